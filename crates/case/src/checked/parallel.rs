//! Work on several machines.

use crate::checker::{Checked, Checker};
use crate::key::Key;
use crate::raw::Parallel;

/// Checks `[parallel]` for a flow on so many `cells`, if there is one.
pub(super) fn check(checker: &Checker<'_>, raw: &Parallel, cells: Option<usize>) -> Checked<()> {
    let key = Key::new("parallel").child("blocks");
    checker.at_least_one(&key, "the number of blocks", raw.blocks)?;
    if raw.blocks == 1 {
        return Ok(());
    }
    let Some(cells) = cells else {
        return checker.require(
            &key,
            "the number of blocks",
            false,
            "1 without a flow: blocks share out the cells of a flow",
        );
    };
    let accepted = format!("1 to {cells}, the number of cells");
    checker.require(&key, "the number of blocks", raw.blocks <= cells, &accepted)
}
