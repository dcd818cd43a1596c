//! Extrusion of two-dimensional meshes.

use super::growth::Check;
use crate::{BoundaryFacet, InteriorFacet, Mesh, MeshError, Orientation, Region, Side};
use basis::gauss_lobatto;

/// The ends of an extruded mesh that is not periodic: z low, z high.
const ENDS: [&str; 2] = ["front", "back"];

/// The extrusion of a two-dimensional mesh: every cell times [lower, lower + depth], in layers of equal height.
///
/// Boundaries and periodic pairs keep their names; the two ends are named "front" (low) and "back", or joined. Cell c
/// of the two-dimensional mesh becomes the cells c + layer * n_cells, with axis 2 along z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extrusion {
    /// z of the front.
    pub lower: f64,
    /// Extent along z.
    pub depth: f64,
    /// Layers of cells.
    pub layers: usize,
    /// Whether front and back are joined.
    pub periodic: bool,
}

/// Rounding distorts layers that are thinner than this part of their distance from z = 0.
const THINNEST: f64 = 1e-10;

impl Mesh<2> {
    /// The three-dimensional mesh with this cross-section. It is valid if this mesh is: det J = det J_2D times half the
    /// height of a layer.
    pub fn extruded(&self, extrusion: &Extrusion) -> Result<Mesh<3>, MeshError> {
        extrusion.check(self)?;
        let layers = 0..extrusion.layers;
        let vertices = self.corners.iter().max().map_or(0, |last| last + 1);
        let corners = layers.clone().flat_map(|layer| self.layer_corners(layer, vertices)).collect();
        let coordinates = layers.clone().flat_map(|layer| self.layer_coordinates(extrusion, layer)).collect();
        let mut interior_facets: Vec<_> = layers.flat_map(|layer| self.layer_facets(layer)).collect();
        interior_facets.extend(self.facets_between_layers(extrusion));
        interior_facets.sort_unstable_by_key(|facet| facet.minus);
        let mut boundary_names = self.boundary_names.clone();
        if !extrusion.periodic {
            boundary_names.extend(ENDS.map(str::to_owned));
        }
        let boundary_facets = self.extruded_boundary(extrusion);
        let regions = self.regions.iter().map(|region| self.extruded_region(region, extrusion.layers)).collect();
        let in_layers =
            |side: &Side| (0..extrusion.layers).map(|layer| self.in_layer(*side, layer)).collect::<Vec<_>>();
        let interface = |(name, sides): &(String, Vec<Side>)| {
            let mut sides: Vec<Side> = sides.iter().flat_map(in_layers).collect();
            sides.sort_unstable();
            (name.clone(), sides)
        };
        Ok(Mesh {
            order: self.order,
            corners,
            coordinates,
            interior_facets,
            boundary_facets,
            boundary_names,
            regions,
            interfaces: self.interfaces.iter().map(interface).collect(),
        })
    }

    fn extruded_region(&self, region: &Region, layers: usize) -> Region {
        let in_layer = |layer: usize| region.cells.iter().map(move |cell| cell + layer * self.n_cells());
        Region { name: region.name.clone(), cells: (0..layers).flat_map(in_layer).collect() }
    }

    /// Vertices of a layer: those of its front, then those of its back.
    fn layer_corners(&self, layer: usize, vertices: usize) -> impl Iterator<Item = usize> {
        let of_cell = move |cell: &[usize]| {
            let end = |side: usize| cell.iter().map(move |vertex| vertex + (layer + side) * vertices);
            end(0).chain(end(1)).collect::<Vec<_>>()
        };
        self.corners.chunks_exact(4).flat_map(of_cell)
    }

    fn layer_coordinates(&self, extrusion: &Extrusion, layer: usize) -> impl Iterator<Item = f64> {
        let nodes = gauss_lobatto(self.order).points;
        let heights: Vec<f64> = nodes.iter().map(|&xi| extrusion.height(layer, xi)).collect();
        let of_cell = move |x: &[f64]| {
            let slice = |&z: &f64| x.chunks_exact(2).flat_map(move |x| [x[0], x[1], z]).collect::<Vec<_>>();
            heights.iter().flat_map(slice).collect::<Vec<_>>()
        };
        self.coordinates.chunks_exact(2 * self.nodes_per_cell()).flat_map(of_cell)
    }

