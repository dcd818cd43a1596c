//! The points of the cross-section of a wall along its curves: in the plane those of the wall itself, in space those of a wall that is extruded
//! along z.

use super::curve::{Arc, Curve, chained, curves, facets_of, integrals, lengths_up_to};
use basis::Rule;
use mesh::{Mesh, NodeNumbering, Strip, clusters};
use std::collections::BTreeMap;

/// The cross-section of a wall.
#[derive(Clone, Debug, PartialEq)]
pub struct Section {
    /// Its curves. In space each of their facets is a stack of facets behind each other.
    pub curves: Vec<Curve>,
    /// The rows of a distribution at each point, curve after curve.
    pub rows: Vec<Vec<usize>>,
    /// In space, for each point: the length at rest up to it, and its part of the length.
    pub lengths: Vec<[f64; 2]>,
}

impl Section {
    /// That of the wall `boundary` with the points of `rule`. `None` if it is not extruded along z.
    pub fn new<const D: usize>(
        mesh: &Mesh<D>,
        numbering: &NodeNumbering,
        boundary: usize,
        rule: &Rule,
    ) -> Option<Self> {
        let facets = facets_of(mesh, boundary);
        if D == 2 {
            let rows = (0..facets.len() * rule.points.len()).map(|row| vec![row]).collect();
            return Some(Section { curves: curves(mesh, numbering, &facets), rows, lengths: Vec::new() });
        }
        let tolerance = mesh.same_place();
        let strips: Option<Vec<Strip>> =
            facets.iter().map(|facet| mesh.strip(numbering, facet.side, &rule.points, tolerance)).collect();
        Some(Self::extruded(&strips?, rule, tolerance))
    }

    fn extruded(strips: &[Strip], rule: &Rule, tolerance: f64) -> Self {
        let places = places(strips, tolerance);
        let mut stacks: BTreeMap<&[usize], Vec<usize>> = BTreeMap::new();
        for (facet, ends) in places.chunks_exact(2).enumerate() {
            stacks.entry(ends).or_default().push(facet);
        }
        let stacks: Vec<Vec<usize>> = stacks.into_values().collect();
        let nodes = joined(strips, places.clone());
        let arc = |(number, stack): (usize, &Vec<usize>)| {
            let first = stack[0];
            Arc { ends: [nodes[2 * first], nodes[2 * first + 1]], positions: strips[first].ends, facet: number }
        };
        let curves = chained(stacks.iter().enumerate().map(arc).collect());
        let in_order = || curves.iter().flat_map(|curve| &curve.facets).map(|&number| &stacks[number][..]);
        let rows = in_order().flat_map(|stack| rows_of(strips, stack)).collect();
        let lengths = lengths(in_order().map(|stack| &strips[stack[0]]), rule);
        Section { rows, lengths, curves }
    }
}

/// The rows at each point of the arc of a `stack`.
fn rows_of(strips: &[Strip], stack: &[usize]) -> Vec<Vec<usize>> {
    let n = strips[stack[0]].lines.len();
    let line = |facet: usize, k: usize| strips[facet].lines[k].iter().map(move |point| facet * n * n + point);
    (0..n).map(|k| stack.iter().flat_map(|&facet| line(facet, k)).collect()).collect()
}

/// The length up to each point of the arcs of `strips`, one after the other, and its part.
fn lengths<'a>(strips: impl Iterator<Item = &'a Strip>, rule: &Rule) -> Vec<[f64; 2]> {
    let (up_to_points, mut start) = (integrals(rule), 0.0);
    let of_arc = |strip: &Strip| -> Vec<[f64; 2]> {
        let places = lengths_up_to(&strip.speeds, &up_to_points, start);
        let parts = strip.speeds.iter().zip(&rule.weights).map(|(speed, weight)| speed * weight);
        let arc: Vec<[f64; 2]> = places.into_iter().zip(parts).map(<[f64; 2]>::from).collect();
        start += arc.iter().map(|[_, part]| part).sum::<f64>();
        arc
    };
    strips.flat_map(of_arc).collect()
}

/// The numbers of the positions in the plane of both ends of every strip.
fn places(strips: &[Strip], tolerance: f64) -> Vec<usize> {
    let ends: Vec<&[f64]> = strips.iter().flat_map(|strip| strip.ends.iter().map(|end| &end[..])).collect();
    let mut places = vec![0; ends.len()];
    for (number, group) in clusters(&ends, tolerance).into_iter().enumerate() {
        group.into_iter().for_each(|end| places[end] = number);
    }
    places
}

/// The `places` of the ends, one for both positions of the nodes of a periodic boundary.
fn joined(strips: &[Strip], mut places: Vec<usize>) -> Vec<usize> {
    let mut first = BTreeMap::new();
    for (end, nodes) in strips.iter().flat_map(|strip| &strip.end_nodes).enumerate() {
        for node in nodes {
            let (here, there) = (places[end], places[*first.entry(*node).or_insert(end)]);
            if here != there {
                places.iter_mut().filter(|place| **place == here).for_each(|place| *place = there);
            }
        }
    }
    places
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use basis::gauss;
    use mesh::{BoxMesh, Curving};

    /// The bottom of a box of two layers along z.
    fn bottom(is_periodic: bool) -> Section {
        let (lower, upper, curving) = ([0.0; 3], [2.0, 1.0, 0.5], Curving::None);
        let mesh = BoxMesh { lower, upper, cells: [4, 1, 2], order: 2, curving, periodic: [is_periodic, false, true] };
        let mesh = mesh.build().unwrap().scrambled(5);
        let boundary = mesh.boundary_names().iter().position(|name| name == "bottom").unwrap();
        Section::new(&mesh, &NodeNumbering::new(&mesh, 3), boundary, &gauss(3)).unwrap()
    }

    /// All jumps of an extruded wall were zero.
    #[test]
    fn an_extruded_wall_jumps_where_it_is_periodic() {
        let section = bottom(true);
        let [curve] = &section.curves[..] else { panic!("one curve") };
        // The gas is above, on the right, so the curve runs to smaller x. It begins at the largest one.
        assert!(curve.is_closed);
        assert_eq!(curve.jumps, [[2.0, 0.0], [0.0; 2], [0.0; 2], [0.0; 2]]);
    }

    /// A wall with ends had no points at all.
    #[test]
    fn an_open_wall_has_points_behind_each_other_and_lengths() {
        let section = bottom(false);
        let [curve] = &section.curves[..] else { panic!("one curve") };
        assert!(!curve.is_closed);
        assert_eq!((section.rows.len(), section.rows[0].len()), (12, 6));
        let mut all = section.rows.concat();
        all.sort_unstable();
        assert_eq!(all, (0..72).collect::<Vec<_>>());
        let points = gauss(3).on(0.0, 0.5).points;
        for (k, [length, _]) in section.lengths.iter().enumerate() {
            assert!((length - (k / 3) as f64 * 0.5 - points[k % 3]).abs() < 1e-14, "{k}: {length}");
        }
        assert!((section.lengths.iter().map(|[_, part]| part).sum::<f64>() - 2.0).abs() < 1e-14);
    }
}
