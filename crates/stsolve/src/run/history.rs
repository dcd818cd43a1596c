//! The columns of history.csv, and its rows.

use super::tally::Tally;
use crate::case::Case;
use coupled::{Interval, MeshQuality, SlabReport};

/// Columns of every run.
const OF_MESH: [&str; 6] =
    ["t", "dt", "elasticity_iterations", "det_j_lower_bound", "det_j_sampled_min", "scaled_jacobian"];

/// Columns of a run with a flow.
const OF_FLOW: [&str; 9] = [
    "jump",
    "newton",
    "krylov",
    "residual_initial",
    "residual",
    "preconditioner_builds",
    "rejected",
    "mass",
    "mass_error",
];

/// Columns of history.csv: those of every run, and for each wall its mean force over the slab and its power.
pub fn columns<const D: usize>(case: &Case<D>) -> Vec<String> {
    let mut columns: Vec<String> = OF_MESH.map(String::from).to_vec();
    if case.flow.is_some() {
        columns.extend(OF_FLOW.map(String::from));
    }
    for wall in walls(case) {
        let name = &case.mesh.boundary_names()[wall];
        columns.extend(["force_x", "force_y", "force_z"][..D].iter().map(|force| format!("{name}_{force}")));
        columns.push(format!("{name}_power"));
    }
    columns
}

/// The boundaries that are walls.
pub fn walls<const D: usize>(case: &Case<D>) -> Vec<usize> {
    let conditions = case.flow.iter().flat_map(|flow| flow.boundary.iter().enumerate());
    conditions.filter(|(_, boundary)| boundary.condition.is_wall()).map(|(number, _)| number).collect()
}

/// A row of the mesh alone.
pub fn row_of_mesh(interval: Interval, iterations: usize, quality: &MeshQuality) -> Vec<f64> {
    let MeshQuality { lower_bound, sampled_min, scaled_jacobian, .. } = *quality;
    vec![interval.end, interval.end - interval.start, iterations as f64, lower_bound, sampled_min, scaled_jacobian]
}

/// A row of mesh and flow; `tally` includes the slab.
pub fn row<const D: usize>(case: &Case<D>, report: &SlabReport, tally: &Tally) -> Vec<f64> {
    let SlabReport { interval, newton, counts, totals, .. } = report;
    let mut row = row_of_mesh(*interval, counts.elasticity_iterations, &report.quality);
    row.extend([
        report.jump,
        newton.steps.len() as f64,
        newton.krylov_iterations as f64,
        newton.initial_norm,
        newton.final_norm(),
    ]);
    row.extend([counts.rebuilds as f64, report.rejected as f64, totals[0], tally.mass_balance(totals)]);
    let dt = interval.end - interval.start;
    for wall in walls(case) {
        // What momentum leaves through a wall is the force of the fluid on it; what energy leaves is the work on it.
        row.extend(report.through[wall][1..].iter().map(|through| through / dt));
    }
    row
}
