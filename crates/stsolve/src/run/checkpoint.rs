//! The state of a run as named arrays, and back.

use crate::case::Time;
use crate::failure::Failure;
use coupled::preconditioner::Ordering;
use coupled::{Frozen, Interval, Past, State};
use output::SolverState;
use std::collections::BTreeMap;

type Arrays = BTreeMap<String, Vec<f64>>;

/// `state`, and what the preconditioner is made of, as named arrays.
pub fn store(state: &State, frozen: Option<&Frozen>, stale: bool) -> SolverState {
    let mut out = SolverState::default();
    let counters = [
        ("slab", state.slab),
        ("nominal", state.nominal),
        ("base_iterations", state.base_iterations),
        ("stale", stale.into()),
    ];
    out.integers.extend(counters.map(|(name, value)| (name.to_string(), value as i64)));
    let pending = state.pending.iter().flat_map(numbers).collect();
    let mut put = |name: &str, values: Vec<f64>| out.arrays.insert(name.to_string(), values);
    put("time", vec![state.time]);
    put("flow", state.u.clone());
    put("displacement", state.d.clone());
    put("pending", pending);
    put("step", vec![state.step]);
    if let Some(past) = &state.past {
        put("past.interval", numbers(&past.interval).to_vec());
        put("past.displacement", past.bottom.clone());
        put("past.flow", past.u.clone());
        put("past.mesh_velocity", past.v.clone());
    }
    if let Some(frozen) = frozen {
        let Frozen { interval, built_for, ordering, .. } = frozen;
        put("frozen.numbers", vec![interval.0, interval.1, built_for.0, built_for.1]);
        put("frozen.displacement", frozen.bottom.clone());
        put("frozen.mesh_velocity", frozen.velocities.clone());
        put("frozen.flow", frozen.state.clone());
        put("frozen.cells", ordering.cells.iter().map(|&cell| cell as f64).collect());
        put("frozen.level_ends", ordering.level_ends.iter().map(|&end| end as f64).collect());
    }
    out
}

/// Reads back what [`store`] has written: the state, what the preconditioner is made of, whether it is stale. `None` if
/// something is missing. `time` is what the resumed run covers.
pub fn load(stored: &SolverState, time: &Time) -> Option<(State, Option<Frozen>, bool)> {
    let integer = |name: &str| stored.integers.get(name).map(|&n| n as usize);
    let array = |name: &str| stored.arrays.get(name).cloned();
    let mut state = State {
        slab: integer("slab")?,
        nominal: integer("nominal")?,
        time: *array("time")?.first()?,
        u: array("flow")?,
        d: array("displacement")?,
        past: past(&stored.arrays),
        pending: array("pending")?.chunks_exact(3).map(interval).collect(),
        step: *array("step")?.first()?,
        base_iterations: integer("base_iterations")?,
    };
    reopen_short_slab(&mut state, time);
    Some((state, frozen(&stored.arrays), integer("stale")? != 0))
}

/// The checkpoint lacks something.
pub fn incomplete() -> Failure {
    Failure::bad_input(anyhow::anyhow!(
        "the checkpoint lacks a part of the state; start the run anew, without --resume"
    ))
}

/// The last slab of a run ends with it, be it shorter than the others. In a run that goes on, its rest is still to be done,
/// unless slabs are adapted: these are not counted.
fn reopen_short_slab(state: &mut State, time: &Time) {
    if time.control.is_some() {
        return;
    }
    let full_end = time.start + time.step * state.nominal as f64;
    if state.pending.is_empty() && state.nominal > 0 && full_end - state.time > 1e-9 * time.step {
        state.nominal -= 1;
    }
}

fn numbers(interval: &Interval) -> [f64; 3] {
    [interval.start, interval.end, f64::from(interval.halvings)]
}

fn interval(numbers: &[f64]) -> Interval {
    Interval { start: numbers[0], end: numbers[1], halvings: numbers[2] as u32 }
}

fn past(arrays: &Arrays) -> Option<Past> {
    let get = |name: &str| arrays.get(&format!("past.{name}")).cloned();
    let interval = get("interval").filter(|numbers| numbers.len() == 3).map(|numbers| interval(&numbers))?;
    let dt = interval.end - interval.start;
    Some(Past { interval, dt, bottom: get("displacement")?, u: get("flow")?, v: get("mesh_velocity")? })
}

fn frozen(arrays: &Arrays) -> Option<Frozen> {
    let get = |name: &str| arrays.get(&format!("frozen.{name}")).cloned();
    let indices = |name: &str| get(name).map(|values| values.iter().map(|&x| x as usize).collect::<Vec<_>>());
    let &[start, dt, built_dt, damping] = &get("numbers")?[..] else { return None };
    let cells = indices("cells")?;
    let mut positions = vec![0; cells.len()];
    cells.iter().enumerate().for_each(|(position, &cell)| positions[cell] = position);
    Some(Frozen {
        interval: (start, dt),
        bottom: get("displacement")?,
        velocities: get("mesh_velocity")?,
        state: get("flow")?,
        built_for: (built_dt, damping),
        ordering: Ordering { cells, positions, level_ends: indices("level_ends")? },
    })
}
