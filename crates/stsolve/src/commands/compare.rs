//! `stsolve compare`

use super::print;
use super::table::{Table, apart};
use case::Difference;
use output::{HISTORY_FILE, HistoryTable, OutputError, RESULT_FILE, ResultReader, SUMMARY_FILE};
use serde_json::{Map, Value, json};
use simulation::Failure;
use std::path::{Path, PathBuf};

/// Figures of two runs that are at most this far apart, relative to the larger, count as the same.
const SAME: f64 = 1e-12;

/// Figures and curves that are below this size in both runs are round-off.
const ROUND_OFF: f64 = 1e-13;

/// Parts of summary.json that describe the machine, not the case.
const OF_THE_MACHINE: [&str; 3] = ["cost", "machine", "version"];

/// Prints what differs between the runs in the directories `first` and `second`: keys of the cases, figures of summary.json, and curves of
/// history.csv over the time that both have.
///
/// # Errors
/// A directory without a result, or with a damaged one.
pub fn compare(first: &Path, second: &Path, json: bool) -> Result<(), Failure> {
    let runs = [Run::read(first)?, Run::read(second)?];
    let (keys, figures, curves, alone) = (keys(&runs)?, figures(&runs), curves(&runs), alone(&runs));
    if json {
        let key = |d: &Difference| (d.key.clone(), json!([d.before, d.now]));
        let keys: Map<String, Value> = keys.iter().map(key).collect();
        let page =
            json!({ "keys": keys, "figures": named(&figures), "curves": named(&curves), "alone": places(&alone) });
        return print(&serde_json::to_string_pretty(&page).map_err(Failure::bad_input)?);
    }
    let mut tables = vec![Table::new("keys that differ")];
    for difference in &keys {
        let [before, now] = difference.shortened();
        tables[0].row(&difference.key, before, format!("and {now}"));
    }
    tables.push(table("figures that differ", &figures, |[a, b]| (b - a).abs() / a.abs().max(b.abs())));
    tables.push(table(
        "curves that differ: the largest difference, as a fraction of the first curve's largest value (-: only one run has a number there), and its time",
        &curves,
        |[largest, _]| *largest,
    ));
    let mut of_one = Table::new("figures and curves that only one run has");
    for (name, run) in &alone {
        of_one.row(name, format!("in {}", run.display()), "");
    }
    tables.push(of_one);
    let texts: Vec<_> = tables.iter().filter(|table| !table.is_empty()).map(Table::text).collect();
    print(&if texts.is_empty() { "no difference".to_owned() } else { texts.join("\n") })
}

/// A run as it lies on disk.
struct Run {
    directory: PathBuf,
    case: String,
    /// The numbers of summary.json by their paths; none as long as the run has not finished.
    summary: Vec<(String, f64)>,
    history: HistoryTable,
}

impl Run {
    fn read(directory: &Path) -> Result<Self, Failure> {
        if !directory.is_dir() {
            return Err(OutputError::NoDirectory { path: directory.to_owned() }.into());
        }
        let case = ResultReader::open(&directory.join(RESULT_FILE))?.metadata.case_text;
        let summary = std::fs::read_to_string(directory.join(SUMMARY_FILE)).unwrap_or_default();
        let mut numbers = Vec::new();
        collect("", &serde_json::from_str(&summary).unwrap_or_default(), &mut numbers);
        Ok(Run { directory: directory.to_owned(), case, summary: numbers, history: HistoryTable::read(directory)? })
    }
}

impl Run {
    fn has_figure(&self, name: &str) -> bool {
        self.summary.iter().any(|(other, _)| other == name)
    }
}

