//! The source on the right-hand side of the equations of the flow.

use super::mesh_crate::Mesh;
use super::states;
use super::time::Time;
use crate::checker::{Checked, Checker};
use crate::expression::Program;
use crate::key::Key;
use crate::magnitude::is_bounded;
use crate::point_data::PointData;
use crate::raw;
use crate::vector::Vector;
use navier_stokes::{Gas, Rotation};

/// The source of a flow.
#[derive(Clone, Debug, PartialEq)]
pub enum Source<const D: usize> {
    /// The one that makes the exact state the solution.
    Manufactured,
    /// Mass, momentum and energy per volume and time.
    Given(Box<PointData<D>>),
    /// The acceleration of a body force and the strength of a sponge. Each is zero where the case gives none. The law holds the target of the
    /// sponge and the rotation of the frame; the acceleration contains the centrifugal one.
    Forcing(Box<PointData<D>>),
}

impl<const D: usize> Source<D> {
    /// Its formulas.
    pub fn formulas(&self) -> Option<&PointData<D>> {
        match self {
            Source::Manufactured => None,
            Source::Given(formulas) | Source::Forcing(formulas) => Some(formulas),
        }
    }
}

/// A source, and what its data mean to the law.
pub(super) type Meaning<const D: usize> = (Option<Source<D>>, navier_stokes::Source<D>);

/// Checks `flow.source`, `flow.sponge` and `flow.rotation`. Their formulas have values everywhere at the start and the end.
pub(super) fn check<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    raw: &raw::Flow,
    gas: Gas,
    over: (&Mesh<D>, &Time),
) -> Checked<Meaning<D>> {
    let key_of_source = key.child("source");
    if let Some(rotation) = &raw.rotation {
        return rotating(checker, key, raw, rotation, over);
    }
    let source = match &raw.source {
        None => return forcing(checker, key, raw.sponge.as_ref(), gas, (None, over)),
        Some(raw::Source::Acceleration(formulas)) => {
            let acceleration = acceleration(checker, &key_of_source.child("acceleration"), formulas, over)?;
            return forcing(checker, key, raw.sponge.as_ref(), gas, (Some(acceleration), over));
        }
        Some(_) if raw.sponge.is_some() => {
            let accepted = "a sponge alone, or with `source = { acceleration = [...] }`";
            return Err(checker.combination(
                &key.child("sponge"),
                "a sponge has no place beside this source",
                accepted,
            ));
        }
        Some(raw::Source::Manufactured) => Source::Manufactured,
        Some(raw::Source::Given(raw)) => {
            Source::Given(Box::new(given(checker, &key_of_source.child("given"), raw, over)?))
        }
    };
    Ok((Some(source), navier_stokes::Source::Given))
}

/// A body force, a sponge, both or none.
fn forcing<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    raw: Option<&raw::Sponge>,
    gas: Gas,
    (acceleration, over): (Option<Vector<D>>, (&Mesh<D>, &Time)),
) -> Checked<Meaning<D>> {
    let (first, meaning) = match raw {
        Some(raw) => sponge(checker, &key.child("sponge"), raw, gas, over)?,
        None if acceleration.is_some() => (zero(), navier_stokes::Source::Acceleration),
        None => return Ok((None, navier_stokes::Source::Given)),
    };
    let data = PointData { first, vector: acceleration.unwrap_or_else(Vector::zero), last: zero() };
    Ok((Some(Source::Forcing(Box::new(data))), meaning))
}

