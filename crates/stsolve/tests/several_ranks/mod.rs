//! Runs of shipped cases on several ranks, which are threads of one process here.

#![allow(clippy::unwrap_used, dead_code)]

use crate::common::{assert_same_bits, shipped};
use case::AnyCase;
use ranks::{FileSharing, Threads};
use simulation::{Destination, Existing, Failure};
use std::path::Path;
use tempfile::TempDir;

/// Runs a shipped case on so many ranks of so many threads each; returns what rank 0 ends with.
pub fn attempt(
    numbers: (usize, usize),
    case: &str,
    changes: &[String],
    destination: (&Path, Existing),
) -> Result<(), Failure> {
    attempt_with(None, numbers, case, changes, destination)
}

/// The same with files that are written as `sharing` tells.
pub fn attempt_with(
    sharing: Option<FileSharing>,
    numbers: (usize, usize),
    case: &str,
    changes: &[String],
    destination: (&Path, Existing),
) -> Result<(), Failure> {
    attempt_each(sharing, numbers, case, &|_| changes.to_vec(), destination)
}

/// The same with changes that depend on the rank. Every rank has threads of its own: one that waits for a message must not keep another from its
/// work.
pub fn attempt_each(
    sharing: Option<FileSharing>,
    (ranks, threads): (usize, usize),
    case: &str,
    changes: &(dyn Fn(usize) -> Vec<String> + Sync),
    (directory, existing): (&Path, Existing),
) -> Result<(), Failure> {
    let results = Threads::run_with(sharing, ranks, |communicator| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let (file, changes) = (shipped(&format!("{case}.toml")), changes(communicator.rank()));
            let case = AnyCase::read(Path::new(&file), &changes).unwrap();
            if communicator.rank() > 0 {
                simulation::serve(&case, &communicator);
                return Ok(());
            }
            let destination = Destination { directory: directory.to_owned(), existing };
            simulation::run_on(communicator, &case, &destination, &()).map(drop)
        })
    });
    results.into_iter().next().unwrap()
}

/// The same of a run that reaches its end.
pub fn run(ranks: usize, threads: usize, case: &str, changes: &[String], directory: &Path, existing: Existing) {
    attempt((ranks, threads), case, changes, (directory, existing)).unwrap();
}

/// Changes of a case as the command line takes them.
pub fn changes(changes: &[&str]) -> Vec<String> {
    changes.iter().map(|&change| change.to_owned()).collect()
}

/// The same for pairs of numbers of ranks and of threads.
pub fn assert_same_bits_on(numbers: &[(usize, usize)], case: &str, set: &[&str]) -> TempDir {
    let (directory, set) = (TempDir::new().unwrap(), changes(set));
    let at = |name: &str| directory.path().join(name);
    run(1, 1, case, &set, &at("1"), Existing::Keep);
    for &(ranks, threads) in numbers {
        let name = format!("{ranks}_{threads}");
        run(ranks, threads, case, &set, &at(&name), Existing::Keep);
        assert_same_bits(&at("1"), &at(&name), &format!("{case}: {ranks} ranks of {threads} threads"));
    }
    directory
}
