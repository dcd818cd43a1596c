//! From the tree of a file to lists.

use crate::condition::Families;
use crate::lists::Lists;
use crate::node::Node;
use crate::{CgnsError, condition, join, structured, unstructured};
use mesh::MeshLists;

/// The three Cartesian coordinates.
const COORDINATES: [&str; 3] = ["CoordinateX", "CoordinateY", "CoordinateZ"];

pub(crate) fn read(root: &Node) -> Result<MeshLists, CgnsError> {
    let base = base(root)?;
    let [cells, space] = base.numbers()?;
    if !(cells == 2 || cells == 3) || space < cells {
        let problem = format!("cells have dimension {cells} and space {space}: a mesh has cells of dimension 2 or 3");
        return Err(base.error(problem));
    }
    let mut lists = Lists::new(cells as usize);
    let zones = base.of_label("Zone_t")?;
    if zones.is_empty() {
        return Err(base.error("there is no zone: save the mesh, not the geometry or the solution alone"));
    }
    let families = condition::families(&base)?;
    for zone in &zones {
        read_zone(&mut lists, zone, &families)?;
    }
    join::join(&mut lists);
    Ok(lists.lists)
}

/// The base, of which there must be one.
fn base(root: &Node) -> Result<Node, CgnsError> {
    let mut bases = root.of_label("CGNSBase_t")?;
    match (bases.pop(), bases.len()) {
        (Some(base), 0) => Ok(base),
        (None, _) => Err(CgnsError::at("/", "there is no CGNSBase_t: this HDF5 file is no CGNS mesh")),
        (Some(_), others) => {
            Err(CgnsError::at("/", format!("there are {} bases: save a file with one CGNSBase_t", others + 1)))
        }
    }
}

fn read_zone(lists: &mut Lists, zone: &Node, families: &Families) -> Result<(), CgnsError> {
    let conditions = condition::of_zone(zone, families)?;
    let cell_names = lists.names(&condition::family_names(zone, families)?);
    match zone.text_of("ZoneType_t")?.as_deref() {
        Some("Structured") => structured::read(lists, zone, &conditions, &cell_names),
        Some("Unstructured") => unstructured::read(lists, zone, &conditions, &cell_names),
        other => {
            let found = other.unwrap_or("nothing");
            Err(zone.error(format!("its ZoneType is {found}: expected Structured or Unstructured")))
        }
    }
}

/// Appends the `count` vertices of a zone; the index of the first one.
pub(crate) fn read_vertices(lists: &mut Lists, zone: &Node, count: usize) -> Result<usize, CgnsError> {
    let grids = zone.of_label("GridCoordinates_t")?;
    // Other nodes with this label are moved grids.
    let grid = grids.iter().find(|grid| grid.name == "GridCoordinates").or(grids.first());
    let grid = grid.ok_or_else(|| zone.error("it has no GridCoordinates_t"))?;
    if let Some(rind) = grid.first("Rind_t")?
        && rind.integers()?.iter().any(|&layers| layers != 0)
    {
        return Err(rind.error("the coordinates have layers of rind: save the mesh without them"));
    }
    let mut positions = vec![[0.0; 3]; 0];
    for (axis, name) in COORDINATES.into_iter().enumerate() {
        let Some(values) = coordinate(lists, grid, name, axis, count)? else { continue };
        positions.resize(count, [0.0; 3]);
        positions.iter_mut().zip(values).for_each(|(position, value)| position[axis] = value);
    }
    lists.push_nodes(&zone.path, positions)
}

/// The values of a coordinate. A plane mesh may lack z.
fn coordinate(
    lists: &Lists,
    grid: &Node,
    name: &str,
    axis: usize,
    count: usize,
) -> Result<Option<Vec<f64>>, CgnsError> {
    let Some(node) = grid.child(name)? else {
        if axis >= lists.dimension {
            return Ok(None);
        }
        let known: Vec<String> = grid.children()?.into_iter().map(|child| child.name).collect();
        let problem = format!("it has no {name}, but {}: save Cartesian coordinates", known.join(", "));
        return Err(grid.error(problem));
    };
    let values = node.reals()?;
    if values.len() != count {
        return Err(node.error(format!("it has {} values, the zone has {count} vertices", values.len())));
    }
    match values.iter().position(|value| !value.is_finite()) {
        Some(index) => Err(node.error(format!("the value of vertex {} is {}", index + 1, values[index]))),
        None => Ok(Some(values)),
    }
}

/// A count in a file, as an index.
pub(crate) fn count(node: &Node, value: i64) -> Result<usize, CgnsError> {
    usize::try_from(value).map_err(|_| node.error(format!("it has the size {value}, expected a number of 0 or more")))
}
