//! Set-up and solve times of every solver: seconds, iterations and memory for about 10^5 unknowns.
//!
//! `cargo test --release -p elasticity --test elasticity solver_times -- --ignored --nocapture`
#![allow(clippy::unwrap_used, clippy::print_stdout)]

use crate::common::held_box;
use elasticity::{ElasticMesh, Material, Solver, Stiffness};
use std::time::Instant;

/// Set-up, first and further solve for a curved box of `cells` cells per direction whose boundary moves.
fn measure<const D: usize>(cells: usize, order: usize, solver: Solver) {
    let (mesh, numbering, constrained) = held_box::<D>(cells, order);
    let material = Material::new(1.0, 0.4).unwrap();
    let start = Instant::now();
    let stiffness = Stiffness::InverseJacobian { power: 1.0 };
    let elastic = ElasticMesh::with_solver(&mesh, &numbering, material, stiffness, &constrained, solver).unwrap();
    let set_up = start.elapsed().as_secs_f64();
    let boundary: Vec<f64> = elastic.coordinates().iter().flat_map(|x| x.map(|x_i| (3.0 * x_i).sin() * x[0])).collect();
    let solve = || -> (f64, usize) {
        let mut d = boundary.clone();
        constrained.as_flattened().iter().zip(&mut d).filter(|(c, _)| !**c).for_each(|(_, d)| *d = 0.0);
        let start = Instant::now();
        let report = elastic.extend(&mut d, 1e-10).unwrap();
        (start.elapsed().as_secs_f64(), report.iterations)
    };
    let (first, iterations) = solve();
    let (further, _) = solve();
    println!(
        "{D}  {order:2}  {:8}  {:18}  {set_up:7.3} s  {first:7.3} s  {further:7.3} s  {iterations:4}  {:8.1} MB",
        elastic.length(),
        format!("{solver:?}"),
        elastic.solver_bytes() as f64 / 1e6,
    );
}

#[test]
#[ignore = "prints times"]
fn times_of_all_solvers() {
    println!("D   N  unknowns  solver                 set-up      first    further  iterations   memory");
    for solver in [Solver::Direct, Solver::ConjugateGradients, Solver::Multigrid] {
        measure::<2>(75, 4, solver);
        measure::<2>(32, 8, solver);
        measure::<3>(11, 4, solver);
        measure::<3>(5, 8, solver);
    }
    measure::<3>(16, 4, Solver::Multigrid);
    measure::<3>(7, 8, Solver::Multigrid);
}
