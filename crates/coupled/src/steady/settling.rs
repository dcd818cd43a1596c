//! Whether a flow settles when it is marched in time.

use super::residual_norms;
use super::search::{Discretisation, Search};
use crate::coupled_slab::{FlowMarch, Jacobian, Predictor, Settings};
use crate::schedule::Schedule;
use crate::slab_error::SlabError;
use crate::system::System;
use newton_krylov::newton;

/// Slabs of a march. Each has two time nodes.
const SLABS: usize = 48;

/// Slabs in a time unit. Their scheme has order 3 and hardly damps oscillations with the period of a time unit.
pub(super) const PER_TIME_UNIT: f64 = 6.0;

/// A flow settles if its rate of change falls below this part of the earlier one.
const CALM: f64 = 0.5;

/// The rate of change of a flow that was marched in time from the best state of a search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settling {
    /// |du/dt| in the first quarter of the march: the mean of its logarithm. L2 mean over the domain, components in units of their scales.
    pub early: f64,
    /// The same in the last quarter.
    pub late: f64,
    /// The time marched.
    pub duration: f64,
}

impl Settling {
    /// Whether the flow becomes steady.
    pub fn calms_down(&self) -> bool {
        self.late < CALM * self.early
    }

    /// Whether the rate of change does not even fall slowly.
    pub fn is_unsteady(&self) -> bool {
        self.late >= self.early
    }

    /// The result, as part of a sentence.
    pub fn describe(&self) -> String {
        let Settling { early, late, duration } = self;
        let seen = format!(
            "marched in time for {duration:.2e} from the best state, its rate of change went from {early:.2e} to {late:.2e}"
        );
        match (self.calms_down(), self.is_unsteady()) {
            (true, _) => format!("though the flow calms down: {seen}"),
            (_, true) => format!("for the flow is unsteady: {seen}"),
            _ => format!("for the flow settles slowly: {seen}"),
        }
    }
}

/// Marches `u` in time on data of the time of `search`. `None` if that fails. `u` becomes the flow where the march has ended.
pub(super) fn settle<const D: usize, const M: usize>(search: &Search<'_, D, M>, u: &mut Vec<f64>) -> Option<Settling> {
    let rates = rates_of_change(search, u, SLABS);
    let quarter = SLABS / 4;
    let late = rates.get(SLABS - quarter..).filter(|late| late.len() == quarter)?;
    Some(Settling { early: mean(&rates[..quarter]), late: mean(late), duration: duration(search, SLABS) })
}

/// |du/dt| after each of `slabs` slabs of a march in time from `u`; fewer numbers if the march fails or the search is stopped. `u` becomes the
/// flow where it has ended.
pub(super) fn rates_of_change<const D: usize, const M: usize>(
    search: &Search<'_, D, M>,
    u: &mut Vec<f64>,
    slabs: usize,
) -> Vec<f64> {
    let _timed = tracing::info_span!("marching in time").entered();
    let (mut steady, _) = (search.discretise)(search.own());
    let mut march = march(search, u, slabs);
    let mut rates = Vec::with_capacity(slabs);
    while !march.is_done() && !(search.is_stopped)() && march.advance().is_ok() {
        let Ok(rate) = rate_of_change(search, &mut steady, &march.state.u) else { break };
        rates.push(rate);
    }
    u.clone_from(&march.state.u);
    rates
}

fn rate_of_change<const D: usize, const M: usize>(
    search: &Search<'_, D, M>,
    steady: &mut System<D, M>,
    u: &[f64],
) -> Result<f64, SlabError> {
    steady.at_rest(search.times(), u, search.displacement)?;
    Ok(residual_norms(steady, u)?[0] / (super::STEADY_SLAB_LENGTH * search.time_unit))
}

/// The mean of the logarithm, as a rate.
pub(super) fn mean(rates: &[f64]) -> f64 {
    (rates.iter().map(|rate| rate.max(f64::MIN_POSITIVE).ln()).sum::<f64>() / rates.len() as f64).exp()
}

/// The length of `slabs` slabs.
pub(super) fn duration<const D: usize, const M: usize>(search: &Search<'_, D, M>, slabs: usize) -> f64 {
    search.time_unit / PER_TIME_UNIT * slabs as f64
}

fn march<const D: usize, const M: usize>(search: &Search<'_, D, M>, u: &[f64], slabs: usize) -> FlowMarch<D, M> {
    let (mut problem, _) = (search.discretise)(Discretisation { time_order: 2, ..search.own() });
    problem.hold_time(search.time);
    let end = search.time + duration(search, slabs);
    let schedule =
        Schedule { start: search.time, end, step: duration(search, 1), slabs, control: None, begins: Vec::new() };
    let newton = newton::Settings { relative_tolerance: 1e-3, ..newton::Settings::default() };
    let settings =
        Settings { schedule, newton, predictor: Predictor::Elastic, jacobian: Jacobian::Exact, max_halvings: 4 };
    let mut march = FlowMarch::new(problem, u.to_vec(), settings);
    march.state.d.copy_from_slice(search.displacement);
    march
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A flow whose rate of change fell slowly was called unsteady, and a duration of 8e-6 was told as 0.000.
    #[test]
    fn only_a_rate_of_change_that_does_not_fall_is_unsteady() {
        let told = |late: f64| Settling { early: 7e-3, late, duration: 8e-6 }.describe();
        for (late, part) in [(3e-3, "calms down"), (6.6e-3, "settles slowly"), (7.1e-3, "is unsteady")] {
            assert!(told(late).contains(part) && told(late).contains("for 8.00e-6 from"), "{}", told(late));
        }
    }
}
