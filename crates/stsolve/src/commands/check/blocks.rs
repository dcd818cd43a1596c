//! The blocks into which the cells of a flow are cut.

use super::super::table::Table;
use case::{Case, Flow};
use navier_stokes::Viscosity;
use std::collections::BTreeSet;

/// Sizes of blocks and of their messages; none if the mesh is one block.
pub(super) fn table<const D: usize>(case: &Case<D>, flow: &Flow<D>) -> Option<Table> {
    let blocks = mesh::blocks(&case.mesh, case.blocks).ok().filter(|_| case.blocks > 1)?;
    let mut sizes = vec![0; case.blocks];
    blocks.iter().for_each(|&block| sizes[block] += 1);
    let extremes = [sizes.iter().min(), sizes.iter().max()].map(|size| size.copied().unwrap_or(0));
    let is_viscous = flow.law.shock_capturing.is_some() || flow.law.gas.viscosity() != Viscosity::Inviscid;
    let kinds = if is_viscous { 2 } else { 1 };
    let face = kinds * flow.order.pow(D as u32 - 1) * (D + 2) * case.time.order;
    let (at_cuts, most_cut) = cuts(case, &blocks);
    let mut table = Table::new("blocks");
    table
        .row("blocks", case.blocks, "at least one for each process")
        .row("smallest block", extremes[0], "cells")
        .row("largest block", extremes[1], "cells")
        .row("cells at cuts", at_cuts.len(), "")
        .row("sent in a product", most_cut * face * size_of::<f64>(), "bytes, by a block at most");
    Some(table)
}

/// The cells at cuts, and the largest number of facets between a block and others.
fn cuts<const D: usize>(case: &Case<D>, blocks: &[usize]) -> (BTreeSet<usize>, usize) {
    let (mut cells, mut facets) = (BTreeSet::new(), vec![0; case.blocks]);
    for facet in case.mesh.interior_facets() {
        let sides = [facet.minus.cell, facet.plus.cell];
        if blocks[sides[0]] != blocks[sides[1]] {
            cells.extend(sides);
            sides.iter().for_each(|&cell| facets[blocks[cell]] += 1);
        }
    }
    (cells, facets.into_iter().max().unwrap_or(0))
}
