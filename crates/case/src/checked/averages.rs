//! Averages over time.

use super::mesh_crate::Mesh;
use super::time::Time;
use crate::checker::{Checked, Checker};
use crate::key::Key;
use crate::raw::{self, Average, Axis};

/// The largest number of phases of a period.
const MOST_PHASES: usize = 1000;

/// The largest number of phases from the start of the averages to the end of the run: they are counted in f64.
const MOST_PHASES_OF_A_RUN: f64 = 1e12;

/// Averages over time.
#[derive(Clone, Debug, PartialEq)]
pub struct Averages {
    /// The time at which they begin.
    pub from: f64,
    /// The time at which they end, if it is not the end of the run.
    pub to: Option<f64>,
    /// The phases of a period that begins at `from`, if they are averaged one by one.
    pub phases: Option<Phases>,
    /// The axes along which they are averaged, too.
    pub along: Vec<usize>,
    /// The averages, each listed once.
    pub fields: Vec<Average>,
}

impl Averages {
    /// A part of a slab that is shorter than this fraction of it is round-off, and is not averaged.
    pub const ROUND_OFF: f64 = 1e-9;

    /// Why no part of a run that covers `time` is averaged, if none is.
    pub fn missed_by(&self, time: &Time) -> Option<String> {
        let round_off = Self::ROUND_OFF * time.step;
        if self.from >= time.end - round_off {
            return Some(format!(
                "they begin at t = {} (`output.averages.from`), and the run ends at {}",
                self.from, time.end
            ));
        }
        let to = self.to.filter(|to| *to <= time.start + round_off)?;
        Some(format!("they end at t = {to} (`output.averages.to`), and the run starts at {}", time.start))
    }
}

/// Equal phases of a period.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Phases {
    /// The length of the period.
    pub period: f64,
    /// The number of phases.
    pub count: usize,
}

/// Checks `[output.averages]` of a run that covers `time`.
pub(super) fn check<const D: usize>(
    checker: &Checker<'_>,
    raw: Option<&raw::Averages>,
    mesh: &Mesh<D>,
    time: &Time,
    has_flow: bool,
) -> Checked<Option<Averages>> {
    let Some(raw) = raw else { return Ok(None) };
    let key = Key::new("output").child("averages");
    if !has_flow {
        let problem = "without a flow there is nothing to average";
        return Err(checker.combination(&key, problem, "this section together with [flow]"));
    }
    let from = checker.number(&key.child("from"), &raw.from)?;
    // A run may be split before they begin.
    checker.require(&key.child("from"), "the start of the averages", from.is_finite(), "a finite number")?;
    let to = raw.to.as_ref().map(|to| checker.number(&key.child("to"), to)).transpose()?;
    let accepted = format!("a time after their start, {from}");
    let later = to.is_none_or(|to| to > from && to.is_finite());
    checker.require(&key.child("to"), "the end of the averages", later, &accepted)?;
    let fields = checker.distinct(&key.child("fields"), "average", &raw.fields)?.to_vec();
    if fields.is_empty() {
        let accepted = "some of `fields`, or no section [output.averages]";
        return Err(checker.combination(&key.child("fields"), "the list of averages is empty", accepted));
    }
    let along = directions(checker, &key.child("along"), &raw.along, mesh)?;
    Ok(Some(Averages { from, to, phases: phases(checker, &key, raw, (time, from))?, along, fields }))
}

/// The axes of space `along` which the cells of the mesh are extruded.
fn directions<const D: usize>(checker: &Checker<'_>, key: &Key, along: &[Axis], mesh: &Mesh<D>) -> Checked<Vec<usize>> {
    let listed = checker.axes::<D>(key, along)?;
    let along: Vec<usize> = (0..D).filter(|&axis| listed[axis]).collect();
    let accepted = format!("{} at most, so that a line or a plane remains", D - 1);
    checker.require(key, "the number of directions", along.len() < D, &accepted)?;
    if !along.is_empty() && mesh.cross_section(mesh.order(), &along).is_none() {
        let problem = "the cells of the mesh are not extruded along these directions";
        let accepted =
            "directions along which all cells are straight, and every cell has copies of its cross-section behind it";
        return Err(checker.combination(key, problem, accepted));
    }
    Ok(along)
}

fn phases(
    checker: &Checker<'_>,
    key: &Key,
    raw: &raw::Averages,
    (time, from): (&Time, f64),
) -> Checked<Option<Phases>> {
    match (&raw.period, raw.phases) {
        (None, None) => Ok(None),
        (Some(period), Some(count)) => {
            let key_of = |name: &str| key.child(name);
            let period = checker.number(&key_of("period"), period)?;
            let period = checker.positive(&key_of("period"), "the period", period)?;
            let accepted = format!("1 to {MOST_PHASES} phases");
            let allowed = (1..=MOST_PHASES).contains(&count);
            checker.require(&key_of("phases"), "the number of phases", allowed, &accepted)?;
            let shortest = time.step / MOST_PHASES as f64;
            let accepted = format!("phases of {shortest:e} or more, a thousandth of a slab");
            let resolved = period / count as f64 >= shortest;
            checker.require(&key_of("period"), "the length of a phase", resolved, &accepted)?;
            let countable = (time.end - from) * count as f64 <= MOST_PHASES_OF_A_RUN * period;
            let accepted = format!("a start at most {MOST_PHASES_OF_A_RUN:e} phases before the end of the run");
            checker.require(&key_of("from"), "the start of the averages", countable, &accepted)?;
            Ok(Some(Phases { period, count }))
        }
        (Some(_), None) => {
            let accepted = "`phases` beside it, the number of parts of the period";
            Err(checker.combination(&key.child("period"), "the number of phases is missing", accepted))
        }
        (None, Some(_)) => {
            let accepted = "`period` beside it, the length of the period";
            Err(checker.combination(&key.child("phases"), "phases of which period?", accepted))
        }
    }
}
