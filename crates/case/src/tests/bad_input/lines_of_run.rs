//! Lines with errors in the times, the solver, the output, the tables and the constants.

use super::BadLine;

pub(super) const BAD: &[BadLine] = &[
    ("order = 2", "order = 0", &["`time.order = 0`", "1 to 16 nodes"]),
    ("end = 1", "end = 0", &["`time.end = 0`", "after the start, 0"]),
    ("end = 1", "end = nan", &["`time.end = nan`", "finite"]),
    ("step = 0.3", "step = 0", &["`time.step = 0`", "a positive number"]),
    ("step = 0.3", "step = -0.1", &["`time.step = -0.1`", "a positive number"]),
    ("step = 0.3", "", &["`time`", "missing", "`step` or `slabs`"]),
    ("step = 0.3", "slabs = 3\nadaptive = { tolerance = 1e-3 }", &["`time.slabs = 3`", "same length", "`time.step`"]),
    ("step = 0.3", "step = 0.3\nadaptive = { tolerance = 0 }", &["`time.adaptive.tolerance = 0`", "positive"]),
    (
        "step = 0.3",
        "step = 0.3\nadaptive = { tolerance = 1e-3, smallest = 1 }",
        &["`time.adaptive.smallest = 1`", "at most the step, 0.3"],
    ),
    (
        "step = 0.3",
        "step = 0.3\nadaptive = { tolerance = 1e-3, largest = 0.1 }",
        &["`time.adaptive.largest = 0.1`", "at least the step, 0.3"],
    ),
    ("step = 0.3", "step = 0.3\nslabs = 3", &["`time`", "twice", "`step` or `slabs`"]),
    (
        "step = 0.3",
        "step = 0.3\n[solver]\nnewton_tolerance = 0.99",
        &["`solver.newton_tolerance = 0.99`", "at most 0.1"],
    ),
    (
        "step = 0.3",
        "step = 0.3\n[solver]\nnewton_absolute_tolerance = 0.2",
        &["`solver.newton_absolute_tolerance = 0.2`", "from 0 to 0.1"],
    ),
    (
        "step = 0.3",
        "step = 0.3\n[solver]\nsteady = { tolerance = 0.5 }",
        &["`solver.steady.tolerance = 0.5`", "at most 0.1"],
    ),
    ("step = 0.3", "step = 0.3\n[output]\nfields = [\"mass\"]", &["`output.fields[0] = \"mass\"`", "`mach`"]),
    (
        "step = 0.3",
        "step = 0.3\n[output]\nfields = [\"density\", \"density\"]",
        &["`output.fields[1] = \"density\"`", "field `density` is listed twice"],
    ),
    ("step = 0.3", "step = 1e-30", &["`time.step = 1e-30`", "round-off of the time", "2.2e-13 or more"]),
    ("step = 0.3", "slabs = 1000000000000000", &["`time.slabs = 1000000000000000`", "round-off of the time"]),
    (
        "step = 0.3",
        "step = 0.3\nadaptive = { tolerance = 1e-3, smallest = 1e-30 }",
        &["`time.adaptive.smallest = 1e-30`", "round-off of the time", "2.2e-13 or more"],
    ),
    (
        "step = 0.3",
        "step = 0.3\n[solver]\nslab_halvings = 4294967297",
        &["`solver.slab_halvings = 4294967297`", "0 to 40"],
    ),
    ("b = ", "c = \"exp(300)\"", &["`constants.c", "the formula, 1.9424263952412558e130,"]),
    ("step = 0.3", "step = 0.3\n[output]\ndirectory = \"\"", &["`output.directory = \"\"`", "empty"]),
    (
        "step = 0.3",
        "step = 0.3\n[tables]\nh = { t = [0, 1, 1, 3], values = [0, 1, 2, 3] }",
        &["`tables.h.t = [0, 1, 1, 3]`", "times must increase"],
    ),
];
