//! The bisection of a graph by way of coarser graphs (Karypis & Kumar, SIAM J. Sci. Comput. 20, 1998).

use super::graph::Graph;
use super::refinement::{Moves, refine};
use super::sizes::Range;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// A graph with this many vertices is not made coarser.
const COARSEST: usize = 40;
/// The number of orders in which vertices find their partners.
const ORDERS: usize = 4;

/// A piece more than necessary counts as much as a cut of this weight: a facet with an aspect ratio of 1000.
const PIECE: i64 = 10_000;

/// The side of every vertex, such that the size of the first side (`false`) is in `range`. Connected sides and a weak cut
/// are the aim.
///
/// The graph is coarsened in several orders of its vertices. Up to `attempts` bisections of every coarsest graph are carried on to the
/// whole graph. The best result counts.
pub(super) fn bisect(graph: &Graph, range: Range, attempts: usize) -> Vec<bool> {
    let best = |order| Levels::new(graph, order).best(range, attempts.clamp(4, COARSEST));
    (0..attempts.clamp(1, ORDERS)).map(best).min().unwrap_or_default().1
}

/// A graph and ever coarser ones.
struct Levels<'a> {
    finest: &'a Graph,
    /// For each finer vertex, its coarse vertex; and the coarse graph.
    coarser: Vec<(Vec<usize>, Graph)>,
}

impl<'a> Levels<'a> {
    fn new(finest: &'a Graph, order: usize) -> Self {
        let mut levels = Levels { finest, coarser: Vec::new() };
        while let Some((target, count)) = coarser(levels.graph(levels.coarser.len()), order) {
            let graph = levels.graph(levels.coarser.len()).contracted(&target, count);
            levels.coarser.push((target, graph));
        }
        levels
    }

    /// The graph of a level; 0 is the finest.
    fn graph(&self, level: usize) -> &Graph {
        if level == 0 { self.finest } else { &self.coarser[level - 1].1 }
    }

    /// The best bisection and its merit, from some bisections of the coarsest graph.
    fn best(&self, range: Range, candidates: usize) -> (Merit, Vec<bool>) {
        let starts = self.starts(range, candidates);
        let finished = |moves| starts.iter().map(move |sides| self.finish(sides.clone(), range, moves));
        finished(Moves::Connected).chain(finished(Moves::Any)).min().unwrap_or_default()
    }

    /// The best bisections of the coarsest graph: grown from every vertex, then refined.
    fn starts(&self, range: Range, candidates: usize) -> Vec<Vec<bool>> {
        let graph = self.graph(self.coarser.len());
        let range = range.widened(graph.largest());
        let start = |seed: usize| {
            let mut sides = grown(graph, seed, range.middle());
            refine(graph, &mut sides, range, Moves::Any);
            (merit(graph, &sides, range), sides)
        };
        let mut starts: Vec<_> = (0..graph.len()).map(start).collect();
        starts.sort_unstable();
        starts.dedup();
        starts.into_iter().take(candidates).map(|(_, sides)| sides).collect()
    }

    /// A bisection of the coarsest graph carried on to the finest, refined on every level; its merit.
    fn finish(&self, mut sides: Vec<bool>, range: Range, moves: Moves) -> (Merit, Vec<bool>) {
        for level in (0..=self.coarser.len()).rev() {
            let graph = self.graph(level);
            refine(graph, &mut sides, range.widened(graph.largest()), moves);
            if level > 0 {
                sides = self.coarser[level - 1].0.iter().map(|&t| sides[t]).collect();
            }
        }
        let mut connected = sides.clone();
        reconnect(self.finest, &mut connected);
        refine(self.finest, &mut connected, range, moves);
        let ranked = [sides, connected].map(|sides| (merit(self.finest, &sides, range), sides));
        ranked.into_iter().min().unwrap_or_default()
    }
}

/// Leaves each side its largest piece: the others change sides.
fn reconnect(graph: &Graph, sides: &mut [bool]) {
    let piece = graph.piece_of_vertices(sides);
    let mut sizes = vec![0; graph.len()];
    piece.iter().zip(&graph.sizes).for_each(|(&p, size)| sizes[p] += size);
    let largest = [false, true].map(|side| {
        let pieces = (0..graph.len()).filter(|&v| sides[v] == side).map(|v| piece[v]);
        pieces.max_by_key(|&p| (sizes[p], Reverse(p)))
    });
    for v in 0..graph.len() {
        sides[v] ^= largest[usize::from(sides[v])] != Some(piece[v]);
    }
}

/// The smaller the better: violation of the range, weight of the cut and the pieces.
type Merit = (i64, i64);

fn merit(graph: &Graph, sides: &[bool], range: Range) -> Merit {
    let size = (0..graph.len()).filter(|&v| !sides[v]).map(|v| graph.sizes[v]).sum();
    (range.violation(size), graph.cut(sides) + PIECE * graph.pieces(sides) as i64)
}

/// The vertices of a graph about half as large: pairs across the strongest edges. `None` if the graph is coarse enough.
fn coarser(graph: &Graph, order: usize) -> Option<(Vec<usize>, usize)> {
    if graph.len() <= COARSEST {
        return None;
    }
    let largest = 3 * graph.size() / (2 * COARSEST as i64);
    let mut target = vec![usize::MAX; graph.len()];
    let mut count = 0;
    for v in visits(graph.len(), order) {
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

/// All numbers below `count`: in their order, or from end to end in steps of about a fraction of `count`.
fn visits(count: usize, order: usize) -> impl Iterator<Item = usize> {
    let fraction = [0.0, 0.618, 0.382, 0.236][order % ORDERS];
    let coprime = |step: &usize| greatest_divisor(*step, count) == 1;
    let step = ((fraction * count as f64) as usize + 1..).find(coprime).unwrap_or(1);
    (0..count).map(move |i| i * step % count)
}

/// The greatest common divisor.
fn greatest_divisor(a: usize, b: usize) -> usize {
    if b == 0 { a } else { greatest_divisor(b, a % b) }
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
