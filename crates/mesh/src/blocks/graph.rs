//! Graphs with weights.

/// A graph whose vertices have sizes and whose edges have weights.
pub(super) struct Graph {
    /// The number of cells that each vertex stands for.
    pub(super) sizes: Vec<i64>,
    /// Where the edges of each vertex begin in `edges`, and the end of the last one's.
    starts: Vec<usize>,
    /// The other end and the weight, in the order of the other ends.
    edges: Vec<(usize, i64)>,
}

impl Graph {
    /// Parallel edges become one; edges from a vertex to itself are dropped.
    pub(super) fn new(sizes: Vec<i64>, edges: impl Iterator<Item = (usize, usize, i64)>) -> Self {
        let apart = edges.filter(|(a, b, _)| a != b);
        let mut directed: Vec<_> = apart.flat_map(|(a, b, weight)| [(a, b, weight), (b, a, weight)]).collect();
        directed.sort_unstable();
        directed.dedup_by(|next, kept| {
            let parallel = (next.0, next.1) == (kept.0, kept.1);
            kept.2 += if parallel { next.2 } else { 0 };
            parallel
        });
        let mut starts = vec![0; sizes.len() + 1];
        directed.iter().for_each(|&(a, _, _)| starts[a + 1] += 1);
        (0..sizes.len()).for_each(|v| starts[v + 1] += starts[v]);
        Graph { sizes, starts, edges: directed.into_iter().map(|(_, b, weight)| (b, weight)).collect() }
    }

    /// The number of vertices.
    pub(super) fn len(&self) -> usize {
        self.sizes.len()
    }
    /// The other ends and the weights of the edges of `vertex`.
    pub(super) fn edges(&self, vertex: usize) -> &[(usize, i64)] {
        &self.edges[self.starts[vertex]..self.starts[vertex + 1]]
    }
    /// The other ends of the edges of `vertex`.
    pub(super) fn neighbours(&self, vertex: usize) -> impl Iterator<Item = usize> + '_ {
        self.edges(vertex).iter().map(|edge| edge.0)
    }
    /// Whether there is an edge between two vertices.
    pub(super) fn joined(&self, a: usize, b: usize) -> bool {
        self.edges(a).binary_search_by_key(&b, |edge| edge.0).is_ok()
    }
    /// The size of the largest vertex.
    pub(super) fn largest(&self) -> i64 {
        self.sizes.iter().copied().max().unwrap_or(0)
    }
    /// The size of all vertices.
    pub(super) fn size(&self) -> i64 {
        self.sizes.iter().sum()
    }

    /// Every edge once, from the lower to the higher vertex.
    fn each_edge(&self) -> impl Iterator<Item = (usize, usize, i64)> + '_ {
        let upwards = move |v: usize| self.edges(v).iter().filter(move |edge| edge.0 > v).map(move |e| (v, e.0, e.1));
        (0..self.len()).flat_map(upwards)
    }

    /// The weight of the edges between vertices of different labels.
    pub(super) fn cut<L: PartialEq>(&self, label: &[L]) -> i64 {
        self.each_edge().filter(|&(a, b, _)| label[a] != label[b]).map(|(_, _, weight)| weight).sum()
    }

    /// The number of connected pieces of vertices with the same label.
    pub(super) fn pieces<L: PartialEq>(&self, label: &[L]) -> usize {
        self.piece_of_vertices(label).into_iter().max().map_or(0, |last| last + 1)
    }

    /// The connected piece, of vertices with the same label, that each vertex belongs to.
    pub(super) fn piece_of_vertices<L: PartialEq>(&self, label: &[L]) -> Vec<usize> {
        let (mut piece, mut count) = (vec![usize::MAX; self.len()], 0);
        for start in 0..self.len() {
            if piece[start] == usize::MAX {
                self.fill(start, label, count, &mut piece);
                count += 1;
            }
        }
        piece
    }

    fn fill<L: PartialEq>(&self, start: usize, label: &[L], number: usize, piece: &mut [usize]) {
        let mut stack = vec![start];
        piece[start] = number;
        while let Some(v) = stack.pop() {
            for other in self.neighbours(v).filter(|&other| label[other] == label[start]) {
                if piece[other] == usize::MAX {
                    piece[other] = number;
                    stack.push(other);
                }
            }
        }
    }

    /// The graph of some vertices, given in increasing order.
    pub(super) fn part(&self, vertices: &[usize]) -> Graph {
        let mut place = vec![None; self.len()];
        vertices.iter().enumerate().for_each(|(i, &v)| place[v] = Some(i));
        let inside = |(a, b, weight): (usize, usize, i64)| Some((place[a]?, place[b]?, weight));
        Graph::new(vertices.iter().map(|&v| self.sizes[v]).collect(), self.each_edge().filter_map(inside))
    }

    /// The graph in which vertex v has become a part of vertex `target[v]` of `count`.
    pub(super) fn contracted(&self, target: &[usize], count: usize) -> Graph {
        let mut sizes = vec![0; count];
        target.iter().zip(&self.sizes).for_each(|(&t, size)| sizes[t] += size);
        Graph::new(sizes, self.each_edge().map(|(a, b, weight)| (target[a], target[b], weight)))
    }
}
