//! The motion of a boundary.

use super::vector::Vector;
use crate::expression::Program;
use coupled::BoundaryField;
use fem::VectorField;
use std::collections::BTreeMap;
use std::sync::Arc;
use tensor::{Dual, Transcendental, rotated};

/// The displacement of a boundary that moves.
#[derive(Clone, Debug, PartialEq)]
pub enum BoundaryMotion<const D: usize> {
    /// By formulas in position and time.
    Formulas(Vector<D>),
    /// As a rigid body.
    Rigid(RigidMotion<D>),
    /// Along the normals.
    Normal(NormalMotion<D>),
}

/// A displacement as a function of the position at rest.
pub type DisplacementOf<'a, const D: usize> = Box<dyn Fn(&[f64; D]) -> [f64; D] + 'a>;

impl<const D: usize> BoundaryMotion<D> {
    /// The number of operations of an evaluation of its formulas.
    pub fn operations(&self) -> usize {
        let of_step = |step: &RigidStep<D>| match step {
            RigidStep::Translate(displacement) => displacement.operations(),
            RigidStep::Rotate { angle, centre, .. } => angle.operations() + centre.operations(),
        };
        match self {
            BoundaryMotion::Formulas(displacement) => displacement.operations(),
            BoundaryMotion::Rigid(motion) => motion.steps.iter().map(of_step).sum(),
            BoundaryMotion::Normal(motion) => motion.amount.operations(),
        }
    }

    /// The displacement at time `t` as a function of the position, if it is one.
    pub fn of_position(&self, t: f64) -> Option<DisplacementOf<'_, D>> {
        match self {
            BoundaryMotion::Formulas(displacement) => Some(Box::new(move |x| displacement.evaluate(x, t))),
            BoundaryMotion::Rigid(motion) => Some(Box::new(move |x| motion.displacement(x, t))),
            BoundaryMotion::Normal(_) => None,
        }
    }
}

impl<const D: usize> BoundaryField<D> for BoundaryMotion<D> {
    fn displacement(&self, node: usize, x: &[f64; D], t: f64) -> [f64; D] {
        match self {
            BoundaryMotion::Formulas(displacement) => displacement.evaluate(x, t),
            BoundaryMotion::Rigid(motion) => motion.displacement(x, t),
            BoundaryMotion::Normal(motion) => motion.displacement(node, x, t),
        }
    }

    fn velocity(&self, node: usize, x: &[f64; D], t: f64) -> [f64; D] {
        let (x_dual, t_dual) = (x.map(Dual::from), Dual::new(t, 1.0));
        match self {
            BoundaryMotion::Formulas(displacement) => displacement.rate(x, t),
            BoundaryMotion::Rigid(motion) => motion.displacement(&x_dual, t_dual).map(|d| d.derivative),
            BoundaryMotion::Normal(motion) => motion.displacement(node, &x_dual, t_dual).map(|d| d.derivative),
        }
    }
}

/// A rigid motion: steps, applied in order.
#[derive(Clone, Debug, PartialEq)]
pub struct RigidMotion<const D: usize> {
    /// The steps.
    pub steps: Vec<RigidStep<D>>,
}

/// A step of a rigid motion.
#[derive(Clone, Debug, PartialEq)]
pub enum RigidStep<const D: usize> {
    /// x -> x + d(t).
    Translate(Vector<D>),
    /// x -> c(t) + R(t) (x - c(t)).
    Rotate {
        /// The angle of R, in radians.
        angle: Program,
        /// c.
        centre: Vector<D>,
        /// The unit vector around which R turns counter-clockwise; in two dimensions the unit vector along z.
        axis: [f64; 3],
    },
}

impl<const D: usize> RigidMotion<D> {
    /// The displacement at time `t` of the point at `x`.
    pub fn displacement<T: Transcendental>(&self, x: &[T; D], t: T) -> [T; D] {
        self.steps.iter().fold([T::from(0.0); D], |d, step| step.add_to(&d, x, t))
    }
}

