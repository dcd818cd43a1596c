//! Warnings about what mesh, slabs and quadrature resolve.

use super::Facts;
use super::warnings::{Warning, warning};
use crate::commands::quality::{centre, least_orthogonal};
use case::{Case, Flow, RigidBody};
use fem::Quadrature;
use mesh::Mesh;
use navier_stokes::Boundary;
use simulation::PrescribedNode;
use tensor::norm;

/// A motion with fewer nodes in time per period is badly resolved.
pub(super) const NODES_PER_PERIOD: f64 = 12.0;

/// Below this Mach number the pressure at rest is large beside that of the motion. At 0.1, with a collocated rule and two nodes in time, the angle of a
/// cylinder that turns to and fro in 31 slabs is off by 1.7 %.
const SLOW: f64 = 0.15;

/// Walls translate if their ways differ by at most this part.
const TRANSLATION: f64 = 0.01;

/// The number of times at which ways of walls are compared.
const TIMES_OF_MOTION: usize = 16;

/// A boundary layer with fewer nodes across is badly resolved.
const NODES_IN_LAYER: f64 = 5.0;

/// Split cells with a smaller orthogonality, or a smaller scaled Jacobian, are poor.
const POOR_CELL: f64 = 0.1;

/// Without walls a flow with a larger Reynolds number of a distance of nodes is not resolved.
const CELL_REYNOLDS: f64 = 100.0;

/// Poor cells of a file, which may be pieces of triangles, tetrahedra or prisms, or of a box that a formula maps.
pub(super) fn poor_cells<const D: usize>(facts: &Facts<'_, D>) -> Option<Warning> {
    if !facts.case.are_cells_given {
        return None;
    }
    let (mesh, may_be_split) = (&facts.case.mesh, facts.case.splits_simplices);
    let (flat, distorted) = (flat_cell(mesh), distorted_cell(mesh, facts.most_distorted, may_be_split));
    let remedy = match (&flat, &distorted) {
        (None, None) => return None,
        _ if !may_be_split => "cells with larger angles",
        (Some(_), _) if D == 2 => "less acute triangles, or quadrilaterals",
        (None, _) if D == 2 => "less curved triangles, or quadrilaterals",
        _ => "hexahedra, or prisms of less acute triangles",
    };
    let problems = flat.into_iter().chain(distorted).collect::<Vec<_>>().join("; ");
    warning("cells", format!("poor cells: {problems}; a mesh of {remedy}"))
}

/// The least orthogonal cell, if it is poor.
fn flat_cell<const D: usize>(mesh: &Mesh<D>) -> Option<String> {
    let (cell, orthogonality) = least_orthogonal(mesh);
    let at = centre(mesh, cell);
    (orthogonality < POOR_CELL).then(|| {
        format!("the orthogonality of cell {cell} at {at:.4?} is {orthogonality:.3}, where 1 is rectangular and 0 flat")
    })
}

/// The most distorted cell, if it is poor: a piece of a tetrahedron always is.
fn distorted_cell<const D: usize>(
    mesh: &Mesh<D>,
    (cell, scaled_jacobian): (usize, f64),
    may_be_split: bool,
) -> Option<String> {
    let most = match D {
        _ if !may_be_split => "",
        2 => " (at most 1/3 in a piece of a triangle)",
        _ => " (at most 2/27 in a piece of a tetrahedron, 1/3 of a prism)",
    };
    (scaled_jacobian < POOR_CELL).then(|| {
        format!(
            "the scaled Jacobian of cell {cell} at {:.4?} is {scaled_jacobian:.3}, where 1 is undistorted and 0 degenerate{most}",
            centre(mesh, cell)
        )
    })
}

/// Fewer points of quadrature than conserve.
pub(super) fn quadrature<const D: usize>(facts: &Facts<'_, D>, flow: &Flow<D>) -> Option<Warning> {
    let orders = facts.orders(flow);
    let (taken, needed) = (flow.quadrature.space_points(D, orders), Quadrature::Conserving.space_points(D, orders));
    if flow.quadrature.conserves(D, orders) {
        return None;
    }
    let text = format!(
        "{taken} points per direction, while conservation on a curved moving mesh needs {needed}: `flow.quadrature = \"conserving\"`"
    );
    warning("quadrature", text)
}

