//! Killed runs, a full disk, truncated files, two runs in one directory.
//!
//! In all cases at most one checkpoint interval is lost, every file can be read or is refused, and nothing hangs. A continued
//! run ends with the bits of an undisturbed one. `STSOLVE_KILLS=200` runs the long version, see `scripts/test_kills`.

#![cfg(unix)]
#![allow(clippy::unwrap_used)]

mod common;
#[path = "common/random.rs"]
mod random;

use common::{assert_same_bits, checkpoint, shipped};
use random::Random;
use std::fs;
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// Slabs between checkpoints.
const INTERVAL: usize = 3;

/// A vortex on 9 cells, 100 slabs.
const SMALL: [&str; 6] = [
    "mesh.order=2",
    "mesh.generate.box.cells=[3,3]",
    "flow.order=2",
    "time.end=10",
    "output.checkpoint_every=3",
    "output.fields=[]",
];

/// The arguments of the run in the folder `run`, with `extra` ones.
fn arguments(extra: &[&str]) -> Vec<String> {
    let case = shipped("vortex.toml");
    let set = SMALL.iter().flat_map(|change| ["--set", change]);
    let fixed = ["run", &case, "--output", "run", "--quiet", "--threads", "1"];
    fixed.into_iter().chain(set).chain(extra.iter().copied()).map(str::to_owned).collect()
}

fn start(directory: &Path, extra: &[&str]) -> Child {
    let mut command = Command::new(assert_cmd::cargo::cargo_bin("stsolve"));
    command.current_dir(directory).args(arguments(extra)).stderr(Stdio::piped()).spawn().unwrap()
}

/// Waits for the end of a process, for a limited time.
fn wait(process: &mut Child) -> ExitStatus {
    let begun = Instant::now();
    loop {
        if let Some(status) = process.try_wait().unwrap() {
            return status;
        }
        assert!(begun.elapsed() < Duration::from_secs(120), "the run hangs");
        std::thread::sleep(Duration::from_millis(1));
    }
}

/// The standard error of a process that has ended.
fn report(process: Child) -> String {
    String::from_utf8(process.wait_with_output().unwrap().stderr).unwrap()
}

/// An undisturbed run, and its duration.
fn undisturbed() -> (TempDir, Duration) {
    let (directory, begun) = (TempDir::new().unwrap(), Instant::now());
    assert!(wait(&mut start(directory.path(), &[])).success());
    (directory, begun.elapsed())
}

/// Slabs in the checkpoint of a run: 0 if there is no result file yet. Fails if a file cannot be read.
fn slabs_kept(run: &Path) -> usize {
    let result = run.join("result.vtkhdf");
    if !result.exists() {
        return 0;
    }
    output::inspect(&result).unwrap();
    checkpoint(run).1["slab"] as usize
}

/// Slabs in history.csv, after a check that all rows are whole.
fn slabs_told(run: &Path) -> usize {
    let Ok(text) = fs::read_to_string(run.join("history.csv")) else { return 0 };
    let columns: Vec<usize> = text.lines().map(|row| row.split(',').count()).collect();
    assert!(text.ends_with('\n') && columns.iter().all(|count| *count == columns[0]), "a torn row in:\n{text}");
    columns.len() - 1
}

/// Resumes the run if possible, or else starts it anew in the place of what it has left.
fn go_on(directory: &Path) -> Child {
    let resume = directory.join("run/result.vtkhdf").exists();
    start(directory, &[if resume { "--resume" } else { "--force" }])
}

/// Continues to the end. The bits must equal those of the undisturbed run, and no working files may be left.
fn assert_ends_well(directory: &Path, undisturbed: &Path, what: &str) {
    let mut process = go_on(directory);
    let status = wait(&mut process);
    assert!(status.success(), "{what}: {}", report(process));
    let run = directory.join("run");
    assert_same_bits(&run, &undisturbed.join("run"), what);
    let mut names: Vec<_> = fs::read_dir(&run).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    names.sort();
    assert_eq!(names, ["history.csv", "log.jsonl", "result.vtkhdf", "summary.json"], "{what}");
}

