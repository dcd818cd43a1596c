//! Runs in several processes of MPI: signals, killed processes, too little memory, a case that one cannot read.
//!
//! Only with the feature `mpi`, and with `mpirun`: `cargo nextest run --release -p stsolve --features mpi --test processes`. `STSOLVE_KILLS=200`
//! kills more often, see `scripts/test_kills --ranks`. `scripts/test` sets what Open MPI needs to start more processes than there are cores.

#![cfg(all(unix, feature = "mpi"))]
#![allow(clippy::unwrap_used)]

mod common;
#[path = "common/random.rs"]
mod random;

use common::{assert_same_bits, shipped};
use random::Random;
use std::fs;
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// A vortex on 36 cells in 4 blocks, 40 slabs.
const SMALL: [&str; 6] = [
    "mesh.generate.box.cells=[6,6]",
    "flow.order=3",
    "time.step=0.05",
    "time.end=2",
    "output.checkpoint_every=3",
    "parallel.blocks=4",
];

/// One group of processes: how many, what starts the program, and more arguments.
struct Group<'a> {
    processes: usize,
    prefix: &'a [&'a str],
    extra: &'a [&'a str],
}

/// So many processes that are all alike.
fn alike<'a>(processes: usize, extra: &'a [&'a str]) -> Group<'a> {
    Group { processes, prefix: &[], extra }
}

/// Starts the run in the folder `run`.
fn start(directory: &Path, groups: &[Group]) -> Child {
    let case = shipped("vortex.toml");
    let set: Vec<&str> = SMALL.iter().flat_map(|change| ["--set", change]).collect();
    let program = assert_cmd::cargo::cargo_bin("stsolve");
    let mut command = Command::new("mpirun");
    for (number, Group { processes, prefix, extra }) in groups.iter().enumerate() {
        command.args(if number > 0 { &[":"][..] } else { &[] });
        command.args(["-n", &processes.to_string()]).args(*prefix).arg(&program);
        command.args(["run", &case, "--output", "run", "--threads", "1"]).args(&set).args(*extra);
    }
    command.current_dir(directory).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap()
}

/// Waits for the end of a process: a run that hangs is killed.
fn wait(process: &mut Child) -> ExitStatus {
    let begun = Instant::now();
    loop {
        if let Some(status) = process.try_wait().unwrap() {
            return status;
        }
        if begun.elapsed() > Duration::from_secs(60) {
            process.kill().unwrap();
            panic!("the run hangs");
        }
        std::thread::sleep(Duration::from_millis(1));
    }
}

/// The exit code and the standard error of a run.
fn end_of(mut process: Child) -> (Option<i32>, String) {
    // The pipe is read meanwhile: a full one would stop the run.
    let mut pipe = process.stderr.take().unwrap();
    let reader = std::thread::spawn(move || std::io::read_to_string(&mut pipe).unwrap());
    (wait(&mut process).code(), reader.join().unwrap())
}

/// An undisturbed run, and its duration.
fn undisturbed() -> (TempDir, Duration) {
    let (directory, begun) = (TempDir::new().unwrap(), Instant::now());
    let (code, message) = end_of(start(directory.path(), &[alike(4, &[])]));
    assert_eq!(code, Some(0), "{message}");
    (directory, begun.elapsed())
}

/// Every process moved the mesh on its own, and all but one failed because the directory was in use.
#[test]
fn the_mesh_alone_moves_in_one_process() {
    let directory = TempDir::new().unwrap();
    let mut command = Command::new("mpirun");
    command.args(["-n", "2"]).arg(assert_cmd::cargo::cargo_bin("stsolve"));
    command.args(["motion", &shipped("vortex.toml"), "--output", "run"]).current_dir(directory.path());
    let (code, message) = end_of(command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap());
    assert_eq!(code, Some(2), "{message}");
    assert!(message.contains("the mesh alone moves in one process, not in 2"), "{message}");
    assert!(!message.contains("in use") && !directory.path().join("run").exists(), "{message}");
}

/// Resumes the run if possible, or else starts it anew.
fn go_on(directory: &Path, processes: usize) -> Child {
    let resume = directory.join("run/result.vtkhdf").exists();
    start(directory, &[alike(processes, if resume { &["--resume"] } else { &["--force"] })])
}

/// Continues to the end in so many processes; the bits must equal those of the undisturbed run.
fn assert_ends_well(directory: &Path, undisturbed: &Path, processes: usize, what: &str) {
    let (code, message) = end_of(go_on(directory, processes));
    assert_eq!(code, Some(0), "{what}: {message}");
    assert_same_bits(&directory.join("run"), &undisturbed.join("run"), what);
}

/// Slabs in history.csv.
fn slabs_told(directory: &Path) -> usize {
    fs::read_to_string(directory.join("run/history.csv")).map_or(0, |text| text.lines().count().saturating_sub(1))
}

/// Waits until the run has told of so many slabs.
fn await_slabs(directory: &Path, slabs: usize) {
    let begun = Instant::now();
    while slabs_told(directory) < slabs {
        assert!(begun.elapsed() < Duration::from_secs(60), "no slab is done");
        std::thread::sleep(Duration::from_millis(1));
    }
}

/// The processes that a process has started, and those that these have started.
fn descendants(process: u32) -> Vec<u32> {
    let children = Command::new("pgrep").args(["-P", &process.to_string()]).output().unwrap().stdout;
    let children: Vec<u32> = String::from_utf8(children).unwrap().lines().map(|line| line.parse().unwrap()).collect();
    children.iter().flat_map(|&child| std::iter::once(child).chain(descendants(child))).collect()
}

/// The ranks below a launcher, those that run this program.
fn ranks_of(launcher: &Child) -> Vec<u32> {
    let is_rank =
        |process: &u32| fs::read_link(format!("/proc/{process}/exe")).is_ok_and(|program| program.ends_with("stsolve"));
    descendants(launcher.id()).into_iter().filter(is_rank).collect()
}

fn signal(process: u32, name: &str) {
    // The process may have ended before.
    Command::new("kill").args([&format!("-{name}"), &process.to_string()]).stderr(Stdio::null()).status().unwrap();
}

#[test]
fn a_user_signal_to_the_launcher_ends_all_with_a_checkpoint() {
    let (through, _) = undisturbed();
    let directory = TempDir::new().unwrap();
    let process = start(directory.path(), &[alike(4, &[])]);
    await_slabs(directory.path(), 4);
    signal(process.id(), "USR1");
    let (code, message) = end_of(process);
    assert_eq!(code, Some(3), "{message}");
    assert_eq!(message.matches("finishing this slab").count(), 1, "{message}");
    assert!(slabs_told(directory.path()) < 40, "the signal came too late");
    assert_ends_well(directory.path(), through.path(), 3, "after a signal");
}

/// The second signal, that to the launcher, ended all without a checkpoint.
#[test]
fn a_signal_to_another_process_than_the_first_changes_nothing() {
    let directory = TempDir::new().unwrap();
    let process = start(directory.path(), &[alike(2, &[])]);
    await_slabs(directory.path(), 4);
    signal(ranks_of(&process).into_iter().max().unwrap(), "USR1");
    await_slabs(directory.path(), 6);
    signal(process.id(), "USR1");
    let (code, message) = end_of(process);
    assert_eq!(code, Some(3), "{message}");
    assert_ends_well(directory.path(), undisturbed().0.path(), 3, "after two signals");
}

#[test]
#[allow(clippy::print_stdout)]
fn a_run_whose_processes_are_killed_resumes_on_another_number_of_them() {
    let kills = std::env::var("STSOLVE_KILLS").map_or(6, |number| number.parse().unwrap());
    let (through, duration) = undisturbed();
    let mut random = Random(9);
    let mut directory = TempDir::new().unwrap();
    let (mut killed, mut ended) = (0, 0);
    while killed < kills {
        let process = go_on(directory.path(), [4, 3][killed % 2]);
        std::thread::sleep(duration.mul_f64(random.below(1000) as f64 / 1000.0));
        let ranks = ranks_of(&process);
        if !ranks.is_empty() {
            signal(ranks[random.below(ranks.len())], "KILL");
        }
        let (code, message) = end_of(process);
        if code == Some(0) {
            assert_same_bits(&directory.path().join("run"), &through.path().join("run"), "not killed");
            (directory, ended) = (TempDir::new().unwrap(), ended + 1);
            continue;
        }
        assert!(!ranks.is_empty(), "{message}");
        killed += 1;
    }
    assert_ends_well(directory.path(), through.path(), 3, "after the last kill");
    println!("{killed} kills, {} runs brought to their end", ended + 1);
}

/// The largest address space of a process so far, in kB.
fn address_space(process: u32) -> u64 {
    let status = fs::read_to_string(format!("/proc/{process}/status")).unwrap();
    let line = status.lines().find_map(|line| line.strip_prefix("VmPeak:")).unwrap();
    line.trim().trim_end_matches("kB").trim().parse().unwrap()
}

/// Resumes a copy of the run; of three processes the second has an address space of so many kB only.
fn resume_with_little_memory(run: &Path, kilobytes: u64) -> (TempDir, Option<i32>, String) {
    let directory = TempDir::new().unwrap();
    fs::create_dir(directory.path().join("run")).unwrap();
    for file in fs::read_dir(run).unwrap().map(Result::unwrap) {
        fs::copy(file.path(), directory.path().join("run").join(file.file_name())).unwrap();
    }
    let limit = format!("ulimit -v {kilobytes}; exec \"$0\" \"$@\"");
    let limited = Group { processes: 1, prefix: &["bash", "-c", &limit], extra: &["--resume"] };
    let groups = [alike(1, &["--resume"]), limited, alike(1, &["--resume"])];
    let (code, message) = end_of(start(directory.path(), &groups));
    (directory, code, message)
}

/// The second of three processes may have nine tenths of the memory that it has taken before.
///
/// Address space is not memory: the allocator reserves more than it uses, so the process may do with less. Then its share is reduced further.
#[test]
fn a_process_with_too_little_memory_ends_all_and_spoils_nothing() {
    let (through, _) = undisturbed();
    let directory = TempDir::new().unwrap();
    let process = start(directory.path(), &[alike(3, &[])]);
    await_slabs(directory.path(), 4);
    let taken = ranks_of(&process).into_iter().map(address_space).min().unwrap();
    signal(process.id(), "USR1");
    assert_eq!(end_of(process).0, Some(3));
    let run = directory.path().join("run");
    let (ended, message) = [9, 8, 7, 6, 5]
        .into_iter()
        .map(|tenths| resume_with_little_memory(&run, taken / 10 * tenths))
        .find_map(|(directory, code, message)| (code != Some(0)).then_some((directory, message)))
        .expect("a process with half of its memory ends the run");
    assert!(ended.path().join("run/result.vtkhdf").exists(), "{message}");
    assert_ends_well(ended.path(), through.path(), 3, "after a lack of memory");
}

#[test]
fn a_case_that_one_process_cannot_read_ends_all() {
    let directory = TempDir::new().unwrap();
    let groups = [alike(1, &[]), alike(1, &["--set", "flow.order=none"]), alike(1, &[])];
    let (code, message) = end_of(start(directory.path(), &groups));
    assert_eq!(code, Some(2), "{message}");
    assert!(message.contains("error: process 1") && message.contains("flow.order"), "{message}");
    assert!(!directory.path().join("run").exists());
}

#[test]
fn other_processes_log_on_demand() {
    let directory = TempDir::new().unwrap();
    let short = ["--set", "time.end=0.2", "--log-ranks"];
    let (code, message) = end_of(start(directory.path(), &[alike(3, &short)]));
    assert_eq!(code, Some(0), "{message}");
    let log = |name: &str| fs::read_to_string(directory.path().join("run").join(name)).unwrap();
    let steps = |log: &str| log.lines().filter(|line| line.contains("\"Newton step\"")).count();
    let first = steps(&log("log.jsonl"));
    assert!(first > 0);
    for rank in [1, 2] {
        assert_eq!(steps(&log(&format!("log_{rank}.jsonl"))), first, "process {rank}");
    }
}
