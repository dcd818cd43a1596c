//! The parts of a mesh that a structure and a flow fill.

use super::mesh_crate::{Mesh, MeshError, Part};
use crate::cause::Cause;
use crate::checker::{Checked, Checker};
use crate::key::Key;
use crate::raw;
use std::collections::BTreeSet;

/// The part of a mesh that a structure fills beside a flow.
#[derive(Clone, Debug, PartialEq)]
pub struct SolidPart<const D: usize> {
    /// Its cells.
    pub mesh: Mesh<D>,
    /// The C0 nodes that it shares with the mesh of the flow: the number of each in the structure, and in the flow.
    pub shared: Vec<(usize, usize)>,
    /// Its boundaries towards the flow.
    pub wet: Vec<usize>,
    /// The boundaries of the mesh of the flow towards it.
    pub walls: Vec<usize>,
}

impl<const D: usize> SolidPart<D> {
    /// The names of its boundaries towards the flow.
    pub(super) fn wet_names(&self) -> impl Iterator<Item = &String> {
        self.wet.iter().map(|wall| &self.mesh.boundary_names()[*wall])
    }
}

/// The mesh of the flow, or of what there is without one, and the part of a structure beside a flow.
pub(super) fn split<const D: usize>(
    checker: &Checker<'_>,
    structure: Option<&raw::Structure>,
    has_flow: bool,
    mesh: Mesh<D>,
) -> Checked<(Mesh<D>, Option<SolidPart<D>>)> {
    let key = Key::new("structure").child("regions");
    let Some(regions) = structure.map(|structure| &structure.regions) else { return Ok((mesh, None)) };
    if regions.is_empty() {
        return if has_flow { Err(no_regions(checker, &mesh)) } else { Ok((mesh, None)) };
    }
    let names: Vec<&str> = checker.distinct(&key, "region", regions)?.iter().map(String::as_str).collect();
    let refused = |error: MeshError| checker.error(&key, Cause::Mesh(error));
    let solid = mesh.part(&names).map_err(refused)?;
    if !has_flow {
        return Ok((solid.mesh, None));
    }
    let fluid = mesh.part_without(&names).map_err(refused)?;
    let shared = mesh.interface(&solid, &fluid, mesh.order()).map_err(refused)?;
    let (wet, walls) = (interfaces(&solid, &mesh), interfaces(&fluid, &mesh));
    Ok((fluid.mesh, Some(SolidPart { mesh: solid.mesh, shared, wet, walls })))
}

fn no_regions<const D: usize>(checker: &Checker<'_>, mesh: &Mesh<D>) -> Box<crate::CaseError> {
    let names: Vec<String> = mesh.regions().iter().map(|region| format!("\"{}\"", region.name)).collect();
    let accepted = match names.is_empty() {
        true => "a mesh with regions, and `structure.regions`; or no [flow]".to_owned(),
        false => format!("`structure.regions`, of {}; or no [flow]", names.join(", ")),
    };
    checker.combination(&Key::new("structure"), "a structure beside a flow fills some regions of the mesh", &accepted)
}

/// The boundaries of `part` that lie inside of the `whole` mesh.
fn interfaces<const D: usize>(part: &Part<D>, whole: &Mesh<D>) -> Vec<usize> {
    let outside: BTreeSet<(usize, usize)> =
        whole.boundary_facets().iter().map(|facet| (facet.side.cell, facet.side.face)).collect();
    let inside = part.mesh.boundary_facets().iter().filter(|facet| {
        let side = (part.cells[facet.side.cell], facet.side.face);
        !outside.contains(&side)
    });
    inside.map(|facet| facet.boundary).collect::<BTreeSet<_>>().into_iter().collect()
}
