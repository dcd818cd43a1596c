//! How the slabs of a run follow each other in time.
//!
//! The flow jumps from the top of a slab to the bottom of the next one, because polynomials in time are not exact. The jump is of order
//! dt^{N_t}, so that
//!
//! ```text
//! dt' = dt clamp( 0.9 (tolerance / jump)^{1/N_t}, 1/4, 2 )                                                    (step control)
//! ```
//!
//! keeps it at a tolerance. The jump is an error inside the slab. At its top the error is much smaller, of order dt^{2 N_t - 1}.

use crate::clock::is_before;
use crate::state::{Interval, State};

/// A slab is repeated when its jump is larger than the tolerance by this factor.
const TOO_LARGE: f64 = 2.0;

/// A slab that would leave less than this part of itself before the end is extended to the end.
const SLIVER: f64 = 0.01;

/// The slabs of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Schedule {
    /// The time at the start.
    pub start: f64,
    /// The time at the end.
    pub end: f64,
    /// The length of a slab; the last may be shorter. With a control, the length of the first.
    pub step: f64,
    /// The number of slabs of the run, unless some are halved. With a control it is an estimate.
    pub slabs: usize,
    /// The control of the length of slabs; `None` if the length is fixed.
    pub control: Option<StepControl>,
    /// Times at which a slab begins, whatever the control: a body is released there. Slabs of a fixed length must meet them anyway.
    pub begins: Vec<f64>,
}

/// Slabs as long as the jump at their bottom allows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepControl {
    /// The target of the jump: an L2 norm over the domain, every component in units of its scale.
    pub tolerance: f64,
    /// The shortest slab: it is accepted with any jump.
    pub smallest: f64,
    /// The longest slab.
    pub largest: f64,
}

impl StepControl {
    /// The length of the next slab by (step control), after one of length `dt` and order `time_order` with this `jump`.
    pub fn next(&self, dt: f64, jump: f64, time_order: usize) -> f64 {
        // A jump of zero gives infinity, which the clamp limits; 0/0 must not arise.
        let ratio = 0.9 * (self.tolerance / jump.max(f64::MIN_POSITIVE)).powf(1.0 / time_order as f64);
        (dt * ratio.clamp(0.25, 2.0)).clamp(self.smallest, self.largest)
    }

    /// Whether a slab of length `dt` with this `jump` has to be repeated with a shorter one. The shortest slab may be longer by rounding, or
    /// by a sliver before the end: a repetition would be the same slab.
    pub fn rejects(&self, dt: f64, jump: f64) -> bool {
        jump > TOO_LARGE * self.tolerance && dt > (1.0 + 2.0 * SLIVER) * self.smallest
    }
}

impl Schedule {
    /// `slabs` slabs of the same length, from time 0 to `end`.
    pub fn uniform(end: f64, slabs: usize) -> Self {
        Schedule { start: 0.0, end, step: end / slabs as f64, slabs, control: None, begins: Vec::new() }
    }

    /// Whether a run in this state is at its end.
    pub fn is_done(&self, state: &State) -> bool {
        match self.control {
            None => state.nominal >= self.slabs && state.pending.is_empty(),
            Some(_) => state.time >= self.end,
        }
    }

    /// The latest end of a slab that begins at `start`.
    fn latest_end(&self, start: f64) -> f64 {
        let later = self.begins.iter().copied().filter(|t| is_before(start, *t, self.step));
        later.chain([self.end]).min_by(f64::total_cmp).unwrap_or(self.end)
    }

    /// The slab after the time reached.
    pub fn next(&self, state: &State) -> Interval {
        let end = match self.control {
            None if state.nominal + 1 == self.slabs => self.end,
            None => self.start + self.step * (state.nominal + 1) as f64,
            Some(control) => {
                let (latest, step) =
                    (self.latest_end(state.time), state.step.max(control.smallest).min(control.largest));
                let is_last_before = latest - state.time <= (1.0 + SLIVER) * step;
                if is_last_before { latest } else { state.time + step }
            }
        };
        Interval { start: state.time, end, halvings: 0 }
    }

    /// The next slab to solve: the slab after the time reached, or the pending part of it.
    pub fn pending(&self, state: &mut State) -> Interval {
        if state.pending.is_empty() {
            state.pending.push(self.next(state));
        }
        state.pending[state.pending.len() - 1]
    }

    /// Halves the next slab `times`, after `interval` could not be solved. Returns false if that is not allowed: the slab was halved
    /// `max_halvings` times, or its half is below the smallest step of the control or near the round-off of the time.
    pub fn shorten(&self, state: &mut State, interval: Interval, (times, max_halvings): (u32, u32)) -> bool {
        match self.control {
            None => {
                let times = times.min(max_halvings.saturating_sub(interval.halvings)).min(interval.possible_halvings());
                if times == 0 {
                    return false;
                }
                state.halve(times);
            }
            Some(control) => {
                let dt = interval.length();
                if 0.5 * dt < control.smallest {
                    return false;
                }
                state.set_step((dt * 0.5_f64.powi(times as i32)).max(control.smallest));
            }
        }
        true
    }