/// Collocated rules at one or two times of a slab: the pressure of the gas at rest then works on walls that turn.
pub(super) fn times_of_quadrature<const D: usize>(
    facts: &Facts<'_, D>,
    flow: &Flow<D>,
    walls: &[PrescribedNode<D>],
) -> Option<Warning> {
    let case = facts.case;
    let collocated = matches!(flow.quadrature, Quadrature::Collocated(_));
    if !collocated || case.motion.is_none() && case.bodies.is_empty() {
        return None;
    }
    let text = match case.time.order {
        1 => {
            "with one node in time a collocated rule sees a slab at one time only, and pressure at rest works on walls that turn: \
             `time.order = 2` or more, or `flow.quadrature = \"conserving\"`"
        }
        2 if flow.law.reference.mach() < SLOW && turns(case, walls) => {
            "with two nodes in time and a collocated rule pressure at rest works on walls that turn, the more the slower the flow is beside \
             sound: shorter slabs, `time.order = 3`, or `flow.quadrature = \"conserving\"`"
        }
        _ => return None,
    };
    warning("quadrature in time", text.to_owned())
}

/// Whether walls do more than translate: structures, bodies that rotate, or nodes with different ways.
fn turns<const D: usize>(case: &Case<D>, walls: &[PrescribedNode<D>]) -> bool {
    let differs = |t: f64| {
        let way = |(node, x, field): &PrescribedNode<D>| field.displacement(*node, x, t);
        let ways: Vec<[f64; D]> = walls.iter().map(way).collect();
        let longest = ways.iter().map(norm).fold(0.0, f64::max);
        let apart = |other: &[f64; D]| norm(&std::array::from_fn::<f64, D, _>(|i| other[i] - ways[0][i]));
        ways.iter().any(|other| apart(other) > TRANSLATION * longest)
    };
    let (start, end) = (case.time.start, case.time.end);
    let times = (1..=TIMES_OF_MOTION).map(|k| start + (end - start) * k as f64 / TIMES_OF_MOTION as f64);
    case.structure.is_some() || case.bodies.iter().any(RigidBody::rotates) || times.into_iter().any(differs)
}

/// A periodic motion with too few nodes in time.
pub(super) fn slab_length<const D: usize>(facts: &Facts<'_, D>) -> Option<Warning> {
    let (time, scales) = (&facts.case.time, facts.motion?);
    let period = std::f64::consts::TAU / scales.frequency();
    let nodes = period / time.step * time.order as f64;
    // A run shorter than half a period has no periodic motion.
    if nodes >= NODES_PER_PERIOD || time.end - time.start < 0.5 * period {
        return None;
    }
    let step = period * time.order as f64 / NODES_PER_PERIOD;
    let text = format!(
        "a period of the motion, about {period:.2e}, has {nodes:.1} nodes in time, fewer than {NODES_PER_PERIOD}: `time.step` of {step:.2e} \
         or less, or a higher `time.order`"
    );
    warning("slab length", text)
}

/// Slabs in which the flow passes its length more often than they have nodes in time.
pub(super) fn passages<const D: usize>(facts: &Facts<'_, D>, flow: &Flow<D>) -> Option<Warning> {
    let (case, time) = (facts.case, &facts.case.time);
    let longest = time.order as f64 * flow.time_unit();
    // A flow that repeats itself may be marched to its steady state. A steady start makes slabs of its own, and slabs that adapt find their length.
    let is_open = flow.boundary.iter().any(|data| !data.condition.is_solid());
    if time.step <= longest || !is_open || case.solver.steady.is_some() || time.control.is_some() {
        return None;
    }
    let text = format!(
        "in a slab the flow passes {:.1} times its length, {:.3e}, with {} nodes in time: `time.step` of {longest:.2e} or less to see how it changes",
        time.step / flow.time_unit(),
        flow.time_length,
        time.order
    );
    warning("slab length", text)
}

