//! The mesh of a run: how it moves, and the proof that it stays valid.

use crate::motion::{MeshMotion, SlabData};
use crate::state::Interval;
use basis::RadauTime;
use elasticity::{ElasticityError, SlabMotion, Work};
use fem::Clock;
use mesh::{Mesh, MotionCheck, NodeNumbering, Validity};
use newton_krylov::inner_product;
use newton_krylov::problem::Inadmissible;
use std::sync::{Mutex, PoisonError};

/// The quantity of the [`Inadmissible`] state of an inverted mesh.
pub const RELATIVE_DETERMINANT: &str = "det J / det J_0";

/// The quality of the mesh over a slab.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshQuality {
    /// Proved: det J / det J_0 is nowhere smaller.
    pub lower_bound: f64,
    /// The smallest det J / det J_0 seen.
    pub sampled_min: f64,
    /// The smallest ratio of the smallest to the largest det J / det J_0 seen in a cell.
    pub scaled_jacobian: f64,
    /// The cell where det J / det J_0 is smallest.
    pub cell: usize,
    /// The time at which it is.
    pub time: f64,
}

impl MeshQuality {
    /// Whether det J > 0 is proved everywhere.
    pub fn is_valid(&self) -> bool {
        self.lower_bound > 0.0
    }

    /// Ok if the mesh is proved to be valid; otherwise the reason, for a line search.
    ///
    /// # Errors
    /// The smallest det J / det J_0 seen, where the mesh is not proved to be valid.
    pub fn admissible(&self) -> Result<(), Inadmissible> {
        if self.is_valid() {
            return Ok(());
        }
        let MeshQuality { sampled_min: value, cell, time, .. } = *self;
        Err(Inadmissible {
            quantity: RELATIVE_DETERMINANT.into(),
            value,
            location: format!("in cell {cell} at t = {time}"),
        })
    }

    /// The worst of both in every respect.
    pub fn worst(self, other: MeshQuality) -> MeshQuality {
        let worse = if other.sampled_min < self.sampled_min { other } else { self };
        MeshQuality {
            lower_bound: self.lower_bound.min(other.lower_bound),
            scaled_jacobian: self.scaled_jacobian.min(other.scaled_jacobian),
            ..worse
        }
    }
}

/// The reference mesh and its motion, slab by slab.
pub struct MeshMover<const D: usize> {
    /// Where the displacement comes from.
    pub motion: MeshMotion<D>,
    /// The polynomials of a slab.
    pub slab_motion: SlabMotion,
    /// The mesh at rest.
    pub reference: Mesh<D>,
    /// Its C0 nodes.
    pub numbering: NodeNumbering,
    positions: Vec<[f64; D]>,
    times: Vec<f64>,
    check: MotionCheck<D>,
    last_proof: Mutex<Option<Proof>>,
}

/// A proof and the motion of the slab that it belongs to.
struct Proof {
    interval: Interval,
    /// Displacement at the bottom and velocities; a vector of zeros is stored as an empty one.
    motion: [Vec<f64>; 2],
    quality: MeshQuality,
}

impl Proof {
    fn new(bottom: &[f64], v: &[f64], interval: Interval, quality: MeshQuality) -> Self {
        let stored = |x: &[f64]| if is_zero(x) { Vec::new() } else { x.to_vec() };
        Proof { interval, motion: [bottom, v].map(stored), quality }
    }

    /// The quality, if the proof is that of this motion.
    fn of(&self, bottom: &[f64], v: &[f64], interval: Interval) -> Option<MeshQuality> {
        let same_time = self.interval.start == interval.start && self.interval.end == interval.end;
        let same = |stored: &Vec<f64>, x: &[f64]| if stored.is_empty() { is_zero(x) } else { stored == x };
        let mut parts = self.motion.iter().zip([bottom, v]);
        (same_time && parts.all(|(stored, x)| same(stored, x))).then_some(self.quality)
    }
}

fn is_zero(x: &[f64]) -> bool {
    x.iter().all(|x| *x == 0.0)
}

impl<const D: usize> MeshMover<D> {
    /// A mover of `reference` with `time_order` nodes per slab; `numbering` has the order of the mesh.
    pub fn new(motion: MeshMotion<D>, reference: Mesh<D>, numbering: NodeNumbering, time_order: usize) -> Self {
        let slab_motion = SlabMotion::new(RadauTime::new(time_order));
        let times: Vec<f64> = std::iter::once(0.0).chain(slab_motion.time().nodes().iter().copied()).collect();
        let check = MotionCheck::new(&reference, &numbering, &times);
        let positions = numbering.positions(&reference);
        let last_proof = Mutex::new(None);
        MeshMover { motion, slab_motion, reference, numbering, positions, times, check, last_proof }
    }

