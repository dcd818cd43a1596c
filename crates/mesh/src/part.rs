//! The part of a mesh that some of its regions fill, and the nodes that two parts share.

use crate::region::{NamedSides, interface_of_sides};
use crate::{BoundaryFacet, InteriorFacet, Mesh, MeshError, NodeNumbering, Side};
use std::collections::BTreeMap;

/// Some regions of a mesh as a mesh of their own. Cells keep their lattices and their positions to the bit.
///
/// A facet between the part and another region is on a boundary of the part. It has the name of the other region, unless the
/// facet has a name of its own.
#[derive(Clone, Debug, PartialEq)]
pub struct Part<const D: usize> {
    /// The cells of the part and their boundaries.
    pub mesh: Mesh<D>,
    /// For each cell its number in the whole mesh, in increasing order.
    pub cells: Vec<usize>,
}

impl<const D: usize> Part<D> {
    /// For each C0 node of the part its number in the whole mesh, where both are numbered with the same order.
    pub fn nodes_in_whole(&self, own: &NodeNumbering, whole: &NodeNumbering) -> Vec<usize> {
        let mut nodes = vec![0; own.count];
        for (cell, &in_whole) in self.cells.iter().enumerate() {
            let pairs = own.cell(cell).iter().zip(whole.cell(in_whole));
            pairs.for_each(|(&node, &in_whole)| nodes[node] = in_whole);
        }
        nodes
    }
}

impl<const D: usize> Mesh<D> {
    /// The part that the named regions fill.
    ///
    /// # Errors
    /// [`MeshError::NoRegion`], [`MeshError::TwoRegions`], or [`MeshError::InterfaceName`] where an interface would have the name of
    /// another boundary of the part.
    pub fn part(&self, names: &[&str]) -> Result<Part<D>, MeshError> {
        self.part_where(names, true)
    }

    /// The part that all other regions fill.
    ///
    /// # Errors
    /// As [`Self::part`], and [`MeshError::NothingLeft`] if there are no others.
    pub fn part_without(&self, names: &[&str]) -> Result<Part<D>, MeshError> {
        let part = self.part_where(names, false)?;
        if part.cells.is_empty() {
            return Err(MeshError::NothingLeft { names: names.iter().map(|&name| name.to_owned()).collect() });
        }
        Ok(part)
    }

    /// The C0 nodes of order `order` that the parts `a` and `b` of this mesh share: pairs of their numbers, in increasing order of those
    /// in `a`.
    ///
    /// # Errors
    /// [`MeshError::Apart`] if there are none.
    pub fn interface(&self, a: &Part<D>, b: &Part<D>, order: usize) -> Result<Vec<(usize, usize)>, MeshError> {
        let whole = NodeNumbering::new(self, order);
        let nodes = |part: &Part<D>| part.nodes_in_whole(&NodeNumbering::new(&part.mesh, order), &whole);
        let in_b: BTreeMap<usize, usize> =
            nodes(b).into_iter().enumerate().map(|(node, whole)| (whole, node)).collect();
        let twin = |(node, whole): (usize, usize)| in_b.get(&whole).map(|&twin| (node, twin));
        let pairs: Vec<_> = nodes(a).into_iter().enumerate().filter_map(twin).collect();
        if pairs.is_empty() {
            let names = |part: &Part<D>| part.mesh.regions.iter().map(|region| region.name.clone()).collect();
            return Err(MeshError::Apart { first: names(a), second: names(b) });
        }
        Ok(pairs)
    }

    /// The part of the cells that are in the named regions, or of those that are not.
    fn part_where(&self, names: &[&str], inside: bool) -> Result<Part<D>, MeshError> {
        let regions = names.iter().map(|name| self.region_index(name)).collect::<Result<Vec<_>, _>>()?;
        let region_of = self.region_of_cells()?;
        let belongs = |cell: &usize| regions.contains(&region_of[*cell]) == inside;
        let cells: Vec<usize> = (0..self.n_cells()).filter(belongs).collect();
        let mut number = vec![None; self.n_cells()];
        cells.iter().enumerate().for_each(|(new, &old)| number[old] = Some(new));
        let mesh = Extraction { whole: self, region_of: &region_of, number: &number }.mesh(&cells)?;
        Ok(Part { mesh, cells })
    }
}

/// The cells and facets of a part.
struct Extraction<'a, const D: usize> {
    whole: &'a Mesh<D>,
    region_of: &'a [usize],
    /// The number of each cell in the part, if it is there.
    number: &'a [Option<usize>],
}

