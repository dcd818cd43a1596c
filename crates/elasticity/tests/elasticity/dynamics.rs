//! The motion of structures: orders in time, energy, limits, and iterations.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

use crate::common::{Run, box_mesh, structure};
use elasticity::{Loads, Material};

fn material() -> Material {
    Material::new(2.0, 0.3).unwrap()
}

fn distance(a: &[f64], b: impl Iterator<Item = f64>) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// d = phi(t) (x^2, x y) is in the space of order 3, so that only the error in time remains. With phi'' = -phi, b = -phi (rho d + div
/// sigma) and div sigma = (5 mu + 3 lambda, 0). The traction is sigma n on three sides, and the fourth moves with d.
fn manufactured(order: usize, step: f64) -> Run<2> {
    let (density, lame) = (1.5, material().lame());
    let body = move |x: &[f64; 2], t: f64| {
        let divergence = 5.0 * lame.mu + 3.0 * lame.lambda;
        [t.sin() * (-density * x[0] * x[0] - divergence), -t.sin() * density * x[0] * x[1]]
    };
    let traction = move |point: &elasticity::SurfacePoint<2>, t: f64| {
        let x = point.position;
        lame.stress(&[[2.0 * x[0], 0.0], [x[1], x[0]]]).map(|row| t.sin() * tensor::dot(&row, &point.normal))
    };
    let mesh = box_mesh([1.0, 0.5], [2, 1], 3, 0.0);
    let structure = structure(mesh, material(), density, |name| [name == "right"; 2]);
    let mut loads = Loads { body_force: Some(Box::new(body)), ..Default::default() };
    for (index, name) in structure.mesh().boundary_names().iter().enumerate() {
        if name != "right" {
            loads.tractions.push((index, Box::new(traction)));
        }
    }
    Run::new(structure, loads, order, step).start(|_| [0.0; 2], |x| [x[0] * x[0], x[0] * x[1]])
}

/// The errors of displacement and velocity at t = 1 after `slabs` slabs.
fn manufactured_errors(order: usize, slabs: usize) -> [f64; 2] {
    let dt = 1.0 / slabs as f64;
    let mut run = manufactured(order, dt);
    for _ in 0..slabs {
        run.advance(dt, |x, t| [t.cos() * x[0] * x[0], t.cos() * x[0] * x[1]]);
    }
    let shape = || run.dynamics.structure().coordinates().iter().flat_map(|x| [x[0] * x[0], x[0] * x[1]]);
    let d = distance(&run.displacement, shape().map(|shape| shape * 1_f64.sin()));
    let v = distance(&run.velocity, shape().map(|shape| shape * 1_f64.cos()));
    [d, v]
}

/// Body force, traction and a moving support: order 2 N_t - 1 at the ends of slabs, of displacement and velocity.
#[test]
fn order_at_slab_ends_is_2_n_t_minus_1() {
    for (order, slabs) in [(1, 32), (2, 16), (3, 8), (4, 4)] {
        let (coarse, fine) = (manufactured_errors(order, slabs), manufactured_errors(order, 2 * slabs));
        for (coarse, fine) in coarse.into_iter().zip(fine) {
            let found = (coarse / fine).log2();
            println!("N_t = {order}: order {found:.2}");
            let expected = (2 * order - 1) as f64;
            assert!(found > expected - 0.15, "N_t = {order}: order {found:.2}, errors {coarse:e}, {fine:e}");
        }
    }
}

/// (energy) holds to round-off in every slab, for any orders and length of the slab.
#[test]
fn energy_is_what_loads_and_supports_have_worked_minus_what_jumps_take() {
    for order in 1..=5 {
        let mut run = manufactured(order, 0.4);
        for _ in 0..5 {
            let before = run.energy();
            let report = run.advance(0.4, |x, t| [(3.0 * t).cos() * x[0], (2.0 * t).sin() * x[1]]);
            let gained = report.work.load + report.work.support - report.work.dissipation;
            let size = report.work.load.abs() + report.work.support.abs();
            assert!(((run.energy() - before) - gained).abs() < 1e-10 * size, "N_t = {order}: {report:?}");
            assert!(report.work.dissipation > 0.0);
        }
    }
}

