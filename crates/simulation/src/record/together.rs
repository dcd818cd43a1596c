//! Cells of a step and of a state that a rank writes, where all ranks write the result together.

use super::layout::layout;
use super::step_parts::StepParts;
use super::{MeshView, Snapshot};
use crate::cells;
use crate::crew::{LongArray, Order, Together};
use crate::error::Failure;
use case::Case;
use coupled::FlowMarch;
use navier_stokes::NavierStokes;
use std::borrow::Cow;
use std::path::Path;
use std::sync::Arc;

/// A time, and the motion of the mesh then.
#[derive(Clone, Copy)]
pub(super) struct Moment<'a> {
    time: f64,
    /// `[C0 node][component]`
    displacement: &'a [f64],
    /// `[time node][C0 node][component]`
    velocities: &'a [f64],
}

impl<'a> Moment<'a> {
    pub(super) fn of(snapshot: &Snapshot<'a>) -> Self {
        let Snapshot { time, displacement, velocities, .. } = *snapshot;
        Moment { time, displacement, velocities }
    }
}

impl<'a, const D: usize, const M: usize> StepParts<'a, D, M> {
    /// Of the steps of a run of `case`, on a rank that has a share of it.
    pub fn of_march(case: &'a Case<D>, march: &FlowMarch<D, M>) -> Self
    where
        NavierStokes<D>: navier_stokes::Compiled<D, M, Boundary = navier_stokes::Boundary<D>>,
    {
        let mover = &march.solver.system.mesh.mover;
        StepParts::new(case, Arc::new(MeshView::new(&mover.reference, &mover.numbering)))
    }

    /// [`Self::write`] for the last slab of `march`, or its start.
    ///
    /// # Errors
    /// As [`Self::write`].
    pub fn write_own(&self, march: &FlowMarch<D, M>, together: &Together, path: &Path) -> Result<(), Failure>
    where
        NavierStokes<D>: navier_stokes::Compiled<D, M, Boundary = navier_stokes::Boundary<D>>,
    {
        let coupled::State { time, d: displacement, past, .. } = &march.state;
        let at_start = || vec![0.0; displacement.len() * self.case.time.order];
        let velocities = past.as_ref().map_or_else(|| at_start().into(), |past| past.v.clone());
        self.write(&Moment { time: *time, displacement, velocities: &velocities }, together, path)
    }

    /// Has all ranks write the cells of a step to the file at `path`, each some of them. A collective call.
    ///
    /// # Errors
    /// A file that a rank cannot write.
    pub(super) fn write(&self, moment: &Moment, together: &Together, path: &Path) -> Result<(), Failure> {
        let Moment { time, displacement, velocities } = *moment;
        together.write(Order::WriteStep, path, layout::<D, M>(self.case), |file| {
            together.deal_step(self.rounds(together.size()), |cells, numbers| {
                let flow = &|_| Cow::Borrowed(&numbers.flow[..]);
                let averages = &|_| numbers.averages.clone();
                let (structure, together) = (None, None);
                let of_cells = Snapshot { time, displacement, velocities, flow, structure, averages, together };
                self.of_cells(&of_cells, cells.clone()).write_to(file, cells.start)
            })
        })
    }
}

/// Has all ranks write the cells of a state to the file at `path`, each some of them. A collective call.
///
/// # Errors
/// A file that a rank cannot write.
pub fn write_state<const D: usize, const M: usize>(
    case: &Case<D>,
    together: &Together,
    path: &Path,
) -> Result<(), Failure> {
    together.write(Order::WriteState, path, layout::<D, M>(case), |file| {
        let write = |array: &LongArray| {
            let rounds = cells::rounds(case.mesh.n_cells(), array.len, together.size());
            together.deal(array, rounds, |cells, values| file.write_state(array.name, cells.start * array.len, &values))
        };
        // Each rank deals every array, also after an error.
        together.arrays.iter().map(write).fold(Ok(()), Result::and)
    })
}
