//! Work on several machines.

use crate::checker::{Checked, Checker};
use crate::key::Key;
use crate::raw::{self, ElasticitySolver, Parallel, Stages};

/// Blocks with fewer cells than this lose many iterations if they are eliminated at the same time (docs/src/clusters.md).
const CELLS_OF_SMALL_BLOCK: usize = 40;

/// The number of groups of cells that the preconditioner eliminates one after the other, for a mesh of so many `cells`.
pub(super) fn stages(checker: &Checker<'_>, raw: &Parallel, cells: usize) -> Checked<usize> {
    let key = Key::new("parallel").child("stages");
    let accepted = "a whole number from 1, or \"exact\"";
    match &raw.stages {
        None if raw.blocks > 1 && cells < CELLS_OF_SMALL_BLOCK * raw.blocks => Ok(usize::MAX),
        None => Ok(1),
        Some(Stages::Name(name)) => {
            checker.require(&key, "the number of stages", name == "exact", accepted).map(|()| usize::MAX)
        }
        Some(Stages::Number(number)) => {
            checker.require(&key, "the number of stages", *number > 0, accepted).map(|()| *number)
        }
    }
}

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

/// A solver that works on blocks needs several.
pub(super) fn check_solver_of_mesh(checker: &Checker<'_>, raw: &raw::Case) -> Checked<()> {
    let elasticity = raw.motion.as_ref().and_then(|motion| motion.elasticity.as_ref());
    let on_blocks = elasticity.is_some_and(|elasticity| elasticity.solver == ElasticitySolver::Bddc);
    if !on_blocks || raw.parallel.blocks != 1 {
        return Ok(());
    }
    let key = Key::new("motion").child("elasticity").child("solver");
    let problem = "\"bddc\" works on several blocks of the mesh, and there is one";
    Err(checker.combination(&key, problem, "parallel.blocks = 2 or more, or another solver"))
}
