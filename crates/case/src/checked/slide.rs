//! The sliding of a wall in its own plane.

use super::openings::NodeAndNormal;
use crate::checker::{Checked, Checker};
use crate::key::Key;
use crate::raw;
use crate::vector::Vector;
use tensor::{dot, norm};

/// The fraction of its velocity with which a wall may leave its plane: a circle of cells of order 3 deviates by 1e-2.
const OUT_OF_PLANE: f64 = 2e-2;

/// Checks that a boundary with these `nodes` at `t` slides along itself then if its condition `raw`, given at `key`, lets it slide. The kernels take
/// only the tangential part of the velocity, so another part would be ignored silently.
pub(super) fn check<const D: usize>(
    checker: &Checker<'_>,
    key: &Key,
    raw: &raw::Condition,
    nodes: &[NodeAndNormal<D>],
    t: f64,
) -> Checked<()> {
    let (name, slide) = match raw {
        raw::Condition::AdiabaticWall(wall) => ("adiabatic_wall", &wall.slide),
        raw::Condition::IsothermalWall(wall) => ("isothermal_wall", &wall.slide),
        _ => return Ok(()),
    };
    let Some(slide) = slide else { return Ok(()) };
    let key = key.child(name).child("slide");
    let slide: Vector<D> = checker.formulas(&key, slide)?;
    let velocity = |x: &[f64; D]| slide.evaluate(x, t);
    let leaves = |(x, normal): &&NodeAndNormal<D>| {
        let velocity = velocity(x);
        dot(&velocity, normal).abs() > OUT_OF_PLANE * norm(&velocity)
    };
    let Some((x, normal)) = nodes.iter().find(leaves) else { return Ok(()) };
    let problem = format!(
        "the wall does not slide in its plane: at {x:?} and t = {t}, where its normal is {normal:.6?}, it would move by {:.3e} along that",
        dot(&velocity(x), normal)
    );
    let accepted = "a velocity along the wall everywhere, to 2 %: a coarse circle needs a higher `mesh.order` or more cells; a wall that moves otherwise is given in \
                    [motion]";
    Err(checker.combination(&key, &problem, accepted))
}
