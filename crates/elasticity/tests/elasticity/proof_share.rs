//! The cost of the proof that a mesh stays valid, relative to the solve that moves it.
//!
//! `cargo test --release -p elasticity --test elasticity proof_share -- --ignored --nocapture` prints it; times are never asserted.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

use basis::RadauTime;
use elasticity::{ElasticMesh, ElasticSlab, Material, SlabMotion, Stiffness};
use mesh::generate::{AirfoilMesh, RotatingBoxMesh};
use mesh::{BoxMesh, Curving, Mesh, MotionCheck, NodeNumbering};
use std::time::Instant;

/// Slabs of length [`STEP`] with two time nodes; the fastest counts.
const SLABS: usize = 5;
const STEP: f64 = 0.05;

/// A mesh with one boundary that turns by half a radian per unit of time.
struct Turning<const D: usize> {
    mesh: ElasticMesh<D>,
    motion: SlabMotion,
    check: MotionCheck<D>,
    turns: Vec<bool>,
    set_up: f64,
}

impl<const D: usize> Turning<D> {
    fn new(mesh: &Mesh<D>, boundary: &str, stiffness: Stiffness<'_, D>) -> Self {
        let numbering = NodeNumbering::new(mesh, mesh.order());
        let (mut constrained, mut turns) = (vec![[false; D]; numbering.count], vec![false; numbering.count]);
        for (number, name) in mesh.boundary_names().iter().enumerate() {
            for node in numbering.on_boundary(mesh, number) {
                constrained[node] = [true; D];
                turns[node] |= name == boundary;
            }
        }
        let motion = SlabMotion::new(RadauTime::new(2));
        let (check, set_up) = seconds(|| MotionCheck::new(mesh, &numbering, &times(&motion)));
        let material = Material::new(1.0, 0.4).unwrap();
        let mesh = ElasticMesh::new(mesh, &numbering, material, stiffness, &constrained).unwrap();
        Turning { mesh, motion, check, turns, set_up }
    }

    /// The displacement prescribed at the time nodes of a slab.
    fn prescribed(&self, slab: usize) -> Vec<f64> {
        let at = |s: &f64| {
            let (sine, cosine) = (0.5 * STEP * (slab as f64 + s)).sin_cos();
            let turned = move |(x, turns): (&[f64; D], &bool)| {
                let mut d = [0.0; D];
                if *turns {
                    d[0] = (cosine - 1.0) * x[0] - sine * x[1];
                    d[1] = sine * x[0] + (cosine - 1.0) * x[1];
                }
                d
            };
            self.mesh.coordinates().iter().zip(&self.turns).flat_map(turned)
        };
        self.motion.time().nodes().iter().flat_map(at).collect()
    }

    /// Velocities in equilibrium, from those of the slab before.
    fn solve(&self, slab: usize, bottom: &[f64], v: &mut [f64]) {
        let elastic = ElasticSlab { mesh: &self.mesh, motion: &self.motion, dt: STEP };
        let (mut r, mut w) = (vec![0.0; v.len()], vec![0.0; v.len()]);
        elastic.residual(bottom, &self.prescribed(slab), v, &mut r).unwrap();
        elastic.solve(&r, &mut w, 1e-10).unwrap();
        v.iter_mut().zip(&w).for_each(|(v, w)| *v -= w);
    }

    /// The proved bound and the smallest sampled value.
    fn prove(&self, bottom: &[f64], v: &[f64]) -> [f64; 2] {
        let times = times(&self.motion);
        let mut displacements = vec![0.0; bottom.len() * times.len()];
        for (s, d) in times.iter().zip(displacements.chunks_exact_mut(bottom.len())) {
            self.motion.displacement(STEP, bottom, v, *s, d);
        }
        let worse =
            |[lower, seen]: [f64; 2], bound: &mesh::Bound<D>| [lower.min(bound.lower), seen.min(bound.sampled_min)];
        self.check.decide(&displacements).iter().map(|answer| answer.bound()).fold([f64::INFINITY; 2], worse)
    }

    fn measure(&self, name: &str) {
        let (mut bottom, mut v) = (vec![0.0; self.mesh.length()], vec![0.0; 2 * self.mesh.length()]);
        let (mut solve, mut proof, mut bound) = (f64::INFINITY, f64::INFINITY, [0.0; 2]);
        for slab in 0..SLABS {
            solve = solve.min(seconds(|| self.solve(slab, &bottom, &mut v)).1);
            let (proved, time) = seconds(|| self.prove(&bottom, &v));
            (proof, bound) = (proof.min(time), proved);
            let start = bottom.clone();
            self.motion.displacement(STEP, &start, &v, 1.0, &mut bottom);
        }
        println!(
            "{name:21} solve {:8.2} ms, proof {:7.3} ms = {:4.1} %, set-up {:6.2} ms; det J / det J_0 >= {:.4}, seen {:.4}",
            1e3 * solve,
            1e3 * proof,
            100.0 * proof / solve,
            1e3 * self.set_up,
            bound[0],
            bound[1]
        );
    }
}

/// The bottom and the time nodes of a slab.
fn times(motion: &SlabMotion) -> Vec<f64> {
    std::iter::once(0.0).chain(motion.time().nodes().iter().copied()).collect()
}

fn seconds<T>(work: impl FnOnce() -> T) -> (T, f64) {
    let clock = Instant::now();
    let result = work();
    (result, clock.elapsed().as_secs_f64())
}

#[test]
#[ignore = "prints times"]
fn share_of_the_proof() {
    for order in [2, 4, 8] {
        let mesh = RotatingBoxMesh::unit(80 / order, order).build().unwrap();
        Turning::new(&mesh, "inner", Stiffness::Constant).measure(&format!("rotating box, N = {order}"));
    }
    for order in [4, 8] {
        let mesh = AirfoilMesh::naca0012(order).build().unwrap();
        let stiffness = Stiffness::InverseJacobian { power: 1.0 };
        Turning::new(&mesh, "airfoil", stiffness).measure(&format!("airfoil, N = {order}"));
    }
    let curving = Curving::Smooth { amplitude: 0.02 };
    let cube = BoxMesh { lower: [0.0; 3], upper: [1.0; 3], cells: [6; 3], order: 4, curving, periodic: [false; 3] };
    let cube = cube.build().unwrap();
    Turning::new(&cube, &cube.boundary_names()[0], Stiffness::Constant).measure("cube, N = 4");
}
