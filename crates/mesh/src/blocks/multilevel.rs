//! The bisection of a graph by way of coarser graphs (Karypis & Kumar, SIAM J. Sci. Comput. 20, 1998).

use super::graph::Graph;
use super::refinement::refine;
use super::sizes::Range;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// A graph with this many vertices is not made coarser.
const COARSEST: usize = 40;

/// The side of every vertex, such that the size of the first side (`false`) is in `range`. Few pieces come before a weak cut.
pub(super) fn bisect(graph: &Graph, range: Range) -> Vec<bool> {
    if let Some((target, count)) = coarser(graph) {
        let coarse = bisect(&graph.contracted(&target, count), range);
        let mut sides: Vec<bool> = target.iter().map(|&t| coarse[t]).collect();
        refine(graph, &mut sides, range);
        return sides;
    }
    let candidates = (0..graph.len()).map(|seed| {
        let mut sides = grown(graph, seed, range.middle());
        refine(graph, &mut sides, range);
        sides
    });
    candidates.min_by_key(|sides| merit(graph, sides, range)).unwrap_or_default()
}

/// The smaller the better: violation of the range, pieces, cut.
fn merit(graph: &Graph, sides: &[bool], range: Range) -> (i64, usize, i64) {
    let size = (0..graph.len()).filter(|&v| !sides[v]).map(|v| graph.sizes[v]).sum();
    (range.violation(size), graph.pieces(sides), graph.cut(sides))
}

/// The vertices of a graph about half as large: pairs across the strongest edges. `None` if the graph is coarse enough.
fn coarser(graph: &Graph) -> Option<(Vec<usize>, usize)> {
    if graph.len() <= COARSEST {
        return None;
    }
    let largest = 3 * graph.size() / (2 * COARSEST as i64);
    let mut target = vec![usize::MAX; graph.len()];
    let mut count = 0;
    for v in 0..graph.len() {
        if target[v] == usize::MAX {
            target[v] = count;
            if let Some(other) = partner(graph, v, &target, largest) {
                target[other] = count;
            }
            count += 1;
        }
    }
    (20 * count < 19 * graph.len()).then_some((target, count))
}

/// The free neighbour with the strongest edge relative to its size.
fn partner(graph: &Graph, v: usize, target: &[usize], largest: i64) -> Option<usize> {
    let fits = |other: usize| target[other] == usize::MAX && graph.sizes[v] + graph.sizes[other] <= largest.max(2);
    let free = graph.edges(v).iter().filter(|edge| fits(edge.0));
    let better = |a: &&(usize, i64), b: &&(usize, i64)| {
        let scaled = |weight: i64, size: i64| i128::from(weight).pow(2) * i128::from(size);
        let strength = scaled(a.1, graph.sizes[b.0]).cmp(&scaled(b.1, graph.sizes[a.0]));
        strength.then(b.0.cmp(&a.0))
    };
    free.max_by(better).map(|edge| edge.0)
}

/// A first side of about `size`, grown from `seed` by the vertices that make the cut weakest.
fn grown(graph: &Graph, seed: usize, size: i64) -> Vec<bool> {
    let mut sides = vec![true; graph.len()];
    let mut gain: Vec<i64> = (0..graph.len()).map(|v| -graph.edges(v).iter().map(|edge| edge.1).sum::<i64>()).collect();
    let (mut queue, mut grown, mut rest) = (BinaryHeap::from([(0, Reverse(seed))]), 0, 0..graph.len());
    while grown < size {
        let next = queue.pop().map(|(_, Reverse(v))| v).or_else(|| rest.next());
        let Some(v) = next else { break };
        if !std::mem::replace(&mut sides[v], false) {
            continue;
        }
        grown += graph.sizes[v];
        for &(other, weight) in graph.edges(v).iter().filter(|edge| sides[edge.0]) {
            gain[other] += 2 * weight;
            queue.push((gain[other], Reverse(other)));
        }
    }
    sides
}
