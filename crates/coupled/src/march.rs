//! The march from slab to slab, for any slab solver.

use crate::schedule::Schedule;
use crate::slab_error::{MarchError, SlabError, chain};
use crate::state::{Interval, State};

/// The solver of a slab.
pub trait SlabSolver {
    /// A slab that is solved.
    type Solved;
    /// Its report.
    type Report;

    /// Solves the slab `interval` on top of `state`.
    ///
    /// # Errors
    /// [`SlabError`]; the slab may then be tried again with another length.
    fn solve(&mut self, state: &State, interval: Interval) -> Result<Self::Solved, SlabError>;

    /// Moves the fields of `state` to the top of the slab `interval`. The march updates time and number.
    fn finish(&mut self, state: &mut State, interval: Interval, solved: Self::Solved) -> Self::Report;

    /// The jump, which controls the length of slabs, and the number of nodes in time.
    fn jump(&self, _solved: &Self::Solved) -> (f64, usize) {
        (0.0, 1)
    }

    /// Called when the last attempt has failed.
    fn reject(&mut self) {}

    /// Whether shorter slabs are not worth a try after the failure `source`, because the caller can go on in another way.
    fn gives_way(&self, _source: &SlabError) -> bool {
        false
    }

    /// Makes the initial state easier, so that a slab of the same length can be tried again. Returns a message, or `None` if nothing was
    /// done.
    fn ease_start(&mut self, _state: &mut State) -> Option<String> {
        None
    }
}

/// A run in progress.
pub struct March<S> {
    /// The solver of a slab.
    pub solver: S,
    /// The state at the time reached.
    pub state: State,
    pub(crate) schedule: Schedule,
    /// How often a slab may be halved before the run gives up.
    pub max_halvings: u32,
}

impl<S: SlabSolver> March<S> {
    /// A run of `solver` from `state` through the slabs of `schedule`. A slab that cannot be solved is halved, at most `max_halvings`
    /// times, or down to the smallest step of an adaptive schedule.
    pub(crate) fn from(solver: S, state: State, schedule: Schedule, max_halvings: u32) -> Self {
        March { solver, state, schedule, max_halvings }
    }

    /// Whether the end is reached.
    pub fn is_done(&self) -> bool {
        self.schedule.is_done(&self.state)
    }

    /// Advances one slab; shortens it if it cannot be solved.
    ///
    /// # Errors
    /// [`MarchError`]; the state is then that of the last slab that succeeded.
    pub fn advance(&mut self) -> Result<S::Report, MarchError> {
        loop {
            if let Some(report) = self.attempt()? {
                return Ok(report);
            }
        }
    }

    /// Attempts to advance one slab. `None` if the attempt is rejected; the next one is easier.
    ///
    /// # Errors
    /// [`MarchError`] if there is no easier one.
    pub fn attempt(&mut self) -> Result<Option<S::Report>, MarchError> {
        let interval = self.schedule.pending(&mut self.state);
        match self.solver.solve(&self.state, interval) {
            Ok(solved) if self.repeats(interval, &solved) => {}
            Ok(solved) => return Ok(Some(self.accept(interval, solved))),
            Err(source) => self.go_on(interval, source)?,
        }
        self.state.rejected += 1;
        Ok(None)
    }

    /// Whether the slab is too long for its jump: the next attempt is shorter.
    fn repeats(&mut self, interval: Interval, solved: &S::Solved) -> bool {
        let (jump, time_order) = self.solver.jump(solved);
        let repeats = self.schedule.repeats(&mut self.state, interval, jump, time_order);
        if repeats {
            tracing::info!(start = interval.start, end = interval.end, jump, "slab too long, shortened");
        }
        repeats
    }

    /// Prepares another attempt after `interval` has failed: an easier start, or a shorter slab.
    ///
    /// # Errors
    /// [`MarchError`] if neither is allowed, or the solver gives way.
    fn go_on(&mut self, interval: Interval, source: SlabError) -> Result<(), MarchError> {
        let (cause, times, length) = (chain(&source), source.halvings(), interval.length());
        let easier = source.is_of_flow().then(|| self.solver.ease_start(&mut self.state)).flatten();
        let remedy = match easier {
            Some(done) => done,
            None if !source.is_final()
                && !self.solver.gives_way(&source)
                && self.schedule.shorten(&mut self.state, interval, (times, self.max_halvings)) =>
            {
                self.state.failed.get_or_insert(interval);
                let next = self.schedule.pending(&mut self.state);
                let times = halvings(length, next.length());
                if times > 1 { format!("it is halved {times} times") } else { "it is halved".into() }
            }
            None => {
                let first = self.state.failed.map_or(length, |failed| failed.length());
                return Err(MarchError::new(&self.state, interval, halvings(first, length), source));
            }
        };
        tracing::warn!(start = interval.start, end = interval.end, cause, "slab rejected: {remedy}");
        self.solver.reject();
        Ok(())
    }

    /// Moves the state to the top of the slab.
    fn accept(&mut self, interval: Interval, solved: S::Solved) -> S::Report {
        let (jump, time_order) = self.solver.jump(&solved);
        let report = self.solver.finish(&mut self.state, interval, solved);
        self.state.finish(interval);
        self.schedule.adapt(&mut self.state, interval, jump, time_order);
        report
    }
}

/// How often a slab of length `before` was halved until it had length `after`, rounded: an adaptive slab may end at a limit.
fn halvings(before: f64, after: f64) -> usize {
    (before / after).log2().round().max(0.0) as usize
}

#[cfg(test)]
mod tests {
    use super::halvings;

    #[test]
    fn halvings_are_counted_by_lengths() {
        assert_eq!([halvings(0.5, 0.5), halvings(0.5, 0.25), halvings(0.5, 0.0625), halvings(0.5, 0.2)], [0, 1, 3, 1]);
    }
}
