//! Natural frequencies against exact ones and against beam theory.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

use crate::common::{box_mesh, structure};
use elasticity::{Material, NaturalMode, natural_modes};
use std::f64::consts::PI;

fn frequencies(modes: &[NaturalMode]) -> Vec<f64> {
    modes.iter().map(|mode| mode.angular_frequency).collect()
}

/// A box between frictionless walls, where the normal displacement is zero. Plane waves with k = pi (i, j, ..) over the lengths fit in.
/// omega = c_p |k| occurs once, and all but one component of k may vanish. omega = c_s |k| occurs for every polarisation across k. In two
/// dimensions there are pressure waves for all (i, j) != 0 and shear waves for i, j >= 1 (curl of sin sin).
#[test]
fn waves_between_frictionless_walls_are_exact() {
    let material = Material::new(2.0, 0.3).unwrap();
    let (lame, density) = (material.lame(), 1.7);
    let (c_p, c_s) = (((lame.lambda + 2.0 * lame.mu) / density).sqrt(), (lame.mu / density).sqrt());
    let mesh = box_mesh([1.0, 0.7], [3, 2], 8, 0.02);
    let walls = |name: &str| if ["left", "right"].contains(&name) { [true, false] } else { [false, true] };
    let found = frequencies(&natural_modes(&structure(mesh, material, density, walls), 6).unwrap());
    let k = |i: usize, j: usize| PI * (i as f64).hypot(j as f64 / 0.7);
    let mut exact: Vec<f64> =
        (0..5).flat_map(|i| (0..5).map(move |j| (i, j))).skip(1).map(|(i, j)| c_p * k(i, j)).collect();
    exact.extend((1..5).flat_map(|i| (1..5).map(move |j| (i, j))).map(|(i, j)| c_s * k(i, j)));
    exact.sort_by(f64::total_cmp);
    for (found, exact) in found.iter().zip(&exact) {
        assert!((found / exact - 1.0).abs() < 1e-6, "{found} against {exact}");
    }
}

/// omega_n = (beta_n L)^2 sqrt(E' I / (rho A)) / L^2 of a slender beam of height 1 by Euler-Bernoulli theory, with rho = 1, I / A = 1/12.
fn euler_bernoulli(n: usize, modulus: f64, length: f64) -> f64 {
    let beta_l = [1.875_104_07_f64, 4.694_091_13, 7.854_757_44][n];
    beta_l.powi(2) * (modulus / 12.0).sqrt() / length.powi(2)
}

/// The lowest bending modes of a clamped beam of length 10 and height 1, those that move the tip across it.
fn bending(cells: [usize; 2], order: usize) -> Vec<f64> {
    let clamp = |name: &str| [name == "left"; 2];
    let beam = structure(box_mesh([10.0, 1.0], cells, order, 0.0), Material::new(1.0, 0.3).unwrap(), 1.0, clamp);
    let tip = beam.coordinates().iter().position(|x| x[0] > 10.0 - 1e-9 && x[1] > 1.0 - 1e-9).unwrap();
    let across = |mode: &NaturalMode| mode.shape[2 * tip + 1].abs() > mode.shape[2 * tip].abs();
    frequencies(&natural_modes(&beam, 4).unwrap().into_iter().filter(across).collect::<Vec<_>>())
}

/// The first three against a fine mesh, and against beam theory in plane strain, E' = E / (1 - nu^2). Euler-Bernoulli theory
/// neglects shear and rotary inertia, so its frequencies are too high, the more the shorter the wave.
#[test]
fn bending_frequencies_of_a_cantilever() {
    let (coarse, fine) = (bending([12, 1], 5), bending([24, 4], 7));
    for (n, beam_theory_excess) in [0.006, 0.054, 0.13].into_iter().enumerate() {
        let (error, distance) = (coarse[n] / fine[n] - 1.0, euler_bernoulli(n, 1.0 / 0.91, 10.0) / fine[n] - 1.0);
        println!("mode {n}: {:.6}, {error:.1e} above a fine mesh, Euler-Bernoulli {distance:.4} above", coarse[n]);
        assert!(error > 0.0 && error < 1e-3, "mode {n}: {error:e}");
        assert!(distance > 0.0 && distance < 1.1 * beam_theory_excess, "mode {n}: {distance}");
    }
}

/// A free body has exactly as many modes of frequency zero as rigid motions.
#[test]
fn a_free_body_has_its_rigid_motions() {
    let material = Material::new(1.0, 0.3).unwrap();
    let plane = structure(box_mesh([2.0, 1.0], [2, 1], 5, 0.02), material, 1.0, |_| [false; 2]);
    let plane = frequencies(&natural_modes(&plane, 5).unwrap());
    assert!(plane[..3].iter().all(|omega| *omega < 1e-5) && plane[3] > 0.5, "{plane:?}");
    let space = structure(box_mesh([2.0, 1.0, 1.0], [2, 1, 1], 3, 0.02), material, 1.0, |_| [false; 3]);
    let space = frequencies(&natural_modes(&space, 7).unwrap());
    assert!(space[..6].iter().all(|omega| *omega < 1e-5) && space[6] > 0.3, "{space:?}");
}

/// A slender beam, whose lowest omega^2 is 3e-8 of the shift of a compact body. Its modes did not converge, or to those of another beam.
#[test]
fn a_slender_beam_has_its_frequencies() {
    let (length, clamp) = (2000.0, |name: &str| [name == "left"; 2]);
    let mesh = box_mesh([length, 1.0], [10, 1], 5, 0.0);
    let beam = structure(mesh, Material::new(1.0, 0.0).unwrap(), 1.0, clamp);
    let found = frequencies(&natural_modes(&beam, 3).unwrap());
    for (n, found) in found.iter().enumerate() {
        let exact = euler_bernoulli(n, 1.0, length);
        println!("mode {n}: {found:e} for {exact:e}");
        assert!((found / exact - 1.0).abs() < 0.02, "mode {n}: {found:e} for {exact:e}");
    }
}

/// A beam of square section bends in two directions at one frequency; shapes of equal frequency are nevertheless orthogonal.
#[test]
fn a_square_beam_bends_twice() {
    let material = Material::new(1.0, 0.3).unwrap();
    let beam = structure(box_mesh([8.0, 1.0, 1.0], [4, 1, 1], 4, 0.0), material, 1.0, |name| [name == "left"; 3]);
    let modes = natural_modes(&beam, 2).unwrap();
    let omega = frequencies(&modes);
    assert!((omega[1] / omega[0] - 1.0).abs() < 1e-8, "{omega:?}");
    // Without plane strain, E' = E: 1 % from shear, 1 % from the mesh.
    assert!((omega[0] / euler_bernoulli(0, 1.0, 8.0) - 1.0).abs() < 0.02, "{omega:?}");
    let mut inertia = vec![0.0; beam.length()];
    beam.apply_mass(&modes[1].shape, &mut inertia);
    let product = |shape: &[f64]| shape.iter().zip(&inertia).map(|(a, b)| a * b).sum::<f64>();
    assert!(product(&modes[0].shape).abs() < 1e-10 && (product(&modes[1].shape) - 1.0).abs() < 1e-10);
}
