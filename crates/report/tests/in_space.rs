//! Pictures in space and movies of a result file with a known vortex, whose surface of Q is a cylinder.

#![allow(clippy::unwrap_used)]

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use output::{ArraySpec, FileLayout, Grid, History, Metadata, RestMesh, ResultFile, RunDirectory, SolverState, Step};
use report::Scenario;
use serde_json::Value;
use std::path::Path;

/// Cells per direction of the cube [-1/2, 1/2]^3, nodes per direction of the flow, steps.
const CELLS: usize = 2;
const ORDER: usize = 4;
const STEPS: usize = 3;

const CASE: &str = "[flow.gas]\ngamma = 1.4\n[flow.boundary]\nfloor = { adiabatic_wall = {} }\nside = \"slip_wall\"\nothers = \"exact\"\n";

/// Positions of the nodes of a cell, axis 0 fastest.
fn nodes(cell: usize, xi: &[f64]) -> Vec<[f64; 3]> {
    let n = xi.len();
    let at = |place: usize, digit: usize| (place as f64 + 0.5 * (1.0 + xi[digit])) / CELLS as f64 - 0.5;
    let place = [cell % CELLS, cell / CELLS % CELLS, cell / CELLS / CELLS];
    let node = |k: usize| {
        let digit = [k % n, k / n % n, k / n / n];
        std::array::from_fn(|i| at(place[i], digit[i]))
    };
    (0..n * n * n).map(node).collect()
}

/// `[component][node]` of all cells.
fn coefficients<const M: usize>(xi: &[f64], of: impl Fn([f64; 3]) -> [f64; M]) -> Vec<f64> {
    let cell = |cell: usize| {
        let values: Vec<[f64; M]> = nodes(cell, xi).into_iter().map(&of).collect();
        (0..M).flat_map(move |m| values.clone().into_iter().map(move |value| value[m])).collect::<Vec<f64>>()
    };
    (0..CELLS.pow(3)).flat_map(cell).collect()
}

/// Density 1, velocity speed (1 - r^2) (-y, x, 0), and much energy.
fn vortex(speed: f64) -> impl Fn([f64; 3]) -> [f64; 5] {
    move |[x, y, _]| {
        let v = speed * (1.0 - x * x - y * y);
        [1.0, -v * y, v * x, 0.0, 10.0]
    }
}

/// The facets at z = -1/2 and x = -1/2.
fn facets() -> Vec<[i64; 3]> {
    let of = |cell: usize| {
        let floor = (cell / CELLS / CELLS == 0).then_some([cell as i64, 4, 0]);
        let side = cell.is_multiple_of(CELLS).then_some([cell as i64, 0, 1]);
        floor.into_iter().chain(side)
    };
    (0..CELLS.pow(3)).flat_map(of).collect()
}

/// Writes the files of a run with a vortex of this speed.
fn run(directory: &Path, speed: f64) {
    let place = RunDirectory::open(directory).unwrap();
    let xi = basis::Lagrange::gauss_lobatto(ORDER).nodes().to_vec();
    let position = coefficients(&[-1.0, 1.0], |x| x);
    let cells = CELLS.pow(3);
    let layout = FileLayout {
        grid: Grid { dimension: 3, points_per_direction: 2, cells },
        fields: vec![],
        exact: vec![
            ArraySpec::new("flow", &[("cell", cells), ("time node", 1), ("component", 5), ("node", ORDER.pow(3))]),
            ArraySpec::new("position", &[("cell", cells), ("component", 3), ("node", 8)]),
        ],
    };
    let mesh = RestMesh {
        position: position.clone(),
        boundary_names: ["floor", "side"].map(str::to_owned).into(),
        boundary_facets: facets(),
    };
    let metadata = Metadata {
        creator: "test".into(),
        case_name: "vortex".into(),
        case_text: CASE.into(),
        case_fingerprint: "0".into(),
        mesh_id: "0".into(),
        space_nodes: xi.clone(),
        time_nodes: vec![1.0],
        mesh,
    };
    let mut result = ResultFile::create(&place, layout, &metadata).unwrap();
    let mut history = History::create(&place, &["t", "dt"].map(str::to_owned), &[]).unwrap();
    let flow = coefficients(&xi, vortex(speed));
    for step in 0..STEPS {
        let time = step as f64;
        let points = vec![0.0; 3 * 8 * cells];
        let exact: [(&str, &[f64]); 2] = [("flow", &flow), ("position", &position)];
        result.append(&Step { time, points: &points, fields: &[], exact: &exact }).unwrap();
        history.push(&[time, 1.0]).unwrap();
    }
    result.checkpoint(&SolverState::default()).unwrap();
}

