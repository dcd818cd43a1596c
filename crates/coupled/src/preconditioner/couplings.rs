//! The off-diagonal blocks in [`bf16_blocks`], in the order in which the sweeps read them.

use super::bf16_blocks;
use super::blocks::{Link, coupling_block};
use super::inverse::Shape;
use super::ordering::Ordering;
use super::panel::padded;
use fem::parallel::{self, Grain};
use fem::{SpaceJacobian, Stored};
use std::slice::ChunksExact;

/// What a sweep does with a neighbour of a cell: A_ik = T_f^T B T_g, i the cell, k the neighbour.
#[derive(Clone, Copy, Debug)]
pub struct Step {
    /// The position of the neighbour.
    pub neighbour: usize,
    /// The face f of the cell.
    pub face: usize,
    /// The face g of the neighbour.
    pub other_face: usize,
    /// The number of the block B.
    block: usize,
}

/// The steps of both sweeps and their blocks.
pub struct Couplings {
    /// Of a block.
    shape: Shape,
    /// How many numbers in bfloat16 an entry is the sum of.
    terms: usize,
    /// `[block][term]`
    blocks: Vec<u32>,
    /// The link of every block.
    links: Vec<Link>,
    /// For every position the steps to earlier positions, and those to later ones.
    earlier: Vec<Vec<Step>>,
    later: Vec<Vec<Step>>,
}

impl Couplings {
    /// The couplings of `jacobian` along the `links` of every cell.
    pub fn new<T: Stored>(jacobian: &SpaceJacobian<T>, links: &[Vec<Link>], ordering: &Ordering) -> Self {
        let t = jacobian.traces.len();
        let shape = Shape { n: t, parts: 1 };
        let mut order = Vec::new();
        let [earlier, later] = [false, true].map(|later| steps(links, ordering, later, &mut order));
        let mut couplings = Couplings { shape, terms: 1, blocks: Vec::new(), links: order, earlier, later };
        couplings.update(jacobian, 1);
        couplings
    }

    /// The couplings of another `jacobian` along the same links, in so many `terms`.
    pub fn update<T: Stored>(&mut self, jacobian: &SpaceJacobian<T>, terms: usize) {
        let (shape, len) = (self.shape, bf16_blocks::panels(self.shape).len());
        self.terms = terms;
        if self.blocks.len() != len * terms * self.links.len() {
            self.blocks = vec![0; len * terms * self.links.len()];
        }
        parallel::for_each_chunk(&mut self.blocks, len * terms, Grain::Any, &|number, stored| {
            let mut block = vec![0.0; shape.len()];
            let columns = coupling_block(jacobian, self.links[number]).chunks_exact(shape.n);
            for (column, b) in block.chunks_exact_mut(shape.stride()).zip(columns) {
                column.iter_mut().zip(b).for_each(|(column, &b)| *column = b.into() as f32);
            }
            bf16_blocks::store_in_terms(shape, &mut block, stored.chunks_exact_mut(len));
        });
    }

    /// The steps at `position` to earlier positions.
    pub fn earlier(&self, position: usize) -> &[Step] {
        &self.earlier[position]
    }
    /// The steps at `position` to later positions.
    pub fn later(&self, position: usize) -> &[Step] {
        &self.later[position]
    }
    /// The number of the coupling of a step.
    pub fn number(&self, step: &Step) -> usize {
        self.links[step.block].coupling
    }
    /// The terms of the block B of a step, in [`bf16_blocks`].
    pub fn block(&self, step: &Step) -> ChunksExact<'_, u32> {
        let len = bf16_blocks::panels(self.shape).len();
        self.blocks[step.block * self.terms * len..][..self.terms * len].chunks_exact(len)
    }
    /// Padded rows of a block.
    pub fn rows(&self) -> usize {
        padded(self.shape.n)
    }
    /// Numbers of all terms of all blocks, with the zeros that pad them.
    pub fn numbers(&self) -> usize {
        2 * self.blocks.len()
    }
    /// Bytes of all blocks.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.blocks[..])
    }
}

/// The steps of one sweep. Their links are appended to `order`: they tell the numbers of blocks.
fn steps(links: &[Vec<Link>], ordering: &Ordering, later: bool, order: &mut Vec<Link>) -> Vec<Vec<Step>> {
    let mut steps = Vec::with_capacity(links.len());
    for (position, &cell) in ordering.cells.iter().enumerate() {
        let wanted = links[cell].iter().filter(|link| (ordering.positions[link.cell] > position) == later);
        let step = |link: &Link| {
            order.push(*link);
            let neighbour = ordering.positions[link.cell];
            Step { neighbour, face: link.face, other_face: link.other_face, block: order.len() - 1 }
        };
        steps.push(wanted.map(step).collect());
    }
    steps
}
