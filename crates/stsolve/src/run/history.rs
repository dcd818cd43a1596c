//! The columns of history.csv, and its rows.

use super::tally::{EnergyBalance, Tally};
use crate::case::{Case, Structure};
use coupled::{Interval, MeshQuality, SlabReport, StructureReport};

/// Columns of every run.
const OF_MESH: [&str; 6] =
    ["t", "dt", "elasticity_iterations", "det_j_lower_bound", "det_j_sampled_min", "scaled_jacobian"];

/// Columns of a run with a flow.
const OF_FLOW: [&str; 8] =
    ["newton", "krylov", "residual_initial", "residual", "preconditioner_builds", "rejected", "mass", "mass_error"];

/// Columns of a run of a structure; work and dissipation since the start.
const OF_STRUCTURE: [&str; 10] = [
    "t",
    "dt",
    "elasticity_iterations",
    "kinetic_energy",
    "strain_energy",
    "energy",
    "load_work",
    "support_work",
    "dissipation",
    "energy_error",
];

/// Columns of history.csv: those of every run, and for each wall its mean force over the slab and its power. A structure has its own.
pub fn columns<const D: usize>(case: &Case<D>) -> Vec<String> {
    if let Some(structure) = &case.structure {
        return columns_of_structure(structure);
    }
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

/// With the displacement of every point and the coordinate of every natural mode.
fn columns_of_structure<const D: usize>(structure: &Structure<D>) -> Vec<String> {
    let of_point =
        |(name, _): &(String, [f64; D])| ["x", "y", "z"][..D].iter().map(|axis| format!("{name}_{axis}")).collect();
    let points = structure.points.iter().flat_map(of_point as fn(&_) -> Vec<String>);
    let modes = (1..=structure.natural_modes).map(|mode| format!("mode_{mode}"));
    OF_STRUCTURE.map(String::from).into_iter().chain(points).chain(modes).collect()
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

/// A row of a structure, up to its points; `balance` includes the slab.
pub fn row_of_structure(report: &StructureReport, balance: &EnergyBalance) -> Vec<f64> {
    let StructureReport { interval, dynamics, kinetic_energy, strain_energy, .. } = report;
    let energy = kinetic_energy + strain_energy;
    let time = [interval.end, interval.end - interval.start, dynamics.iterations as f64];
    let work = [balance.load_work, balance.support_work, balance.dissipation, balance.error(energy)];
    [&time[..], &[*kinetic_energy, *strain_energy, energy], &work].concat()
}

/// A row of mesh and flow; `tally` includes the slab.
pub fn row<const D: usize>(case: &Case<D>, report: &SlabReport, tally: &Tally) -> Vec<f64> {
    let SlabReport { interval, newton, counts, totals, .. } = report;
    let mut row = row_of_mesh(*interval, counts.elasticity_iterations, &report.quality);
    row.extend([newton.steps.len() as f64, newton.krylov_iterations as f64, newton.initial_norm, newton.final_norm()]);
    row.extend([counts.rebuilds as f64, report.rejected as f64, totals[0], tally.mass_balance(totals)]);
    let dt = interval.end - interval.start;
    for wall in walls(case) {
        // What momentum leaves through a wall is the force of the fluid on it; what energy leaves is the work on it.
        row.extend(report.through[wall][1..].iter().map(|through| through / dt));
    }
    row
}
