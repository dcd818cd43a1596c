//! The columns of history.csv, and its rows.

use super::bodies;
use super::controls;
use super::openings::is_opening;
use super::statistics::{EnergyBalance, RunStatistics};
use super::walls::{WallLoads, from_numbers};
use super::{opening_states, probes};
use crate::error::Failure;
use case::{Case, Flow, Integral, Structure, Wall};
use coupled::block::BodyState;
use coupled::{Interval, MeshQuality, SlabReport, StructureReport};
use navier_stokes::{Coefficients, Conserved, WallForce};
use std::array::from_fn;
use tensor::AXES;

/// Columns of every run.
const OF_MESH: [&str; 6] =
    ["t", "dt", "elasticity_iterations", "det_j_lower_bound", "det_j_sampled_min", "scaled_jacobian"];

/// Columns of a run with a flow.
const OF_FLOW: [&str; 11] = [
    "jump",
    "newton",
    "krylov",
    "residual_initial",
    "residual",
    "preconditioner_builds",
    "rejected",
    "mass",
    "mass_error",
    "energy",
    "energy_error",
];

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

/// Columns of history.csv: the columns of every run, and for each wall its loads at the top of the slab, over the slab and since the
/// start. For each inflow and outflow there is the mass that leaves per time at the top. A structure has its own columns.
pub fn columns<const D: usize>(case: &Case<D>) -> Vec<String> {
    if let (None, Some(structure)) = (&case.flow, &case.structure) {
        return columns_of_structure(case, structure);
    }
    let mut columns: Vec<String> = OF_MESH.map(String::from).to_vec();
    let Some(flow) = &case.flow else { return columns };
    columns.extend(OF_FLOW.map(String::from));
    for wall in &flow.walls {
        columns.extend(of_wall::<D>().iter().map(|column| format!("{}_{column}", wall.name)));
    }
    columns.extend(openings(flow).map(|boundary| format!("{}_mass_flow", case.mesh.boundary_names()[boundary])));
    columns.extend(bodies::columns(case));
    columns.extend(opening_states::columns(case));
    columns.extend(probes::columns(case));
    columns.extend(case.output.integrals.iter().map(|integral| integral_name(*integral).to_owned()));
    columns.extend(case.controls.iter().map(controls::column));
    columns
}

/// Every column has a name of its own: readers look for names.
///
/// # Errors
/// The name that two columns have.
pub fn require_distinct_columns<const D: usize>(case: &Case<D>) -> Result<(), Failure> {
    let mut columns = columns(case);
    columns.sort_unstable();
    let Some(pair) = columns.windows(2).find(|pair| pair[0] == pair[1]) else { return Ok(()) };
    Err(Failure::bad_input(anyhow::anyhow!(
        "two columns of history.csv would be named `{}`: rename a probe, a point, a formula or a body of the case, or a boundary of the mesh",
        pair[0]
    )))
}

fn integral_name(integral: Integral) -> &'static str {
    match integral {
        Integral::KineticEnergy => "kinetic_energy",
        Integral::Enstrophy => "enstrophy",
        Integral::Entropy => "entropy",
        Integral::MomentumX => "momentum_x",
        Integral::MomentumY => "momentum_y",
        Integral::MomentumZ => "momentum_z",
    }
}

/// The inflows and outflows of a flow.
pub fn openings<const D: usize>(flow: &Flow<D>) -> impl Iterator<Item = usize> {
    (0..flow.boundary.len()).filter(|&boundary| is_opening(&flow.boundary[boundary].condition))
}

/// Columns of a wall, in the order of [`row_of_wall`].
fn of_wall<const D: usize>() -> Vec<String> {
    let axes = &AXES[..D];
    let vector = |name: &'static str| axes.iter().map(move |axis| format!("{name}_{axis}"));
    let moment = |name: &'static str| match D {
        2 => vec![name.to_string()],
        _ => vector(name).collect(),
    };
    let mut columns: Vec<String> = ["force", "pressure_force", "friction_force"].into_iter().flat_map(vector).collect();
    columns.extend(moment("moment"));
    columns
        .extend(["power", "heat_flow", "drag_coefficient", "lift_coefficient", "moment_coefficient"].map(String::from));
    for [impulse, moment_impulse, work, heat] in [
        ["impulse_in_slab", "moment_impulse_in_slab", "work_in_slab", "heat_in_slab"],
        ["total_impulse", "total_moment_impulse", "total_work", "total_heat"],
    ] {
        columns.extend(vector(impulse));
        columns.extend(moment(moment_impulse));
        columns.extend([work, heat].map(String::from));
    }
    columns
}

