//! The state of a run as named arrays, and back.

use crate::error::Failure;
use case::Time;
use coupled::blocks::Counts;
use coupled::preconditioner::{Ordering, TimeScales};
use coupled::{EasedStart, Interval, JacobianReusePolicy, Linearisation, Past, State};
use output::{Arrays, SolverState};
use std::sync::Arc;

/// The array of the flow at the time of the checkpoint.
pub const FLOW: &str = "flow";
/// The array of the determinants that slabs carry on.
pub const DETERMINANTS: &str = "determinants";
/// The array of the flow in the last slab.
pub const PAST_FLOW: &str = "past.flow";
/// The array of the flow that the preconditioner is made of.
pub const FROZEN_FLOW: &str = "frozen.flow";

/// `state`, and the linearisation of the preconditioner, as named arrays.
pub fn store(state: &State, frozen: Option<&Linearisation>, stale: bool) -> SolverState {
    let mut out = SolverState::default();
    let counters = [
        ("slab", state.slab),
        ("nominal", state.nominal),
        ("rejected", state.rejected),
        ("reuse.base", state.reuse_policy.base),
        ("reuse.excess", state.reuse_policy.excess),
        ("reuse.slabs", state.reuse_policy.slabs),
        ("reuse.eager", state.reuse_policy.eager),
        ("stale", stale.into()),
        ("boundary_jumps", state.boundary_jumps.into()),
    ];
    out.integers.extend(counters.map(|(name, value)| (name.to_string(), value as i64)));
    let pending = state.pending.iter().flat_map(numbers).collect();
    let mut put = |name: &str, values: Vec<f64>| drop(out.arrays.insert(name.to_string(), values.into()));
    put("time", vec![state.time]);
    put(FLOW, state.u.clone());
    put("displacement", state.d.clone());
    put(DETERMINANTS, state.determinants.clone());
    put("pending", pending);
    put("failed", state.failed.iter().flat_map(numbers).collect());
    put("step", vec![state.step]);
    if let Some(EasedStart { attempts, thickness, totals }) = &state.eased {
        put("eased_start", [&[*attempts as f64, *thickness], &totals[..]].concat());
    }
    state.bodies.iter().enumerate().for_each(|(body, stored)| put(&format!("body.{body}"), stored.clone()));
    state.past.iter().for_each(|past| store_past(past, &mut out.arrays));
    frozen.iter().for_each(|frozen| store_frozen(frozen, &mut out.arrays));
    out
}

/// Adds the slab before. [`past`] reads it.
fn store_past(past: &Past, arrays: &mut Arrays) {
    let mut put = |name: &str, values: Arc<Vec<f64>>| drop(arrays.insert(name.to_string(), values));
    put(PAST_FLOW, past.u.clone());
    put("past.mesh_velocity", past.v.clone());
    put("past.interval", numbers(&past.interval).to_vec().into());
    put("past.displacement", past.bottom.clone().into());
    past.bodies.iter().enumerate().for_each(|(body, z)| put(&format!("past.body.{body}"), z.clone().into()));
}

/// Adds the linearisation of the preconditioner. [`frozen`] reads it.
fn store_frozen(frozen: &Linearisation, arrays: &mut Arrays) {
    let Linearisation { start, dt, built_for, ordering, .. } = frozen;
    let mut put = |name: &str, values: Arc<Vec<f64>>| drop(arrays.insert(name.to_string(), values));
    let indices = |indices: &[usize]| Arc::new(indices.iter().map(|&index| index as f64).collect::<Vec<f64>>());
    put(FROZEN_FLOW, frozen.state.clone());
    put("frozen.numbers", vec![*start, *dt, built_for.dt, built_for.damping].into());
    put("frozen.coarse_level", vec![f64::from(u8::from(frozen.coarse_level))].into());
    put("frozen.displacement", frozen.bottom.clone().into());
    put("frozen.mesh_velocity", frozen.velocities.clone().into());
    put("frozen.cells", indices(&ordering.cells));
    put("frozen.level_ends", indices(&ordering.level_ends));
    put("frozen.stage_ends", indices(&ordering.stage_ends()));
}

/// The array with what rejected attempts at the next slab have cost.
pub const ATTEMPTS: &str = "attempts";

/// Adds what rejected attempts at the next slab have cost. Its report contains that.
pub fn store_attempts(stored: &mut SolverState, counts: Counts) {
    let numbers: Vec<f64> = counts.numbers().map(|number| number as f64).to_vec();
    stored.arrays.insert(ATTEMPTS.to_owned(), numbers.into());
}

/// The counts of [`store_attempts`], if there are some.
pub fn attempts(stored: &SolverState) -> Option<Counts> {
    let numbers = <[f64; 6]>::try_from(&stored.arrays.get(ATTEMPTS)?[..]).ok()?;
    Some(Counts::from_numbers(numbers.map(|number| number as usize)))
}

