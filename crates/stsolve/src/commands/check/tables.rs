//! Figures of a case without trial computations.

use super::super::quality::least_orthogonal;
use super::super::table::Table;
use super::{Facts, blocks, outputs};
use case::{About, Analysis, Case, Flow, Motion, Plane, Preconditioner, Structure, StructureLaw, Support};
use elasticity::{Law, Solver};
use mesh::Mesh;
use serde_json::Value;
use simulation::typical_iterations;

/// All tables except the defaults.
pub(super) fn known<const D: usize>(facts: &Facts<'_, D>) -> Vec<Table> {
    let case = facts.case;
    let mut tables = vec![about(&case.about), mesh_table(facts), time_table(case)];
    tables.extend(case.motion.as_ref().map(|motion| motion_table(facts, motion)));
    tables.extend(case.structure.as_ref().map(|structure| structure_table(case, structure)));
    if let Some(flow) = &case.flow {
        tables.push(flow_table(facts, flow));
        tables.extend(wall_table(facts, flow));
        tables.extend(blocks::table(case, flow));
    }
    tables.extend(outputs::table(case));
    tables.push(cost_table(facts));
    tables
}

fn about(about: &About) -> Table {
    let mut table = Table::new("case");
    table.row("name", about.name.clone(), "").row("title", about.title.clone(), "");
    table
}

fn mesh_table<const D: usize>(facts: &Facts<'_, D>) -> Table {
    let (mesh, (cell, scaled_jacobian)) = (&facts.case.mesh, facts.most_distorted);
    let (sheared, orthogonality) = least_orthogonal(mesh);
    let mut table = Table::new("mesh");
    table
        .row("dimension", D, "")
        .row("cells", mesh.n_cells(), "")
        .row("order", mesh.order(), "nodes per direction")
        .row("volume", mesh.volume(), "")
        .row("smallest cell", facts.smallest_size, "")
        .row("largest aspect ratio", largest_aspect_ratio(mesh), "")
        .row("smallest scaled Jacobian", scaled_jacobian, "1: det J is constant, 0: degenerate")
        .row("most distorted cell", cell, "")
        .row("smallest orthogonality", orthogonality, "1 is rectangular, 0 flat")
        .row("least orthogonal cell", sheared, "")
        .row("boundaries", mesh.boundary_names().to_vec(), "");
    for region in mesh.regions() {
        table.row(&format!("region {}", region.name), region.cells.len(), "cells");
    }
    table
}

fn largest_aspect_ratio<const D: usize>(mesh: &Mesh<D>) -> f64 {
    (0..mesh.n_cells()).map(|cell| mesh.aspect_ratio(cell)).fold(1.0, f64::max)
}

fn time_table<const D: usize>(case: &Case<D>) -> Table {
    let time = &case.time;
    let mut table = Table::new("time");
    table
        .row("start", time.start, "")
        .row("end", time.end, "")
        .row("slabs", time.slabs, if time.control.is_some() { "if all were as long as the first" } else { "" })
        .row("length of a slab", time.step, if time.control.is_some() { "at first" } else { "" })
        .row("order", time.order, "nodes per slab");
    if let Some(from) = &case.restart {
        table.row("starts where this run stands", from.to_string_lossy().into_owned(), "");
    }
    if let Some(coupled::StepControl { tolerance, smallest, largest }) = time.control {
        table.row("jump aimed at", tolerance, "").row("shortest slab", smallest, "").row("longest slab", largest, "");
    }
    table
}

