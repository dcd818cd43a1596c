//! The driven coordinates of bodies go on from where they are.

use super::{Origin, RestartError};
use crate::motion_jump::{self, MOMENT};
use case::{Case, Freedom, freedoms_of};
use coupled::block::BodyState;
use coupled::{State, is_before, rounded_time};

impl Origin {
    /// Driven coordinates of bodies must be where their motion puts them.
    pub(super) fn check_drives<const D: usize>(&self, case: &Case<D>, state: &State) -> Result<(), RestartError> {
        for (body, stored) in case.bodies.iter().zip(&state.bodies) {
            for (freedom, &there) in body.freedoms.iter().zip(stored) {
                let Some(motion) = drive(freedom, state.time, case.time.step) else { continue };
                let here = motion(state.time);
                if (there - here).abs() > 1e-9 * (freedom.size(&case.mesh) + there.abs().max(here.abs())) {
                    let (path, time, body) = (self.path.clone(), rounded_time(state.time), body.name.clone());
                    return Err(RestartError::BodyJumps { path, time, body, coordinate: freedom.name, there, here });
                }
            }
        }
        Ok(())
    }

    /// A warning if a driven coordinate changes its rate at once, because its motion is not that of the run, or if the case gives a free one
    /// another `rate`.
    pub(super) fn jump_of_drives<const D: usize>(
        &self,
        case: &Case<D>,
        state: &State,
    ) -> Result<Option<String>, RestartError> {
        if case.bodies.is_empty() || !self.is_other(case, &["constants", "tables", "bodies"])? {
            return Ok(None);
        }
        let before = match freedoms_of(&self.result.metadata.case_text, case) {
            Ok(before) => before,
            Err(reason) => {
                let path = self.path.display();
                return Ok(Some(format!("the rates of the bodies in `{path}` cannot be compared: {reason}")));
            }
        };
        let bodies = case.bodies.iter().zip(&before).zip(&state.bodies);
        let of_body = |((body, before), stored): ((&case::RigidBody<D>, &Vec<Freedom>), &Vec<f64>)| {
            let rates = &stored[BodyState::coordinates(stored)..];
            let mut freedoms = body.freedoms.iter().zip(before).zip(rates);
            freedoms.find_map(|((now, before), rate)| {
                self.jump_of_rate(case, (&body.name, now), (before, *rate), state.time)
                    .or_else(|| self.rate_without_effect((&body.name, now), (before, *rate)))
            })
        };
        Ok(bodies.into_iter().find_map(of_body))
    }

    /// The warning about the coordinate `now` of a body, which was `before` and had this `rate` at the end of the run.
    fn jump_of_rate<const D: usize>(
        &self,
        case: &Case<D>,
        (body, now): (&str, &Freedom),
        (before, rate): (&Freedom, f64),
        t: f64,
    ) -> Option<String> {
        let (step, moment) = (case.time.step, MOMENT * case.time.step);
        let here = motion_jump::rate(drive(now, t, step)?, t, moment);
        // The stored rate of a driven coordinate has the error of a slab.
        let there = drive(before, t, step).map_or(rate, |motion| motion_jump::rate(motion, t, -moment));
        let least = motion_jump::small(there.abs().max(here.abs()), now.size(&case.mesh), step);
        ((there - here).abs() > least).then(|| {
            format!(
                "the body `{body}` changes its rate at once at t = {}, which sends a pressure wave into the flow: the rate of `{}` is {there:.6} in \
                 `{}`, and {here:.6} from here on",
                rounded_time(t),
                now.name,
                self.path.display()
            )
        })
    }

    /// The warning about a coordinate whose `rate` was changed, while it goes on with the rate of the run.
    fn rate_without_effect(&self, (body, now): (&str, &Freedom), (before, rate): (&Freedom, f64)) -> Option<String> {
        (now.rate != before.rate).then(|| {
            format!(
                "`bodies.{body}.{}.rate` has no effect: the coordinate goes on with the rate {rate:.6} of `{}`; a `force` or a `motion` with \
                 `release` can change it",
                now.name,
                self.path.display()
            )
        })
    }
}

/// The motion of a coordinate, if that drives it in slabs from time `t` on, most of which have the length `step`.
fn drive(freedom: &Freedom, t: f64, step: f64) -> Option<impl Fn(f64) -> f64> {
    let is_driven = freedom.release.is_none_or(|release| is_before(t, release, step));
    let motion = freedom.motion.as_ref().filter(|_| is_driven)?;
    Some(move |t| motion.evaluate::<f64>(&[], t))
}
