//! Walls in the plane of the windows.

use super::bounds::Extent;
use super::snapshot::Snapshot;
use super::track::{Track, face_points};

/// A boundary that may be a wall.
#[derive(Clone, Debug, PartialEq)]
pub struct Wall {
    /// Its name.
    pub name: String,
    /// Its faces that the shown plane meets: cell and face.
    pub facets: Vec<[usize; 2]>,
    /// The box around these faces in all snapshots.
    pub extent: Extent,
    /// The box in all snapshots around the face in its middle.
    pub middle: Extent,
}

impl Wall {
    /// The faces of a boundary that the plane z = `height` meets, if there is one.
    pub fn new<const D: usize>(
        name: &str,
        mut facets: Vec<[usize; 2]>,
        snapshots: &[Snapshot<D>],
        height: Option<f64>,
    ) -> Self {
        let meets = |snapshot: &Snapshot<D>, [cell, face]: [usize; 2], height: f64| {
            let z: Vec<f64> = face_points(snapshot, cell, face).map(|x| x[D - 1]).collect();
            z.iter().any(|z| *z <= height) && z.iter().any(|z| *z >= height)
        };
        facets.retain(|&facet| {
            height.is_none_or(|height| snapshots.iter().any(|snapshot| meets(snapshot, facet, height)))
        });
        let boxes = |facets: Vec<[usize; 2]>| {
            let track = Track::over(facets);
            snapshots.iter().map(|snapshot| track.extent(snapshot)).fold(Extent::EMPTY, Extent::union)
        };
        let middle = snapshots.first().and_then(|first| middle(&facets, first)).into_iter().collect();
        Wall { name: name.to_owned(), extent: boxes(facets.clone()), middle: boxes(middle), facets }
    }
}

/// The face closest to the middle of the box around all `facets`.
fn middle<const D: usize>(facets: &[[usize; 2]], snapshot: &Snapshot<D>) -> Option<[usize; 2]> {
    let centre = |facets: Vec<[usize; 2]>| Track::over(facets).extent(snapshot).centre();
    let all = centre(facets.to_vec());
    let distance = |facet: [usize; 2]| {
        let x = centre(vec![facet]);
        (x[0] - all[0]).hypot(x[1] - all[1])
    };
    facets.iter().copied().min_by(|a, b| distance(*a).total_cmp(&distance(*b)))
}
