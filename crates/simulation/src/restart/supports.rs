//! The supports of a structure go on from where they are.

use super::{Origin, RestartError};
use crate::bodies::beside_flow;
use crate::build::{StructureAtStart, structure_at_start};
use case::Case;
use coupled::State;

/// How far a support may be from its formula, relative to its displacement: positions are the quadrature of velocities.
const DRIFT: f64 = 1e-3;

/// The same, relative to the size of the mesh.
const ROUND_OFF: f64 = 1e-9;

impl Origin {
    /// Supports that differ from those of the run must begin where the structure of `state` is: only their velocities are prescribed.
    pub(super) fn check_supports<const D: usize>(&self, case: &Case<D>, state: &State) -> Result<(), RestartError> {
        let (Some((structure, _)), Some(stored)) = (beside_flow(case), state.bodies.last()) else { return Ok(()) };
        if !self.is_other(case, &["constants", "tables", "structure"])? {
            return Ok(());
        }
        // A structure that cannot be built is an error of the run.
        let Ok(StructureAtStart { body, supports, .. }) = structure_at_start(case, structure) else { return Ok(()) };
        let there = &stored[..body.length()];
        let mut here = there.to_vec();
        supports.set(&body, &mut here, |field, x| field.value(x, state.time));
        let largest = there.iter().chain(&here).fold(0.0, |most: f64, d| most.max(d.abs()));
        let least = DRIFT * largest + ROUND_OFF * case.mesh.diameter();
        let nodes = body.coordinates().iter().zip(there.chunks_exact(D).zip(here.chunks_exact(D)));
        let jumps = |there: &[f64], here: &[f64]| there.iter().zip(here).any(|(a, b)| (a - b).abs() > least);
        let Some((position, (there, here))) = nodes.into_iter().find(|(_, (there, here))| jumps(there, here)) else {
            return Ok(());
        };
        Err(RestartError::SupportJumps {
            path: self.path.clone(),
            time: state.time,
            position: position.to_vec(),
            there: there.to_vec(),
            here: here.to_vec(),
        })
    }
}
