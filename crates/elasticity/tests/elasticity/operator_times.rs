//! Speed of the stiffness operator for every order in million unknowns per second and thread, and the cost per unknown relative to
//! the order. Also the time of one application of the low-order preconditioner, and the set-up of both.
//!
//! `cargo test --release -p elasticity --test elasticity operator_times -- --ignored --nocapture`
#![allow(clippy::unwrap_used, clippy::print_stdout)]

use crate::common::held_box;
use elasticity::{ElasticMesh, Material, Solver, Stiffness};
use std::time::Instant;

/// The best of several short bursts, in seconds.
fn best_time(mut call: impl FnMut()) -> f64 {
    call();
    (0..7)
        .map(|_| {
            let start = Instant::now();
            call();
            start.elapsed().as_secs_f64()
        })
        .fold(f64::INFINITY, f64::min)
}

/// Operator and preconditioner of order `order` with about `nodes` nodes per direction.
fn measure<const D: usize>(order: usize, nodes: usize) {
    let cells = (nodes / (order - 1)).max(2);
    let (mesh, numbering, constrained) = held_box::<D>(cells, order);
    let start = Instant::now();
    let (material, solver) = (Material::new(1.0, 0.4).unwrap(), Solver::ConjugateGradients);
    let elastic =
        ElasticMesh::with_solver(&mesh, &numbering, material, Stiffness::Constant, &constrained, solver).unwrap();
    let set_up = start.elapsed().as_secs_f64();
    let (d, mut out) = (vec![1.0; elastic.length()], vec![0.0; elastic.length()]);
    let operator = best_time(|| elastic.apply(&d, &mut out));
    let preconditioner = best_time(|| elastic.precondition(&d, &mut out));
    let (unknowns, threads) = (elastic.length() as f64, rayon::current_num_threads() as f64);
    println!(
        "{D}  {order:2}  {unknowns:8}  {:9.1}  {:12.2}  {:6.1}  {:9.2} ms  {set_up:6.2} s",
        unknowns / operator / threads / 1e6,
        operator * threads / unknowns / order as f64 * 1e9,
        2.0 * elastic.multiplications() as f64 / operator / threads / 1e9,
        preconditioner * 1e3,
    );
}

#[test]
#[ignore = "prints times"]
fn times_of_the_operator() {
    println!("D   N  unknowns  million/s  ns/(unkn. N)  Gflop/s  precondit.      set-up");
    for order in 2..=16 {
        measure::<2>(order, 240);
    }
    for order in 2..=16 {
        measure::<3>(order, 24);
    }
}