    /// Whether `interval`, solved with this `jump`, has to be repeated. If so, sets the shorter slab to solve next. A slab in which the boundary
    /// jumps is not repeated: in a shorter one the boundary would be faster, and the jump of the flow would be larger.
    pub fn repeats(&self, state: &mut State, interval: Interval, jump: f64, time_order: usize) -> bool {
        let dt = interval.length();
        let control = self.control.filter(|control| !state.boundary_jumps && control.rejects(dt, jump));
        let Some(control) = control else { return false };
        state.set_step(control.next(dt, jump, time_order));
        true
    }

    /// Sets the length of the slab after `interval`, which was solved with this `jump`. A slab that the end of the run or a release has cut short
    /// must not shorten later ones.
    pub fn adapt(&self, state: &mut State, interval: Interval, jump: f64, time_order: usize) {
        let Some(control) = self.control else { return };
        let length = interval.length();
        let next = control.next(length, jump, time_order);
        let is_cut = interval.end >= self.latest_end(interval.start) && length < (1.0 - SLIVER) * state.step;
        state.step = if is_cut { next.max(state.step) } else { next };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CONTROL: StepControl = StepControl { tolerance: 1e-3, smallest: 1e-3, largest: 1.0 };

    /// A body was released up to a whole slab late.
    #[test]
    fn a_slab_begins_where_a_body_is_released() {
        let schedule = Schedule { begins: vec![0.0, 0.5, 0.7], ..schedule(Some(CONTROL)) };
        let end = |time: f64| schedule.next(&state(time, 0.3)).end;
        assert_eq!([end(0.0), end(0.25), end(0.5), end(0.7)], [0.3, 0.5, 0.7, 1.0]);
        let mut after = state(0.25, 0.3);
        schedule.adapt(&mut after, Interval { start: 0.25, end: 0.5, halvings: 0 }, 1e-3, 1);
        assert_eq!(after.step, 0.3, "a slab that was cut short does not shorten the next one");
    }

    fn state(time: f64, step: f64) -> State {
        State { step, ..State::new(time, Vec::new(), Vec::new()) }
    }

    fn schedule(control: Option<StepControl>) -> Schedule {
        Schedule { start: 0.0, end: 1.0, step: 0.3, slabs: 4, control, begins: Vec::new() }
    }

    /// Slabs became as short as a unit in the last place of the time, and 1 / dt infinite.
    #[test]
    fn halvings_end_before_the_round_off_of_the_time() {
        let (schedule, late) = (schedule(None), Interval { start: 1000.0, end: 1000.0 + 2_f64.powi(-30), halvings: 0 });
        let mut state = State { pending: vec![late], ..state(1000.0, 0.3) };
        assert!(schedule.shorten(&mut state, late, (40, 60)));
        let shortest = state.pending[state.pending.len() - 1];
        assert!(shortest.length() > 10.0 * f64::EPSILON * 1000.0 && shortest.halvings > 5, "{shortest:?}");
        assert!(!schedule.shorten(&mut state, shortest, (1, 60)));
        let from_zero = Interval { start: 0.0, end: 1.0, halvings: 0 };
        assert!(from_zero.possible_halvings() > 40);
    }

    #[test]
    fn a_jump_of_order_n_t_reaches_the_tolerance_in_one_step() {
        for n_t in 1..=4 {
            let jump = |dt: f64| 1e-3 * (dt / 0.2).powi(n_t);
            for dt in [0.12, 0.2, 0.35] {
                let next = CONTROL.next(dt, jump(dt), n_t as usize);
                assert!((next - 0.9 * 0.2).abs() < 1e-12, "N_t = {n_t}, dt = {dt}: {next}");
            }
        }
    }

    #[test]
    fn steps_stay_in_their_bounds() {
        assert_eq!(CONTROL.next(0.1, 0.0, 2), 0.2);
        assert_eq!(CONTROL.next(0.1, f64::INFINITY, 2), 0.025);
        assert_eq!(CONTROL.next(0.9, 0.0, 2), 1.0);
        assert_eq!(CONTROL.next(0.002, 1.0, 2), 1e-3);
        assert!(CONTROL.rejects(0.1, 3e-3) && !CONTROL.rejects(0.1, 1e-3) && !CONTROL.rejects(1e-3, 1.0));
    }

    /// The same slab was repeated for ever if it was the shortest one up to rounding, or up to the sliver that the last slab takes.
    #[test]
    fn the_shortest_slab_is_accepted_at_any_time() {
        let control = StepControl { tolerance: 1e-14, smallest: 0.05, largest: 1.0 };
        for end in [1.0, 0.100_4] {
            let adapted = Schedule { end, ..schedule(Some(control)) };
            let mut state = state(0.0, 0.05);
            while !adapted.is_done(&state) {
                let interval = adapted.next(&state);
                assert!(!adapted.repeats(&mut state, interval, 1e3, 2), "{interval:?}");
                state.time = interval.end;
            }
        }
    }

    /// A body that jumped at a restart made its way in the shortest slab, with a work that was larger by the square of the ratio of lengths.
    #[test]
    fn a_slab_in_which_the_boundary_jumps_is_not_repeated() {
        let adapted = schedule(Some(CONTROL));
        let mut state = State { boundary_jumps: true, ..state(0.0, 0.3) };
        let first = adapted.next(&state);
        assert!(!adapted.repeats(&mut state, first, 1e3, 2));
        state.finish(first);
        let second = adapted.next(&state);
        assert!(adapted.repeats(&mut state, second, 1e3, 2));
    }

    #[test]
    fn fixed_slabs_end_at_the_end() {
        let mut state = state(0.0, 0.0);
        let mut ends = Vec::new();
        while !schedule(None).is_done(&state) {
            let interval = schedule(None).next(&state);
            state.pending.push(interval);
            state.finish(interval);
            ends.push(interval.end);
        }
        assert_eq!(ends, [0.3, 0.6, 0.3 * 3.0, 1.0]);
    }

    #[test]
    fn adapted_slabs_end_at_the_end_without_a_sliver() {
        let adapted = schedule(Some(CONTROL));
        assert_eq!(adapted.next(&state(0.5, 0.2)).end, 0.7);
        assert_eq!(adapted.next(&state(0.5, 0.496)).end, 1.0);
        assert_eq!(adapted.next(&state(0.5, 3.0)).end, 1.0);
        assert!(adapted.is_done(&state(1.0, 0.1)) && !adapted.is_done(&state(0.99, 0.1)));
    }

    /// The first slab after a resume was as long as the earlier limit allowed.
    #[test]
    fn no_slab_is_longer_than_the_present_limit() {
        let adapted = schedule(Some(StepControl { largest: 0.05, ..CONTROL }));
        assert_eq!(adapted.next(&state(0.5, 0.2)).end, 0.55);
    }

    /// A resumed run may have a larger lower limit than the one that has left the step.
    #[test]
    fn no_slab_is_shorter_than_the_present_limit() {
        let adapted = schedule(Some(StepControl { smallest: 0.1, ..CONTROL }));
        assert_eq!(adapted.next(&state(0.5, 0.02)).end, 0.6);
    }

    /// The slab that the end has cut short says how short the next attempt is, but not how long a later one may be.
    #[test]
    fn a_slab_cut_short_by_the_end() {
        let (adapted, mut state) = (schedule(Some(CONTROL)), state(0.9, 0.5));
        let last = adapted.next(&state);
        assert!(adapted.repeats(&mut state, last, 1.0, 2));
        assert!((state.step - 0.025).abs() < 1e-15);
        state.step = 0.5;
        adapted.adapt(&mut state, last, 1e-3, 2);
        assert_eq!(state.step, 0.5);
    }

    /// Three times at once: the parts that follow grow again.
    #[test]
    fn a_slab_is_halved_several_times_at_once() {
        let (fixed, mut state) = (schedule(None), state(0.0, 0.0));
        let first = fixed.pending(&mut state);
        assert!(fixed.shorten(&mut state, first, (3, 6)));
        let mut lengths = Vec::new();
        while !state.pending.is_empty() {
            let interval = fixed.pending(&mut state);
            lengths.push((interval.length()) / 0.3);
            state.finish(interval);
        }
        assert!(lengths.iter().zip([0.125, 0.125, 0.25, 0.5]).all(|(a, b)| (a - b).abs() < 1e-14), "{lengths:?}");
        assert_eq!(state.nominal, 1);
        let part = Interval { halvings: 5, ..first };
        state.pending = vec![part];
        assert!(fixed.shorten(&mut state, part, (3, 6)) && state.pending.iter().all(|part| part.halvings == 6));
        assert!(!fixed.shorten(&mut state, Interval { halvings: 6, ..first }, (1, 6)));
    }

    #[test]
    fn a_slab_that_fails_is_halved_until_the_smallest() {
        let (adapted, mut state) = (schedule(Some(CONTROL)), state(0.0, 0.004));
        let mut steps = vec![];
        let mut next = adapted.next(&state);
        while adapted.shorten(&mut state, next, (1, 0)) {
            steps.push(state.step);
            next = adapted.next(&state);
        }
        assert_eq!(steps, [0.002, 0.001]);
    }
}