/// A motion that rests for a while, which slabs that adapt may step over: they see it at a few times only.
pub(super) fn longest_slab<const D: usize>(facts: &Facts<'_, D>) -> Option<Warning> {
    let (time, scales) = (&facts.case.time, facts.motion?);
    let (largest, period) = (time.control?.largest, std::f64::consts::TAU / scales.frequency());
    let wanted = 0.25 * period;
    if scales.rest < period || largest <= wanted {
        return None;
    }
    // The longest slab is at least as long as the first one.
    let keys = if time.step > wanted { "`time.step` and `time.adaptive.largest`" } else { "`time.adaptive.largest`" };
    let text = format!(
        "the motion rests for a time of {:.2e}, in which slabs may grow up to {largest:.2e}; they see the motion at a few times only, and may step over \
         what follows, with a period of about {period:.2e}: {keys} of {wanted:.2e} or less",
        scales.rest
    );
    warning("longest slab", text)
}

/// A boundary layer with too few nodes, or a turbulent one.
pub(super) fn layer<const D: usize>(facts: &Facts<'_, D>, flow: &Flow<D>) -> Option<Warning> {
    let (plate, height) = (facts.plate?, facts.walls?.cell_height? / flow.reference_length);
    if plate.is_turbulent() {
        let text = format!(
            "at this Reynolds number a boundary layer is turbulent, and there is no turbulence model: a lower Reynolds number, or a mesh in space \
             that resolves turbulence{}",
            against_aliasing(flow)
        );
        return warning("turbulence", text);
    }
    let nodes = plate.thickness() / height * (flow.order as f64 - 1.0);
    // Between walls, in a stream that repeats itself, layers have met.
    let is_open = flow.boundary.iter().any(|data| !data.condition.is_solid());
    if nodes >= NODES_IN_LAYER || !is_open {
        return None;
    }
    let text = format!(
        "about {nodes:.1} nodes across the boundary layer of thickness {:.2e}, fewer than {NODES_IN_LAYER}: thinner cells at the wall (`first_cell` \
         of a generator), or a higher `flow.order`{}",
        plate.thickness() * flow.reference_length,
        against_aliasing(flow)
    );
    warning("first cell", text)
}

/// A viscous flow without walls and far field, such as decaying turbulence in a box, whose smallest scales the mesh does not resolve.
pub(super) fn free_flow<const D: usize>(facts: &Facts<'_, D>, flow: &Flow<D>) -> Option<Warning> {
    let (plate, advice) = (facts.plate?, against_aliasing(flow));
    let has_far_field = flow.boundary.iter().any(|data| matches!(data.condition, Boundary::FarField(_)));
    let distance = facts.smallest_size / (flow.order as f64 - 1.0);
    let reynolds = plate.reynolds() * distance / flow.reference_length;
    let is_smooth = flow.exact.is_some() || has_far_field || !flow.walls.is_empty();
    if is_smooth || advice.is_empty() || reynolds <= CELL_REYNOLDS {
        return None;
    }
    let text = format!(
        "the Reynolds number of a distance of nodes is {reynolds:.0}: more cells, or a higher `flow.order`{advice}"
    );
    warning("resolution", text)
}

/// What keeps a flow stable that the mesh does not resolve, for the end of a warning; empty if it is in use.
fn against_aliasing<const D: usize>(flow: &Flow<D>) -> &'static str {
    let is_split = flow.law.volume_flux.is_split();
    match flow.quadrature {
        Quadrature::ThreeHalves | Quadrature::Double => "",
        _ if is_split => "",
        _ => {
            "; where the mesh does not resolve the flow, `flow.quadrature = \"three_halves\"` is more robust, and so is \"collocated_lobatto\" with \
             `flow.volume_flux = \"entropy\"`"
        }
    }
}
