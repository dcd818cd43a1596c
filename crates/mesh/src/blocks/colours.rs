//! Colours of the cells at the cuts between blocks.

use crate::{Mesh, Side};
use std::collections::VecDeque;

/// The colour of every cell that has a facet to another block, `None` for the others. Two cells of different blocks that
/// share a facet have different colours.
///
/// Consider the graph of these cells and of the facets at cuts. Its pieces are coloured one after the other, breadth first
/// from the lowest cell: every cell takes the first colour that its neighbours across the cuts do not have. Two colours do
/// if no ring of facets at cuts is odd; otherwise there are more.
///
/// # Panics
/// If `block` has fewer entries than there are cells.
pub fn colours<const D: usize>(mesh: &Mesh<D>, block: &[usize]) -> Vec<Option<usize>> {
    let across = neighbours_across(mesh, block);
    let mut colour = vec![None; across.len()];
    for start in 0..across.len() {
        if colour[start].is_none() && !across[start].is_empty() {
            colour_piece(start, &across, &mut colour);
        }
    }
    colour
}

/// The neighbours of every cell in other blocks, in the order of their numbers.
fn neighbours_across<const D: usize>(mesh: &Mesh<D>, block: &[usize]) -> Vec<Vec<usize>> {
    let mut across = vec![Vec::new(); mesh.n_cells()];
    for facet in mesh.interior_facets() {
        let (Side { cell: minus, .. }, Side { cell: plus, .. }) = (facet.minus, facet.plus);
        if block[minus] != block[plus] {
            across[minus].push(plus);
            across[plus].push(minus);
        }
    }
    for cells in &mut across {
        cells.sort_unstable();
        cells.dedup();
    }
    across
}

fn colour_piece(start: usize, across: &[Vec<usize>], colour: &mut [Option<usize>]) {
    let mut queue = VecDeque::from([start]);
    while let Some(cell) = queue.pop_front() {
        if colour[cell].is_none() {
            let taken = |c: &usize| across[cell].iter().any(|&other| colour[other] == Some(*c));
            colour[cell] = (0..).find(|c| !taken(c));
            queue.extend(across[cell].iter().filter(|&&other| colour[other].is_none()));
        }
    }
}
