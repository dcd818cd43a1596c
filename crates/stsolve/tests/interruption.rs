//! SIGTERM: the first one ends a run after the current slab, the second one at once. SIGHUP: ends a run after the current slab.

#![cfg(unix)]
#![allow(clippy::unwrap_used)]

mod common;

use common::{assert_same_bits, on_case, shipped, summary};
use std::io::{BufRead, BufReader};
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Child, ChildStderr, Command, Stdio};
use tempfile::TempDir;

/// A run in progress, and its output.
struct Running {
    process: Child,
    report: BufReader<ChildStderr>,
}

impl Running {
    fn start(directory: &Path, case: &str, set: &[&str]) -> Self {
        Self::start_with(directory, case, set, &[])
    }

    fn start_with(directory: &Path, case: &str, set: &[&str], extra: &[&str]) -> Self {
        let mut command = Command::new(assert_cmd::cargo::cargo_bin("stsolve"));
        command.env_remove("RUST_BACKTRACE").current_dir(directory).stderr(Stdio::piped());
        command.args(["run", &shipped(&format!("{case}.toml")), "--output", "run"]).args(extra);
        set.iter().for_each(|change| {
            command.args(["--set", change]);
        });
        let mut process = command.spawn().unwrap();
        let report = BufReader::new(process.stderr.take().unwrap());
        Running { process, report }
    }

    /// Waits for a line that contains `text`.
    fn wait_for(&mut self, text: &str) -> String {
        let mut line = String::new();
        while !line.contains(text) {
            line.clear();
            assert!(self.report.read_line(&mut line).unwrap() > 0, "the run ended without `{text}`");
        }
        line
    }

    fn terminate(&self) {
        self.send("-TERM");
    }

    fn send(&self, signal: &str) {
        let sent = Command::new("kill").args([signal, &self.process.id().to_string()]).status().unwrap();
        assert!(sent.success());
    }
}

#[test]
fn a_run_that_is_stopped_and_resumed_has_the_same_bits() {
    stop_and_resume("vortex", &["time.end=4", "output.checkpoint_every=7"]);
}

/// If slabs are adapted, the length of the next one belongs to the state.
#[test]
fn a_run_with_adapted_slabs_that_is_stopped_and_resumed_has_the_same_bits() {
    stop_and_resume("vortex", &["time.end=4", "time.step=0.02", "time.adaptive.tolerance=2e-5"]);
}

/// Low-order blocks are rounded. They were rounded anew for another length of the slab.
#[test]
fn adapted_slabs_with_the_low_order_preconditioner_keep_their_bits() {
    let adapted = ["time.end=4", "time.step=0.02", "time.adaptive.tolerance=2e-5", "solver.preconditioner=low_order"];
    stop_and_resume("vortex", &adapted);
}

/// From its steady start on, with impulse and work in the history.
#[test]
fn an_airfoil_that_is_stopped_and_resumed_has_the_same_bits() {
    stop_and_resume(
        "naca0012_heave",
        &[
            "mesh.order=3",
            "flow.order=3",
            "mesh.generate.airfoil={ first_cell = 0.015, trailing_edge_cell = 0.02, surface_cells = 8, wake_cells = 6, normal_cells = 10, far_field = 20 }",
            "time.end=0.6",
            "time.step=0.05",
        ],
    );
}

fn stop_and_resume(case: &str, set: &[&str]) {
    let directory = TempDir::new().unwrap();
    let mut running = Running::start(directory.path(), case, set);
    running.wait_for("slab 3 ");
    running.terminate();
    let message = running.wait_for("stopped at t = ");
    assert_eq!(running.process.wait().unwrap().code(), Some(3), "not 0: scripts must notice");
    // Without the quotes that a shell needs around braces and spaces.
    let resume = message.split("continue with: stsolve ").nth(1).unwrap().trim().replace('\'', "");
    let changes: Vec<String> = set.iter().map(|change| format!("--set {change}")).collect();
    assert!(resume.ends_with(&format!("{} --output run --resume", changes.join(" "))), "{resume}");

    let stopped = summary(&directory.path().join("run"));
    assert_eq!(stopped["completed"], false);
    assert!(stopped["reason"].as_str().unwrap().contains("signal"));
    let slabs = stopped["slabs"].as_u64().unwrap();
    assert!((3..40).contains(&slabs), "{slabs}");

    on_case(directory.path(), "run", case, set, "run", &["--resume"]).expect(0, &[]);
    on_case(directory.path(), "run", case, set, "through", &[]).expect(0, &[]);
    assert_same_bits(&directory.path().join("run"), &directory.path().join("through"), "stopped by a signal");
    assert_eq!(summary(&directory.path().join("run"))["completed"], true);
}

