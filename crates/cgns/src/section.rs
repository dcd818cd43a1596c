//! The elements of a section.

use crate::CgnsError;
use crate::base::count;
use crate::kind::{Kind, MIXED};
use crate::node::Node;
use crate::{faces, order};
use mesh::{ListedElement, Shape};
use std::collections::BTreeMap;

/// The vertices of a zone.
#[derive(Clone, Copy)]
pub(crate) struct Vertices {
    /// The index of the first one in the lists.
    pub(crate) first: usize,
    pub(crate) count: usize,
}

/// Reads the sections of one zone.
pub(crate) struct SectionReader {
    dimension: usize,
    vertices: Vertices,
    /// For each kind of cells the order of the nodes, see [`order::from_cgns`].
    orders: BTreeMap<&'static str, Vec<usize>>,
}

impl SectionReader {
    pub(crate) fn new(dimension: usize, vertices: Vertices) -> Self {
        SectionReader { dimension, vertices, orders: BTreeMap::new() }
    }

    /// Hands the cells and the faces of a section to `take`, each with its number.
    pub(crate) fn read(
        &mut self,
        section: &Node,
        mut take: impl FnMut(i64, ListedElement),
    ) -> Result<[i64; 2], CgnsError> {
        let [code, _] = section.numbers()?;
        let range @ [first, last] = section.required("ElementRange")?.numbers()?;
        let expected = match last.checked_sub(first).and_then(|steps| steps.checked_add(1)) {
            Some(expected) if expected > 0 && first > 0 => count(section, expected)?,
            _ => return Err(section.error(format!("its ElementRange is {first} to {last}, which is empty"))),
        };
        // Refuses polygons before their lists are read.
        let kind = if code == MIXED { None } else { Some(self.kind(section, code)?) };
        let numbers = section.required("ElementConnectivity")?.integers()?;
        let mut rest = &numbers[..];
        for element in 0..expected {
            let number = first + element as i64;
            let kind = match (kind, rest) {
                (Some(kind), _) => kind,
                (None, [code, after @ ..]) => {
                    rest = after;
                    self.kind(section, *code)?
                }
                (None, []) => return Err(too_short(section, number)),
            };
            let (nodes, after) = rest.split_at_checked(kind.n_nodes).ok_or_else(|| too_short(section, number))?;
            rest = after;
            if let Some(element) = self.element(section, kind, number, nodes)? {
                take(number, element);
            }
        }
        match rest.len() {
            0 => Ok(range),
            more => {
                Err(section.error(format!("its ElementConnectivity has {more} numbers more than ElementRange says")))
            }
        }
    }

    fn kind(&self, section: &Node, code: i64) -> Result<Kind, CgnsError> {
        let kind = Kind::from_code(code).map_err(|problem| section.error(problem))?;
        let dimension = kind.shape.dimension();
        if dimension > self.dimension {
            let problem = format!("elements {} are volumes, but the base has cells of dimension 2", kind.name);
            return Err(section.error(problem));
        }
        let checked = if dimension == self.dimension { kind.check_cell() } else { Ok(kind) };
        checked.map_err(|problem| section.error(problem))
    }

    /// The element, if it is a cell or a face. Of a face only the corners count.
    fn element(
        &mut self,
        section: &Node,
        kind: Kind,
        number: i64,
        nodes: &[i64],
    ) -> Result<Option<ListedElement>, CgnsError> {
        let dimension = kind.shape.dimension();
        if dimension + 1 < self.dimension {
            return Ok(None);
        }
        let nodes = nodes.iter().map(|&node| self.vertex(section, number, node)).collect::<Result<Vec<_>, _>>()?;
        if dimension < self.dimension {
            return Ok(Some(faces::element(&nodes[..n_corners(kind.shape)], Vec::new())));
        }
        let order = self.orders.entry(kind.name).or_insert_with(|| order::from_cgns(kind.shape, kind.degree));
        let nodes = order.iter().map(|&k| nodes[k]).collect();
        Ok(Some(ListedElement { shape: kind.shape, degree: kind.degree, nodes, names: Vec::new() }))
    }

    /// The index of a vertex in the lists.
    fn vertex(&self, section: &Node, number: i64, vertex: i64) -> Result<usize, CgnsError> {
        match usize::try_from(vertex) {
            Ok(index) if (1..=self.vertices.count).contains(&index) => Ok(self.vertices.first + index - 1),
            _ => {
                let place = format!("{}, element {number}", section.path);
                let problem = format!("there is no vertex {vertex}, they count from 1 to {}", self.vertices.count);
                Err(CgnsError::at(place, problem))
            }
        }
    }
}

/// The number of corners of a face.
fn n_corners(shape: Shape) -> usize {
    match shape {
        Shape::Line => 2,
        Shape::Triangle => 3,
        _ => 4,
    }
}

fn too_short(section: &Node, number: i64) -> CgnsError {
    section.error(format!("its ElementConnectivity ends in element {number}: it is shorter than ElementRange says"))
}
