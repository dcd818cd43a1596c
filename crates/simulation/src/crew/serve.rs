//! What the other ranks do.

use super::orders::{self, Order};
use super::parts::{self, Own};
use super::together::{Together, path_of};
use super::{add_up, advance, agree, begin_averages, march, peak_memories, require_one_case, stored};
use crate::averages::{AverageSums, add_slab};
use crate::record::{StepParts, write_state};
use crate::steady_search::find;
use crate::{controls, errors, integrals};
use case::{AnyCase, Case, Flow};
use coupled::FlowMarch;
use navier_stokes::{Compiled, NavierStokes};
use ranks::Communicator;
use std::borrow::Cow;
use std::sync::Arc;

/// Executes the orders of rank 0, until it orders to finish.
pub fn serve(case: &AnyCase, communicator: &Arc<dyn Communicator>) {
    rayon::scope(|_| match case {
        AnyCase::Plane(case) => serve_in::<2, 4>(case, communicator),
        AnyCase::Space(case) => serve_in::<3, 5>(case, communicator),
    });
}

fn serve_in<const D: usize, const M: usize>(case: &Case<D>, communicator: &Arc<dyn Communicator>)
where
    NavierStokes<D>: Compiled<D, M, Boundary = navier_stokes::Boundary<D>>,
{
    let Some(flow) = &case.flow else {
        // Rank 0 refuses such a case, or finds that this rank has read another one, and says that it has finished.
        loop {
            match orders::receive(&**communicator).0 {
                Order::Finish => return,
                Order::Build => drop(require_one_case(case, &**communicator)),
                _ => {}
            }
        }
    };
    let (averages, step_parts) = (AverageSums::default(), None);
    let mut worker = Worker { case, flow: Cow::Borrowed(flow), communicator, averages, step_parts };
    let mut own: Option<FlowMarch<D, M>> = None;
    loop {
        let (order, state) = orders::receive(&**communicator);
        match (order, &mut own) {
            (Order::Finish, _) => return,
            // An error is that of all ranks; rank 0 tells it.
            (Order::Build, _) => own = march(case, &worker.flow, communicator).ok(),
            (Order::TellMemory, _) => drop(peak_memories(&**communicator)),
            (order, Some(march)) => worker.obey(order, &state, march),
            (_, None) => {}
        }
    }
}

/// What a rank has beside its part of the march.
struct Worker<'a, const D: usize, const M: usize> {
    case: &'a Case<D>,
    /// In another form once the run has changed to it.
    flow: Cow<'a, Flow<D>>,
    communicator: &'a Arc<dyn Communicator>,
    averages: AverageSums,
    /// The cells of a step in the result file, once a step was written.
    step_parts: Option<StepParts<'a, D, M>>,
}

impl<const D: usize, const M: usize> Worker<'_, D, M>
where
    NavierStokes<D>: Compiled<D, M, Boundary = navier_stokes::Boundary<D>>,
{
    /// Executes an order that comes with a `state`. Errors are those of all ranks, and rank 0 tells them.
    fn obey(&mut self, order: Order, state: &[u8], march: &mut FlowMarch<D, M>) {
        let (case, averages) = (self.case, &mut self.averages);
        match order {
            Order::Restore => self.restore(state, march),
            Order::SearchSteadyFlow => {
                case.solver.steady.iter().for_each(|steady| drop(find(case, &self.flow, steady, march, &())));
            }
            Order::Advance => {
                controls::receive(case, &orders::decode(state));
                if let Ok(Some(_)) = advance(march) {
                    add_slab(case, &self.flow, march, averages);
                }
            }
            Order::BeginAverages => drop(begin_averages(case, march, averages)),
            Order::Send => parts::serve(Own { march, averages }, &orders::decode(state)),
            Order::SendPlaces => drop(parts::join_places(march)),
            Order::Integrate => drop(integrals::of_run(case, &self.flow, march)),
            Order::AddUp => drop(add_up(march)),
            Order::Measure => drop(errors::of_cells(&self.flow, march)),
            Order::WriteState => self.write(state, march, false),
            Order::WriteStep => self.write(state, march, true),
            Order::Finish | Order::Build | Order::TellMemory => {}
        }
    }

    fn restore(&mut self, state: &[u8], march: &mut FlowMarch<D, M>) {
        let common = orders::decode(state);
        controls::set_for_preconditioner(self.case, Some(&common));
        let share = &march.solver.system.flow.operator.share;
        let own = parts::with_own_arrays(common, share, |_, _| Vec::new());
        // Rank 0 may not have been able to read.
        if let Ok(own) = agree(&**self.communicator, Ok(own)) {
            stored::restore(self.case, &mut self.flow, &own, (march, &mut self.averages));
        }
    }

    /// Writes the own cells of the state, and those of a step if `is_step`.
    fn write(&mut self, state: &[u8], march: &FlowMarch<D, M>, is_step: bool) {
        let own = Own { march, averages: &self.averages };
        let Some(together) = Together::new(own, &**self.communicator, None) else { return };
        let path = path_of(&orders::decode(state));
        drop(if is_step {
            let parts = self.step_parts.get_or_insert_with(|| StepParts::of_march(self.case, march));
            parts.write_own(march, &together, &path)
        } else {
            write_state::<D, M>(self.case, &together, &path)
        });
    }
}
