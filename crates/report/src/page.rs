//! The page of a run: `page.html` with its data.

use super::chart::{Curve, rows_on_page};
use super::charts::{Chart, arranged};
use super::document::{Document, fill, missing};
use super::groups::{self, Group};
use super::html::{escaped, short};
use super::pictures::Pictures;
use super::run_files::{RunFiles, Status};
use super::{figures, panel, why};
use output::HistoryTable;
use serde_json::{Map, Value, json};

const TEMPLATE: &str = include_str!("page.html");

const SECTIONS: [(&str, &str); 4] =
    [("fields", "Fields"), ("curves", "Curves"), ("figures", "Figures"), ("case", "Case")];

/// The page of a run; `pictures`, or the reason why there are none.
pub fn page(run: &RunFiles, pictures: &Result<Pictures, String>) -> String {
    let (title, name) = (run.title(), run.case_name());
    let times: Vec<f64> = pictures.iter().flat_map(|shown| &shown.frames).map(|frame| frame.time).collect();
    let main = fill(TEMPLATE, |key| match key {
        "failure" => run.failure.as_ref().map_or_else(String::new, why::section),
        "pictures" => pictures.as_ref().map_or_else(|reason| missing("No pictures", reason), panel::html),
        "charts" => charts(run),
        "figures" => figures::tables(run),
        "figures_note" => figures_note(run).to_owned(),
        "case" => run.case_text().map_or_else(String::new, escaped),
        _ => String::new(),
    });
    Document {
        name,
        title: if title.is_empty() { name } else { &title },
        status: status(run),
        sections: &SECTIONS,
        main,
        creator: run.result.as_ref().map_or("", |reader| &reader.metadata.creator),
        data: json!({
            "name": run.directory, "history": [history(&run.history, &times)], "pictures": pictures.as_ref().ok().map(panel::data),
        }),
    }
    .html()
}

/// The progress of the run.
fn status(run: &RunFiles) -> String {
    let (class, word, text) = match &run.status {
        Status::Done => ("good", "completed", run.split_form_since().map_or_else(String::new, split_form)),
        Status::Running => ("busy", "running", "make the report again to see more".to_owned()),
        // The section on the failure says the same.
        Status::Stopped(_) if run.failure.is_some() => ("bad", "failed", String::new()),
        Status::Stopped(reason) => ("bad", "stopped", escaped(reason)),
        Status::Interrupted => {
            let remedy =
                if run.result.is_ok() { "continue it with --resume" } else { "no checkpoint either; run it again" };
            ("bad", "interrupted", format!("the run has left no summary; {remedy}"))
        }
    };
    let reached = run.history.column("t").and_then(|t| t.last().copied());
    let reached = reached.map_or("no slab is done yet".to_owned(), |t| format!("t = {}", short(t)));
    let slabs = match run.slabs() {
        1 => "1 slab".to_owned(),
        slabs => format!("{slabs} slabs"),
    };
    format!(
        "<p class=\"status\"><span class=\"badge {class}\">{word}</span> {reached}, {slabs} <span class=\"reason\">{text}\
         </span></p>"
    )
}

/// What a run says of a slab that could be solved in a split form only.
fn split_form(since: f64) -> String {
    format!(
        "a slab could not be solved, perhaps because the mesh does not resolve the flow: in a split form from t = {}",
        short(since)
    )
}

/// A chart of every group of columns.
fn charts(run: &RunFiles) -> String {
    let chart = |Group { title, series, scale, of_solver }: Group| {
        let curves =
            series.iter().filter_map(|(column, label)| Curve::of(&run.history, 0, column, label, scale)).collect();
        Chart { title, scale, of_solver, curves }
    };
    let groups = groups::groups(&run.history.columns, run.boundaries());
    arranged(&groups.into_iter().map(chart).collect::<Vec<_>>())
}

fn figures_note(run: &RunFiles) -> &'static str {
    match run.summary {
        Some(_) => "From summary.json. Point at a number to see all its digits.",
        None => "There is no summary of this run; these are sums and extremes of history.csv.",
    }
}

/// The rows on a page with pictures at these `times`, column by column.
pub fn history(history: &HistoryTable, times: &[f64]) -> Value {
    let rows = rows_on_page(history, times);
    let column = |name: &String| {
        let values = history.column(name).unwrap_or_default();
        (name.clone(), rows.iter().map(|&row| number(values[row])).collect::<Value>())
    };
    Value::Object(history.columns.iter().map(column).collect::<Map<_, _>>())
}

/// A number; integers without a fraction, as in the file.
fn number(value: f64) -> Value {
    if value.fract() == 0.0 && value.abs() < 1e15 { json!(value as i64) } else { json!(value) }
}
