//! The figures of a run: every number of summary.json, or for an unfinished run those of its history.

use super::html::{capitalised, escaped, short};
use super::run_files::RunFiles;
use output::HistoryTable;
use serde_json::{Value, json};
use std::fmt::Write;

/// The titles of the sections of the summary, in their order on the page. Other sections come after these; keys outside any
/// section are `run`.
const SECTIONS: [(&str, &str); 15] = [
    ("run", "Run"),
    ("mesh", "Mesh"),
    ("unknowns", "Unknowns of a slab"),
    ("newton", "Newton steps"),
    ("krylov", "Krylov iterations"),
    ("mesh_quality", "Quality of the mesh, worst over the run"),
    ("steady", "Steady flow at the start"),
    ("structure", "Structure"),
    ("conservation", "Conservation"),
    ("error", "Distance to the exact solution"),
    ("walls", "Walls"),
    ("openings", "Inflows and outflows"),
    ("bodies", "Bodies"),
    ("machine", "Machine"),
    ("cost", "Cost"),
];

/// Tables of all figures.
pub fn tables(run: &RunFiles) -> String {
    let figures = run.summary.clone().unwrap_or_else(|| so_far(run.slabs(), &run.history));
    let mut sections: Vec<(String, Vec<(String, Value)>)> = Vec::new();
    for (key, value) in figures.as_object().into_iter().flatten() {
        let section = if value.is_object() { key.as_str() } else { "run" };
        let mut rows = Vec::new();
        flatten(if value.is_object() { "" } else { key }, value, &mut rows);
        match sections.iter_mut().find(|(name, _)| name == section) {
            Some((_, all)) => all.extend(rows),
            None => sections.push((section.to_owned(), rows)),
        }
    }
    let place = |section: &str| SECTIONS.iter().position(|(key, _)| *key == section).unwrap_or(SECTIONS.len());
    sections.sort_by_key(|(name, _)| place(name));
    sections.iter().map(|(name, rows)| table(name, rows)).collect()
}

/// The figures in the history of a run without a summary, after so many `slabs`. Totals are sums over slabs, as in the summary. The search for a
/// steady flow has a row without length, which they leave out.
fn so_far(slabs: usize, history: &HistoryTable) -> Value {
    let lengths = history.column("dt").unwrap_or_default();
    let last = |name: &str| history.column(name).and_then(|column| column.last().copied());
    let total =
        |column: Vec<f64>| column.iter().zip(&lengths).filter(|(_, dt)| **dt > 0.0).map(|(n, _)| n).sum::<f64>();
    let sum = |name: &str| history.column(name).map(|column| total(column) as u64);
    let least = |name: &str| history.column(name).map(|column| column.into_iter().fold(f64::INFINITY, f64::min));
    let mut figures = json!({
        "slabs": slabs, "time": last("t"),
        "newton": { "total": sum("newton") },
        "krylov": { "total": sum("krylov"), "elasticity_total": sum("elasticity_iterations") },
        "mesh_quality": {
            "det_j_lower_bound": least("det_j_lower_bound"), "det_j_sampled_min": least("det_j_sampled_min"),
            "scaled_jacobian_min": least("scaled_jacobian"),
        },
    });
    remove_absent(&mut figures);
    figures
}

/// Removes absent values, and sections that become empty.
fn remove_absent(value: &mut Value) {
    if let Value::Object(entries) = value {
        entries.values_mut().for_each(remove_absent);
        entries.retain(|_, entry| !entry.is_null() && entry.as_object().is_none_or(|section| !section.is_empty()));
    }
}

/// Nested tables as rows with dotted keys.
pub fn flatten(key: &str, value: &Value, rows: &mut Vec<(String, Value)>) {
    match value {
        Value::Object(entries) => {
            for (name, entry) in entries {
                let key = if key.is_empty() { name.clone() } else { format!("{key}.{name}") };
                flatten(&key, entry, rows);
            }
        }
        other => rows.push((key.to_owned(), other.clone())),
    }
}

fn table(section: &str, rows: &[(String, Value)]) -> String {
    let title = SECTIONS.iter().find(|(key, _)| *key == section).map(|(_, title)| (*title).to_owned());
    let title = title.unwrap_or_else(|| capitalised(&words(section)));
    let mut out = format!("<table><caption>{}</caption><tbody>\n", escaped(&title));
    for (key, value) in rows {
        let path = if section == "run" { key.clone() } else { format!("{section}.{key}") };
        let _ = writeln!(
            out,
            "<tr><th scope=\"row\">{}</th><td data-key=\"{}\" title=\"{}\">{}</td></tr>",
            escaped(&words(key)),
            escaped(&path),
            escaped(&value.to_string()),
            shown(value)
        );
    }
    out + "</tbody></table>\n"
}

/// A key in words.
pub fn words(key: &str) -> String {
    key.replace('_', " ").replace('.', ": ").replace("det j", "det J").replace("l2", "L2")
}

/// Integers in full, other numbers with six digits; the cell's title has all digits.
pub fn shown(value: &Value) -> String {
    match value {
        Value::Number(number) if number.is_f64() => short(number.as_f64().unwrap_or(f64::NAN)),
        Value::Array(entries) => entries.iter().map(shown).collect::<Vec<_>>().join(", "),
        Value::String(text) => escaped(text),
        Value::Bool(yes) => if *yes { "yes" } else { "no" }.into(),
        Value::Null => "\u{2013}".into(),
        other => other.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// It counted as a slab, with its Newton steps.
    #[test]
    fn the_search_for_a_steady_flow_is_no_slab() {
        let columns = ["t", "dt", "newton", "krylov"].map(str::to_owned).to_vec();
        let rows = vec![0.0, 0.0, 9.0, 90.0, 0.5, 0.5, 2.0, 20.0, 1.0, 0.5, 3.0, 30.0];
        let figures = so_far(2, &HistoryTable { columns, rows });
        assert_eq!(figures["newton"]["total"], 5);
        assert_eq!(figures["krylov"]["total"], 50);
        assert_eq!((&figures["slabs"], &figures["time"]), (&json!(2), &json!(1.0)));
    }

    #[test]
    fn a_section_without_a_title_has_its_name() {
        let rows = [("l2".to_owned(), Value::Null), ("l2_max".to_owned(), json!(0.5))];
        let table = table("far_field", &rows);
        assert!(table.contains("<caption>Far field</caption>"), "{table}");
        assert!(table.contains("data-key=\"far_field.l2\" title=\"null\">\u{2013}</td>"), "{table}");
    }
}
