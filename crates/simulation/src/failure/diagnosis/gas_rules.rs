//! Causes in the gas: its initial state, its boundaries, its resolution.

use super::super::data::{Extreme, FailureData, FlowStart, Gas, Mismatch, OpeningMisuse};
use super::{Cause, number, rises};
use crate::openings::Misuse;
use case::{NoValue, NotPositive};

/// A flow whose states change by less within each cell is smooth, as a logarithm or relative to the speed of sound.
const SMOOTH: f64 = 0.1;

/// Below this Reynolds number of a distance of nodes viscosity alone decides.
const CREEPING: f64 = 0.1;

/// Whether the run has begun with the initial state of its case.
fn has_initial_state(gas: &Gas) -> bool {
    gas.start != FlowStart::OtherRun
}

/// The density is nearly zero somewhere.
pub fn near_vacuum(data: &FailureData) -> Option<Cause> {
    let gas = data.gas.as_ref()?;
    let likelihood = |lowest: f64| 1.0 - rises(lowest.max(0.0), 0.02);
    let (start, last) = (gas.at_start.lowest, gas.last.lowest);
    let from_start = has_initial_state(gas) && likelihood(start.value) >= 0.5 * likelihood(last.value);
    let (Extreme { quantity, value, cell }, weight, when) =
        if from_start { (start, 0.95, "in the initial state") } else { (last, 0.55, "in the last good state") };
    Some(Cause {
        name: "near_vacuum",
        likelihood: weight * likelihood(value),
        what: format!(
            "the gas is close to vacuum {when}: in cell {cell} the {quantity} is {} of its mean",
            number(value)
        ),
        remedy: format!(
            "start from a state with less contrast: a higher smallest pressure and density, smoothed over two cells or more{}",
            low_order(gas)
        ),
    })
}

/// The flow at an inflow or outflow is not suited to its condition.
pub fn opening(data: &FailureData) -> Option<Cause> {
    // A state of the wrong side of the speed of sound has too many or too few data wherever it stands. Gas that turns round is treated
    // well: it explains a failure only where there is much of it now.
    let weighed = |opening: &OpeningMisuse| match opening.record.now.misuse {
        Misuse::Supersonic | Misuse::Subsonic => 0.99 * rises(opening.record.now.share, 0.02),
        Misuse::Leaving | Misuse::Backflow | Misuse::Overtaking => 0.9 * rises(opening.record.now.share, 0.1),
    };
    let openings = data.gas.as_ref()?.openings.iter();
    let (likelihood, opening) =
        openings.map(|opening| (weighed(opening), opening)).max_by(|a, b| a.0.total_cmp(&b.0))?;
    Some(Cause {
        name: "opening",
        likelihood,
        what: opening.told.clone(),
        remedy: opening.record.now.misuse.remedy(&opening.boundary),
    })
}

/// A formula has no value: a table that ends, a root of a negative number.
pub fn no_value(data: &FailureData) -> Option<Cause> {
    let NoValue { of, x, t } = data.gas.as_ref()?.without_value.as_ref()?;
    Some(Cause {
        name: "no_value",
        likelihood: 1.0,
        what: format!("a formula of `{of}` has no finite value at {x:?} and t = {t}"),
        remedy: "a formula with a value over the whole run; a table that covers it, or one whose `ends` are \"at_rest\" or \"periodic\"".into(),
    })
}

/// A boundary condition asks for a pressure, a temperature or a density that no gas has.
pub fn boundary_value(data: &FailureData) -> Option<Cause> {
    let NotPositive { boundary, key, x, t, value } = data.gas.as_ref()?.not_positive.as_ref()?;
    Some(Cause {
        name: "boundary_value",
        likelihood: 1.0,
        what: format!(
            "`{key}` of the boundary `{boundary}` is {} at {x:?} and t = {t}, and must be positive",
            number(*value)
        ),
        remedy: format!(
            "a formula in `flow.boundary.{boundary}` that is positive all the time, for instance with `max`"
        ),
    })
}

/// A boundary condition and the gas beside it that differ by less agree.
const SLIGHT: f64 = 0.01;

