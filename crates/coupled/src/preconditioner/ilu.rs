//! The preconditioner: modes are separated, swept and joined.

use super::bf16_blocks;
use super::blocks::{Link, links};
use super::couplings::Couplings;
use super::cuts::Cuts;
use super::face_traces::FaceTraces;
use super::factor::Elimination;
use super::inverse::Shape;
use super::modal::{Split, join, largest};
use super::ordering::{Ordering, minimum_discarded_fill};
use super::panel::padded;
use super::sweeps::Shared;
use super::{FactoredModes, FlowPreconditioner, TimeScales};
use basis::TemporalModes;
use faer::c64;
use fem::parallel::{self, Grain};
use fem::{Layout, PerThread, Share, SlabOperator, SpaceJacobian, Stored};
use navier_stokes::Conserved;
use newton_krylov::operator::Preconditioner;
use std::slice::ChunksExact;
use std::sync::atomic::AtomicU32;
use std::sync::{Arc, Mutex};
use tensor::Arch;

/// The largest (growth) at which entries are stored in one term. Up to there a second term saves no iteration on airfoils, whose largest growth
/// is 18,500. A thin periodic layer takes 50 iterations for 5 at 14,500, 700 at 24,000, and thousands above.
const LARGE_GROWTH: f64 = 2e4;

/// Block ILU(0) of every temporal mode of a slab.
///
/// The Jacobian is kept with entries of type `T`. Off-diagonal blocks are the same for all modes and kept in traces; they and the factors are
/// stored in bfloat16, each entry as one number or as the sum of two or three. The iteration that uses them works in double precision and loses nothing.
pub struct BlockIlu<T> {
    pub(super) layout: Layout,
    pub(super) share: Arc<Share>,
    pub(super) modes: TemporalModes,
    pub(super) jacobian: SpaceJacobian<T>,
    links: Vec<Vec<Link>>,
    pub(super) ordering: Ordering,
    pub(super) couplings: Couplings,
    /// D^{-1} of all modes, own cell by own cell in the order of positions, `[cell][term][mode]`.
    inverses: Vec<u32>,
    /// How many numbers in bfloat16 the entries of D^{-1} and of the couplings are the sums of.
    terms: usize,
    /// The scale of every unknown of a cell.
    scales: Vec<f32>,
    /// How traces are taken and sent back, for every face of a cell.
    pub(super) faces: Vec<FaceTraces>,
    pub(super) dt: f64,
    pub(super) arch: Arch,
    pub(super) scratch: PerThread<Scratch>,
    /// Right-hand sides and results at the positions of own cells.
    pub(super) swept: Vec<Shared>,
    /// The couplings to other ranks.
    pub(super) cuts: Cuts,
    /// Traces of the results of ghosts, `[column][padded trace]`, by the number of the coupling; empty where no ghost is.
    pub(super) received: Vec<Mutex<Vec<f32>>>,
}

impl<T: Stored> BlockIlu<T> {
    /// Factors the modes of the Jacobian of `operator` in the middle of its slab. The order of elimination is found anew unless one is given.
    pub fn new<const D: usize, const M: usize>(
        operator: &SlabOperator<D, M>,
        scales: TimeScales,
        ordering: Option<Ordering>,
    ) -> Self {
        let mut preconditioner = Self::unfactored(operator, scales.dt, ordering);
        preconditioner.factor(scales);
        preconditioner
    }

    /// All but the factors.
    pub(super) fn unfactored<const D: usize, const M: usize>(
        operator: &SlabOperator<D, M>,
        dt: f64,
        ordering: Option<Ordering>,
    ) -> Self {
        let (layout, share, modes) =
            (operator.layout, operator.share.clone(), TemporalModes::new(&operator.tables.time));
        let known = ordering.filter(|ordering| ordering.own().count() == layout.cells);
        // Its Jacobian is dropped before the one of type T is made.
        let scales = dynamic_scales::<D, M>(operator.problem.kernels.scales());
        let ordering = known.unwrap_or_else(|| {
            let jacobian = operator.space_jacobian(0.5);
            let links = links(&jacobian, layout.cells, share.ghosts.len());
            minimum_discarded_fill(&jacobian, &links, &share, &scales, (dt, modes.mean_shift()))
        });
        let jacobian = operator.space_jacobian(0.5);
        let links = links(&jacobian, layout.cells, share.ghosts.len());
        let couplings = Couplings::new(&jacobian, &links, &ordering);
        let (columns, rows) = (modes.forward.rows(), padded(jacobian.block));
        // A rank of few cells meets some faces on ghosts alone.
        let faces = links.iter().flatten().map(|link| link.face.max(link.other_face) + 1).max().unwrap_or(0);
        let traces = columns * couplings.rows();
        let room = move || vec![0.0; traces];
        let scratch = PerThread::new(move || Scratch { taken: room(), sent: room(), turned: vec![0.0; 4 * rows] });
        let cuts = Cuts::new(&links, &ordering, layout.cells);
        let mut received = vec![Vec::new(); jacobian.couplings.len()];
        cuts.crossings.iter().for_each(|crossing| received[crossing.coupling] = vec![0.0; traces]);
        let room_at = |cell: &usize| Shared::new(if *cell < layout.cells { columns * rows } else { 0 });
        BlockIlu {
            layout,
            share,
            modes,
            links,
            couplings,
            inverses: Vec::new(),
            terms: 1,
            scales: scales.iter().flat_map(|&scale| std::iter::repeat_n(scale as f32, jacobian.block / M)).collect(),
            faces: (0..faces).map(|face| FaceTraces::new(&jacobian.traces, face)).collect(),
            dt,
            arch: Arch::new(),
            scratch,
            swept: ordering.cells.iter().map(room_at).collect(),
            received: received.into_iter().map(Mutex::new).collect(),
            cuts,
            ordering,
            jacobian,
        }
    }

