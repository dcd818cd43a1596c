//! Lines, slices, fields and formulas of them, against exact values.
#![allow(clippy::unwrap_used)]

mod common;

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use common::{column, finished, number, on_text, shipped, stsolve};
use std::fs;
use std::path::Path;
use tempfile::TempDir;

/// The columns of a CSV file.
struct Table {
    names: Vec<String>,
    rows: Vec<Vec<f64>>,
}

impl Table {
    fn read(path: &Path) -> Self {
        let text = fs::read_to_string(path).unwrap();
        let mut lines = text.lines();
        let names = lines.next().unwrap().split(',').map(str::to_owned).collect();
        let rows = lines.map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect()).collect();
        Table { names, rows }
    }

    fn column(&self, name: &str) -> Vec<f64> {
        let position = self.names.iter().position(|other| other == name).unwrap_or_else(|| panic!("no column {name}"));
        self.rows.iter().map(|row| row[position]).collect()
    }
}

/// An array of a file of poly data.
fn array<const BYTES: usize, T>(text: &str, name: &str, number: fn([u8; BYTES]) -> T) -> Vec<T> {
    let encoded = text.split(&format!("Name=\"{name}\"")).nth(1).unwrap().split(['>', '<']).nth(1).unwrap();
    let bytes = BASE64_STANDARD.decode(encoded).unwrap();
    assert_eq!(u64::from_le_bytes(bytes[..8].try_into().unwrap()) as usize, bytes.len() - 8);
    bytes[8..].chunks_exact(BYTES).map(|chunk| number(chunk.try_into().unwrap())).collect()
}

fn floats(text: &str, name: &str) -> Vec<[f64; 3]> {
    array(text, name, f64::from_le_bytes).as_chunks().0.to_vec()
}

/// The area of all polygons, fans of triangles.
fn area(text: &str) -> f64 {
    let (points, connectivity) = (floats(text, "Points"), array(text, "connectivity", i64::from_le_bytes));
    let ends = array(text, "offsets", i64::from_le_bytes);
    let starts = [0].into_iter().chain(ends.iter().copied());
    let triangle = |[a, b, c]: [[f64; 3]; 3]| {
        let [u, v]: [[f64; 3]; 2] = [b, c].map(|end| std::array::from_fn(|i| end[i] - a[i]));
        0.5 * tensor::norm(&std::array::from_fn::<f64, 3, _>(|i| {
            u[(i + 1) % 3] * v[(i + 2) % 3] - u[(i + 2) % 3] * v[(i + 1) % 3]
        }))
    };
    let of_polygon = |(start, end): (i64, &i64)| -> f64 {
        let corners: Vec<[f64; 3]> =
            connectivity[start as usize..*end as usize].iter().map(|p| points[*p as usize]).collect();
        (2..corners.len()).map(|k| triangle([corners[0], corners[k - 1], corners[k]])).sum()
    };
    starts.zip(&ends).map(of_polygon).sum()
}

fn largest<'a>(values: impl IntoIterator<Item = &'a f64>, exact: impl Fn(usize) -> f64) -> f64 {
    values.into_iter().enumerate().map(|(i, value)| (value - exact(i)).abs()).fold(0.0, f64::max)
}

