//! The preconditioner: modes are separated, swept and joined.

use super::blocks::{Link, links};
use super::coarse::CoarseLevel;
use super::couplings::Couplings;
use super::face_traces::FaceTraces;
use super::factor::Elimination;
use super::inverse::Shape;
use super::ordering::{Ordering, minimum_discarded_fill};
use super::panel::padded;
use basis::TemporalModes;
use faer::c64;
use fem::{Layout, Pool, SpaceJacobian};
use rayon::prelude::*;
use tensor::Arch;

/// Bytes of factors that a task of a sweep reads at least: levels are short, and to share their cells out costs something too.
const GRAIN: usize = 1 << 16;

/// Block ILU(0) of every temporal mode of a slab.
///
/// Off-diagonal blocks are the same for all modes and kept in traces; everything is stored in single precision: the
/// iteration that uses it works in double, and loses nothing.
pub struct FlowPreconditioner {
    layout: Layout,
    pub(super) modes: TemporalModes,
    pub(super) jacobian: SpaceJacobian,
    links: Vec<Vec<Link>>,
    pub(super) ordering: Ordering,
    pub(super) couplings: Couplings,
    /// D^{-1} of all modes, cell by cell in the order of positions.
    inverses: Vec<f32>,
    /// How traces are taken and sent back, for every face of a cell.
    pub(super) faces: Vec<FaceTraces>,
    pub(super) dt: f64,
    pub(super) arch: Arch,
    pub(super) scratch: Pool<Scratch>,
    /// Right-hand sides and results, `[position][column][padded row]`.
    pub(super) panel: Vec<f32>,
    pub(super) result: Vec<f32>,
}

impl FlowPreconditioner {
    /// Factors the modes of a slab of length `dt` around `jacobian`, damped by `damping` = dt / dtau. The order of
    /// elimination is found anew unless one is given.
    pub fn new(
        layout: Layout,
        modes: TemporalModes,
        jacobian: SpaceJacobian,
        dt: f64,
        damping: f64,
        ordering: Option<Ordering>,
    ) -> Self {
        let mut preconditioner = Self::unfactored(layout, modes, jacobian, ordering, dt);
        preconditioner.refactor(dt, damping);
        preconditioner
    }

    /// The same of a steady flow, whose one mode has a coarse level too; that is left out where its matrix is singular. `order` nodes
    /// per direction.
    pub fn of_steady_flow(
        layout: Layout,
        modes: TemporalModes,
        jacobian: SpaceJacobian,
        (dt, damping): (f64, f64),
        ordering: Option<Ordering>,
        order: usize,
    ) -> (Self, Option<CoarseLevel>) {
        let lambda = modes.eigenvalues[0].re + damping;
        let mut preconditioner = Self::unfactored(layout, modes, jacobian, ordering, dt);
        let (mut inverses, unfactored) = (Vec::new(), &preconditioner);
        let factorise = || unfactored.factorise(dt, damping, &mut inverses);
        let ((), coarse) = rayon::join(factorise, || CoarseLevel::new(unfactored, layout, order, dt, lambda));
        preconditioner.inverses = inverses;
        (preconditioner, coarse.ok())
    }

    /// All but the factors.
    fn unfactored(
        layout: Layout,
        modes: TemporalModes,
        jacobian: SpaceJacobian,
        ordering: Option<Ordering>,
        dt: f64,
    ) -> Self {
        let links = links(&jacobian, layout.cells);
        let ordering = ordering.unwrap_or_else(|| minimum_discarded_fill(&jacobian, &links, dt, modes.mean_shift()));
        let couplings = Couplings::new(&jacobian, &links, &ordering);
        let (columns, rows) = (modes.forward.rows(), padded(jacobian.block));
        let faces = links.iter().flatten().map(|link| link.face + 1).max().unwrap_or(0);
        let size = layout.cells * columns * rows;
        let room = || vec![0.0; columns * couplings.rows()];
        let scratch = Pool::new(|| Scratch { taken: room(), sent: room() });
        FlowPreconditioner {
            layout,
            modes,
            links,
            ordering,
            couplings,
            inverses: Vec::new(),
            faces: (0..faces).map(|face| FaceTraces::new(&jacobian.traces, face)).collect(),
            dt,
            arch: Arch::new(),
            scratch,
            panel: vec![0.0; size],
            result: vec![0.0; size],
            jacobian,
        }
    }

    /// Factors anew for another slab length or damping, around the same Jacobian.
    pub fn refactor(&mut self, dt: f64, damping: f64) {
        self.dt = dt;
        let mut inverses = std::mem::take(&mut self.inverses);
        self.factorise(dt, damping, &mut inverses);
        self.inverses = inverses;
    }

