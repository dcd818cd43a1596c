//! The length to which a flow refers.

use super::*;

/// A cylinder of diameter 0.5 in a channel of height 4, in units of `length`.
fn cylinder(length: f64, reference: &str) -> (f64, f64) {
    let [inner, outer, first] = [0.25, 4.0, 0.1].map(|size| size * length);
    let text = format!(
        "mesh = {{ order = 3, generate.annulus = {{ inner_radius = {inner}, outer_radius = {outer}, first_cell = {first}, cells = [8, 4] }} }}
         time = {{ order = 1, end = 1, step = 1 }}
         [flow]
         order = 2
         initial.uniform = {{ velocity = [1, 0], pressure = 1 }}
         {reference}
         [flow.boundary]
         wall = \"slip_wall\"
         far = {{ far_field = {{ velocity = [1, 0], pressure = 1 }} }}"
    );
    let case = plane(&text, &[]);
    let flow = case.flow.unwrap();
    assert_eq!(flow.time_unit() * flow.reference_speed, flow.time_length);
    (flow.reference_length, flow.time_length)
}

/// The unit of length decided whether a steady start succeeded: scales of time followed from a length of 1.
#[test]
fn scales_of_time_follow_from_the_mesh_where_no_length_is_given() {
    for length in [1e-4, 0.01, 1.0, 1000.0] {
        let (reference, of_time) = cylinder(length, "");
        assert_eq!(reference, 1.0, "coefficients keep their length");
        assert!((of_time / (0.5 * length) - 1.0).abs() < 1e-14, "{length}: {of_time}");
    }
    assert_eq!(cylinder(0.01, "reference = { density = 1, speed = 2, pressure = 1 }"), (1.0, 0.005));
    assert_eq!(cylinder(0.01, "reference = { density = 1, speed = 2, pressure = 1, length = 3 }"), (3.0, 3.0));
}

/// A box of this size, whose wall is the boundary `wall`.
fn box_length(size: &str, cells: &str, wall: &str) -> f64 {
    let zero = if size.matches(',').count() == 1 { "[0, 0]" } else { "[0, 0, 0]" };
    let velocity = zero.replacen('0', "1", 1);
    let text = format!(
        "mesh = {{ order = 2, generate.box = {{ lower = {zero}, upper = {size}, cells = {cells} }} }}
         time = {{ order = 1, end = 1, step = 1 }}
         [flow]
         order = 2
         initial.uniform = {{ velocity = {velocity}, pressure = 1 }}
         [flow.boundary]
         {wall} = \"slip_wall\"
         others = {{ far_field = {{ velocity = {velocity}, pressure = 1 }} }}"
    );
    match check_text(&text, &[]).unwrap() {
        AnyCase::Plane(case) => case.flow.unwrap().time_length,
        AnyCase::Space(case) => case.flow.unwrap().time_length,
    }
}

/// A wall along the whole mesh is no body. The length of a duct and the width of a thin slice of it tell nothing.
#[test]
fn without_a_body_the_second_largest_extent_counts() {
    assert_eq!(box_length("[20, 1.234]", "[4, 2]", "bottom"), 1.2);
    assert_eq!(box_length("[0.5, 3]", "[2, 2]", "top"), 0.5);
    assert_eq!(box_length("[20, 2, 0.1]", "[4, 2, 1]", "bottom"), 2.0);
}

/// The span of a wing with two free tips is longer than its chord.
#[test]
fn the_middle_extent_of_a_body_counts() {
    let text = "mesh = { order = 4, generate.ellipsoid = { semi_axes = [0.5, 0.03, 1.5], outer_radius = 15, first_cell = 0.02, cells = [6, 2, 6, 7] } }
                time = { order = 1, end = 1, step = 1 }
                [flow]
                order = 2
                initial.uniform = { velocity = [1, 0, 0], pressure = 1 }
                [flow.boundary]
                wall = \"slip_wall\"
                far = { far_field = { velocity = [1, 0, 0], pressure = 1 } }";
    let Ok(AnyCase::Space(case)) = check_text(text, &[]) else { panic!("refused") };
    assert_eq!(case.flow.unwrap().time_length, 1.0);
}

/// The speed of the reference and the viscosity at a Reynolds number of 100, with this start and these far fields.
fn reference_speed(start: &str, far: [&str; 2]) -> (f64, f64) {
    let text = format!(
        "mesh = {{ order = 2, generate.box = {{ lower = [0, 0], upper = [1, 1], cells = [2, 2] }} }}
         time = {{ order = 1, end = 1, step = 1 }}
         [flow]
         order = 2
         gas.viscosity.reynolds = 100
         {start}
         [flow.boundary]
         left = {{ far_field = {{ {}, pressure = 2 }} }}
         others = {{ far_field = {{ {}, pressure = 2 }} }}",
        far[0], far[1]
    );
    let flow = plane(&text, &[]).flow.unwrap();
    let navier_stokes::Viscosity::Constant(viscosity) = flow.law.gas.viscosity() else { panic!("it is constant") };
    (flow.reference_speed, viscosity)
}

/// Another initial state than the far field was the reference of all coefficients and of the viscosity, without a word.
#[test]
fn the_reference_is_the_far_field() {
    let [rest, fast] = ["[0, 0]", "[3, 0]"].map(|w| format!("initial.uniform = {{ velocity = {w}, pressure = 2 }}"));
    let exact = "exact.uniform = { velocity = [5, 0], pressure = 2 }";
    let [one, two] = ["velocity = [0, 1]", "velocity = [2, 0]"];
    let formulas = "initial.expression = { density = 1, velocity = [1, 0], pressure = 2 }";
    for start in [&rest, &fast, formulas] {
        assert_eq!(reference_speed(start, [one, one]), (1.0, 0.01), "{start}");
    }
    assert_eq!(reference_speed(&fast, [one, two]), (3.0, 0.03), "two far fields");
    assert_eq!(reference_speed(&fast, ["velocity = [0, 0]"; 2]), (3.0, 0.03), "a far field at rest");
    assert_eq!(reference_speed(exact, [one, one]), (5.0, 0.05), "the exact state");
}