/// A state whose conserved variables are polynomials of degree 3: a flow of order 4 holds it exactly.
const POLYNOMIAL: &str = r#"
    mesh = { order = 2, generate.box = { lower = [0, 0, 0], upper = [1, 2, 1], cells = [2, 3, 2] } }
    time = { order = 1, end = 1e-4, slabs = 2 }
    constants.mach = 7
    [output]
    formulas.total = "pressure/0.4 + density*(velocity_x^2 + velocity_y^2 + velocity_z^2)/2 + mach - mach + x + t"
    lines.diagonal = { from = [0.01, 0.1, 0.2], to = [0.97, 1.8, 0.9], points = 7, fields = [
        "density", "velocity", "temperature", "mach", "pressure_coefficient", "total_pressure", "total_temperature", "entropy",
        "q_criterion", "vorticity", "jacobian", "mesh_velocity", "displacement"] }
    probes.there = { at = [0.3, 0.4, 0.5], fields = ["vorticity", "total_temperature"] }
    slices.oblique = { point = [0.5, 1, 0.5], normal = [1, 2, 3], fields = ["velocity", "pressure"], every = 2, csv = true }
    slices.between_cells = { point = [0.5, 1, 0.5], normal = [1, 0, 0], parts = 1 }
    slices.boundary = { point = [0, 0, 1], normal = [0, 0, 1] }
    slices.outside = { point = [0, 0, 1.5], normal = [0, 0, 1] }
    [flow]
    order = 4
    gas.gas_constant = 0.5
    initial.expression = { density = "1 + x/10", velocity = ["y", "x + z", "z/2"], pressure = "2 + y/5" }
    reference = { density = 2, speed = 3, pressure = 1.5 }
    boundary.others = { prescribed_state.expression = { density = "1 + x/10", velocity = ["y", "x + z", "z/2"], pressure = "2 + y/5" } }
"#;

fn polynomial(directory: &Path) -> std::path::PathBuf {
    let case = directory.join("polynomial.toml");
    fs::write(&case, POLYNOMIAL).unwrap();
    stsolve(directory, &["run", case.to_str().unwrap(), "--output", "run", "--quiet"]).expect(0, &[]);
    directory.join("run")
}

#[test]
fn fields_of_a_polynomial_state_are_exact_along_a_line() {
    let directory = TempDir::new().unwrap();
    let run = polynomial(directory.path());
    let line = Table::read(&run.join("line_diagonal.csv"));
    assert_eq!(line.rows.len(), 21, "at the start and after two slabs");
    let start = Table { names: line.names.clone(), rows: line.rows[..7].to_vec() };
    let [x, y, z] = ["x", "y", "z"].map(|name| start.column(name));
    let length = (0.96_f64.powi(2) + 1.7_f64.powi(2) + 0.7_f64.powi(2)).sqrt();
    assert!(largest(&start.column("s"), |i| length * i as f64 / 6.0) < 1e-14);
    let (rho, p) = (|i: usize| 1.0 + x[i] / 10.0, |i: usize| 2.0 + y[i] / 5.0);
    let v2 = |i: usize| y[i].powi(2) + (x[i] + z[i]).powi(2) + z[i].powi(2) / 4.0;
    let m2 = |i: usize| v2(i) * rho(i) / (1.4 * p(i));
    let temperature = |i: usize| p(i) / (0.5 * rho(i));
    let total = |i: usize| 1.0 + 0.2 * m2(i);
    let exact: [(&str, &dyn Fn(usize) -> f64); 17] = [
        ("density", &rho),
        ("velocity_y", &|i| x[i] + z[i]),
        ("temperature", &temperature),
        ("mach", &|i| m2(i).sqrt()),
        ("pressure_coefficient", &|i| (p(i) - 1.5) / 9.0),
        ("total_pressure", &|i| p(i) * total(i).powf(3.5)),
        ("total_temperature", &|i| temperature(i) * total(i)),
        ("entropy", &|i| p(i).ln() - 1.4 * rho(i).ln()),
        // grad v: d_x v_y = d_y v_x = 1, d_z v_y = 1, d_z v_z = 1/2.
        ("q_criterion", &|_| -0.5 * (2.0 + 0.25)),
        ("vorticity_x", &|_| -1.0),
        ("vorticity_y", &|_| 0.0),
        ("vorticity_z", &|_| 0.0),
        ("jacobian", &|_| 1.0),
        ("mesh_velocity_z", &|_| 0.0),
        ("displacement_x", &|_| 0.0),
        ("total", &|i| p(i) / 0.4 + 0.5 * rho(i) * v2(i) + x[i]),
        ("t", &|_| 0.0),
    ];
    for (name, exact) in exact {
        let error = largest(&start.column(name), exact);
        assert!(error < 1e-12, "{name}: {error:e}");
    }
    // The points of history.csv take the same fields. Two slabs of 5e-5 change them little.
    assert!((column(&run, "there_vorticity_x")[1] + 1.0).abs() < 0.01);
    assert!(column(&run, "there_total").len() == 2 && column(&run, "there_total_temperature")[0] > 4.0);
}

