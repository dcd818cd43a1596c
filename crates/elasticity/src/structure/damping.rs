//! The damping of a structure.

use super::Structure;
use crate::operator::Operator;

/// The damping C = alpha M + beta K of Rayleigh. If the law is not linear, K is the one of (viscous) in `law`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Damping {
    /// alpha
    pub mass: f64,
    /// beta
    pub stiffness: f64,
}

impl<const D: usize> Structure<D> {
    /// The same body with `damping`.
    pub fn with_damping(self, damping: Damping) -> Self {
        Structure { damping, ..self }
    }

    /// The damping.
    pub fn damping(&self) -> Damping {
        self.damping
    }

    /// out += C v at the displacement `d`.
    pub(crate) fn add_damping(&self, d: &[f64], v: &[f64], out: &mut [f64]) {
        self.add_damping_by(v, out, |operator, out| operator.viscous_forces(d, v, out));
    }

    /// out += the derivative of C v at the displacement and velocity `at` along the displacement and velocity `along`.
    pub(crate) fn add_damping_product(&self, at: (&[f64], &[f64]), along: (&[f64], &[f64]), out: &mut [f64]) {
        self.add_damping_by(along.1, out, |operator, out| operator.viscous_product(at, along, out));
    }

    /// out += alpha M v + beta K v. If the law is not linear, `viscous` gives K v.
    fn add_damping_by(&self, v: &[f64], out: &mut [f64], viscous: impl Fn(&Operator<D>, &mut [f64])) {
        let Damping { mass, stiffness } = self.damping;
        let mut force = vec![0.0; out.len()];
        let mut add = |factor: f64, apply: &dyn Fn(&mut [f64])| {
            if factor != 0.0 {
                apply(&mut force);
                out.iter_mut().zip(&force).for_each(|(out, force)| *out += factor * force);
            }
        };
        add(mass, &|force| self.apply_mass(v, force));
        if self.law().is_linear() {
            return add(stiffness, &|force| self.apply_stiffness(v, force));
        }
        for operator in [&self.operator].into_iter().chain(&self.excess) {
            add(stiffness, &|force| viscous(operator, force));
        }
    }
}
