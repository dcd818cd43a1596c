//! Causes in bodies that the flow moves.

use super::super::data::{FailureData, Motion};
use super::{Cause, number, rises};

/// What to do where bodies that are released do not find their equilibrium.
const HELD: &str = "`solver.steady.bodies = \"held\"`, and a march in time to the equilibrium";

/// What makes bodies move less in a slab: a `shorter` one, where the case gives its length.
fn smaller_motion<'a>(data: &FailureData, shorter: &'a str) -> &'a str {
    if data.attempt.has_given_length() { shorter } else { HELD }
}

/// Nothing holds a body that is to find its equilibrium.
pub fn unheld(data: &FailureData) -> Option<Cause> {
    let [what, remedy] = data.bodies.as_ref()?.unheld.clone()?;
    Some(Cause { name: "unheld_body", likelihood: 0.95, what, remedy })
}

/// The gas turns the structure inside out.
pub fn crushed(data: &FailureData) -> Option<Cause> {
    let ratio = data.bodies.as_ref()?.inverted?;
    Some(Cause {
        name: "crushed_structure",
        likelihood: 0.94,
        what: format!("the gas turns the structure inside out: det(I + grad d) is {} in a cell of it", number(ratio)),
        remedy: format!(
            "balance the mean pressure p of the gas by a negative `follower_pressure`, -p, on the wall between structure and gas: in \
             `structure.boundary` it has the name of the region of the gas; a larger `structure.young_modulus`; {}",
            smaller_motion(data, "a shorter `time.step`")
        ),
    })
}

/// A body crosses its cells within one slab: it is too soft, or the slab too long.
pub fn far_in_one_slab(data: &FailureData) -> Option<Cause> {
    let travel = data.bodies.as_ref()?.travel;
    (travel > 0.01 || travel.is_nan()).then(|| Cause {
        name: "body_far_in_one_slab",
        likelihood: 0.02 + 0.9 * rises(travel, 0.5),
        what: format!("the flow moves the body by {} thicknesses of cells in one slab", number(travel)),
        remedy: format!(
            "{}; a stiffer or heavier body moves less",
            smaller_motion(data, "shorten `time.step`, or let `time.adaptive` choose it")
        ),
    })
}

/// The mesh that follows a body by weights folds.
pub fn folding_weights(data: &FailureData) -> Option<Cause> {
    (data.bodies.is_some() && data.mesh.motion == Motion::Prescribed).then(|| Cause {
        name: "folding_weights",
        likelihood: 0.9,
        what: format!(
            "the mesh that follows a body by weights folds: det J / det J_0 is {} in the worst cell",
            number(data.mesh.smallest_det_j)
        ),
        remedy: "in `bodies.NAME.mesh` let the weight fall less steeply: a smaller `inner` and a larger `outer`, short of other walls, or another \
                 formula; or leave `mesh` out: then the mesh is an elastic body"
            .into(),
    })
}

/// The fluid that moves with a body is much heavier than the body. This matters most in the first slabs.
pub fn light_body(data: &FailureData) -> Option<Cause> {
    let ratio = data.bodies.as_ref()?.added_mass;
    let recent = 1.0 / (1.0 + data.attempt.slabs_done as f64 / 20.0);
    (ratio > 1.0).then(|| Cause {
        name: "light_body",
        likelihood: 0.02 + 0.9 * recent * rises(ratio, 30.0),
        what: format!("the body is light: a volume of fluid of its size weighs {} times as much", number(ratio)),
        remedy: match data.attempt.released {
            true => HELD.to_owned(),
            false => "start from rest and let the inflow grow smoothly, or drive the body and release it later; shorten `time.step`"
                .to_owned(),
        },
    })
}
