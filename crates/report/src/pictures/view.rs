//! The view of a run: its windows, and the pictures in them.

use super::encode::{colour_numbers, line_layer, picture};
use super::lines::Lines;
use super::quantity::{Quantity, Range};
use super::raster::Raster;
use super::snapshot::{PARTS, Snapshot};
use super::surface::{face_lines, surface};
use super::window::{Extent, Window, bodies, following, windows};
use super::{Encoded, Picture};
use output::ResultReader;

/// Edges of cells.
const MESH_COLOUR: [u8; 3] = [0, 0, 0];
/// Boundaries: visible on light and on dark backgrounds.
const OUTLINE_COLOUR: [u8; 3] = [110, 110, 110];

/// Widths of lines, in pixels.
const MESH_LINE: f64 = 0.9;
const OUTLINE: f64 = 1.8;

/// Edges of cells at this distance, in pixels, and more are drawn in full strength. With smaller cells the picture would be
/// black.
const WIDE_CELL: f64 = 14.0;

/// Bodies that move by less than this part of their length do not need a window that moves with them.
const VISIBLE: f64 = 0.02;

/// The view of a run.
pub struct View<const D: usize> {
    /// The windows.
    pub windows: Vec<Window>,
    /// In three dimensions: the plane z = height that is shown.
    pub height: Option<f64>,
    /// The translation of the bodies at each snapshot, since the first.
    shifts: Vec<[f64; 2]>,
    /// The faces of each cell that lie on a boundary.
    boundary_faces: Vec<Vec<usize>>,
}

impl<const D: usize> View<D> {
    /// Chooses the windows such that they show all snapshots.
    pub fn new(reader: &ResultReader, snapshots: &[Snapshot<D>]) -> Self {
        let mesh = &reader.metadata.mesh;
        let cells = reader.layout.grid.cells;
        let mut boundary_faces = vec![Vec::new(); cells];
        let mut boundaries = vec![Extent::EMPTY; mesh.boundary_names.len()];
        let facets: Vec<[usize; 3]> = mesh.boundary_facets.iter().map(|facet| facet.map(|i| i as usize)).collect();
        for &[cell, face, boundary] in &facets {
            boundary_faces[cell].push(face);
            for snapshot in snapshots {
                boundaries[boundary] = boundaries[boundary].union(face_box(snapshot, cell, face));
            }
        }
        let corners = |snapshot: &Snapshot<D>| (0..cells).flat_map(|cell| snapshot.cell_box(cell)).collect::<Vec<_>>();
        let corners: Vec<[f64; D]> = snapshots.iter().flat_map(corners).collect();
        let domain = Extent::of(corners.iter().map(|x| [x[0], x[1]]));
        let bodies = bodies(domain, &boundaries);
        let near = bodies.iter().fold(Extent::EMPTY, |near, &body| near.union(boundaries[body]));
        let facets: Vec<[usize; 2]> = facets
            .iter()
            .filter(|[.., boundary]| bodies.contains(boundary))
            .map(|&[cell, face, _]| [cell, face])
            .collect();
        let (shifts, following) = follow(snapshots, &facets);
        let mut windows = windows(domain, near);
        let whole = windows.len() - 1;
        windows.splice(whole..whole, following);
        View { windows, shifts, height: middle(&corners), boundary_faces }
    }

    /// A window at a snapshot, and how far it has moved.
    pub fn window(&self, window: &Window, snapshot: usize) -> (Window, [f64; 2]) {
        let by = if window.follows { self.shifts[snapshot] } else { [0.0; 2] };
        (window.shifted(by), by)
    }

    /// All quantities in a window. M = D + 2.
    pub fn raster<const M: usize>(&self, snapshot: &Snapshot<D>, window: &Window) -> Raster {
        let mut raster = None;
        for (cell, fineness) in self.visible(snapshot, window) {
            let patch = snapshot.patch::<M>(cell, fineness);
            let quantities = patch.values.len() / patch.points.len();
            let raster = raster.get_or_insert_with(|| Raster::new(window, quantities));
            raster.draw(window, &surface(&patch, self.height.unwrap_or(0.0)));
        }
        raster.unwrap_or_else(|| Raster::new(window, 1))
    }

    /// The pictures in a window.
    ///
    /// # Errors
    /// As [`picture`].
    pub fn encode<const M: usize>(
        &self,
        snapshot: &Snapshot<D>,
        (window, shift): (&Window, [f64; 2]),
        quantities: &[(Quantity, Range)],
    ) -> Result<Encoded, png::EncodingError> {
        let raster = self.raster::<M>(snapshot, window);
        let encode = |(q, (quantity, range)): (usize, &(Quantity, Range))| -> Result<Picture, png::EncodingError> {
            let numbers = colour_numbers(raster.of(q), *range);
            let uri = picture(raster.width, raster.height, &numbers, quantity.colours())?;
            Ok(Picture { uri, extremes: extremes(raster.of(q)) })
        };
        let (mesh, outline) = self.lines(snapshot, window);
        Ok(Encoded {
            pictures: quantities.iter().enumerate().map(encode).collect::<Result<_, _>>()?,
            mesh: line_layer(&mesh, MESH_COLOUR)?,
            outline: line_layer(&outline, OUTLINE_COLOUR)?,
            shift,
        })
    }