/// The pictures in the data of the page.
fn pictures(directory: &Path, q_level: Option<f64>) -> Value {
    let page = report::write_at(directory, q_level).unwrap();
    assert_eq!(page.pictures, Ok(STEPS));
    let html = std::fs::read_to_string(page.path).unwrap();
    let data = html.split(r#"<script type="application/json" id="data">"#).nth(1).unwrap();
    let data: Value = serde_json::from_str(data.split("</script>").next().unwrap()).unwrap();
    data["pictures"].clone()
}

/// The window of a name.
fn window<'v>(pictures: &'v Value, label: &str) -> &'v Value {
    let windows = pictures["windows"].as_array().unwrap();
    windows.iter().find(|window| window["label"] == label).unwrap_or_else(|| panic!("no window `{label}`"))
}

/// The colour numbers of a picture.
fn numbers(uri: &str) -> Vec<u8> {
    let bytes = BASE64_STANDARD.decode(uri.strip_prefix("data:image/png;base64,").unwrap()).unwrap();
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut pixels).unwrap();
    pixels
}

/// The area that the pixels with some colour numbers cover in the last picture of the first field.
fn area(window: &Value, counts: impl Fn(u8) -> bool) -> f64 {
    let number = |key: &str, i: usize| window[key][i].as_f64().unwrap();
    let area: f64 = (0..2).map(|i| number("upper", i) - number("lower", i)).product();
    let pixels = numbers(window["pictures"][0][STEPS - 1][0].as_str().unwrap());
    area * pixels.iter().filter(|pixel| counts(**pixel)).count() as f64 / pixels.len() as f64
}

const WALL: u8 = 241;

/// With s = r^2, Q = 1 - 4 s + 3 s^2, and four fifths of its positive part in the cube lie above Q = 0.413. The level is one of the values on a
/// lattice of distance 1/8, of which there are few here.
#[test]
fn the_surface_of_q_is_a_cylinder_beside_its_walls() {
    let directory = tempfile::tempdir().unwrap();
    run(directory.path(), 1.0);
    let pictures = pictures(directory.path(), None);
    let from_above = window(&pictures, "vortices, along y");
    let note = from_above["note"].as_str().unwrap();
    let level = level_in(note);
    assert!((level - 0.413).abs() < 0.05, "{note}");
    is_the_diameter(from_above, level);
    // A camera that looks against z sees the floor, except behind the rim of the cylinder. Both walls look along y at their edges.
    let against_z = window(&pictures, "vortices, along z");
    let floor = area(against_z, |number| number == WALL);
    assert!(floor > 0.85 && floor <= 1.01, "{floor}");
    assert!(area(from_above, |number| number == WALL) < 0.01);
    // Obliquely one wall is seen from the flow, and the other one turns its back: cos 25 cos 40 of the floor, cos 25 sin 40 of the side,
    // less what the cylinder hides.
    for (label, most) in [("vortices, oblique", 0.694), ("vortices, from behind", 0.583)] {
        let seen = area(window(&pictures, label), |number| number == WALL);
        assert!(seen > 0.25 * most && seen < most + 0.01, "{label}: {seen}");
    }
}

/// The silhouette against y is the diameter at a level times the height 1.
fn is_the_diameter(from_above: &Value, level: f64) {
    let radius = ((2.0 - (1.0 + 3.0 * level).sqrt()) / 3.0).sqrt();
    let seen = area(from_above, |number| number > 0 && number < WALL);
    assert!((seen - 2.0 * radius).abs() < 0.02, "{seen} instead of {}", 2.0 * radius);
}

