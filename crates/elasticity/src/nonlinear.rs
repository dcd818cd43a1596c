//! Newton's method for the equations of an elastic body.
//!
//! The equilibrium of a mesh, the equilibrium of a structure, and its motion in a slab are [`ElasticEquations`]. One [`Problem`] hands each
//! of them to the driver of `newton_krylov`.

use newton_krylov::inner_product::{Euclidean, InnerProduct};
use newton_krylov::newton::{self, Report, Settings, Workspace};
use newton_krylov::problem::{Field, Inadmissible, NonlinearProblem};
use newton_krylov::pseudo_time;

/// The equations R(x) = 0 of an elastic body, with the derivative of R and an approximate inverse of that.
pub(crate) trait ElasticEquations {
    /// The name of the equations in reports.
    const FIELD: &'static str;

    /// r := R(x)
    ///
    /// # Errors
    /// [`Inadmissible`] if R is not defined at x; `r` is then meaningless.
    fn residual(&self, x: &[f64], r: &mut [f64]) -> Result<(), Inadmissible>;

    /// Prepares the preconditioner for the derivative at x. By default it serves all x.
    fn linearise(&mut self, _x: &[f64]) {}

    /// out := (dR/dx)(x) w
    fn product(&self, x: &[f64], w: &[f64], out: &mut [f64]);

    /// w := P^-1 r, where P approximates dR/dx. It need not be exact: a solve that has not converged still gives a good direction.
    fn precondition(&mut self, r: &[f64], w: &mut [f64]);

    /// w := the first guess of the increment for the right-hand side `r`. By default it is zero.
    fn guess(&mut self, _r: &[f64], w: &mut [f64]) {
        w.fill(0.0);
    }

    /// The inner product of residuals. By default they are forces, and it is Euclidean.
    fn inner_product(&self) -> &dyn InnerProduct {
        &Euclidean
    }

    /// The norm in which the line search compares residuals. By default it is that of the increment P^-1 r: a slender body is stiff along
    /// its axis and soft across it.
    fn merit(&mut self, r: &[f64]) -> f64 {
        let mut increment = vec![0.0; r.len()];
        self.precondition(r, &mut increment);
        Euclidean.norm(&increment)
    }

    /// The rounding of |R(x)|; `None` if it is not known.
    fn round_off(&self, _x: &[f64]) -> Option<f64> {
        None
    }
}

/// Replaces the guess `x` by the solution of `equations`, without pseudo-time. Relative tolerances refer to the norm `reference`.
pub(crate) fn solve<E: ElasticEquations>(
    equations: &mut E,
    x: &mut [f64],
    reference: f64,
    settings: Settings,
) -> Result<Report, newton::Error> {
    let pseudo_time = pseudo_time::Settings { restart_inverse: 0.0, max_rejections: 0, ..Default::default() };
    let settings = Settings { pseudo_time, ..settings };
    let fields = [Field { name: E::FIELD, range: 0..x.len() }];
    let mut problem = Problem { equations, fields, point: x.to_vec() };
    newton::solve(&mut problem, x, Some(&[reference]), &settings, &mut Workspace::default())
}

/// Equations as one field of a nonlinear problem.
struct Problem<'a, E> {
    equations: &'a mut E,
    fields: [Field; 1],
    /// The x at which R is differentiated.
    point: Vec<f64>,
}

impl<E: ElasticEquations> NonlinearProblem for Problem<'_, E> {
    fn len(&self) -> usize {
        self.point.len()
    }
    fn fields(&self) -> &[Field] {
        &self.fields
    }
    fn inner_product(&self) -> &dyn InnerProduct {
        self.equations.inner_product()
    }
    fn residual(&mut self, x: &[f64], r: &mut [f64]) -> Result<(), Inadmissible> {
        self.equations.residual(x, r)
    }
    fn linearise(&mut self, x: &[f64], _inverse_pseudo_time: &[f64]) -> Result<(), Inadmissible> {
        self.point.copy_from_slice(x);
        self.equations.linearise(x);
        Ok(())
    }
    fn guess_increment(&mut self, right_side: &[f64], increment: &mut [f64]) {
        self.equations.guess(right_side, increment);
    }
    fn jacobian_product(&mut self, direction: &[f64], out: &mut [f64]) {
        self.equations.product(&self.point, direction, out);
    }
    fn add_pseudo_time(&mut self, _direction: &[f64], _out: &mut [f64]) {}
    fn precondition(&mut self, r: &[f64], out: &mut [f64]) {
        self.equations.precondition(r, out);
    }
    fn merit(&mut self, r: &[f64]) -> f64 {
        self.equations.merit(r)
    }
    fn largest_step(&mut self, _x: &[f64], _increment: &[f64]) -> f64 {
        1.0
    }
    fn round_off(&mut self, x: &[f64]) -> Option<Vec<f64>> {
        self.equations.round_off(x).map(|norm| vec![norm])
    }
}
