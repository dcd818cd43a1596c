//! Prescribed states.

use crate::checker::{Checked, Checker};
use crate::error::{both, collected};
use crate::key::Key;
use crate::raw;
use crate::state::{Formulas, State};
use navier_stokes::exact::{Couette, FreeStream, Vortex, Waves};
use navier_stokes::{Gas, Primitive, Viscosity};

/// A state with its typical values: those of the free stream, or the mean. Formulas have none.
pub(super) struct Typical<const D: usize> {
    pub(super) state: State<D>,
    pub(super) stream: Option<Primitive<f64, D>>,
}

/// Checks a state of `gas`.
pub(super) fn check<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    raw: &raw::State,
    gas: Gas,
) -> Checked<Typical<D>> {
    match raw {
        raw::State::Uniform(uniform) => {
            let key = key.child("uniform");
            let stream = free_stream(checker, &key, uniform, gas)?;
            let state = checker.physics(&key, FreeStream::new(gas, stream))?;
            Ok(Typical { state: State::Uniform(state), stream: Some(stream) })
        }
        raw::State::Vortex(vortex) => self::vortex(checker, &key.child("vortex"), vortex, vortex.strength, gas),
        raw::State::VortexPersson(vortex) => {
            let strength = Vortex::<D>::strength_of_persson(vortex.strength);
            self::vortex(checker, &key.child("vortex_persson"), vortex, strength, gas)
        }
        raw::State::Couette(couette) => self::couette(checker, &key.child("couette"), couette, gas),
        raw::State::Waves(waves) => {
            let key = key.child("waves");
            let mean = free_stream(checker, &key.child("mean"), &waves.mean, gas)?;
            let length = checker.positive(&key.child("length"), "the period", waves.length)?;
            let state = checker.physics(&key.child("amplitude"), Waves::new(gas, mean, waves.amplitude, length))?;
            Ok(Typical { state: State::Waves(state), stream: Some(mean) })
        }
        raw::State::Expression(primitive) => expression(checker, &key.child("expression"), primitive, gas),
    }
}

fn vortex<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    raw: &raw::Vortex,
    strength: f64,
    gas: Gas,
) -> Checked<Typical<D>> {
    let stream = free_stream(checker, &key.child("free_stream"), &raw.free_stream, gas)?;
    let centre = checker.finite_vector(&key.child("centre"), "the centre", &raw.centre)?;
    let radius = checker.positive(&key.child("radius"), "the radius", raw.radius)?;
    for (axis, length) in raw.period.into_iter().flatten().enumerate() {
        checker.positive(&key.child("period").entry(axis), "the period", length)?;
    }
    let is_swirl = strength == 0.0 || stream.velocity.iter().any(|w| *w != 0.0);
    let accepted = "a `free_stream` that moves: the swirl is this part of its speed";
    checker.require(&key.child("strength"), "the strength of a vortex in gas at rest", is_swirl, accepted)?;
    let vortex = Vortex::new(gas, stream, centre, radius, strength, raw.period);
    Ok(Typical { state: State::Vortex(checker.physics(&key.child("strength"), vortex)?), stream: Some(stream) })
}

fn couette<const D: usize>(checker: &Checker<'_>, key: &Key, raw: &raw::Couette, gas: Gas) -> Checked<Typical<D>> {
    let frame: [f64; D] = checker.vector_or_zero(&key.child("frame"), "the velocity", raw.frame.as_ref())?;
    for (name, value) in [
        ("height", raw.height),
        ("lower_temperature", raw.lower_temperature),
        ("upper_temperature", raw.upper_temperature),
        ("pressure", raw.pressure),
    ] {
        checker.positive(&key.child(name), "the number", value)?;
    }
    if let Viscosity::Sutherland { .. } = gas.viscosity() {
        let problem = "the exact flow between two plates is that of a constant viscosity";
        return Err(checker.combination(key, problem, "`flow.gas.viscosity.constant` in place of `sutherland`"));
    }
    let temperatures = [raw.lower_temperature, raw.upper_temperature];
    let couette = Couette::new(gas, raw.height, raw.speed, temperatures, raw.pressure, frame);
    let state = State::Couette(checker.physics(&key.child("speed"), couette)?);
    // The speed of the upper plate relative to the lower one, combined with the state at the lower one.
    let mut velocity = [0.0; D];
    velocity[0] = raw.speed;
    let density = gas.density(raw.pressure, raw.lower_temperature);
    Ok(Typical { state, stream: Some(Primitive { density, velocity, pressure: raw.pressure }) })
}

