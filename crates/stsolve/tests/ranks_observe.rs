//! What a run on several ranks observes has the bits of a run on one: no rank has the whole flow.

#![allow(clippy::unwrap_used)]

mod common;
mod several_ranks;

use common::{contents, summary};
use output::{RESULT_FILE, ResultReader};
use several_ranks::{assert_same_bits_on, changes, run};
use simulation::Existing;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// Tables, lines, slices and distributions of a run, by their paths in its directory.
fn observed(run: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let is_observed = |path: &Path| path.extension().is_some_and(|kind| kind == "csv" || kind == "vtp");
    let here = |path: PathBuf| path.strip_prefix(run).unwrap().to_owned();
    contents(run).into_iter().filter(|(path, _)| is_observed(path)).map(|(path, bytes)| (here(path), bytes)).collect()
}

/// The bits of all coefficients of all steps of a result, averages among them.
fn steps(run: &Path) -> Vec<(String, Vec<u64>)> {
    let reader = ResultReader::open(&run.join(RESULT_FILE)).unwrap();
    let of = |name: &str, step| {
        let values = reader.exact(name, step).unwrap().unwrap();
        (format!("{name} {step}"), values.iter().map(|value| value.to_bits()).collect())
    };
    let names: Vec<&str> = reader.layout.exact.iter().map(|array| &array.name[..]).collect();
    (0..reader.times.len())
        .flat_map(|step| names.iter().map(move |name| (*name, step)))
        .map(|(n, s)| of(n, s))
        .collect()
}

/// Fails unless two runs have observed the same and have the same errors; there must be so many files.
fn assert_same_observations(one: &Path, other: &Path, files: usize) {
    let (here, there) = (observed(one), observed(other));
    assert_eq!(here.keys().collect::<Vec<_>>(), there.keys().collect::<Vec<_>>());
    assert_eq!(here.len(), files, "{:?}", here.keys());
    for (path, bytes) in &here {
        assert!(bytes == &there[path], "{} differs", path.display());
    }
    assert!(steps(one) == steps(other), "a step differs");
    let errors = |run: &Path| summary(run)["error"].clone();
    assert_eq!(errors(one), errors(other));
}

/// Walls, points, a line that cells leave, integrals, and averages over phases.
const AIRFOIL: [&str; 8] = [
    "flow.order=3",
    "time.end=0.4",
    "parallel.blocks=4",
    "output.every=2",
    "output.integrals=[\"kinetic_energy\",\"enstrophy\"]",
    "output.probes.wake={at=[1.5,0.1],fields=[\"pressure\"]}",
    "output.lines.wake={from=[1.2,-1],to=[1.2,1],points=9,fields=[\"velocity\"],every=2}",
    "output.averages={from=0.05,period=0.3,phases=2,fields=[\"velocity\",\"reynolds_stress\"]}",
];

#[test]
fn an_airfoil_is_observed_alike_on_any_number_of_ranks() {
    let walls = "output.surfaces={walls=[\"airfoil\"],every=1}";
    let runs = assert_same_bits_on(&[(3, 2), (4, 1)], "naca0012_heave", &[&AIRFOIL[..], &[walls]].concat());
    let at = |name: &str| runs.path().join(name);
    for other in ["3_2", "4_1"] {
        // history, the line, the distribution, its means and its separation points.
        assert_same_observations(&at("1"), &at(other), 5);
    }
}

/// A slice through cells of all ranks, averages along an axis, and errors of a flow that is known.
#[test]
fn a_flow_in_space_is_observed_alike_on_any_number_of_ranks() {
    let set = [
        "parallel.blocks=5",
        "time.slabs=3",
        "output.slices.middle={point=[0.5,0.5,0.5],normal=[1,1,0.3],fields=[\"velocity\"],every=1}",
        "output.averages={from=0.1,fields=[\"density\",\"velocity\"]}",
    ];
    let runs = assert_same_bits_on(&[(2, 1), (5, 1)], "free_stream_3d", &set);
    let at = |name: &str| runs.path().join(name);
    let files = observed(&at("1")).len();
    assert!(files > 3, "{files}");
    for other in ["2_1", "5_1"] {
        assert_same_observations(&at("1"), &at(other), files);
    }
}

/// Averages, as the rest of the state, go on on other ranks.
#[test]
fn averages_are_resumed_on_another_number_of_ranks() {
    let directory = TempDir::new().unwrap();
    let at = |name: &str| directory.path().join(name);
    let until = |end: &str| changes(&[&AIRFOIL[..], &[end]].concat());
    run(1, 1, "naca0012_heave", &until("time.end=0.6"), &at("through"), Existing::Keep);
    run(4, 1, "naca0012_heave", &until("time.end=0.2"), &at("interrupted"), Existing::Keep);
    for (ranks, end) in [(1, "time.end=0.4"), (3, "time.end=0.6")] {
        run(ranks, 1, "naca0012_heave", &until(end), &at("interrupted"), Existing::Resume);
    }
    let last = |name: &str| {
        let mut last = steps(&at(name));
        last.split_off(last.len() - 4)
    };
    assert!(last("through").iter().any(|(name, _)| name.starts_with("reynolds_stress")));
    assert!(last("through").iter().zip(last("interrupted")).all(|(one, other)| one.1 == other.1));
}
