//! Integrals over the flow: columns of history.csv.
//!
//! ```text
//! K = int rho v . v / 2 dx,     E = int rho omega . omega / 2 dx,     S = int rho ln(p / rho^gamma) dx                (integrals)
//! P = int rho v dx
//! ```
//!
//! The kinetic energy K, the enstrophy E of the vorticity omega, the entropy S, and the momentum P. They are integrated by Gauss points, three for two
//! nodes. `inner_product::sum` adds the cells, so the sums have the same bits for any number of threads.

use case::{Case, Field, Flow, Integral};
use coupled::FlowMarch;
use fem::Sampler;
use fem::parallel::{self, Grain};
use navier_stokes::{Gas, Primitive};
use newton_krylov::inner_product;
use report::fields::{self, CellSample, Medium};

/// The integrals that `case` asks for, over each cell of the present flow of all ranks, `[cell][integral]`, on rank 0. A collective call.
pub fn of_run<const D: usize, const M: usize>(case: &Case<D>, flow: &Flow<D>, march: &FlowMarch<D, M>) -> Vec<f64> {
    let (state, system, wanted) = (&march.state, &march.solver.system, &case.output.integrals);
    let (share, one) = (&system.flow.operator.share, system.flow.operator.layout.at_one_time());
    let mover = &system.mesh.mover;
    let integrals = FlowIntegrals::<D> {
        orders: [flow.order, case.mesh.order()],
        cells: one.cells,
        positions: &|cell| mover.cell_positions(share.own[cell], &state.d),
        state: &|cell| &state.u[one.cell(cell)],
        gas: &flow.law.gas,
    };
    share.join(&integrals.of_cells::<M>(wanted).concat())
}

/// The sums of `count` integrals over all cells.
pub fn sums(of_cells: &[f64], count: usize) -> Vec<f64> {
    let sum = |k: usize| inner_product::sum(&of_cells.iter().skip(k).step_by(count).copied().collect::<Vec<f64>>());
    (0..count).map(sum).collect()
}

/// The flow of a run at one time.
struct FlowIntegrals<'a, const D: usize> {
    /// Nodes per direction of flow and mesh.
    orders: [usize; 2],
    /// Number of cells.
    cells: usize,
    /// The positions of the nodes of a cell, `[component][node]`.
    positions: &'a (dyn Fn(usize) -> Vec<f64> + Sync),
    /// The state of a cell, `[component][node]`.
    state: &'a (dyn Fn(usize) -> &'a [f64] + Sync),
    /// The gas.
    gas: &'a Gas,
}

impl<const D: usize> FlowIntegrals<'_, D> {
    /// The `wanted` integrals over each cell.
    fn of_cells<const M: usize>(&self, wanted: &[Integral]) -> Vec<Vec<f64>> {
        let rule = basis::gauss((3 * self.orders[0]).div_ceil(2).max(self.orders[1]));
        let sampler = Sampler::<D>::new(self.orders[0], self.orders[1], &rule.points);
        let weights = rule.tensor_weights(D);
        let of_cell = |cell: usize| self.of_cell::<M>(cell, &sampler, &weights, wanted);
        parallel::map(self.cells, Grain::Any, &of_cell)
    }

    fn of_cell<const M: usize>(
        &self,
        cell: usize,
        sampler: &Sampler<D>,
        weights: &[f64],
        wanted: &[Integral],
    ) -> Vec<f64> {
        let (nodal, coefficients) = ((self.positions)(cell), (self.state)(cell));
        let (state, det) = (sampler.state(coefficients), sampler.determinants(&nodal));
        let vorticity = match wanted.contains(&Integral::Enstrophy) {
            true => self.squared_vorticity::<M>(sampler, coefficients, &nodal, &state),
            false => Vec::new(),
        };
        let at = |p: usize, integral: &Integral| {
            let u: [f64; M] = std::array::from_fn(|m| state[m * weights.len() + p]);
            let Primitive { density, velocity, pressure } = Primitive::<f64, D>::unpack(self.gas, &u);
            density
                * match integral {
                    Integral::KineticEnergy => 0.5 * tensor::dot(&velocity, &velocity),
                    Integral::Enstrophy => 0.5 * vorticity[p],
                    Integral::Entropy => self.gas.entropy(density, pressure),
                    Integral::MomentumX => velocity[0],
                    Integral::MomentumY => velocity[1],
                    Integral::MomentumZ => velocity[D - 1],
                }
        };
        let integral = |integral: &Integral| {
            weights.iter().zip(&det).enumerate().map(|(p, (w, det))| w * det * at(p, integral)).sum()
        };
        wanted.iter().map(integral).collect()
    }

    /// omega . omega at the points.
    fn squared_vorticity<const M: usize>(
        &self,
        sampler: &Sampler<D>,
        coefficients: &[f64],
        nodal: &[f64],
        state: &[f64],
    ) -> Vec<f64> {
        let gradients = sampler.gradients(coefficients, nodal);
        let sample = CellSample { state, gradients: &gradients, ..CellSample::of_points(sampler.points()) };
        let mut omega = Vec::new();
        let medium = Medium::gas(*self.gas);
        fields::values::<D, M>(Field::Vorticity, Some(&medium), &sample, &mut omega);
        omega.chunks_exact(omega.len() / sampler.points()).map(|omega| omega.iter().map(|w| w * w).sum()).collect()
    }
}