    /// The edges of the cells, and the edges on a boundary.
    fn lines(&self, snapshot: &Snapshot<D>, window: &Window) -> (Lines, Lines) {
        let (mut mesh, mut outline) = (Lines::new(window), Lines::new(window));
        for (cell, fineness) in self.visible(snapshot, window) {
            let points = snapshot.points(cell, fineness);
            let strength = 0.6 * (thickness(&points) * window.scale() / WIDE_CELL).clamp(0.1, 1.0);
            for face in 0..2 * D {
                for line in face_lines(&points, PARTS[fineness], face, self.height.unwrap_or(0.0)) {
                    mesh.draw(window, line, MESH_LINE, strength);
                    if self.boundary_faces[cell].contains(&face) {
                        outline.draw(window, line, OUTLINE, 1.0);
                    }
                }
            }
        }
        (mesh, outline)
    }

    /// The cells visible in a window, and how finely they are evaluated.
    fn visible(&self, snapshot: &Snapshot<D>, window: &Window) -> Vec<(usize, usize)> {
        let seen = |cell: usize| {
            let [lower, upper] = snapshot.cell_box(cell);
            let cell_box = Extent { lower: [lower[0], lower[1]], upper: [upper[0], upper[1]] };
            // A curved cell may extend beyond the box of its nodes.
            let bulge = 0.1 * (0..D).map(|d| upper[d] - lower[d]).fold(0.0, f64::max);
            let in_plane = |z: f64| lower[D - 1] - bulge <= z && z <= upper[D - 1] + bulge;
            let inside = !cell_box.grown([bulge; 2]).intersection(window.extent).is_empty();
            (inside && self.height.is_none_or(in_plane))
                .then(|| (cell, Snapshot::<D>::fineness(cell_box.length() * window.scale())))
        };
        (0..self.boundary_faces.len()).filter_map(seen).collect()
    }
}

/// How far the faces of bodies have moved at each snapshot, and a window that moves with them, if they move visibly.
fn follow<const D: usize>(snapshots: &[Snapshot<D>], facets: &[[usize; 2]]) -> (Vec<[f64; 2]>, Option<Window>) {
    let boxes =
        |snapshot: &Snapshot<D>| facets.iter().map(|&[cell, face]| face_box(snapshot, cell, face)).collect::<Vec<_>>();
    let centre = |boxes: &[Extent]| {
        let sum = |i: usize| boxes.iter().map(|face| 0.5 * (face.lower[i] + face.upper[i])).sum::<f64>();
        [0, 1].map(|i| sum(i) / boxes.len() as f64)
    };
    let boxes: Vec<Vec<Extent>> = snapshots.iter().map(boxes).collect();
    let centres: Vec<[f64; 2]> = boxes.iter().map(|boxes| centre(boxes)).collect();
    let shifts: Vec<[f64; 2]> = centres.iter().map(|c| [c[0] - centres[0][0], c[1] - centres[0][1]]).collect();
    let back = |(faces, by): (&Vec<Extent>, &[f64; 2])| {
        faces.iter().fold(Extent::EMPTY, |all, face| all.union(face.shifted([-by[0], -by[1]])))
    };
    let at_first = boxes.iter().zip(&shifts).map(back).fold(Extent::EMPTY, Extent::union);
    let farthest = shifts.iter().map(|by| by[0].hypot(by[1])).fold(0.0, f64::max);
    let moves = !facets.is_empty() && farthest > VISIBLE * at_first.length();
    (shifts, moves.then(|| following(at_first)))
}

/// In three dimensions the middle of the z of `corners`, slightly shifted. On the faces of cells it would be arbitrary which
/// cell the plane belongs to.
fn middle<const D: usize>(corners: &[[f64; D]]) -> Option<f64> {
    let z = || corners.iter().map(|x| x[D - 1]);
    let (lower, upper) = (z().fold(f64::INFINITY, f64::min), z().fold(f64::NEG_INFINITY, f64::max));
    (D == 3).then_some(lower + 0.501 * (upper - lower))
}

/// The box around a face.
fn face_box<const D: usize>(snapshot: &Snapshot<D>, cell: usize, face: usize) -> Extent {
    let points = snapshot.points(cell, 0);
    Extent::of(mesh::face_nodes(D, PARTS[0] + 1, face).into_iter().map(|node| [points[node][0], points[node][1]]))
}

/// The smallest distance between the centres of opposite faces, projected to the plane.
fn thickness<const D: usize>(points: &[[f64; D]]) -> f64 {
    let n = (points.len() as f64).powf(1.0 / D as f64).round() as usize;
    let middle = |axis: usize, side: usize| -> [f64; D] {
        let digit = |a: usize| if a == axis { side * (n - 1) } else { n / 2 };
        points[(0..D).map(|a| digit(a) * n.pow(a as u32)).sum::<usize>()]
    };
    let distance = |axis: usize| {
        let (a, b) = (middle(axis, 0), middle(axis, 1));
        (b[0] - a[0]).hypot(b[1] - a[1])
    };
    // An axis out of the plane is not visible.
    let distances = (0..D).map(distance);
    let longest = distances.clone().fold(0.0, f64::max);
    distances.filter(|distance| *distance > 1e-6 * longest).fold(longest, f64::min)
}

fn extremes(values: impl Iterator<Item = f32>) -> Option<[f32; 2]> {
    let extend = |range: Option<[f32; 2]>, value: f32| {
        let [lower, upper] = range.unwrap_or([value; 2]);
        Some([lower.min(value), upper.max(value)])
    };
    values.filter(|value| value.is_finite()).fold(None, extend)
}
