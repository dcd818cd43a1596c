//! The view of a run: its windows, and the pictures in them.

use super::bounds::Extent;
use super::bounds::{Cuboid, in_space};
use super::drawn::{Drawn, extremes};
use super::encode::colour_numbers;
use super::lines::LineLayer;
use super::near_walls::windows;
use super::plane::Plane;
use super::quantity::{PictureQuantity, Range};
use super::raster::Raster;
use super::scheme::PARTS;
use super::snapshot::Snapshot;
use super::space::{PictureRegion, Space};
use super::surface::{face_lines, surface};
use super::wall::Wall;
use super::window::Window;
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
    /// In three dimensions: the box through which cuts pass.
    pub near: Option<Cuboid>,
    /// The plane of the windows without a camera.
    pub plane: Plane,
    /// The faces of each cell that lie on a boundary.
    boundary_faces: Vec<Vec<usize>>,
    /// The pictures of surfaces in space, if there are some.
    space: Option<Space>,
    /// The box around the mesh in all snapshots.
    pub mesh: Cuboid,
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
        let plane = height.map_or(Plane::ALL_OF_2D, |at| Plane { axis: 2, at });
        let (walls, known) = walls(reader, snapshots, height);
        let mut windows = windows(domain, &walls, known, snapshots);
        if let Some(height) = height {
            let note =
                format!("Shown is the cut of the three-dimensional domain with the plane z = {}.", short(height));
            windows.iter_mut().for_each(|window| *window = Window { plane, note: note.clone(), ..window.clone() });
        }
        let region = height.map(|_| PictureRegion::new(reader, snapshots));
        let near = region.as_ref().map(|region| region.near);
        let space = region.and_then(|region| Space::new::<D, M>(region, snapshots, q_level));
        windows.extend(space.iter().flat_map(|space| space.windows.iter().cloned()));
        View { windows, near, plane, boundary_faces, space, mesh: Cuboid::of(corners.iter().map(in_space)) }
    }

    /// A window at a snapshot, and how far it has moved.
    fn window(&self, window: &Window, snapshot: &Snapshot<D>) -> (Window, [f64; 2]) {
        let by = window.follows.as_ref().map_or([0.0; 2], |track| track.shift(snapshot));
        (window.shifted(by), by)
    }

    /// All of the `count` quantities in a window. M = D + 2.
    pub fn raster<const M: usize>(&self, snapshot: &Snapshot<D>, window: &Window, count: usize) -> Raster {
        let mut raster = None;
        for (cell, fineness) in self.visible(snapshot, window) {
            let patch = snapshot.patch::<M>(cell, fineness);
            let quantities = patch.values.len() / patch.points.len();
            let raster = raster.get_or_insert_with(|| Raster::new(window, quantities));
            raster.draw(window, &surface(&patch, window.plane));
        }
        // A mesh that moves may have left the plane of a cut.
        raster.unwrap_or_else(|| Raster::new(window, count))
    }

    /// The pictures of the plane in a window.
    fn draw_plane<const M: usize>(
        &self,
        snapshot: &Snapshot<D>,
        window: &Window,
        quantities: &[(PictureQuantity, Range)],
    ) -> Drawn {
        let raster = self.raster::<M>(snapshot, window, quantities.len());
        let numbers = |(q, (_, range)): (usize, &(PictureQuantity, Range))| colour_numbers(raster.of(q), *range);
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
        quantities: &[(PictureQuantity, Range)],
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
    fn lines(&self, snapshot: &Snapshot<D>, window: &Window) -> (LineLayer, LineLayer) {
        let (mut mesh, mut outline) = (LineLayer::new(window), LineLayer::new(window));
        for (cell, fineness) in self.visible(snapshot, window) {
            let points = snapshot.points(cell, fineness);
            let strength = 0.6 * (thickness(&points, window.plane) * window.scale() / WIDE_CELL).clamp(0.1, 1.0);
            for face in 0..2 * D {
                for line in face_lines(&points, PARTS[fineness], face, window.plane) {
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
            let corners = snapshot.cell_box(cell);
            // A curved cell may extend beyond the box of its nodes.
            let bulge = 0.1 * (0..D).map(|d| corners[1][d] - corners[0][d]).fold(0.0, f64::max);
            let meets = window.plane.meets(&corners[0].map(|x| x - bulge), &corners[1].map(|x| x + bulge));
            let [lower, upper] = corners.map(|corner| window.plane.project(&corner));
            let cell_box = Extent { lower, upper };
            (meets && !cell_box.grown([bulge; 2]).intersection(window.extent).is_empty())
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

/// The walls that the plane z = `height` meets, or all boundaries if the walls are not known; and whether they are known.
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
fn thickness<const D: usize>(points: &[[f64; D]], plane: Plane) -> f64 {
    let n = (points.len() as f64).powf(1.0 / D as f64).round() as usize;
    let middle = |axis: usize, side: usize| -> [f64; D] {
        let digit = |a: usize| if a == axis { side * (n - 1) } else { n / 2 };
        points[(0..D).map(|a| digit(a) * n.pow(a as u32)).sum::<usize>()]
    };
    let distance = |axis: usize| {
        let [a, b] = [0, 1].map(|side| plane.project(&middle(axis, side)));
        (b[0] - a[0]).hypot(b[1] - a[1])
    };
    // An axis out of the plane is not visible.
    let distances = (0..D).map(distance);
    let longest = distances.clone().fold(0.0, f64::max);
    distances.filter(|distance| *distance > 1e-6 * longest).fold(longest, f64::min)
}
