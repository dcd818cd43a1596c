//! The gas, the states and the reference of a flow, to which its conditions refer.

use super::states::{self, Typical};
use crate::checker::{Checked, Checker};
use crate::error::{Errors, collected};
use crate::key::Key;
use crate::raw;
use crate::state::State;
use navier_stokes::{Gas, Primitive, Reference, Viscosity};

/// The length to which coefficients and Reynolds numbers refer where the case gives none.
pub(super) const DEFAULT_LENGTH: f64 = 1.0;

/// What the conditions of a flow refer to.
pub(super) struct Given<const D: usize> {
    pub(super) exact: Option<State<D>>,
    pub(super) initial: State<D>,
    /// The velocity at the start, if it is uniform.
    pub(super) uniform_velocity: Option<[f64; D]>,
    pub(super) gas: Gas,
    pub(super) reference: Reference,
    /// The speed of the reference.
    pub(super) speed: f64,
    /// Its length, if there is one.
    pub(super) length: Option<f64>,
}

/// Checks them.
pub(super) fn check<const D: usize>(checker: &Checker<'_>, key: &Key, raw: &raw::Flow) -> Checked<Given<D>> {
    let gas = gas::<D>(checker, key, raw)?;
    let [exact, initial] = states(checker, key, raw, gas)?;
    let Some(start) = initial.as_ref().or(exact.as_ref()).map(|typical| typical.state.clone()) else {
        let accepted = "a key `initial`, or `exact` from which it is taken";
        return Err(checker.combination(key, "there is no initial state", accepted));
    };
    let stream = typical_stream(checker, key, raw, [exact.as_ref(), initial.as_ref()], gas);
    let (reference, speed, length) = reference(checker, key, raw.reference.as_ref(), stream, gas)?;
    let uniform = initial.as_ref().filter(|typical| matches!(typical.state, State::Uniform(_)));
    let uniform_velocity = uniform.and_then(|typical| typical.stream).map(|stream| stream.velocity);
    if initial.is_none() && exact.is_some() {
        checker.note_default(&key.child("initial"), "flow.exact");
    }
    if raw.source == Some(raw::Source::Manufactured) && exact.is_none() {
        let problem = "a manufactured source needs a solution to be made for";
        return Err(checker.combination(&key.child("source"), problem, "this key together with `exact`"));
    }
    let exact = exact.map(|typical| typical.state);
    Ok(Given { exact, initial: start, uniform_velocity, gas, reference, speed, length })
}

/// The exact and the initial state of `gas`.
fn states<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    raw: &raw::Flow,
    gas: Gas,
) -> Checked<[Option<Typical<D>>; 2]> {
    let state = |(name, state): (&str, &Option<raw::State>)| {
        state.as_ref().map(|state| states::check::<D>(checker, &key.child(name), state, gas)).transpose()
    };
    let mut states = collected([("exact", &raw.exact), ("initial", &raw.initial)].into_iter().map(state))?.into_iter();
    Ok([states.next().flatten(), states.next().flatten()])
}

/// The stream from which the reference follows: that of the exact state, or of the far field, or of the initial state.
fn typical_stream<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    raw: &raw::Flow,
    [exact, initial]: [Option<&Typical<D>>; 2],
    gas: Gas,
) -> Option<Primitive<f64, D>> {
    let of_far_field = || far_stream(checker, &key.child("boundary"), raw, gas);
    match exact {
        Some(exact) => exact.stream,
        None => of_far_field().or_else(|| initial.and_then(|typical| typical.stream)),
    }
}

/// The stream of all far fields, if it is one and moves. The errors of a far field are those of its boundary.
fn far_stream<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    raw: &raw::Flow,
    gas: Gas,
) -> Option<Primitive<f64, D>> {
    let stream = |(name, condition): (&String, &raw::Condition)| match condition {
        raw::Condition::FarField(stream) => {
            Some(states::free_stream(checker, &key.child(name).child("far_field"), stream, gas).ok())
        }
        _ => None,
    };
    let mut streams = raw.boundary.iter().filter_map(stream);
    let first = streams.next().flatten().filter(|stream| tensor::norm(&stream.velocity) > 0.0)?;
    streams.all(|other| other == Some(first)).then_some(first)
}

/// The gas. A Reynolds number needs the reference state. This follows from the given states, for which a gas of any viscosity will do.
fn gas<const D: usize>(checker: &Checker<'_>, flow_key: &Key, flow: &raw::Flow) -> Checked<Gas> {
    let (key, raw) = (&flow_key.child("gas"), &flow.gas);
    let mut errors = Errors::default();
    let gamma = (1.0001..=100.0).contains(&raw.gamma);
    let accepted = "a number above 1 (air: 1.4), from 1.0001 to 100";
    errors.note(checker.require(&key.child("gamma"), "the ratio of specific heats", gamma, accepted));
    let (prandtl, accepted) = ((1e-6..=1e6).contains(&raw.prandtl), "a positive number, 1e-6 to 1e6 (air: 0.72)");
    errors.note(checker.require(&key.child("prandtl"), "the Prandtl number", prandtl, accepted));
    let gas_constant = errors.note(gas_constant(checker, key, raw));
    let viscosity = errors.note(viscosity(checker, &key.child("viscosity"), &raw.viscosity));
    errors.all()?;
    let (Some(gas_constant), Some(viscosity)) = (gas_constant, viscosity) else {
        unreachable!("what is missing has left an error")
    };
    let gas = |viscosity| checker.physics(key, Gas::new(raw.gamma, gas_constant, raw.prandtl, viscosity));
    let raw::Viscosity::Reynolds(reynolds) = raw.viscosity else { return gas(viscosity) };
    let provisional = gas(viscosity)?;
    let [exact, initial] = states::<D>(checker, flow_key, flow, provisional)?;
    let stream = typical_stream(checker, flow_key, flow, [exact.as_ref(), initial.as_ref()], provisional);
    let (reference, speed, length) = reference(checker, flow_key, flow.reference.as_ref(), stream, provisional)?;
    gas(Viscosity::Constant(reference.density() * speed * length.unwrap_or(DEFAULT_LENGTH) / reynolds))
}

