//! The flow in planes.
//!
//! Each cell is divided into parts, and these into tetrahedra of the reference cell. The edges of a tetrahedron that end on both sides of the
//! plane are cut where the curved cell crosses it. So corners lie on the plane, and their values come from the coefficients of the cell.

use super::cells::{StateInCells, StateSource};
use super::probes::{CellAtPoints, FlowAtPoints, names};
use case::Slice;
use fem::parallel::{self, Grain};
use mesh::{CellMap, Mesh};
use output::{FieldSpec, PolyData};
use report::fields;
use report::simplices::{crossings, simplices};
use std::collections::BTreeMap;
use tensor::{dot, norm};

/// Distances below this fraction of the size of a cell are round-off.
const ROUND_OFF: f64 = 1e-12;

/// Steps of the search for a crossing; it ends much earlier.
const STEPS: usize = 60;

/// The cut of the mesh with a plane, and the flow there.
pub fn cut<const D: usize, const M: usize>(flow: &FlowAtPoints<D>, slice: &Slice<D>, source: &StateSource) -> PolyData {
    let mesh = &flow.mover.reference;
    let plane = Plane { point: slice.point, normal: slice.normal };
    let lattice = basis::equidistant_points(slice.parts + 1);
    let map = CellMap::<D>::on_grid(flow.mover.reference.order(), &lattice);
    let tetrahedra = simplices::<D>(slice.parts);
    let faces = outer_faces(mesh);
    let of_plane = |cell| {
        let heights = plane.heights(&map.positions(&flow.nodes(cell)));
        let (plane, heights) = plane.seen(heights, faces.get(&cell).map_or(&[][..], |faces| faces), lattice.len())?;
        Some((cell, plane, heights))
    };
    let cut = parallel::map(mesh.n_cells(), Grain::Any, &of_plane);
    let cut: Vec<(usize, Plane<D>, Vec<f64>)> = cut.into_iter().flatten().collect();
    let state = source(cut.iter().map(|(cell, ..)| *cell).collect());
    let of_cell = |(cell, plane, heights): &(usize, Plane<D>, Vec<f64>)| {
        Piece::of::<M>(&flow.cell(*cell), &state, slice, (plane, heights.clone()), (&lattice, &tetrahedra))
    };
    let pieces = parallel::map(cut.len(), Grain::Any, &|number| of_cell(&cut[number]));
    joined::<D>(flow, slice, &pieces)
}

/// The faces of cells where the mesh ends: at boundaries, and at periodic ones, whose other side lies elsewhere.
fn outer_faces<const D: usize>(mesh: &Mesh<D>) -> BTreeMap<usize, Vec<usize>> {
    let periodic = mesh.interior_facets().iter().filter(|facet| facet.periodic);
    let sides = periodic.flat_map(|facet| [facet.minus, facet.plus]);
    let mut faces: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for side in mesh.boundary_facets().iter().map(|facet| facet.side).chain(sides) {
        faces.entry(side.cell).or_default().push(side.face);
    }
    faces
}

/// A plane with its unit normal.
#[derive(Clone, Copy)]
struct Plane<const D: usize> {
    point: [f64; D],
    normal: [f64; D],
}

impl<const D: usize> Plane<D> {
    fn height(&self, x: &[f64; D]) -> f64 {
        dot(&self.normal, &std::array::from_fn(|i| x[i] - self.point[i]))
    }

    /// The heights of the points of a cell at `positions`.
    fn heights(&self, positions: &[[f64; D]]) -> Vec<f64> {
        let size = norm(&std::array::from_fn::<f64, D, _>(|i| positions[positions.len() - 1][i] - positions[0][i]));
        let snapped = |height: f64| if height.abs() <= ROUND_OFF * size { 0.0 } else { height };
        positions.iter().map(|x| snapped(self.height(x))).collect()
    }

    /// The plane and the heights above it of a cell that it cuts. Points on the plane count to its upper side, so that a face between two cells
    /// is cut once. Where one of the outer `faces` lies on the plane and the cell above it, nothing is below: the plane is seen from
    /// the other side. A lattice has `n` points per direction.
    fn seen(&self, heights: Vec<f64>, faces: &[usize], n: usize) -> Option<(Self, Vec<f64>)> {
        if heights.iter().any(|h| *h < 0.0) {
            return heights.iter().any(|h| *h >= 0.0).then_some((*self, heights));
        }
        let is_on_plane = |face: &usize| mesh::face_nodes(D, n, *face).into_iter().all(|node| heights[node] == 0.0);
        let other_side = Plane { point: self.point, normal: self.normal.map(|n| -n) };
        faces.iter().any(is_on_plane).then(|| (other_side, heights.iter().map(|h| -h).collect()))
    }
}