/// The forces in a rotating frame, and a body force.
fn rotating<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    raw: &raw::Flow,
    rotation: &raw::RotatingFrame,
    over: (&Mesh<D>, &Time),
) -> Checked<Meaning<D>> {
    let given = match (&raw.source, &raw.sponge) {
        (None, None) => Vector::zero(),
        (Some(raw::Source::Acceleration(formulas)), None) => {
            acceleration(checker, &key.child("source").child("acceleration"), formulas, over)?
        }
        (_, sponge) => {
            let other = if sponge.is_some() { "sponge" } else { "source" };
            let problem = format!("a rotating frame has no place beside this {other}");
            let accepted = "the rotation alone, or with `source = { acceleration = [...] }`";
            return Err(checker.combination(&key.child(other), &problem, accepted));
        }
    };
    let key = key.child("rotation");
    let axis = rotation.axis.map(|axis| super::unit_axis::<D>(checker, &key.child("axis"), axis, "a rotation"));
    let axis = axis.transpose()?.unwrap_or([0.0, 0.0, 1.0]);
    let zeros = vec![0.0; D];
    let centre = rotation.centre.as_ref().unwrap_or(&zeros);
    let centre: [f64; D] = checker.finite_vector(&key.child("centre"), "the coordinate", centre)?;
    let rotation = Rotation::new(axis.map(|a| rotation.rate * a));
    let rotation: Rotation<D> = checker.physics(&key.child("rate"), rotation)?;
    let unit = |j: usize| std::array::from_fn(|i| f64::from(u8::from(i == j)));
    let columns: [[f64; D]; D] = std::array::from_fn(|j| rotation.centrifugal(unit(j)));
    let rows = std::array::from_fn(|i| columns.map(|column| column[i]));
    let data = PointData { first: zero(), vector: given.plus_linear(&rows, &centre), last: zero() };
    Ok((Some(Source::Forcing(Box::new(data))), navier_stokes::Source::Rotating(rotation)))
}

fn acceleration<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    formulas: &[raw::Formula],
    over: (&Mesh<D>, &Time),
) -> Checked<Vector<D>> {
    let vector: Vector<D> = checker.formulas(key, formulas)?;
    bounded(checker, key, "the acceleration", over, |x, t| vector.evaluate(x, t).to_vec())?;
    Ok(vector)
}

fn zero() -> Program {
    Program::constant(0.0)
}

fn given<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    raw: &raw::GivenSource,
    over: (&Mesh<D>, &Time),
) -> Checked<PointData<D>> {
    let number = |name: &str, formula: &Option<raw::Formula>| -> Checked<Program> {
        let Some(formula) = formula else { return Ok(zero()) };
        let program = checker.formula::<D>(&key.child(name), formula)?;
        bounded(checker, &key.child(name), &format!("the source of {name}"), over, |x, t| {
            vec![program.evaluate(x, t)]
        })?;
        Ok(program)
    };
    let (first, last) = (number("density", &raw.density)?, number("energy", &raw.energy)?);
    let Some(formulas) = &raw.momentum else { return Ok(PointData { first, vector: Vector::zero(), last }) };
    let key = key.child("momentum");
    let vector: Vector<D> = checker.formulas(&key, formulas)?;
    bounded(checker, &key, "the source of momentum", over, |x, t| vector.evaluate(x, t).to_vec())?;
    Ok(PointData { first, vector, last })
}

/// The strength of a sponge, and its target.
fn sponge<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    raw: &raw::Sponge,
    gas: Gas,
    over: (&Mesh<D>, &Time),
) -> Checked<(Program, navier_stokes::Source<D>)> {
    let target = states::free_stream::<D>(checker, &key.child("target"), &raw.target, gas)?.to_conserved(&gas);
    let key = key.child("strength");
    let strength = checker.formula::<D>(&key, &raw.strength)?;
    for (x, t) in points_and_times(over) {
        let value = strength.evaluate(&x, t);
        let quantity = format!("the strength at {x:?} and t = {t}, {value},");
        let holds = value >= 0.0 && is_bounded(value);
        checker.require_of_formula(
            &key,
            &quantity,
            holds,
            "a formula that is 0 or positive everywhere, and at most 1e60",
        )?;
    }
    Ok((strength, navier_stokes::Source::Sponge { target }))
}

/// Checks that the `values` of a quantity are finite.
fn bounded<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    quantity: &str,
    over: (&Mesh<D>, &Time),
    values: impl Fn(&[f64; D], f64) -> Vec<f64>,
) -> Checked<()> {
    for (x, t) in points_and_times(over) {
        let values = values(&x, t);
        let quantity = format!("{quantity} at {x:?} and t = {t}, {values:?},");
        let bounded = values.iter().all(|value| is_bounded(*value));
        checker.require_of_formula(key, &quantity, bounded, "formulas that are finite everywhere, and at most 1e60")?;
    }
    Ok(())
}

/// The nodes of the mesh at some times of the run.
fn points_and_times<'a, const D: usize>(
    (mesh, time): (&'a Mesh<D>, &'a Time),
) -> impl Iterator<Item = ([f64; D], f64)> + 'a {
    let nodes = mesh.coordinates().chunks_exact(D).map(|x| std::array::from_fn(|axis| x[axis]));
    nodes.flat_map(|x| time.check_times().map(|t| (x, t)))
}