/// States that differ by more, as a logarithm or in Mach numbers, come from a value in another unit or a key that is missing.
const MISTAKEN: f64 = 2.0;

/// A boundary condition disagrees with the gas beside it.
pub fn boundary_condition(data: &FailureData) -> Option<Cause> {
    let gas = data.gas.as_ref()?;
    // A steady flow around a body may well start from a uniform stream.
    let weight = if data.attempt.steady { 0.6 } else { 0.9 };
    // Another rule treats the part that the motion of a wall explains.
    let size = |mismatch: &Mismatch| (mismatch.size - gas.kick).max(0.0);
    let weighed = |mismatch: &Option<Mismatch>, weight: f64| {
        let mismatch = mismatch.clone()?;
        let weight = if size(&mismatch) > MISTAKEN { 0.94 } else { weight };
        Some((weight * rises(size(&mismatch), 0.7), mismatch))
    };
    // The initial state of a search for the steady flow is gone once that is found.
    let is_past = gas.start == FlowStart::SteadyFlow && !data.attempt.steady;
    let at_start = gas.at_start.mismatch.clone().filter(|_| has_initial_state(gas) && !is_past);
    let (start, last) = (weighed(&at_start, weight), weighed(&gas.last.mismatch, 0.5));
    let (likelihood, mismatch) = [start, last].into_iter().flatten().max_by(|a, b| a.0.total_cmp(&b.0))?;
    if mismatch.size < SLIGHT {
        return None;
    }
    let Mismatch { boundary, quantity, inside, target_state, .. } = mismatch;
    // Nobody is told to take the steady start that the run has, or that has just failed.
    let steady = match gas.start {
        FlowStart::SteadyFlow | FlowStart::OtherRun => "",
        FlowStart::UniformStream | FlowStart::OtherState => ", or start from the steady flow (`solver.steady = {}`)",
    };
    Some(Cause {
        name: "boundary_condition",
        likelihood: 0.05 + likelihood,
        what: format!(
            "the condition on boundary `{boundary}` does not fit the gas beside it: the state that it sets has a {quantity} of {}, the gas {}",
            number(target_state),
            number(inside)
        ),
        remedy: format!(
            "compare `flow.boundary.{boundary}` with the initial state: signs, Mach number, units; let what differs grow in \
             time from the initial value{steady}"
        ),
    })
}

/// A boundary starts to move suddenly.
pub fn kick(data: &FailureData) -> Option<Cause> {
    let kick = data.gas.as_ref()?.kick;
    // The waves of the start have left after some slabs.
    let recent = 1.0 / (1.0 + data.attempt.slabs_done as f64 / 20.0);
    Some(Cause {
        name: "impulsive_motion",
        likelihood: 0.97 * recent * rises(kick, 0.3),
        what: format!("a boundary is set in motion at once, at {} times the speed of sound", number(kick)),
        remedy: "let the motion begin with zero velocity, for instance as t^3: \
                 displacement and velocity must both be zero at the start"
            .into(),
    })
}

/// A body in a stream faster than this makes the flow faster than sound beside it.
const TRANSONIC: f64 = 0.7;

/// The flow is faster than sound somewhere, or becomes so beside a body, and nothing captures the shocks behind.
pub fn shock(data: &FailureData) -> Option<Cause> {
    let gas = data.gas.as_ref().filter(|gas| !gas.captures_shocks)?;
    let mach = number(gas.mach);
    let (likelihood, what) = match gas.mach {
        local if local > 1.0 => {
            (0.85, format!("the flow reaches Mach {mach}, and nothing captures the shocks that such a flow has"))
        }
        // The last good state of a failed search is that at the start.
        start if data.attempt.steady && start > TRANSONIC => {
            let what = format!(
                "at Mach {mach} the flow beside a body becomes faster than sound, and nothing captures the shock behind"
            );
            (0.65, what)
        }
        _ => return None,
    };
    let remedy = format!(
        "{}capture shocks: add the empty section `[flow.shock_capturing]`; take smaller cells where the shock stands",
        steady_start(data, gas)
    );
    Some(Cause { name: "shock", likelihood, what, remedy })
}

