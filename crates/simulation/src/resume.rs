//! Decides whether a run may continue from a checkpoint.

use case::{Difference, Differences, differences_after, lasting_of};
use output::Metadata;

/// The settings that may change, and another way, for the end of a message.
const MAY_CHANGE: &str = "only the end of the run, the numbers of `time.adaptive` and `solver.steady` but not whether they are there, other keys of `[solver]`, \
                          tables after the checkpoint, and in `[output]` all but fields, formulas, points, integrals and averages may change; where there is a flow, a new run starts from it with `restart.from` and \
                          another output directory";

/// The remedy where a table has become longer, for the end of a message.
const LONGER_TABLE: &str = "begin anew with `--force`, or, where there is a flow, start a new run from it with `restart.from` and another \
                            output directory; a table that goes on for 20 points after `time.end` can be made longer later";

/// Decides whether a run continues from a checkpoint of the run `before`, which has `reached` a time, and logs the settings that change.
/// `fingerprint` is that of the new run with another lasting part of its case.
///
/// # Errors
/// The reason of the refusal.
pub fn accept(
    before: &Metadata,
    now: &Metadata,
    reached: f64,
    fingerprint: impl Fn(&str) -> String,
) -> Result<(), String> {
    let (there, here) = (&before.mesh, &now.mesh);
    if !there.boundary_names.is_empty()
        && (&there.boundary_names, &there.boundary_facets) != (&here.boundary_names, &here.boundary_facets)
    {
        return Err("the boundaries of the mesh are others, perhaps because its file has changed".to_owned());
    }
    let differences = differences_after(&before.case_text, &now.case_text, reached);
    let is_same = before.case_fingerprint == now.case_fingerprint;
    if is_same || differences.as_ref().is_ok_and(|found| differs_in_tables_to_come(before, found, fingerprint)) {
        let changed = differences.unwrap_or_default().all;
        changed.iter().for_each(|difference| tracing::info!(%difference, "resumed with another setting"));
        changed.iter().filter(|found| is_other_slice(found)).for_each(|found| {
            tracing::warn!("{found}: the earlier files of the slice keep the former value, and do not tell it");
        });
        return Ok(());
    }
    let differences =
        differences.map_err(|reason| format!("it was written by another version of the program ({reason})"))?;
    let first = first_lasting(&differences);
    if let Some(table) = first.and_then(|difference| differences.longer_table(difference)) {
        return Err(format!("{table}; {LONGER_TABLE}"));
    }
    Err(match first {
        Some(difference) => format!("{difference}{}; {MAY_CHANGE}", and_more(&differences.lasting)),
        None if before.mesh_id != now.mesh_id => {
            "the mesh at rest is another one, perhaps because its file has changed".to_owned()
        }
        None => "the mesh was moved alone there, and is solved with a flow here, or the other way round".to_owned(),
    })
}

/// Whether a difference gives a slice that both runs have another plane, or other parts or fields in it.
fn is_other_slice(difference: &Difference) -> bool {
    let key = difference.key.strip_prefix("output.slices.").and_then(|rest| rest.rsplit_once('.'));
    key.is_some_and(|(_, key)| !["every", "csv"].contains(&key))
}

/// Whether the runs have the same fingerprint if the new one takes the tables of the old one, from which it differs only at times to come.
fn differs_in_tables_to_come(
    before: &Metadata,
    differences: &Differences,
    fingerprint: impl Fn(&str) -> String,
) -> bool {
    let lasting = lasting_of(&before.case_text);
    differences.lasting.is_empty() && lasting.is_ok_and(|lasting| fingerprint(&lasting) == before.case_fingerprint)
}

/// The first difference in the lasting part, with the values of the cases.
fn first_lasting(Differences { all, lasting, .. }: &Differences) -> Option<&Difference> {
    let first = lasting.first()?;
    Some(all.iter().find(|difference| difference.key == first.key).unwrap_or(first))
}

fn and_more(differences: &[Difference]) -> String {
    match differences.len() - 1 {
        0 => String::new(),
        more => format!(", and {more} more"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A slice in another plane went on in the same series without a word.
    #[test]
    fn another_plane_is_told_and_a_new_slice_is_not() {
        let of = |key: &str| is_other_slice(&Difference { key: key.to_owned(), before: None, now: None });
        assert!(of("output.slices.wake.point") && of("output.slices.wake.parts"));
        assert!(!of("output.slices.wake") && !of("output.slices.wake.every") && !of("output.lines.wake.from"));
    }
}
