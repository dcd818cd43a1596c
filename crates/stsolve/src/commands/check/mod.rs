//! `stsolve check`
//!
//! | module | holds |
//! |---|---|
//! | `tables` | figures of a case without trial computations |
//! | `outputs` | what a case observes: averages, distributions, points, lines, planes, formulas |
//! | `observed` | warnings about that |
//! | `scales` | speed and amplitude of the motion of the mesh |
//! | `walls` | resolution of the first cell at a wall |
//! | `measured` | measurements of trial computations |
//! | `warnings` | choices that are allowed but likely wrong |
//! | `gas`, `streams`, `bodies` | those about the gas, its streams, and bodies in it |
//! | `resolution` | warnings about what mesh, slabs and quadrature resolve |

mod blocks;
mod bodies;
mod gas;
mod measured;
mod observed;
mod outputs;
mod resolution;
mod scales;
mod streams;
mod tables;
mod walls;
mod warnings;

use super::print;
use super::table::Table;
use crate::cli::Probe;
use case::{AnyCase, Case, Flow};
use elasticity::Plan;
use scales::MotionScales;
use serde_json::{Map, Value};
use simulation::{Failure, MemoryEstimate, Mismatch, OpeningRecord, Preflight, PrescribedNode, check_controls};
use walls::{FlatPlate, Walls};
use warnings::{Warning, warnings};

/// Explains a checked case; `probe` decides about trial computations.
///
/// # Errors
/// If stdout cannot be written, or if the case starts from a result that does not exist or does not fit.
pub fn check(case: &AnyCase, json: bool, probe: Probe) -> Result<(), Failure> {
    // Inside the pool, as in a run.
    let tables = rayon::scope(|_| match case {
        AnyCase::Plane(case) => explain(case, probe),
        AnyCase::Space(case) => explain(case, probe),
    })?;
    if json {
        let object: Map<String, Value> = tables.iter().map(Table::json).collect();
        return print(&Value::Object(object).to_string());
    }
    print(&tables.iter().map(Table::text).collect::<Vec<_>>().join("\n"))
}

/// A case, and figures that follow from it.
pub(super) struct Facts<'a, const D: usize> {
    case: &'a Case<D>,
    /// The smallest edge of the boxes, along the axes, around the cells.
    smallest_size: f64,
    /// The cell with the smallest scaled Jacobian at rest, and that value.
    most_distorted: (usize, f64),
    /// The C0 nodes with a prescribed motion.
    prescribed: Vec<PrescribedNode<D>>,
    motion: Option<MotionScales>,
    memory: MemoryEstimate,
    /// The size of the result file, in MB.
    result_megabytes: f64,
    /// The solver of an elastic mesh.
    plan: Option<Plan>,
    walls: Option<Walls>,
    /// The boundary layer of a flow with viscosity.
    plate: Option<FlatPlate>,
}