impl<const D: usize> RigidStep<D> {
    /// The displacement of the point at `x` after this step, which follows a displacement `d`. Differences of positions are not taken where
    /// displacements can be added, so that no digits are lost far from the origin.
    fn add_to<T: Transcendental>(&self, d: &[T; D], x: &[T; D], t: T) -> [T; D] {
        let x: [T; D] = std::array::from_fn(|i| x[i] + d[i]);
        match self {
            RigidStep::Translate(displacement) => {
                let step = displacement.evaluate(&x, t);
                std::array::from_fn(|i| d[i] + step[i])
            }
            RigidStep::Rotate { angle, centre, axis } => {
                let c = centre.evaluate(&x, t);
                let y: [T; D] = std::array::from_fn(|i| x[i] - c[i]);
                let angle = angle.evaluate(&x, t);
                let turned = rotated(&axis.map(|k| angle * k), &y);
                std::array::from_fn(|i| d[i] + (turned[i] - y[i]))
            }
        }
    }
}

/// The displacement f(x, t, s) n along the normals of the boundary at rest.
#[derive(Clone, Debug, PartialEq)]
pub struct NormalMotion<const D: usize> {
    /// f.
    pub amount: Program,
    /// n and s at the C0 nodes of the boundary.
    pub nodes: Arc<BTreeMap<usize, NormalAndArc<D>>>,
}

/// The unit normal out of the domain, and the arc length as a fraction, 0 if the boundary is no closed curve.
pub type NormalAndArc<const D: usize> = ([f64; D], f64);

impl<const D: usize> NormalMotion<D> {
    fn displacement<T: Transcendental>(&self, node: usize, x: &[T; D], t: T) -> [T; D] {
        let Some((normal, s)) = self.nodes.get(&node) else { return [T::from(0.0); D] };
        let amount = self.amount_at(x, *s, t);
        normal.map(|n| amount * n)
    }

    /// f
    pub(super) fn amount_at<T: Transcendental>(&self, x: &[T; D], s: f64, t: T) -> T {
        let mut position = [T::from(0.0); 4];
        position[..D].copy_from_slice(x);
        position[D] = T::from(s);
        self.amount.evaluate(&position[..=D], t)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::expression::Names;

    fn of_time(text: &str) -> Program {
        Program::compile(text, &Names::constants_only().with_time()).unwrap()
    }

    fn rotate<const D: usize>(angle: &str, centre: [&str; D], axis: [f64; 3]) -> RigidStep<D> {
        RigidStep::Rotate { angle: of_time(angle), centre: Vector::new(centre.map(of_time)), axis }
    }

    #[test]
    fn steps_follow_each_other() {
        let translate = RigidStep::Translate(Vector::new([of_time("0"), of_time("t")]));
        let heave_then_pitch =
            RigidMotion { steps: vec![translate.clone(), rotate("pi/2*t", ["1", "t"], [0.0, 0.0, 1.0])] };
        let pitch_then_heave = RigidMotion { steps: vec![rotate("pi/2*t", ["1", "0"], [0.0, 0.0, 1.0]), translate] };
        // (3, 0) up to (3, 1), a quarter turn about (1, 1): (1, 3). The other order, about the point at rest, is the same.
        for motion in [heave_then_pitch, pitch_then_heave] {
            let d = motion.displacement(&[3.0, 0.0], 1.0);
            assert!((d[0] + 2.0).abs() < 1e-15 && (d[1] - 3.0).abs() < 1e-15, "{d:?}");
            assert_eq!(motion.displacement(&[3.0, 0.7], 0.0), [0.0; 2]);
        }
    }

    #[test]
    fn rotations_in_space_turn_about_their_axis() {
        let diagonal = [3.0_f64.sqrt().recip(); 3];
        let motion = RigidMotion { steps: vec![rotate("2*pi/3", ["0", "0", "0"], diagonal)] };
        let d = motion.displacement(&[1.0, 2.0, 3.0], 0.0);
        // A third of a turn about the diagonal: x -> y -> z -> x.
        assert!(d.iter().zip([2.0, -1.0, -1.0]).all(|(d, e)| (d - e).abs() < 1e-14), "{d:?}");
        let about_z = RigidMotion { steps: vec![rotate("t", ["0", "0", "0"], [0.0, 0.0, 1.0])] };
        let (d, e) = (about_z.displacement(&[1.0, 0.5, 4.0], 0.3), {
            let plane = RigidMotion { steps: vec![rotate("t", ["0", "0"], [0.0, 0.0, 1.0])] };
            plane.displacement(&[1.0, 0.5], 0.3)
        });
        assert_eq!(d, [e[0], e[1], 0.0]);
        let [cos, sin] = [0.3_f64.cos(), 0.3_f64.sin()];
        assert!((e[0] - (cos - 0.5 * sin - 1.0)).abs() < 1e-15 && (e[1] - (sin + 0.5 * cos - 0.5)).abs() < 1e-15);
    }
}
