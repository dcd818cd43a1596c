//! Lines with errors in the conditions of the flow's boundaries.

use super::BadLine;

pub(super) const BAD: &[BadLine] = &[
    (
        "left = \"slip_wall\"",
        "lfet = \"slip_wall\"",
        &["`flow.boundary.lfet", "unknown boundary `lfet`", "`right`", "did you mean `left`"],
    ),
    (
        "left = \"slip_wall\"",
        "left = \"slip\"",
        &["`flow.boundary.left = \"slip\"`", "unknown choice `slip`", "`slip_wall`"],
    ),
    (
        "left = \"slip_wall\"",
        "left = { supersonic_outflow = {} }",
        &["unknown choice `supersonic_outflow`", "did you mean `outflow`"],
    ),
    ("left = \"slip_wall\"", "left = \"adiabatic_wall\"", &["settings in a table"]),
    (
        "left = \"slip_wall\"",
        "left = \"exact\"",
        &["`flow.boundary.left = \"exact\"`", "no exact solution", "`flow.exact`"],
    ),
    (
        "left = \"slip_wall\"",
        "left = { isothermal_wall = { temperature = 0 } }",
        &["`flow.boundary.left.isothermal_wall.temperature = 0`", "a positive number"],
    ),
    ("left = \"slip_wall\"", "left = { outflow = { pressure = -1 } }", &["outflow.pressure", "positive"]),
    (
        "left = \"slip_wall\"",
        "left = { adiabatic_wall = { slide = [1] } }",
        &["adiabatic_wall.slide = [1]`", "2 entries"],
    ),
    (
        "left = \"slip_wall\"",
        "left = { outflow = { pressure = \"x - 1\" } }",
        &["outflow.pressure = \"x - 1\"`", "the pressure of -1 at [0.0, 0.0] and t = 0", "positive everywhere"],
    ),
    (
        "left = \"slip_wall\"",
        "left = { isothermal_wall = { temperature = \"1 - 2*t\" } }",
        &["isothermal_wall.temperature = \"1 - 2*t\"`", "t = 0.618", "positive everywhere"],
    ),
    (
        "left = \"slip_wall\"",
        "left = { inflow = { total_pressure = \"1 + y\", total_temperature = 1, direction = [1] } }",
        &["inflow.direction = [1]`", "2 entries"],
    ),
    (
        "left = \"slip_wall\"",
        "left = { inflow = { total_pressure = 1, total_temperature = \"y\", direction = [1, 0] } }",
        &["total_temperature = \"y\"`", "the temperature of 0 at [0.0, 0.0] and t = 0", "positive everywhere"],
    ),
    (
        "left = \"slip_wall\"",
        "left = { inflow = { total_pressure = 1, total_temperature = 1, direction = [\"y\", 0] } }",
        &["inflow.direction", "the direction at [0.0, 0.0]", "points somewhere"],
    ),
    (
        "left = \"slip_wall\"",
        "left = { inflow = { total_pressure = 1, total_temperature = 1, direction = [\"-1 - y\", 0] } }",
        &["inflow.direction", "a vector into the domain"],
    ),
    (
        "left = \"slip_wall\"",
        "left = { adiabatic_wall = { slide = [\"y\", 0] } }",
        &["adiabatic_wall.slide", "does not slide in its plane"],
    ),
    (
        "left = \"slip_wall\"",
        "left = { adiabatic_wall = { slide = [0, \"1/y\"] } }",
        &["adiabatic_wall.slide", "the vector at [0.0, 0.0] and t = 0", "finite everywhere"],
    ),
    (
        "left = \"slip_wall\"",
        "left = { adiabatic_wall = { slide = [\"t\", 0] } }",
        &["adiabatic_wall.slide", "does not slide in its plane", "t = 0.236068"],
    ),
    (
        "left = \"slip_wall\"",
        "left = { isothermal_wall = { temperature = \"1 - 2*t*y\" } }",
        &["isothermal_wall.temperature", "the temperature of -0.236", "t = 0.618034", "positive everywhere"],
    ),
    (
        "left = \"slip_wall\"",
        "left = { outflow = { pressure = \"1 - 2*t*y\" } }",
        &["outflow.pressure", "the pressure of", "t = 0.618034", "positive everywhere"],
    ),
    (
        "left = \"slip_wall\"",
        "left = { inflow = { total_pressure = \"1 - 2*t*y\", total_temperature = 1, direction = [1, 0] } }",
        &["inflow.total_pressure", "the pressure of", "t = 0.618034", "positive everywhere"],
    ),
    (
        "left = \"slip_wall\"",
        "left = { inflow = { total_pressure = 1, total_temperature = 1, direction = [\"1 - 2*t\", 0] } }",
        &["inflow.direction", "the direction at [", "t = 0.618034", "a vector into the domain"],
    ),
    ("others = {", "", &["`flow.boundary`", "boundaries `right`, ", "of the mesh have no flow condition", "`others`"]),
    (
        "left = \"slip_wall\"",
        "left = { adiabatic_wall = { slide = [1, 0.5] } }",
        &["adiabatic_wall.slide = [1, 0.5]`", "does not slide in its plane", "[0.0, 0.0]", "along the wall"],
    ),
    (
        "others = {",
        "others = { far_field = { velocity = [1e6, 0], pressure = 1 } }",
        &["`flow.boundary.others.far_field.velocity = [1e6, 0]`", "the Mach number, 8.4515e5", "at most 100 times"],
    ),
    (
        "others = {",
        "others = { prescribed_state = { expression = { density = \"sqrt(-1-x)\", velocity = [0.5, 0], pressure = 1 } } }",
        &["prescribed_state.expression.density = \"sqrt(-1-x)\"`", "in cell 3", "NaN", "positive everywhere"],
    ),
    (
        "left = \"slip_wall\"",
        "left = { isothermal_wall = { temperature = 1e300 } }",
        &["isothermal_wall.temperature = 1e300`", "the number is out of range", "1e-60 to 1e60"],
    ),
    (
        "left = \"slip_wall\"",
        "left = { outflow = { pressure = 1e-300 } }",
        &["outflow.pressure = 1e-300`", "the number is out of range", "1e-60 to 1e60"],
    ),
    (
        "others = {",
        "others = { prescribed_state = { expression = { density = 1, velocity = [\"exp(300+x)\", 0], pressure = 1 } } }",
        &["expression.velocity[0] = \"exp(300+x)\"`", "the velocity in cell", "at most 1e60"],
    ),
];
