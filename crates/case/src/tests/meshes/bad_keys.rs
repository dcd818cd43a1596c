//! Errors of the keys of a mesh name the key and what is accepted.

use super::*;

/// Keys below `[mesh]` after the order, and parts of the message.
const BAD: &[(&str, &[&str])] = &[
    ("", &["`mesh`", "there is no mesh", "`file`"]),
    ("periodic = [[\"a\", \"b\"]]\ngenerate.airfoil = {}", &["`mesh.periodic", "joined by name"]),
    (
        "split_simplices = true\ngenerate.disc = { radius = 2, core_cells = 2, radial_cells = 1 }",
        &["`mesh.split_simplices", "only cells of a file"],
    ),
    ("file = \"none.msh\"", &["`mesh.file = \"none.msh\"`", "cannot read dir/none.msh"]),
    ("generate.airfoli = {}", &["unknown choice `airfoli`", "did you mean `airfoil`"]),
    ("generate.rotating_box = { cells_per_side = 5, sides = 1 }", &["rotating_box.sides = 1`", "did you mean `side`"]),
    ("generate.rotating_box = { cells_per_side = 7 }", &["rotating_box.cells_per_side = 7`", "multiples of 5"]),
    ("generate.rotating_box = { cells_per_side = 5, side = -1 }", &["rotating_box.side = -1`", "a positive number"]),
    ("generate.rotating_box = { cells_per_side = 5, hole = 2 }", &["rotating_box.hole = 2`", "less than the side"]),
    ("generate.rotating_box = { cells_per_side = 100000 }", &["cells_per_side = 100000`", "fewer cells"]),
    ("generate.channel = { extent = [1], cells = [2] }", &["channel.extent = [1]`", "two or three"]),
    ("generate.channel = { extent = [1, 0], cells = [2, 2] }", &["channel.extent[1] = 0`", "a positive number"]),
    ("generate.channel = { extent = [1, 1], cells = [0, 2] }", &["channel.cells[0] = 0`", "1 or more"]),
    ("generate.channel = { extent = [1, 1], cells = [2] }", &["channel.cells = [2]`", "2 entries"]),
    (
        "generate.channel = { extent = [1, 1], cells = [2, 2], wall_ratio = 0 }",
        &["channel.wall_ratio = 0`", "a positive number"],
    ),
    (
        "generate.annulus = { inner_radius = 0, outer_radius = 3, first_cell = 0.2, cells = [8, 3] }",
        &["annulus.inner_radius = 0`", "a positive number"],
    ),
    (
        "generate.annulus = { inner_radius = 1, outer_radius = 1, first_cell = 0.2, cells = [8, 3] }",
        &["annulus.outer_radius = 1`", "a positive number"],
    ),
    (
        "generate.annulus = { inner_radius = 1, outer_radius = 3, first_cell = 9, cells = [8, 3] }",
        &["annulus.first_cell = 9`", "less than the width"],
    ),
    (
        "generate.annulus = { inner_radius = 1, outer_radius = 3, first_cell = 0.2, cells = [2, 3] }",
        &["annulus.cells[0] = 2`", "at least 3"],
    ),
    (
        "generate.annulus = { inner_radius = 1, outer_radius = 3, first_cell = 0.2, cells = [8, 0] }",
        &["annulus.cells[1] = 0`", "1 to 100000"],
    ),
    ("generate.disc = { radius = 0, core_cells = 2, radial_cells = 1 }", &["disc.radius = 0`", "a positive number"]),
    ("generate.disc = { core_cells = 0, radial_cells = 1 }", &["disc.core_cells = 0`", "1 to 100000"]),
    ("generate.disc = { core_cells = 2, radial_cells = 0 }", &["disc.radial_cells = 0`", "1 to 100000"]),
    ("generate.airfoil.thickness = 0", &["airfoil.thickness = 0`", "more than 0"]),
    ("generate.airfoil.far_field = 1", &["airfoil.far_field = 1`", "at least 2 chords"]),
    ("generate.airfoil.first_cell = 1", &["airfoil.first_cell = 1`", "1e-8 to 0.2"]),
    ("generate.airfoil.trailing_edge_cell = 0.5", &["airfoil.trailing_edge_cell = 0.5`", "smooth distribution"]),
    ("generate.airfoil.surface_cells = 1", &["airfoil.surface_cells = 1`", "2 or more"]),
    ("generate.airfoil.wake_cells = 0", &["airfoil.wake_cells = 0`", "1 to 100000"]),
    ("generate.airfoil.near_wake = { extent = 60, cells = 4 }", &["airfoil.near_wake.extent = 60`", "at most half"]),
    ("generate.airfoil.near_wake = { extent = 2, cells = 10 }", &["airfoil.near_wake.cells = 10`", "fewer than"]),
    ("generate.airfoil.near_wall = { extent = 0, cells = 4 }", &["airfoil.near_wall.extent = 0`", "more than 0"]),
    ("generate.airfoil.near_wall = { extent = 1, cells = 0 }", &["airfoil.near_wall.cells = 0`", "1 or more"]),
    ("generate.airfoil.normal_cells = 0", &["airfoil.normal_cells = 0`", "1 to 100000"]),
    ("generate.turbine_blade.pitch = 0", &["turbine_blade.pitch = 0`", "a positive number"]),
    ("generate.turbine_blade.inflow_angle = 90", &["turbine_blade.inflow_angle = 90`", "between -87 and 87"]),
    ("generate.turbine_blade.outflow_angle = -90", &["turbine_blade.outflow_angle = -90`", "between -87 and 87"]),
    ("generate.turbine_blade.inflow_distance = 0", &["turbine_blade.inflow_distance = 0`", "a positive number"]),
    ("generate.turbine_blade.outflow_distance = 0", &["turbine_blade.outflow_distance = 0`", "a positive number"]),
    ("generate.turbine_blade.layer = 0", &["turbine_blade.layer = 0`", "a positive number"]),
    ("generate.turbine_blade.first_cell = 1", &["turbine_blade.first_cell = 1`", "less than the layer"]),
    ("generate.turbine_blade.cells.side = 0", &["turbine_blade.cells.side = 0`", "1 to 100000"]),
    ("generate.turbine_blade.cells.end = 0", &["turbine_blade.cells.end = 0`", "1 to 100000"]),
    ("generate.turbine_blade.cells.normal = 0", &["turbine_blade.cells.normal = 0`", "1 to 100000"]),
    ("generate.turbine_blade.cells.gap = 0", &["turbine_blade.cells.gap = 0`", "1 to 100000"]),
    ("generate.turbine_blade.cells.before = 0", &["turbine_blade.cells.before = 0`", "1 to 100000"]),
    ("generate.turbine_blade.cells.after = 0", &["turbine_blade.cells.after = 0`", "1 to 100000"]),
    (
        "generate.turbine_blade.profile = \"t107\"",
        &["turbine_blade.profile", "unknown choice", "`low_pressure_turbine`"],
    ),
    (
        "generate.disc = { core_cells = 2, radial_cells = 1 }\nextrude = { depth = 0, layers = 2 }",
        &["`mesh.extrude.depth = 0`", "a positive number"],
    ),
    (
        "generate.disc = { core_cells = 2, radial_cells = 1 }\nextrude = { depth = 1, layers = 0 }",
        &["`mesh.extrude.layers = 0`", "1 to 100000"],
    ),
    (
        "generate.disc = { core_cells = 2, radial_cells = 1 }\nextrude = { depth = 1, layers = 2, lower = nan }",
        &["`mesh.extrude.lower = nan`", "number"],
    ),
    (
        "generate.box = { lower = [0, 0, 0], upper = [1, 1, 1], cells = [1, 1, 1] }\nextrude = { depth = 1, layers = 2 }",
        &["`mesh.extrude", "three dimensions already"],
    ),
    ("generate.channel_flag.flag_end = 0.3", &["channel_flag.flag_end = 0.3`", "more than twice x of the centre"]),
    ("generate.channel_flag.cells.along = 0", &["channel_flag.cells.along = 0`", "1 to 100000"]),
    ("generate.channel_flag.thickness = 0.2", &["channel_flag.thickness = 0.2`", "less than the diameter"]),
    (
        "generate.box = { lower = [0, 0], upper = [1, 1], cells = [2, 2], regions.a = { lower = [0, 0], upper = [0.4, 1] } }",
        &["regions.a.upper[0] = 0.4`", "not between cells", "is at 0.5"],
    ),
    (
        "generate.box = { lower = [0, 0], upper = [1, 1], cells = [2, 2], regions.a = { lower = [0, 0], upper = [0, 1] } }",
        &["box.regions.a", "has no cells"],
    ),
    (
        "generate.box = { lower = [0, 0], upper = [1, 1], cells = [2, 2], regions.rest = { lower = [0, 0], upper = [0.5, 1] } }",
        &["box.regions.rest", "another name"],
    ),
    (
        "generate.box = { lower = [0, 0], upper = [1, 1], cells = [2, 2], regions.a = { lower = [0], upper = [0.5, 1] } }",
        &["regions.a.lower = [0]`", "2 entries"],
    ),
    (
        "generate.box = { lower = [0, 0], upper = [1, 1], cells = [2, 2], segments.x = [{ end = 1, cells = 3 }] }",
        &["segments.x[0]", "expected 1 after 2 cells"],
    ),
    (
        "generate.box = { lower = [0, 0], upper = [1, 1], cells = [2, 2], segments.z = [{ end = 1, cells = 2 }] }",
        &["segments.z", "no such axis"],
    ),
    (
        "generate.box = { lower = [0, 0], upper = [1, 1], cells = [2, 2], size_ratio = [2, 1], segments.x = [{ end = 1, cells = 2 }] }",
        &["segments.x", "no effect"],
    ),
];

#[test]
fn what_is_wrong_with_a_mesh_is_named_by_its_key() {
    for (keys, expected) in BAD {
        let message = with_mesh(&format!("order = 2\n{keys}")).unwrap_err().to_string();
        let line = message.split(':').nth(1).unwrap();
        assert!(line.parse::<usize>().is_ok_and(|line| line >= 7), "no line of [mesh]: {message}");
        expected.iter().for_each(|part| assert!(message.contains(part), "no {part} in:\n{message}"));
    }
    let message = with_mesh("generate.airfoil = {}").unwrap_err().to_string();
    assert!(message.contains("the order of the mesh is missing"), "{message}");
}
