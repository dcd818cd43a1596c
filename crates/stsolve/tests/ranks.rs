//! A run on several ranks has the bits of a run on one. Ranks are threads of one process here.

#![allow(clippy::unwrap_used)]

mod common;

use case::AnyCase;
use common::{assert_same_bits, number, shipped, summary};
use ranks::Threads;
use simulation::{Destination, Existing};
use std::path::Path;
use tempfile::TempDir;

/// Runs a shipped case on so many ranks of so many threads each.
fn run(ranks: usize, threads: usize, case: &str, changes: &[String], directory: &Path, existing: Existing) {
    Threads::run(ranks, |communicator| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let case = AnyCase::read(Path::new(&shipped(&format!("{case}.toml"))), changes).unwrap();
            if communicator.rank() > 0 {
                return simulation::serve(&case, &communicator);
            }
            let destination = Destination { directory: directory.to_owned(), existing };
            simulation::run_on(communicator, &case, &destination, &()).unwrap();
        });
    });
}

/// Changes of a case as the command line takes them.
fn changes(changes: &[&str]) -> Vec<String> {
    changes.iter().map(|&change| change.to_owned()).collect()
}

/// A run of a shipped case has the same bits on 1, 2, 3 and 4 ranks of one and two threads. Returns the run on one rank.
fn assert_ranks_leave_no_trace(case: &str, set: &[&str]) -> TempDir {
    let (directory, set) = (TempDir::new().unwrap(), changes(set));
    let at = |name: &str| directory.path().join(name);
    run(1, 1, case, &set, &at("1"), Existing::Keep);
    for (ranks, threads) in [(1, 2), (2, 1), (3, 2), (4, 1)] {
        let name = format!("{ranks}_{threads}");
        run(ranks, threads, case, &set, &at(&name), Existing::Keep);
        assert_same_bits(&at("1"), &at(&name), &format!("{case}: {ranks} ranks of {threads} threads"));
    }
    directory
}

const VORTEX: [&str; 4] = ["mesh.generate.box.cells=[6,6]", "time.step=0.2", "time.end=1", "parallel.blocks=4"];

#[test]
fn a_moving_vortex_has_the_same_bits_on_any_number_of_ranks() {
    let runs = assert_ranks_leave_no_trace("vortex", &VORTEX);
    let mass = number(&summary(&runs.path().join("4_1")), "conservation.mass_error");
    assert!(mass < 1e-13, "{mass:.1e}");
}