    /// The facets of the cross-section in one layer. Faces keep their numbers. The lattice of a facet gains the axis z,
    /// last and along z on both sides, so the orientation is unchanged.
    fn layer_facets(&self, layer: usize) -> impl Iterator<Item = InteriorFacet> {
        self.interior_facets.iter().map(move |&facet| InteriorFacet {
            minus: self.in_layer(facet.minus, layer),
            plus: self.in_layer(facet.plus, layer),
            ..facet
        })
    }

    fn in_layer(&self, side: Side, layer: usize) -> Side {
        Side { cell: side.cell + layer * self.n_cells(), ..side }
    }

    /// The facets with normal z, from face 5 of a cell to face 4 of the next one.
    fn facets_between_layers(&self, extrusion: &Extrusion) -> impl Iterator<Item = InteriorFacet> {
        let Extrusion { layers, periodic, .. } = *extrusion;
        let between = move |below: usize| {
            let above = (below + 1) % layers;
            (0..self.n_cells()).map(move |cell| InteriorFacet {
                minus: self.in_layer(Side { cell, face: 5 }, below),
                plus: self.in_layer(Side { cell, face: 4 }, above),
                orientation: Orientation::default(),
                periodic: above == 0,
            })
        };
        (0..if periodic { layers } else { layers - 1 }).flat_map(between)
    }

    fn extruded_boundary(&self, extrusion: &Extrusion) -> Vec<BoundaryFacet> {
        let in_layer = |layer| move |&BoundaryFacet { side, boundary }: &BoundaryFacet| (side, boundary, layer);
        let sides = (0..extrusion.layers).flat_map(|layer| self.boundary_facets.iter().map(in_layer(layer)));
        let place = |(side, boundary, layer)| BoundaryFacet { side: self.in_layer(side, layer), boundary };
        let mut facets: Vec<BoundaryFacet> = sides.map(place).collect();
        if !extrusion.periodic {
            for (end, layer) in [(0, 0), (1, extrusion.layers - 1)] {
                let boundary = self.boundary_names.len() + end;
                let side = |cell| self.in_layer(Side { cell, face: 4 + end }, layer);
                facets.extend((0..self.n_cells()).map(|cell| BoundaryFacet { side: side(cell), boundary }));
            }
        }
        facets.sort_unstable_by_key(|facet| (facet.boundary, facet.side));
        facets
    }
}

impl Extrusion {
    fn check(&self, mesh: &Mesh<2>) -> Result<(), MeshError> {
        let check = Check { mesh: "extruded" };
        check.positive("the depth", self.depth)?;
        check.count("the number of layers", self.layers)?;
        check.that(self.lower.is_finite(), "z of the front", self.lower, "a number")?;
        let (height, furthest) =
            (self.depth / self.layers as f64, self.lower.abs().max((self.lower + self.depth).abs()));
        check.that(
            height > THINNEST * furthest,
            "the height of a layer",
            height,
            "more than 1e-10 of z at its ends",
        )?;
        match mesh.boundary_names.iter().find(|name| !self.periodic && ENDS.contains(&name.as_str())) {
            Some(name) => Err(MeshError::NameOfEnd { name: name.clone() }),
            None => Ok(()),
        }
    }

