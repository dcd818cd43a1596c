//! The time to cover, and the output.

use crate::checker::{Checked, Checker};
use crate::error::Errors;
use crate::key::Key;
use crate::raw::{self, Field, Integral};
use coupled::{Schedule, StepControl, rounded_time};
use std::path::PathBuf;

/// The time to cover, slab by slab.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Time {
    /// N_t, nodes per slab.
    pub order: usize,
    /// The start.
    pub start: f64,
    /// The end.
    pub end: f64,
    /// The length of a slab; the last one may be shorter.
    pub step: f64,
    /// The number of slabs.
    pub slabs: usize,
    /// The control of the length of the slabs.
    pub control: Option<StepControl>,
}

/// Times at which formulas are checked, as fractions of the length of the run. Apart from the ends they have no simple ratio, so a
/// formula that vanishes at all of them is likely to be zero.
const CHECK_TIMES: [f64; 5] = [0.0, 0.236068, 0.618034, 0.854102, 1.0];

impl Time {
    /// Times of the run at which formulas are checked, including its ends.
    pub(super) fn check_times(&self) -> [f64; 5] {
        // Messages show them, so those between the ends have few digits.
        let readable = |t: f64| if t == self.end { t } else { rounded_time(t).clamp(self.start, self.end) };
        CHECK_TIMES.map(|part| readable((1.0 - part) * self.start + part * self.end))
    }

    /// Times that differ by less are one: the round-off of sums of slabs.
    pub fn round_off(&self) -> f64 {
        1e-9 * self.step
    }

    /// The slabs.
    pub fn schedule(&self) -> Schedule {
        let Time { start, end, step, slabs, control, .. } = *self;
        Schedule { start, end, step, slabs, control, begins: Vec::new() }
    }
}

/// Directory and contents of the output.
#[derive(Clone, Debug, PartialEq)]
pub struct Output {
    /// The directory given in the case; None: the default.
    pub directory: Option<PathBuf>,
    /// Slabs between checkpoints; None: spaced by their own duration.
    pub checkpoint_every: Option<usize>,
    /// Slabs between fields.
    pub every: usize,
    /// Fields for display.
    pub fields: Vec<Field>,
    /// Integrals over the flow.
    pub integrals: Vec<Integral>,
    /// Walls whose distributions are written, by name.
    pub surfaces: Vec<String>,
    /// Slabs between these distributions; None: only at the end.
    pub surfaces_every: Option<usize>,
}

/// Checks `[time]`. A run that `begins_steady` may end at its start, with the steady flow.
pub(super) fn check(checker: &Checker<'_>, raw: &raw::Time, begins_steady: bool) -> Checked<Time> {
    let key = Key::new("time");
    let orders = 1..=16;
    checker.require(&key.child("order"), "the order in time", orders.contains(&raw.order), "1 to 16 nodes per slab")?;
    checker.require(&key.child("start"), "the start", raw.start.is_finite(), "a finite number")?;
    let duration = raw.end - raw.start;
    let accepted = format!("a time after the start, {}; the start itself with `solver.steady`", raw.start);
    let covers = duration > 0.0 || (duration == 0.0 && begins_steady);
    checker.require(&key.child("end"), "the end", covers && duration.is_finite(), &accepted)?;
    let (step, slabs) = match (raw.step, raw.slabs) {
        (Some(step), None) => {
            let step = checker.positive(&key.child("step"), "the length of a slab", step)?;
            check_resolved(checker, &key.child("step"), raw, step)?;
            if duration > 0.0 { (step.min(duration), slabs_to_cover(duration, step)) } else { (step, 0) }
        }
        (None, Some(slabs)) if duration > 0.0 => {
            checker.at_least_one(&key.child("slabs"), "the number of slabs", slabs)?;
            let step = length_of_slabs(duration, slabs);
            check_resolved(checker, &key.child("slabs"), raw, step)?;
            (step, slabs)
        }
        (None, None) => {
            return Err(checker.combination(&key, "the length of the slabs is missing", "`step` or `slabs`"));
        }
        (None, Some(_)) => {
            let problem = "slabs that cover no time have no length";
            return Err(checker.combination(&key.child("slabs"), problem, "`time.step` in its place"));
        }
        _ => return Err(checker.combination(&key, "the length of the slabs is given twice", "`step` or `slabs`")),
    };
    let control = raw.adaptive.as_ref().map(|adaptive| control(checker, raw, adaptive, step, duration)).transpose()?;
    Ok(Time { order: raw.order, start: raw.start, end: end(raw, step, slabs), step, slabs, control })
}

/// The length of `slabs` equal slabs. It is rounded to a short decimal number if that changes the end by round-off only: a later end with more
/// slabs then has the same length, to the bit.
pub(crate) fn length_of_slabs(duration: f64, slabs: usize) -> f64 {
    let quotient = duration / slabs as f64;
    let decimal = rounded_time(quotient);
    let is_as_good = (decimal * slabs as f64 - duration).abs() <= f64::EPSILON * duration;
    if is_as_good { decimal } else { quotient }
}

/// The largest shift of the ends of a slab by round-off of the time, as a fraction of its length.
const LARGEST_SHIFT: f64 = 1e-3;

/// Checks that slabs of `length`, which follows from the value at `key`, are longer than the round-off of time. A run with shorter ones
/// makes no progress.
fn check_resolved(checker: &Checker<'_>, key: &Key, raw: &raw::Time, length: f64) -> Checked<()> {
    let latest = raw.start.abs().max(raw.end.abs());
    let shortest = f64::EPSILON * latest / LARGEST_SHIFT;
    if length >= shortest {
        return Ok(());
    }
    let problem = format!(
        "slabs of length {length:e} drown in the round-off of the time, which is {:.1e} at t = {latest}",
        f64::EPSILON * latest
    );
    Err(checker.combination(key, &problem, &format!("slabs of length {shortest:.1e} or more")))
}