/// Reads back the data of [`store`]: the state, the linearisation of the preconditioner, and whether it is stale.
/// `None` if something is missing or parts do not fit together. The resumed run covers `time`.
pub fn load(stored: &SolverState, time: &Time) -> Option<(State, Option<Linearisation>, bool)> {
    let integer = |name: &str| stored.integers.get(name).map(|&n| n as usize);
    let array = |name: &str| stored.arrays.get(name).map(|values| values.to_vec());
    let mut state = State {
        slab: integer("slab")?,
        nominal: integer("nominal")?,
        rejected: integer("rejected").unwrap_or_default(),
        eased: array("eased_start").and_then(|numbers| eased_start(&numbers)),
        time: *array("time")?.first()?,
        u: array(FLOW)?,
        d: array("displacement")?,
        determinants: array(DETERMINANTS).unwrap_or_default(),
        bodies: bodies(&stored.arrays, "body"),
        past: past(&stored.arrays),
        pending: array("pending")?.chunks_exact(3).map(interval).collect(),
        failed: array("failed").and_then(|failed| failed.chunks_exact(3).map(interval).next()),
        step: *array("step")?.first()?,
        boundary_jumps: integer("boundary_jumps").unwrap_or_default() != 0,
        reuse_policy: JacobianReusePolicy {
            base: integer("reuse.base")?,
            excess: integer("reuse.excess")?,
            slabs: integer("reuse.slabs")?,
            eager: integer("reuse.eager")?,
        },
    };
    reopen_short_slab(&mut state, time);
    let frozen = frozen(&stored.arrays);
    // Displacement, velocities and flow of a slab.
    let past = state.past.as_ref().map(|past| [past.bottom.len(), past.v.len(), past.u.len()]);
    let made_of = frozen.as_ref().map(|frozen| [frozen.bottom.len(), frozen.velocities.len(), frozen.state.len()]);
    let lengths = [state.d.len(), time.order * state.d.len(), time.order * state.u.len()];
    let fits = [past, made_of].into_iter().flatten().all(|found| found == lengths);
    fits.then_some((state, frozen, integer("stale")? != 0))
}

/// Back from numbers.
fn eased_start(numbers: &[f64]) -> Option<EasedStart> {
    let [attempts, thickness, totals @ ..] = numbers else { return None };
    Some(EasedStart { attempts: *attempts as usize, thickness: *thickness, totals: totals.to_vec() })
}

/// Replaces `state`, that of a march without a flow, by the stored one. `None` if it does not fit the mesh.
pub fn restore(state: &mut State, stored: &SolverState, time: &Time) -> Option<()> {
    let (loaded, ..) = load(stored, time)?;
    let fits = loaded.d.len() == state.d.len();
    fits.then(|| *state = loaded)
}

/// The checkpoint is incomplete.
pub fn incomplete() -> Failure {
    Failure::bad_input(anyhow::anyhow!(
        "the checkpoint lacks a part of the state; start the run anew, without --resume"
    ))
}