#[test]
fn slices_lie_in_their_planes_and_hold_the_values_of_the_flow() {
    let directory = TempDir::new().unwrap();
    let run = polynomial(directory.path());
    let read =
        |name: &str, slab: usize| fs::read_to_string(run.join(format!("slice_{name}/slab_{slab:06}.vtp"))).unwrap();
    let oblique = read("oblique", 0);
    let (points, velocity, pressure) =
        (floats(&oblique, "Points"), floats(&oblique, "velocity"), array(&oblique, "pressure", f64::from_le_bytes));
    assert!(points.len() > 100 && velocity.len() == points.len());
    for ([x, y, z], (v, p)) in points.iter().zip(velocity.iter().zip(&pressure)) {
        assert!((x + 2.0 * y + 3.0 * z - 4.0).abs() < 1e-14, "{x} {y} {z}");
        assert!((v[0] - y).abs() + (v[1] - x - z).abs() + (v[2] - z / 2.0).abs() + (p - 2.0 - y / 5.0).abs() < 1e-12);
    }
    // A section of 1.5 in x and y, inclined.
    assert!((area(&oblique) - 1.5 * 14_f64.sqrt() / 3.0).abs() < 1e-12, "{}", area(&oblique));
    assert!((area(&read("between_cells", 0)) - 2.0).abs() < 1e-12, "each facet once");
    assert!((area(&read("boundary", 1)) - 2.0).abs() < 1e-12);
    assert_eq!(floats(&read("outside", 0), "Points").len(), 0);
    let series = fs::read_to_string(run.join("slice_oblique.pvd")).unwrap();
    assert_eq!(series.matches("<DataSet ").count(), 2, "every second slab: {series}");
    assert!(series.contains("timestep=\"0.0001\"") && series.contains("slice_oblique/slab_000002.vtp"));
    assert!(!run.join("slice_oblique/slab_000001.vtp").exists());
    let table = Table::read(&run.join("slice_oblique/slab_000000.csv"));
    assert!(table.column("pressure") == pressure && table.column("velocity_y").len() == points.len());
    assert!(table.column("z").iter().zip(&points).all(|(z, point)| *z == point[2]));
    assert!(!run.join("slice_boundary/slab_000000.csv").exists(), "on request only");
}

/// Three cubes: one on the other, and a third beside the upper one.
const STEP: &str = r#"$MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
2
2 1 "wall"
3 2 "gas"
$EndPhysicalNames
$Nodes
18
1 0 0 0
2 1 0 0
3 2 0 0
4 0 1 0
5 1 1 0
6 2 1 0
7 0 0 1
8 1 0 1
9 2 0 1
10 0 1 1
11 1 1 1
12 2 1 1
13 0 0 2
14 1 0 2
15 2 0 2
16 0 1 2
17 1 1 2
18 2 1 2
$EndNodes
$Elements
17
1 3 2 1 1 1 2 5 4
2 3 2 1 1 1 2 8 7
3 3 2 1 1 2 5 11 8
4 3 2 1 1 5 4 10 11
5 3 2 1 1 4 1 7 10
6 3 2 1 1 13 14 17 16
7 3 2 1 1 7 8 14 13
8 3 2 1 1 11 10 16 17
9 3 2 1 1 10 7 13 16
10 3 2 1 1 8 9 12 11
11 3 2 1 1 14 15 18 17
12 3 2 1 1 8 9 15 14
13 3 2 1 1 9 12 18 15
14 3 2 1 1 12 11 17 18
15 5 2 2 2 1 2 5 4 7 8 11 10
16 5 2 2 2 7 8 11 10 13 14 17 16
17 5 2 2 2 8 9 12 11 14 15 18 17
$EndElements
"#;