    /// Takes the Jacobian that `operator` has now, in the memory of the old one, and factors its modes.
    pub fn update<const D: usize, const M: usize>(&mut self, operator: &SlabOperator<D, M>, scales: TimeScales) {
        self.update_beside(operator, scales, |_| ());
    }

    /// The same while `other` works with the new Jacobian.
    pub(super) fn update_beside<const D: usize, const M: usize, R: Send>(
        &mut self,
        operator: &SlabOperator<D, M>,
        scales: TimeScales,
        other: impl FnOnce(&Self) -> R + Send,
    ) -> R {
        operator.update_space_jacobian(0.5, &mut self.jacobian);
        self.couplings.update(&self.jacobian, self.terms);
        self.factor_beside(scales, other)
    }

    /// Factors the modes while `other` works. Several ranks do one after the other: both may talk to other ranks.
    pub(super) fn factor_beside<R: Send>(&mut self, scales: TimeScales, other: impl FnOnce(&Self) -> R + Send) -> R {
        self.dt = scales.dt;
        let inverses = std::mem::take(&mut self.inverses);
        let ((inverses, terms), result) = if self.share.is_distributed() {
            (self.factorise(scales, inverses), other(self))
        } else {
            rayon::join(|| self.factorise(scales, inverses), || other(self))
        };
        self.inverses = inverses;
        if terms != self.terms {
            self.terms = terms;
            self.couplings.update(&self.jacobian, terms);
        }
        result
    }

    /// The factors in the memory of `inverses`, and the number of their terms. It follows from the Jacobian and the `scales` alone:
    /// a resumed run has nothing else.
    fn factorise(&self, scales: TimeScales, mut inverses: Vec<u32>) -> (Vec<u32>, usize) {
        // Mostly they need as many terms as before.
        let growth = self.factorise_in(self.terms, scales, &mut inverses);
        let terms = bf16_blocks::terms(growth / LARGE_GROWTH);
        tracing::debug!(growth, terms, "blocks of the preconditioner");
        if terms != self.terms {
            self.factorise_in(terms, scales, &mut inverses);
        }
        (inverses, terms)
    }

    /// Factors the modes in `terms`; returns their (growth) on all ranks.
    fn factorise_in(&self, terms: usize, TimeScales { dt, damping }: TimeScales, inverses: &mut Vec<u32>) -> f64 {
        let len: usize = self.shapes().map(|shape| bf16_blocks::panels(shape).len()).sum();
        if inverses.len() != len * terms * self.layout.cells {
            *inverses = vec![0; len * terms * self.layout.cells];
        }
        let shifts: Vec<c64> = self.modes.eigenvalues.iter().map(|lambda| lambda + damping).collect();
        let elimination = Elimination {
            jacobian: &self.jacobian,
            links: &self.links,
            ordering: &self.ordering,
            share: &self.share,
            cuts: &self.cuts,
            faces: &self.faces,
            dt,
            shifts: &shifts,
            scales: &self.scales,
            terms,
            growth: AtomicU32::new(0),
        };
        elimination.factorise(inverses);
        let growth = f32::from_bits(elimination.growth.into_inner());
        largest(&self.share, &[f64::from(growth)])
    }

    /// The blocks of the modes.
    pub(super) fn shapes(&self) -> impl Iterator<Item = Shape> {
        self.modes.eigenvalues.iter().map(|lambda| Elimination::<T>::shape(self.jacobian.block, *lambda))
    }

