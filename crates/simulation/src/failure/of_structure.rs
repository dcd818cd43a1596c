//! The examination of a failed run of a structure.

use super::data::{Attempt, BadLoad, FailureData, GaveUp, StructureData};
use super::finding::{Finding, WorstCell, most_squeezed, squeezed};
use super::grid::{Grid, difference};
use super::of_mesh::shape;
use case::Analysis;
use coupled::{Interval, StructureMarch};
use elasticity::ElasticityError;

/// The run of a `structure` that stopped with `error` in an `interval` after the state of `march`.
pub fn examine<const D: usize>(
    structure: &case::Structure<D>,
    march: &StructureMarch<D>,
    interval: Interval,
    error: &anyhow::Error,
) -> Finding {
    let (state, body) = (&march.state, march.structure());
    let grid = Grid::new(body.mesh(), body.numbering(), body.mesh().order());
    let bad_load = match error.downcast_ref::<ElasticityError>() {
        Some(ElasticityError::Load { time, position, .. }) => Some(BadLoad { time: *time, position: position.clone() }),
        _ => None,
    };
    let Interval { start, halvings, .. } = interval;
    let length = interval.length();
    let waves = || structure.shear_speed() * length / smallest_distance(&grid, &state.d);
    Finding {
        cell: Some(worst_cell(&grid, &state.d, bad_load.as_ref())),
        residuals: Vec::new(),
        data: FailureData {
            gave_up: if bad_load.is_some() { GaveUp::Load } else { GaveUp::Structure },
            attempt: Attempt { slabs_done: state.slab, start, length, halvings, ..Attempt::default() },
            newton: None,
            mesh: shape(&grid, &state.d),
            gas: None,
            structure: Some(StructureData {
                poisson_ratio: structure.largest.poisson_ratio,
                waves_per_slab: (structure.analysis == Analysis::Dynamic).then(waves),
                is_nonlinear: !body.law().is_linear(),
                smallest_volume_ratio: most_squeezed(&grid, &state.d).1,
                bad_load,
            }),
            bodies: None,
        },
    }
}

/// The smallest mean distance of nodes across a cell.
fn smallest_distance<const D: usize>(grid: &Grid<D>, d: &[f64]) -> f64 {
    let thickness = (0..grid.cells()).map(|cell| grid.thickness(cell, d)).fold(f64::INFINITY, f64::min);
    thickness / (grid.mesh.order() - 1) as f64
}

/// The cell where the load is NaN, or else the most compressed cell.
fn worst_cell<const D: usize>(grid: &Grid<D>, d: &[f64], bad_load: Option<&BadLoad>) -> WorstCell {
    match bad_load {
        Some(load) => {
            squeezed(grid, d, nearest(grid, &load.position), "a load at one of its nodes is no number".into())
        }
        None => {
            let (cell, smallest) = most_squeezed(grid, d);
            squeezed(grid, d, cell, format!("it is squeezed most: its volume has changed by a factor of {smallest:.6}"))
        }
    }
}

/// The cell with a point nearest to a position at rest.
fn nearest<const D: usize>(grid: &Grid<D>, position: &[f64]) -> usize {
    let place: [f64; D] = std::array::from_fn(|i| position[i]);
    let at_rest = vec![0.0; grid.field_len()];
    let distance = |cell: usize| {
        let points = grid.positions(cell, &at_rest);
        points.iter().map(|x| tensor::norm(&difference(x, &place))).fold(f64::INFINITY, f64::min)
    };
    (0..grid.cells()).min_by(|a, b| distance(*a).total_cmp(&distance(*b))).unwrap_or(0)
}
