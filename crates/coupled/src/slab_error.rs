//! Why a slab, or a run, could not be solved.

use crate::clock::rounded_time;
use crate::mesh_mover::MeshQuality;
use crate::state::{Interval, State};
use crate::system::ResidualBreakdown;
use newton_krylov::newton;
use newton_krylov::problem::Inadmissible;

/// Why a slab could not be solved.
#[derive(Debug, thiserror::Error)]
pub enum SlabError {
    /// The mesh equations were not solved.
    #[error("the mesh could not be moved")]
    Mesh(#[from] elasticity::ElasticityError),
    /// The equations of a structure were not solved.
    #[error(transparent)]
    Structure(elasticity::ElasticityError),
    /// A cell is not proved to stay valid.
    #[error("cell {} is inverted or nearly so at t = {}: det J / det J_0 = {:e}", quality.cell, quality.time, quality.sampled_min)]
    Invalid {
        /// What was found.
        quality: MeshQuality,
    },
    /// The rotation vector of a body that turns about several axes ends at a full turn.
    #[error(
        "body \"{body}\" has turned by {angle:.3}, and its rotation vector ends at a full turn, 6.283: shorter slabs do not help. Let it turn about a \
         single axis, or end the run earlier"
    )]
    FullTurn {
        /// The body.
        body: String,
        /// The length of the rotation vector.
        angle: f64,
    },
    /// A body meets its stops in a slab that is too long for the contact: the time integration gives it energy.
    #[error(
        "the slab is too long for the contact of body \"{body}\" with its stops: the time integration adds {:.1} % to the energy of the body. Take shorter \
         slabs, softer stops, or `time.adaptive`",
        100.0 * gain
    )]
    EnergyGain {
        /// The body.
        body: String,
        /// The energy that it gains, relative to its energy.
        gain: f64,
    },
    /// The guess that stays as it is at the bottom of the slab is not admissible.
    #[error("no admissible guess")]
    Guess(#[from] Inadmissible),
    /// The solution has a negative density or pressure at the end of the slab. The equations constrain the interior of the slab only.
    #[error("the equations have a solution that is not admissible at the top of the slab")]
    Top(#[source] Inadmissible),
    /// The caller wants no more steps.
    #[error("stopped")]
    Stopped,
    /// Newton failed.
    #[error("the equations of flow and mesh are not solved{}", largest_in(residual_breakdown.as_deref()))]
    Newton {
        /// The parts of the residual, if it is defined.
        residual_breakdown: Option<Box<ResidualBreakdown>>,
        /// Why.
        source: Box<newton::Error>,
    },
}

/// Halvings of a slab at once, at most.
const MOST_HALVINGS: f64 = 4.0;

impl SlabError {
    /// Whether the flow is at fault, and not the mesh.
    pub fn is_of_flow(&self) -> bool {
        matches!(self, SlabError::Newton { .. } | SlabError::Top(_))
    }

    /// Whether shorter slabs cannot help.
    pub(crate) fn is_final(&self) -> bool {
        matches!(self, SlabError::FullTurn { .. })
    }

    /// How often the slab should be halved. If Newton's steps were short, one half would fail as well. The step length was seen to grow
    /// with about dt^-2: a slab halved k times takes steps 4^k times as long. They should be at least a quarter of the increment.
    pub fn halvings(&self) -> u32 {
        let SlabError::Newton { source, .. } = self else { return 1 };
        let newton::Error::Fruitless { steps, report, .. } = &**source else { return 1 };
        let times = 0.5 * (0.25 / report.longest_of_last(*steps)).log2();
        times.round().clamp(1.0, MOST_HALVINGS) as u32
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use newton_krylov::newton::{Report, StepReport};

    /// Two failures of a cylinder in a sudden flow: at dt = 0.05 steps of 0.016, and four times shorter slabs were solved.
    #[test]
    fn the_shorter_the_steps_the_shorter_the_next_slab() {
        for (length, expected) in [(0.25, 1), (0.1, 1), (0.016, 2), (0.004, 3), (1e-9, 4)] {
            let step = StepReport {
                residual_norm: 1.0,
                field_norms: vec![],
                forcing: 0.1,
                linear_residual: 0.1,
                krylov_iterations: 1,
                step_length: length,
                inverse_pseudo_time: vec![],
                rejections: 0,
            };
            let report = Box::new(Report { steps: vec![step; 4], ..Report::default() });
            let source = Box::new(newton::Error::Fruitless { steps: 4, before: 1.0, report });
            assert_eq!(SlabError::Newton { residual_breakdown: None, source }.halvings(), expected, "{length}");
        }
        let top = Inadmissible { quantity: "density".into(), value: -1.0, location: "in cell 1".into() };
        assert_eq!(SlabError::Top(top).halvings(), 1);
    }

    /// A body at the end of its rotation vector was halved six times, and each time in vain.
    #[test]
    fn a_full_turn_is_not_halved() {
        assert!(SlabError::FullTurn { body: "top".into(), angle: 6.2 }.is_final());
        assert!(!SlabError::EnergyGain { body: "ball".into(), gain: 0.5 }.is_final());
    }
}

/// Where the residual is largest, for a message.
fn largest_in(residual_breakdown: Option<&ResidualBreakdown>) -> String {
    residual_breakdown
        .and_then(ResidualBreakdown::worst_cell)
        .map_or(String::new(), |cell| format!("; their residual is largest in cell {cell}"))
}

/// The run stops: the smallest slab allowed could not be solved either.
#[derive(Debug, thiserror::Error)]
#[error(
    "slab {slab}, t = {} to {}, could not be solved{}",
    rounded_time(interval.start),
    rounded_time(interval.end),
    if *shortened > 0 { format!(", halved {shortened} times") } else { String::new() }
)]
pub struct MarchError {
    /// The number of the slab.
    pub slab: usize,
    /// The interval of the last attempt.
    pub interval: Interval,
    /// How often the slab was halved, rounded.
    pub shortened: usize,
    /// The error of the last attempt.
    #[source]
    pub source: SlabError,
}

impl MarchError {
    /// `interval`, the next one of `state`, has failed because of `source`, after it was `shortened` so often.
    pub(crate) fn new(state: &State, interval: Interval, shortened: usize, source: SlabError) -> Self {
        MarchError { slab: state.slab + 1, interval, shortened, source }
    }
}

/// An error and its causes in one line.
pub fn chain(error: &dyn std::error::Error) -> String {
    let causes = std::iter::successors(Some(error), |e| e.source());
    causes.map(ToString::to_string).collect::<Vec<_>>().join(": ")
}
