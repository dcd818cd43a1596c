//! Decides whether a run may continue from a checkpoint.

use case::{Difference, Differences, differences};
use output::Metadata;

/// The settings that may change, for the end of a message.
const MAY_CHANGE: &str =
    "only the end of the run, `time.adaptive`, `[solver]` and `[output]` but for its fields may change";

/// Decides whether a run continues from a checkpoint of the run `before`, and logs the settings that change.
///
/// # Errors
/// The reason of the refusal.
pub fn accept(before: &Metadata, now: &Metadata) -> Result<(), String> {
    let differences = differences(&before.case_text, &now.case_text);
    if before.case_fingerprint == now.case_fingerprint {
        let changed = differences.unwrap_or_default().all;
        changed.iter().for_each(|difference| tracing::info!(%difference, "resumed with another setting"));
        return Ok(());
    }
    let differences =
        differences.map_err(|reason| format!("it was written by another version of the program ({reason})"))?;
    Err(match first_lasting(&differences) {
        Some(difference) => format!("{difference}{}; {MAY_CHANGE}", and_more(&differences.lasting)),
        None if before.mesh_id != now.mesh_id => {
            "the mesh at rest is another one, perhaps because its file has changed".to_owned()
        }
        None => "the mesh was moved alone there, and is solved with a flow here, or the other way round".to_owned(),
    })
}

/// The first difference in the lasting part, with the values of the cases.
fn first_lasting(Differences { all, lasting }: &Differences) -> Option<&Difference> {
    let first = lasting.first()?;
    Some(all.iter().find(|difference| difference.key == first.key).unwrap_or(first))
}

fn and_more(differences: &[Difference]) -> String {
    match differences.len() - 1 {
        0 => String::new(),
        more => format!(", and {more} more"),
    }
}