/// A plane that lies on a step has both sides of it. The part that touches it from above was missing.
#[test]
fn a_slice_on_a_step_is_whole() {
    let directory = TempDir::new().unwrap();
    let slice = |name: &str, at: f64, z: f64| {
        format!("[output.slices.{name}]\npoint=[0,0,{at}]\nnormal=[0,0,{z}]\nfields=[\"pressure\"]\n")
    };
    let case = format!(
        "[mesh]\nfile=\"step.msh\"\norder=2\n[flow]\norder=2\ngas={{gamma=1.4,mach=0.3}}\nreference={{density=1,speed=1,pressure=8}}\n\
         initial={{uniform={{density=1,velocity=[0,0,0],pressure=8}}}}\n[flow.boundary]\nwall=\"slip_wall\"\n\
         [time]\norder=1\nend=0.1\nslabs=1\n{}{}{}",
        slice("up", 1.0, 1.0),
        slice("down", 1.0, -1.0),
        slice("floor", 0.0, 1.0)
    );
    fs::write(directory.path().join("step.msh"), STEP).unwrap();
    fs::write(directory.path().join("step.toml"), case).unwrap();
    stsolve(directory.path(), &["run", "step.toml", "--output", "run"]).expect(0, &[]);
    for (name, expected) in [("up", 2.0), ("down", 2.0), ("floor", 1.0)] {
        let text = fs::read_to_string(directory.path().join(format!("run/slice_{name}/slab_000001.vtp"))).unwrap();
        assert!((area(&text) - expected).abs() < 1e-12, "{name}: {}", area(&text));
    }
}

/// The slice at the lower of two periodic sides was empty for one direction of the normal, and that at the upper one for the other.
#[test]
fn slices_on_periodic_planes_are_whole() {
    let directory = TempDir::new().unwrap();
    let planes = [("a", 0.0, 1), ("b", 0.0, -1), ("c", 2.0, 1), ("d", 2.0, -1)];
    let slice = |(name, z, normal): (&str, f64, i32)| {
        format!("[output.slices.{name}]\npoint=[0,0,{z:?}]\nnormal=[0,0,{normal}]\nfields=[\"pressure\"]\n")
    };
    let case = format!(
        "[mesh]\norder=2\n[mesh.generate.box]\nlower=[0,0,0]\nupper=[1,1,2]\ncells=[2,2,2]\nperiodic=[\"x\",\"y\",\"z\"]\n\
         [flow]\norder=2\nreference={{density=1,speed=1,pressure=8}}\ninitial={{uniform={{density=1,velocity=[0,0,0],pressure=8}}}}\n\
         [time]\norder=1\nend=0.1\nslabs=1\n{}",
        planes.map(slice).concat()
    );
    on_text(directory.path(), &case, &[], "run", &[]).expect(0, &[]);
    for (name, ..) in planes {
        let text = fs::read_to_string(directory.path().join(format!("run/slice_{name}/slab_000001.vtp"))).unwrap();
        assert!((area(&text) - 1.0).abs() < 1e-12, "{name}: {}", area(&text));
    }
}

/// Slices of a curved mesh that moves.
#[test]
fn a_slice_of_curved_cells_is_plane() {
    let directory = TempDir::new().unwrap();
    let set =
        ["output.slices.a={point=[0.5,0.5,0.52],normal=[0,0.1,1],fields=[\"density\",\"mesh_velocity\"],parts=4}"];
    finished(directory.path(), "free_stream_3d", &set);
    let text = fs::read_to_string(directory.path().join("free_stream_3d/slice_a/slab_000005.vtp")).unwrap();
    let points = floats(&text, "Points");
    assert!(points.iter().all(|[_, y, z]| (0.1 * (y - 0.5) + z - 0.52).abs() < 1e-14));
    assert!(largest(&array(&text, "density", f64::from_le_bytes), |_| 1.2) < 1e-12);
    // At the boundary x moves by 0.04 sin(2 t) and z not there; the edges in y slide within their planes.
    let motion = floats(&text, "mesh_velocity");
    assert!(motion.iter().any(|v| tensor::norm(v) > 0.01));
    assert!((area(&text) - 1.01_f64.sqrt()).abs() < 2e-3, "{}", area(&text));
}

