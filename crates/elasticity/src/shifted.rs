//! Systems with stiffness and mass, K + m M, and their complex rotations.
//!
//! Let M_lo use the same corner points, so that it is diagonal. The low-order matrix K_lo + m M_lo is spectrally equivalent to K + m M
//! as K_lo is to K. With m = |s|^2 and s^2 = m e^(i theta) it also preconditions the complex system
//!
//! ```text
//! (K + s^2 M) y = c                                                                                            (complex)
//! ( cos(theta/2) (K + m M) + i sin(theta/2) (m M - K) ) y = e^(-i theta/2) c                                   (rotated)
//! ```
//!
//! Rotated by half the angle, the real part is definite and a multiple of the factored matrix. The eigenvalues of (K + m M)^{-1} (m
//! M - K) lie in [-1, 1]. So the preconditioned spectrum lies on a straight line past the origin, and GMRES gains a factor
//! tan(theta/4) per iteration on any mesh.

use crate::low_order::LowOrderInverse;
use crate::{ElasticityError, Structure};
use newton_krylov::inner_product::{Euclidean, InnerProduct};
use newton_krylov::operator::LinearSystem;
use newton_krylov::{cg, fgmres};

/// Iterations after which a solve gives up: several times the worst case.
const MAX_ITERATIONS: usize = 500;

/// A shift m and the factored low-order K + m M.
pub(crate) struct Shifted<const D: usize> {
    pub(crate) m: f64,
    /// A mass of every node in addition to the mass of the structure; may be empty.
    pub(crate) layer: Vec<[[f64; D]; D]>,
    /// The displacement at which K is taken; empty for a linear law.
    pub(crate) position: Vec<f64>,
    /// Whether K omits the part proportional to the stress, see [`Structure::apply_material_stiffness_at`].
    pub(crate) material: bool,
    pub(crate) low_order: LowOrderInverse<D>,
}

impl<const D: usize> Shifted<D> {
    /// out = K x on all entries.
    pub(crate) fn apply_stiffness(&self, structure: &Structure<D>, x: &[f64], out: &mut [f64]) {
        if self.material {
            structure.apply_material_stiffness_at(&self.position, x, out);
        } else {
            structure.apply_stiffness_at(&self.position, x, out);
        }
    }

    /// Solves (K + m M) x = b at free entries from x = 0 by CG to |residual| <= `tolerance` |b|. b must vanish at fixed entries; then x
    /// does too. Returns the iterations. After an error x still is an approximation.
    pub(crate) fn solve(
        &self,
        structure: &Structure<D>,
        b: &[f64],
        x: &mut [f64],
        tolerance: f64,
    ) -> Result<usize, ElasticityError> {
        x.fill(0.0);
        let mut system = Real { structure, shifted: self, inertia: vec![0.0; b.len()] };
        let settings =
            cg::Settings { relative_tolerance: tolerance, max_iterations: MAX_ITERATIONS, ..Default::default() };
        let solved = cg::solve(&mut system, b, x, &settings, &mut cg::Workspace::default());
        if solved.is_err() && x.iter().all(|x| *x == 0.0) {
            // K(d) of a compressed body need not be definite. The low-order matrix always is.
            self.low_order.apply(b, x);
        }
        Ok(solved?.iterations)
    }

    /// Solves (complex) at free entries from y = 0 by FGMRES on (rotated), `theta` in [0, pi). In `c` and `y` the real parts come
    /// first, then the imaginary parts. Returns the iterations.
    pub(crate) fn solve_complex(
        &self,
        structure: &Structure<D>,
        theta: f64,
        c: &[f64],
        y: &mut [f64],
        tolerance: f64,
    ) -> Result<usize, ElasticityError> {
        y.fill(0.0);
        let (sin, cos) = (0.5 * theta).sin_cos();
        let (re, im) = c.split_at(c.len() / 2);
        let rotated_re = re.iter().zip(im).map(|(re, im)| cos * re + sin * im);
        let rotated_im = re.iter().zip(im).map(|(re, im)| cos * im - sin * re);
        let rotated: Vec<f64> = rotated_re.chain(rotated_im).collect();
        let mut system = Rotated { structure, shifted: self, cos, sin, work: vec![0.0; 2 * c.len()] };
        let settings = fgmres::Settings {
            relative_tolerance: tolerance,
            restart: 100,
            max_iterations: MAX_ITERATIONS,
            ..Default::default()
        };
        match fgmres::solve(&mut system, &rotated, y, &settings, &mut fgmres::Workspace::default()) {
            Ok(report) => Ok(report.iterations),
            Err(error @ fgmres::Error::NotFinite(_)) => Err(error.into()),
            // y is as accurate as round-off allows; the residual of the slab shows whether this is enough.
            Err(error) => Ok(error.report().iterations),
        }
    }
}

/// The cost of products and preconditioners within these solves. Iterations open a span of their own, which leaves them out.
fn timed() -> tracing::span::EnteredSpan {
    tracing::trace_span!(target: "cost", "elasticity").entered()
}

/// K + m M at free entries.
struct Real<'a, const D: usize> {
    structure: &'a Structure<D>,
    shifted: &'a Shifted<D>,
    inertia: Vec<f64>,
}

impl<const D: usize> LinearSystem for Real<'_, D> {
    fn multiply(&mut self, x: &[f64], y: &mut [f64]) {
        let _timed = timed();
        self.shifted.apply_stiffness(self.structure, x, y);
        self.structure.apply_mass_with(&self.shifted.layer, x, &mut self.inertia);
        y.iter_mut().zip(&self.inertia).for_each(|(y, inertia)| *y += self.shifted.m * inertia);
        self.structure.at_fixed(y, |_| 0.0);
    }
    fn precondition(&mut self, r: &[f64], z: &mut [f64]) {
        let _timed = timed();
        self.shifted.low_order.apply(r, z);
    }
    fn inner_product(&self) -> &dyn InnerProduct {
        &Euclidean
    }
}

/// (rotated) at free entries, as a real system for real and imaginary part.
struct Rotated<'a, const D: usize> {
    structure: &'a Structure<D>,
    shifted: &'a Shifted<D>,
    cos: f64,
    sin: f64,
    work: Vec<f64>,
}

impl<const D: usize> LinearSystem for Rotated<'_, D> {
    fn multiply(&mut self, x: &[f64], y: &mut [f64]) {
        let _timed = timed();
        let (n, m) = (x.len() / 2, self.shifted.m);
        let (forces, inertia) = self.work.split_at_mut(2 * n);
        for part in [0..n, n..2 * n] {
            self.shifted.apply_stiffness(self.structure, &x[part.clone()], &mut forces[part.clone()]);
            self.structure.apply_mass_with(&self.shifted.layer, &x[part.clone()], &mut inertia[part]);
        }
        let (re, im) = y.split_at_mut(n);
        for i in 0..n {
            let sum = |i: usize| m * inertia[i] + forces[i];
            let difference = |i: usize| m * inertia[i] - forces[i];
            re[i] = self.cos * sum(i) - self.sin * difference(n + i);
            im[i] = self.cos * sum(n + i) + self.sin * difference(i);
        }
        self.structure.at_fixed(re, |_| 0.0);
        self.structure.at_fixed(im, |_| 0.0);
    }
    fn precondition(&mut self, r: &[f64], z: &mut [f64]) {
        let _timed = timed();
        let n = r.len() / 2;
        for part in [0..n, n..2 * n] {
            self.shifted.low_order.apply(&r[part.clone()], &mut z[part]);
        }
    }
    fn inner_product(&self) -> &dyn InnerProduct {
        &Euclidean
    }
}