/// Checks `[time.adaptive]` of a run of length `duration` with the first slab of length `step`.
fn control(
    checker: &Checker<'_>,
    raw: &raw::Time,
    adaptive: &raw::Adaptive,
    step: f64,
    duration: f64,
) -> Checked<StepControl> {
    let key = Key::new("time.adaptive");
    if raw.slabs.is_some() {
        let problem = "`time.slabs` makes all slabs of the same length, `time.adaptive` does not";
        return Err(checker.combination(&Key::new("time.slabs"), problem, "`time.step`, the length of the first slab"));
    }
    let tolerance = adaptive.tolerance;
    // A norm over the domain has a unit of length: no number is too large.
    let accepted = "a positive number, 1e-14 or more: a jump in units of `flow.reference`";
    let is_fine = tolerance >= 1e-14 && tolerance.is_finite();
    checker.require(&key.child("tolerance"), "the tolerance", is_fine, accepted)?;
    let smallest = adaptive.smallest.unwrap_or(1e-3 * step);
    let accepted = format!("a positive number, at most the step, {step}");
    checker.require(&key.child("smallest"), "the shortest slab", smallest > 0.0 && smallest <= step, &accepted)?;
    check_resolved(checker, &key.child("smallest"), raw, smallest)?;
    let largest = adaptive.largest.unwrap_or(duration.max(step));
    let accepted = format!("at least the step, {step}");
    checker.require(&key.child("largest"), "the longest slab", largest >= step && largest.is_finite(), &accepted)?;
    Ok(StepControl { tolerance, smallest, largest })
}

/// If the end is a multiple of the step up to round-off, this exact multiple is taken, which a longer run passes too.
fn end(raw: &raw::Time, step: f64, slabs: usize) -> f64 {
    let multiple = raw.start + step * slabs as f64;
    if (multiple - raw.end).abs() <= 1e-12 * (raw.end - raw.start) { multiple } else { raw.end }
}

/// A step that fits up to round-off leaves no short slab at the end.
fn slabs_to_cover(duration: f64, step: f64) -> usize {
    ((duration / step) * (1.0 - 1e-12)).ceil().max(1.0) as usize
}

/// Checks `[output]`.
pub(super) fn check_output(checker: &Checker<'_>, raw: &raw::Output) -> Checked<Output> {
    let key = Key::new("output");
    if raw.directory.as_ref().is_some_and(|directory| directory.as_os_str().is_empty()) {
        let accepted = "a directory beside the case file, or no key `directory`";
        return Err(checker.combination(&key.child("directory"), "the name of the directory is empty", accepted));
    }
    let mut errors = Errors::default();
    let positive = |name: &str, value| checker.at_least_one(&key.child(name), "the number of slabs", value);
    let of_surfaces = key.child("surfaces").child("every");
    let every = |slabs: usize| checker.at_least_one(&of_surfaces, "the number of slabs", slabs);
    let surfaces = raw.surfaces.as_ref();
    let output = Output {
        directory: raw.directory.as_deref().map(|directory| checker.beside_case(directory)),
        checkpoint_every: raw.checkpoint_every.and_then(|slabs| errors.note(positive("checkpoint_every", slabs))),
        every: errors.note(positive("every", raw.every)).unwrap_or(1),
        fields: errors.list(checker.distinct(&key.child("fields"), "field", &raw.fields).map(<[_]>::to_vec)),
        surfaces: surfaces.map_or_else(Vec::new, |surfaces| surfaces.walls.clone()),
        surfaces_every: surfaces.and_then(|surfaces| surfaces.every).and_then(|slabs| errors.note(every(slabs))),
        integrals: errors
            .list(checker.distinct(&key.child("integrals"), "integral", &raw.integrals).map(<[_]>::to_vec)),
    };
    errors.all().map(|()| output)
}

/// Checks that a flow in the plane is not asked for its momentum along z.
pub(super) fn check_integrals<const D: usize>(checker: &Checker<'_>, integrals: &[Integral]) -> Checked<()> {
    match integrals.iter().position(|integral| D == 2 && *integral == Integral::MomentumZ) {
        Some(index) => {
            let key = Key::new("output.integrals").entry(index);
            Err(checker.dimension(&key, "the mesh is two-dimensional", "`momentum_x`, `momentum_y`"))
        }
        None => Ok(()),
    }
}

/// Checks that only a case with a flow or a structure writes fields of it.
pub(super) fn check_fields(
    checker: &Checker<'_>,
    fields: &[Field],
    has_flow: bool,
    has_structure: bool,
) -> Checked<()> {
    // The default fields are those of a flow.
    let is_given = checker.is_given("output.fields");
    let needs_flow = |field: &Field| Field::OF_FLOW.contains(field) || *field == Field::Vorticity;
    for (index, field) in fields.iter().enumerate() {
        let key = Key::new("output.fields").entry(index);
        if field.is_of_structure() && !has_structure {
            let problem = "the case has no structure, and this is a field of one";
            return Err(checker.combination(&key, problem, "a field of the flow, or a section [structure]"));
        }
        if needs_flow(field) && !has_flow && is_given {
            let problem = "the case has no flow, and this is a field of one";
            return Err(checker.combination(
                &key,
                problem,
                "a field of the mesh or the structure, or a section [flow]",
            ));
        }
    }
    Ok(())
}