impl<const D: usize> Extraction<'_, D> {
    fn mesh(&self, cells: &[usize]) -> Result<Mesh<D>, MeshError> {
        let whole = self.whole;
        let mut boundaries = self.outer_boundaries();
        let interfaces = self.interfaces_with_others();
        if let Some((name, _)) = interfaces.iter().find(|(name, _)| boundaries.iter().any(|(other, _)| other == name)) {
            return Err(MeshError::InterfaceName { name: name.clone() });
        }
        boundaries.extend(interfaces);
        let facets = |(boundary, (_, sides)): (usize, &(String, Vec<Side>))| {
            sides.iter().map(move |&side| BoundaryFacet { side, boundary }).collect::<Vec<_>>()
        };
        Ok(Mesh {
            order: whole.order,
            corners: cells.iter().flat_map(|&cell| whole.corners(cell).iter().copied()).collect(),
            coordinates: cells.iter().flat_map(|&cell| whole.cell_coordinates(cell).iter().copied()).collect(),
            interior_facets: whole.interior_facets.iter().filter_map(|facet| self.interior_facet(facet)).collect(),
            boundary_facets: boundaries.iter().enumerate().flat_map(facets).collect(),
            boundary_names: boundaries.into_iter().map(|(name, _)| name).collect(),
            regions: self.regions(),
            interfaces: self.interfaces_inside(),
        })
    }

    /// `side` in the numbers of the part, if its cell is there.
    fn side(&self, side: Side) -> Option<Side> {
        self.number[side.cell].map(|cell| Side { cell, ..side })
    }

    fn interior_facet(&self, facet: &InteriorFacet) -> Option<InteriorFacet> {
        Some(InteriorFacet { minus: self.side(facet.minus)?, plus: self.side(facet.plus)?, ..*facet })
    }

    /// The boundaries of the whole mesh that the part has a share in.
    fn outer_boundaries(&self) -> NamedSides {
        let sides = |boundary: usize| -> Vec<Side> {
            let facets = self.whole.boundary_facets.iter().filter(|facet| facet.boundary == boundary);
            facets.filter_map(|facet| self.side(facet.side)).collect()
        };
        let boundaries = self.whole.boundary_names.iter().enumerate().map(|(index, name)| (name.clone(), sides(index)));
        boundaries.filter(|(_, sides)| !sides.is_empty()).collect()
    }

    /// The facets between cells of the part and other cells, in the order of their names. A facet without a name takes the name of the
    /// region on the other side.
    fn interfaces_with_others(&self) -> NamedSides {
        let named = interface_of_sides(&self.whole.interfaces);
        let mut boundaries: BTreeMap<&str, Vec<Side>> = BTreeMap::new();
        for facet in &self.whole.interior_facets {
            let (side, other) = match (self.side(facet.minus), self.side(facet.plus)) {
                (Some(side), None) => (side, facet.plus),
                (None, Some(side)) => (side, facet.minus),
                _ => continue,
            };
            let own_name = named.get(&facet.minus).or(named.get(&facet.plus));
            let name = own_name.copied().unwrap_or(&self.whole.regions[self.region_of[other.cell]].name);
            boundaries.entry(name).or_default().push(side);
        }
        boundaries.values_mut().for_each(|sides| sides.sort_unstable());
        boundaries.into_iter().map(|(name, sides)| (name.to_owned(), sides)).collect()
    }

    /// The regions of the part.
    fn regions(&self) -> Vec<crate::Region> {
        let own = |cells: &[usize]| -> Vec<usize> { cells.iter().filter_map(|&cell| self.number[cell]).collect() };
        let regions = self.whole.regions.iter();
        let regions = regions.map(|region| crate::Region { name: region.name.clone(), cells: own(&region.cells) });
        regions.filter(|region| !region.cells.is_empty()).collect()
    }

    /// The named facets between two regions of the part.
    fn interfaces_inside(&self) -> NamedSides {
        let inside: BTreeMap<Side, &InteriorFacet> =
            self.whole.interior_facets.iter().flat_map(|facet| [(facet.minus, facet), (facet.plus, facet)]).collect();
        let kept = |side: &Side| self.interior_facet(inside[side]).and_then(|_| self.side(*side));
        let interfaces = self.whole.interfaces.iter();
        let interfaces = interfaces.map(|(name, sides)| (name.clone(), sides.iter().filter_map(kept).collect()));
        interfaces.filter(|(_, sides): &(String, Vec<Side>)| !sides.is_empty()).collect()
    }
}

#[cfg(test)]
mod tests;