/// The reactions of a support that moves and the loads change the momentum of the body, to rounding.
#[test]
fn reactions_close_the_balance_of_momentum() {
    for order in 1..=3 {
        let body = structure(box_mesh([1.0, 0.5], [2, 1], 4, 0.02), material(), 3.0, |name| [name == "left"; 2]);
        let loads = Loads { body_force: Some(Box::new(|_, _| [0.3, -2.0])), ..Default::default() };
        let mut run = Run::new(body, loads, order, 0.2);
        let momentum = |run: &Run<2>| {
            let mut momentum = vec![0.0; run.velocity.len()];
            run.dynamics.structure().apply_mass(&run.velocity, &mut momentum);
            sums(&momentum)
        };
        for _ in 0..4 {
            let before = momentum(&run);
            let report = run.advance(0.2, |x, t| [0.1 * (3.0 * t).cos() * x[1], (2.0 * t).sin()]);
            let (reaction, after) = (sums(&report.reaction), momentum(&run));
            for (i, load) in [0.15, -1.0].into_iter().enumerate() {
                let error = after[i] - before[i] - 0.2 * (reaction[i] + load);
                assert!(error.abs() < 1e-10, "N_t = {order}, axis {i}: {error:e}, {reaction:?}");
            }
            assert!(reaction[1].abs() > 1e-3);
        }
    }
}

/// The sum of the nodal `forces`, along each axis.
fn sums(forces: &[f64]) -> [f64; 2] {
    [0, 1].map(|i| forces.chunks_exact(2).map(|force| force[i]).sum())
}

/// A free body falls like a point: d = a t^2 / 2 is a polynomial of the slab for N_t >= 2.
#[test]
fn a_free_body_falls_without_deforming() {
    let gravity = [0.3, -9.81, 0.1];
    let density = 2.5;
    for order in [2, 3, 8, 16] {
        let structure = structure(box_mesh([1.0, 2.0, 1.0], [1, 2, 1], 3, 0.02), material(), density, |_| [false; 3]);
        let loads =
            Loads { body_force: Some(Box::new(move |_, _| gravity.map(|g| density * g))), ..Default::default() };
        let mut run = Run::new(structure, loads, order, 0.5);
        (0..2).for_each(|_| {
            run.advance(0.5, |_, _| [0.0; 3]);
        });
        let nodes = run.displacement.len() / 3;
        let error = distance(&run.displacement, gravity.map(|g| 0.5 * g).repeat(nodes).into_iter());
        assert!(error < 1e-9, "N_t = {order}: {error:e}");
        assert!(distance(&run.velocity, gravity.repeat(nodes).into_iter()) < 1e-9);
    }
}

/// A slab that is long beside all periods ends in equilibrium with its load.
#[test]
fn the_limit_of_long_slabs_is_the_static_equilibrium() {
    let build = || structure(box_mesh([4.0, 1.0], [4, 1], 5, 0.02), material(), 1.0, |name| [name == "left"; 2]);
    let loads = || {
        let shear: elasticity::Traction<2> = Box::new(|point, _| [0.0, 1e-3 * point.position[1]]);
        Loads {
            body_force: Some(Box::new(|x, _| [1e-4 * x[1], 0.0])),
            tractions: vec![(1, shear)],
            ..Default::default()
        }
    };
    let static_structure = build();
    let (mut f, mut equilibrium) = (vec![0.0; static_structure.length()], vec![0.0; static_structure.length()]);
    static_structure.load(&loads(), 0.0, &mut f).unwrap();
    static_structure.equilibrium(&f, &mut equilibrium).unwrap();
    let size = equilibrium.iter().fold(0.0, |m: f64, d| m.max(d.abs()));
    for order in [1, 2, 3] {
        let mut run = Run::new(build(), loads(), order, 1e7);
        run.advance(1e7, |_, _| [0.0; 2]);
        let error = distance(&run.displacement, equilibrium.iter().copied());
        assert!(error < 1e-8 * size, "N_t = {order}: {error:e} of {size:e}");
    }
}

#[test]
fn same_bits_for_any_number_of_threads() {
    let run = |threads| {
        rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(|| {
            let mut run = manufactured(3, 0.1);
            let reports: Vec<_> = (0..3).map(|_| run.advance(0.1, |x, _| [x[0], x[1]])).collect();
            (run.displacement, run.velocity, reports)
        })
    };
    assert!(run(1) == run(2));
}

/// The iterations of a slab of a cantilever, over all modes and corrections, with dt a fifteenth of the first period. They hardly
/// grow with N.
#[test]
fn iterations_of_a_slab() {
    let count = |order: usize, time_order: usize| {
        let beam = structure(box_mesh([10.0, 1.0], [12, 1], order, 0.0), material(), 1.0, |name| [name == "left"; 2]);
        let mut run = Run::new(beam, Loads::default(), time_order, 40.0).start(|_| [0.0; 2], |x| [0.0, x[0] * x[0]]);
        run.advance(40.0, |_, _| [0.0; 2]).iterations
    };
    for (time_order, at_most) in [(1, [42, 46, 50]), (2, [90, 100, 112]), (3, [160, 178, 200])] {
        let found = [3, 5, 8].map(|order| count(order, time_order));
        println!("N_t = {time_order}: {found:?} iterations for N = 3, 5, 8");
        assert!(found.iter().zip(at_most).all(|(found, at_most)| *found <= at_most), "N_t = {time_order}: {found:?}");
    }
}
