//! Minimum discarded fill (Persson & Peraire 2008).
//!
//! Eliminating cell k would create the fill A_ik A_kk^{-1} A_kj between its remaining neighbours i and j, which ILU(0)
//! discards; the cell whose fill is least comes next.

use super::graph::{Edge, Graph};
use std::collections::BTreeSet;

/// Takes the cell of least discarded fill again and again; the lower number where two are equal.
pub fn eliminate(graph: &Graph) -> Vec<usize> {
    let cells = graph.edges.len();
    let mut gone = vec![false; cells];
    let mut weights: Vec<f64> = (0..cells).map(|k| discarded(graph, k, &gone)).collect();
    let mut queue: BTreeSet<(u64, usize)> = weights.iter().enumerate().map(|(k, w)| (w.to_bits(), k)).collect();
    let mut order = Vec::with_capacity(cells);
    while let Some((_, k)) = queue.pop_first() {
        gone[k] = true;
        order.push(k);
        for edge in graph.edges[k].iter().filter(|edge| !gone[edge.cell]) {
            queue.remove(&(weights[edge.cell].to_bits(), edge.cell));
            weights[edge.cell] = discarded(graph, edge.cell, &gone);
            queue.insert((weights[edge.cell].to_bits(), edge.cell));
        }
    }
    order
}

/// The squared norm of the fill that the elimination of cell `k` would create.
fn discarded(graph: &Graph, k: usize, gone: &[bool]) -> f64 {
    let edges = &graph.edges[k];
    let alive = || edges.iter().enumerate().filter(|(_, edge)| !gone[edge.cell]);
    alive()
        .flat_map(|(a, i)| alive().filter(move |(b, _)| *b != a).map(move |(b, _)| (i, b)))
        .map(|(i, b)| (towards(graph, k, i) * edges[b].strength).powi(2))
        // A sum of nothing is -0, of which the bits are not those of the least number.
        .fold(0.0, |sum, fill| sum + fill)
}

/// |A_ii^{-1} A_ik| of the cell i at the end of an edge of cell `k`: it is stored with cell i, with the edge back across the same facet.
fn towards(graph: &Graph, k: usize, edge: &Edge) -> f64 {
    let is_back = |other: &&Edge| (other.cell, other.face, other.other_face) == (k, edge.other_face, edge.face);
    graph.edges[edge.cell].iter().find(is_back).map_or(0.0, |back| back.strength)
}
