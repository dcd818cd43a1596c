//! The order of the unknowns of a level, in which sweeps of Gauss-Seidel run in parallel with the same bits on any number of threads.
//!
//! Nodes that follow one another form chunks. Chunks with coupled nodes have different colours. A sweep treats one colour after the other, and
//! the chunks of a colour at the same time: none of them reads what another one writes.

use std::ops::Range;

/// The nodes of a chunk in three dimensions, where the iterations stay the same.
const CHUNK: usize = 256;

/// The nodes of a chunk in D dimensions. In two dimensions one chunk has all nodes, because several cost a tenth more iterations.
pub(crate) fn nodes_per_chunk(dimension: usize) -> usize {
    if dimension == 2 { usize::MAX } else { CHUNK }
}

/// The nodes coupled with every node, itself included: a symmetric relation.
pub(crate) struct Couplings {
    starts: Vec<usize>,
    nodes: Vec<u32>,
}

impl Couplings {
    /// Of no node.
    pub(crate) fn new() -> Self {
        Couplings { starts: vec![0], nodes: Vec::new() }
    }

    /// Appends a node with those coupled with it.
    pub(crate) fn push(&mut self, coupled: &[u32]) {
        self.nodes.extend_from_slice(coupled);
        self.starts.push(self.nodes.len());
    }

    /// The number of nodes.
    pub(super) fn count(&self) -> usize {
        self.starts.len() - 1
    }

    /// The number of all couplings.
    pub(super) fn total(&self) -> usize {
        self.nodes.len()
    }

    /// The nodes coupled with a node.
    pub(crate) fn of(&self, node: usize) -> &[u32] {
        &self.nodes[self.starts[node]..self.starts[node + 1]]
    }
}

/// The nodes of a level in the order of their colours.
pub(crate) struct Colouring {
    /// The node before reordering of every node.
    pub(crate) order: Vec<usize>,
    /// The nodes of every colour. Each chunk of a colour is full; only its last one may have fewer nodes.
    pub(super) colours: Vec<Range<usize>>,
    /// The nodes of a chunk.
    pub(super) chunk: usize,
}

impl Colouring {
    /// For these couplings, and chunks of so many nodes.
    pub(crate) fn new(couplings: &Couplings, chunk: usize) -> Self {
        let colour_of = colours_of_chunks(couplings, chunk);
        let (mut order, mut colours) = (Vec::with_capacity(couplings.count()), Vec::new());
        for colour in 0..colour_of.iter().max().map_or(0, |last| last + 1) {
            let begin = order.len();
            let chunks = (0..colour_of.len()).filter(|&number| colour_of[number] == colour);
            chunks.for_each(|number| order.extend(nodes_of(number, chunk, couplings.count())));
            colours.push(begin..order.len());
        }
        Colouring { order, colours, chunk }
    }

    /// The place in the order of every node before reordering.
    pub(crate) fn places(&self) -> Vec<usize> {
        let mut places = vec![0; self.order.len()];
        self.order.iter().enumerate().for_each(|(place, &node)| places[node] = place);
        places
    }
}

fn nodes_of(number: usize, chunk: usize, nodes: usize) -> Range<usize> {
    number * chunk..((number + 1) * chunk).min(nodes)
}

/// The first colour that no earlier chunk with a coupled node has, for one chunk after the other.
fn colours_of_chunks(couplings: &Couplings, chunk: usize) -> Vec<usize> {
    let mut colours: Vec<usize> = Vec::new();
    for number in 0..couplings.count().div_ceil(chunk) {
        let coupled = nodes_of(number, chunk, couplings.count()).flat_map(|node| couplings.of(node));
        let mut taken: Vec<bool> = Vec::new();
        for &colour in coupled.filter_map(|&other| colours.get(other as usize / chunk)) {
            taken.resize(taken.len().max(colour + 1), false);
            taken[colour] = true;
        }
        colours.push(taken.iter().position(|taken| !taken).unwrap_or(taken.len()));
    }
    colours
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The nodes of a square lattice, coupled with their eight neighbours.
    fn lattice(side: usize) -> Couplings {
        let near = |i: usize| i.saturating_sub(1)..(i + 2).min(side);
        let around = |k: usize| near(k / side).flat_map(move |i| near(k % side).map(move |j| (i * side + j) as u32));
        let mut couplings = Couplings::new();
        (0..side * side).for_each(|k| couplings.push(&around(k).collect::<Vec<u32>>()));
        couplings
    }

    #[test]
    fn no_chunk_is_coupled_with_another_of_its_colour() {
        let neighbours = lattice(90);
        let colouring = Colouring::new(&neighbours, CHUNK);
        let places = colouring.places();
        assert_eq!(colouring.colours.last().map(|last| last.end), Some(8100));
        for colour in &colouring.colours {
            let chunk = |place: usize| (place - colour.start) / CHUNK;
            for place in colour.clone() {
                let coupled = neighbours.of(colouring.order[place]).iter().map(|&other| places[other as usize]);
                let same_colour = coupled.filter(|other| colour.contains(other));
                same_colour.for_each(|other| assert_eq!(chunk(other), chunk(place)));
            }
        }
    }
}
