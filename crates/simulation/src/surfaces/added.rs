//! Walls whose distributions begin where a run goes on, because it had none along them before.

use case::{Averages, Case, walls_with_series_of};
use coupled::rounded_time;

/// The walls with distributions in `case` of which the run with the resolved case `before` kept none.
pub fn added<const D: usize>(case: &Case<D>, before: &str) -> Vec<String> {
    let Ok(there) = walls_with_series_of(before) else { return Vec::new() };
    listed(case).into_iter().filter(|wall| !there.contains(wall)).collect()
}

/// The walls of `case` with distributions over time.
pub fn listed<const D: usize>(case: &Case<D>) -> Vec<String> {
    case.output.surfaces.iter().filter(|_| case.output.surfaces_every.is_some()).cloned().collect()
}

/// A warning that the distributions of a run are not continued, because the flow has another gas, order or quadrature: `changed` says which.
pub fn begun_anew<const D: usize>(case: &Case<D>, begin: f64, changed: &str) -> Option<String> {
    let walls = listed(case).iter().map(|wall| format!("`{wall}`")).collect::<Vec<_>>().join(", ");
    let time = rounded_time(begin);
    (!walls.is_empty())
        .then(|| format!("the distributions along {walls} begin anew at t = {time}: the flow has another {changed}"))
}

/// A warning that a series of distributions along `wall` ends before the time `begin` at which it goes on.
pub fn interrupted(wall: &str, last: f64, begin: f64) -> String {
    let [last, begin] = [last, begin].map(rounded_time);
    format!(
        "there are no distributions along `{wall}` between t = {last} and {begin}, and its means are straight lines in between: start a new run with \
         `restart.from`, where they begin anew, if averages shall cover that time"
    )
}

/// A warning if the means along the walls `added`, of which there is no distribution before the time `begin`, cover less than the other averages.
pub fn late_means<const D: usize>(case: &Case<D>, added: &[String], begin: f64) -> Option<String> {
    let is_cut = |averages: &&Averages| averages.from < begin && averages.to.is_none_or(|to| to > begin);
    let averages = case.averages.as_ref().filter(is_cut)?;
    let walls = added.iter().map(|wall| format!("`{wall}`")).collect::<Vec<_>>().join(", ");
    (!added.is_empty()).then(|| {
        format!(
            "the means along {walls} begin at t = {}, where the first distribution is, and not at {}, as `output.averages.from` asks for: the run \
             before kept no distributions there (`output.surfaces.every`)",
            rounded_time(begin),
            averages.from
        )
    })
}
