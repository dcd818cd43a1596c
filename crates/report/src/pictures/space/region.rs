//! The part of the flow that pictures in space show.

use super::super::bounds::{Cuboid, in_space};
use crate::pictures::snapshot::Snapshot;
use crate::pictures::track::face_points;
use output::ResultReader;

/// The part of the flow that pictures in space show.
#[derive(Clone)]
pub struct PictureRegion {
    /// The box around all cells at all times.
    pub domain: Cuboid,
    /// Surfaces are shown in this box: around bodies in a wide domain, else the domain.
    pub outer: Cuboid,
    /// Cuts pass through this box: closer around bodies, or the domain.
    pub near: Cuboid,
    /// The faces of walls, and the box around them at all times.
    pub walls: Vec<[usize; 2]>,
    around_walls: Cuboid,
}

/// Walls shorter than this fraction of the domain are bodies in it.
const BODY: f64 = 0.5;

/// The distance from bodies up to which surfaces are shown, in lengths of the bodies.
const REACH: f64 = 4.0;

/// The same of cuts.
const REACH_OF_CUTS: f64 = 1.0;

impl PictureRegion {
    /// The region of a run.
    pub fn new<const D: usize>(reader: &ResultReader, snapshots: &[Snapshot<D>]) -> Self {
        let walls = faces_of_walls(reader);
        let around = |faces: &Vec<[usize; 2]>| {
            let face = |(snapshot, &[cell, face]): (&Snapshot<D>, &[usize; 2])| {
                Cuboid::of(face_points(snapshot, cell, face).map(|x| in_space(&x)))
            };
            let all = snapshots.iter().flat_map(|snapshot| faces.iter().map(move |at| (snapshot, at)));
            all.map(face).fold(Cuboid::EMPTY, Cuboid::union)
        };
        let boxes: Vec<Cuboid> = walls.iter().map(around).collect();
        let around_walls = boxes.iter().copied().fold(Cuboid::EMPTY, Cuboid::union);
        let domain = snapshots.iter().map(domain).fold(Cuboid::EMPTY, Cuboid::union);
        let [outer, near] = [REACH, REACH_OF_CUTS].map(|reach| around_bodies(domain, &boxes, reach));
        PictureRegion { domain, outer, near, walls: walls.concat(), around_walls }
    }

    /// The cells that may lie in the box of the surfaces.
    pub fn cells<const D: usize>(&self, snapshot: &Snapshot<D>) -> impl Iterator<Item = usize> {
        let meets = |cell: &usize| {
            let around = Cuboid::of_cell(snapshot, *cell);
            // A curved cell may extend beyond the box of its nodes.
            !around.grown([0.1 * around.length(); 3]).intersection(self.outer).is_empty()
        };
        (0..snapshot.cells()).filter(meets)
    }

    /// The boxes that the pictures show: the walls and the boxes of `vortices`.
    pub fn shown(&self, vortices: &[Cuboid]) -> Vec<Cuboid> {
        let all = vortices.iter().chain([&self.around_walls]).map(|shown| shown.intersection(self.outer));
        all.filter(|shown| !shown.is_empty()).collect()
    }
}

/// The cells and faces of each wall.
fn faces_of_walls(reader: &ResultReader) -> Vec<Vec<[usize; 2]>> {
    let mesh = &reader.metadata.mesh;
    let walls = case::walls_of(&reader.metadata.case_text, &mesh.boundary_names);
    let faces = |wall: &&str| {
        let on_wall = |facet: &&[i64; 3]| mesh.boundary_names[facet[2] as usize] == **wall;
        mesh.boundary_facets.iter().filter(on_wall).map(|&[cell, face, _]| [cell as usize, face as usize]).collect()
    };
    walls.iter().map(faces).collect()
}

/// The box around all cells.
fn domain<const D: usize>(snapshot: &Snapshot<D>) -> Cuboid {
    (0..snapshot.cells()).map(|cell| Cuboid::of_cell(snapshot, cell)).fold(Cuboid::EMPTY, Cuboid::union)
}

/// The box around bodies in a domain with a margin of `reach` times their length; the domain itself if the walls, with their boxes, are no bodies.
fn around_bodies(domain: Cuboid, walls: &[Cuboid], reach: f64) -> Cuboid {
    let short = |wall: &Cuboid| !wall.is_empty() && wall.length() < BODY * domain.length();
    let bodies = walls.iter().copied().filter(short).fold(Cuboid::EMPTY, Cuboid::union);
    if bodies.is_empty() || bodies.length() > BODY * domain.length() {
        return domain;
    }
    bodies.grown([reach * bodies.length(); 3]).intersection(domain)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cube(half: f64) -> Cuboid {
        Cuboid { lower: [-half; 3], upper: [half; 3] }
    }

    #[test]
    fn a_wide_domain_is_cut_to_the_bodies() {
        assert_eq!(around_bodies(cube(100.0), &[cube(0.5)], 4.0), cube(4.5));
        assert_eq!(around_bodies(cube(3.0), &[cube(0.5)], 4.0), cube(3.0));
        assert_eq!(around_bodies(cube(3.0), &[cube(2.0), Cuboid::EMPTY], 1.0), cube(3.0));
    }
}
