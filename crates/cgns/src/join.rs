//! Zones with common vertices.
//!
//! An outer face without a name is joined to others: its corners become one vertex with the corners of such faces at the
//! same positions. So zones are joined to each other and, at the cut of a C-mesh or an O-mesh, to themselves. The two sides of a thin plate
//! have names and stay apart.

use crate::faces::{self, Face};
use crate::lists::Lists;
use std::collections::BTreeMap;

/// Positions are the same up to this times the shortest edge of a face there.
const TOLERANCE: f64 = 1e-4;

/// A direction that is normal to no plane of a usual mesh: vertices are sorted along it.
const DIRECTION: [f64; 3] = [0.537, 0.728, 0.426];

/// A vertex that may be joined to others.
struct Candidate {
    vertex: usize,
    position: [f64; 3],
    along: f64,
    tolerance: f64,
}

/// Joins the zones.
pub(crate) fn join(lists: &mut Lists) {
    let candidates = candidates(lists);
    let mut same: BTreeMap<usize, usize> = BTreeMap::new();
    for (index, one) in candidates.iter().enumerate() {
        let near = candidates[index + 1..].iter().take_while(|other| other.along - one.along <= one.tolerance);
        for other in near.filter(|other| coincide(one, other)) {
            let (one, other) = (representative(&same, one.vertex), representative(&same, other.vertex));
            if one != other {
                same.insert(one.max(other), one.min(other));
            }
        }
    }
    if !same.is_empty() {
        let nodes = lists.lists.elements.iter_mut().flat_map(|element| &mut element.nodes);
        nodes.for_each(|node| *node = representative(&same, *node));
    }
}

/// The corners of outer faces without a name, along [`DIRECTION`].
fn candidates(lists: &Lists) -> Vec<Candidate> {
    let mut shortest: BTreeMap<usize, f64> = BTreeMap::new();
    for face in lists.outer_faces(0).iter().filter(|face| !lists.named.contains(&faces::key(face))) {
        let edge = shortest_edge(&lists.lists.nodes, face);
        for &vertex in face {
            let length = shortest.entry(vertex).or_insert(edge);
            *length = length.min(edge);
        }
    }
    let candidate = |(vertex, edge): (usize, f64)| {
        let position = lists.lists.nodes[vertex];
        let along = position.iter().zip(DIRECTION).map(|(x, direction)| x * direction).sum();
        Candidate { vertex, position, along, tolerance: TOLERANCE * edge }
    };
    let mut candidates: Vec<Candidate> = shortest.into_iter().map(candidate).collect();
    candidates.sort_by(|one, other| one.along.total_cmp(&other.along));
    candidates
}

fn shortest_edge(nodes: &[[f64; 3]], face: &Face) -> f64 {
    let ends = (0..face.len()).map(|k| (face[k], face[(k + 1) % face.len()]));
    ends.map(|(from, to)| distance(&nodes[from], &nodes[to])).fold(f64::INFINITY, f64::min)
}

fn coincide(one: &Candidate, other: &Candidate) -> bool {
    distance(&one.position, &other.position) <= one.tolerance.min(other.tolerance)
}

fn distance(one: &[f64; 3], other: &[f64; 3]) -> f64 {
    one.iter().zip(other).map(|(x, y)| (x - y) * (x - y)).sum::<f64>().sqrt()
}

/// The vertex that represents `vertex` and all vertices joined to it: the first one.
fn representative(same: &BTreeMap<usize, usize>, mut vertex: usize) -> usize {
    while let Some(&earlier) = same.get(&vertex) {
        vertex = earlier;
    }
    vertex
}