    /// Entries of a displacement, `[C0 node][component]`.
    pub fn field_len(&self) -> usize {
        self.positions.len() * D
    }
    /// Reference positions of the C0 nodes.
    pub fn positions(&self) -> &[[f64; D]] {
        &self.positions
    }

    /// Positions of the nodes of `cell` displaced by `d`, `[component][node]`. Nodes on periodic boundaries have the position that this
    /// cell sees.
    pub fn cell_positions(&self, cell: usize, d: &[f64]) -> Vec<f64> {
        self.cell_positions_with(cell, &|entry| d[entry])
    }

    /// [`Self::cell_positions`] where `d` gives an entry of the displacement.
    pub fn cell_positions_with(&self, cell: usize, d: &dyn Fn(usize) -> f64) -> Vec<f64> {
        let (nodes, x) = (self.numbering.cell(cell), self.reference.cell_coordinates(cell));
        (0..D).flat_map(|i| nodes.iter().enumerate().map(move |(k, &node)| x[k * D + i] + d(node * D + i))).collect()
    }

    /// The displacement prescribed at time `t`; for an elastic mesh zero at free entries.
    pub fn prescribed(&self, t: f64, out: &mut [f64]) {
        self.motion.prescribed(&self.positions, t, out);
    }

    /// Sets the velocity `v` of C0 nodes whose motion is prescribed to the prescribed one at time `t`.
    pub fn prescribe_velocity(&self, t: f64, v: &mut [f64]) {
        self.motion.prescribe_velocity(&self.positions, t, v);
    }

    /// The displacement at the start of a run: prescribed where every node is, zero otherwise.
    pub fn displacement_at_start(&self, t: f64) -> Vec<f64> {
        let mut d = vec![0.0; self.field_len()];
        if let MeshMotion::Prescribed(_) = self.motion {
            self.prescribed(t, &mut d);
        }
        d
    }

    /// The displacements prescribed at the time nodes of a slab of length `dt` on top of the displacement `bottom`,
    /// `[time node][C0 node][component]`.
    pub fn prescribed_in_slab(&self, clock: Clock, dt: f64, bottom: &[f64], out: &mut [f64]) {
        self.motion.prescribed_in_slab(&self.positions, &self.slab_motion, (clock, dt), bottom, out);
    }

    /// Prepares the elastic mesh for the slab that starts at the displacement `bottom`.
    ///
    /// # Errors
    /// As [`elasticity::ElasticMesh::begin_slab`].
    pub fn begin_slab(&mut self, bottom: &[f64]) -> Result<(), ElasticityError> {
        if let MeshMotion::Elastic { mesh, .. } = &mut self.motion { mesh.begin_slab(bottom) } else { Ok(()) }
    }

    /// Replaces the guess `v` by velocities that meet the displacements `g` prescribed at the time nodes of a slab. With a law that is not
    /// linear, every iterate is proved to be valid.
    ///
    /// # Errors
    /// As [`elasticity::ElasticSlab::equilibrium`].
    pub fn velocities(
        &self,
        interval: Interval,
        bottom: &[f64],
        g: &[f64],
        v: &mut [f64],
    ) -> Result<Work, ElasticityError> {
        let guard = |v: &[f64]| self.check_validity(bottom, v, interval);
        let data = SlabData { dt: interval.length(), bottom, prescribed: g };
        self.motion.velocities(&self.slab_motion, data, v, &guard)
    }

    /// Ok if the motion of a slab is proved to be valid; otherwise the reason, for a line search.
    ///
    /// # Errors
    /// The smallest det J / det J_0 seen, where it is not.
    pub fn check_validity(&self, bottom: &[f64], v: &[f64], interval: Interval) -> Result<(), Inadmissible> {
        self.quality(bottom, v, interval).admissible()
    }

    /// Proves det J > 0 for the motion of a slab. The last proof is kept: the same motion is not proved again.
    pub fn quality(&self, bottom: &[f64], v: &[f64], interval: Interval) -> MeshQuality {
        let last = || self.last_proof.lock().unwrap_or_else(PoisonError::into_inner);
        let known = last().as_ref().and_then(|proof| proof.of(bottom, v, interval));
        if let Some(quality) = known {
            return quality;
        }
        let quality = self.prove(bottom, v, interval, 1.0);
        *last() = Some(Proof::new(bottom, v, interval, quality));
        quality
    }

