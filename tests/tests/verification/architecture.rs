//! Invariants of the architecture, `crates/README.md`, read off the sources.

use std::fs::{read_dir, read_to_string};
use std::path::{Path, PathBuf};

/// What is in a folder, by name.
fn entries(folder: &Path) -> Vec<PathBuf> {
    let mut entries: Vec<_> = read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    entries.sort();
    entries
}

/// The names of the crates that `is_chosen` by their folder.
fn crates(is_chosen: impl Fn(&Path) -> bool) -> Vec<String> {
    let all = entries(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../crates"));
    let chosen = all.iter().filter(|folder| folder.is_dir() && is_chosen(folder));
    chosen.map(|folder| folder.file_name().unwrap().to_string_lossy().into_owned()).collect()
}

/// Whether a crate depends on `library`, other than in its tests.
fn depends_on(folder: &Path, library: &str) -> bool {
    let manifest = read_to_string(folder.join("Cargo.toml")).unwrap();
    let section = manifest.lines().skip_while(|line| *line != "[dependencies]").skip(1);
    section.take_while(|line| !line.starts_with('[')).any(|line| line.split(['.', ' ', '=']).next() == Some(library))
}

/// The Rust files below a folder without those of tests, whose names begin with `test`.
fn sources(folder: &Path) -> Vec<PathBuf> {
    let is_test = |path: &Path| path.file_stem().is_some_and(|stem| stem.to_string_lossy().starts_with("test"));
    let below = |path: PathBuf| if path.is_dir() { sources(&path) } else { vec![path] };
    let mut files: Vec<_> = entries(folder).into_iter().filter(|path| !is_test(path)).flat_map(below).collect();
    files.retain(|file| file.extension().is_some_and(|extension| extension == "rs"));
    files
}

/// Whether a file contains one of the `words`, other than in tests and comments.
fn file_contains(file: &Path, words: &[&str]) -> bool {
    let text = read_to_string(file).unwrap();
    let code = text.split("#[cfg(test)]\nmod tests {").next().unwrap();
    let mut lines = code.lines().filter(|line| !line.trim_start().starts_with("//"));
    lines.any(|line| words.iter().any(|word| line.contains(word)))
}

/// Whether a crate contains one of the `words`, other than in tests and comments.
fn contains(folder: &Path, words: &[&str]) -> bool {
    sources(&folder.join("src")).iter().any(|file| file_contains(file, words))
}

/// The files of all crates that contain one of the `words`, other than in tests and comments: `crate/src/file.rs`.
fn files_with(words: &[&str]) -> Vec<String> {
    let all = Path::new(env!("CARGO_MANIFEST_DIR")).join("../crates");
    let files = crates(|_| true).into_iter().flat_map(|name| sources(&all.join(name).join("src")));
    let found = files.filter(|file| file_contains(file, words));
    found.map(|file| file.strip_prefix(&all).unwrap().to_string_lossy().into_owned()).collect()
}

#[test]
fn a_library_of_files_ranks_or_the_terminal_has_few_users() {
    for (library, users) in [
        ("toml", &["case", "case_keys"][..]),
        ("hdf5", &["cgns", "output"]),
        ("mpi", &["message_passing"]),
        ("clap", &["stsolve"]),
        ("clap_complete", &["stsolve"]),
        ("indicatif", &["stsolve"]),
        ("signal-hook", &["stsolve"]),
    ] {
        assert_eq!(crates(|folder| depends_on(folder, library)), users, "{library}");
    }
}

#[test]
fn only_the_command_prints_and_exits() {
    let printing = ["print!(", "println!(", "stdout()", "stderr()"];
    assert_eq!(crates(|folder| contains(folder, &printing)), ["stsolve"]);
    // `Communicator::abort` ends the process.
    assert_eq!(crates(|folder| contains(folder, &["process::exit", "ExitCode"])), ["ranks", "stsolve"]);
}

/// Sums, maxima and minima over the mesh have one order, whatever the number of threads and ranks.
#[test]
fn only_newton_krylov_reduces_over_the_mesh() {
    // Over the ranks.
    assert_eq!(crates(|folder| contains(folder, &["sums.total(", "sums.largest("])), ["newton_krylov"]);
    // By rayon, in an order that depends on the threads.
    let by_threads = [".reduce(||", "par_iter().sum", "par_iter().min", "par_iter().max"];
    assert!(files_with(&by_threads).is_empty(), "{:?}", files_with(&by_threads));
    // In the crates whose numbers a march depends on.
    let extremes = ["f64::max)", "f64::min)"];
    let users = crates(|folder| {
        ["coupled", "elasticity"].iter().any(|name| folder.ends_with(name)) && contains(folder, &extremes)
    });
    assert!(users.is_empty(), "{users:?}");
}

/// Cells may have their own orders later: then only `Layout` knows which index belongs to which component. The preconditioner has vectors of
/// its own.
#[test]
fn indices_into_a_flow_go_through_the_layout() {
    let arithmetic = ["% M", "% components", "/ layout.nodes", "* layout.nodes", "/ one.nodes", "* one.nodes"];
    let mut files = files_with(&arithmetic);
    files.retain(|file| !file.starts_with("fem/") && !file.contains("/preconditioner/"));
    assert!(files.is_empty(), "{files:?}");
}

/// Where density, momentum and energy stand is known to the gas alone.
#[test]
fn only_navier_stokes_knows_which_component_is_the_energy() {
    assert_eq!(crates(|folder| contains(folder, &["[M - 1]", "== M - 1", ", M - 1"])), ["navier_stokes"]);
}

/// One of a slab of all blocks, one of an elastic body, and the one that replaces products of another by differences.
#[test]
fn there_are_few_nonlinear_problems() {
    let expected = ["coupled/src/system.rs", "elasticity/src/nonlinear.rs", "newton_krylov/src/finite_difference.rs"];
    assert_eq!(files_with(&["NonlinearProblem for "]), expected);
}

/// A law is written for numbers of any kind; lanes are one of them.
#[test]
fn the_physics_of_the_gas_knows_no_lanes() {
    let users = crates(|folder| contains(folder, &["Lanes", "pulp::", "Arch::"]));
    let expected =
        ["basis", "coupled", "elasticity", "fem", "mesh", "newton_krylov", "simulation", "stsolve", "tensor"];
    assert_eq!(users, expected);
}

/// A loop of rayon is compiled for each of its callers. These are hot, or of the report.
#[test]
fn few_loops_are_no_loops_of_mesh_parallel() {
    let mut files = files_with(&["par_iter", "par_chunks"]);
    files.retain(|file| !file.starts_with("report/"));
    let expected = [
        "coupled/src/preconditioner/coarse.rs",
        "elasticity/src/elastic_mesh/solve.rs",
        "elasticity/src/modal.rs",
        "elasticity/src/multigrid/aggregation.rs",
        "elasticity/src/multigrid/matrix.rs",
        "elasticity/src/multigrid/prolongation.rs",
        "elasticity/src/operator.rs",
        "fem/src/mesh_traces.rs",
        "fem/src/operator/evaluation.rs",
        "fem/src/traces.rs",
        "mesh/src/parallel.rs",
        "mesh/src/validity/mod.rs",
        "mesh/src/validity/motion.rs",
        "newton_krylov/src/inner_product/columns.rs",
        "simulation/src/averages/mod.rs",
    ];
    assert_eq!(files, expected);
}

/// The tables of modules had forgotten thirty, and kept one that was gone.
#[test]
fn a_table_of_modules_has_all_of_them() {
    let module = |line: &str| {
        let rest = ["mod ", "pub mod ", "pub(crate) mod "].iter().find_map(|start| line.strip_prefix(start))?;
        rest.strip_suffix(';').map(str::to_owned)
    };
    for name in crates(|folder| folder.join("src/lib.rs").exists()) {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../crates").join(&name).join("src/lib.rs");
        let text = read_to_string(file).unwrap();
        let rows: String = text.lines().filter_map(|line| line.strip_prefix("//! | `")?.split('|').next()).collect();
        if !text.contains("//! | module |") {
            continue;
        }
        let told = |module: &str| rows.split(|c: char| !c.is_alphanumeric() && c != '_').any(|word| word == module);
        let lines: Vec<&str> = text.lines().collect();
        let is_test = |k: usize| k > 0 && lines[k - 1] == "#[cfg(test)]";
        let modules = (0..lines.len()).filter(|&k| !is_test(k)).filter_map(|k| module(lines[k]));
        let missing: Vec<String> = modules.filter(|module| !told(module)).collect();
        assert!(missing.is_empty(), "{name}: {missing:?}");
    }
}
