//! Forces on walls, the power of these forces, and heat.
//!
//! **The sign** of all of them refers to the action of the fluid on the wall. The wall takes up the momentum and energy that
//! leave the domain through it, so that
//!
//! ```text
//! F_w = int (p n - tau n) dS,   M_w = int (x - x_p) x (p n - tau n) dS,   P_w = int (p n - tau n) . w_b dS,
//! Q_w = - int kappa T_,n dS                                                                                   (force)
//! ```
//!
//! with n out of the fluid, x_p a point that may move with the body, and w_b the velocity of the wall. F_w and M_w are what the scheme
//! takes from the momentum of the gas; P_w + Q_w is taken from its energy. The impulse, the work and the heat over some time are the
//! integrals in the quadrature of the scheme.
//!
//! At the top of a slab w_b is the prescribed velocity: there P_w = F_w . h' + M_w . theta' of a rigid body to round-off. During a slab it is
//! the velocity of the mesh, a polynomial in time, so that work and heat are the energy that leaves the gas, to round-off.

use fem::{BoundaryFlux, FluxPart, FluxesAt};
use std::ops::AddAssign;
use tensor::cross;

/// Force, moment, power and heat of a wall at one time; or their integral over some time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallForce<const D: usize> {
    /// The part of F_w that pressure exerts.
    pub pressure: [f64; D],
    /// The part of F_w that friction exerts.
    pub friction: [f64; D],
    /// M_w. In 2-D only the last component is not zero; positive is counter-clockwise.
    pub moment: [f64; 3],
    /// P_w; over some time the work.
    pub power: f64,
    /// Q_w; over some time the heat.
    pub heat: f64,
}

impl<const D: usize> Default for WallForce<D> {
    fn default() -> Self {
        WallForce { pressure: [0.0; D], friction: [0.0; D], moment: [0.0; 3], power: 0.0, heat: 0.0 }
    }
}

impl<const D: usize> WallForce<D> {
    /// The force of the flux through the wall, with the moment about `point`.
    pub fn new<const M: usize>(flux: &BoundaryFlux<M>, point: &[f64; D]) -> Self {
        let force = |flux: &FluxPart<M>| std::array::from_fn(|i| flux.force[i]);
        let (pressure, friction) = (force(&flux.inviscid), force(&flux.viscous));
        let mut wall = WallForce { pressure, friction, moment: [0.0; 3], power: flux.work, heat: flux.heat };
        wall.moment = flux.moment_about(&std::array::from_fn(|i| point.get(i).copied().unwrap_or(0.0)));
        wall
    }

    /// Impulse, angular impulse, work and heat over a slab on boundary number `boundary`, about a point that moves.
    pub fn during_slab<const M: usize>(
        fluxes: &[FluxesAt<M>],
        boundary: usize,
        point: impl Fn(f64) -> [f64; D],
    ) -> Self {
        let mut sum = WallForce::default();
        for at in fluxes {
            sum += WallForce::new(&at.boundaries[boundary].scaled(at.weight), &point(at.time));
        }
        sum
    }

    /// F_w.
    pub fn force(&self) -> [f64; D] {
        std::array::from_fn(|i| self.pressure[i] + self.friction[i])
    }
}

impl<const D: usize> AddAssign for WallForce<D> {
    fn add_assign(&mut self, other: Self) {
        for i in 0..D {
            self.pressure[i] += other.pressure[i];
            self.friction[i] += other.friction[i];
        }
        for i in 0..3 {
            self.moment[i] += other.moment[i];
        }
        self.power += other.power;
        self.heat += other.heat;
    }
}

/// The reference values that make forces dimensionless:
///
/// ```text
/// C_D = F_w . e_D / (q A),  C_L = F_w . (e_z x e_D) / (q A),  C_M = M_w . a / (q A L),  q = rho U^2 / 2            (coefficients)
/// ```
///
/// In space e_z x e_D is scaled to unit length. Lift is to the left of drag. A moment about a = e_z is positive counter-clockwise. A moment
/// about a = -e_z is positive if it raises the nose, which is upstream, towards the lift.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForceScales<const D: usize> {
    /// q.
    pub dynamic_pressure: f64,
    /// A; in 2-D per unit span, hence a length.
    pub area: f64,
    /// L.
    pub length: f64,
    /// e_D, of unit length.
    pub drag_direction: [f64; D],
    /// a, of unit length: moments about it count as positive by the right-hand rule.
    pub moment_axis: [f64; 3],
}

/// (coefficients)
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coefficients {
    /// C_D.
    pub drag: f64,
    /// C_L.
    pub lift: f64,
    /// C_M.
    pub moment: f64,
}

