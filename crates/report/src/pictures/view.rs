//! The view of a run: its windows, and the pictures in them.

use super::drawn::{Drawn, extremes};
use super::encode::colour_numbers;
use super::lines::Lines;
use super::near_walls::{Wall, windows};
use super::quantity::{Quantity, Range};
use super::raster::Raster;
use super::snapshot::{PARTS, Snapshot};
use super::space::Space;
use super::surface::{face_lines, surface};
use super::window::{Extent, Window};
use crate::html::short;
use output::ResultReader;

/// Boundaries: visible on light and on dark backgrounds.
const OUTLINE_COLOUR: [u8; 3] = [110, 110, 110];

/// Widths of lines, in pixels.
const MESH_LINE: f64 = 0.9;
const OUTLINE: f64 = 1.8;

/// Edges of cells at this distance, in pixels, and more are drawn in full strength. With smaller cells the picture would be
/// black.
const WIDE_CELL: f64 = 14.0;

/// The view of a run.
pub struct View<const D: usize> {
    /// The windows.
    pub windows: Vec<Window>,
    /// In three dimensions: the plane z = height that is shown.
    pub height: Option<f64>,
    /// The faces of each cell that lie on a boundary.
    boundary_faces: Vec<Vec<usize>>,
    /// The pictures of surfaces in space, if there are some.
    space: Option<Space>,
}

impl<const D: usize> View<D> {
    /// Chooses the windows such that they show all snapshots. `q_level` is the Q of the surfaces in space, if it is given.
    pub fn new<const M: usize>(reader: &ResultReader, snapshots: &[Snapshot<D>], q_level: Option<f64>) -> Self {
        let mesh = &reader.metadata.mesh;
        let cells = reader.layout.grid.cells;
        let mut boundary_faces = vec![Vec::new(); cells];
        mesh.boundary_facets.iter().for_each(|&[cell, face, _]| boundary_faces[cell as usize].push(face as usize));
        let corners = |snapshot: &Snapshot<D>| (0..cells).flat_map(|cell| snapshot.cell_box(cell)).collect::<Vec<_>>();
        let corners: Vec<[f64; D]> = snapshots.iter().flat_map(corners).collect();
        let domain = Extent::of(corners.iter().map(|x| [x[0], x[1]]));
        let height = middle(&corners);
        let (walls, known) = walls(reader, snapshots, height);
        let mut windows = windows(domain, &walls, known, snapshots);
        if let Some(height) = height {
            let note =
                format!("Shown is the cut of the three-dimensional domain with the plane z = {}.", short(height));
            windows.iter_mut().for_each(|window| window.note.clone_from(&note));
        }
        let space = Space::new::<D, M>(reader, snapshots, q_level);
        windows.extend(space.iter().flat_map(|space| space.windows.iter().cloned()));
        View { windows, height, boundary_faces, space }
    }

    /// A window at a snapshot, and how far it has moved.
    fn window(&self, window: &Window, snapshot: &Snapshot<D>) -> (Window, [f64; 2]) {
        let by = window.follows.as_ref().map_or([0.0; 2], |track| track.shift(snapshot));
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

    /// The pictures of the plane in a window.
    fn draw_plane<const M: usize>(
        &self,
        snapshot: &Snapshot<D>,
        window: &Window,
        quantities: &[(Quantity, Range)],
    ) -> Drawn {
        let raster = self.raster::<M>(snapshot, window);
        let numbers = |(q, (_, range)): (usize, &(Quantity, Range))| colour_numbers(raster.of(q), *range);
        let (mesh, outline) = self.lines(snapshot, window);
        Drawn {
            numbers: quantities.iter().enumerate().map(numbers).collect(),
            extremes: (0..quantities.len()).map(|q| extremes(raster.of(q))).collect(),
            mesh,
            outline,
            outline_colour: OUTLINE_COLOUR,
            strongest: 1.0,
        }
    }

    /// The pictures of a snapshot in some of the windows, and how far each window has moved. M = D + 2.
    pub fn draw<const M: usize>(
        &self,
        snapshot: &Snapshot<D>,
        windows: &[Window],
        quantities: &[(Quantity, Range)],
    ) -> Vec<(Drawn, [f64; 2])> {
        let in_space = windows.iter().any(|window| window.camera.is_some());
        let scene = self.space.as_ref().filter(|_| in_space).map(|space| space.scene::<D, M>(snapshot));
        let draw = |window: &Window| match (&window.camera, &scene) {
            (Some(camera), Some(scene)) => (scene.draw(window, camera, quantities), [0.0; 2]),
            _ => {
                let (window, shift) = self.window(window, snapshot);
                (self.draw_plane::<M>(snapshot, &window, quantities), shift)
            }
        };
        windows.iter().map(draw).collect()
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
                .then(|| (cell, Snapshot::<D>::fineness(cell_box.length() * window.scale()).min(snapshot.finest())))
        };
        (0..self.boundary_faces.len()).filter_map(seen).collect()
    }
}

/// In three dimensions the middle of the z of `corners`, slightly shifted. On the faces of cells it would be arbitrary which
/// cell the plane belongs to.
fn middle<const D: usize>(corners: &[[f64; D]]) -> Option<f64> {
    let z = || corners.iter().map(|x| x[D - 1]);
    let (lower, upper) = (z().fold(f64::INFINITY, f64::min), z().fold(f64::NEG_INFINITY, f64::max));
    (D == 3).then_some(lower + 0.501 * (upper - lower))
}

/// The walls that the plane z = `height` meets, or all boundaries if the case does not tell the walls; whether it does.
fn walls<const D: usize>(reader: &ResultReader, snapshots: &[Snapshot<D>], height: Option<f64>) -> (Vec<Wall>, bool) {
    let metadata = &reader.metadata;
    let names = &metadata.mesh.boundary_names;
    let known = case::walls_of(&metadata.case_text, names);
    let chosen = |index: &usize| known.is_empty() || known.contains(&&names[*index][..]);
    let facets = |index: usize| -> Vec<[usize; 2]> {
        let of_wall = metadata.mesh.boundary_facets.iter().filter(|facet| facet[2] as usize == index);
        of_wall.map(|&[cell, face, _]| [cell as usize, face as usize]).collect()
    };
    let wall = |index: usize| Wall::new(&names[index], facets(index), snapshots, height);
    ((0..names.len()).filter(chosen).map(wall).collect(), !known.is_empty())
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
