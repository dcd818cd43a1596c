//! Causes in a structure.

use super::super::data::{BadLoad, FailureData};
use super::{Cause, number, rises};

/// The formula of a load has no value.
pub fn bad_load(data: &FailureData) -> Option<Cause> {
    let BadLoad { time, position } = data.structure.as_ref()?.bad_load.as_ref()?;
    Some(Cause {
        name: "bad_load",
        likelihood: 0.97,
        what: format!("the formula of a load has no finite value at t = {} near {position:?}", number(*time)),
        remedy: "look at the formulas of `structure.boundary` and `structure.body_force`: division by zero, the root or logarithm of a \
                 negative number, a table that ends before the run"
            .into(),
    })
}

/// Waves travel over many nodes in a slab, so that the systems of its modes are far from the mass matrix.
pub fn long_slab(data: &FailureData) -> Option<Cause> {
    let waves = data.structure.as_ref()?.waves_per_slab;
    Some(Cause {
        name: "long_slab",
        likelihood: 0.1 + 0.6 * rises(waves, 1e4),
        what: format!("the slab is long: a shear wave passes {} distances of nodes in it", number(waves)),
        remedy: "shorten `time.step`, to a part of the shortest period that matters".into(),
    })
}

/// Cells are slender or uneven, which increases round-off.
pub fn slender_cells(data: &FailureData) -> Option<Cause> {
    let mesh = &data.mesh;
    let _ = data.structure.as_ref()?;
    Some(Cause {
        name: "slender_cells",
        likelihood: 0.1 + 0.7 * rises(mesh.aspect_ratio, 1e3).max(1.0 - rises(mesh.evenness, 1e-2)),
        what: format!(
            "the cells lose accuracy to round-off: the largest aspect ratio is {}, within a cell det J varies by a factor of {}",
            number(mesh.aspect_ratio),
            number(1.0 / mesh.evenness)
        ),
        remedy: "take cells whose sides are more alike".into(),
    })
}

/// The material is nearly incompressible.
pub fn nearly_incompressible(data: &FailureData) -> Option<Cause> {
    let nu = data.structure.as_ref()?.poisson_ratio;
    Some(Cause {
        name: "nearly_incompressible",
        likelihood: 0.8 * rises(1.0 / (1.0 - 2.0 * nu), 1e3),
        what: format!("the material is nearly incompressible, with Poisson's ratio {nu}"),
        remedy: "take `structure.poisson_ratio` of 0.49 or less".into(),
    })
}
