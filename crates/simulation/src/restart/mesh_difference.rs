//! The mesh of a case against that of the run that it continues.

use super::{Origin, RestartError};
use crate::nodal::by_node;
use case::{AllowedChange, Case};

/// The remedy if the flow can be interpolated.
const ALLOW_MESH: &str = "; `restart.allow = [\"mesh\"]` interpolates the flow";

/// How two meshes at rest differ.
enum MeshDifference {
    Dimension,
    Boundaries,
    Cells,
    /// The largest distance of a coordinate.
    Nodes(f64),
}

impl Origin {
    /// The mesh at rest must be the same, up to round-off, unless the case allows another one. Returns whether it is another one.
    pub(super) fn check_mesh<const D: usize>(&self, case: &Case<D>) -> Result<bool, RestartError> {
        match self.mesh_difference(case) {
            None => Ok(false),
            Some(MeshDifference::Cells | MeshDifference::Nodes(_)) if case.allows(AllowedChange::Mesh) => {
                if self.has_structure(case) {
                    let here = "one beside a structure, which cannot be interpolated";
                    return Err(self.differs("the mesh", "another one", here));
                }
                Ok(true)
            }
            Some(difference) => Err(self.told(case, &difference)),
        }
    }

    fn mesh_difference<const D: usize>(&self, case: &Case<D>) -> Option<MeshDifference> {
        let (there, here) = (&self.result.metadata.mesh, &case.mesh);
        if self.result.layout.grid.dimension != D {
            return Some(MeshDifference::Dimension);
        }
        if there.boundary_names != here.boundary_names() {
            return Some(MeshDifference::Boundaries);
        }
        if (self.cells_of_flow(), there.position.len()) != (here.n_cells(), here.coordinates().len()) {
            return Some(MeshDifference::Cells);
        }
        let distances =
            self.positions::<D>().into_iter().zip(here.coordinates()).map(|(there, here)| (there - here).abs());
        let apart = distances.fold(0.0, f64::max);
        (apart > 1e-12 * here.diameter()).then_some(MeshDifference::Nodes(apart))
    }

    fn told<const D: usize>(&self, case: &Case<D>, difference: &MeshDifference) -> RestartError {
        let (there, grid, here) = (&self.result.metadata.mesh, &self.result.layout.grid, &case.mesh);
        let size = |dimension: usize, cells: usize, numbers: usize| {
            format!("{cells} cells in {dimension} dimensions, {} nodes each", numbers / (dimension * cells).max(1))
        };
        let of_there = size(grid.dimension, self.cells_of_flow(), there.position.len());
        let of_here = size(D, here.n_cells(), here.coordinates().len());
        let can_be_allowed = !self.has_structure(case) && !case.allows(AllowedChange::Mesh);
        let remedy = if can_be_allowed { ALLOW_MESH } else { "" };
        let (quantity, there, here) = match difference {
            MeshDifference::Dimension => ("the mesh", of_there, of_here),
            MeshDifference::Boundaries => {
                ("the boundaries", there.boundary_names.join(", "), here.boundary_names().join(", "))
            }
            MeshDifference::Cells => ("the mesh", of_there, of_here + remedy),
            MeshDifference::Nodes(apart) => {
                ("nodes of the mesh at rest", "elsewhere".to_owned(), format!("up to {apart:e} apart{remedy}"))
            }
        };
        self.differs(quantity, there, here)
    }

    /// The positions at rest of the nodes of the flow in the file, `[cell][node][component]`.
    pub(super) fn positions<const D: usize>(&self) -> Vec<f64> {
        let position = &self.result.metadata.mesh.position;
        let in_cell = (position.len() / self.cells_of_flow().max(1)).max(1);
        position.chunks_exact(in_cell).flat_map(by_node::<D>).collect()
    }

    /// The cells of the flow in the file.
    pub(super) fn cells_of_flow(&self) -> usize {
        self.result.layout.grid.cells.saturating_sub(self.cells_of_structure())
    }

    /// The cells of a structure beside the flow in the file.
    fn cells_of_structure(&self) -> usize {
        let array = self.result.layout.exact.iter().find(|array| array.name == "structure_position");
        array.and_then(|array| array.axes.first()).map_or(0, |axis| axis.length)
    }

    /// Whether there is a structure here or there.
    pub(super) fn has_structure<const D: usize>(&self, case: &Case<D>) -> bool {
        case.structure.is_some() || self.cells_of_structure() > 0
    }
}
