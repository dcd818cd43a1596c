//! Structures that the tests share.
#![allow(dead_code, clippy::unwrap_used)]

use elasticity::{Dynamics, DynamicsReport, Loads, Material, SlabBottom, Structure};
use mesh::{BoxMesh, Curving, Mesh, NodeNumbering};
use tensor::{Dual, Transcendental};

/// A manufactured displacement d(x): products of sines and cosines.
pub fn displacement<T: Transcendental, const D: usize>(x: &[T; D]) -> [T; D] {
    std::array::from_fn(|i| {
        let next = x[(i + 1) % D];
        (x[i] * 3.0 + 0.3).sin() * (next * 2.0 + i as f64).cos() + x[D - 1] * x[0] * 0.5
    })
}

/// The body force for [`displacement`], f = -div sigma, of the `stress` at a point with a gradient of d: f_i = -sum_j d sigma_ij / dx_j, with
/// the derivatives of d in the inner duals.
pub fn body_force<const D: usize>(
    x: &[f64; D],
    stress: impl Fn(&[Dual<f64>; D], &[[Dual<f64>; D]; D]) -> [[Dual<f64>; D]; D],
) -> [f64; D] {
    let mut force = [0.0; D];
    for j in 0..D {
        let seed = |i: usize, axis: usize| if i == axis { 1.0 } else { 0.0 };
        let along_j: [Dual<f64>; D] = std::array::from_fn(|i| Dual::new(x[i], seed(i, j)));
        let mut gradient = [[Dual::new(0.0, 0.0); D]; D];
        for k in 0..D {
            let d: [_; D] = displacement(&std::array::from_fn(|i| Dual::new(along_j[i], Dual::new(seed(i, k), 0.0))));
            (0..D).for_each(|i| gradient[i][k] = d[i].derivative);
        }
        let sigma = stress(&along_j, &gradient);
        (0..D).for_each(|i| force[i] -= sigma[i][j].derivative);
    }
    force
}

/// A box with a corner at the origin, curved inside.
pub fn box_mesh<const D: usize>(upper: [f64; D], cells: [usize; D], order: usize, amplitude: f64) -> Mesh<D> {
    let curving = Curving::Smooth { amplitude };
    BoxMesh { lower: [0.0; D], upper, cells, order, curving, periodic: [false; D] }.build().unwrap()
}

/// A unit box of `cells` cells per direction, wavy inside, with its nodes, and for every node whether its components are held: those of the boundary are.
pub fn held_box<const D: usize>(cells: usize, order: usize) -> (Mesh<D>, NodeNumbering, Vec<[bool; D]>) {
    let curving = Curving::Wavy { amplitude: 0.02 };
    let mesh = BoxMesh { lower: [0.0; D], upper: [1.0; D], cells: [cells; D], order, curving, periodic: [false; D] }
        .build()
        .unwrap();
    let numbering = NodeNumbering::new(&mesh, order);
    let mut held = vec![[false; D]; numbering.count];
    (0..2 * D).flat_map(|boundary| numbering.on_boundary(&mesh, boundary)).for_each(|node| held[node] = [true; D]);
    (mesh, numbering, held)
}

/// The body with the components `fixed(boundary)` of every boundary held.
pub fn structure<const D: usize>(
    mesh: Mesh<D>,
    material: Material,
    density: f64,
    fixed: impl Fn(&str) -> [bool; D],
) -> Structure<D> {
    let numbering = NodeNumbering::new(&mesh, mesh.order());
    let mut entries = vec![[false; D]; numbering.count];
    for (index, name) in mesh.boundary_names().iter().enumerate() {
        for node in numbering.on_boundary(&mesh, index) {
            (0..D).for_each(|i| entries[node][i] |= fixed(name)[i]);
        }
    }
    Structure::new(mesh, numbering, material, density, entries).unwrap()
}

/// A run of slabs of one length from rest or from a given state.
pub struct Run<const D: usize> {
    /// The equations.
    pub dynamics: Dynamics<D>,
    /// Its displacement, `[C0 node][component]`.
    pub displacement: Vec<f64>,
    /// Its velocity.
    pub velocity: Vec<f64>,
    time: f64,
}

impl<const D: usize> Run<D> {
    /// At rest.
    pub fn new(structure: Structure<D>, loads: Loads<D>, time_order: usize, step: f64) -> Self {
        let (displacement, velocity) = (vec![0.0; structure.length()], vec![0.0; structure.length()]);
        let dynamics = Dynamics::new(structure, loads, time_order, step).unwrap();
        Run { dynamics, displacement, velocity, time: 0.0 }
    }

    /// One slab; supports move with `support(x, t)`.
    pub fn advance(&mut self, dt: f64, support: impl Fn(&[f64; D], f64) -> [f64; D]) -> DynamicsReport {
        let length = self.displacement.len();
        let nodes = self.dynamics.motion().time().nodes().to_vec();
        let fixed = self.dynamics.structure().fixed().to_vec();
        let mut v = self.velocity.repeat(nodes.len());
        for (s, v) in nodes.iter().zip(v.chunks_exact_mut(length)) {
            for (node, x) in self.dynamics.structure().coordinates().iter().enumerate() {
                let g = support(x, self.time + s * dt);
                (0..D).filter(|i| fixed[node * D + i]).for_each(|i| v[node * D + i] = g[i]);
            }
        }
        let bottom = SlabBottom { time: self.time, displacement: &self.displacement, velocity: &self.velocity };
        let report = self.dynamics.solve(bottom, dt, &mut v).unwrap();
        let mut top = vec![0.0; length];
        self.dynamics.motion().displacement(dt, &self.displacement, &v, 1.0, &mut top);
        self.displacement = top;
        self.velocity = v[v.len() - length..].to_vec();
        self.time += dt;
        report
    }

    /// Kinetic and strain energy.
    pub fn energy(&self) -> f64 {
        let structure = self.dynamics.structure();
        structure.kinetic_energy(&self.velocity) + structure.strain_energy(&self.displacement)
    }

    /// From the displacement d(x) and the velocity v(x).
    pub fn start(mut self, d: impl Fn(&[f64; D]) -> [f64; D], v: impl Fn(&[f64; D]) -> [f64; D]) -> Self {
        self.displacement = self.dynamics.structure().coordinates().iter().flat_map(d).collect();
        self.velocity = self.dynamics.structure().coordinates().iter().flat_map(v).collect();
        self
    }
}