#[test]
#[allow(clippy::print_stdout)]
fn a_killed_run_loses_at_most_one_checkpoint_interval() {
    let kills = std::env::var("STSOLVE_KILLS").map_or(16, |number| number.parse().unwrap());
    let (through, mut duration) = undisturbed();
    let mut random = Random(9);
    let mut directory = TempDir::new().unwrap();
    let (mut killed, mut ended) = (0, 0);
    while killed < kills {
        let mut process = go_on(directory.path());
        std::thread::sleep(duration.mul_f64(random.below(1000) as f64 / 1000.0));
        process.kill().unwrap();
        let run = directory.path().join("run");
        if wait(&mut process).success() {
            assert_ends_well(directory.path(), through.path(), "the run had ended before it was killed");
            (directory, ended) = (TempDir::new().unwrap(), ended + 1);
            // The first run had less of the machine than this one.
            duration = duration.mul_f64(0.8);
            continue;
        }
        killed += 1;
        let (kept, told) = (slabs_kept(&run), slabs_told(&run));
        assert!(kept + INTERVAL >= told, "kill {killed}: {told} slabs were done, the checkpoint has {kept}");
    }
    assert_ends_well(directory.path(), through.path(), "after the last kill");
    println!("{killed} kills, {} runs brought to their end", ended + 1);
}

/// A limit of the file size stands for a full disk: writing fails there, in any file and step.
#[test]
fn a_full_disk_stops_the_run_and_spoils_nothing() {
    let (through, _) = undisturbed();
    let whole = fs::metadata(through.path().join("run/result.vtkhdf")).unwrap().len() as usize / 1024;
    let mut random = Random(10);
    for trial in 0..8 {
        let directory = TempDir::new().unwrap();
        let limit = if trial == 0 { 0 } else { random.below(whole) };
        // XFSZ is the signal of a file that grows too large; ignored, it leaves the error to the program.
        let script = format!("trap '' XFSZ; ulimit -f {limit}; exec \"$0\" \"$@\"");
        let program = assert_cmd::cargo::cargo_bin("stsolve");
        let mut shell = Command::new("bash");
        shell.args(["-c", &script]).arg(program).args(arguments(&[])).current_dir(directory.path());
        let mut process = shell.stderr(Stdio::piped()).spawn().unwrap();
        let status = wait(&mut process);
        let message = report(process);
        assert!(matches!(status.code(), Some(1 | 2)), "{limit} kB: {status}: {message}");
        assert!(message.starts_with("error: ") && message.contains("`run"), "{limit} kB: {message}");
        let run = directory.path().join("run");
        assert!(slabs_kept(&run) + INTERVAL >= slabs_told(&run), "{limit} kB");
        assert_ends_well(directory.path(), through.path(), &format!("{limit} kB"));
    }
}

/// A randomly truncated file is refused with its name, or does not matter to the continued run.
#[test]
fn a_cut_file_is_refused_or_does_not_matter() {
    let (through, _) = undisturbed();
    let mut random = Random(11);
    for name in ["result.vtkhdf", "history.csv", "summary.json", "log.jsonl"] {
        for _ in 0..3 {
            let directory = TempDir::new().unwrap();
            fs::create_dir(directory.path().join("run")).unwrap();
            for entry in fs::read_dir(through.path().join("run")).unwrap() {
                let path = entry.unwrap().path();
                fs::copy(&path, directory.path().join("run").join(path.file_name().unwrap())).unwrap();
            }
            let path = directory.path().join("run").join(name);
            let bytes = fs::read(&path).unwrap();
            fs::write(&path, &bytes[..random.below(bytes.len())]).unwrap();
            if name == "result.vtkhdf" {
                let mut process = go_on(directory.path());
                assert_eq!(wait(&mut process).code(), Some(2));
                let message = report(process);
                assert!(message.contains("`run/result.vtkhdf` is damaged"), "{message}");
            } else {
                assert_ends_well(directory.path(), through.path(), name);
            }
        }
    }
}

#[test]
fn of_two_runs_in_one_directory_the_second_is_told_of_the_first() {
    for trial in 0..6 {
        let directory = TempDir::new().unwrap();
        let mut runs = [start(directory.path(), &[]), start(directory.path(), &[])];
        let begun = Instant::now();
        let refused = loop {
            if let Some(refused) = (0..2).find(|&i| runs[i].try_wait().unwrap().is_some()) {
                break refused;
            }
            assert!(begun.elapsed() < Duration::from_secs(120), "both runs hang");
        };
        let holder = runs[1 - refused].id();
        let [first, second] = &mut runs;
        let (loser, winner) = if refused == 0 { (first, second) } else { (second, first) };
        let code = wait(loser).code();
        winner.kill().unwrap();
        winner.wait().unwrap();
        let [first, second] = runs;
        let message = report(if refused == 0 { first } else { second });
        assert_eq!(code, Some(2), "trial {trial}: {message}");
        assert!(message.contains(&format!("process {holder} on ")), "trial {trial}, process {holder}: {message}");
    }
}