    fn factorise(&self, dt: f64, damping: f64, inverses: &mut Vec<f32>) {
        let len: usize = self.shapes().map(Shape::len).sum();
        inverses.resize(len * self.layout.cells, 0.0);
        let shifts: Vec<c64> = self.modes.eigenvalues.iter().map(|lambda| lambda + damping).collect();
        let elimination = Elimination {
            jacobian: &self.jacobian,
            links: &self.links,
            ordering: &self.ordering,
            faces: &self.faces,
            dt,
            shifts: &shifts,
        };
        elimination.factorise(inverses);
    }

    /// The blocks of the modes.
    pub(super) fn shapes(&self) -> impl Iterator<Item = Shape> {
        self.modes.eigenvalues.iter().map(|lambda| Elimination::shape(&self.jacobian, *lambda))
    }

    /// D^{-1} of all modes at `position`.
    pub(super) fn inverses(&self, position: usize) -> &[f32] {
        let len = self.inverses.len() / self.layout.cells;
        &self.inverses[position * len..(position + 1) * len]
    }

    /// The order of elimination.
    pub fn ordering(&self) -> &Ordering {
        &self.ordering
    }

    /// The Jacobian that the modes are made of.
    pub(super) fn jacobian(&self) -> &SpaceJacobian {
        &self.jacobian
    }

    /// The couplings of every cell.
    pub(super) fn links(&self) -> &[Vec<Link>] {
        &self.links
    }

    /// Bytes held by factors and couplings.
    pub fn bytes(&self) -> usize {
        let couplings: usize = self.jacobian.couplings.iter().map(|c| c.minus_plus.len() + c.plus_minus.len()).sum();
        let double = self.jacobian.diagonal.len() + self.jacobian.mass.len() + couplings;
        self.couplings.bytes() + size_of_val(&self.inverses[..]) + 8 * double
    }

    /// Bytes that an application reads, all in single precision: couplings once, factors in both sweeps.
    pub fn swept_bytes(&self) -> usize {
        self.couplings.bytes() + 2 * size_of_val(&self.inverses[..])
    }

    /// Floating-point operations of the products with blocks in an application: two for a number of a real block and column, four for
    /// one of a complex factor.
    pub fn operations(&self) -> usize {
        let factors: usize = self.shapes().map(|shape| 2 * shape.parts * shape.len()).sum();
        let couplings = self.couplings.bytes() / size_of::<f32>();
        2 * factors * self.layout.cells + 2 * self.modes.forward.rows() * couplings
    }

    /// z = P^{-1} r.
    pub fn apply(&mut self, r: &[f64], z: &mut [f64]) {
        let scale = r.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
        if scale == 0.0 {
            z.fill(0.0);
            return;
        }
        self.split_into_modes(r, 1.0 / scale);
        self.forward_sweep();
        self.backward_sweep();
        self.join_modes(scale, z);
    }

    /// Cells of a level that a thread takes at least.
    pub(super) fn cells_per_task(&self) -> usize {
        GRAIN.div_ceil(size_of_val(self.inverses(0)))
    }

    /// Length of one cell's panel.
    pub(super) fn panel_len(&self) -> usize {
        self.modes.forward.rows() * padded(self.jacobian.block)
    }

    /// c = (Q^{-1} W^{-1} (x) I) r, scaled so that single precision does not underflow.
    fn split_into_modes(&mut self, r: &[f64], scale: f64) {
        let (n, len) = (self.jacobian.block, self.panel_len());
        let (layout, forward, cells) = (self.layout, &self.modes.forward, &self.ordering.cells);
        self.panel.par_chunks_exact_mut(len).zip(cells).with_min_len(16).for_each(|(panel, &cell)| {
            for (column, panel) in panel.chunks_exact_mut(padded(n)).enumerate() {
                panel.fill(0.0);
                for a in 0..layout.time_order {
                    let weight = forward[(column, a)] * scale;
                    let r = &r[layout.cell_at(cell, a)];
                    panel.iter_mut().zip(r).for_each(|(c, r)| *c += (weight * r) as f32);
                }
            }
        });
    }

    /// z = (Q (x) I) c.
    fn join_modes(&self, scale: f64, z: &mut [f64]) {
        let (n, len) = (self.jacobian.block, self.panel_len());
        let (layout, backward, positions) = (self.layout, &self.modes.backward, &self.ordering.positions);
        z.par_chunks_exact_mut(layout.cell_len()).enumerate().with_min_len(16).for_each(|(cell, z)| {
            let panel = &self.result[positions[cell] * len..(positions[cell] + 1) * len];
            for (a, z) in z.chunks_exact_mut(n).enumerate() {
                z.fill(0.0);
                for (column, panel) in panel.chunks_exact(padded(n)).enumerate() {
                    let weight = backward[(a, column)] * scale;
                    z.iter_mut().zip(panel).for_each(|(z, c)| *z += weight * f64::from(*c));
                }
            }
        });
    }
}

/// Room for the traces of a panel, `[column][padded trace]`.
pub(super) struct Scratch {
    pub(super) taken: Vec<f32>,
    pub(super) sent: Vec<f32>,
}