/// The vortex on its swirling mesh: a line is as accurate as the flow, also if the mesh carries it.
#[test]
fn a_line_through_the_vortex_follows_the_exact_solution() {
    let directory = TempDir::new().unwrap();
    let fields = "fields=[\"density\",\"velocity\",\"pressure\",\"displacement\"]";
    let set = [
        "time.end=1.9964",
        "time.slabs=20",
        &format!("output.lines.fixed={{from=[1,3],to=[17,9],points=81,every=20,{fields}}}"),
        &format!("output.lines.carried={{from=[1,3],to=[17,9],points=81,every=20,carried=true,{fields}}}"),
        "output.lines.beyond={from=[-1,1],to=[1,1],points=5}",
    ];
    let summary = finished(directory.path(), "vortex_sinusoidal", &set);
    let run = directory.path().join("vortex_sinusoidal");
    let rms = number(&summary, "error.density_l2");
    for name in ["fixed", "carried"] {
        let line = Table::read(&run.join(format!("line_{name}.csv")));
        let last = &Table { names: line.names.clone(), rows: line.rows[81..].to_vec() };
        assert_eq!(last.rows.len(), 81);
        let [t, x, y, d, density] = ["t", "x", "y", "displacement_x", "density"].map(|name| last.column(name));
        let error = largest(&density, |i| vortex_density([x[i], y[i]], t[i]));
        assert!(error < 10.0 * rms && density.iter().any(|rho| *rho < 0.9996), "{name}: {error:e}, {rms:e}");
        // Carried points are where the prescribed motion takes them.
        let moved = |i: usize| {
            let (x, y) = (1.0 + 16.0 * i as f64 / 80.0, 3.0 + 6.0 * i as f64 / 80.0);
            let pi = std::f64::consts::PI;
            2.0 * (pi * x / 10.0).sin() * (2.0 * pi * y / 15.0).sin() * (2.0 * pi * t[i] / 125_f64.sqrt()).sin()
        };
        if name == "carried" {
            assert!(largest(&d, moved) < 1e-2, "an interpolated displacement: {:e}", largest(&d, moved));
            assert!(largest(&x, |i| 1.0 + 0.2 * i as f64 + d[i]) < 1e-12);
        }
    }
    let beyond = Table::read(&run.join("line_beyond.csv")).column("density");
    assert!(beyond[..2].iter().all(|rho| rho.is_nan()) && beyond[2..5].iter().all(|rho| rho.is_finite()));
}

/// The density of the vortex of `vortex_sinusoidal`.
fn vortex_density([x, y]: [f64; 2], t: f64) -> f64 {
    let [u, v] = [2.0 / 5_f64.sqrt(), 1.0 / 5_f64.sqrt()];
    let r2 = (x - 5.0 - u * t).powi(2) + (y - 5.0 - v * t).powi(2);
    let f = 1.0 - r2 / 1.5_f64.powi(2);
    let (gamma, mach, strength) = (1.4_f64, 0.5_f64, 0.3_f64);
    let factor = strength.powi(2) * (gamma - 1.0) * mach.powi(2) / (8.0 * std::f64::consts::PI.powi(2)) * f.exp();
    (1.0 - factor).powf(1.0 / (gamma - 1.0))
}

