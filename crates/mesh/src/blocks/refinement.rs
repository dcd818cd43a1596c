//! Moves of vertices across a cut while they make it weaker (Fiduccia & Mattheyses, DAC 1982).

use super::graph::Graph;
use super::sizes::Range;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// A pass ends after this many moves without a better cut.
const FRUITLESS: usize = 200;

/// Which moves are allowed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Moves {
    /// All.
    Any,
    /// Those that leave connected sides connected.
    Connected,
}

/// Improves a bisection until a pass of moves finds nothing better. A size within `range` comes before a weak cut.
pub(super) fn refine(graph: &Graph, sides: &mut [bool], range: Range, moves: Moves) {
    while Pass::new(graph, sides, range, moves).run() {}
}

/// One pass: every vertex moves at most once, the best one first, also if the cut becomes stronger for a while.
struct Pass<'a> {
    graph: &'a Graph,
    sides: &'a mut [bool],
    range: Range,
    moves: Moves,
    /// The size of the first side.
    size: i64,
    /// The largest violation of the range that a move may cause for a while.
    tolerance: i64,
    /// How much weaker the cut becomes by a move of the vertex.
    gain: Vec<i64>,
    moved: Vec<bool>,
    /// Candidates of either side: gain and vertex. An entry with an old gain is void.
    queues: [BinaryHeap<(i64, Reverse<usize>)>; 2],
}

impl<'a> Pass<'a> {
    fn new(graph: &'a Graph, sides: &'a mut [bool], range: Range, moves: Moves) -> Self {
        let signed = |v: usize| graph.edges(v).iter().map(|&(o, w)| if sides[o] == sides[v] { -w } else { w }).sum();
        let gain: Vec<i64> = (0..graph.len()).map(signed).collect();
        let queue = |side| (0..graph.len()).filter(|&v| sides[v] == side).map(|v| (gain[v], Reverse(v))).collect();
        let queues = [queue(false), queue(true)];
        let size = (0..graph.len()).filter(|&v| !sides[v]).map(|v| graph.sizes[v]).sum();
        let tolerance = graph.largest();
        Pass { graph, range, moves, size, tolerance, gain, moved: vec![false; graph.len()], queues, sides }
    }

    /// Whether the pass found something better.
    fn run(mut self) -> bool {
        let (mut moves, mut change) = (Vec::new(), 0);
        let start = (self.range.violation(self.size), 0);
        let (mut best, mut kept) = (start, 0);
        while moves.len() < kept + FRUITLESS {
            let Some(v) = self.next() else { break };
            change -= self.gain[v];
            self.shift(v);
            moves.push(v);
            let now = (self.range.violation(self.size), change);
            if now < best {
                (best, kept) = (now, moves.len());
            }
        }
        moves[kept..].iter().for_each(|&v| self.sides[v] = !self.sides[v]);
        best < start
    }

    /// The vertex to move: from the side that is too large, otherwise the one with the larger gain.
    fn next(&mut self) -> Option<usize> {
        loop {
            self.drop_void();
            let top = |side: usize| self.queues[side].peek().copied();
            let side = match (self.size > self.range.high, self.size < self.range.low) {
                (true, _) => 0,
                (_, true) => 1,
                _ => usize::from(top(1) > top(0)),
            };
            let (_, Reverse(v)) = self.queues[side].pop()?;
            if self.admits(v) && (self.moves == Moves::Any || self.keeps_connected(v)) {
                return Some(v);
            }
        }
    }

    fn drop_void(&mut self) {
        for queue in &mut self.queues {
            while queue.peek().is_some_and(|&(gain, Reverse(v))| self.moved[v] || gain != self.gain[v]) {
                queue.pop();
            }
        }
    }

    /// Whether a move keeps the size near the range, or brings it nearer.
    fn admits(&self, v: usize) -> bool {
        let violation = self.range.violation(self.size_after(v));
        violation <= self.tolerance || violation < self.range.violation(self.size)
    }

    /// Whether both sides stay connected by a move. It is enough to look near the vertex: it has a neighbour on the other
    /// side, and its neighbours on its own side are joined to each other there, directly or through one more vertex.
    fn keeps_connected(&self, v: usize) -> bool {
        let own = |other: &usize| self.sides[*other] == self.sides[v];
        let (mut rest, others): (Vec<usize>, Vec<usize>) = self.graph.neighbours(v).partition(own);
        let mut reached: Vec<usize> = rest.pop().into_iter().collect();
        while let Some(from) = reached.pop() {
            let near = |to: &usize| {
                let joins = |&by: &usize| by == *to || (by != v && own(&by) && self.graph.joined(by, *to));
                self.graph.neighbours(from).any(|by| joins(&by))
            };
            let (next, left): (Vec<usize>, Vec<usize>) = rest.into_iter().partition(near);
            reached.extend(next);
            rest = left;
        }
        rest.is_empty() && !others.is_empty()
    }

    fn size_after(&self, v: usize) -> i64 {
        self.size + if self.sides[v] { self.graph.sizes[v] } else { -self.graph.sizes[v] }
    }

    fn shift(&mut self, v: usize) {
        self.size = self.size_after(v);
        self.sides[v] = !self.sides[v];
        self.moved[v] = true;
        for &(other, weight) in self.graph.edges(v) {
            self.gain[other] += if self.sides[other] == self.sides[v] { -2 * weight } else { 2 * weight };
            if !self.moved[other] {
                self.queues[usize::from(self.sides[other])].push((self.gain[other], Reverse(other)));
            }
        }
    }
}
