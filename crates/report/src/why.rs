//! Why a run failed: likely causes, remedies, the worst cell.

use super::html::{capitalised, escaped, short, with_code};
use super::run_files::FailedRun;
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use serde_json::Value;

/// The section of a run that failed.
pub fn section(failed: &FailedRun) -> String {
    let error = sentence(&failed.numbers["error"]);
    let causes: String = failed.numbers["causes"].as_array().into_iter().flatten().map(cause).collect();
    let causes = if causes.is_empty() { "<li>None is known for this kind of failure.</li>".to_owned() } else { causes };
    let picture = failed.cell.as_ref().map_or_else(String::new, |svg| worst_cell(&failed.numbers["worst_cell"], svg));
    format!(
        "<section id=\"failure\"><h2>Why it failed</h2>\n<p>{error}</p>\n<div class=\"why\"><ol>{causes}</ol>{picture}</div></section>\n"
    )
}

fn cause(cause: &Value) -> String {
    format!("<li>{}.<br><strong>Remedy:</strong> {}.</li>\n", sentence(&cause["what"]), sentence(&cause["remedy"]))
}

/// The picture of the worst cell, its place and its error.
fn worst_cell(cell: &Value, svg: &str) -> String {
    let centre = cell["centre"].as_array().into_iter().flatten().filter_map(Value::as_f64);
    let centre: Vec<String> = centre.map(short).collect();
    let caption =
        format!("The worst cell, {}, at ({}): {}", cell["cell"], centre.join(", "), escaped(plain(&cell["because"])));
    let uri = BASE64_STANDARD.encode(svg);
    format!(
        "<figure class=\"worst\"><img src=\"data:image/svg+xml;base64,{uri}\" alt=\"{caption}\"><figcaption>{caption}.</figcaption>\
         </figure>"
    )
}

fn plain(value: &Value) -> &str {
    value.as_str().unwrap_or_default()
}

/// A text as HTML that begins with a capital.
fn sentence(value: &Value) -> String {
    with_code(&capitalised(plain(value)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn causes_remedies_and_the_worst_cell_are_told() {
        let numbers = json!({
            "error": "p < 0",
            "causes": [{ "what": "the step is long", "remedy": "shorten `time.step`" }],
            "worst_cell": { "cell": 7, "centre": [0.5, 2.0], "because": "p is lowest there" },
        });
        let html = section(&FailedRun { numbers, cell: Some("<svg/>".to_owned()) });
        assert!(html.contains("<p>P &lt; 0</p>"));
        assert!(
            html.contains("<li>The step is long.<br><strong>Remedy:</strong> Shorten <code>time.step</code>.</li>")
        );
        assert!(html.contains("The worst cell, 7, at (0.5, 2): p is lowest there.</figcaption>"));
    }

    #[test]
    fn without_a_cause_there_is_a_sentence() {
        let html = section(&FailedRun { numbers: json!({ "error": "x" }), cell: None });
        assert!(html.contains("None is known for this kind of failure") && !html.contains("<figure"));
    }
}
