//! From failure data to causes in words, the likeliest first.
//!
//! Every rule reads a few data and returns a likelihood between 0 and 1: a judgement, not a probability. Observations at the start of
//! a run count more than those in the failed state, which may be a consequence.

mod body_rules;
mod gas_rules;
mod mesh_rules;
mod solver_rules;
mod structure_rules;
#[cfg(test)]
mod tests;

use super::data::{FailureData, GaveUp};
use serde::Serialize;

/// A possible cause.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Cause {
    /// A short name.
    pub name: &'static str,
    /// Its likelihood, between 0 and 1.
    pub likelihood: f64,
    /// The cause, with the measurements.
    pub what: String,
    /// The remedy.
    pub remedy: String,
}

/// The name of the cause that Newton's method was allowed too few steps.
pub const NEWTON_STEPS: &str = "newton_steps";

/// The largest number of causes that are named.
const NAMED: usize = 3;

/// A cause that is less likely is not named.
const UNLIKELY: f64 = 0.02;

type Rule = fn(&FailureData) -> Option<Cause>;

const OF_MESH: [Rule; 11] = [
    mesh_rules::undefined_motion,
    mesh_rules::far_away,
    mesh_rules::deformation,
    mesh_rules::folding_formula,
    mesh_rules::far_in_one_slab,
    body_rules::far_in_one_slab,
    body_rules::folding_weights,
    body_rules::unheld,
    mesh_rules::stiffness,
    mesh_rules::uneven_cells,
    mesh_rules::nearly_incompressible,
];

const OF_STRUCTURE: [Rule; 6] = [
    structure_rules::inverted_start,
    structure_rules::squeezed,
    structure_rules::limit_load,
    structure_rules::long_slab,
    structure_rules::slender_cells,
    structure_rules::nearly_incompressible,
];

const OF_FLOW: [Rule; 20] = [
    gas_rules::no_value,
    gas_rules::boundary_value,
    gas_rules::opening,
    gas_rules::near_vacuum,
    gas_rules::boundary_condition,
    gas_rules::kick,
    gas_rules::shock,
    gas_rules::steep_start,
    gas_rules::not_resolved,
    gas_rules::quadrature,
    solver_rules::no_steady_flow,
    solver_rules::newton_steps,
    solver_rules::linear_solver,
    solver_rules::time_step,
    solver_rules::tolerance,
    mesh_rules::nearly_inverted,
    body_rules::far_in_one_slab,
    body_rules::light_body,
    body_rules::unheld,
    body_rules::crushed,
];

/// The likeliest causes, in decreasing order.
pub fn causes(data: &FailureData) -> Vec<Cause> {
    let rules: &[Rule] = match data.gave_up {
        GaveUp::InvertedCell | GaveUp::Equilibrium => &OF_MESH,
        GaveUp::Load => &[structure_rules::bad_load],
        GaveUp::Structure => &OF_STRUCTURE,
        GaveUp::Inadmissible | GaveUp::Newton | GaveUp::LinearSolver => &OF_FLOW,
        GaveUp::Other => &[body_rules::unheld],
    };
    let mut causes: Vec<Cause> =
        rules.iter().filter_map(|rule| rule(data)).filter(|cause| cause.likelihood >= UNLIKELY).collect();
    // The sort is stable: of equal likelihoods the first rule comes first.
    causes.sort_by(|a, b| b.likelihood.total_cmp(&a.likelihood));
    causes.truncate(NAMED);
    causes
}

/// Increases from 0 to 1 with `fact`, 1/2 at `half`.
fn rises(fact: f64, half: f64) -> f64 {
    let ratio = (fact / half).powi(2);
    if ratio.is_finite() { ratio / (1.0 + ratio) } else { 1.0 }
}

/// A number in a sentence.
fn number(value: f64) -> String {
    if value == 0.0 || (1e-3..1e5).contains(&value.abs()) {
        let rounded: f64 = format!("{value:.2e}").parse().unwrap_or(value);
        return rounded.to_string();
    }
    format!("{value:.1e}")
}
