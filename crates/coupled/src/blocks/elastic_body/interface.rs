//! The nodes of the flow's mesh that move with a solid.

/// A node of the flow's mesh that moves with a node of the solid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Follower {
    /// The C0 node of the solid.
    pub solid: usize,
    /// The C0 node of the flow's mesh.
    pub node: usize,
    /// Its displacement relative to the node of the solid: one on the wall, less in the mesh that follows the wall.
    pub weight: f64,
}

/// The interface of a solid and the flow.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Interface {
    /// All nodes that move with the solid; those of the wall come first.
    followers: Vec<Follower>,
    /// For every node of the wall, in the order of `followers`, its position in the list of loaded nodes of the flow.
    loaded: Vec<usize>,
}

impl Interface {
    /// The interface with the wall nodes `pairs`: a C0 node of the solid and one of the flow's mesh. The flow loads the nodes `loaded` of
    /// its mesh, in increasing order. A pair whose node is not loaded only moves.
    pub fn new(pairs: &[(usize, usize)], loaded: &[usize]) -> Self {
        let position = |pair: &(usize, usize)| loaded.binary_search(&pair.1).ok();
        let follower = |&(solid, node): &(usize, usize)| Follower { solid, node, weight: 1.0 };
        let (wet, dry): (Vec<_>, Vec<_>) = pairs.iter().partition(|pair| position(pair).is_some());
        let followers = wet.iter().chain(&dry).map(follower).collect();
        Interface { followers, loaded: wet.iter().filter_map(position).collect() }
    }

    /// The same with more nodes that move with the solid.
    pub fn with_followers(mut self, followers: impl IntoIterator<Item = Follower>) -> Self {
        self.followers.extend(followers);
        self
    }

    /// Adds the displacement `d` of the solid to the field `out` of the flow's mesh, both `[C0 node][component]`, in `dimension`
    /// directions.
    pub(super) fn add_displacement(&self, dimension: usize, d: &[f64], out: &mut [f64]) {
        for Follower { solid, node, weight } in &self.followers {
            let (from, to) = (solid * dimension, node * dimension);
            (0..dimension).for_each(|i| out[to + i] += weight * d[from + i]);
        }
    }

    /// For every node of the wall the node of the solid and its position in the list of loaded nodes.
    pub(super) fn wall(&self) -> impl Iterator<Item = (usize, usize)> {
        self.followers.iter().zip(&self.loaded).map(|(follower, loaded)| (follower.solid, *loaded))
    }
}
