//! The vector operations of FGMRES: a solve with a diagonal matrix, whose products cost almost nothing.

use super::flow::{PLANE_NODES, SPACE_NODES};
use super::subject::{Build, Size, Subject, Work, bytes};
use newton_krylov::fgmres::{self, Settings, Workspace};
use newton_krylov::inner_product::{AT_ONCE, InnerProduct, Weighted, copy};
use newton_krylov::operator::LinearSystem;

/// Iterations of a solve, about as many as a Newton step takes.
const ITERATIONS: usize = 20;

/// A diagonal matrix with more eigenvalues than FGMRES has iterations.
struct Diagonal {
    weights: Weighted,
}

impl LinearSystem for Diagonal {
    fn multiply(&mut self, x: &[f64], y: &mut [f64]) {
        const EIGENVALUES: usize = 4 * ITERATIONS;
        for (y, x) in y.chunks_mut(EIGENVALUES).zip(x.chunks(EIGENVALUES)) {
            y.iter_mut().zip(x).enumerate().for_each(|(i, (y, x))| *y = (1.0 + i as f64) * x);
        }
    }
    fn precondition(&mut self, r: &[f64], z: &mut [f64]) {
        copy(r, z);
    }
    fn inner_product(&self) -> &dyn InnerProduct {
        &self.weights
    }
}

/// Vectors as long as those of the flow.
pub struct Vectors {
    system: Diagonal,
    right: Vec<f64>,
    solution: Vec<f64>,
    workspace: Workspace,
}

impl Build for Vectors {
    fn build(size: Size) -> anyhow::Result<Option<Self>> {
        let nodes = size.order * size.even_cells(PLANE_NODES, SPACE_NODES);
        let length = 2 * (2 + size.dimension) * nodes.pow(size.dimension as u32);
        let (system, right) = (Diagonal { weights: Weighted::new(vec![1.0; length]) }, vec![1.0; length]);
        Ok(Some(Vectors { system, right, solution: vec![0.0; length], workspace: Workspace::default() }))
    }
}

impl Subject for Vectors {
    /// Per iteration j: j inner products and updates with the basis, which is read twice; some passes over one or two vectors.
    fn work(&self) -> Vec<Work> {
        let (n, m) = (self.right.len(), ITERATIONS);
        let pairs = m * (m + 1) / 2;
        // Products with the weights are formed once per group of columns.
        let groups: usize = (1..=m).map(|j| j.div_ceil(AT_ONCE)).sum();
        let (flops, numbers) = ((4 * pairs + groups + 10 * m) * n, (2 * pairs + 9 * m) * n);
        let unknowns = (n * m) as f64;
        vec![Work { kernel: "FGMRES vectors", unknowns, flops: Some(flops as f64), bytes: bytes(numbers) }]
    }

    /// The solve ends without convergence, as intended.
    fn run(&mut self, _: usize) {
        self.solution.fill(0.0);
        let settings = Settings {
            relative_tolerance: 1e-30,
            restart: ITERATIONS,
            max_iterations: ITERATIONS,
            ..Settings::default()
        };
        let Vectors { system, right, solution, workspace } = self;
        let _ = fgmres::solve(system, right, solution, &settings, workspace);
    }
}
