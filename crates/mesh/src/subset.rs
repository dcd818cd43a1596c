//! Some cells of a mesh, for a rank that works on no others.

use crate::{BoundaryFacet, InteriorFacet, Mesh, NodeNumbering, Side};

/// Cells of a whole mesh with other numbers.
///
/// Not every face of its mesh has a facet: cells that are only neighbours of the others have those that lead to these.
#[derive(Clone, Debug)]
pub struct Subset<const D: usize> {
    /// The cells. Boundaries have the numbers that they have in the whole mesh.
    pub mesh: Mesh<D>,
    /// For every boundary facet its number in the whole mesh.
    pub boundary_facets: Vec<usize>,
}

impl<const D: usize> Mesh<D> {
    /// The `cells` in this order, with all facets of the first `own` of them. Facets keep their order and their sides.
    pub fn subset(&self, cells: &[usize], own: usize) -> Subset<D> {
        let mut number = vec![None; self.n_cells()];
        cells.iter().enumerate().for_each(|(new, &old)| number[old] = Some(new));
        let side = |side: Side| number[side.cell].map(|cell| Side { cell, ..side });
        let interior = |facet: &InteriorFacet| {
            let (minus, plus) = (side(facet.minus)?, side(facet.plus)?);
            (minus.cell < own || plus.cell < own).then_some(InteriorFacet { minus, plus, ..*facet })
        };
        let boundary = |(number, facet): (usize, &BoundaryFacet)| {
            let side = side(facet.side).filter(|side| side.cell < own)?;
            Some((number, BoundaryFacet { side, ..*facet }))
        };
        let (boundary_facets, facets): (Vec<_>, Vec<_>) =
            self.boundary_facets.iter().enumerate().filter_map(boundary).unzip();
        let mesh = Mesh {
            order: self.order,
            corners: cells.iter().flat_map(|&cell| self.corners(cell).iter().copied()).collect(),
            coordinates: cells.iter().flat_map(|&cell| self.cell_coordinates(cell).iter().copied()).collect(),
            interior_facets: self.interior_facets.iter().filter_map(interior).collect(),
            boundary_facets: facets,
            boundary_names: self.boundary_names.clone(),
            regions: Vec::new(),
            interfaces: Default::default(),
        };
        Subset { mesh, boundary_facets }
    }
}

impl NodeNumbering {
    /// The rows of `cells`. Nodes keep their numbers in the whole mesh, and `count` is the count of the whole mesh.
    pub fn subset(&self, cells: &[usize]) -> NodeNumbering {
        self.with_cells(cells.iter().flat_map(|&cell| self.cell(cell).iter().copied()).collect())
    }
}