/// The row of a wall; `total` are its impulses, work and heat since the start.
fn row_of_wall<const D: usize>(wall: &Wall<D>, loads: &WallLoads<D>, total: &WallForce<D>) -> Vec<f64> {
    let now = &loads.at_top;
    let Coefficients { drag, lift, moment: turning } = wall.scales.coefficients(now);
    let mut row: Vec<f64> = [now.force(), now.pressure, now.friction].concat();
    row.extend(wall.moments(now));
    row.extend([now.power, now.heat, drag, lift, turning]);
    for sum in [&loads.during, total] {
        row.extend(sum.force());
        row.extend(wall.moments(sum));
        row.extend([sum.power, sum.heat]);
    }
    row
}

/// With the reactions of supports, the displacement of every point and the coordinate of every natural mode.
fn columns_of_structure<const D: usize>(case: &Case<D>, structure: &Structure<D>) -> Vec<String> {
    let reactions = bodies::reaction_names(structure, &case.mesh);
    let points = bodies::point_names(structure);
    let modes = (1..=structure.natural_modes).map(|mode| format!("mode_{mode}"));
    OF_STRUCTURE.map(String::from).into_iter().chain(reactions).chain(points).chain(modes).collect()
}

/// A row of the mesh alone.
pub fn row_of_mesh(interval: Interval, iterations: usize, quality: &MeshQuality) -> Vec<f64> {
    let MeshQuality { lower_bound, sampled_min, scaled_jacobian, .. } = *quality;
    vec![interval.end, interval.length(), iterations as f64, lower_bound, sampled_min, scaled_jacobian]
}

/// A row of a structure, up to its points; `balance` includes the slab.
pub fn row_of_structure(report: &StructureReport, balance: &EnergyBalance) -> Vec<f64> {
    let StructureReport { interval, dynamics, kinetic_energy, strain_energy, reactions, .. } = report;
    let energy = kinetic_energy + strain_energy;
    let time = [interval.end, interval.length(), dynamics.iterations as f64];
    let work = [balance.load_work, balance.support_work, balance.dissipation, balance.error(energy)];
    [&time[..], &[*kinetic_energy, *strain_energy, energy], &work, reactions].concat()
}

/// A row of mesh and flow, with the loads of the walls; `statistics` includes the slab.
pub fn row<const D: usize, const M: usize>(
    flow: &Flow<D>,
    report: &SlabReport<M>,
    loads: &[WallLoads<D>],
    bodies: &[BodyState],
    statistics: &RunStatistics,
) -> Vec<f64> {
    let SlabReport { interval, newton, residual_norms, counts, totals, .. } = report;
    let mut row = row_of_mesh(*interval, counts.elasticity_iterations, &report.quality);
    row.push(report.jump);
    row.extend([newton.steps.len() as f64, newton.krylov_iterations as f64]);
    row.extend(residual_norms);
    row.extend([counts.rebuilds as f64, report.rejected as f64]);
    let (held, created) =
        (Conserved::<f64, D>::unpack::<M>(&from_fn(|m| totals[m])), statistics.balances::<D, M>(totals));
    let known = |error: f64, is_known: bool| if is_known { error } else { f64::NAN };
    row.extend([held.density, known(created.density, flow.conserves_mass())]);
    row.extend([held.energy, known(created.energy, flow.source.is_none())]);
    let totals = |wall: usize| from_numbers(statistics.impulses.get(wall).map_or(&[][..], Vec::as_slice));
    let walls = flow.walls.iter().zip(loads).enumerate();
    row.extend(walls.flat_map(|(number, (wall, loads))| row_of_wall(wall, loads, &totals(number))));
    row.extend(openings(flow).map(|boundary| statistics.mass_flows.get(boundary).copied().unwrap_or(f64::NAN)));
    row.extend(bodies.iter().flat_map(bodies::row));
    row
}
