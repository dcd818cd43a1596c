//! The examination of the mesh of a failed run.

use super::data::{Attempt, FailureData, GaveUp, Mesh, Motion, Undefined};
use super::finding::{Finding, WorstCell, most_squeezed, squeezed};
use super::grid::Grid;
use case::rounded_time;
use case::{Case, Stiffness};
use coupled::{Interval, MarchError, MeshMover, MeshQuality, MeshReport, State};

/// The mesh of `case`, displaced by `d` before the slab that failed.
pub fn mesh<const D: usize>(
    case: &Case<D>,
    mover: &MeshMover<D>,
    grid: &Grid<D>,
    d: &[f64],
    interval: Interval,
) -> Mesh {
    let (motion, poisson_ratio) = kind(case);
    let (undefined, reach) = prescribed(mover, interval);
    let travel = travel(mover, grid, d, interval);
    Mesh { motion, travel, undefined, reach, poisson_ratio, tolerance: tolerance(case), ..shape(grid, d) }
}

/// The first place and time in `interval` where the prescribed displacement is NaN, and its largest size relative to the mesh.
fn prescribed<const D: usize>(mover: &MeshMover<D>, interval: Interval) -> (Option<Undefined>, f64) {
    let mut g = vec![0.0; mover.field_len()];
    let mut largest = 0.0_f64;
    for s in mover.slab_motion.time().nodes() {
        let time = interval.start + s * (interval.length());
        mover.prescribed(time, &mut g);
        if let Some(node) = g.chunks_exact(D).position(|g| g.iter().any(|g| !g.is_finite())) {
            return (Some(Undefined { time, position: mover.positions()[node].to_vec() }), 0.0);
        }
        largest = g.iter().fold(largest, |largest, g| largest.max(g.abs()));
    }
    (None, largest / mover.reference.diameter())
}

/// Measurements of the cells, displaced by `d`, for any kind of motion.
pub fn shape<const D: usize>(grid: &Grid<D>, d: &[f64]) -> Mesh {
    let cells = 0..grid.cells();
    Mesh {
        smallest_det_j: most_squeezed(grid, d).1,
        aspect_ratio: cells.clone().map(|cell| grid.mesh.aspect_ratio(cell)).fold(1.0, f64::max),
        evenness: cells.map(|cell| grid.evenness(cell)).fold(1.0, f64::min),
        ..Mesh::default()
    }
}

fn kind<const D: usize>(case: &Case<D>) -> (Motion, f64) {
    match &case.motion {
        None => (Motion::Still, 0.0),
        Some(case::Motion::Prescribed(_) | case::Motion::Followed) => (Motion::Prescribed, 0.0),
        Some(case::Motion::Elastic { poisson_ratio, stiffness: Stiffness::Constant, .. }) => {
            (Motion::Elastic, *poisson_ratio)
        }
        Some(case::Motion::Elastic { poisson_ratio, .. }) => (Motion::Graded, *poisson_ratio),
    }
}

/// The tolerance of the equilibrium, if the law needs one.
fn tolerance<const D: usize>(case: &Case<D>) -> Option<f64> {
    match &case.motion {
        Some(case::Motion::Elastic { law, tolerance, .. }) if !law.is_linear() => Some(*tolerance),
        _ => None,
    }
}

/// The path of nodes in `interval` by the prescribed motion, in thicknesses of their cells.
fn travel<const D: usize>(mover: &MeshMover<D>, grid: &Grid<D>, d: &[f64], interval: Interval) -> f64 {
    let at = |t: f64| {
        let mut g = vec![0.0; mover.field_len()];
        mover.prescribed(t, &mut g);
        g
    };
    let (from, to) = (at(interval.start), at(interval.end));
    let path: Vec<f64> = from.iter().zip(&to).map(|(from, to)| to - from).collect();
    grid.longest_path(&path, d)
}

/// A run of the mesh alone that stopped with `error` in the slab after `state`.
pub fn examine<const D: usize>(case: &Case<D>, mover: &MeshMover<D>, state: &State, error: &anyhow::Error) -> Finding {
    let grid = grid(mover);
    let whole = Interval { start: state.time, end: state.time + case.time.step, halvings: 0 };
    let interval = error.downcast_ref::<MarchError>().map_or(whole, |error| error.interval);
    let (cell, smallest) = most_squeezed(&grid, &state.d);
    let because = format!("det J / det J_0 is {smallest:.3e} there at t = {}, the smallest", rounded_time(state.time));
    Finding {
        data: data(GaveUp::Equilibrium, state.slab, interval, mesh(case, mover, &grid, &state.d, interval)),
        residuals: Vec::new(),
        cell: Some(squeezed(&grid, &state.d, cell, because)),
    }
}

/// The slab of `report`, which has led to `state`: a cell of the mesh alone is inverted in it.
pub fn examine_inverted<const D: usize>(
    case: &Case<D>,
    mover: &MeshMover<D>,
    state: &State,
    report: &MeshReport,
) -> Option<Finding> {
    let (grid, past, MeshReport { interval, quality, .. }) = (grid(mover), state.past.as_ref()?, report);
    let mut d = past.bottom.clone();
    mover.slab_motion.displacement(past.dt, &past.bottom, &past.v, (quality.time - interval.start) / past.dt, &mut d);
    let mut mesh = mesh(case, mover, &grid, &past.bottom, *interval);
    mesh.smallest_det_j = quality.sampled_min;
    Some(Finding {
        data: data(GaveUp::InvertedCell, state.slab - 1, *interval, mesh),
        residuals: Vec::new(),
        cell: Some(inverted(&grid, &d, quality)),
    })
}

/// The worst cell of a slab, on the mesh displaced by `d` at the time of `quality`.
pub fn inverted<const D: usize>(grid: &Grid<D>, d: &[f64], quality: &MeshQuality) -> WorstCell {
    let because = format!("det J / det J_0 is {:.3e} there at t = {}", quality.sampled_min, rounded_time(quality.time));
    squeezed(grid, d, quality.cell, because)
}

fn grid<const D: usize>(mover: &MeshMover<D>) -> Grid<'_, D> {
    Grid::new(&mover.reference, &mover.numbering, mover.reference.order())
}

fn data(gave_up: GaveUp, slabs_done: usize, interval: Interval, mesh: Mesh) -> FailureData {
    let mesh = Mesh { alone: true, ..mesh };
    let Interval { start, end, halvings } = interval;
    let attempt = Attempt { slabs_done, start, length: end - start, halvings, ..Attempt::default() };
    FailureData { gave_up, attempt, newton: None, mesh, gas: None, structure: None, bodies: None }
}