fn expression<const D: usize>(checker: &Checker<'_>, key: &Key, raw: &raw::Primitive, gas: Gas) -> Checked<Typical<D>> {
    let density = checker.formula::<D>(&key.child("density"), &raw.density)?;
    let velocity = checker.formulas(&key.child("velocity"), &raw.velocity)?;
    let pressure = checker.formula::<D>(&key.child("pressure"), &raw.pressure)?;
    Ok(Typical { state: State::Expression(Box::new(Formulas { gas, density, velocity, pressure })), stream: None })
}

/// A uniform state, from its density, velocity and one more quantity.
pub(super) fn free_stream<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    raw: &raw::FreeStream,
    gas: Gas,
) -> Checked<Primitive<f64, D>> {
    let velocity = checker.finite_vector(&key.child("velocity"), "the velocity", &raw.velocity);
    let ((), velocity): ((), [f64; D]) = both(check_signs(checker, key, raw), velocity)?;
    let density = raw.density;
    let pressure = match (raw.pressure, raw.temperature, raw.mach) {
        (Some(pressure), None, None) => pressure,
        (None, Some(temperature), None) => density * gas.gas_constant() * temperature,
        (None, None, Some(mach)) => pressure_of_mach(checker, key, density, &velocity, mach, gas)?,
        (None, None, None) => return Err(checker.combination(key, "the pressure is missing", ONE_OF_THREE)),
        _ => return Err(checker.combination(key, "the pressure is given more than once", ONE_OF_THREE)),
    };
    let stream = Primitive { density, velocity, pressure };
    check_mach(checker, &key.child(if raw.mach.is_some() { "mach" } else { "velocity" }), &stream, gas)?;
    Ok(stream)
}

/// Checks that the numbers of a uniform state besides its velocity are positive.
fn check_signs(checker: &Checker<'_>, key: &Key, raw: &raw::FreeStream) -> Checked<()> {
    let given = [
        ("density", "the density", Some(raw.density)),
        ("pressure", "the pressure", raw.pressure),
        ("temperature", "the temperature", raw.temperature),
        ("mach", "the Mach number", raw.mach),
    ];
    let positive = |(name, quantity, value): (_, _, Option<f64>)| {
        value.map(|value| checker.positive(&key.child(name), quantity, value))
    };
    collected(given.into_iter().filter_map(positive)).map(drop)
}

/// The highest Mach number. The pressure follows from the total minus the kinetic energy, which is M^2 gamma (gamma - 1) / 2 times the
/// internal one. At high Mach numbers this difference has few digits.
const HIGHEST_MACH: f64 = 100.0;

fn check_mach<const D: usize>(checker: &Checker<'_>, key: &Key, stream: &Primitive<f64, D>, gas: Gas) -> Checked<()> {
    let mach = gas.mach(stream);
    let accepted = format!("a velocity of at most {HIGHEST_MACH} times the speed of sound, sqrt(gamma p / rho)");
    checker.require(key, &format!("the Mach number, {mach:.4e},"), mach <= HIGHEST_MACH, &accepted)
}

const ONE_OF_THREE: &str = "one of `pressure`, `temperature` and `mach`";

/// p = rho |w|^2 / (gamma M^2)
fn pressure_of_mach<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    density: f64,
    velocity: &[f64; D],
    mach: f64,
    gas: Gas,
) -> Checked<f64> {
    let speed = tensor::norm(velocity);
    if speed == 0.0 {
        let problem = "a Mach number does not give the pressure of a gas at rest";
        return Err(checker.combination(&key.child("mach"), problem, "`pressure` or `temperature` instead"));
    }
    Ok(density * speed * speed / (gas.gamma() * mach * mach))
}