fn motion_table<const D: usize>(facts: &Facts<'_, D>, motion: &Motion<D>) -> Table {
    let case = facts.case;
    let mut table = Table::new("motion");
    match motion {
        Motion::Prescribed(_) => table.row("interior", "prescribed everywhere", ""),
        Motion::Followed => table.row("interior", "follows bodies by weights", ""),
        Motion::Elastic { poisson_ratio, law, boundary, slides, .. } => table
            .row("interior", law_name(*law), "")
            .row("Poisson's ratio", *poisson_ratio, "")
            .row("moving boundaries", boundary.iter().flatten().count(), "")
            .row("sliding boundaries", slides.iter().flatten().count(), ""),
    };
    if let Some(plan) = &facts.plan {
        let solver = match plan.solver {
            Solver::Direct => "direct",
            Solver::Multigrid => "conjugate gradients with multigrid",
            Solver::Bddc => "conjugate gradients with BDDC on blocks",
            Solver::ConjugateGradients | Solver::Automatic => "conjugate gradients with a low-order factor",
        };
        table.row("solver", solver, "").row("memory of the solver", plan.bytes as f64 / 1e6, "MB");
    }
    if let Some(scales) = facts.motion {
        table
            .row("amplitude A", scales.amplitude, "half of the largest path of a node")
            .row("largest speed V", scales.speed, "of that node")
            .row("angular frequency omega", scales.frequency(), "V / A")
            .row("slabs per period", std::f64::consts::TAU / (scales.frequency() * case.time.step), "");
    }
    table
}

fn structure_table<const D: usize>(case: &Case<D>, structure: &Structure<D>) -> Table {
    let count = |chosen: fn(&Support<D>) -> bool| structure.boundary.iter().filter(|support| chosen(support)).count();
    let mut table = Table::new("structure");
    if let Some(part) = &structure.part {
        table.row("cells", part.mesh.n_cells(), "beside those of the flow");
    }
    table.row("analysis", if structure.analysis == Analysis::Static { "static" } else { "dynamic" }, "");
    let law = match structure.law {
        StructureLaw::Linear => "linear",
        StructureLaw::StVenantKirchhoff => "St. Venant-Kirchhoff",
        StructureLaw::NeoHookean => "neo-Hookean",
    };
    table.row("law", law, "");
    if D == 2 {
        table.row("plane", if structure.plane == Plane::Stress { "stress" } else { "strain" }, "");
    }
    for (name, formula) in
        [("Young's modulus", &structure.young_modulus), ("Poisson's ratio", &structure.poisson_ratio)]
    {
        match formula.as_constant() {
            Some(value) => table.row(name, value, ""),
            None => table.row(name, "a formula", ""),
        };
    }
    if let Some(density) = structure.density {
        table.row("density", density, "").row("mass", density * structure.mesh(&case.mesh).volume(), "").row(
            "speed of shear waves",
            structure.shear_speed(),
            "",
        );
    }
    table
        .row("supported boundaries", count(|support| support.fixes() != [false; D]), "")
        .row(
            "loaded boundaries",
            count(|s| matches!(s, Support::Traction(_) | Support::Pressure(_) | Support::FollowerPressure(_))),
            "",
        )
        .row("natural modes", structure.natural_modes, "");
    table
}

fn law_name(law: Law) -> &'static str {
    match law {
        Law::Linear => "linear elasticity about the initial mesh",
        Law::Incremental => "linear elasticity about the mesh at the start of each slab",
        Law::NeoHookean => "neo-Hookean elasticity about the initial mesh",
        Law::StVenantKirchhoff => "St. Venant-Kirchhoff elasticity about the initial mesh",
    }
}

fn flow_table<const D: usize>(facts: &Facts<'_, D>, flow: &Flow<D>) -> Table {
    let (gas, reference) = (&flow.law.gas, &flow.law.reference);
    let reynolds = reference.reynolds(gas, flow.reference_length);
    let orders = facts.orders(flow);
    let mut table = Table::new("flow");
    table
        .row("order", flow.order, "nodes per direction and cell")
        .row("numerical flux", flow.law.riemann.name(), "")
        .row("quadrature points", flow.quadrature.space_points(D, orders), "per direction")
        .row("quadrature points in time", flow.quadrature.time_points(D, orders), "per slab")
        .row("ratio of specific heats", gas.gamma(), "")
        .row("Mach number", reference.mach(), "");
    if let Some([x, y, ..]) = flow.uniform_velocity.as_ref().map(|velocity| &velocity[..]).filter(|w| w[1] != 0.0) {
        table.row("direction of the stream", y.atan2(*x).to_degrees(), "degrees from x to y");
    }
    table
        .row(
            "Reynolds number",
            if reynolds.is_finite() { Value::from(reynolds) } else { "infinite (no viscosity)".into() },
            "",
        )
        .row("Prandtl number", gas.prandtl(), "")
        .row("acoustic CFL number", facts.acoustic_cfl(flow), "");
    if let Some(scales) = facts.motion {
        let (length, speed, omega) = (flow.reference_length, flow.reference_speed, scales.frequency());
        let strouhal = omega * scales.amplitude / (std::f64::consts::PI * speed);
        table.row("Strouhal number", strouhal, "2 A f / U");
        table.row("reduced frequency", 0.5 * omega * length / speed, "omega L / (2 U)");
    }
    table
}