/// The numbers in `value` by their paths; true is 1 and false 0.
fn collect(path: &str, value: &Value, numbers: &mut Vec<(String, f64)>) {
    let below = |name: &str| if path.is_empty() { name.to_owned() } else { format!("{path}.{name}") };
    match value {
        // Whether a run is completed, for instance.
        Value::Bool(is_true) => numbers.push((path.to_owned(), f64::from(u8::from(*is_true)))),
        Value::Number(number) => numbers.push((path.to_owned(), number.as_f64().unwrap_or(f64::NAN))),
        Value::Array(entries) => {
            entries.iter().enumerate().for_each(|(i, entry)| collect(&format!("{path}[{i}]"), entry, numbers));
        }
        Value::Object(entries) => entries
            .iter()
            .filter(|(name, _)| !path.is_empty() || !OF_THE_MACHINE.contains(&name.as_str()))
            .for_each(|(name, entry)| collect(&below(name), entry, numbers)),
        _ => {}
    }
}

fn keys([first, second]: &[Run; 2]) -> Result<Vec<Difference>, Failure> {
    let differences = case::differences(&first.case, &second.case);
    let explained = |error| anyhow::anyhow!("a result holds the case of another version of the program: {error}");
    differences.map(|differences| differences.all).map_err(|error| Failure::bad_input(explained(error)))
}

/// A figure or curve by its name, with two numbers about it.
type Named = (String, [f64; 2]);

/// The figures that both runs have, with different values.
fn figures([first, second]: &[Run; 2]) -> Vec<Named> {
    let other = |name: &str| second.summary.iter().find(|(other, _)| other == name).map(|(_, value)| *value);
    let pair = |(name, value): &(String, f64)| Some((name.clone(), [*value, other(name)?]));
    first.summary.iter().filter_map(pair).filter(|(_, [a, b])| differ(*a, *b)).collect()
}

/// The figures and columns that only one run has, and the directory of that run. A missing summary counts as one figure.
fn alone([first, second]: &[Run; 2]) -> Vec<(String, &Path)> {
    let missing = |run: &Run, other: &Run| -> Vec<String> {
        let figures: Vec<String> = match other.summary.is_empty() {
            true => run.summary.first().map(|_| SUMMARY_FILE.to_owned()).into_iter().collect(),
            false => run.summary.iter().map(|(name, _)| name.clone()).filter(|name| !other.has_figure(name)).collect(),
        };
        let columns = run.history.columns.iter().filter(|name| !other.history.columns.contains(name));
        figures.into_iter().chain(columns.map(|name| format!("{HISTORY_FILE}: {name}"))).collect()
    };
    let named = |names: Vec<String>, run| names.into_iter().map(move |name| (name, run));
    let ones = named(missing(first, second), first.directory.as_path());
    ones.chain(named(missing(second, first), second.directory.as_path())).collect()
}

/// The columns that both histories have: the largest difference, relative to the largest value of the first, and its time. The second curve is
/// taken at the times of the first, joined by straight lines. Where only one run has a number the difference is NaN, larger than any number.
fn curves([first, second]: &[Run; 2]) -> Vec<Named> {
    let (Some(times), Some(others)) = (first.history.column("t"), second.history.column("t")) else {
        return Vec::new();
    };
    let difference = |name: &String| {
        let (one, other) = (first.history.column(name)?, second.history.column(name)?);
        let largest = one.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
        let apart = |(t, value): (&f64, &f64)| Some([distance(*value, at(&others, &other, *t)?), *t]);
        // Among equal differences the first.
        let worst = times.iter().zip(&one).filter_map(apart).rev().max_by(|a, b| a[0].total_cmp(&b[0]))?;
        let relative = if largest > 0.0 { worst[0] / largest } else { worst[0] };
        let is_same = largest.max(worst[0]) <= ROUND_OFF || relative <= SAME;
        (worst[0].is_nan() || !is_same).then(|| (name.clone(), [relative, worst[1]]))
    };
    first.history.columns.iter().filter(|name| *name != "t").filter_map(difference).collect()
}

/// The distance of two values, zero if neither is a number.
fn distance(a: f64, b: f64) -> f64 {
    if a == b || (a.is_nan() && b.is_nan()) { 0.0 } else { (a - b).abs() }
}

