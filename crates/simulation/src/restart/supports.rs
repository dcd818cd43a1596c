//! The supports of a structure go on from where they are.

use super::{Origin, RestartError};
use crate::bodies::beside_flow;
use crate::build::{StructureAtStart, structure_at_start};
use crate::motion_jump::{self, MOMENT};
use case::Case;
use coupled::{State, rounded_time};
use tensor::AXES;

/// How far a support may be from its formula, relative to its displacement: positions are the quadrature of velocities.
const DRIFT: f64 = 1e-3;

/// The same, relative to the size of the mesh.
const ROUND_OFF: f64 = 1e-9;

impl Origin {
    /// Supports that differ from those of the run must begin where the structure of `state` is: only their velocities are prescribed. Returns
    /// a warning if these jump.
    pub(super) fn check_supports<const D: usize>(
        &self,
        case: &Case<D>,
        state: &State,
    ) -> Result<Option<String>, RestartError> {
        let (Some((structure, _)), Some(stored)) = (beside_flow(case), state.bodies.last()) else { return Ok(None) };
        if !self.is_other(case, &["constants", "tables", "structure"])? {
            return Ok(None);
        }
        // A structure that cannot be built is an error of the run.
        let Ok(structure) = structure_at_start(case, structure) else { return Ok(None) };
        let StructureAtStart { body, supports, .. } = &structure;
        let there = &stored[..body.length()];
        let mut here = there.to_vec();
        supports.set(body, &mut here, |field, x| field.value(x, state.time));
        let largest = there.iter().chain(&here).fold(0.0, |most: f64, d| most.max(d.abs()));
        let least = DRIFT * largest + ROUND_OFF * case.mesh.diameter();
        let nodes = body.coordinates().iter().zip(there.chunks_exact(D).zip(here.chunks_exact(D)));
        let jumps = |there: &[f64], here: &[f64]| there.iter().zip(here).any(|(a, b)| (a - b).abs() > least);
        let Some((position, (there, here))) = nodes.into_iter().find(|(_, (there, here))| jumps(there, here)) else {
            return Ok(self.jump_of_supports(case, &structure, stored, state.time));
        };
        Err(RestartError::SupportJumps {
            path: self.path.clone(),
            time: rounded_time(state.time),
            position: position.to_vec(),
            there: there.to_vec(),
            here: here.to_vec(),
        })
    }

    /// A warning if a support changes its velocity at once at time `t`, from the rates `stored` after the positions.
    fn jump_of_supports<const D: usize>(
        &self,
        case: &Case<D>,
        StructureAtStart { body, supports, .. }: &StructureAtStart<D>,
        stored: &[f64],
        t: f64,
    ) -> Option<String> {
        let moment = MOMENT * case.time.step;
        let there = &stored[body.length()..2 * body.length()];
        let mut here = there.to_vec();
        supports.set(body, &mut here, |field, x| {
            std::array::from_fn(|i| motion_jump::rate(|t| field.value(x, t)[i], t, moment))
        });
        let fastest = there.iter().chain(&here).fold(0.0, |most: f64, v| most.max(v.abs()));
        let least = motion_jump::small(fastest, case.mesh.diameter(), case.time.step);
        let place = there.iter().zip(&here).position(|(there, here)| (there - here).abs() > least)?;
        let (node, axis, path) = (place / D, AXES[place % D], self.path.display());
        Some(format!(
            "a support of the structure changes its velocity at once at t = {}, which sends waves into structure and flow: along {axis} the point \
             at {:?} moves with {:.6} in `{path}`, and with {:.6} from here on",
            rounded_time(t),
            body.coordinates()[node],
            there[place],
            here[place]
        ))
    }
}