/// The cut of a cell.
#[derive(Default)]
struct Piece<const D: usize> {
    points: Vec<[f64; D]>,
    /// `[point][column]`
    values: Vec<Vec<f64>>,
    polygons: Vec<Vec<usize>>,
}

impl<const D: usize> Piece<D> {
    fn of<const M: usize>(
        cell: &CellAtPoints<'_, '_, D>,
        state: &StateInCells,
        slice: &Slice<D>,
        (plane, heights): (&Plane<D>, Vec<f64>),
        (lattice, tetrahedra): (&[f64], &[Vec<usize>]),
    ) -> Self {
        let mut piece = Piece { points: Vec::new(), values: Vec::new(), polygons: Vec::new() };
        let n = lattice.len();
        let xi = |k: usize| -> [f64; D] { std::array::from_fn(|i| lattice[k / n.pow(i as u32) % n]) };
        let mut known = BTreeMap::new();
        for corners in tetrahedra {
            let edges = crossings(corners, |corner| heights[corner]);
            let mut corner = |&(below, above, _): &(usize, usize, f64)| {
                // A corner of the lattice on the plane is the end of several edges.
                let edge = if heights[above] == 0.0 { (above, above) } else { (below, above) };
                *known.entry(edge).or_insert_with(|| {
                    let at = crossing(cell, plane, [xi(below), xi(above)], [heights[below], heights[above]]);
                    piece.points.push(cell.position(&at));
                    piece.values.push(cell.values::<M>(state, &at, &slice.fields));
                    piece.points.len() - 1
                })
            };
            piece.polygons.extend(polygon(edges.iter().map(&mut corner).collect()));
        }
        piece
    }
}

/// The corners of a cut in their order, without those that occur twice.
fn polygon(mut corners: Vec<usize>) -> Option<Vec<usize>> {
    if corners.len() == 4 {
        corners.swap(2, 3);
    }
    corners.dedup();
    if corners.len() > 1 && corners.first() == corners.last() {
        corners.pop();
    }
    (corners.len() >= 3).then_some(corners)
}

/// The reference point between two `ends` below and above the plane at which the cell crosses it, by the Illinois method.
fn crossing<const D: usize>(
    cell: &CellAtPoints<'_, '_, D>,
    plane: &Plane<D>,
    ends: [[f64; D]; 2],
    heights: [f64; 2],
) -> [f64; D] {
    let at = |part: f64| -> [f64; D] { std::array::from_fn(|i| ends[0][i] + part * (ends[1][i] - ends[0][i])) };
    let ([mut a, mut b], [mut below, mut above]) = ([0.0, 1.0], heights);
    let (small, mut last) = (1e-15 * (above - below), 0.0);
    for _ in 0..STEPS {
        if above == 0.0 || b - a <= f64::EPSILON {
            return at(b);
        }
        let part = a - below * (b - a) / (above - below);
        let height = plane.height(&cell.position(&at(part)));
        if height.abs() <= small {
            return at(part);
        }
        // An end that stays twice has its height halved.
        if height < 0.0 {
            (a, below) = (part, height);
            above *= if last < 0.0 { 0.5 } else { 1.0 };
        } else {
            (b, above) = (part, height);
            below *= if last > 0.0 { 0.5 } else { 1.0 };
        }
        last = height;
    }
    at(a - below * (b - a) / (above - below))
}

/// All pieces in one.
fn joined<const D: usize>(flow: &FlowAtPoints<D>, slice: &Slice<D>, pieces: &[Piece<D>]) -> PolyData {
    let mut all = PolyData::default();
    for piece in pieces {
        let first = all.points.len() / 3;
        all.points.extend(piece.points.iter().flat_map(|x| (0..3).map(|i| x.get(i).copied().unwrap_or(0.0))));
        all.polygons.extend(piece.polygons.iter().map(|corners| corners.iter().map(|c| first + c).collect()));
    }
    let rows = || pieces.iter().flat_map(|piece| &piece.values);
    let mut first = 0;
    let of_fields = slice.fields.iter().map(|field| fields::spec(*field, D));
    for spec in of_fields.chain(flow.formulas.iter().map(|formula| FieldSpec::scalar(&formula.name))) {
        let columns = first..first + spec.components;
        first = columns.end;
        all.fields.push((spec, rows().flat_map(|row| row[columns.clone()].iter().copied()).collect()));
    }
    debug_assert_eq!(first, names::<D>(&slice.fields, flow.formulas).count());
    all
}
