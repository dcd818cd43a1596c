//! A box that turns far within a larger one; the meshes are proved valid over space and time.

use elasticity::Law;
use std::time::Instant;
use verification::rotating_box::Turn;

/// The degrees reached with `step` degrees per slab, and the cost, as a row of the table.
fn turned(order: usize, step: f64, end: f64) -> f64 {
    let turn = Turn { order, time_order: 1, law: Law::NeoHookean, step, end, accuracy: 1e-6 };
    let start = Instant::now();
    let (reports, error) = turn.run();
    let angle = reports.last().map_or(0.0, |report| report.interval.end);
    let bound = reports.iter().map(|report| report.quality.lower_bound).fold(f64::INFINITY, f64::min);
    let (steps, solves) =
        reports.iter().fold((0, 0), |(steps, solves), report| (steps + report.work.steps, solves + report.work.solves));
    let (slabs, seconds) = (reports.len(), start.elapsed().as_secs_f64());
    println!("{order:2}  {angle:5}  {bound:9.5}  {slabs:6}  {steps:6}  {solves:7}  {seconds:6.1} s");
    assert!(error.is_none(), "N = {order}: {error:?}");
    angle
}

#[test]
fn a_neo_hookean_mesh_turns_with_the_box() {
    println!(" N  angle  det bound   slabs   steps   solves");
    assert!(turned(2, 5.0, 180.0) >= 180.0);
    assert!(turned(4, 5.0, 180.0) >= 180.0);
    assert!(turned(8, 2.5, 135.0) >= 135.0);
}
