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

/// The Rust files below a folder without those of tests.
fn sources(folder: &Path) -> Vec<PathBuf> {
    let is_test = |path: &Path| path.file_stem().is_some_and(|stem| stem == "tests");
    let below = |path: PathBuf| if path.is_dir() { sources(&path) } else { vec![path] };
    let mut files: Vec<_> = entries(folder).into_iter().filter(|path| !is_test(path)).flat_map(below).collect();
    files.retain(|file| file.extension().is_some_and(|extension| extension == "rs"));
    files
}

/// Whether a crate contains one of the `words`, other than in tests and comments.
fn contains(folder: &Path, words: &[&str]) -> bool {
    sources(&folder.join("src")).iter().any(|file| {
        let text = read_to_string(file).unwrap();
        let code = text.split("#[cfg(test)]\nmod tests {").next().unwrap();
        let mut lines = code.lines().filter(|line| !line.trim_start().starts_with("//"));
        lines.any(|line| words.iter().any(|word| line.contains(word)))
    })
}

#[test]
fn a_library_of_files_ranks_or_the_terminal_has_few_users() {
    for (library, users) in [
        ("toml", &["case"][..]),
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
