//! The mesh: cells, their curved geometry, and the facets between them.

use crate::facet::{corner_node, face_nodes};
use crate::numbering::unite_nodes;
use crate::region::NamedSides;
use crate::{
    BoundaryFacet, InteriorFacet, MeshError, PeriodicPair, Region, Side, geometry, periodic, region, topology, validity,
};
use tensor::norm;

/// Orders that a mesh may have.
pub const ORDERS: std::ops::RangeInclusive<usize> = 2..=16;

/// Quadrilaterals (D = 2) or hexahedra (D = 3), curved: the map of every cell is a polynomial of degree N - 1 per
/// direction, given by its values x(xi) at the N^D Gauss-Lobatto nodes.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh<const D: usize> {
    pub(crate) order: usize,
    pub(crate) corners: Vec<usize>,
    pub(crate) coordinates: Vec<f64>,
    pub(crate) interior_facets: Vec<InteriorFacet>,
    pub(crate) boundary_facets: Vec<BoundaryFacet>,
    pub(crate) boundary_names: Vec<String>,
    pub(crate) regions: Vec<Region>,
    pub(crate) interfaces: NamedSides,
}

impl<const D: usize> Mesh<D> {
    /// Builds a mesh and checks it. Every face has one partner, a name or a periodic twin. Neighbours share the nodes
    /// of their facet. det J > 0 is proved in every cell.
    ///
    /// * `order`: N, nodes per direction of the geometry, 2..=16
    /// * `corners`: vertex numbers, `[cell][2^D]`; bit a of the local number is the side along axis a
    /// * `coordinates`: `[cell][Gauss-Lobatto node, axis 0 fastest][D]`
    /// * `boundaries`: names, and the faces that belong to them
    /// * `periodic`: pairs of boundaries, by index, that are joined; they lose their names
    pub fn new(
        order: usize,
        corners: Vec<usize>,
        coordinates: Vec<f64>,
        boundaries: Vec<(String, Vec<Side>)>,
        periodic: Vec<PeriodicPair<D>>,
    ) -> Result<Self, MeshError> {
        Self::of_regions(order, corners, coordinates, boundaries, periodic, Vec::new())
    }

    /// The same with named sets of cells. `boundaries` may list facets between cells of different regions, by a side of each.
    pub fn of_regions(
        order: usize,
        corners: Vec<usize>,
        coordinates: Vec<f64>,
        boundaries: Vec<(String, Vec<Side>)>,
        pairs: Vec<PeriodicPair<D>>,
        regions: Vec<Region>,
    ) -> Result<Self, MeshError> {
        check_arrays::<D>(order, &corners, &coordinates)?;
        let regions = region::complete(corners.len() >> D, regions)?;
        let (interior_facets, boundary_facets, boundary_names, interfaces) = Default::default();
        let mut mesh =
            Mesh { order, corners, coordinates, interior_facets, boundary_facets, boundary_names, regions, interfaces };
        let joined = topology::connect(&mut mesh, boundaries, &pairs)?;
        unite_nodes(&mut mesh);
        periodic::align_images(&mut mesh, &joined);
        validity::check_cells(&mesh)?;
        Ok(mesh)
    }

