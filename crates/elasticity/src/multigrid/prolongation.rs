//! The functions of the next level, and the matrix of that level.

use super::blocks::{Block, add_block_product, transposed};
use super::colouring::{Colouring, Couplings};
use super::matrix::BlockRows;
use rayon::prelude::*;

/// Rows of A_c that are kept beside the matrix while they are computed.
const ROWS: usize = 1024;

/// The nodes that a thread takes at least.
const AT_LEAST: usize = 8;

/// P: the values of the next level's functions, in single precision. The matrix of that level is made of the same numbers, so that their
/// rounding changes the functions slightly, and no product with them.
pub(crate) struct Prolongation<const R: usize, const B: usize> {
    /// The first block of each node.
    starts: Vec<usize>,
    /// The nodes of the next level.
    columns: Vec<u32>,
    blocks: Vec<[[f32; B]; R]>,
    transpose: Transpose,
}

/// The blocks of P by nodes of the next level.
#[derive(Default)]
struct Transpose {
    /// The first of `places` of every node.
    starts: Vec<usize>,
    /// A node of this level, and the block.
    places: Vec<[u32; 2]>,
}

impl Transpose {
    /// For the first block of each node, the columns of the blocks, and `count` nodes of the next level.
    fn new(rows: &[usize], columns: &[u32], count: usize) -> Self {
        let mut starts = vec![0; count + 1];
        columns.iter().for_each(|&column| starts[column as usize + 1] += 1);
        (0..count).for_each(|column| starts[column + 1] += starts[column]);
        let (mut next, mut places) = (starts.clone(), vec![[0; 2]; columns.len()]);
        for (row, blocks) in rows.windows(2).enumerate() {
            for block in blocks[0]..blocks[1] {
                let column = columns[block] as usize;
                places[next[column]] = [row as u32, block as u32];
                next[column] += 1;
            }
        }
        Transpose { starts, places }
    }

    /// The nodes and blocks of a function.
    fn of(&self, function: usize) -> &[[u32; 2]] {
        &self.places[self.starts[function]..self.starts[function + 1]]
    }
}

impl<const R: usize, const B: usize> Prolongation<R, B> {
    /// Without rows.
    pub(crate) fn new() -> Self {
        let (starts, columns, blocks) = (vec![0], Vec::new(), Vec::new());
        Prolongation { starts, columns, blocks, transpose: Transpose::default() }
    }

    /// Appends a row.
    pub(crate) fn push(&mut self, row: impl IntoIterator<Item = (usize, Block<R, B>)>) {
        for (column, block) in row {
            self.columns.push(column as u32);
            self.blocks.push(block.map(|row| row.map(|value| value as f32)));
        }
        self.starts.push(self.columns.len());
    }

    /// A_c = P^T A P for all rows and `count` nodes of the next level. It reorders these; the new order is the second result.
    pub(crate) fn finish(&mut self, matrix: &BlockRows<R>, count: usize) -> (BlockRows<B>, Vec<usize>) {
        self.transpose = Transpose::new(&self.starts, &self.columns, count);
        let couplings = self.couplings(matrix, count);
        let colouring = Colouring::new(&couplings, matrix.chunk());
        let places = colouring.places();
        self.columns.iter_mut().for_each(|column| *column = places[*column as usize] as u32);
        self.transpose = Transpose::new(&self.starts, &self.columns, count);
        let mut coarse = BlockRows::zero(couplings, &colouring, &places);
        self.galerkin(matrix, &mut coarse);
        coarse.make_regular();
        (coarse, colouring.order)
    }

    fn columns(&self, row: usize) -> &[u32] {
        &self.columns[self.starts[row]..self.starts[row + 1]]
    }

    fn block(&self, place: usize) -> Block<R, B> {
        self.blocks[place].map(|row| row.map(f64::from))
    }

    /// The coupled nodes of each of `count` nodes of the next level: those of the functions that meet in an entry of `matrix`.
    fn couplings(&self, matrix: &BlockRows<R>, count: usize) -> Couplings {
        let find = |[fine, coarse]: &mut [Found; 2], function: usize| {
            fine.clear();
            coarse.clear();
            for [row, _] in self.transpose.of(function) {
                matrix.columns(*row as usize).iter().for_each(|&column| _ = fine.place(column));
            }
            let functions = fine.nodes.iter().flat_map(|&node| self.columns(node as usize));
            functions.for_each(|&function| _ = coarse.place(function));
            coarse.nodes.clone()
        };
        let found = || [Found::new(matrix.rows()), Found::new(count)];
        let lists: Vec<Vec<u32>> = (0..count).into_par_iter().with_min_len(ROWS).map_init(found, find).collect();
        let mut couplings = Couplings::new();
        lists.iter().for_each(|list| couplings.push(list));
        couplings
    }