impl<'a, const D: usize> Facts<'a, D> {
    fn new(case: &'a Case<D>) -> Self
    where
        Case<D>: Preflight<D>,
    {
        let (flow, prescribed, plan) = (case.flow.as_ref(), case.prescribed_nodes(), case.elasticity_plan());
        Facts {
            case,
            smallest_size: (0..case.mesh.n_cells())
                .flat_map(|cell| case.mesh.extents(cell))
                .fold(f64::INFINITY, f64::min),
            most_distorted: case.mesh.smallest_scaled_jacobian(),
            motion: MotionScales::new(case, &prescribed),
            prescribed,
            memory: MemoryEstimate::new(case, plan.as_ref()),
            result_megabytes: 1e-6 * case.result_bytes() as f64,
            plan,
            walls: flow.map(|flow| Walls::new(case, flow)),
            plate: flow
                .and_then(|flow| FlatPlate::new(flow.law.reference.reynolds(&flow.law.gas, flow.reference_length))),
        }
    }

    fn orders(&self, flow: &Flow<D>) -> fem::Orders {
        fem::Orders { flow: flow.order, mesh: self.case.mesh.order(), time: self.case.time.order }
    }

    /// The way of the fastest wave in a slab, in distances of nodes of the smallest cells.
    fn acoustic_cfl(&self, flow: &Flow<D>) -> f64 {
        let wave = flow.reference_speed * (1.0 + 1.0 / flow.law.reference.mach());
        wave * self.case.time.step / self.smallest_size * (flow.order as f64 - 1.0)
    }
}

fn explain<const D: usize>(case: &Case<D>, probe: Probe) -> Result<Vec<Table>, Failure>
where
    Case<D>: Preflight<D>,
{
    let mut of_restart = Vec::new();
    if let Some(flow) = &case.flow {
        of_restart = case.require_restart(flow)?;
        check_controls(case)?;
    }
    simulation::require_distinct_columns(case)?;
    simulation::check_structure(case)?;
    let facts = Facts::new(case);
    let mut tables = tables::known(&facts);
    let mut warnings = warnings(&facts);
    warnings.extend(of_restart.into_iter().map(|text| Warning { subject: "restart", text }));
    warnings.extend(observed::warnings(&facts));
    warnings.extend(misused_openings(case));
    tables.extend(mesh_over_run(case, probe, &mut warnings));
    tables.extend(seconds(&facts, probe, &mut warnings));
    tables.push(tables::defaults(&case.about));
    tables.push(warning_table(&warnings));
    Ok(tables)
}

/// Warns of inflows and outflows that the initial state does not fit.
fn misused_openings<const D: usize>(case: &Case<D>) -> Vec<Warning>
where
    Case<D>: Preflight<D>,
{
    let Some(flow) = &case.flow else { return Vec::new() };
    let warning = |record: &OpeningRecord| {
        let name = &case.mesh.boundary_names()[record.now.boundary];
        Warning { subject: "opening", text: format!("{}: {}", record.told(name), record.now.misuse.remedy(name)) }
    };
    let jump = |Mismatch { boundary, quantity, inside, target_state, .. }: &Mismatch| {
        let is_named = |(_, name): &(_, &String)| *name == boundary;
        let named = flow.boundary.iter().zip(case.mesh.boundary_names()).find(is_named);
        let remedy = match named.is_some_and(|(data, _)| data.condition.is_solid()) {
            true => "let the velocity across it fall to zero at it, by a formula in `flow.initial`".to_owned(),
            false => format!("compare `flow.boundary.{boundary}` with `flow.initial`, also their units"),
        };
        let text = format!(
            "the flow starts with a jump at `{boundary}`: the state that the condition sets there has a {quantity} of {target_state:.4e}, the gas \
             {inside:.4e}: {remedy}"
        );
        Warning { subject: "opening", text }
    };
    let jumps = if case.restart.is_some() { Vec::new() } else { case.jumps_at_openings(flow) };
    case.openings_at_start(flow).iter().map(warning).chain(jumps.iter().map(jump)).collect()
}

/// Moves the mesh over the run, if requested, and warns if it is not proved valid.
fn mesh_over_run<const D: usize>(case: &Case<D>, probe: Probe, warnings: &mut Vec<Warning>) -> Option<Table>
where
    Case<D>: Preflight<D>,
{
    if !measured::moves_mesh(case, probe) {
        return measured::mesh_not_moved(case, probe);
    }
    if case.is_moved_by_flow() && case.prescribed_nodes().is_empty() {
        return Some(measured::mesh_moved_by_flow());
    }
    let over_run = match case.move_over_run() {
        Ok(over_run) => over_run?,
        Err(error) => {
            warnings.push(Warning { subject: "mesh", text: format!("{error:#}") });
            return None;
        }
    };
    if let Some(time) = over_run.first_invalid {
        let text = format!(
            "cell {} is inverted or nearly so from t = {time:.6} on: a smaller motion, `motion.elasticity.stiffness` by `inverse_jacobian` \
             with a higher power, or `motion.elasticity.law = \"neo_hookean\"` for large rotations",
            over_run.quality.cell
        );
        warnings.push(Warning { subject: "mesh", text });
    }
    Some(measured::mesh_table(&over_run, case.is_moved_by_flow()))
}

/// Times the parts of a slab, if requested.
fn seconds<const D: usize>(facts: &Facts<'_, D>, probe: Probe, warnings: &mut Vec<Warning>) -> Option<Table>
where
    Case<D>: Preflight<D>,
{
    let flow = facts.case.flow.as_ref()?;
    if !measured::times_flow::<D>(facts.case.flow_unknowns(), probe) {
        return None;
    }
    match facts.case.time_flow(flow) {
        Ok(timing) => Some(measured::timing_table(facts.case, &timing)),
        Err(error) => {
            warnings.push(Warning { subject: "first slab", text: error.to_string() });
            None
        }
    }
}

fn warning_table(warnings: &[Warning]) -> Table {
    let mut table = Table::new("warnings");
    for Warning { subject, text } in warnings {
        table.row(subject, text.clone(), "");
    }
    if warnings.is_empty() {
        table.row("none", "", "");
    }
    table
}
