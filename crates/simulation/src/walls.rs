//! The loads of the walls of a case.

use case::Flow;
use coupled::SlabReport;
use navier_stokes::WallForce;

/// The loads of a wall at the top of a slab and during the slab, see [`navier_stokes::WallForce`] for signs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallLoads<const D: usize> {
    /// Forces, power and heat flow at the top.
    pub at_top: WallForce<D>,
    /// Impulses, work and heat.
    pub during: WallForce<D>,
}

/// The loads of every wall of `flow` in a slab.
pub fn wall_loads<const D: usize, const M: usize>(flow: &Flow<D>, report: &SlabReport<M>) -> Vec<WallLoads<D>> {
    let loads = |wall: &case::Wall<D>| {
        let top = report.fluxes.last().map(|top| WallForce::new(&top.boundaries[wall.boundary], &wall.point(top.time)));
        let during = WallForce::during_slab(&report.fluxes, wall.boundary, |t| wall.point(t));
        WallLoads { at_top: top.unwrap_or_default(), during }
    };
    flow.walls.iter().map(loads).collect()
}

/// The count of numbers of [`to_numbers`] in `dimension` dimensions: two forces, a moment, a power and a heat flow.
pub const fn numbers_per_wall(dimension: usize) -> usize {
    2 * dimension + 5
}

/// The numbers of a force, for a checkpoint.
pub fn to_numbers<const D: usize>(force: &WallForce<D>) -> Vec<f64> {
    [&force.pressure[..], &force.friction, &force.moment, &[force.power, force.heat]].concat()
}

/// Back from numbers; zero if they are invalid.
pub fn from_numbers<const D: usize>(numbers: &[f64]) -> WallForce<D> {
    let at = |i: usize| numbers.get(i).copied().unwrap_or(0.0);
    WallForce {
        pressure: std::array::from_fn(at),
        friction: std::array::from_fn(|i| at(D + i)),
        moment: std::array::from_fn(|i| at(2 * D + i)),
        power: at(2 * D + 3),
        heat: at(2 * D + 4),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forces_survive_a_checkpoint() {
        let force = WallForce::<3> {
            pressure: [1.0, 2.0, 3.0],
            friction: [4.0, 5.0, 6.0],
            moment: [7.0, 8.0, 9.0],
            power: 10.0,
            heat: 11.0,
        };
        assert_eq!(to_numbers(&force).len(), numbers_per_wall(3));
        assert_eq!(from_numbers::<3>(&to_numbers(&force)), force);
        assert_eq!(to_numbers(&WallForce::<2>::default()).len(), numbers_per_wall(2));
    }
}