/// The resolution of the first cell at the walls.
fn wall_table<const D: usize>(facts: &Facts<'_, D>, flow: &Flow<D>) -> Option<Table> {
    let walls = facts.walls?;
    let mut table = Table::new("walls");
    if walls.far_field.is_finite() {
        table.row("distance of the far field", walls.far_field / flow.reference_length, "reference lengths");
    }
    if let (Some(plate), Some(height)) = (facts.plate, walls.cell_height) {
        let relative = height / flow.reference_length;
        let friction = if plate.is_turbulent() { "of a turbulent flat plate" } else { "of a laminar flat plate" };
        table
            .row("first cell", height, "height, at most")
            .row("first cell in wall units", plate.wall_units(relative), friction)
            .row("first node in wall units", plate.wall_units(relative) / (flow.order as f64 - 1.0), "on average")
            .row("boundary layer", plate.thickness() * flow.reference_length, friction)
            .row("first cells across it", plate.thickness() / relative, "");
    }
    (!table.is_empty()).then_some(table)
}

/// Unknowns of a slab, memory, and the size of the result.
fn cost_table<const D: usize>(facts: &Facts<'_, D>) -> Table {
    let case = facts.case;
    let mesh = case.mesh_unknowns().unwrap_or(0);
    let memory = facts.memory;
    let megabytes = |bytes: usize| bytes as f64 / 1e6;
    let mut table = Table::new("unknowns and memory");
    table
        .row("flow unknowns", case.flow_unknowns(), "per slab")
        .row("mesh unknowns", mesh, "per slab")
        .row("memory of a run", megabytes(memory.peak()), "MB, estimated, of which")
        .row("program", megabytes(simulation::PROGRAM_BYTES), "MB")
        .row("mesh", megabytes(memory.mesh), "MB, with the solver of an elastic one")
        .row("Jacobian blocks", megabytes(memory.jacobian), "MB")
        .row("preconditioner", megabytes(memory.factors), preconditioner(case))
        .row("vectors", megabytes(memory.vectors), format!("MB, with {} Krylov iterations", typical_iterations(case)))
        .row(
            "Krylov vectors",
            megabytes(memory.most_krylov),
            "MB at most, with `solver.krylov_restart` iterations, instead of those in `vectors`",
        );
    if memory.averages > 0 {
        table.row("averages", megabytes(memory.averages), "MB");
    }
    if let Some(steady) = memory.steady {
        table.row("steady flow", megabytes(steady.iter().sum()), "MB, in the place of these, with its coarse level");
    }
    table.row("result file", facts.result_megabytes, "MB");
    table
}

/// The unit of the memory of the preconditioner: which one it is, and why.
fn preconditioner<const D: usize>(case: &Case<D>) -> String {
    let name = match case.preconditioner() {
        Preconditioner::Blocks => "blocks of cells",
        Preconditioner::Lines => "lines of cells",
        Preconditioner::LowOrder => "low order",
    };
    let reason = match case.solver.preconditioner {
        Some(_) => "as asked for",
        None if case.has_moved_bodies() => "the cheapest for this dimension and order with bodies that the flow moves",
        None if D == 3 && case.has_thin_layer() => "the cheapest for a layer as thin as this",
        None => "the cheapest for this dimension and order",
    };
    format!("MB, {name}, {reason}")
}

/// Every default taken.
pub(super) fn defaults(about: &About) -> Table {
    let mut table = Table::new("defaults taken");
    for (key, value) in &about.defaults {
        table.row(key, value.clone(), "");
    }
    table
}
