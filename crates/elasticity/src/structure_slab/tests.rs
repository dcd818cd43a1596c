#![allow(clippy::unwrap_used)]
use super::*;
use crate::testing::{distance, largest, material, noise, unit_box};
use crate::{Damping, FluidLayer, ModalSolver, SlabSystems};
use basis::RadauTime;
use mesh::NodeNumbering;

/// A square that is clamped at its first side.
fn square() -> Structure<2> {
    let mesh = unit_box([2, 2], 4, 0.03);
    let numbering = NodeNumbering::new(&mesh, 4);
    let mut fixed = vec![[false; 2]; numbering.count];
    numbering.on_boundary(&mesh, 0).into_iter().for_each(|node| fixed[node] = [true; 2]);
    let damping = Damping { mass: 0.7, stiffness: 0.2 };
    Structure::new(mesh, numbering, material(), 1.5, fixed).unwrap().with_damping(damping)
}

/// Something to do with the square in a slab, a state at its bottom, and a vector of the slab.
fn in_slab<R>(act: impl FnOnce(StructureSlab<'_, 2>, &[f64]) -> R) -> R {
    let (structure, loads, motion) = (square(), Loads::default(), SlabMotion::new(RadauTime::new(3)));
    let state = noise(2 * structure.length());
    let (displacement, velocity) = state.split_at(structure.length());
    let bottom = SlabBottom { time: 0.2, displacement, velocity };
    let v = noise(3 * structure.length());
    act(
        StructureSlab {
            structure: &structure,
            loads: &loads,
            motion: &motion,
            bottom,
            dt: 0.3,
            clock: fem::Clock::running(0.2, 0.3),
        },
        &v,
    )
}

/// The residual is affine, so that a difference over a long step is exact.
#[test]
fn the_product_is_the_derivative_of_the_residual() {
    in_slab(|slab, v| {
        let (forces, w) = (vec![0.0; v.len()], noise(v.len() + 1)[1..].to_vec());
        let at = |a: f64| {
            let (moved, mut r) = (v.iter().zip(&w).map(|(v, w)| v + a * w).collect::<Vec<_>>(), vec![0.0; v.len()]);
            slab.residual(&forces, &moved, &mut r).unwrap();
            r
        };
        let difference: Vec<f64> = at(1.0).iter().zip(at(-1.0)).map(|(plus, minus)| 0.5 * (plus - minus)).collect();
        let mut product = vec![0.0; v.len()];
        slab.product(v, &w, &mut product);
        assert!(distance(&product, &difference) < 1e-13 * largest(&product));
    });
}

/// (dR/dV + T)^{-1} r, where T is (1/dtau) dt omega_a M, and the mass has that of a fluid.
#[test]
fn the_modes_invert_the_derivative_with_pseudo_time_and_a_fluid() {
    in_slab(|slab, w| {
        let (structure, length, dt) = (slab.structure, slab.structure.length(), slab.dt);
        let wet: Vec<bool> = structure.coordinates().iter().map(|x| x[0] > 1.0 - 1e-9).collect();
        let mut w = w.to_vec();
        w.chunks_exact_mut(length).for_each(|w| structure.at_fixed(w, |_| 0.0));
        for (rate, depth) in [(0.0, 0.0), (7.0, 0.0), (7.0, 0.5)] {
            // A sound that is fast: the mass of the layer is the same for all modes, and the system exact.
            let areas = structure.wet_areas(&wet);
            let fluid = FluidLayer { density: 2.0, speed_of_sound: 1e9, depth, areas };
            let of = SlabSystems { dt, inverse_pseudo_time: rate, fluid: Some(&fluid), position: &[] };
            let solver = ModalSolver::new(structure, slab.motion.time(), of).unwrap();
            let (mut r, mut inertia) = (vec![0.0; w.len()], vec![0.0; length]);
            slab.product(&w, &w, &mut r);
            let (time, layer) = (slab.motion.time(), fluid.masses(0.0));
            for (a, r) in r.chunks_exact_mut(length).enumerate() {
                let (mut change, mut alone) = (vec![0.0; length], vec![0.0; length]);
                accumulate(1.0, &w, time.slab_matrix().row(a), &mut change);
                structure.apply_mass(&change, &mut alone);
                structure.apply_mass_with(&layer, &change, &mut inertia);
                (0..length).for_each(|i| r[i] += inertia[i] - alone[i]);
                structure.apply_mass_with(&layer, &w[a * length..(a + 1) * length], &mut inertia);
                structure.apply_mass(&w[a * length..(a + 1) * length], &mut alone);
                let alpha = structure.damping().mass;
                (0..length).for_each(|i| {
                    r[i] += dt * time.weights()[a] * (rate * inertia[i] + alpha * (inertia[i] - alone[i]));
                });
            }
            solver.solve(structure, dt, 1e-12, &mut r).unwrap();
            let error = distance(&r, &w) / largest(&w);
            assert!(error < 1e-9, "1/dtau = {rate}, L = {depth}: {error:e}");
        }
    });
}

/// The areas of the sides of the unit square, and their normals.
#[test]
fn wet_areas_are_those_of_the_sides() {
    let mesh = unit_box([3, 2], 3, 0.0);
    let numbering = NodeNumbering::new(&mesh, 3);
    let free = vec![[false; 2]; numbering.count];
    let body = Structure::new(mesh, numbering, material(), 1.0, free).unwrap();
    let wet: Vec<bool> = body.coordinates().iter().map(|x| x[0] > 1.0 - 1e-9 || x[1] < 1e-9).collect();
    let areas = body.wet_areas(&wet);
    let sum = |i: usize, j: usize| areas.iter().map(|area| area[i][j]).sum::<f64>();
    assert!((sum(0, 0) - 1.0).abs() < 1e-13 && (sum(1, 1) - 1.0).abs() < 1e-13 && sum(0, 1).abs() < 1e-13);
}