fn gas_constant(checker: &Checker<'_>, key: &Key, raw: &raw::Gas) -> Checked<f64> {
    match (raw.gas_constant, raw.mach) {
        (Some(given), None) => checker.positive(&key.child("gas_constant"), "the gas constant", given),
        (None, None) => {
            checker.note_default(&key.child("gas_constant"), "1.0");
            Ok(1.0)
        }
        (None, Some(mach)) => {
            let mach = checker.positive(&key.child("mach"), "the Mach number", mach)?;
            Ok(1.0 / (raw.gamma * mach * mach))
        }
        _ => Err(checker.combination(key, "the gas constant is given twice", "`gas_constant` or `mach`")),
    }
}

/// The artificial viscosity of shocks, if there is one.
pub(super) fn shock_capturing(
    checker: &Checker<'_>,
    key: &Key,
    raw: &raw::Flow,
) -> Checked<Option<navier_stokes::ShockCapturing>> {
    let Some(raw::ShockCapturing { strength, threshold }) = raw.shock_capturing else { return Ok(None) };
    let strength = checker.positive(&key.child("strength"), "the strength of the artificial viscosity", strength)?;
    let threshold =
        checker.positive(&key.child("threshold"), "the threshold of the artificial viscosity", threshold)?;
    Ok(Some(checker.physics(key, navier_stokes::ShockCapturing::new(strength, threshold))?))
}

/// The viscosity; an arbitrary one if a Reynolds number is given.
fn viscosity(checker: &Checker<'_>, key: &Key, raw: &raw::Viscosity) -> Checked<Viscosity> {
    match *raw {
        raw::Viscosity::Inviscid => Ok(Viscosity::Inviscid),
        raw::Viscosity::Constant(viscosity) => {
            Ok(Viscosity::Constant(checker.positive(&key.child("constant"), "the viscosity", viscosity)?))
        }
        raw::Viscosity::Reynolds(reynolds) => {
            checker.positive(&key.child("reynolds"), "the Reynolds number", reynolds)?;
            Ok(Viscosity::Constant(1.0))
        }
        raw::Viscosity::Sutherland { viscosity, temperature, constant } => {
            let key = key.child("sutherland");
            for (name, value) in [("viscosity", viscosity), ("temperature", temperature), ("constant", constant)] {
                checker.positive(&key.child(name), "the number", value)?;
            }
            Ok(Viscosity::Sutherland { viscosity, temperature, constant })
        }
    }
}

/// The given reference state, or the `stream`; with its speed and the length that is given.
fn reference<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    raw: Option<&raw::Reference>,
    stream: Option<Primitive<f64, D>>,
    gas: Gas,
) -> Checked<(Reference, f64, Option<f64>)> {
    let key_reference = key.child("reference");
    if let Some(raw) = raw {
        let length = raw.length.map(|length| ("length", length));
        let numbers = [("density", raw.density), ("speed", raw.speed), ("pressure", raw.pressure)];
        for (name, value) in numbers.into_iter().chain(length) {
            checker.positive(&key_reference.child(name), &format!("the {name}"), value)?;
        }
        let reference = Reference::new(&gas, raw.density, raw.speed, raw.pressure);
        let reference = checker.physics(&key_reference, reference)?;
        let (mach, accepted) = (reference.mach(), "sizes of one flow: a Mach number from 1e-6 to 100");
        let quantity = format!("the Mach number, speed over sqrt(gamma p / rho), {mach:.3e},");
        checker.require(&key_reference.child("speed"), &quantity, (1e-6..=100.0).contains(&mach), accepted)?;
        return Ok((reference, raw.speed, raw.length));
    }
    let accepted = "a table `reference = { density, speed, pressure }` with sizes that are typical of the flow";
    let speed = stream.map_or(0.0, |stream| tensor::norm(&stream.velocity));
    let Some(stream) = stream.filter(|_| speed > 0.0) else {
        let problem =
            "the size of the velocity cannot be told from the exact state, the far field or the initial state";
        return Err(checker.combination(&key_reference, problem, accepted));
    };
    let (density, pressure) = (stream.density, stream.pressure);
    let taken = format!("{{ density = {density}, speed = {speed}, pressure = {pressure} }}, of the free stream");
    checker.note_default(&key_reference, &taken);
    let reference = Reference::new(&gas, density, speed, pressure);
    Ok((checker.physics(&key_reference, reference)?, speed, None))
}
