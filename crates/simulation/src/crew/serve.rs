//! What the other ranks do.

use super::orders::{self, Order};
use super::parts::{self, Own};
use super::together::{Together, path_of};
use super::{add_up, advance, agree, begin_averages, march, peak_memories, stored};
use crate::averages::{AverageSums, add_slab};
use crate::record::{StepParts, write_state};
use crate::steady_search::find;
use crate::{controls, errors, integrals};
use case::{AnyCase, Case, State};
use coupled::FlowMarch;
use fem::StateField;
use navier_stokes::{Compiled, Exact, ExactState, Manufactured, NavierStokes};
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
    State<D>: ExactState<D, M>,
    Exact<State<D>>: StateField<D, M>,
    Manufactured<State<D>, D>: StateField<D, M>,
{
    let Some(flow) = &case.flow else {
        // Rank 0 refuses such a case, and says that it has finished.
        while !matches!(orders::receive(&**communicator), (Order::Finish, _)) {}
        return;
    };
    let mut flow = Cow::Borrowed(flow);
    let mut own: Option<FlowMarch<D, M>> = None;
    let mut averages = AverageSums::default();
    let mut step_parts = None;
    loop {
        let (order, state) = orders::receive(&**communicator);
        match (order, &mut own) {
            (Order::Finish, _) => return,
            // An error is that of all ranks; rank 0 tells it.
            (Order::Build, _) => own = march(case, &flow, communicator).ok(),
            (Order::Restore, Some(march)) => {
                let common = orders::decode(&state);
                controls::set_for_preconditioner(case, Some(&common));
                let share = &march.solver.system.flow.operator.share;
                let own = parts::with_own_arrays(common, share, |_, _| Vec::new());
                // Rank 0 may not have been able to read.
                if let Ok(own) = agree(&**communicator, Ok(own)) {
                    stored::restore(case, &mut flow, &own, (march, &mut averages));
                }
            }
            (Order::SearchSteadyFlow, Some(march)) => {
                case.solver.steady.iter().for_each(|steady| drop(find(case, &flow, steady, march, &())));
            }
            (Order::Advance, Some(march)) => {
                controls::hear(case, &orders::decode(&state));
                // An error is that of all ranks.
                if let Ok(Some(_)) = advance(march) {
                    add_slab(case, &flow, march, &mut averages);
                }
            }
            (Order::BeginAverages, Some(march)) => drop(begin_averages(case, march, &mut averages)),
            (Order::Send, Some(march)) => {
                parts::serve(Own { march, averages: &averages }, &orders::decode(&state));
            }
            (Order::SendPlaces, Some(march)) => drop(parts::join_places(march)),
            (Order::Integrate, Some(march)) => drop(integrals::of_run(case, &flow, march)),
            (Order::AddUp, Some(march)) => drop(add_up(march)),
            (Order::Measure, Some(march)) => drop(errors::of_cells(&flow, march)),
            (Order::WriteStep | Order::WriteState, Some(march)) => {
                let own = Own { march, averages: &averages };
                let Some(together) = Together::new(own, &**communicator, None) else { continue };
                let path = path_of(&orders::decode(&state));
                // An error is that of all ranks.
                drop(match order {
                    Order::WriteState => write_state::<D, M>(case, &together, &path),
                    _ => {
                        let parts = step_parts.get_or_insert_with(|| StepParts::of_march(case, march));
                        parts.write_own(march, &together, &path)
                    }
                });
            }
            (Order::TellMemory, _) => drop(peak_memories(&**communicator)),
            (_, None) => {}
        }
    }
}
