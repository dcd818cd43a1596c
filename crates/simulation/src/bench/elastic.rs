//! The stiffness operator of the mesh, the set-up of its solver, and a solve to 1e-10.

use super::subject::{Build, Size, Subject, Work, bytes};
use elasticity::{ElasticMesh, ElasticityError, Material, Plan, Solver, Stiffness};
use mesh::{BoxMesh, Curving, Mesh, NodeNumbering};

/// A curved box whose boundary is constrained.
pub struct ElasticBox<const D: usize> {
    mesh: Mesh<D>,
    numbering: NodeNumbering,
    material: Material,
    constrained: Vec<[bool; D]>,
}

impl<const D: usize> ElasticBox<D> {
    /// With about 10^5 unknowns.
    pub fn new(size: Size) -> anyhow::Result<Self> {
        let (order, intervals) = (size.order, size.nodes(226, 33) - 1);
        let cells = ((intervals as f64 / (order - 1) as f64).round() as usize).max(2);
        let curving = Curving::Wavy { amplitude: 0.02 };
        let box_mesh =
            BoxMesh { lower: [0.0; D], upper: [1.0; D], cells: [cells; D], order, curving, periodic: [false; D] };
        let mesh = box_mesh.build()?;
        let numbering = NodeNumbering::new(&mesh, order);
        let mut constrained = vec![[false; D]; numbering.count];
        (0..2 * D).flat_map(|b| numbering.on_boundary(&mesh, b)).for_each(|node| constrained[node] = [true; D]);
        Ok(ElasticBox { mesh, numbering, material: Material::new(1.0, 0.4)?, constrained })
    }

    /// The plan of `solver` for this box.
    pub fn plan(&self, solver: Solver) -> Plan {
        Plan::new(&self.mesh, &self.numbering, &self.constrained, solver)
    }

    /// Everything up to the first solve.
    pub fn set_up(&self, solver: Solver) -> Result<ElasticMesh<D>, ElasticityError> {
        let stiffness = Stiffness::InverseJacobian { power: 1.0 };
        ElasticMesh::with_solver(&self.mesh, &self.numbering, self.material, stiffness, &self.constrained, solver)
    }

    /// Repeats a set-up that succeeded before.
    pub fn set_up_again(&self, solver: Solver) -> ElasticMesh<D> {
        self.set_up(solver).unwrap_or_else(|error| unreachable!("it was set up before: {error}"))
    }
}

/// A displacement of the boundary.
pub fn boundary<const D: usize>(elastic: &ElasticMesh<D>) -> Vec<f64> {
    let everywhere = elastic.coordinates().iter().flat_map(|x| x.map(|x_i| (3.0 * x_i).sin() * x[0]));
    everywhere.zip(elastic.constrained()).map(|(d, held)| if *held { d } else { 0.0 }).collect()
}

/// The box with the solver that suits its size.
pub struct Elastic<const D: usize> {
    of: ElasticBox<D>,
    elastic: ElasticMesh<D>,
    moved: Vec<f64>,
    out: Vec<f64>,
}

impl<const D: usize> Build for Elastic<D> {
    fn build(size: Size) -> anyhow::Result<Option<Self>> {
        let of = ElasticBox::new(size)?;
        let elastic = of.set_up(Solver::Automatic)?;
        let (moved, out) = (boundary(&elastic), vec![0.0; elastic.length()]);
        Ok(Some(Elastic { of, elastic, moved, out }))
    }
}

impl<const D: usize> Subject for Elastic<D> {
    fn work(&self) -> Vec<Work> {
        let (n, solver) = (self.elastic.length(), self.elastic.solver_bytes() as f64);
        let unknowns = n as f64;
        let flops = 2.0 * self.elastic.multiplications() as f64;
        let metric = bytes(self.elastic.metric_length());
        vec![
            Work { kernel: "elasticity operator", unknowns, flops: Some(flops), bytes: bytes(2 * n) + metric },
            Work { kernel: "elasticity set-up", unknowns, flops: None, bytes: solver },
            Work { kernel: "elasticity solve", unknowns, flops: None, bytes: bytes(2 * n) + solver },
        ]
    }

    fn run(&mut self, number: usize) {
        let Elastic { of, elastic, moved, out } = self;
        match number {
            0 => elastic.apply(moved, out),
            1 => *elastic = of.set_up_again(Solver::Automatic),
            _ => {
                out.copy_from_slice(moved);
                elastic.extend(out, 1e-10).unwrap_or_else(|error| unreachable!("a box is solved: {error}"));
            }
        }
    }
}
