//! Several runs on one page: their curves over each other, their figures and keys side by side.

use super::chart::Curve;
use super::charts::{Chart, arranged};
use super::document::{Document, fill};
use super::figures;
use super::groups::{self, Group};
use super::html::escaped;
use super::page::history;
use super::run_files::RunFiles;
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};

const TEMPLATE: &str = include_str!("comparison.html");

/// Sections of the summary that differ for the same run.
const OF_THE_MACHINE: [&str; 2] = ["machine", "cost"];

const SECTIONS: [(&str, &str); 3] = [("curves", "Curves"), ("figures", "Figures"), ("case", "Cases")];

/// The page of some `runs` with these names.
pub fn page(runs: &[RunFiles], names: &[String]) -> String {
    let main = fill(TEMPLATE, |key| match key {
        "charts" => charts(runs, names),
        "figures" => figures(runs, names),
        "keys" => keys(runs, names),
        _ => String::new(),
    });
    let history: Vec<Value> = runs.iter().map(|run| history(&run.history, &[])).collect();
    Document {
        name: &names.join(", "),
        title: &format!("{} runs compared", runs.len()),
        status: String::new(),
        sections: &SECTIONS,
        main,
        creator: runs.iter().find_map(|run| run.result.as_ref().ok()).map_or("", |reader| &reader.metadata.creator),
        data: json!({ "name": names.join("_"), "history": history, "pictures": null }),
    }
    .html()
}

/// A chart for each column that some run has, in the order of the page of a run.
fn charts(runs: &[RunFiles], names: &[String]) -> String {
    let mut columns: Vec<String> = Vec::new();
    for column in runs.iter().flat_map(|run| &run.history.columns) {
        if !columns.contains(column) {
            columns.push(column.clone());
        }
    }
    let boundaries: Vec<String> = runs.iter().flat_map(|run| run.boundaries()).cloned().collect();
    let of_group = |Group { title, series, scale, of_solver }: Group| {
        series.into_iter().map(move |(column, label)| {
            let curve = |(run, files): (usize, &RunFiles)| Curve::of(&files.history, run, &column, &names[run], scale);
            let curves = runs.iter().enumerate().filter_map(curve).collect();
            Chart { title: format!("{title}: {label}"), scale, of_solver, curves }
        })
    };
    arranged(&groups::groups(&columns, &boundaries).into_iter().flat_map(of_group).collect::<Vec<_>>())
}

/// A row for each figure that some run has; rows that differ are marked.
fn figures(runs: &[RunFiles], names: &[String]) -> String {
    let mut rows: BTreeMap<String, Vec<Option<Value>>> = BTreeMap::new();
    for (run, files) in runs.iter().enumerate() {
        let mut figures = Vec::new();
        let mut summary = files.summary.clone().unwrap_or_default();
        if let Value::Object(sections) = &mut summary {
            sections.retain(|name, _| !OF_THE_MACHINE.contains(&name.as_str()));
            figures::flatten("", &summary, &mut figures);
        }
        for (key, value) in figures {
            rows.entry(key).or_insert_with(|| vec![None; runs.len()])[run] = Some(value);
        }
    }
    let cell = |value: &Option<Value>| match value {
        Some(value) => format!("<td title=\"{}\">{}</td>", escaped(&value.to_string()), figures::shown(value)),
        None => "<td></td>".to_owned(),
    };
    let row = |(key, values): (&String, &Vec<Option<Value>>)| {
        let differs = values.windows(2).any(|pair| pair[0] != pair[1]);
        let class = if differs { " class=\"differs\"" } else { "" };
        let cells: String = values.iter().map(cell).collect();
        format!("<tr{class}><th scope=\"row\">{}</th>{cells}</tr>\n", escaped(&figures::words(key)))
    };
    table(names, rows.iter().map(row).collect())
}

/// The keys with values that differ between the cases. A run without a case has no values.
fn keys(runs: &[RunFiles], names: &[String]) -> String {
    let values = |run: &RunFiles| run.case_text().and_then(|text| case::values(text).ok());
    let cases: Vec<Option<BTreeMap<String, String>>> = runs.iter().map(values).collect();
    let keys: BTreeSet<&String> = cases.iter().flatten().flat_map(BTreeMap::keys).collect();
    let row = |key: &String| {
        let values: Vec<_> = cases.iter().flatten().map(|values| values.get(key)).collect();
        let cell = |of_run: &Option<BTreeMap<String, String>>| {
            let value = of_run.as_ref().map(|values| values.get(key).map_or("not there", String::as_str));
            format!("<td>{}</td>", escaped(&case::cut(value.unwrap_or("no case"))))
        };
        let cells = || cases.iter().map(cell).collect::<String>();
        let differ = values.windows(2).any(|pair| pair[0] != pair[1]);
        differ.then(|| format!("<tr><th scope=\"row\">{}</th>{}</tr>\n", escaped(key), cells()))
    };
    let rows: String = keys.into_iter().filter_map(row).collect();
    if rows.is_empty() { "<p>None.</p>\n".to_owned() } else { table(names, rows) }
}

fn table(names: &[String], rows: String) -> String {
    let heads: String = names.iter().map(|name| format!("<th scope=\"col\">{}</th>", escaped(name))).collect();
    format!("<table class=\"compared\"><thead><tr><td></td>{heads}</tr></thead><tbody>\n{rows}</tbody></table>\n")
}