    /// Proves det J > 0 for the first part of the motion of a slab, s <= `part`.
    fn prove(&self, bottom: &[f64], v: &[f64], interval: Interval, part: f64) -> MeshQuality {
        let _timed = tracing::trace_span!(target: "cost", "mesh_proof").entered();
        let (dt, len) = (interval.length(), bottom.len());
        let mut displacements = vec![0.0; len * self.times.len()];
        for (s, d) in self.times.iter().zip(displacements.chunks_exact_mut(len)) {
            self.slab_motion.displacement(dt, bottom, v, part * s, d);
        }
        if let Some(undefined) = displacements.iter().position(|d| !d.is_finite()) {
            return self.undefined(undefined % len / D, interval.start + part * dt * self.times[undefined / len]);
        }
        let cells = self.check.decide(&displacements);
        worst(&cells, Interval { end: interval.start + part * dt, ..interval })
    }

    /// The quality of a mesh if the displacement of `node` is not finite at `time`: not valid.
    fn undefined(&self, node: usize, time: f64) -> MeshQuality {
        let cell = (0..self.reference.n_cells()).find(|&cell| self.numbering.cell(cell).contains(&node));
        let nothing = f64::NAN;
        MeshQuality {
            lower_bound: nothing,
            sampled_min: nothing,
            scaled_jacobian: nothing,
            cell: cell.unwrap_or(0),
            time,
        }
    }

    /// The first time in a slab at which a cell is not proved to be valid, to a thousandth of the slab; `None` if all are.
    pub fn first_invalid(&self, bottom: &[f64], v: &[f64], interval: Interval) -> Option<f64> {
        if self.quality(bottom, v, interval).is_valid() {
            return None;
        }
        let (mut valid, mut invalid) = (0.0, 1.0);
        while invalid - valid > 1e-3 {
            let middle = 0.5 * (valid + invalid);
            if self.prove(bottom, v, interval, middle).is_valid() { valid = middle } else { invalid = middle }
        }
        Some(interval.start + invalid * (interval.length()))
    }
}

/// The smallest bound and the smallest sample of all cells.
fn worst<const D: usize>(cells: &[Validity<D>], interval: Interval) -> MeshQuality {
    let quality = |(cell, validity): (usize, &Validity<D>)| {
        let bound = validity.bound();
        MeshQuality {
            lower_bound: bound.lower,
            sampled_min: bound.sampled_min,
            scaled_jacobian: bound.scaled_jacobian(),
            cell,
            time: interval.start + bound.at.s * (interval.length()),
        }
    };
    inner_product::reduce(cells.iter().enumerate().map(quality), MeshQuality::worst).expect("a mesh has cells")
}

#[cfg(test)]
mod tests {
    use super::*;
    use mesh::BoxMesh;

    fn square() -> Result<MeshMover<2>, Box<dyn std::error::Error>> {
        let (lower, upper, curving, periodic) = ([0.0; 2], [1.0; 2], mesh::Curving::None, [false; 2]);
        let mesh = BoxMesh { lower, upper, cells: [2, 2], order: 3, curving, periodic }.build()?;
        let numbering = NodeNumbering::new(&mesh, 3);
        Ok(MeshMover::new(MeshMotion::Still, mesh, numbering, 2))
    }

    /// The mesh stretched along x, at the bottom of a slab and with this rate in it.
    fn stretched(mover: &MeshMover<2>, factor: f64) -> Vec<f64> {
        mover.positions().iter().flat_map(|x| [factor * x[0], 0.0]).collect()
    }

    #[test]
    fn the_last_proof_serves_its_own_motion_alone() -> Result<(), Box<dyn std::error::Error>> {
        let mover = square()?;
        let interval = Interval { start: 0.0, end: 1.0, halvings: 0 };
        let shorter = Interval { end: 0.5, ..interval };
        let bottoms = [0.0, 0.5].map(|factor| stretched(&mover, factor));
        let velocities = [0.0, 0.3, -2.0].map(|factor| stretched(&mover, factor).repeat(2));
        for (bottom, v) in bottoms.iter().flat_map(|bottom| velocities.iter().map(move |v| (bottom, v))) {
            for interval in [interval, interval, shorter] {
                let found = mover.quality(bottom, v, interval);
                assert_eq!(found, square()?.quality(bottom, v, interval), "{interval:?}");
            }
        }
        assert!(!mover.quality(&bottoms[0], &velocities[2], interval).is_valid());
        assert!(mover.quality(&bottoms[0], &velocities[1], interval).is_valid());
        let mut undefined = velocities[1].clone();
        undefined[0] = f64::NAN;
        assert!(!mover.quality(&bottoms[0], &undefined, interval).is_valid());
        assert!(mover.quality(&bottoms[0], &velocities[1], interval).is_valid());
        Ok(())
    }
}
