//! Helpers shared by the tests of the command.

// Every test file compiles this module and uses a part of it.
#![allow(dead_code)]

use assert_cmd::Command;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The outcome of a command.
pub struct Outcome {
    /// The exit code.
    pub code: i32,
    /// Its standard output.
    pub stdout: String,
    /// Its standard error.
    pub stderr: String,
}

impl Outcome {
    /// Fails unless the exit code is `code` and stderr contains all `parts`.
    pub fn expect(&self, code: i32, parts: &[&str]) {
        assert_eq!(self.code, code, "{}", self.stderr);
        for part in parts {
            assert!(self.stderr.contains(part), "no `{part}` in: {}", self.stderr);
        }
    }
}

/// Calls the program in `directory`.
pub fn stsolve(directory: &Path, arguments: &[&str]) -> Outcome {
    let mut command = Command::cargo_bin("stsolve").unwrap();
    let output = command.env_remove("RUST_BACKTRACE").current_dir(directory).args(arguments).output().unwrap();
    let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).unwrap();
    let code = output.status.code().expect("the program was not killed");
    Outcome { code, stdout: text(&output.stdout), stderr: text(&output.stderr) }
}

/// A case of the folder `cases`.
pub fn shipped(name: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases").join(name).to_str().unwrap().into()
}

/// A command on the case `name`, changed by `set`, that writes into `output` in `directory`.
pub fn on_case(directory: &Path, command: &str, name: &str, set: &[&str], output: &str, extra: &[&str]) -> Outcome {
    let case = shipped(&format!("{name}.toml"));
    changed(directory, &[command, &case, "--output", output, "--quiet"], set, extra)
}

/// A run of the case `text`, changed by `set`, that writes into `output` in `directory`.
pub fn on_text(directory: &Path, text: &str, set: &[&str], output: &str, extra: &[&str]) -> Outcome {
    std::fs::write(directory.join("case.toml"), text).unwrap();
    changed(directory, &["run", "case.toml", "--output", output], set, extra)
}

/// A command on a case that is changed by `set`.
fn changed(directory: &Path, command: &[&str], set: &[&str], extra: &[&str]) -> Outcome {
    let set: Vec<&str> = set.iter().flat_map(|change| ["--set", change]).collect();
    stsolve(directory, &[command, &set, extra].concat())
}

/// Runs a case that must reach its end; returns its summary.
pub fn finished(directory: &Path, name: &str, set: &[&str]) -> serde_json::Value {
    on_case(directory, "run", name, set, name, &["--force"]).expect(0, &[]);
    let summary = summary(&directory.join(name));
    assert_eq!(summary["completed"], true);
    summary
}

/// summary.json of a run.
pub fn summary(run: &Path) -> serde_json::Value {
    serde_json::from_str(&std::fs::read_to_string(run.join("summary.json")).unwrap()).unwrap()
}

/// The number at a path such as `error.density_l2`.
pub fn number(json: &serde_json::Value, path: &str) -> f64 {
    let value = path.split('.').fold(json, |json, key| &json[key]);
    value.as_f64().unwrap_or_else(|| panic!("no number at {path} in {json}"))
}

/// Fails unless a run has kept mass and energy to round-off.
pub fn assert_conserves(summary: &serde_json::Value) {
    for figure in ["mass_error", "energy_error"] {
        let value = number(summary, &format!("conservation.{figure}"));
        assert!(value < 1e-12, "{figure}: {value:e}");
    }
}

/// A column of history.csv.
pub fn column(run: &Path, name: &str) -> Vec<f64> {
    let text = std::fs::read_to_string(run.join("history.csv")).unwrap();
    let position = text.lines().next().unwrap().split(',').position(|column| column == name).unwrap();
    text.lines().skip(1).map(|row| row.split(',').nth(position).unwrap().parse().unwrap()).collect()
}

/// The file `surface_WALL.csv` of a run.
pub struct Surface {
    names: Vec<String>,
    rows: Vec<Vec<f64>>,
}

