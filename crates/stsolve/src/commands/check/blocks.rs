//! The blocks into which the cells of a flow are cut.

use super::super::table::Table;
use case::{Case, Flow};
use std::collections::BTreeSet;

/// Sizes of blocks and of what they send; none where the mesh is one block.
pub(super) fn table<const D: usize>(case: &Case<D>, flow: &Flow<D>) -> Option<Table> {
    let blocks = mesh::blocks(&case.mesh, case.blocks).ok().filter(|_| case.blocks > 1)?;
    let colours = mesh::colours(&case.mesh, &blocks);
    let mut sizes = vec![0; case.blocks];
    blocks.iter().for_each(|&block| sizes[block] += 1);
    let extremes = [sizes.iter().min(), sizes.iter().max()].map(|size| size.copied().unwrap_or(0));
    let cell = flow.order.pow(D as u32) * (D + 2) * case.time.order;
    let mut table = Table::new("blocks");
    table
        .row("blocks", case.blocks, "at least one for each process")
        .row("smallest block", extremes[0], "cells")
        .row("largest block", extremes[1], "cells")
        .row("cells at cuts", colours.iter().flatten().count(), "")
        .row("colours of cells at cuts", colours.iter().flatten().max().map_or(0, |colour| colour + 1), "")
        .row("sent in a product", most_sent(case, &blocks) * cell * size_of::<f64>(), "bytes, by a block at most");
    Some(table)
}

/// The largest number of cells that a block sends to its neighbours, a cell once to each of them.
fn most_sent<const D: usize>(case: &Case<D>, blocks: &[usize]) -> usize {
    let mut sent: Vec<BTreeSet<(usize, usize)>> = vec![BTreeSet::new(); case.blocks];
    for facet in case.mesh.interior_facets() {
        for (here, there) in [(facet.minus.cell, facet.plus.cell), (facet.plus.cell, facet.minus.cell)] {
            if blocks[here] != blocks[there] {
                sent[blocks[here]].insert((here, blocks[there]));
            }
        }
    }
    sent.iter().map(BTreeSet::len).max().unwrap_or(0)
}
