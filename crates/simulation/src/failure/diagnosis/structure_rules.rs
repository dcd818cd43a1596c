//! Causes in a structure.

use super::super::data::{BadLoad, FailureData};
use super::{Cause, number, rises};
use elasticity::NEARLY_INCOMPRESSIBLE;

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

/// The run begins inside out.
pub fn inverted_start(data: &FailureData) -> Option<Cause> {
    let smallest = data.structure.as_ref()?.smallest_volume_ratio;
    (data.attempt.slabs_done == 0 && smallest <= 0.0).then(|| Cause {
        name: "inverted_start",
        likelihood: 0.95,
        what: format!("the displacement at the start turns a cell inside out: det(I + grad d) = {}", number(smallest)),
        remedy: "look at `structure.initial.displacement`: it compresses the body to less than nothing".into(),
    })
}

/// The body is squeezed to nothing.
pub fn squeezed(data: &FailureData) -> Option<Cause> {
    let structure = data.structure.as_ref()?;
    let smallest = structure.smallest_volume_ratio.max(0.0);
    (data.attempt.slabs_done > 0 && structure.is_nonlinear).then(|| Cause {
        name: "squeezed",
        likelihood: 0.8 * (1.0 - rises(smallest, 0.1)),
        what: format!("the body is squeezed to nothing: to {} of its volume at a point", number(smallest)),
        remedy: "lower the loads or the velocity; the law \"neo_hookean\" resists compression without limit, \"st_venant_kirchhoff\" does not"
            .into(),
    })
}

/// Laws of large displacement carry limited loads: beyond, there is no equilibrium near.
pub fn limit_load(data: &FailureData) -> Option<Cause> {
    let structure = data.structure.as_ref()?;
    let remedy = if structure.waves_per_slab.is_none() {
        "let the loads grow with t, in more `time.slabs`, up to a smaller one; with `structure.analysis = \"dynamic\"` a body may snap through"
    } else {
        "shorten `time.step`"
    };
    structure.is_nonlinear.then(|| Cause {
        name: "limit_load",
        likelihood: 0.4,
        what: "the loads change much in this slab, or exceed what the body can carry: no solution was found near the last one".into(),
        remedy: remedy.into(),
    })
}

/// Waves travel over many nodes in a slab, so that the systems of its modes are far from the mass matrix.
pub fn long_slab(data: &FailureData) -> Option<Cause> {
    let waves = data.structure.as_ref()?.waves_per_slab?;
    Some(Cause {
        name: "long_slab",
        likelihood: 0.1 + 0.6 * rises(waves, 1e4),
        what: format!("the slab is long: a shear wave passes {} distances of nodes in it", number(waves)),
        remedy: "shorten `time.step`, to a part of the shortest period that matters".into(),
    })
}

/// Cells with a smaller aspect ratio are not slender.
const SLENDER: f64 = 100.0;

/// Cells whose det J varies less are not uneven.
const UNEVEN: f64 = 0.1;

/// Cells are slender or uneven, which increases round-off.
pub fn slender_cells(data: &FailureData) -> Option<Cause> {
    let mesh = &data.mesh;
    let _ = data.structure.as_ref()?;
    (mesh.aspect_ratio > SLENDER || mesh.evenness < UNEVEN).then(|| Cause {
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
        remedy: format!("take `structure.poisson_ratio` of {NEARLY_INCOMPRESSIBLE} or less"),
    })
}
