//! Boundaries that share a node must give it the same displacement.

use super::Time;
use super::displacement::check_displacement;
use super::mesh_crate::{Mesh, NodeNumbering, face_nodes};
use crate::checker::{Checked, Checker};
use crate::key::Key;
use std::collections::BTreeMap;

/// The distance below which two places of `mesh` are the same, for displacements by formulas.
pub(super) fn same_place<const D: usize>(mesh: &Mesh<D>) -> f64 {
    1e-9 * mesh.diameter()
}

/// The displacement of a node of a boundary, each component if it is prescribed, for (boundary, node, position at rest, time).
pub(super) type Displacement<'a, const D: usize> = dyn Fn(usize, usize, &[f64; D], f64) -> [Option<f64>; D] + 'a;

/// The boundaries of a mesh whose nodes are moved.
pub(super) struct SharedNodes<'a, const D: usize> {
    /// The source of errors.
    pub(super) checker: &'a Checker<'a>,
    /// The mesh.
    pub(super) mesh: &'a Mesh<D>,
    /// Its C0 nodes.
    pub(super) numbering: &'a NodeNumbering,
    /// The time that the run covers.
    pub(super) time: Time,
}

/// The first boundary that moves a node, the position at rest and the displacement.
#[derive(Clone, Copy)]
struct First<const D: usize> {
    boundary: usize,
    x: [f64; D],
    d: [Option<f64>; D],
}

impl<const D: usize> SharedNodes<'_, D> {
    /// Checks the displacements of all boundaries, given at `keys`. They must have values over the whole run, and agree at nodes that two
    /// boundaries share or that periodicity identifies.
    pub(super) fn check(&self, keys: &[Key], displacement: &Displacement<'_, D>) -> Checked<()> {
        self.time.check_times().into_iter().try_for_each(|t| self.check_at(t, keys, displacement))
    }

    fn check_at(&self, t: f64, keys: &[Key], displacement: &Displacement<'_, D>) -> Checked<()> {
        let (size, tolerance) = (self.mesh.diameter(), same_place(self.mesh));
        let mut moved: BTreeMap<usize, First<D>> = BTreeMap::new();
        for (boundary, key) in keys.iter().enumerate() {
            for (node, x) in nodes_on(self.mesh, self.numbering, boundary) {
                let d = displacement(boundary, node, &x, t);
                check_displacement(self.checker, key, &x, &d.map(|d| d.unwrap_or(0.0)), t, size)?;
                let first = *moved.entry(node).or_insert(First { boundary, x, d });
                let apart = |i: usize| matches!((d[i], first.d[i]), (Some(a), Some(b)) if (a - b).abs() > tolerance);
                if (0..D).any(apart) {
                    return Err(self.conflict(key, first, First { boundary, x, d }, t));
                }
                // Components that the first boundary leaves free may be prescribed by another one.
                moved.insert(node, First { d: std::array::from_fn(|i| first.d[i].or(d[i])), ..first });
            }
        }
        Ok(())
    }

    fn conflict(&self, key: &Key, first: First<D>, second: First<D>, t: f64) -> Box<crate::CaseError> {
        let name = |boundary: usize| &self.mesh.boundary_names()[boundary];
        if first.boundary == second.boundary {
            return not_periodic(self.checker, key, [first.x, second.x], [first.d, second.d], t);
        }
        let (a, b) = (plain(&first.d), plain(&second.d));
        let constants = self.checker.constants_in_words();
        let (one, other) = (name(first.boundary), name(second.boundary));
        let problem = format!(
            "boundaries `{one}` and `{other}` share the node at {:?}, but until t = {t} `{one}` moves it by {a} and `{other}` by {b}{constants}",
            second.x
        );
        let remedy = "motions that agree where boundaries meet: the same formulas for both, or a formula in x, y, z that is that of the other one there";
        self.checker.combination(key, &problem, remedy)
    }
}

/// The error of a displacement at `key` that is `d` at the positions `x` of one node until the time `t`.
pub(super) fn not_periodic<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    [from, other]: [[f64; D]; 2],
    d: [[Option<f64>; D]; 2],
    t: f64,
) -> Box<crate::CaseError> {
    let ([a, b], constants) = (d.map(|d| plain(&d)), checker.constants_in_words());
    let problem = format!(
        "the displacement is not periodic: {from:?} and {other:?} are one node of the mesh, but move by {a} and by {b} until t = {t}{constants}"
    );
    checker.combination(key, &problem, "a displacement with the period of the mesh")
}

/// A displacement as text, with `free` for components that are not prescribed.
fn plain<const D: usize>(d: &[Option<f64>; D]) -> String {
    let components = d.iter().map(|d| d.map_or_else(|| "free".to_owned(), |d| format!("{d:.3e}")));
    format!("[{}]", components.collect::<Vec<_>>().join(", "))
}

/// The C0 nodes on a boundary and their positions, facet by facet.
pub(super) fn nodes_on<const D: usize>(
    mesh: &Mesh<D>,
    numbering: &NodeNumbering,
    boundary: usize,
) -> impl Iterator<Item = (usize, [f64; D])> {
    let facets = mesh.boundary_facets().iter().filter(move |facet| facet.boundary == boundary);
    facets.flat_map(move |facet| {
        let (cell, face) = (facet.side.cell, facet.side.face);
        let (numbers, positions) = (numbering.cell(cell), mesh.cell_coordinates(cell));
        let node = |k: usize| (numbers[k], std::array::from_fn(|i| positions[k * D + i]));
        face_nodes(D, mesh.order(), face).into_iter().map(node)
    })
}

/// Two positions of one node, which periodicity identifies, where the values of the node differ by more than `tolerance`.
pub(super) fn periodic_copies_apart<const D: usize, const N: usize>(
    mesh: &Mesh<D>,
    numbering: &NodeNumbering,
    tolerance: f64,
    value: impl Fn(usize, &[f64; D]) -> [f64; N],
) -> Option<[[f64; D]; 2]> {
    let near = 1e-9 * mesh.diameter();
    let apart = |a: &[f64], b: &[f64], tolerance: f64| a.iter().zip(b).any(|(a, b)| (a - b).abs() > tolerance);
    let mut first: Vec<Option<[f64; D]>> = vec![None; numbering.count];
    for cell in 0..mesh.n_cells() {
        let (positions, _) = mesh.cell_coordinates(cell).as_chunks::<D>();
        for (&node, x) in numbering.cell(cell).iter().zip(positions) {
            let one = first[node].get_or_insert(*x);
            if apart(&one[..], x, near) && apart(&value(node, one), &value(node, x), tolerance) {
                return Some([*one, *x]);
            }
        }
    }
    None
}
