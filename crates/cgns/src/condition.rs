//! Boundary conditions: names of faces. Periodic interfaces are boundaries too, which a case may join.

use crate::CgnsError;
use crate::node::Node;

/// A boundary: a name and what it consists of.
pub(crate) struct Condition {
    /// The family, or else the name of the boundary condition.
    pub(crate) name: String,
    pub(crate) path: String,
    pub(crate) location: Location,
    pub(crate) points: Points,
}

/// What the numbers of a condition count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Location {
    /// Vertices: the condition consists of the outer faces between them.
    Vertex,
    /// Faces: elements of dimension D - 1, or in a lattice faces normal to an axis, if it is known.
    Face(Option<usize>),
}

pub(crate) enum Points {
    List(Vec<i64>),
    /// The lowest and the highest indices, axis by axis.
    Range(Vec<[i64; 2]>),
}

/// The conditions of a zone.
pub(crate) fn of_zone(zone: &Node) -> Result<Vec<Condition>, CgnsError> {
    let mut conditions = Vec::new();
    for list in zone.of_label("ZoneBC_t")? {
        for node in list.of_label("BC_t")? {
            let family = node.text_of("FamilyName_t")?.filter(|family| !family.is_empty());
            conditions.push(read(&node, family)?);
        }
    }
    for interfaces in zone.of_label("ZoneGridConnectivity_t")? {
        for node in interfaces.children()? {
            check_interface(&node)?;
            if is_periodic(&node)? {
                conditions.push(read(&node, None)?);
            }
        }
    }
    Ok(conditions)
}

/// Refuses interfaces between faces that do not coincide.
fn check_interface(node: &Node) -> Result<(), CgnsError> {
    match node.text_of("GridConnectivityType_t")?.as_deref() {
        Some(kind @ ("Abutting" | "Overset")) => {
            let problem = format!("this interface is {kind}: zones must meet face to face, as in Abutting1to1");
            Err(node.error(problem))
        }
        _ => Ok(()),
    }
}

fn is_periodic(node: &Node) -> Result<bool, CgnsError> {
    match node.first("GridConnectivityProperty_t")? {
        Some(property) => Ok(property.first("Periodic_t")?.is_some()),
        None => Ok(false),
    }
}

fn read(node: &Node, family: Option<String>) -> Result<Condition, CgnsError> {
    let (points, is_old) = points(node)?;
    let location = if is_old { Location::Face(None) } else { location(node)? };
    Ok(Condition { name: family.unwrap_or_else(|| node.name.clone()), path: node.path.clone(), location, points })
}

/// The numbers of a condition, and whether they are those of elements by the rule of old files.
fn points(node: &Node) -> Result<(Points, bool), CgnsError> {
    for (name, is_old) in [("PointList", false), ("ElementList", true)] {
        if let Some(list) = node.child(name)? {
            return Ok((Points::List(list.integers()?), is_old));
        }
    }
    for (name, is_old) in [("PointRange", false), ("ElementRange", true)] {
        if let Some(range) = node.child(name)? {
            return Ok((Points::Range(ends(&range)?), is_old));
        }
    }
    Err(node.error("it has neither PointList nor PointRange, so it names no faces"))
}

/// The lowest and the highest indices of a range, whose two ends may come in any order.
fn ends(range: &Node) -> Result<Vec<[i64; 2]>, CgnsError> {
    let ends = range.integers()?;
    let (from, to) = ends.split_at(ends.len() / 2);
    if from.len() != to.len() || from.is_empty() {
        return Err(range.error(format!("it has {} numbers, expected two per index", ends.len())));
    }
    Ok(from.iter().zip(to).map(|(&one, &other)| [one.min(other), one.max(other)]).collect())
}

fn location(node: &Node) -> Result<Location, CgnsError> {
    match node.text_of("GridLocation_t")?.as_deref() {
        None | Some("Vertex") => Ok(Location::Vertex),
        Some("FaceCenter" | "EdgeCenter") => Ok(Location::Face(None)),
        Some("IFaceCenter") => Ok(Location::Face(Some(0))),
        Some("JFaceCenter") => Ok(Location::Face(Some(1))),
        Some("KFaceCenter") => Ok(Location::Face(Some(2))),
        Some(other) => {
            Err(node.error(format!("its GridLocation is {other}: expected Vertex, FaceCenter or EdgeCenter")))
        }
    }
}

impl Condition {
    /// An error at this condition.
    pub(crate) fn error(&self, problem: impl Into<String>) -> CgnsError {
        CgnsError::at(&self.path, problem)
    }

    /// The numbers of a list, or those of a range with one index, which must be in `1..=highest`.
    pub(crate) fn numbers(&self, what: &str, highest: usize) -> Result<Vec<usize>, CgnsError> {
        let number = |value: i64| {
            let inside = usize::try_from(value).ok().filter(|number| (1..=highest).contains(number));
            inside.ok_or_else(|| self.error(format!("there is no {what} {value}, they count from 1 to {highest}")))
        };
        match &self.points {
            Points::List(values) => values.iter().map(|&value| number(value)).collect(),
            Points::Range(ends) => match ends[..] {
                [[low, high]] => Ok((number(low)?..=number(high)?).collect()),
                _ => Err(self.error(format!("its range has {} indices, expected 1", ends.len()))),
            },
        }
    }
}