impl Surface {
    /// Reads it.
    pub fn read(run: &Path, wall: &str) -> Self {
        let text = std::fs::read_to_string(run.join(format!("surface_{wall}.csv"))).unwrap();
        let mut lines = text.lines();
        let names = lines.next().unwrap().split(',').map(str::to_owned).collect();
        Surface { names, rows: lines.map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect()).collect() }
    }

    /// The rows at the time `t` alone.
    pub fn at(self, t: f64) -> Self {
        let rows = self.rows.into_iter().filter(|row| row[0] == t).collect();
        Surface { names: self.names, rows }
    }

    /// A column.
    pub fn column(&self, name: &str) -> Vec<f64> {
        let position = self.names.iter().position(|other| other == name).unwrap_or_else(|| panic!("no column {name}"));
        self.rows.iter().map(|row| row[position]).collect()
    }

    /// The integral of a column over the wall.
    pub fn integral(&self, name: &str) -> f64 {
        self.column("area").iter().zip(self.column(name)).map(|(area, value)| area * value).sum()
    }

    /// The force on the wall along an axis: that of pressure and of friction.
    pub fn force(&self, axis: &str) -> f64 {
        let [area, pressure, normal] = ["area", "pressure", &format!("normal_{axis}")].map(|name| self.column(name));
        let pushed: f64 = (0..area.len()).map(|i| area[i] * pressure[i] * normal[i]).sum();
        pushed + self.integral(&format!("friction_{axis}"))
    }
}

/// Case C2, `naca0012_heave_pitch`, at a Mach number of 0.01: the pressure at rest is 7,143 times the dynamic one.
pub const SLOW: [&str; 3] =
    ["flow.gas.mach=0.01", "flow.initial.uniform.mach=0.01", "flow.boundary.far.far_field.mach=0.01"];

/// F . h' + M . theta' of the airfoil of case C2 at every row of history.csv.
pub fn power_of_rates(run: &Path) -> Vec<f64> {
    let amplitude = 80.0 * std::f64::consts::PI / 180.0;
    let [t, force, moment] = ["t", "airfoil_force_y", "airfoil_moment"].map(|name| column(run, name));
    let heave = |t: f64| (24.0 * t.powi(2) - 12.0 * t.powi(3)) / 16.0;
    let pitch = |t: f64| -amplitude * (3.0 * t.powi(2) * (2.0 - t).powi(3) - 3.0 * t.powi(3) * (2.0 - t).powi(2));
    (0..t.len()).map(|i| force[i] * heave(t[i]) + moment[i] * pitch(t[i])).collect()
}

/// All numbers of the last checkpoint, bit by bit, and the counters.
pub fn checkpoint(run: &Path) -> (BTreeMap<String, Vec<u64>>, BTreeMap<String, i64>) {
    let (_, state) = output::read_checkpoint(&run.join("result.vtkhdf")).unwrap();
    let bits = |values: &[f64]| values.iter().copied().map(f64::to_bits).collect();
    (state.arrays.into_iter().map(|(name, values)| (name, bits(&values))).collect(), state.integers)
}

/// Fails unless two runs have ended with the same bits.
pub fn assert_same_bits(one: &Path, other: &Path, what: &str) {
    let ((arrays, integers), (other_arrays, other_integers)) = (checkpoint(one), checkpoint(other));
    assert!(arrays.contains_key("flow") || arrays.contains_key("displacement"));
    assert_eq!(arrays.keys().collect::<Vec<_>>(), other_arrays.keys().collect::<Vec<_>>(), "{what}");
    for (name, values) in &arrays {
        assert!(values == &other_arrays[name], "{what}: the bits of `{name}` differ");
    }
    assert_eq!(integers, other_integers, "{what}");
    let history = |run: &Path| std::fs::read(run.join("history.csv")).unwrap();
    assert!(history(one) == history(other), "{what}: history.csv differs");
}

/// Every file of a directory and of the folders in it, and its bytes.
pub fn contents(directory: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut contents = BTreeMap::new();
    for path in std::fs::read_dir(directory).unwrap().map(|entry| entry.unwrap().path()) {
        if path.is_dir() {
            contents.extend(self::contents(&path));
        } else {
            contents.insert(path.clone(), std::fs::read(&path).unwrap());
        }
    }
    contents
}
