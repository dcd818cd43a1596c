//! What is found out about the mesh of a run that has failed.

use super::evidence::{Attempt, Evidence, GaveUp, Mesh, Motion};
use super::finding::Finding;
use super::grid::{Grid, difference};
use crate::case::{self, Case, Stiffness};
use coupled::{Interval, MarchError, MeshMover};

/// The mesh of `case`, displaced by `d` before the slab that failed.
pub fn mesh<const D: usize>(
    case: &Case<D>,
    mover: &MeshMover<D>,
    grid: &Grid<D>,
    d: &[f64],
    interval: Interval,
) -> Mesh {
    let cells = 0..grid.cells();
    let ratios = cells.clone().flat_map(|cell| grid.volume_ratios(cell, d));
    let (motion, poisson_ratio) = kind(case);
    Mesh {
        motion,
        smallest_det_j: ratios.fold(f64::INFINITY, f64::min),
        travel: travel(mover, grid, d, interval),
        aspect_ratio: cells.clone().map(|cell| case.mesh.aspect_ratio(cell)).fold(1.0, f64::max),
        evenness: cells.map(|cell| grid.evenness(cell)).fold(1.0, f64::min),
        poisson_ratio,
    }
}

fn kind<const D: usize>(case: &Case<D>) -> (Motion, f64) {
    match &case.motion {
        None => (Motion::Still, 0.0),
        Some(case::Motion::Prescribed(_)) => (Motion::Prescribed, 0.0),
        Some(case::Motion::Elastic { poisson_ratio, stiffness: Stiffness::Constant, .. }) => {
            (Motion::Elastic, *poisson_ratio)
        }
        Some(case::Motion::Elastic { poisson_ratio, .. }) => (Motion::Graded, *poisson_ratio),
    }
}

/// How far nodes go in `interval` by what is prescribed, in thicknesses of their cells.
fn travel<const D: usize>(mover: &MeshMover<D>, grid: &Grid<D>, d: &[f64], interval: Interval) -> f64 {
    let at = |t: f64| {
        let mut g = vec![0.0; mover.field_len()];
        mover.prescribed(t, &mut g);
        g
    };
    let (from, to) = (at(interval.start), at(interval.end));
    let of_cell = |cell: usize| {
        let (from, to) = (grid.vectors(cell, &from), grid.vectors(cell, &to));
        let way = from.iter().zip(&to).map(|(from, to)| tensor::norm(&difference(to, from)));
        way.fold(0.0, f64::max) / grid.thickness(cell, d).max(f64::MIN_POSITIVE)
    };
    (0..grid.cells()).map(of_cell).fold(0.0, f64::max)
}

/// A run of the mesh alone that stopped with `error` in the slab after `state`.
pub fn examine<const D: usize>(
    case: &Case<D>,
    mover: &MeshMover<D>,
    state: &coupled::State,
    error: &anyhow::Error,
) -> Finding {
    let grid = Grid::new(mover, mover.reference.order());
    let whole = Interval { start: state.time, end: state.time + case.time.step, halvings: 0 };
    let interval = error.downcast_ref::<MarchError>().map_or(whole, |error| error.interval);
    let Interval { start, end, halvings } = interval;
    let attempt = Attempt { steady: false, slabs_done: state.slab, start, length: end - start, halvings };
    let mesh = mesh(case, mover, &grid, &state.d, interval);
    let evidence = Evidence { gave_up: GaveUp::Equilibrium, attempt, newton: None, mesh, gas: None };
    Finding { evidence, residuals: Vec::new(), cell: None }
}
