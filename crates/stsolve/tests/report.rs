//! `stsolve report`: the page of a finished run, of a running one, and of the mesh alone.

#![allow(clippy::unwrap_used)]

mod common;

use common::{Outcome, column, finished, number, on_case, stsolve, summary};
use serde_json::Value;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

const SMALL: [&str; 3] = ["mesh.generate.box.cells=[3,3]", "time.step=0.1", "time.end=0.3"];

/// The page of the run in the folder `run`.
fn page(directory: &Path) -> String {
    let outcome = stsolve(directory, &["report", "run"]);
    outcome.expect(0, &[]);
    assert!(outcome.stdout.starts_with("run/report.html: "), "{}", outcome.stdout);
    fs::read_to_string(directory.join("run/report.html")).unwrap()
}

/// The data of the script in the page.
fn data(page: &str) -> Value {
    let data = page.split(r#"<script type="application/json" id="data">"#).nth(1).unwrap();
    serde_json::from_str(data.split("</script>").next().unwrap()).unwrap()
}

/// The pairs of dotted keys and values in nested tables.
fn flat(value: &Value, key: &str, out: &mut Vec<(String, Value)>) {
    match value.as_object() {
        Some(entries) => entries.iter().for_each(|(name, entry)| {
            flat(entry, format!("{key}.{name}").trim_start_matches('.'), out);
        }),
        None => out.push((key.to_owned(), value.clone())),
    }
}

/// The entry of a key in the tables: the text, and the title with all digits.
fn figure(page: &str, key: &str) -> (String, String) {
    let cell = page.split(&format!("<td data-key=\"{key}\" title=\"")).nth(1).unwrap_or_else(|| panic!("no `{key}`"));
    let (title, rest) = cell.split_once("\">").unwrap();
    (rest.split("</td>").next().unwrap().replace('\u{2212}', "-"), title.replace("&quot;", "\""))
}

fn run(directory: &TempDir, command: &str, case: &str, set: &[&str]) -> Outcome {
    on_case(directory.path(), command, case, set, "run", &[])
}

#[test]
fn every_number_is_that_of_the_summary_and_the_history() {
    let directory = TempDir::new().unwrap();
    run(&directory, "run", "vortex", &SMALL).expect(0, &[]);
    let (page, run) = (page(directory.path()), directory.path().join("run"));
    let mut figures = Vec::new();
    flat(&summary(&run), "", &mut figures);
    assert!(figures.len() > 25, "{figures:?}");
    for (key, value) in figures {
        let (text, title) = figure(&page, &key);
        assert_eq!(serde_json::from_str::<Value>(&title).unwrap(), value, "{key}");
        if let Some(value) = value.as_f64() {
            let shown: f64 = text.parse().unwrap();
            assert!((shown - value).abs() <= 1e-5 * value.abs(), "{key}: {text}, {value}");
        }
    }
    let history = &data(&page)["history"][0];
    for (name, values) in history.as_object().unwrap() {
        let values: Vec<f64> = values.as_array().unwrap().iter().map(|value| value.as_f64().unwrap()).collect();
        assert_eq!(values, column(&run, name), "{name}");
    }
    assert_eq!(history.as_object().unwrap().len(), 17);
}

#[test]
fn pictures_show_every_field_at_every_step() {
    let directory = TempDir::new().unwrap();
    run(&directory, "run", "vortex", &SMALL).expect(0, &[]);
    let page = page(directory.path());
    let pictures = &data(&page)["pictures"];
    assert_eq!(pictures["steps"], serde_json::json!([0, 1, 2, 3]));
    let times: Vec<f64> = pictures["times"].as_array().unwrap().iter().map(|time| time.as_f64().unwrap()).collect();
    assert_eq!(times[1..], column(&directory.path().join("run"), "t"));
    let labels: Vec<&str> =
        pictures["quantities"].as_array().unwrap().iter().map(|q| q["label"].as_str().unwrap()).collect();
    let expected =
        ["Mach number", "Vorticity", "Pressure", "Density", "Mesh: det J / det J\u{2080}", "Mesh: scaled Jacobian"];
    assert_eq!(labels, expected);
    let window = &pictures["windows"][0];
    for quantity in window["pictures"].as_array().unwrap() {
        assert_eq!(quantity.as_array().unwrap().len(), 4);
        assert!(quantity[0][0].as_str().unwrap().starts_with("data:image/png;base64,iVBOR"));
    }
    assert!(!page.contains("src=\"http") && !page.contains("href=\"http"), "the page loads something");
    // The same bits again, by one thread.
    let again = assert_cmd::Command::cargo_bin("stsolve")
        .unwrap()
        .env("RAYON_NUM_THREADS", "1")
        .current_dir(&directory)
        .args(["report", "run"])
        .output()
        .unwrap();
    assert!(again.status.success());
    assert!(fs::read_to_string(directory.path().join("run/report.html")).unwrap() == page);
}

#[test]
fn the_page_of_a_run_that_goes_on_shows_what_is_there() {
    let directory = TempDir::new().unwrap();
    run(&directory, "run", "vortex", &SMALL).expect(0, &[]);
    let folder = directory.path().join("run");
    let held = output::RunDirectory::open(&folder).unwrap();
    let going_on = page(directory.path());
    assert!(going_on.contains("busy\">running</span> t = 0.3, 3 slabs"));
    // The summary may belong to an earlier run, so sums come from the history.
    let newton: f64 = column(&folder, "newton").iter().sum();
    assert_eq!(figure(&going_on, "newton.total").1, newton.to_string());
    assert!(!going_on.contains("cost.wall_seconds"));
    assert_eq!(data(&going_on)["pictures"]["steps"].as_array().unwrap().len(), 4);

    // A new run has begun, but the result still belongs to the old one.
    let history = fs::read_to_string(folder.join("history.csv")).unwrap();
    let begun: String = history.lines().take(2).flat_map(|line| [line, "\n"]).collect();
    fs::write(folder.join("history.csv"), begun + "0.2,0.1").unwrap();
    let begun = page(directory.path());
    assert!(begun.contains("t = 0.1, 1 slab ") && begun.contains("is that of an earlier run"));
    fs::remove_file(folder.join("result.vtkhdf")).unwrap();
    assert!(page(directory.path()).contains("it appears with the first checkpoint"));
    drop(held);
    assert!(page(directory.path()).contains("bad\">interrupted</span>"));
}

#[test]
fn the_page_of_the_mesh_alone_has_no_flow() {
    let directory = TempDir::new().unwrap();
    let set = ["mesh.generate.box.cells=[3,3]", "constants.stretch=1.5", "time.step=0.5"];
    run(&directory, "motion", "vortex", &set).expect(1, &["the mesh is not valid"]);
    let page = page(directory.path());
    let quantities = data(&page)["pictures"]["quantities"].clone();
    let labels: Vec<&str> = quantities.as_array().unwrap().iter().map(|q| q["label"].as_str().unwrap()).collect();
    let expected = ["Mesh: det J / det J\u{2080}", "Mesh: scaled Jacobian", "Displacement, magnitude"];
    assert_eq!(labels, expected);
    // Without other curves those of the mesh are open.
    assert!(page.contains("<details open><summary>Solver and mesh</summary>"));
    assert!(page.contains("Quality of the mesh") && !page.contains("Residual of a slab"));
    let first = number(&summary(&directory.path().join("run")), "mesh_quality.first_invalid_time");
    assert_eq!(figure(&page, "mesh_quality.first_invalid_time").1, first.to_string());
}

#[test]
fn in_space_a_cut_is_shown_and_named() {
    let directory = TempDir::new().unwrap();
    finished(directory.path(), "free_stream_3d", &["time.end=0.1", "time.slabs=1"]);
    fs::rename(directory.path().join("free_stream_3d"), directory.path().join("run")).unwrap();
    let page = page(directory.path());
    assert!(page.contains("with the plane z = "));
    let pictures = &data(&page)["pictures"];
    assert_eq!(pictures["quantities"][1]["label"], "Vorticity, z");
    // The density of a free stream is uniform.
    let density = &pictures["windows"][0]["pictures"][3][1][1];
    assert_eq!(density[0], density[1], "{density}");
    // The option takes a name of the page, which this is.
    let cut = ["report", "run", "--picture", "mach", "--window", "cut x"];
    stsolve(directory.path(), &cut).expect(0, &[]);
    assert!(directory.path().join("run/mach_cut_x_last.png").exists());
}

/// The page of a failed run shows causes, remedies and the worst cell.
#[test]
fn the_page_of_a_failed_run_tells_why() {
    let directory = TempDir::new().unwrap();
    let set = [SMALL[0], "constants.stretch=1.5", "time.step=0.4", "time.end=4", "solver.slab_halvings=0"];
    run(&directory, "run", "vortex", &set).expect(1, &["likely cause: "]);
    let page = page(directory.path());
    let failed: Value =
        serde_json::from_str(&fs::read_to_string(directory.path().join("run/failure/failure.json")).unwrap()).unwrap();
    let plain = page.replace("<code>", "`").replace("</code>", "`");
    let plain = plain.replace("&lt;", "<").replace("&gt;", ">").replace("&quot;", "\"").replace("&amp;", "&");
    let causes = failed["causes"].as_array().unwrap();
    assert!(!causes.is_empty() && page.contains("id=\"failure\""));
    for text in
        causes.iter().flat_map(|cause| [&cause["what"], &cause["remedy"]]).chain([&failed["worst_cell"]["because"]])
    {
        // Sentences of the page begin with a capital.
        let (first, rest) = text.as_str().unwrap().split_at(1);
        assert!(plain.contains(&(first.to_uppercase() + rest)) || plain.contains(&format!("{first}{rest}")), "{text}");
    }
    assert!(page.contains("bad\">failed</span>"));
    assert!(page.contains("src=\"data:image/svg+xml;base64,"));
    // The same directory, with a run that does not fail.
    on_case(directory.path(), "run", "vortex", &SMALL, "run", &["--force"]).expect(0, &[]);
    assert!(!self::page(directory.path()).contains("id=\"failure\""));
}

/// The row of a steady start is no slab.
#[test]
fn a_steady_start_is_no_slab() {
    let directory = TempDir::new().unwrap();
    let case = directory.path().join("still.toml");
    let text = r#"
        mesh = { order = 2, generate.box = { lower = [0, 0], upper = [1, 1], cells = [2, 2] } }
        flow = { order = 2, exact.uniform = { velocity = [0.5, 0], pressure = 1 }, boundary.others = "exact" }
        time = { order = 1, end = 0.2, slabs = 2 }
        solver.steady = {}
    "#;
    fs::write(&case, text).unwrap();
    stsolve(directory.path(), &["run", "still.toml", "--output", "run", "--quiet"]).expect(0, &[]);
    assert_eq!(column(&directory.path().join("run"), "t").len(), 3);
    assert!(page(directory.path()).contains("t = 0.2, 2 slabs"));
}

/// A body that moves has a window that moves with it.
#[test]
fn a_window_follows_a_body() {
    let directory = TempDir::new().unwrap();
    let case = directory.path().join("disc.toml");
    let text = r#"
        mesh = { order = 3, generate.annulus = { inner_radius = 0.5, outer_radius = 5, first_cell = 0.1, cells = [12, 6] } }
        motion.boundary = { wall = { displacement = ["0.3*t^2", "0.1*t^2"] }, far = "fixed" }
        time = { order = 2, end = 1, slabs = 4 }
    "#;
    fs::write(&case, text).unwrap();
    let outcome = stsolve(directory.path(), &["motion", "disc.toml", "--output", "run", "--quiet"]);
    outcome.expect(0, &[]);
    let page = page(directory.path());
    let windows = &data(&page)["pictures"]["windows"];
    let labels: Vec<&str> = windows.as_array().unwrap().iter().map(|w| w["label"].as_str().unwrap()).collect();
    assert_eq!(labels, ["near the walls", "moving with the walls", "whole domain"]);
    let shifts = windows[1]["shifts"].as_array().unwrap();
    let last: Vec<f64> = shifts[4].as_array().unwrap().iter().map(|shift| shift.as_f64().unwrap()).collect();
    assert!((last[0] - 0.3).abs() < 1e-10 && (last[1] - 0.1).abs() < 1e-10, "{last:?}");
    assert!(windows[0]["shifts"].is_null() && windows[2]["shifts"].is_null());
}

/// The curves of several runs on one page.
#[test]
fn runs_are_laid_over_each_other() {
    let directory = TempDir::new().unwrap();
    for (name, order) in [("coarse", "flow.order=3"), ("fine", "flow.order=4")] {
        on_case(directory.path(), "run", "vortex", &[&SMALL[..], &[order]].concat(), name, &[]).expect(0, &[]);
    }
    let outcome = stsolve(directory.path(), &["report", "coarse", "fine"]);
    outcome.expect(0, &[]);
    assert!(outcome.stdout.starts_with("coarse/comparison.html: "), "{}", outcome.stdout);
    let page = fs::read_to_string(directory.path().join("coarse/comparison.html")).unwrap();
    for (run, name) in ["coarse", "fine"].iter().enumerate() {
        let history = &data(&page)["history"][run];
        let mass: Vec<f64> = history["mass"].as_array().unwrap().iter().map(|value| value.as_f64().unwrap()).collect();
        assert_eq!(mass, column(&directory.path().join(name), "mass"));
    }
    // A chart of each column but the time, with a curve for each run.
    let columns = data(&page)["history"][0].as_object().unwrap().len() - 1;
    assert!(page.matches("<figure class=\"chart\">").count() <= columns);
    assert_eq!(page.matches("data-column=\"mass\"").count(), 2);
    assert!(page.contains("<th scope=\"row\">flow.order</th><td>3</td><td>4</td>"));
    assert!(page.contains("<tr class=\"differs\"><th scope=\"row\">unknowns: flow</th>"));
    assert!(!page.contains("src=\"http") && !page.contains("href=\"http"), "the page loads something");
    let again = [&SMALL[..], &["flow.order=3"]].concat();
    on_case(directory.path(), "run", "vortex", &again, "coarse", &["--force"]).expect(0, &[]);
    assert!(!directory.path().join("coarse/comparison.html").exists(), "a comparison of the replaced run");
    stsolve(directory.path(), &["report", "coarse", "nowhere"]).expect(2, &["`nowhere` is not the directory of a run"]);
}

/// A defect that was: runs without a key had the value of the first run.
#[test]
fn keys_of_several_cases_are_those_of_each() {
    let directory = TempDir::new().unwrap();
    let at = directory.path();
    for (name, probe) in [("one", "{p={at=[1,1]}}"), ("two", "{p={at=[2,2]}}"), ("none", "{}")] {
        let probes = format!("output.probes={probe}");
        let set = [&SMALL[..], &[&probes]].concat();
        on_case(at, "run", "vortex", &set, name, &[]).expect(0, &[]);
    }
    stsolve(at, &["report", "one", "two", "none"]).expect(0, &[]);
    let page = fs::read_to_string(at.join("one/comparison.html")).unwrap();
    let values = "<td>[1.0, 1.0]</td><td>[2.0, 2.0]</td><td>not there</td>";
    assert!(page.contains(&format!("<th scope=\"row\">output.probes.p.at</th>{values}")), "{page}");
    assert!(!page.contains("<th scope=\"row\">output.probes</th>"));
}

#[test]
fn what_is_no_run_is_refused() {
    let directory = TempDir::new().unwrap();
    let outcome = stsolve(directory.path(), &["report", "."]);
    outcome.expect(2, &["`.` is not the directory of a run: it has no history.csv"]);
    assert_eq!(fs::read_dir(directory.path()).unwrap().count(), 0);
    stsolve(directory.path(), &["report", "nowhere"]).expect(2, &["`nowhere` is not the directory of a run"]);
}

/// Two walls along a channel: each has a window. A movie has a frame for every step.
#[test]
fn every_wall_has_a_window_and_a_movie_every_step() {
    let directory = TempDir::new().unwrap();
    let text = r#"
        mesh = { order = 2, generate.box = { lower = [0, 0], upper = [4, 1], cells = [4, 2] } }
        time = { order = 1, end = 0.2, slabs = 2 }
        output.formulas.twice_the_pressure = "2*pressure"
        [flow]
        order = 2
        initial.uniform = { velocity = [0.1, 0], pressure = 1 }
        boundary = { bottom = "slip_wall", top = "slip_wall", others = { outflow = { pressure = 1 } } }
    "#;
    fs::write(directory.path().join("channel.toml"), text).unwrap();
    let outcome = stsolve(directory.path(), &["run", "channel.toml", "--output", "run", "--quiet"]);
    outcome.expect(0, &[]);
    let page = page(directory.path());
    let windows = data(&page)["pictures"]["windows"].clone();
    let labels: Vec<&str> = windows.as_array().unwrap().iter().map(|w| w["label"].as_str().unwrap()).collect();
    assert_eq!(labels, ["whole domain", "near bottom", "near top"]);
    let outcome = stsolve(directory.path(), &["report", "run", "--movie", "mach", "--window", "near top"]);
    outcome.expect(0, &[]);
    assert!(outcome.stdout.starts_with("run/mach_near_top.png: ") && outcome.stdout.contains(" 3 frames, near top"));
    let movie = fs::read(directory.path().join("run/mach_near_top.png")).unwrap();
    // The chunk acTL: the number of frames, and for ever.
    let control = movie.windows(4).position(|name| name == b"acTL").unwrap() + 4;
    assert_eq!(movie[control..control + 8], [0, 0, 0, 3, 0, 0, 0, 0]);
    let outcome =
        stsolve(directory.path(), &["report", "run", "--picture", "mach", "--window", "0,0,1,1", "--range=-1,1"]);
    outcome.expect(0, &[]);
    assert!(outcome.stdout.starts_with("run/mach_0_0_1_1_last.png: ") && outcome.stdout.contains(" 1 frame, 0,0,1,1"));
    let picture = fs::read(directory.path().join("run/mach_0_0_1_1_last.png")).unwrap();
    assert!(picture.starts_with(b"\x89PNG") && !picture.windows(4).any(|name| name == b"acTL"));
    draws_every_field_of_the_flow(directory.path());
    stsolve(directory.path(), &["report", "run", "--picture", "--window", "0,0,1,1", "--range=-1,1"]).expect(0, &[]);
    assert_eq!(fs::read(directory.path().join("run/mach_0_0_1_1_last.png")).unwrap(), picture, "the first field");
    refuses_bad_pictures(directory.path());
}

/// The result file has these fields; pictures of them were refused.
fn draws_every_field_of_the_flow(directory: &Path) {
    for field in ["pressure_coefficient", "temperature", "total_temperature", "velocity", "twice_the_pressure"] {
        let outcome = stsolve(directory, &["report", "run", "--picture", field, "--window", "0,0,1,1"]);
        outcome.expect(0, &[]);
        let picture = fs::read(directory.join(format!("run/{field}_0_0_1_1_last.png"))).unwrap();
        assert!(picture.starts_with(b"\x89PNG"), "{field}");
    }
}

/// Fields, windows, ranges and options of pictures that make no sense.
fn refuses_bad_pictures(directory: &Path) {
    stsolve(directory, &["report", "run", "--movie", "much"])
        .expect(2, &["no pictures of `much`", "mach", "twice_the_pressure"]);
    let nowhere = ["report", "run", "--movie", "mach", "--window", "nowhere"];
    stsolve(directory, &nowhere).expect(2, &["no window `nowhere`", "near bottom"]);
    let range = ["report", "run", "--picture", "mach", "--range", "1,0"];
    stsolve(directory, &range).expect(2, &["`1,0` is no range of colours"]);
    let words = ["report", "run", "--picture", "mach", "--range", "1"];
    stsolve(directory, &words).expect(2, &["two numbers with a comma between them"]);
    stsolve(directory, &["report", "run", "--picture", "mach", "--movie", "mach"]).expect(2, &["cannot be used with"]);
    // A level of Q was ignored, and a negative one was taken for an option.
    for level in ["2.5", "-1"] {
        let plane = ["three dimensions", "is plane"];
        stsolve(directory, &["report", "run", "--q-level", level]).expect(2, &plane);
        stsolve(directory, &["report", "run", "--picture", "mach", "--q-level", level]).expect(2, &plane);
    }
    stsolve(directory, &["report", "run", "run", "--q-level", "1"]).expect(2, &["the page of one run"]);
    stsolve(directory, &["report", "run", "--no-edges"]).expect(2, &["--movie [<FIELD>]"]);
}

/// The planes of cuts span the positions of the mesh at all times. One that the mesh has left had a picture of another size, and the page lost all.
#[test]
fn cuts_that_the_mesh_has_left_are_empty() {
    let directory = TempDir::new().unwrap();
    let case = r#"
        mesh = { order = 2, generate.box = { lower = [0, 0, 0], upper = [1, 1, 1], cells = [1, 1, 1] } }
        motion.displacement = ["0.3*sin(2*pi*t)", 0, 0]
        time = { order = 1, end = 0.25, slabs = 1 }
    "#;
    fs::write(directory.path().join("case.toml"), case).unwrap();
    stsolve(directory.path(), &["run", "case.toml", "--output", "run", "--quiet"]).expect(0, &[]);
    let outcome = stsolve(directory.path(), &["report", "run"]);
    outcome.expect(0, &[]);
    assert!(!outcome.stdout.contains("no pictures"), "{}", outcome.stdout);
}