    /// N, the number of nodes per direction of the geometry.
    pub fn order(&self) -> usize {
        self.order
    }
    /// The number of cells.
    pub fn n_cells(&self) -> usize {
        self.corners.len() >> D
    }
    /// N^D.
    pub fn nodes_per_cell(&self) -> usize {
        self.order.pow(D as u32)
    }
    /// Positions of all nodes, `[cell][node][D]`.
    pub fn coordinates(&self) -> &[f64] {
        &self.coordinates
    }
    /// Positions of the nodes of `cell`, `[node][D]`, node axis 0 fastest.
    pub fn cell_coordinates(&self, cell: usize) -> &[f64] {
        let length = self.nodes_per_cell() * D;
        &self.coordinates[cell * length..(cell + 1) * length]
    }
    /// The vertex numbers of `cell`, 2^D of them. Vertices on two sides of a periodic pair have different numbers.
    pub fn corners(&self, cell: usize) -> &[usize] {
        &self.corners[cell << D..(cell + 1) << D]
    }
    /// The facets between two cells, in the order of their minus sides.
    pub fn interior_facets(&self) -> &[InteriorFacet] {
        &self.interior_facets
    }
    /// The facets on the boundary, grouped by boundary.
    pub fn boundary_facets(&self) -> &[BoundaryFacet] {
        &self.boundary_facets
    }
    /// The names of the boundaries that are not periodic.
    pub fn boundary_names(&self) -> &[String] {
        &self.boundary_names
    }

    /// The same cells with the geometry interpolated to `order` nodes per direction; exact if `order` is not smaller.
    ///
    /// # Panics
    /// If `order` is outside [`ORDERS`].
    pub fn with_order(&self, order: usize) -> Self {
        assert!(ORDERS.contains(&order), "order {order} is outside {ORDERS:?}");
        let mut mesh = Mesh { order, coordinates: geometry::interpolated_coordinates(self, order), ..self.clone() };
        unite_nodes(&mut mesh);
        mesh
    }

    /// The vertex numbers of a face, in the order of the face's lattice.
    pub(crate) fn face_corners(&self, side: Side) -> Vec<usize> {
        let corners = self.corners(side.cell);
        face_nodes(D, 2, side.face).into_iter().map(|k| corners[k]).collect()
    }

    /// The positions of the nodes of a face, in the order of its lattice.
    pub fn face_positions(&self, side: Side) -> Vec<[f64; D]> {
        let cell = self.cell_coordinates(side.cell);
        face_nodes(D, self.order, side.face).into_iter().map(|k| point(cell, k)).collect()
    }

    /// The positions of the vertices of a face, in the order of its lattice.
    pub(crate) fn face_corner_positions(&self, side: Side) -> Vec<[f64; D]> {
        let cell = self.cell_coordinates(side.cell);
        face_nodes(D, 2, side.face).into_iter().map(|k| point(cell, corner_node(D, self.order, k))).collect()
    }

    /// The mean of the corners of a face, as its location.
    pub(crate) fn face_centre(&self, side: Side) -> Vec<f64> {
        let corners = self.face_corner_positions(side);
        (0..D).map(|i| corners.iter().map(|x| x[i]).sum::<f64>() / corners.len() as f64).collect()
    }

    /// The diagonal of the smallest box, along the axes, that contains all nodes.
    pub fn diameter(&self) -> f64 {
        let (lower, upper) = geometry::bounding_box::<D>(&self.coordinates);
        norm(&std::array::from_fn::<f64, D, _>(|i| upper[i] - lower[i]))
    }
}

/// Node `k` of a `[node][D]` array.
pub(crate) fn point<const D: usize>(nodes: &[f64], k: usize) -> [f64; D] {
    std::array::from_fn(|i| nodes[k * D + i])
}

/// Whether order, lengths and numbers are possible.
fn check_arrays<const D: usize>(order: usize, corners: &[usize], coordinates: &[f64]) -> Result<(), MeshError> {
    if !ORDERS.contains(&order) {
        return Err(MeshError::Order { order });
    }
    let (cells, per_cell) = (corners.len() >> D, order.pow(D as u32) * D);
    let length = |array, found, expected| {
        if found == expected { Ok(()) } else { Err(MeshError::Length { array, found, expected }) }
    };
    length("corners", corners.len(), cells.max(1) << D)?;
    length("coordinates", coordinates.len(), cells * per_cell)?;
    match coordinates.iter().position(|x| !x.is_finite()) {
        Some(i) => Err(MeshError::NotFinite { cell: i / per_cell, value: coordinates[i] }),
        None => Ok(()),
    }
}