/// The level that a note tells.
fn level_in(note: &str) -> f64 {
    note.split("the surface Q = ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap()
}

#[test]
fn the_level_of_q_may_be_given() {
    let directory = tempfile::tempdir().unwrap();
    run(directory.path(), 1.0);
    let pictures = pictures(directory.path(), Some(0.7));
    let from_above = window(&pictures, "vortices, along y");
    assert_eq!(level_in(from_above["note"].as_str().unwrap()), 0.7);
    is_the_diameter(from_above, 0.7);
}

/// Gas at rest has no vortices, and so no pictures of them.
#[test]
fn without_vortices_there_is_no_surface() {
    let directory = tempfile::tempdir().unwrap();
    run(directory.path(), 1e-9);
    let pictures = pictures(directory.path(), None);
    let labels: Vec<&str> =
        pictures["windows"].as_array().unwrap().iter().map(|window| window["label"].as_str().unwrap()).collect();
    // The plane z = constant does not meet the floor.
    assert_eq!(labels, ["whole domain", "near side", "cut x", "cut y", "cut z"]);
}

/// The vorticity 2 - 4 (x^2 + y^2) has its extremes on the middle and on the edges of every cut.
#[test]
fn cuts_show_the_flow_at_their_positions() {
    let directory = tempfile::tempdir().unwrap();
    run(directory.path(), 1.0);
    let pictures = pictures(directory.path(), None);
    assert_eq!(pictures["quantities"][1]["label"], "Vorticity, z");
    for (axis, axes) in [("x", ["z", "y"]), ("y", ["x", "z"]), ("z", ["x", "y"])] {
        let cut = window(&pictures, &format!("cut {axis}"));
        assert_eq!((&cut["cut"]["axis"], &cut["axes"]), (&Value::from(axis), &serde_json::json!(axes)));
        let positions = cut["cut"]["positions"].as_array().unwrap();
        assert_eq!(positions.len(), 7);
        for (number, position) in positions.iter().enumerate() {
            let at = if axis == "z" { 0.0 } else { position.as_f64().unwrap() };
            let edges = if axis == "z" { 0.5 } else { at * at + 0.25 };
            let shown = |end: usize| -> f64 {
                cut["pictures"][1][number][1][end].as_str().unwrap().replace('\u{2212}', "-").parse().unwrap()
            };
            assert!((shown(1) - (2.0 - 4.0 * at * at)).abs() < 0.02, "{axis} = {position}: {}", shown(1));
            assert!((shown(0) - (2.0 - 4.0 * edges)).abs() < 0.05, "{axis} = {position}: {}", shown(0));
        }
    }
}

/// A movie has a frame for every step, plays for ever, and its fields include those that the page does not show.
#[test]
fn a_movie_has_a_frame_for_every_step() {
    let directory = tempfile::tempdir().unwrap();
    run(directory.path(), 1.0);
    for (field, window, name) in
        [("mach", None, "mach.png"), ("q_criterion", Some("vortices, along y"), "q_criterion_vortices_along_y.png")]
    {
        let movie = report::write_movie(directory.path(), &Scenario { field, window, ..Scenario::default() }).unwrap();
        assert_eq!((movie.frames, movie.path.file_name().unwrap().to_str()), (STEPS, Some(name)));
        let decoder = png::Decoder::new(std::io::BufReader::new(std::fs::File::open(movie.path).unwrap()));
        let mut reader = decoder.read_info().unwrap();
        let control = reader.info().animation_control.unwrap();
        assert_eq!((control.num_frames as usize, control.num_plays), (STEPS, 0));
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        for _ in 0..STEPS {
            reader.next_frame(&mut pixels).unwrap();
        }
        assert!(reader.next_frame(&mut pixels).is_err());
    }
    refuses_unknown_names(directory.path());
}

/// A picture shows the last step, at the width and in the part of the plane that are asked for.
#[test]
fn a_picture_shows_the_last_step() {
    let directory = tempfile::tempdir().unwrap();
    run(directory.path(), 1.0);
    let scenario = Scenario { field: "vorticity", window: Some("y=0.1"), width: Some(300), ..Scenario::default() };
    let picture = report::write_picture(directory.path(), &scenario).unwrap();
    let name = picture.path.file_name().unwrap().to_str();
    assert_eq!((picture.frames, name), (1, Some("vorticity_y=0.1_last.png")));
    let decoder = png::Decoder::new(std::io::BufReader::new(std::fs::File::open(picture.path).unwrap()));
    let reader = decoder.read_info().unwrap();
    assert!(reader.info().animation_control.is_none() && reader.info().width.abs_diff(300) < 3);
    let scenario = Scenario { range: Some([2.0, 0.0]), ..scenario };
    let refused = report::write_picture(directory.path(), &scenario).unwrap_err().to_string();
    assert!(refused.contains("`2,0` is no range of colours"), "{refused}");
}

/// Fields and windows that are not there are refused with the list of what there is.
fn refuses_unknown_names(directory: &Path) {
    let refused = |field, window| {
        let scenario = Scenario { field, window, ..Scenario::default() };
        report::write_movie(directory, &scenario).unwrap_err().to_string()
    };
    assert!(refused("much", None).contains("no pictures of `much`; accepted: mach, vorticity, pressure"));
    assert!(refused("mach", Some("elsewhere")).contains("no window `elsewhere`; accepted: whole domain, near side"));
}
