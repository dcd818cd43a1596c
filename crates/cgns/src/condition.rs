//! Boundary conditions: names of faces. Periodic interfaces are boundaries too, which a case may join.

use crate::CgnsError;
use crate::node::Node;
use std::collections::BTreeMap;

/// A boundary: its names and its elements or nodes.
pub(crate) struct Condition {
    /// The families, or else the name of the boundary condition.
    pub(crate) names: Vec<String>,
    pub(crate) role: Role,
    pub(crate) path: String,
    pub(crate) location: Location,
    pub(crate) points: Points,
}

/// The part that the faces of a condition play, in the order in which conditions are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Role {
    /// Faces that are joined to others. They belong to no boundary.
    Interface,
    /// A boundary, or cells of a region.
    Boundary,
    /// A periodic interface: faces without a boundary.
    Periodic,
}

/// The entities that the numbers of a condition count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Location {
    /// Vertices: the condition consists of the outer faces between them.
    Vertex,
    /// Elements of a section, or in a lattice faces normal to an axis, if it is known.
    Element(Option<usize>),
    /// Elements of a section.
    Cell,
}

/// Labels of interfaces.
const LABELS: [&str; 2] = ["GridConnectivity1to1_t", "GridConnectivity_t"];

/// For each family the families to which it belongs.
pub(crate) type Families = BTreeMap<String, Vec<String>>;

/// The families of a base.
pub(crate) fn families(base: &Node) -> Result<Families, CgnsError> {
    let parents = |family: Node| {
        let parents = family.of_label("FamilyName_t")?.iter().map(Node::text).collect::<Result<_, _>>()?;
        Ok((family.name, parents))
    };
    base.of_label("Family_t")?.into_iter().map(parents).collect()
}

/// The names that a zone or a boundary condition has by its family.
pub(crate) fn family_names(node: &Node, families: &Families) -> Result<Vec<String>, CgnsError> {
    let Some(family) = node.text_of("FamilyName_t")?.filter(|family| !family.is_empty()) else {
        return Ok(Vec::new());
    };
    // A family of another base has a path.
    let family = family.rsplit('/').next().unwrap_or_default();
    match families.get(family) {
        Some(parents) if !parents.is_empty() => Ok(parents.clone()),
        _ => Ok(vec![family.to_owned()]),
    }
}

pub(crate) enum Points {
    List(Vec<i64>),
    /// The lowest and the highest indices, axis by axis.
    Range(Vec<[i64; 2]>),
}

/// The conditions of a zone in the order of their roles.
pub(crate) fn of_zone(zone: &Node, families: &Families) -> Result<Vec<Condition>, CgnsError> {
    let mut conditions = Vec::new();
    for list in zone.of_label("ZoneBC_t")? {
        for node in list.of_label("BC_t")? {
            conditions.push(read(&node, family_names(&node, families)?, Role::Boundary)?);
        }
    }
    for interfaces in zone.of_label("ZoneGridConnectivity_t")? {
        for node in interfaces.children()?.iter().filter(|node| LABELS.contains(&node.label.as_str())) {
            check_interface(node)?;
            let role = if is_periodic(node)? { Role::Periodic } else { Role::Interface };
            // Zones are joined by positions, with or without the numbers of this node.
            conditions.extend(read(node, Vec::new(), role));
        }
    }
    conditions.sort_by_key(|condition| condition.role);
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

fn read(node: &Node, mut names: Vec<String>, role: Role) -> Result<Condition, CgnsError> {
    let (points, is_old) = points(node)?;
    let location = if is_old { Location::Element(None) } else { location(node)? };
    if names.is_empty() {
        names.push(node.name.clone());
    }
    Ok(Condition { names, role, path: node.path.clone(), location, points })
}

/// The numbers of a condition, and whether they number elements by the rule of old files.
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

/// The lowest and the highest indices of a range. The file may give its two ends in any order.
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
        Some("FaceCenter" | "EdgeCenter") => Ok(Location::Element(None)),
        Some("IFaceCenter") => Ok(Location::Element(Some(0))),
        Some("JFaceCenter") => Ok(Location::Element(Some(1))),
        Some("KFaceCenter") => Ok(Location::Element(Some(2))),
        Some("CellCenter") => Ok(Location::Cell),
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

    /// The numbers of a list or of a range with one index. They must be in `1..=highest`.
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