    /// The terms of D^{-1} of all modes at `position`.
    pub(super) fn inverses(&self, position: usize) -> ChunksExact<'_, u32> {
        let (len, number) = (self.inverses.len() / self.layout.cells, self.ordering.among_own(position));
        self.inverses[number * len..(number + 1) * len].chunks_exact(len / self.terms)
    }

    /// The couplings of every cell.
    pub(super) fn links(&self) -> &[Vec<Link>] {
        &self.links
    }

    /// Bytes that an application reads: couplings once, factors in both sweeps.
    pub fn swept_bytes(&self) -> usize {
        self.couplings.bytes() + 2 * size_of_val(&self.inverses[..])
    }

    /// Floating-point operations of the products with blocks in an application: two for a number of a real block and column, four for
    /// one of a complex factor.
    pub fn operations(&self) -> usize {
        let factors: usize = self.shapes().map(|shape| 2 * shape.parts * shape.len()).sum();
        let couplings = self.couplings.numbers();
        2 * self.terms * factors * self.layout.cells + 2 * self.modes.forward.rows() * couplings
    }

    /// c = (Q^{-1} W^{-1} (x) I) r, divided by `scale`, so that single precision does not underflow.
    fn split_into_modes(&mut self, r: &[f64], scale: f64) {
        let (block, layout, cells) = (self.jacobian.block, self.layout, &self.ordering.cells);
        let right_side = Split { modes: &self.modes, layout, r, scale };
        parallel::for_each_chunk(&mut self.swept, 1, Grain::Any, &|position, swept| {
            let cell = cells[position];
            if cell >= layout.cells {
                return;
            }
            for (column, panel) in swept[0].get().right_side.chunks_exact_mut(padded(block)).enumerate() {
                let (c, padding) = panel.split_at_mut(block);
                right_side.take(cell, column, c);
                padding.fill(0.0);
            }
        });
    }

    /// z by the sweeps of the right-hand sides that `set` writes, for r divided by the number that it gets. Returns this number.
    pub(super) fn apply_to(&mut self, r: &[f64], z: &mut [f64], set: impl FnOnce(&mut Self, f64)) -> f64 {
        let scale = largest(&self.share, r);
        if scale == 0.0 {
            z.fill(0.0);
            return scale;
        }
        set(self, scale);
        self.sweep();
        self.join_modes(scale, z);
        scale
    }

    /// z = (Q (x) I) c.
    fn join_modes(&self, scale: f64, z: &mut [f64]) {
        let rows = padded(self.jacobian.block);
        parallel::for_each_chunk(z, self.layout.cell_len(), Grain::AtLeast(16), &|cell, z| {
            z.fill(0.0);
            let swept = self.swept[self.ordering.positions[cell]].read();
            for (column, panel) in swept.result.chunks_exact(rows).enumerate() {
                join(&self.modes, column, scale, panel, z);
            }
        });
    }
}

/// The scales of a state with the energy in units of momentum^2 / (2 density). The order of elimination takes these: in units of the thermal energy,
/// flows at low Mach numbers would need more iterations. Steady starts vary by a fifth for other factors near this one.
fn dynamic_scales<const D: usize, const M: usize>(scales: [f64; M]) -> [f64; M] {
    let scales = Conserved::<f64, D>::unpack(&scales);
    Conserved { energy: 0.5 * scales.momentum[0].powi(2) / scales.density, ..scales }.pack()
}

impl<T: Stored> Preconditioner for BlockIlu<T> {
    fn apply(&mut self, r: &[f64], z: &mut [f64]) {
        self.apply_to(r, z, |sweeps, scale| sweeps.split_into_modes(r, scale));
    }
}

impl<T: Stored> FactoredModes for BlockIlu<T> {
    fn factor(&mut self, scales: TimeScales) {
        self.factor_beside(scales, |_| ());
    }
    fn ordering(&self) -> Ordering {
        self.ordering.clone()
    }
    fn bytes(&self) -> usize {
        self.jacobian.bytes() + self.couplings.bytes() + size_of_val(&self.inverses[..])
    }
}

impl<const D: usize, const M: usize, T: Stored + 'static> FlowPreconditioner<D, M> for BlockIlu<T> {
    fn updated(
        mut self: Box<Self>,
        flow: &SlabOperator<D, M>,
        scales: TimeScales,
    ) -> Box<dyn FlowPreconditioner<D, M>> {
        self.update(flow, scales);
        self
    }
}

/// Room for a thread.
pub(super) struct Scratch {
    /// Traces, `[column][padded trace]`.
    pub(super) taken: Vec<f32>,
    pub(super) sent: Vec<f32>,
    /// The columns (re, -im) and (im, re) of a complex vector.
    pub(super) turned: Vec<f32>,
}
