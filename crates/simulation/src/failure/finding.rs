//! The findings about a failure.

use super::data::FailureData;
use super::diagnosis::{Cause, NEWTON_STEPS, causes};
use super::grid::Grid;
use super::picture::Painting;
use mesh::Mesh;
use serde::Serialize;

/// The findings.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// The input of the diagnosis.
    pub data: FailureData,
    /// The final residual of every equation, if there was a residual.
    pub residuals: Vec<(&'static str, f64)>,
    /// The worst cell, if one stands out.
    pub cell: Option<WorstCell>,
}

impl Finding {
    /// What to say if the likeliest cause is that Newton's method was allowed too few steps.
    pub fn too_few_steps(&self) -> Option<String> {
        let Cause { name, what, remedy, .. } = causes(&self.data).into_iter().next()?;
        (name == NEWTON_STEPS).then(|| format!("{what} ({remedy})"))
    }
}

/// The worst cell.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WorstCell {
    /// Its number.
    pub cell: usize,
    /// Its centre.
    pub centre: Vec<f64>,
    /// The boundaries that it touches.
    pub boundaries: Vec<String>,
    /// The reason why it is the worst.
    pub because: String,
    /// The cell and its neighbours.
    #[serde(skip)]
    pub svg: String,
}

/// The reason why a cell is the worst one, and the quantity of its picture.
pub struct WorstCellCause<'a> {
    /// The cell.
    pub cell: usize,
    /// The reason.
    pub because: String,
    /// The quantity of the picture ...
    pub quantity: &'a str,
    /// ... at the points of any cell.
    pub values: &'a dyn Fn(usize) -> Vec<f64>,
}

impl WorstCell {
    /// The worst cell by `cause`, on the mesh displaced by `d`.
    pub fn new<const D: usize>(grid: &Grid<D>, d: &[f64], cause: WorstCellCause<'_>) -> Self {
        let WorstCellCause { cell, because, quantity, values } = cause;
        let mesh = grid.mesh;
        let points = grid.positions(cell, d);
        let facets = mesh.boundary_facets().iter().filter(|facet| facet.side.cell == cell);
        let mut boundaries: Vec<String> = facets.map(|facet| mesh.boundary_names()[facet.boundary].clone()).collect();
        boundaries.sort();
        boundaries.dedup();
        let cells = with_neighbours(mesh, cell);
        let values = cells.iter().map(|&cell| values(cell)).collect();
        let svg = Painting { grid, displacement: d, cells, label: quantity.to_owned(), values }.svg();
        WorstCell { cell, centre: points[points.len() / 2].to_vec(), boundaries, because, svg }
    }
}

/// The `cell` with the largest change of volume, by `because`, on the mesh displaced by `d`.
pub fn squeezed<const D: usize>(grid: &Grid<D>, d: &[f64], cell: usize, because: String) -> WorstCell {
    let values = |cell: usize| grid.volume_ratios(cell, d);
    WorstCell::new(grid, d, WorstCellCause { cell, because, quantity: "det J / det J_0", values: &values })
}

/// The cell with the smallest det J / det J_0, and this value.
pub fn most_squeezed<const D: usize>(grid: &Grid<D>, d: &[f64]) -> (usize, f64) {
    let smallest = |cell: usize| grid.volume_ratios(cell, d).into_iter().fold(f64::INFINITY, f64::min);
    let cells = (0..grid.cells()).map(|cell| (cell, smallest(cell)));
    cells.fold((0, f64::INFINITY), |worst, found| if found.1 < worst.1 { found } else { worst })
}

/// A cell, then its neighbours across faces, except periodic ones.
fn with_neighbours<const D: usize>(mesh: &Mesh<D>, cell: usize) -> Vec<usize> {
    let across = mesh.interior_facets().iter().filter(|facet| !facet.periodic).filter_map(|facet| {
        match [facet.minus.cell, facet.plus.cell] {
            [minus, plus] if minus == cell => Some(plus),
            [minus, plus] if plus == cell => Some(minus),
            _ => None,
        }
    });
    std::iter::once(cell).chain(across).collect()
}
