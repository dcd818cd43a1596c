//! Faces of bodies, and how far they have moved.

use super::bounds::Extent;
use super::scheme::PARTS;
use super::snapshot::Snapshot;

/// Faces of bodies, and their centre at the first picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Track {
    facets: Vec<[usize; 2]>,
    start: [f64; 2],
}

impl Track {
    /// The faces `facets`, which are cells and faces of cells, from `first` on.
    pub fn new<const D: usize>(facets: Vec<[usize; 2]>, first: &Snapshot<D>) -> Self {
        let mut track = Track::over(facets);
        track.start = track.shift(first);
        track
    }

    /// The faces `facets` without a first picture.
    pub fn over(facets: Vec<[usize; 2]>) -> Self {
        Track { facets, start: [0.0; 2] }
    }

    /// The box around the faces.
    pub fn extent<const D: usize>(&self, snapshot: &Snapshot<D>) -> Extent {
        self.boxes(snapshot).fold(Extent::EMPTY, Extent::union)
    }

    /// How far the mean of the centres of the faces has moved.
    pub fn shift<const D: usize>(&self, snapshot: &Snapshot<D>) -> [f64; 2] {
        let mut sum = [0.0; 2];
        for face in self.boxes(snapshot) {
            (0..2).for_each(|i| sum[i] += 0.5 * (face.lower[i] + face.upper[i]));
        }
        [0, 1].map(|i| sum[i] / self.facets.len().max(1) as f64 - self.start[i])
    }

    fn boxes<const D: usize>(&self, snapshot: &Snapshot<D>) -> impl Iterator<Item = Extent> {
        self.facets.iter().map(|&[cell, face]| Extent::of(face_points(snapshot, cell, face).map(|x| [x[0], x[1]])))
    }
}

/// A few points of a face.
pub fn face_points<const D: usize>(snapshot: &Snapshot<D>, cell: usize, face: usize) -> impl Iterator<Item = [f64; D]> {
    let points = snapshot.points(cell, 0);
    mesh::face_nodes(D, PARTS[0] + 1, face).into_iter().map(move |node| points[node])
}
