//! Warnings about what a case observes.

use super::Facts;
use super::warnings::{Warning, warning};
use case::Observed;

/// Lines and planes without a mesh, averages of less than a period or after the end, and controls and names without effect.
pub(super) fn warnings<const D: usize>(facts: &Facts<'_, D>) -> Vec<Warning> {
    [lines(facts), slices(facts), averages(facts), phases(facts), controls(facts), unused_names(facts)]
        .into_iter()
        .flatten()
        .collect()
}

/// Lines whose points all lie outside the mesh at rest. A mesh that moves may come there.
fn lines<const D: usize>(facts: &Facts<'_, D>) -> Option<Warning> {
    let Observed { lines, .. } = &facts.case.observed;
    let outside = listed(lines.iter().filter(|line| !line.meets(&facts.case.mesh)).map(|line| line.name.as_str()))?;
    let until = if facts.case.motion.is_some() { ", until it comes there" } else { "" };
    let text = format!(
        "no point of {outside} lies in the mesh at rest: all values are NaN{until}; `from` and `to` of `output.lines` in the mesh"
    );
    warning("lines", text)
}

fn slices<const D: usize>(facts: &Facts<'_, D>) -> Option<Warning> {
    let Observed { slices, .. } = &facts.case.observed;
    let outside =
        listed(slices.iter().filter(|slice| !slice.meets(&facts.case.mesh)).map(|slice| slice.name.as_str()))?;
    let text = format!(
        "the plane of {outside} does not cut the mesh at rest: its files are empty; `point` and `normal` of `output.slices` in the units of the mesh"
    );
    warning("slices", text)
}

/// The names as a list; None if there are none.
fn listed<'a>(names: impl Iterator<Item = &'a str>) -> Option<String> {
    let names: Vec<String> = names.map(|name| format!("`{name}`")).collect();
    (!names.is_empty()).then(|| names.join(", "))
}

/// Controls that change nothing.
fn controls<const D: usize>(facts: &Facts<'_, D>) -> Option<Warning> {
    let unused = facts.case.controls.iter().filter(|control| !control.is_used);
    let unused = listed(unused.map(|control| control.name.as_str()))?;
    let text = format!(
        "no formula contains {unused}: it has no effect; its name in a formula of `flow.source` or `flow.boundary`"
    );
    warning("controls", text)
}

/// Constants and tables that change nothing: perhaps a name is misspelt.
fn unused_names<const D: usize>(facts: &Facts<'_, D>) -> Option<Warning> {
    let unused = listed(facts.case.about.unused.iter().map(String::as_str))?;
    warning("constants", format!("no formula contains {unused}: another spelling, or a formula with this name"))
}

/// Averages that begin after the end.
fn averages<const D: usize>(facts: &Facts<'_, D>) -> Option<Warning> {
    let (averages, time) = (facts.case.averages.as_ref()?, &facts.case.time);
    let reason = averages.missed_by(time)?;
    let text = format!(
        "the run has no averages: {reason}; another `from` or `to` of `output.averages`, or a later `time.end` with `--resume`"
    );
    warning("averages", text)
}

/// Phases that the run does not meet.
fn phases<const D: usize>(facts: &Facts<'_, D>) -> Option<Warning> {
    let (averages, time) = (facts.case.averages.as_ref()?, &facts.case.time);
    if averages.missed_by(time).is_some() {
        return None;
    }
    let period = averages.phases?.period;
    let length = averages.to.map_or(time.end, |to| to.min(time.end)) - averages.from.max(time.start);
    // A whole number of periods is met up to round-off.
    if length >= period * (1.0 - 1e-9) {
        return None;
    }
    let text = format!(
        "`output.averages` cover {length:.4}, less than their period of {period:.4}, so some phases have no values: a later `time.end` or `to`, \
         an earlier `from`, or a shorter `period`"
    );
    warning("averages", text)
}
