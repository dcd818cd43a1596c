//! The contents of a result file at each step: the grid, the displayed fields, the exact coefficients.

use serde::{Deserialize, Serialize};

/// The cells for a viewer: each cell has its own equidistant lattice of points on the reference cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Grid {
    /// 2 (quadrilaterals) or 3 (hexahedra); 1 (curves) along a wall in the plane.
    pub dimension: usize,
    /// Lattice points per direction and cell, at least 2; one more than the degree that a viewer draws.
    pub points_per_direction: usize,
    /// Number of cells.
    pub cells: usize,
}

impl Grid {
    /// Lattice points of one cell.
    pub fn points_per_cell(&self) -> usize {
        self.points_per_direction.pow(self.dimension as u32)
    }

    /// Lattice points of all cells.
    pub fn points(&self) -> usize {
        self.cells * self.points_per_cell()
    }
}

/// A displayed field, with values at the lattice points.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct FieldSpec {
    /// Name shown by a viewer, without `/`.
    pub name: String,
    /// 1 for a scalar, 3 for a vector (in two dimensions too, with a zero third component).
    pub components: usize,
}

impl FieldSpec {
    /// A field with one value per point.
    pub fn scalar(name: &str) -> Self {
        Self { name: name.to_owned(), components: 1 }
    }

    /// A field with three values per point.
    pub fn vector(name: &str) -> Self {
        Self { name: name.to_owned(), components: 3 }
    }
}

/// The label of an axis of the cells of the flow.
const CELL: &str = "cell";

/// One axis of an array of coefficients.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Axis {
    /// The meaning of the axis, for instance `cell`.
    pub label: String,
    /// Number of entries.
    pub length: usize,
}

/// An array of exact coefficients, written at every step.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ArraySpec {
    /// Name, without `/`.
    pub name: String,
    /// Axes, slowest first.
    pub axes: Vec<Axis>,
}

impl ArraySpec {
    /// An array with labelled axes, slowest first: `ArraySpec::new("flow", &[("cell", 16), ("time node", 2)])`.
    pub fn new(name: &str, axes: &[(&str, usize)]) -> Self {
        let axis = |&(label, length): &(&str, usize)| Axis { label: label.to_owned(), length };
        Self { name: name.to_owned(), axes: axes.iter().map(axis).collect() }
    }

    /// Number of values in one step.
    pub fn len(&self) -> usize {
        self.axes.iter().map(|axis| axis.length).product()
    }

    /// Number of values of one entry of the first axis, at least 1.
    pub(crate) fn entry_len(&self) -> usize {
        self.axes.iter().skip(1).map(|axis| axis.length).product::<usize>().max(1)
    }

    /// Whether the entries of its first axis are the cells of the flow.
    pub(crate) fn is_of_cells(&self) -> bool {
        self.axes.first().is_some_and(|axis| axis.label == CELL)
    }

    /// Whether a step has no values.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// The contents of each step.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct FileLayout {
    /// The lattice of points.
    pub grid: Grid,
    /// Fields on the lattice.
    pub fields: Vec<FieldSpec>,
    /// Coefficients of the scheme, which define the solution exactly.
    pub exact: Vec<ArraySpec>,
}