impl<const D: usize> ForceScales<D> {
    /// The coefficients of `wall`.
    pub fn coefficients(&self, wall: &WallForce<D>) -> Coefficients {
        let (force, along) = (wall.force(), &self.drag_direction);
        let scale = self.dynamic_pressure * self.area;
        // In space the part of e_D in the x-y plane need not have unit length. A drag along z leaves no direction for the lift.
        let in_plane = if D == 2 { 1.0 } else { along[0].hypot(along[1]) };
        let lift = if in_plane > 0.0 { cross(along, &force)[2] / in_plane } else { 0.0 };
        Coefficients {
            drag: tensor::dot(&force, along) / scale,
            lift: lift / scale,
            moment: self.moment(wall) / (scale * self.length),
        }
    }

    /// M_w . a
    pub fn moment(&self, wall: &WallForce<D>) -> f64 {
        tensor::dot(&wall.moment, &self.moment_axis)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flux(momentum: [f64; 2], at: [f64; 2]) -> BoundaryFlux<4> {
        let components = [0.0, momentum[0], momentum[1], 3.5];
        let moment = [0.0, 0.0, at[0] * momentum[1] - at[1] * momentum[0]];
        let inviscid = FluxPart { components, force: [momentum[0], momentum[1], 0.0], moment };
        BoundaryFlux { inviscid, work: 3.0, heat: 0.5, ..BoundaryFlux::default() }
    }

    #[test]
    fn the_moment_follows_the_point() {
        // A force (2, 5) that acts at (4, 1), about (3, -1): 1 * 5 - 2 * 2.
        let wall = WallForce::new(&flux([2.0, 5.0], [4.0, 1.0]), &[3.0, -1.0]);
        assert_eq!((wall.force(), wall.moment, wall.power, wall.heat), ([2.0, 5.0], [0.0, 0.0, 1.0], 3.0, 0.5));
    }

    #[test]
    fn impulses_follow_the_moving_point_in_the_quadrature_of_the_slab() {
        let at = |time: f64, weight| FluxesAt { time, weight, boundaries: vec![flux([0.0, 2.0], [time, 0.0])] };
        // The top has no weight.
        let fluxes = [at(1.0, 0.25), at(2.0, 0.75), at(3.0, 0.0)];
        let impulse = WallForce::<2>::during_slab(&fluxes, 0, |t| [0.5 * t, 7.0]);
        assert_eq!(impulse.force(), [0.0, 2.0]);
        assert_eq!(impulse.moment[2], 2.0 * (0.25 * 0.5 + 0.75));
        assert_eq!((impulse.power, impulse.heat), (3.0, 0.5));
    }

    #[test]
    fn drag_is_along_the_stream_and_lift_to_its_left() {
        let drag_direction = [0.6, 0.8];
        let scales =
            ForceScales { dynamic_pressure: 0.5, area: 2.0, length: 4.0, drag_direction, moment_axis: [0.0, 0.0, 1.0] };
        let (pressure, friction) = ([0.6, 0.8], [-0.8, 0.6]);
        let wall = WallForce { pressure, friction, moment: [0.0, 0.0, 2.0], ..WallForce::default() };
        let Coefficients { drag, lift, moment } = scales.coefficients(&wall);
        assert!((drag - 1.0).abs() < 1e-15 && (lift - 1.0).abs() < 1e-15 && moment == 0.5);
    }

    /// The lift was shortened where the drag is not in the x-y plane.
    #[test]
    fn lift_has_a_unit_direction_in_space() {
        let lift = |drag_direction: [f64; 3]| {
            let scales = ForceScales::<3> {
                dynamic_pressure: 1.0,
                area: 1.0,
                length: 1.0,
                drag_direction,
                moment_axis: [0.0, 0.0, 1.0],
            };
            let wall = WallForce { pressure: [-1.0, 0.0, 0.0], ..WallForce::default() };
            scales.coefficients(&wall).lift
        };
        let third = 3.0_f64.sqrt().recip();
        assert!((lift([third; 3]) - 0.5_f64.sqrt()).abs() < 1e-15);
        assert_eq!(lift([0.0, 0.0, 1.0]), 0.0);
    }

    /// A force along the lift that acts upstream of the point raises the nose, for any stream.
    #[test]
    fn a_moment_about_minus_z_raises_the_nose() {
        for along in [[1.0, 0.0], [0.6, 0.8], [-1.0, 0.0], [0.0, -1.0]] {
            let (nose, lift) = ([-along[0], -along[1]], [-along[1], along[0]]);
            let wall = WallForce::<2>::new(&flux(lift, nose), &[0.0; 2]);
            let scales = |z| ForceScales {
                dynamic_pressure: 1.0,
                area: 1.0,
                length: 1.0,
                drag_direction: along,
                moment_axis: [0.0, 0.0, z],
            };
            assert!((scales(-1.0).coefficients(&wall).moment - 1.0).abs() < 1e-15, "{along:?}");
            assert!((scales(1.0).coefficients(&wall).moment + 1.0).abs() < 1e-15, "{along:?}");
        }
    }
}
