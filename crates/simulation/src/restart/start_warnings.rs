//! Warnings about keys of the start that a restart does not take as they may be meant.

use super::{Origin, RestartError, is_in};
use case::{Case, Difference, searches_steady_flow, start_of};
use coupled::{State, rounded_time};
use output::Arrays;

/// Whether a difference changes the meaning of columns that both runs have. A point or a formula that is new has columns of its own, and the
/// fields of a point are columns.
fn redefines(Difference { key, before, now }: &Difference) -> bool {
    let is_kept = before.is_some() && now.is_some() || key.split('.').count() > 3;
    let of_points = ["output.probes", "output.formulas"].iter().any(|table| is_in(key, table));
    let of_forces = ["flow.forces", "flow.reference"].iter().any(|table| is_in(key, table));
    of_forces || of_points && is_kept && !key.ends_with(".fields")
}

impl Origin {
    /// Warnings about the start of `case` from the `state` of the run, which has the given `sums`, unless the case `searches_anew` a steady flow.
    pub(super) fn start_warnings<const D: usize>(
        &self,
        case: &Case<D>,
        state: &State,
        sums: &Arrays,
        searches_anew: bool,
    ) -> Result<Vec<String>, RestartError> {
        let start = self.misunderstood_start(case, state.time)?;
        let search = if searches_anew { None } else { self.of_search(case, state, sums)? };
        let unused = self.unused_keys(case, state)?;
        let columns = if searches_anew { None } else { self.other_columns(case, state)? };
        Ok(start.into_iter().chain(search).chain(unused).chain(columns).collect())
    }

    /// A warning about keys of `case` that give columns of history.csv another meaning than they have in the rows of the run.
    fn other_columns<const D: usize>(&self, case: &Case<D>, state: &State) -> Result<Option<String>, RestartError> {
        let found = self.differences(case)?.all;
        let keys: Vec<String> =
            found.iter().filter(|found| redefines(found)).map(|found| format!("`{}`", found.key)).collect();
        let (path, time) = (self.path.display(), rounded_time(state.time));
        Ok((!keys.is_empty()).then(|| {
            format!(
                "{} differs from that of `{path}`: rows of history.csv up to t = {time}, and sums over them, have the former value",
                keys.join(", ")
            )
        }))
    }

    /// Warnings about keys that are new in `case` and act at the start of a run only, although the run has marched.
    fn unused_keys<const D: usize>(&self, case: &Case<D>, state: &State) -> Result<Vec<String>, RestartError> {
        if state.slab == 0 {
            return Ok(Vec::new());
        }
        let keys = [
            ("solver.steady", case.solver.steady.is_some()),
            ("solver.start_layer", case.solver.start_layer.is_some_and(|thickness| thickness > 0.0)),
            ("structure.initial", case.structure.is_some()),
        ];
        let found = self.differences(case)?.all;
        let is_new = |key: &str| found.iter().any(|difference| is_in(&difference.key, key));
        let unused = keys.into_iter().filter(|(key, is_set)| *is_set && is_new(key));
        let (path, time) = (self.path.display(), rounded_time(state.time));
        let told = |key| {
            format!("`{key}` has no effect here: it acts at the start of a run, and `{path}` has marched to t = {time}")
        };
        Ok(unused.map(|(key, _)| told(key)).collect())
    }

    /// A warning if the run has found its steady flow with other settings of the search, or has not finished the search and this one does not
    /// search.
    fn of_search<const D: usize>(
        &self,
        case: &Case<D>,
        state: &State,
        sums: &Arrays,
    ) -> Result<Option<String>, RestartError> {
        let searches =
            searches_steady_flow(&self.result.metadata.case_text).map_err(|reason| self.unreadable(reason))?;
        let found = sums.get("statistics.steady").is_some_and(|steady| !steady.is_empty());
        if state.slab > 0 || !searches {
            return Ok(None);
        }
        let path = self.path.display();
        if found {
            let settings = self.differences(case)?.all.into_iter().map(|difference| difference.key);
            let unused = settings.into_iter().find(|key| key.starts_with("solver.steady."));
            return Ok(unused.map(|key| {
                format!("`{key}` has no effect here: `{path}` has found its steady flow; a run without `restart` searches again")
            }));
        }
        Ok(case.solver.steady.is_none().then(|| {
            format!(
                "the search for a steady flow in `{path}` was not finished: this run begins with its initial state; `stsolve run --resume` finishes it"
            )
        }))
    }

    /// A warning if `time.start` is neither that of the run nor the `time` from which this case goes on.
    fn misunderstood_start<const D: usize>(&self, case: &Case<D>, time: f64) -> Result<Option<String>, RestartError> {
        let there = start_of(&self.result.metadata.case_text).map_err(|reason| self.unreadable(reason))?;
        let (start, time, round_off) = (case.time.start, rounded_time(time), case.time.round_off());
        let is_meant = |other: f64| (start - other).abs() <= round_off;
        Ok((start != 0.0 && !is_meant(there) && !is_meant(time)).then(|| {
            format!(
                "`time.start` = {start} is not where this run begins: it goes on from t = {time}, where `{}` stands, and only its slabs count from \
                 `time.start`; leave that key out",
                self.path.display()
            )
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_new_point_redefines_no_column_and_another_place_does() {
        let of = |key: &str, before: Option<&str>, now: Option<&str>| {
            let [before, now] = [before, now].map(|value| value.map(str::to_owned));
            redefines(&Difference { key: key.to_owned(), before, now })
        };
        assert!(of("output.probes.wake.at", Some("[2, 0]"), Some("[0, 3]")));
        assert!(of("output.probes.wake.carried", None, Some("true")));
        assert!(of("output.formulas.a", Some("pressure"), Some("density")));
        assert!(of("flow.forces.wall.area", None, Some("2")) && of("flow.forces", None, Some("{ wall.area = 2 }")));
        assert!(!of("output.probes.wake", None, Some("{ at = [0, 3] }")), "a new column");
        assert!(!of("output.probes.wake.fields", Some("[]"), Some("[\"mach\"]")), "other columns");
        assert!(!of("output.every", Some("1"), Some("2")));
    }
}