#[test]
fn the_second_signal_ends_the_run_at_once() {
    let directory = TempDir::new().unwrap();
    // A slab of this case takes long enough for two signals.
    let mut running = Running::start(directory.path(), "vortex", &["mesh.generate.box.cells=[40,40]", "flow.order=6"]);
    running.wait_for("slab 1 ");
    running.terminate();
    running.wait_for("finishing this slab");
    running.terminate();
    assert_eq!(running.process.wait().unwrap().signal(), Some(15));
    assert!(!directory.path().join("run/summary.json").exists());
}

/// A terminal that closed killed the run, without a checkpoint. The shell and the system may both send the signal.
#[test]
#[cfg(target_os = "linux")]
fn a_terminal_that_closes_ends_the_run_with_a_checkpoint() {
    let directory = TempDir::new().unwrap();
    let mut running = Running::start(directory.path(), "vortex", &["time.end=100"]);
    running.wait_for("slab 1 ");
    running.send("-HUP");
    running.send("-HUP");
    running.wait_for("stopped at t = ");
    assert_eq!(running.process.wait().unwrap().code(), Some(3));
    assert_eq!(summary(&directory.path().join("run"))["completed"], false);
}

/// The handler must not undo `nohup`.
#[test]
fn a_run_that_ignores_its_terminal_goes_on() {
    let directory = TempDir::new().unwrap();
    let program = assert_cmd::cargo::cargo_bin("stsolve");
    let run = format!(
        "trap '' HUP; exec '{}' run '{}' --output run --set time.end=4",
        program.display(),
        shipped("vortex.toml")
    );
    let mut shell = Command::new("sh");
    shell.args(["-c", &run]).current_dir(directory.path()).stderr(Stdio::piped());
    let mut process = shell.spawn().unwrap();
    let report = BufReader::new(process.stderr.take().unwrap());
    let mut running = Running { process, report };
    running.wait_for("slab 1 ");
    running.send("-HUP");
    assert!(running.process.wait().unwrap().success());
    assert_eq!(summary(&directory.path().join("run"))["completed"], true);
}

/// During a run there is no summary, so that after a kill none describes another run.
#[test]
fn a_stale_summary_stood_beside_the_half_result_of_another_run() {
    let directory = TempDir::new().unwrap();
    let set = ["mesh.generate.box.cells=[4,4]", "output.checkpoint_every=1"];
    let short = [&set[..], &["time.end=0.1"]].concat();
    let long = [&set[..], &["time.end=100"]].concat();
    let run = directory.path().join("run");
    on_case(directory.path(), "run", "vortex", &short, "run", &[]).expect(0, &[]);
    assert_eq!(summary(&run)["completed"], true);
    for (extra, slab) in [("--resume", "slab 4 "), ("--force", "slab 2 ")] {
        let mut running = Running::start_with(directory.path(), "vortex", &long, &[extra]);
        running.wait_for(slab);
        running.process.kill().unwrap();
        running.process.wait().unwrap();
        assert!(!run.join("summary.json").exists(), "{extra}");
        let again = on_case(directory.path(), "run", "vortex", &long, "run", &[]);
        again.expect(2, &["holds an unfinished run, t = ", "--resume", "--force"]);
    }
    on_case(directory.path(), "run", "vortex", &[&set[..], &["time.end=0.4"]].concat(), "run", &["--resume"])
        .expect(0, &[]);
    assert_eq!(summary(&run)["completed"], true);
}