/// Values of a line and of points are those of the coefficients in the result, evaluated here by products of Lagrange polynomials.
#[test]
fn values_are_those_of_the_coefficients() {
    let directory = TempDir::new().unwrap();
    let set = ["time.end=0.4", "time.slabs=4"];
    finished(directory.path(), "vortex_sinusoidal", &set);
    let reader = output::ResultReader::open(&directory.path().join("vortex_sinusoidal/result.vtkhdf")).unwrap();
    let [position, flow] =
        ["position", "flow"].map(|name| reader.exact(name, reader.times.len() - 1).unwrap().unwrap());
    let nodes = basis::gauss_lobatto(4).points;
    let lagrange = |k: usize, x: f64| -> f64 {
        let others = nodes.iter().enumerate().filter(|(j, _)| *j != k);
        others.map(|(_, node)| (x - node) / (nodes[k] - node)).product()
    };
    let at = |coefficients: &[f64], [a, b]: [f64; 2]| -> f64 {
        (0..16).map(|k| coefficients[k] * lagrange(k % 4, a) * lagrange(k / 4, b)).sum()
    };
    let place = |cell: usize, xi: [f64; 2]| [0, 1].map(|i| at(&position[(2 * cell + i) * 16..][..16], xi));
    // Of the last of two time nodes.
    let density = |cell: usize, xi: [f64; 2]| at(&flow[((2 * cell + 1) * 4) * 16..][..16], xi);
    let ends = [(53, [0.3, -0.7]), (100, [-0.21, 0.123])];
    let [from, to] = ends.map(|(cell, xi)| place(cell, xi));
    let line = format!("output.lines.a={{from=[{:?},{:?}],to=[{:?},{:?}],points=2}}", from[0], from[1], to[0], to[1]);
    let probe = |x: [f64; 2]| format!("{{at=[{:?},{:?}]}}", x[0], x[1]);
    let probes = format!("output.probes={{first={},second={}}}", probe(from), probe(to));
    finished(directory.path(), "vortex_sinusoidal", &[set[0], set[1], &line, &probes]);
    for (name, (cell, xi)) in ["first", "second"].into_iter().zip(ends) {
        let values = column(&directory.path().join("vortex_sinusoidal"), &format!("{name}_density"));
        assert!((values[3] - density(cell, xi)).abs() < 1e-12, "{name}: {values:?}");
    }
    let line = Table::read(&directory.path().join("vortex_sinusoidal/line_a.csv"));
    let last = &line.column("density")[8..];
    assert!(largest(last, |i| density(ends[i].0, ends[i].1)) < 1e-12, "{last:?}");
}

#[test]
fn files_of_a_resumed_run_are_those_of_an_uninterrupted_one() {
    let directory = TempDir::new().unwrap();
    let cuts = [
        "output.lines.a={from=[0.1,0.1,0.2],to=[0.9,0.8,0.7],points=5}",
        "output.slices.b={point=[0.5,0.5,0.5],normal=[0,0,1]}",
        // The former end, after two slabs, is no multiple of this.
        "output.lines.c={from=[0.1,0.1,0.2],to=[0.9,0.8,0.7],points=2,every=3}",
        "output.slices.d={point=[0.5,0.5,0.5],normal=[0,0,1],every=3}",
        "output.checkpoint_every=2",
    ];
    let go = |output: &str, end: &str, extra: &[&str]| {
        let set = [&cuts[..], &[end, "time.step=0.1"]].concat();
        let text = fs::read_to_string(shipped("free_stream_3d.toml")).unwrap().replace("slabs = 5\n", "");
        let case = directory.path().join("free_stream_3d.toml");
        fs::write(&case, text).unwrap();
        let mut arguments = vec!["run", case.to_str().unwrap(), "--output", output, "--quiet"];
        set.iter().for_each(|change| arguments.extend(["--set", change]));
        arguments.extend(extra);
        stsolve(directory.path(), &arguments).expect(0, &[]);
    };
    go("through", "time.end=0.4", &[]);
    go("resumed", "time.end=0.2", &[]);
    // Rows after the checkpoint are computed again.
    let path = directory.path().join("resumed/line_a.csv");
    fs::write(&path, fs::read_to_string(&path).unwrap() + "0.3,1,2,3,4,5,6,7,8,9\n0.35,").unwrap();
    go("resumed", "time.end=0.4", &["--resume"]);
    let slices = ["slice_b.pvd", "slice_b/slab_000003.vtp", "slice_b/slab_000004.vtp", "slice_d.pvd"];
    for name in ["line_a.csv", "line_c.csv"].into_iter().chain(slices) {
        let read = |run: &str| fs::read(directory.path().join(run).join(name)).unwrap();
        assert!(read("through") == read("resumed"), "{name}");
    }
}
