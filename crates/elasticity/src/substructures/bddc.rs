//! Balancing domain decomposition by constraints (Dohrmann 2003) with deluxe scaling (Dohrmann & Widlund 2013).
//!
//! With the restriction R_b to the interface of a block, and for every piece F of the interface the part S_b,F of S_b:
//!
//! ```text
//! P^{-1} = sum_b R_b^T D_b (Phi_b S_c^{-1} Phi^T + K_b) D_b^T R_b                                                    (bddc)
//! D_b = (sum_j S_j,F)^{-1} S_b,F on every piece F                                                                  (deluxe)
//! ```
//!
//! K_b inverts S_b where the constraints vanish: values at vertices, rigid motions of edges and faces, and for faces the eigenvectors
//! that are dear (`constraints`). Phi_b extends values of constraints with the least energy, S_c is their energy.

mod coarse;
mod constraints;
mod local;
mod scaling;

use crate::ElasticityError;
use crate::substructures::exchange::Exchange;
use crate::substructures::interface::Interface;
use coarse::Coarse;
use constraints::Constraints;
use faer::{Mat, Side};
use fem::parallel::{self, Grain};
use local::Local;
use scaling::Scaling;

/// The preconditioner of the interface: what belongs to own blocks, and the coarse problem.
pub(super) struct Bddc<const D: usize> {
    locals: Vec<Local>,
    scaling: Scaling<D>,
    coarse: Coarse,
}

impl<const D: usize> Bddc<D> {
    /// From the S_b of the own blocks. A collective call.
    pub(super) fn new(
        interface: &Interface<D>,
        exchange: &Exchange,
        own: Vec<Mat<f64>>,
    ) -> Result<Self, ElasticityError> {
        let (scaling, faces) = Scaling::new(interface, exchange, &own)?;
        let constraints = Constraints::new(interface, exchange, &faces)?;
        let first = exchange.first_own();
        let mut own = own;
        let local = |place: usize, s: &mut [Mat<f64>]| {
            Local::new(std::mem::replace(&mut s[0], Mat::new()), interface, first + place, &constraints)
        };
        let locals = parallel::map_chunks(&mut own, 1, &local).into_iter().collect::<Result<Vec<_>, _>>();
        let (locals, energies): (Vec<_>, Vec<_>) = exchange.agree(locals)?.into_iter().unzip();
        let coarse = Coarse::new(&constraints, exchange, &energies)?;
        Ok(Bddc { locals, scaling, coarse })
    }

    /// u = P^{-1} u by (bddc). A collective call.
    pub(super) fn apply(&self, interface: &Interface<D>, exchange: &Exchange, u: &mut [f64]) {
        let first = exchange.first_own();
        let r = self.scaling.over_sums(interface, u);
        let count = self.locals.len();
        let share = |place: usize| self.scaling.share(interface, first + place, |k| &r[&k]);
        let shares = parallel::map(count, Grain::Any, &share);
        let loads = parallel::map(count, Grain::Any, &|place| self.locals[place].load(&shares[place]));
        let values = self.coarse.solve(exchange, loads);
        let correct = |place: usize| {
            let x = self.locals[place].solve(&shares[place], &self.coarse.of_block(first + place, &values));
            let parts = interface.parts(first + place, &x);
            self.scaling.share(interface, first + place, |k| &parts[&k])
        };
        let corrections =
            exchange.gather(parallel::map(count, Grain::Any, &correct), |b| interface.of_block[b].len() * D);
        u.fill(0.0);
        corrections.iter().enumerate().for_each(|(block, part)| interface.add_part(block, part, u));
        let whole = self.scaling.over_sums(interface, u);
        self.scaling.collect(interface, exchange, &whole, u);
    }

    pub(super) fn bytes(&self) -> usize {
        self.locals.iter().map(Local::bytes).sum::<usize>() + self.scaling.bytes() + self.coarse.bytes()
    }
}

/// The Cholesky factor of a matrix, whose lower triangle is read.
fn cholesky(matrix: &Mat<f64>, of: &str) -> Result<faer::linalg::solvers::Llt<f64>, ElasticityError> {
    matrix.llt(Side::Lower).map_err(|cause| ElasticityError::NotDefinite { cause: format!("{of}: {cause:?}") })
}

/// The rows and columns `of` of a matrix.
fn submatrix(matrix: &Mat<f64>, of: &[usize]) -> Mat<f64> {
    Mat::from_fn(of.len(), of.len(), |i, j| matrix[(of[i], of[j])])
}
