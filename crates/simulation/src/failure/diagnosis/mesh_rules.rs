//! Causes in the mesh and its motion.

use super::super::data::{FailureData, GaveUp, Mesh, Motion, Undefined};
use super::{Cause, number, rises};

/// A displacement, in sizes of the mesh, at which coordinates have lost half of their digits.
const FAR: f64 = 1e8;

/// A formula of the motion has no value.
pub fn undefined_motion(data: &FailureData) -> Option<Cause> {
    let Undefined { time, position } = data.mesh.undefined.as_ref()?;
    Some(Cause {
        name: "undefined_motion",
        likelihood: 1.0,
        what: format!("the prescribed displacement of the point at rest at {position:?} is not a number at t = {time}"),
        remedy: "correct its formula in [motion]: `sqrt` and `log` need arguments that are not negative, quotients a divisor that is not zero, \
                 tables must cover the run"
            .into(),
    })
}

/// The displacement is so large that coordinates lose the digits that the cells need.
pub fn far_away(data: &FailureData) -> Option<Cause> {
    let reach = data.mesh.reach;
    (reach > 1.0).then(|| Cause {
        name: "far_away",
        likelihood: rises(reach, FAR),
        what: format!(
            "the prescribed displacement reaches {} times the size of the mesh: coordinates keep too few digits to tell nodes apart",
            number(reach)
        ),
        remedy: "correct the formula in [motion], or move by less: by a million sizes of the mesh at most".into(),
    })
}

/// The boundary moves further than an elastic mesh can follow.
pub fn deformation(data: &FailureData) -> Option<Cause> {
    let mesh = &data.mesh;
    matches!(mesh.motion, Motion::Elastic | Motion::Graded).then(|| Cause {
        name: "deformation",
        likelihood: 0.9 * trust(mesh),
        what: format!(
            "the boundary moves further than the mesh follows: det J / det J_0 is {} in the worst cell{}",
            number(mesh.smallest_det_j),
            in_equilibrium(mesh)
        ),
        remedy: to_follow_further(data, &["move less", "make the cells between moving and fixed boundaries larger"]),
    })
}

/// The weight of det J as a sign of the motion: zero if it is NaN or the mesh is too far away.
fn trust(mesh: &Mesh) -> f64 {
    if mesh.undefined.is_some() { 0.0 } else { 1.0 - rises(mesh.reach, FAR) }
}

/// The tolerance of the equilibrium, if the case can choose it. Beside a flow the mesh is solved to round-off.
fn in_equilibrium(mesh: &Mesh) -> String {
    mesh.tolerance.filter(|_| mesh.alone).map_or_else(String::new, |tolerance| {
        format!(", in equilibrium to {} distances of nodes (`motion.elasticity.tolerance`)", number(tolerance))
    })
}

/// `remedies`, and those that are not in use yet.
fn to_follow_further(data: &FailureData, remedies: &[&str]) -> String {
    let mesh = &data.mesh;
    // Without the flow nobody knows how it moves bodies.
    let look = (!mesh.alone && data.bodies.is_none()).then_some("look at the motion alone with `stsolve motion CASE`");
    let law = mesh.tolerance.is_none().then_some("take `motion.elasticity.law = \"neo_hookean\"`");
    let graded = match mesh.motion {
        Motion::Elastic => Some("let small cells be stiffer with `motion.elasticity.stiffness`"),
        Motion::Graded => {
            Some("let them be stiffer still: a larger power or amplitude in `motion.elasticity.stiffness`")
        }
        Motion::Still | Motion::Prescribed => None,
    };
    let elastic = law.filter(|_| graded.is_some());
    look.into_iter().chain(remedies.iter().copied()).chain(elastic).chain(graded).collect::<Vec<_>>().join("; ")
}

/// The formula of the displacement maps two points to one.
pub fn folding_formula(data: &FailureData) -> Option<Cause> {
    let mesh = &data.mesh;
    (mesh.motion == Motion::Prescribed && data.bodies.is_none()).then(|| Cause {
        name: "folding_formula",
        likelihood: 0.9 * trust(mesh),
        what: format!(
            "the prescribed displacement folds the domain: det J / det J_0 is {} in the worst cell",
            number(mesh.smallest_det_j)
        ),
        remedy: "make the displacement in `motion.displacement` smaller or smoother: its slopes in space must stay below 1; \
                 `stsolve motion CASE` tells the first invalid time"
            .into(),
    })
}

/// The motion within one slab is large relative to cells.
pub fn far_in_one_slab(data: &FailureData) -> Option<Cause> {
    let travel = data.mesh.travel;
    // A nonlinear law must be solved by iteration; a linear law is not affected.
    let weight = if data.gave_up == GaveUp::Equilibrium { 0.95 } else { 0.85 };
    // Every mesh that moves has a travel: a small one is no cause.
    (travel > 0.1).then(|| Cause {
        name: "far_in_one_slab",
        likelihood: 0.05 + weight * rises(travel, 1.0),
        what: format!("the boundary moves by {} thicknesses of its cells in one slab", number(travel)),
        remedy: "shorten `time.step`, or raise `time.order`, so that polynomials in time follow the motion".into(),
    })
}

/// All cells deform alike, including the small ones.
pub fn stiffness(data: &FailureData) -> Option<Cause> {
    (data.mesh.motion == Motion::Elastic).then(|| Cause {
        name: "stiffness",
        likelihood: 0.3 + 0.3 * rises(data.mesh.aspect_ratio, 20.0),
        what: "the mesh is equally stiff everywhere, so that small cells deform as much as large ones".into(),
        remedy: "take `motion.elasticity.stiffness = { inverse_jacobian = { power = 1 } }`, or `wall_distance`".into(),
    })
}

/// The mesh has poor cells at rest.
pub fn uneven_cells(data: &FailureData) -> Option<Cause> {
    let mesh = &data.mesh;
    (mesh.evenness < 0.9).then(|| Cause {
        name: "uneven_cells",
        likelihood: 0.1 + 0.7 * (1.0 - rises(mesh.evenness, 0.1)),
        what: format!(
            "the mesh is poor before it moves: within a cell det J varies by a factor of {}, the largest aspect ratio is {}",
            number(1.0 / mesh.evenness),
            number(mesh.aspect_ratio)
        ),
        remedy: "make the cells less curved and less thin, or take more of them".into(),
    })
}

/// The material is nearly incompressible.
pub fn nearly_incompressible(data: &FailureData) -> Option<Cause> {
    let nu = data.mesh.poisson_ratio;
    (nu > 0.0).then(|| Cause {
        name: "nearly_incompressible",
        likelihood: 0.6 * rises(1.0 / (1.0 - 2.0 * nu), 50.0),
        what: format!("the mesh is nearly incompressible, with Poisson's ratio {nu}"),
        remedy: "take `motion.elasticity.poisson_ratio` between 0.2 and 0.4".into(),
    })
}

/// Cells that keep more than this part of their volume are no cause.
const SOUND: f64 = 0.3;

/// The mesh was barely valid when the flow failed. During the search for a steady flow it does not move.
pub fn nearly_inverted(data: &FailureData) -> Option<Cause> {
    let smallest = data.mesh.smallest_det_j;
    let moves = data.mesh.motion != Motion::Still && !data.attempt.steady;
    (moves && smallest <= SOUND).then(|| Cause {
        name: "nearly_inverted",
        likelihood: 0.9 * (1.0 - rises(smallest.max(0.0), 0.05)),
        what: format!("cells are nearly inverted: det J / det J_0 is down to {}", number(smallest)),
        remedy: to_follow_further(data, &["move less"]),
    })
}
