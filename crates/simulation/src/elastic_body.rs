//! The structure beside a flow, as a body.

use super::bodies::extent;
use super::build::{StructureAtStart, structure_at_start};
use case::{Case, Flow, SolidPart, Structure};
use coupled::Observation;
use coupled::blocks::elastic_body::{ElasticBodyData, Interface};
use coupled::blocks::{ElasticBody, SlabTimes};
use elasticity::{ElasticityError, FluidLayer};
use fem::SlabOperator;

/// The depth of the fluid that moves with a structure, as a fraction of the extent of the structure, for the preconditioner.
const DEPTH: f64 = 0.1;

/// Body number `number` of `case`: the structure and its part of the mesh.
///
/// # Errors
/// As [`structure_at_start`].
pub fn elastic_body<const D: usize, const M: usize>(
    case: &Case<D>,
    flow: &Flow<D>,
    (structure, part): (&Structure<D>, &SolidPart<D>),
    operator: &SlabOperator<D, M>,
    number: usize,
    times: SlabTimes,
) -> Result<ElasticBody<D>, ElasticityError> {
    let StructureAtStart { body, loads, supports, displacement, mut velocity } = structure_at_start(case, structure)?;
    supports.set(&body, &mut velocity, |field, x| field.rate(x, case.time.start));
    let mut wet = vec![false; body.numbering().count];
    for &wall in &part.wet {
        body.numbering().on_boundary(body.mesh(), wall).into_iter().for_each(|node| wet[node] = true);
    }
    let density = flow.law.reference.density();
    let fluid = FluidLayer {
        density,
        speed_of_sound: flow.law.gas.sound_speed(density, flow.reference_pressure()),
        depth: DEPTH * extent(&case.mesh, &part.walls),
        areas: body.wet_areas(&wet),
    };
    // The case has been checked, so every point is in the mesh.
    let point = |(_, x): &(String, [f64; D])| Observation::new(body.mesh(), body.numbering(), x);
    let points = structure.points.iter().filter_map(point).collect();
    let data = ElasticBodyData { structure: body, loads, supports, displacement, velocity, fluid, points };
    let interface = Interface::new(&part.shared, operator.loaded_nodes());
    Ok(ElasticBody::new(data, interface, number, times))
}