    /// z at reference coordinate xi of a layer, the same to the bit from both sides.
    fn height(&self, layer: usize, xi: f64) -> f64 {
        let end = |k: usize| self.lower + self.depth * k as f64 / self.layers as f64;
        (0.5 - 0.5 * xi) * end(layer) + (0.5 + 0.5 * xi) * end(layer + 1)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::facet::corner_node;
    use crate::generate::RotatingBoxMesh;
    use crate::{BoxMesh, Curving, NodeNumbering, PeriodicPair};

    fn extrusion(layers: usize, periodic: bool) -> Extrusion {
        Extrusion { lower: -1.0, depth: 0.5, layers, periodic }
    }

    /// The extruded mesh from its parts, with all checks.
    fn rebuilt(mesh: &Mesh<3>, periodic: bool) -> Mesh<3> {
        let mut boundaries: Vec<(String, Vec<Side>)> =
            mesh.boundary_names.iter().map(|name| (name.clone(), vec![])).collect();
        mesh.boundary_facets.iter().for_each(|facet| boundaries[facet.boundary].1.push(facet.side));
        let mut pairs = vec![];
        if periodic {
            let joined = mesh.interior_facets.iter().filter(|facet| facet.periodic);
            let (back, front) = joined.map(|facet| (facet.minus, facet.plus)).unzip();
            let minus = boundaries.len();
            boundaries.extend([("back".to_owned(), back), ("front".to_owned(), front)]);
            pairs.push(PeriodicPair { minus, plus: minus + 1, translation: [0.0, 0.0, -0.5] });
        }
        Mesh::new(mesh.order, mesh.corners.clone(), mesh.coordinates.clone(), boundaries, pairs).unwrap()
    }

    #[test]
    fn facets_are_those_that_the_corners_imply() {
        let plane = RotatingBoxMesh::unit(5, 4).build().unwrap().scrambled(3);
        for (layers, periodic) in [(1, false), (1, true), (2, true), (3, false)] {
            let mesh = plane.extruded(&extrusion(layers, periodic)).unwrap();
            assert_eq!(mesh, rebuilt(&mesh, periodic), "{layers} {periodic}");
            assert!((mesh.volume() - 0.48).abs() < 1e-13);
        }
    }

    #[test]
    fn periodic_pairs_of_the_plane_stay_joined() {
        let curving = Curving::Wavy { amplitude: 0.04 };
        let periodic = [true, false];
        let plane = BoxMesh { lower: [0.0; 2], upper: [1.0; 2], cells: [3, 2], order: 4, curving, periodic };
        let mesh = plane.build().unwrap().extruded(&extrusion(2, true)).unwrap();
        assert_eq!(mesh.boundary_names(), ["bottom", "top"]);
        // 3 (N - 1) nodes along x, 2 (N - 1) + 1 along y, 2 (N - 1) along z.
        assert_eq!(NodeNumbering::new(&mesh, 4).count, 9 * 7 * 6);
    }

    #[test]
    fn ends_lie_where_their_names_say() {
        let mesh = RotatingBoxMesh::unit(5, 2).build().unwrap().extruded(&extrusion(2, false)).unwrap();
        assert_eq!(mesh.boundary_names()[2..], ["front", "back"]);
        for facet in mesh.boundary_facets().iter().filter(|facet| facet.boundary >= 2) {
            let z = if facet.boundary == 2 { -1.0 } else { -0.5 };
            assert!(mesh.face_positions(facet.side).iter().all(|x| x[2] == z));
        }
        let corner = mesh.cell_coordinates(0)[3 * corner_node(3, 2, 4) + 2];
        assert_eq!(corner, -0.75);
    }

    #[test]
    fn impossible_extrusions_are_refused() {
        let plane = RotatingBoxMesh::unit(5, 2).build().unwrap();
        assert!(plane.extruded(&extrusion(0, true)).is_err());
        assert!(plane.extruded(&Extrusion { depth: 0.0, ..extrusion(1, true) }).is_err());
        let mut named = plane.clone();
        named.boundary_names[0] = "back".to_owned();
        assert_eq!(named.extruded(&extrusion(1, false)).unwrap_err(), MeshError::NameOfEnd { name: "back".to_owned() });
        // Layers that rounding makes uneven were a mesh.
        let far = Extrusion { lower: 1e9, depth: 1e-7, ..extrusion(4, false) };
        assert!(matches!(plane.extruded(&far), Err(MeshError::Parameter { quantity: "the height of a layer", .. })));
        assert!(named.extruded(&extrusion(1, true)).is_ok());
    }
}
