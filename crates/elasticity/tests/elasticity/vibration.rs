//! A cantilever that vibrates in one of its natural modes: period and energy.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

use crate::common::{Run, box_mesh, structure};
use elasticity::{Loads, Material, NaturalMode, Structure, natural_modes};
use std::f64::consts::TAU;

/// A clamped beam of length 10 and height 1/2.
fn beam(cells: [usize; 2], order: usize) -> Structure<2> {
    let mesh = box_mesh([10.0, 0.5], cells, order, 0.0);
    structure(mesh, Material::new(1.0, 0.3).unwrap(), 1.0, |name| [name == "left"; 2])
}

/// A run that starts at rest, displaced by `mode`.
fn vibrating(mode: &NaturalMode, time_order: usize, step: f64) -> Run<2> {
    let mut run = Run::new(beam([12, 1], 5), Loads::default(), time_order, step);
    run.displacement.clone_from(&mode.shape);
    run
}

/// omega of samples q_k of a vibration, `step` apart: the best fit of q_{k-1} + q_{k+1} = 2 cos(omega dt) q_k.
fn fitted_frequency(q: &[f64], step: f64) -> f64 {
    let (mut above, mut below) = (0.0, 0.0);
    for q in q.windows(3) {
        above += q[1] * (q[0] + q[2]);
        below += 2.0 * q[1] * q[1];
    }
    (above / below).acos() / step
}

/// The first three bending modes of a coarse beam, from the eigenproblem and from the motion of the tip over three periods, both within
/// 1 % of a fine eigenproblem.
#[test]
fn the_first_three_periods() {
    let coarse = natural_modes(&beam([12, 1], 5), 3).unwrap();
    let fine = natural_modes(&beam([24, 4], 7), 3).unwrap();
    let tip = beam([12, 1], 5).coordinates().iter().position(|x| *x == [10.0, 0.5]).unwrap();
    for (n, (mode, fine)) in coarse.iter().zip(&fine).enumerate() {
        let step = TAU / mode.angular_frequency / 12.0;
        let mut run = vibrating(mode, 3, step);
        let mut tip_history = vec![run.displacement[2 * tip + 1]];
        for _ in 0..36 {
            run.advance(step, |_, _| [0.0; 2]);
            tip_history.push(run.displacement[2 * tip + 1]);
        }
        let fine = fine.angular_frequency;
        let [modal, fitted] =
            [mode.angular_frequency, fitted_frequency(&tip_history, step)].map(|omega| omega / fine - 1.0);
        println!("mode {}: omega = {fine:.6}, coarse {modal:+.1e}, from its motion {fitted:+.1e}", n + 1);
        assert!(modal.abs() < 1e-3 && fitted.abs() < 1e-3, "mode {n}: {modal:e}, {fitted:e}");
    }
}

/// |R(i z)|^2 of the subdiagonal Pade approximation R of exp, which is the Radau IIA method of N_t nodes on d'' = -omega^2 d, z = omega dt.
fn damping(time_order: usize, z: f64) -> f64 {
    // Numerator and denominator by powers of z; real and imaginary part.
    let square = |c: &[f64]| {
        let powers: Vec<f64> = c.iter().zip(0..).map(|(c, k)| c * z.powi(k)).collect();
        let part = |first: usize| -> f64 {
            powers.iter().skip(first).step_by(2).zip([1.0, -1.0].into_iter().cycle()).map(|(p, s)| s * p).sum()
        };
        part(0).powi(2) + part(1).powi(2)
    };
    match time_order {
        1 => 1.0 / square(&[1.0, -1.0]),
        2 => square(&[1.0, 1.0 / 3.0]) / square(&[1.0, -2.0 / 3.0, 1.0 / 6.0]),
        _ => square(&[1.0, 0.4, 0.05]) / square(&[1.0, -0.6, 0.15, -1.0 / 60.0]),
    }
}

/// Over 20 periods of 10 slabs a mode loses the energy that the method dissipates for an oscillator, and no more.
#[test]
fn energy_over_twenty_periods() {
    let mode = &natural_modes(&beam([12, 1], 5), 1).unwrap()[0];
    let step = TAU / mode.angular_frequency / 10.0;
    for time_order in [1, 2, 3] {
        let mut run = vibrating(mode, time_order, step);
        let start = run.energy();
        (0..200).for_each(|_| {
            run.advance(step, |_, _| [0.0; 2]);
        });
        let (kept, expected) = (run.energy() / start, damping(time_order, mode.angular_frequency * step).powi(200));
        println!("N_t = {time_order}: {kept:.6e} of the energy is left after 20 periods");
        assert!((kept / expected - 1.0).abs() < 1e-5, "N_t = {time_order}: {kept:e}, expected {expected:e}");
    }
}