/// The last slab of a run ends with the run and may be shorter than the others. If the run is continued, the rest of that
/// slab is done first, or after the parts of it that remain. Nothing goes beyond the present end of the run. Adapted slabs are not counted, so this does not apply to them.
fn reopen_short_slab(state: &mut State, time: &Time) {
    if time.control.is_some() {
        return;
    }
    let tolerance = time.round_off();
    for part in &mut state.pending {
        part.end = part.end.min(time.end);
    }
    state.pending.retain(|part| part.length() > tolerance);
    if let Some(&last) = state.pending.first() {
        let end = time.end.min(time.start + time.step * (state.nominal + 1) as f64);
        if end - last.end > tolerance {
            state.pending.insert(0, Interval { start: last.end, end, ..last });
        }
        return;
    }
    let full_end = time.end.min(time.start + time.step * state.nominal as f64);
    if state.nominal > 0 && full_end - state.time > tolerance {
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
    let shared = |name: &str| arrays.get(&format!("past.{name}")).cloned();
    let get = |name: &str| shared(name).map(Arc::unwrap_or_clone);
    let interval = get("interval").filter(|numbers| numbers.len() == 3).map(|numbers| interval(&numbers))?;
    let dt = interval.length();
    let bodies = bodies(arrays, "past.body");
    let (u, v) = (shared("flow")?, shared("mesh_velocity")?);
    Some(Past { interval, dt, bottom: get("displacement")?, u, v, bodies })
}

/// The arrays `name`.0, `name`.1, ... as far as there are any.
pub fn bodies(arrays: &Arrays, name: &str) -> Vec<Vec<f64>> {
    (0..).map_while(|body| arrays.get(&format!("{name}.{body}")).map(|values| values.to_vec())).collect()
}

fn frozen(arrays: &Arrays) -> Option<Linearisation> {
    let shared = |name: &str| arrays.get(&format!("frozen.{name}")).cloned();
    let get = |name: &str| shared(name).map(Arc::unwrap_or_clone);
    let indices = |name: &str| get(name).map(|values| values.iter().map(|&x| x as usize).collect::<Vec<_>>());
    let &[start, dt, built_dt, damping] = &get("numbers")?[..] else { return None };
    Some(Linearisation {
        start,
        dt,
        bottom: get("displacement")?,
        velocities: get("mesh_velocity")?,
        state: shared("flow")?,
        built_for: TimeScales { dt: built_dt, damping },
        ordering: ordering(&indices("cells")?, indices("level_ends")?, &indices("stage_ends")?)?,
        coarse_level: get("coarse_level")?.first() == Some(&1.0),
    })
}

/// `None` unless every cell has one position, and levels and stages end in increasing order, the last ones with the cells.
fn ordering(cells: &[usize], level_ends: Vec<usize>, stage_ends: &[usize]) -> Option<Ordering> {
    let mut found = vec![false; cells.len()];
    for &cell in cells {
        *found.get_mut(cell)? = true;
    }
    let end_with_cells = |ends: &[usize]| ends.is_sorted() && ends.last().is_none_or(|last| *last == cells.len());
    let whole = !found.contains(&false) && !level_ends.is_empty() && (!stage_ends.is_empty() || cells.is_empty());
    let fits = whole && end_with_cells(&level_ends) && end_with_cells(stage_ends);
    fits.then(|| Ordering::in_stages(cells, level_ends, stage_ends))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    const TIME: Time = Time { order: 2, start: 0.0, end: 1.0, step: 0.1, slabs: 10, control: None };

    fn stored() -> SolverState {
        let past = Past {
            interval: Interval { start: 0.1, end: 0.2, halvings: 0 },
            dt: 0.1,
            bottom: vec![1.0; 3],
            u: vec![2.0; 8].into(),
            v: vec![3.0; 6].into(),
            bodies: vec![vec![9.0; 2]],
        };
        let state = State {
            slab: 2,
            nominal: 2,
            bodies: vec![vec![1.0]],
            past: Some(past),
            ..State::new(0.2, vec![4.0; 4], vec![5.0; 3])
        };
        let frozen = Linearisation {
            start: 0.1,
            dt: 0.1,
            bottom: vec![6.0; 3],
            velocities: vec![7.0; 6],
            state: vec![8.0; 8].into(),
            built_for: TimeScales { dt: 0.1, damping: 0.0 },
            ordering: ordering(&[1, 0, 2], vec![2, 3], &[1, 3]).unwrap(),
            coarse_level: false,
        };
        store(&state, Some(&frozen), true)
    }

    #[test]
    fn what_is_stored_is_read_back() {
        let (state, frozen, stale) = load(&stored(), &TIME).unwrap();
        assert_eq!((state.slab, state.time, state.past.as_ref().unwrap().u.len(), stale), (2, 0.2, 8, true));
        let again = store(&state, frozen.as_ref(), stale);
        assert_eq!(again.arrays.keys().collect::<Vec<_>>(), stored().arrays.keys().collect::<Vec<_>>());
        let ordering = frozen.unwrap().ordering;
        assert_eq!((&ordering.positions[..], ordering.stages_of_cells()), (&[1, 0, 2][..], vec![1, 0, 1]));
    }

    /// Any stored data give either a consistent state or none.
    #[test]
    fn parts_that_do_not_fit_are_refused() {
        for name in stored().arrays.keys() {
            for change in 0..4 {
                let mut damaged = stored();
                let values = Arc::make_mut(damaged.arrays.get_mut(name).unwrap());
                match change {
                    0 => drop(damaged.arrays.remove(name)),
                    1 => values.push(9.0),
                    2 => drop(values.pop()),
                    _ => values.iter_mut().for_each(|value| *value = -1e300),
                }
                let Some((state, frozen, _)) = load(&damaged, &TIME) else { continue };
                assert!(state.past.is_none_or(|past| past.u.len() == 2 * state.u.len()), "{name} {change}");
                assert!(frozen.is_none_or(|frozen| frozen.state.len() == 2 * state.u.len()), "{name} {change}");
            }
        }
        for (cells, level_ends, stage_ends) in [
            ([0, 0], vec![2], vec![2]),
            ([0, 2], vec![2], vec![2]),
            ([0, 1], vec![1], vec![2]),
            ([0, 1], vec![], vec![2]),
            ([0, 1], vec![2], vec![1]),
            ([0, 1], vec![2], vec![2, 1]),
            ([0, 1], vec![2], vec![]),
        ] {
            assert_eq!(ordering(&cells, level_ends, &stage_ends), None);
        }
        assert!(ordering(&[0, 1], vec![2], &[1, 2]).is_some());
    }
}
