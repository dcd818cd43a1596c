//! Lines with errors in the section of the flow, besides those of its boundaries.

use super::BadLine;

pub(super) const BAD: &[BadLine] = &[
    ("order = 4", "ordr = 4", &["`flow.ordr = 4`", "unknown key `ordr`", "`quadrature`", "did you mean `order`"]),
    ("order = 4", "order = \"four\"", &["`flow.order = \"four\"`", "unknown name `four`"]),
    ("order = 4", "order = 1", &["`flow.order = 1`", "2 to 16 nodes"]),
    ("order = 4", "order = 17", &["`flow.order = 17`", "2 to 16 nodes"]),
    ("order = 4", "order = -4", &["`flow.order = -4`", "a whole number"]),
    ("order = 4", "order = 18446744073709551615", &["`flow.order = 18446744073709551615`", "below 2^63"]),
    ("order = 4", "order = 1000000000000000000000", &["1000000000000000000000`", "below 2^63"]),
    ("order = 4", "", &["`flow`", "missing key `order`"]),
    ("order = 4", "order = ", &["expected"]),
    ("order = 4", "order = 4\norder = 5", &["duplicate key"]),
    ("velocity = [0.5, 0]", "velocity = [0.5, inf]", &["velocity[1] = inf`", "finite"]),
    ("pressure = 1", "pressure = 0", &["`flow.initial.uniform.pressure = 0`", "positive"]),
    ("pressure = 1", "", &["`flow.initial.uniform`", "the pressure is missing", "`mach`"]),
    ("pressure = 1", "pressure = 1\nmach = 0.5", &["more than once", "one of"]),
    ("pressure = 1", "mach = 0", &["`flow.initial.uniform.mach = 0`", "positive"]),
    ("order = 4", "order = 4\ngas.gamma = 1", &["`flow.gas.gamma = 1`", "above 1"]),
    ("order = 4", "order = 4\ngas = { mach = 0.5, gas_constant = 1 }", &["`flow.gas`", "given twice"]),
    (
        "order = 4",
        "order = 4\nquadrature = { points = 3 }",
        &["`flow.quadrature.points = 3`", "4, the order of the flow"],
    ),
    ("order = 4", "order = 4\nsource = \"manufactured\"", &["`flow.source", "`exact`"]),
    ("order = 4", "order = 4\nsource = { given = { momentum = [1] } }", &["source.given.momentum = [1]`", "2 entries"]),
    (
        "order = 4",
        "order = 4\nsource = { given = { density = \"1/x\" } }",
        &["source.given.density", "the source of density at [0.0, 0.0] and t = 0", "finite everywhere"],
    ),
    (
        "order = 4",
        "order = 4\nsponge = { strength = \"1 - x\", target = { velocity = [0.5, 0], pressure = 1 } }",
        &["`flow.sponge.strength = \"1 - x\"`", "the strength at", "0 or positive everywhere"],
    ),
    (
        "order = 4",
        "order = 4\nsponge = { strength = 1, target = { velocity = [0.5, 0], pressure = -1 } }",
        &["`flow.sponge.target.pressure = -1`", "positive"],
    ),
    (
        "order = 4",
        "order = 4\nsource = { given = { energy = 1 } }\nsponge = { strength = 1, target = { velocity = [1, 0], pressure = 1 } }",
        &["`flow.sponge", "no place beside this source", "acceleration"],
    ),
    ("[flow]", "[folw]", &["`folw`", "unknown key `folw`", "did you mean `flow`"]),
    ("order = 4", "order = 4\ngas.viscosity.sutherland = [1, 2, 3]", &["sutherland = [1, 2, 3]`", "a table"]),
    (
        "order = 4",
        "order = 4\nforces.left.point = [0, \"sqrt(0.5-t)\"]",
        &["`flow.forces.left.point[1]", "t = 0.618", "NaN", "finite over the whole run"],
    ),
    ("order = 4", "order = 4\ngas.gamma = 1e30", &["`flow.gas.gamma = 1e30`", "1.0001 to 100"]),
    ("order = 4", "order = 4\ngas.viscosity = 0.1", &["`flow.gas.viscosity = 0.1`", "wrong type", "`sutherland`"]),
    ("order = 4", "order = 4\nreference = { speed = 1e30, pressure = 1 }", &["`flow.reference.speed = 1e30`", "Mach"]),
    (
        "order = 4",
        "order = 4\nforces.left.drag_direction = [0, 0]",
        &["`flow.forces.left.drag_direction = [0, 0]`", "infinite"],
    ),
    ("order = 4", "order = 4\ngas.viscosity = { constant = 1e300 }", &["viscosity.constant = 1e300`", "1e-60 to 1e60"]),
];
