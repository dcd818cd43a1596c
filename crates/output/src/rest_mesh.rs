//! The group `/stsolve/mesh`: the mesh at rest, for readers that need more than the positions at each step.

use hdf5::types::VarLenUnicode;
use hdf5::{Error, Group, Result};
use ndarray::ArrayView2;

use crate::hdf::constant;

/// The mesh at rest. Empty for files of programs that did not write it.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct RestMesh {
    /// Positions of the nodes, `[cell][component][mesh node]`, as `exact/position` has them at each step.
    pub position: Vec<f64>,
    /// Names of the boundaries.
    pub boundary_names: Vec<String>,
    /// Facets on a boundary: cell, face (2 axis + side), index of the boundary in `boundary_names`.
    pub boundary_facets: Vec<[i64; 3]>,
}

/// Name of the group.
const GROUP: &str = "mesh";

/// Writes the mesh into the group `parent`.
pub(crate) fn write(parent: &Group, mesh: &RestMesh) -> Result<()> {
    let group = parent.create_group(GROUP)?;
    constant(&group, "position", &mesh.position)?;
    let facets = ArrayView2::from_shape((mesh.boundary_facets.len(), 3), mesh.boundary_facets.as_flattened())?;
    let facets = group.new_dataset_builder().obj_track_times(false).with_data(facets).create("boundary_facets")?;
    let text = |name: &String| name.parse().map_err(|_| Error::from(format!("`{name}` contains a zero byte")));
    let names = mesh.boundary_names.iter().map(text).collect::<Result<Vec<VarLenUnicode>>>()?;
    facets.new_attr_builder().with_data(&names).create("boundary_names").map(drop)
}

/// Reads the mesh from the group `parent`.
pub(crate) fn read(parent: &Group) -> Result<RestMesh> {
    if !parent.link_exists(GROUP) {
        return Ok(RestMesh::default());
    }
    let group = parent.group(GROUP)?;
    let facets = group.dataset("boundary_facets")?;
    let names: Vec<VarLenUnicode> = facets.attr("boundary_names")?.read_raw()?;
    Ok(RestMesh {
        position: group.dataset("position")?.read_raw()?,
        boundary_names: names.iter().map(|name| String::from_utf8_lossy(name.as_bytes()).into_owned()).collect(),
        boundary_facets: facets.read_raw::<i64>()?.as_chunks().0.to_vec(),
    })
}
