//! Set-up and application of each solver of the mesh.

use super::elastic::{ElasticBox, boundary};
use super::subject::{Build, Size, Subject, Work, bytes};
use elasticity::{ElasticMesh, Solver};

/// The largest memory of a solver in bytes.
const MOST_BYTES: usize = 1 << 30;

/// The solvers, and the names of their set-up and of an application, one pass of a solve.
const SOLVERS: [(Solver, [&str; 2]); 3] = [
    (Solver::Direct, ["direct set-up", "direct"]),
    (Solver::ConjugateGradients, ["low-order set-up", "low-order"]),
    (Solver::Multigrid, ["multigrid set-up", "multigrid"]),
];

/// A solver on the box, with the names of its rows.
struct Solving<const D: usize> {
    solver: Solver,
    names: [&'static str; 2],
    elastic: ElasticMesh<D>,
}

/// The box with every solver that fits into memory.
pub struct ElasticSolvers<const D: usize> {
    of: ElasticBox<D>,
    all: Vec<Solving<D>>,
    right: Vec<f64>,
    out: Vec<f64>,
}

impl<const D: usize> Build for ElasticSolvers<D> {
    /// The direct solver is included only if it would be chosen: otherwise its set-up takes minutes.
    fn build(size: Size) -> anyhow::Result<Option<Self>> {
        let of = ElasticBox::new(size)?;
        let chosen = of.plan(Solver::Automatic).solver;
        let fits = |solver| match solver {
            Solver::Direct => chosen == Solver::Direct,
            _ => of.plan(solver).bytes <= MOST_BYTES,
        };
        let mut all = Vec::new();
        for (solver, names) in SOLVERS.into_iter().filter(|(solver, _)| fits(*solver)) {
            all.push(Solving { solver, names, elastic: of.set_up(solver)? });
        }
        let Some(first) = all.first() else { return Ok(None) };
        let right = boundary(&first.elastic);
        Ok(Some(ElasticSolvers { of, out: vec![0.0; right.len()], right, all }))
    }
}

impl<const D: usize> Subject for ElasticSolvers<D> {
    fn work(&self) -> Vec<Work> {
        let n = self.right.len();
        let rows = |Solving { names: [set_up, pass], elastic, .. }: &Solving<D>| {
            let stored = elastic.solver_bytes() as f64;
            let work = |kernel, bytes| Work { kernel, unknowns: n as f64, flops: None, bytes };
            [work(*set_up, stored), work(*pass, bytes(2 * n) + stored)]
        };
        self.all.iter().flat_map(rows).collect()
    }

    fn run(&mut self, number: usize) {
        let Solving { solver, elastic, .. } = &mut self.all[number / 2];
        match number % 2 {
            0 => *elastic = self.of.set_up_again(*solver),
            _ => elastic.precondition(&self.right, &mut self.out),
        }
    }
}
