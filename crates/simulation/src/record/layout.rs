//! The layout of the result file, and the data by which it is recognised.

use super::mesh_view::MeshView;
use super::{average_fields, averages};
use crate::averages::AverageSums;
use crate::bodies::beside_flow;
use crate::memory_estimate::averages_bytes;
use crate::surfaces::columns;
use case::Case;
use fem::Layout;
use output::{ArraySpec, Checksum, FieldSpec, FileLayout, Grid, Metadata, RestMesh};
use report::fields;

/// The fields that the case lists and that exist in it, and those of mesh and structure that every such run shows.
pub(super) fn drawn_fields<const D: usize>(case: &Case<D>) -> impl Iterator<Item = case::Field> + use<'_, D> {
    let (flows, has_structure) = (case.flow.is_some(), case.structure.is_some());
    let exists = move |field: &case::Field| match fields::of_structure(*field) {
        true => has_structure,
        false => flows || fields::of_mesh(*field),
    };
    let of_mesh = [case::Field::Jacobian, case::Field::MeshVelocity].into_iter().filter(move |_| !flows);
    let of_structure = [case::Field::Displacement, case::Field::VonMises].into_iter().filter(move |_| has_structure);
    let listed = case.output.fields.iter().copied().filter(exists);
    listed.chain(of_mesh.chain(of_structure).filter(|field| !case.output.fields.contains(field)))
}

/// The storage of these fields, and then of those by formulas.
pub(super) fn drawn_specs<const D: usize>(case: &Case<D>) -> impl Iterator<Item = FieldSpec> + use<'_, D> {
    let formulas = case.observed.formulas.iter().map(|formula| FieldSpec::scalar(&formula.name));
    drawn_fields(case).map(|field| fields::spec(field, D)).chain(formulas)
}

/// The order of the flow, or of the mesh without a flow.
pub(super) fn flow_order<const D: usize>(case: &Case<D>) -> usize {
    case.flow.as_ref().map_or(case.mesh.order(), |flow| flow.order)
}

/// The layout of the flow in a slab.
pub(super) fn flow_layout<const D: usize, const M: usize>(case: &Case<D>) -> Layout {
    let nodes = flow_order(case).pow(D as u32);
    Layout { cells: case.mesh.n_cells(), time_order: case.time.order, components: M, nodes }
}

pub(super) fn layout<const D: usize, const M: usize>(case: &Case<D>) -> FileLayout {
    let (cells, mesh_nodes, time) = (case.mesh.n_cells(), case.mesh.nodes_per_cell(), case.time.order);
    let points_per_direction = flow_order(case).max(case.mesh.order());
    let position = ArraySpec::new("position", &[("cell", cells), ("component", D), ("mesh node", mesh_nodes)]);
    let velocity = [("cell", cells), ("time node", time), ("component", D), ("mesh node", mesh_nodes)];
    let mut exact = vec![position, ArraySpec::new("mesh_velocity", &velocity)];
    if case.flow.is_some() {
        let nodes = flow_order(case).pow(D as u32);
        let axes = [("cell", cells), ("time node", time), ("component", M), ("flow node", nodes)];
        exact.push(ArraySpec::new("flow", &axes));
    }
    let beside = beside_flow(case).map_or(0, |(_, part)| part.mesh.n_cells());
    if beside > 0 {
        let position = [("structure cell", beside), ("component", D), ("mesh node", mesh_nodes)];
        let velocity = [("structure cell", beside), ("time node", time), ("component", D), ("mesh node", mesh_nodes)];
        exact.push(ArraySpec::new("structure_position", &position));
        exact.push(ArraySpec::new("structure_velocity", &velocity));
    }
    let mut fields: Vec<_> = drawn_specs(case).collect();
    if let Some(of_mesh) = average_fields(case, &AverageSums::default()) {
        exact.extend(of_mesh.averages().iter().map(|average| of_mesh.array(average)));
        fields.extend(of_mesh.averages().iter().map(averages::spec));
    }
    FileLayout { grid: Grid { dimension: D, points_per_direction, cells: cells + beside }, fields, exact }
}

/// The bytes of the result file of a whole run: all numbers have 8, and indices compress to almost nothing.
pub fn result_bytes<const D: usize, const M: usize>(case: &Case<D>) -> usize {
    let FileLayout { grid, fields, exact } = layout::<D, M>(case);
    let points = grid.cells * grid.points_per_direction.pow(D as u32);
    let drawn: usize = fields.iter().map(|field| field.components).sum();
    let step = exact.iter().map(ArraySpec::len).sum::<usize>() + points * (POSITION + drawn);
    let steps = 1 + case.time.slabs.div_ceil(case.output.every);
    let checkpoint = 2 * case.flow_unknowns() + averages_bytes(case) / 8;
    8 * (steps * step + checkpoint + distributions(case))
}

/// The components of a position in the file.
const POSITION: usize = 3;

/// The numbers of the distributions along walls, at about as many points per facet as the flow has nodes there.
fn distributions<const D: usize>(case: &Case<D>) -> usize {
    let (Some(every), walls) = (case.output.surfaces_every, &case.output.surfaces) else { return 0 };
    let names = case.mesh.boundary_names();
    let is_listed = |facet: &&mesh::BoundaryFacet| walls.contains(&names[facet.boundary]);
    let facets = case.mesh.boundary_facets().iter().filter(is_listed).count();
    let of_point: usize = columns(D).iter().map(|column| column.components).sum();
    facets * flow_order(case).pow(D as u32 - 1) * of_point * (1 + case.time.slabs.div_ceil(every))
}

/// A checksum of the parts that a run must share with the run that it continues: the `lasting` part of the case, and the
/// equations solved.
pub(super) fn fingerprint<const D: usize>(case: &Case<D>, lasting: &str) -> String {
    let solved = match (&case.flow, &case.structure) {
        (Some(_), _) => "mesh and flow",
        (None, Some(_)) => "structure",
        (None, None) => "mesh",
    };
    // The mesh is included, because it may come from a file that has changed.
    let solid = beside_flow(case).map_or(&[][..], |(_, part)| part.mesh.coordinates());
    let checksum = Checksum::default().text(lasting).text(solved);
    checksum.numbers(case.mesh.coordinates()).numbers(solid).to_string()
}

pub(super) fn metadata<const D: usize>(case: &Case<D>, mesh: &MeshView<D>) -> Metadata {
    Metadata {
        creator: format!("stsolve {}", env!("CARGO_PKG_VERSION")),
        case_name: case.about.name.clone(),
        case_text: case.about.resolved.clone(),
        case_fingerprint: fingerprint(case, &case.about.lasting),
        mesh_id: Checksum::default().numbers(case.mesh.coordinates()).to_string(),
        space_nodes: basis::gauss_lobatto(flow_order(case)).points,
        time_nodes: basis::RadauTime::new(case.time.order).nodes().to_vec(),
        mesh: rest_mesh(case, mesh),
    }
}

fn rest_mesh<const D: usize>(case: &Case<D>, mesh: &MeshView<D>) -> RestMesh {
    let facet = |facet: &mesh::BoundaryFacet| [facet.side.cell, facet.side.face, facet.boundary].map(|i| i as i64);
    RestMesh {
        position: mesh.positions.concat(),
        boundary_names: case.mesh.boundary_names().to_vec(),
        boundary_facets: case.mesh.boundary_facets().iter().map(facet).collect(),
    }
}