/// For the begin of a remedy: the steady start, which spares a uniform stream the strong waves of a sudden start. They have left after
/// some slabs.
fn steady_start(data: &FailureData, gas: &Gas) -> &'static str {
    /// The slabs after which a failure is no longer blamed on the start.
    const EARLY: usize = 20;
    match gas.start {
        FlowStart::UniformStream if data.attempt.slabs_done < EARLY => {
            "start from the steady flow (`solver.steady = {}`), because the uniform stream that meets the walls at once makes strong \
             waves; or "
        }
        _ => "",
    }
}

/// The initial state jumps within cells.
pub fn steep_start(data: &FailureData) -> Option<Cause> {
    let gas = data.gas.as_ref().filter(|gas| has_initial_state(gas))?;
    let Extreme { quantity, value, cell } = gas.at_start.steepest;
    Some(Cause {
        name: "steep_initial_state",
        likelihood: 0.9 * rises(value, 1.5),
        what: format!("the initial state jumps: the {quantity} changes {} within cell {cell}", change(quantity, value)),
        remedy: format!(
            "smooth the initial state over several cells, for instance with tanh((x - x0)/width){}",
            capture(gas)
        ),
    })
}

/// The flow has become steep, or nothing damps the scales that the mesh does not resolve.
pub fn not_resolved(data: &FailureData) -> Option<Cause> {
    let gas = data.gas.as_ref()?;
    let Extreme { quantity, value, cell } = gas.last.steepest;
    // Viscosity damps all scales of a smooth flow whose nodes are that close.
    if value <= SMOOTH && gas.cell_reynolds.is_some_and(|reynolds| reynolds < CREEPING) {
        return None;
    }
    let viscosity = match gas.cell_reynolds {
        Some(reynolds) => format!("the Reynolds number of a distance of nodes is {}", number(reynolds)),
        None => "there is no viscosity".to_owned(),
    };
    let what = match value > SMOOTH {
        true => format!(
            "steeper than the mesh resolves: the {quantity} changes {} within cell {cell}",
            change(quantity, value)
        ),
        false => "perhaps steeper within the slab than the mesh resolves".to_owned(),
    };
    let more = match gas.is_split {
        true => "",
        false => ", or a split form: `flow.quadrature = \"collocated_lobatto\"` with `flow.volume_flux = \"entropy\"`",
    };
    Some(Cause {
        name: "not_resolved",
        likelihood: 0.15 + 0.5 * rises(value, 1.0),
        what: format!("the flow is {what}; {viscosity}"),
        remedy: format!(
            "take more or smaller cells there, or add viscosity{more}; at walls `flow.wall_flux = \"mirrored\"` is more robust{}",
            capture(gas)
        ),
    })
}

/// The setting for a shock, for the end of a remedy.
fn capture(gas: &Gas) -> String {
    match gas.captures_shocks {
        true => format!("; a shock may need a larger `flow.shock_capturing.strength`{}", low_order(gas)),
        false => "; a shock needs `flow.shock_capturing`".to_owned(),
    }
}

/// The order for the strongest shocks, for the end of a remedy: between pressures that are 1e5 apart, orders above 2 fail.
fn low_order(gas: &Gas) -> &'static str {
    if gas.captures_shocks && gas.order > 2 { "; `flow.order = 2` for a very strong shock" } else { "" }
}

fn change(quantity: &str, value: f64) -> String {
    match quantity {
        "velocity" => format!("by {} times the speed of sound", number(value)),
        _ => format!("by a factor of {}", number(value.exp())),
    }
}

/// Fewer quadrature points than a free stream needs.
pub fn quadrature(data: &FailureData) -> Option<Cause> {
    let [points, needed] = data.gas.as_ref()?.quadrature;
    (points < needed).then(|| Cause {
        name: "quadrature",
        likelihood: 0.6,
        what: format!("{points} quadrature points per direction do not conserve on this mesh, which takes {needed}"),
        remedy: "remove `flow.quadrature`, or raise it".into(),
    })
}