/// The curve through (`times`, `values`) at `t`; None beyond its ends.
fn at(times: &[f64], values: &[f64], t: f64) -> Option<f64> {
    let after = times.partition_point(|time| *time < t);
    let (right, end) = (values.get(after)?, times[after]);
    if end == t {
        return Some(*right);
    }
    let (left, start) = (values[after.checked_sub(1)?], times[after - 1]);
    Some(left + (right - left) * (t - start) / (end - start))
}

fn differ(a: f64, b: f64) -> bool {
    let size = a.abs().max(b.abs());
    size > ROUND_OFF && (a - b).abs() > SAME * size
}

fn places(rows: &[(String, &Path)]) -> Map<String, Value> {
    rows.iter().map(|(name, run)| (name.clone(), json!(run))).collect()
}

fn named(rows: &[Named]) -> Map<String, Value> {
    rows.iter().map(|(name, values)| (name.clone(), json!(values))).collect()
}

/// Rows of two numbers each, the largest `measure` first.
fn table(title: &str, rows: &[Named], measure: impl Fn(&[f64; 2]) -> f64) -> Table {
    let (mut table, mut rows) = (Table::new(title), rows.to_vec());
    rows.sort_by(|a, b| measure(&b.1).total_cmp(&measure(&a.1)));
    for (name, values) in rows {
        table.row(&name, apart(values).join(", "), "");
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_are_joined_by_straight_lines_and_end_at_their_ends() {
        let (times, values) = ([0.0, 1.0, 3.0], [2.0, 4.0, 8.0]);
        assert_eq!([0.0, 0.5, 1.0, 2.0, 3.0].map(|t| at(&times, &values, t)), [2.0, 3.0, 4.0, 6.0, 8.0].map(Some));
        assert_eq!([-0.1, 3.1].map(|t| at(&times, &values, t)), [None, None]);
    }

    /// A run with the row (t, value) for each of `values`, at the times 0, 1, ...
    fn run(values: &[f64]) -> Run {
        let rows = values.iter().enumerate().flat_map(|(t, value)| [t as f64, *value]).collect();
        let history = HistoryTable { columns: vec!["t".to_owned(), "loss".to_owned()], rows };
        Run { directory: PathBuf::new(), case: String::new(), summary: Vec::new(), history }
    }

    /// A column with a NaN was left out.
    #[test]
    fn a_value_that_is_no_number_differs_from_every_number() {
        const NONE: f64 = f64::NAN;
        let compared = |a: &[f64], b: &[f64]| curves(&[run(a), run(b)]);
        assert!(compared(&[NONE, 1.0, 2.0], &[NONE, 1.0, 2.0]).is_empty() && compared(&[NONE], &[NONE]).is_empty());
        assert_eq!(compared(&[NONE, 1.0, 2.0], &[NONE, 1.0, 3.0])[0].1, [0.5, 2.0]);
        assert!(compared(&[f64::INFINITY, 1.0], &[f64::INFINITY, 1.0]).is_empty(), "infinite in both");
        for (a, b) in
            [([1.0, NONE, NONE], [1.0, 1.0, 1.0]), ([0.0, 5.0, 0.0], [0.0, NONE, NONE]), ([NONE; 3], [NONE, 0.0, 0.0])]
        {
            let found = compared(&a, &b);
            assert!(found[0].1[0].is_nan() && found[0].1[1] == 1.0, "{a:?} {b:?}: {found:?}");
        }
    }

    #[test]
    fn numbers_have_paths_and_those_of_the_machine_are_left_out() {
        let summary = json!({ "walls": { "a": { "impulse": [1.0, 2.0] } }, "cost": { "seconds": 3 }, "case": "x" });
        let mut numbers = Vec::new();
        collect("", &summary, &mut numbers);
        assert_eq!(numbers, [("walls.a.impulse[0]".to_owned(), 1.0), ("walls.a.impulse[1]".to_owned(), 2.0)]);
    }
}
