//! Named sets of cells.

use crate::{Mesh, MeshError, Side};
use std::collections::{BTreeMap, BTreeSet};

/// Cells with a name: what a solid or a fluid fills.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Region {
    /// The name.
    pub name: String,
    /// The cells, in increasing order.
    pub cells: Vec<usize>,
}

/// Names, and the faces that bear them.
pub(crate) type NamedSides = Vec<(String, Vec<Side>)>;

/// The name of the region of all cells without one, in a mesh that has regions.
pub const REST: &str = "rest";

impl<const D: usize> Mesh<D> {
    /// The named sets of cells; A mesh without regions has an empty list. Otherwise every cell is in at least one region.
    pub fn regions(&self) -> &[Region] {
        &self.regions
    }

    /// The facets between regions that have a name of their own: the names, and a side of each facet.
    pub fn interfaces(&self) -> &[(String, Vec<Side>)] {
        &self.interfaces
    }

    /// The region of every cell, by index.
    ///
    /// # Errors
    /// [`MeshError::TwoRegions`] if a cell has two.
    pub fn region_of_cells(&self) -> Result<Vec<usize>, MeshError> {
        let name = |region: usize| self.regions[region].name.clone();
        let single = |(cell, regions): (usize, Vec<usize>)| match regions[..] {
            [first, second, ..] => Err(MeshError::TwoRegions { cell, first: name(first), second: name(second) }),
            [region] => Ok(region),
            [] => Ok(0),
        };
        regions_of_cells(self.n_cells(), &self.regions).into_iter().enumerate().map(single).collect()
    }

    /// The number of a region.
    ///
    /// # Errors
    /// [`MeshError::NoRegion`] if there is none of that name.
    pub fn region_index(&self, name: &str) -> Result<usize, MeshError> {
        let known = || self.regions.iter().map(|region| region.name.clone()).collect();
        let found = self.regions.iter().position(|region| region.name == name);
        found.ok_or_else(|| MeshError::NoRegion { name: name.to_owned(), known: known() })
    }
}

/// The regions that contain each cell.
pub(crate) fn regions_of_cells(cells: usize, regions: &[Region]) -> Vec<Vec<usize>> {
    let mut of_cell = vec![Vec::new(); cells];
    for (index, region) in regions.iter().enumerate() {
        region.cells.iter().for_each(|&cell| of_cell[cell].push(index));
    }
    of_cell
}

/// Checks the regions of a mesh of `cells` cells, sorts their cells, and adds a region of the cells that no region contains.
pub(crate) fn complete(cells: usize, regions: Vec<Region>) -> Result<Vec<Region>, MeshError> {
    let mut sets: Vec<(String, BTreeSet<usize>)> = Vec::new();
    for Region { name, cells: listed } in regions {
        if let Some(&cell) = listed.iter().find(|&&cell| cell >= cells) {
            return Err(MeshError::NoSuchCell { name, cell, cells });
        }
        if sets.iter().any(|(other, _)| *other == name) {
            return Err(MeshError::RegionTwice { name });
        }
        if listed.is_empty() {
            return Err(MeshError::EmptyRegion { name });
        }
        sets.push((name, listed.into_iter().collect()));
    }
    add_rest(cells, &mut sets);
    Ok(sets.into_iter().map(|(name, cells)| Region { name, cells: cells.into_iter().collect() }).collect())
}

/// Puts the cells that no set contains into the set named [`REST`].
fn add_rest(cells: usize, sets: &mut Vec<(String, BTreeSet<usize>)>) {
    let rest: BTreeSet<usize> = (0..cells).filter(|cell| sets.iter().all(|(_, set)| !set.contains(cell))).collect();
    if sets.is_empty() || rest.is_empty() {
        return;
    }
    match sets.iter_mut().find(|(name, _)| name == REST) {
        Some((_, set)) => set.extend(rest),
        None => sets.push((REST.to_owned(), rest)),
    }
}

/// The boundaries without their facets between regions, and those facets. Boundaries consisting only of such facets are dropped.
pub(crate) fn split_interfaces(boundaries: NamedSides, between: &BTreeSet<Side>) -> (NamedSides, NamedSides) {
    let (mut outer, mut interfaces) = (Vec::new(), Vec::new());
    for (name, sides) in boundaries {
        let (mut inner, outside): (Vec<Side>, Vec<Side>) = sides.into_iter().partition(|side| between.contains(side));
        if inner.is_empty() || !outside.is_empty() {
            outer.push((name.clone(), outside));
        }
        if !inner.is_empty() {
            inner.sort_unstable();
            interfaces.push((name, inner));
        }
    }
    (outer, interfaces)
}

/// The name of the interface that lists each side.
pub(crate) fn interface_of_sides(interfaces: &[(String, Vec<Side>)]) -> BTreeMap<Side, &str> {
    interfaces.iter().flat_map(|(name, sides)| sides.iter().map(move |&side| (side, &name[..]))).collect()
}
