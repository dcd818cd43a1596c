//! What the walls of a case feel.

use crate::case::Flow;
use coupled::SlabReport;
use navier_stokes::WallForce;

/// What a wall feels at the top of a slab and during the slab, see [`navier_stokes::WallForce`] for signs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Felt<const D: usize> {
    /// Forces and power at the top.
    pub at_top: WallForce<D>,
    /// Impulses and work.
    pub during: WallForce<D>,
}

/// For every wall of `flow` what it felt in a slab.
pub fn felt<const D: usize, const M: usize>(flow: &Flow<D>, report: &SlabReport<M>) -> Vec<Felt<D>> {
    let felt = |wall: &crate::case::Wall<D>| {
        let top = report.fluxes.last().map(|top| WallForce::new(&top.boundaries[wall.boundary], &wall.point(top.time)));
        let during = WallForce::during_slab(&report.fluxes, wall.boundary, |t| wall.point(t));
        Felt { at_top: top.unwrap_or_default(), during }
    };
    flow.walls.iter().map(felt).collect()
}

/// Numbers of a force, to be kept in a checkpoint.
pub fn to_numbers<const D: usize>(force: &WallForce<D>) -> Vec<f64> {
    [&force.pressure[..], &force.friction, &force.moment, &[force.power]].concat()
}

/// Back from numbers; zero if they are none.
pub fn from_numbers<const D: usize>(numbers: &[f64]) -> WallForce<D> {
    let at = |i: usize| numbers.get(i).copied().unwrap_or(0.0);
    WallForce {
        pressure: std::array::from_fn(at),
        friction: std::array::from_fn(|i| at(D + i)),
        moment: std::array::from_fn(|i| at(2 * D + i)),
        power: at(2 * D + 3),
    }
}
