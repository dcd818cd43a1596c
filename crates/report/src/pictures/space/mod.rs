//! Pictures in space: iso-surfaces of the Q criterion and the walls, from a few directions.

mod camera;
mod continuous;
mod depth;
mod iso_surface;
mod level;
mod places;
mod region;
mod surface;
mod wall;

use super::bounds::{Cuboid, in_space};
pub use camera::Camera;
pub use depth::DARKEST;
pub use region::PictureRegion;

use super::drawn::Drawn;
use super::lines::LineLayer;
use super::quantity::{PictureQuantity, Range};
use super::snapshot::Snapshot;
use super::window::Window;
use crate::html::short;
use continuous::ContinuousQ;
use depth::DepthRaster;
use iso_surface::iso_surface;
use places::Places;
use rayon::prelude::*;
use surface::TriangleSurface;
use wall::wall_surface;

/// What is needed for the pictures in space.
pub struct Space {
    /// The Q of the surface.
    level: f64,
    region: PictureRegion,
    /// One for each camera.
    pub windows: Vec<Window>,
}

/// The surfaces at one time.
pub struct Scene {
    vortices: TriangleSurface,
    walls: TriangleSurface,
}

/// Pixels of a picture.
const PIXELS: f64 = 160e3;

/// The margin around what is shown, as a fraction of its length.
const MARGIN: f64 = 0.03;

impl Space {
    /// The pictures of a `region` of a run in three dimensions, with the surface of a `given` level, or of one that fits the run. There are none
    /// without a flow. Without a given level there are none if Q is zero up to round-off.
    pub fn new<const D: usize, const M: usize>(
        region: PictureRegion,
        snapshots: &[Snapshot<D>],
        given: Option<f64>,
    ) -> Option<Self> {
        snapshots.first()?.q_criterion::<M>(0, 0)?;
        let samples = level::samples::<D, M>(&region, snapshots);
        let level = given.or_else(|| samples.level::<D, M>(snapshots, region.domain))?;
        let mut shown = region.shown(&samples.vortices::<D, M>(level, snapshots));
        if shown.is_empty() {
            // No Q is above the given level, and there are no walls.
            shown.push(region.domain);
        }
        let windows = Camera::all().into_iter().map(|camera| window(camera, &shown, level, given.is_some())).collect();
        Some(Space { level, region, windows })
    }

    /// The surfaces of a snapshot. M = D + 2.
    pub fn scene<const D: usize, const M: usize>(&self, snapshot: &Snapshot<D>) -> Scene {
        let scale = self.windows.iter().map(Window::scale).fold(0.0, f64::max);
        let fineness = |cell: usize| {
            let pixels = Cuboid::of_cell(snapshot, cell).length() * scale;
            Snapshot::<D>::fineness(pixels).min(snapshot.fineness_of_order())
        };
        let cells: Vec<usize> = self.region.cells(snapshot).collect();
        let q = ContinuousQ::new::<D, M>(snapshot, &cells, self.region.domain.length());
        let of_cell = |cell: usize| self.vortices::<D, M>(snapshot, &q, cell, fineness(cell));
        let vortices: Vec<TriangleSurface> = cells.into_par_iter().filter_map(of_cell).collect();
        let walls =
            self.region.walls.par_iter().map(|&[cell, face]| wall_surface(snapshot, cell, face, fineness(cell)));
        let walls: Vec<TriangleSurface> = walls.collect();
        let vortices = TriangleSurface::joined(vortices).with_common_normals(Places::new(self.region.domain.length()));
        Scene { vortices, walls: TriangleSurface::joined(walls) }
    }

    /// The surface Q = level in a cell of the flow.
    fn vortices<const D: usize, const M: usize>(
        &self,
        snapshot: &Snapshot<D>,
        q: &ContinuousQ,
        cell: usize,
        fineness: usize,
    ) -> Option<TriangleSurface> {
        let q = q.at(snapshot, cell, fineness)?;
        let above = q.iter().filter(|q| **q >= self.level).count();
        if above == 0 || above == q.len() {
            return None;
        }
        let patch = snapshot.patch::<M>(cell, fineness);
        let points: Vec<[f64; 3]> = patch.points.iter().map(in_space).collect();
        let surface = iso_surface((&points, patch.parts), &q, self.level, &patch.values);
        Some(surface.within(self.region.outer))
    }
}

/// The window of a camera on the boxes `shown`.
fn window(camera: Camera, shown: &[Cuboid], level: f64, given: bool) -> Window {
    let extent = camera.extent(shown);
    let margin = MARGIN * extent.length();
    let meaning = " Four fifths of the integral of positive Q, over the part of the flow around the walls and all times shown, lie inside.";
    let note = format!(
        "Shown is the surface Q = {} of the Q criterion with the colours of the field, {}. Walls are grey.{}",
        short(level),
        camera.direction,
        if given { "" } else { meaning },
    );
    let window = Window::new(camera.label, extent.grown([margin; 2]), PIXELS);
    Window { note, camera: Some(camera), ..window }
}

impl Scene {
    /// The picture of a camera in a window.
    pub fn draw(&self, window: &Window, camera: &Camera, quantities: &[(PictureQuantity, Range)]) -> Drawn {
        let mut raster = DepthRaster::new(window, quantities.len());
        raster.draw(window, camera, &self.walls);
        raster.draw(window, camera, &self.vortices);
        let numbers = |(q, (_, range)): (usize, &(PictureQuantity, Range))| raster.numbers(q, *range);
        Drawn {
            numbers: quantities.iter().enumerate().map(numbers).collect(),
            extremes: (0..quantities.len()).map(|q| super::drawn::extremes(raster.of(q))).collect(),
            mesh: LineLayer::new(window),
            outline: raster.shadows(),
            outline_colour: [0; 3],
            strongest: DARKEST,
        }
    }
}