    /// A_c = (P^T A) P, row by row.
    fn galerkin(&self, matrix: &BlockRows<R>, coarse: &mut BlockRows<B>) {
        let count = coarse.rows();
        for first in (0..count).step_by(ROWS) {
            let work = || (Found::new(matrix.rows()), Found::new(count));
            let functions = (first..(first + ROWS).min(count)).into_par_iter().with_min_len(ROWS / 16);
            let rows =
                functions.map_init(work, |(fine, coarse), function| self.galerkin_row(matrix, function, fine, coarse));
            let rows: Vec<_> = rows.collect();
            for (row, blocks) in (first..).zip(rows) {
                blocks.iter().for_each(|(column, block)| coarse.add(row, *column as usize, block));
            }
        }
    }

    /// The columns and blocks of a row of A_c.
    fn galerkin_row(
        &self,
        matrix: &BlockRows<R>,
        function: usize,
        fine: &mut Found,
        coarse: &mut Found,
    ) -> Vec<(u32, Block<B, B>)> {
        fine.clear();
        coarse.clear();
        let (mut products, mut row): (Vec<Block<B, R>>, Vec<Block<B, B>>) = (Vec::new(), Vec::new());
        for [node, place] in self.transpose.of(function) {
            let left = transposed(&self.block(*place as usize));
            for (column, right) in matrix.row(*node as usize) {
                add_block_product(&left, &right, fine.entry(column as u32, &mut products));
            }
        }
        for (&node, left) in fine.nodes.iter().zip(&products) {
            for place in self.starts[node as usize]..self.starts[node as usize + 1] {
                add_block_product(left, &self.block(place), coarse.entry(self.columns[place], &mut row));
            }
        }
        coarse.nodes.iter().copied().zip(row).collect()
    }
}

/// Different nodes in the order in which they were found.
struct Found {
    nodes: Vec<u32>,
    /// One more than its place, for a node that was found.
    places: Vec<u32>,
}

impl Found {
    fn new(count: usize) -> Self {
        Found { nodes: Vec::new(), places: vec![0; count] }
    }

    fn clear(&mut self) {
        self.nodes.drain(..).for_each(|node| self.places[node as usize] = 0);
    }

    /// The place of a node, which may be new.
    fn place(&mut self, node: u32) -> usize {
        let place = &mut self.places[node as usize];
        if *place == 0 {
            self.nodes.push(node);
            *place = self.nodes.len() as u32;
        }
        *place as usize - 1
    }

    /// The block of a node, which is zero if the node is new.
    fn entry<'a, const R: usize, const C: usize>(
        &mut self,
        node: u32,
        blocks: &'a mut Vec<Block<R, C>>,
    ) -> &'a mut Block<R, C> {
        let place = self.place(node);
        if place == blocks.len() {
            blocks.push([[0.0; C]; R]);
        }
        &mut blocks[place]
    }
}

/// The block of a column in a short list, where it is added with zeros if it is new.
pub(super) fn entry_of<const R: usize, const B: usize>(
    list: &mut Vec<(usize, Block<R, B>)>,
    column: usize,
) -> &mut Block<R, B> {
    let place = list.iter().position(|(other, _)| *other == column).unwrap_or(list.len());
    if place == list.len() {
        list.push((column, [[0.0; B]; R]));
    }
    &mut list[place].1
}

impl<const R: usize, const B: usize> Prolongation<R, B> {
    /// x = x + P c
    pub(crate) fn add_to(&self, coarse: &[[f64; B]], x: &mut [[f64; R]]) {
        x.par_iter_mut().with_min_len(AT_LEAST).enumerate().for_each(|(row, x)| {
            for place in self.starts[row]..self.starts[row + 1] {
                let coarse = &coarse[self.columns[place] as usize];
                for (x, values) in x.iter_mut().zip(&self.blocks[place]) {
                    *x += values.iter().zip(coarse).map(|(&value, coarse)| f64::from(value) * coarse).sum::<f64>();
                }
            }
        });
    }

    /// c = P^T r
    pub(crate) fn restrict(&self, r: &[[f64; R]], coarse: &mut [[f64; B]]) {
        coarse.par_iter_mut().with_min_len(AT_LEAST).enumerate().for_each(|(function, coarse)| {
            *coarse = [0.0; B];
            for [row, block] in self.transpose.of(function) {
                for (values, r) in self.blocks[*block as usize].iter().zip(&r[*row as usize]) {
                    coarse.iter_mut().zip(values).for_each(|(coarse, &value)| *coarse += f64::from(value) * r);
                }
            }
        });
    }

    /// Its memory.
    pub(crate) fn bytes(&self) -> usize {
        let Transpose { starts, places } = &self.transpose;
        let indices = size_of_val(&self.starts[..]) + size_of_val(&self.columns[..]) + size_of_val(&starts[..]);
        indices + size_of_val(&self.blocks[..]) + size_of_val(&places[..])
    }
}
