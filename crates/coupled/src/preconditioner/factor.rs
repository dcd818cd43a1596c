//! The block ILU(0) of lambda M + dt A.
//!
//! ```text
//! D_i = lambda M_i + dt A_ii - sum_{k before i} dt^2 A_ik D_k^{-1} A_ki                                             (d-ilu)
//! ```
//!
//! Cells of a quadrilateral or hexahedral mesh that are neighbours share no third neighbour, so that only the diagonal
//! changes; around an irregular vertex the fill is dropped. Complex matrices are pairs of real ones.

use super::blocks::{Link, coupling_block, diagonal_block, traces_of};
use super::ordering::Ordering;
use super::panel::padded;
use basis::is_real;
use faer::linalg::solvers::DenseSolveCore;
use faer::{Mat, MatRef, c64};
use fem::SpaceJacobian;
use rayon::prelude::*;

/// Real parts of a matrix: one, or two for a complex one.
type Parts = Vec<Mat<f64>>;

/// What the elimination of a cell subtracts from a later one: a matrix in the traces of one of its faces, row-major parts.
struct Update {
    position: usize,
    face: usize,
    parts: Vec<Vec<f64>>,
}

/// Numbers stored per cell for a mode: parts of D^{-1}, columns padded.
pub fn stored_len(block: usize, lambda: c64) -> usize {
    padded(block) * block * if is_real(lambda) { 1 } else { 2 }
}

/// D_i^{-1} of all cells in single precision, by position, each part column-major with padded columns.
pub fn factorise(jacobian: &SpaceJacobian, links: &[Vec<Link>], ordering: &Ordering, dt: f64, lambda: c64) -> Vec<f32> {
    let (n, len) = (jacobian.block, stored_len(jacobian.block, lambda));
    let mut stored = vec![0.0; len * links.len()];
    let mut updates: Vec<Vec<Update>> = (0..links.len()).map(|_| Vec::new()).collect();
    let mut start = 0;
    for &end in &ordering.level_ends {
        let level = stored[start * len..end * len].par_chunks_exact_mut(len).enumerate();
        let new: Vec<Vec<Update>> = level
            .map(|(i, stored)| {
                let cell = ordering.cells[start + i];
                let inverse = inverse(&diagonal(jacobian, cell, dt, lambda, &updates[start + i]));
                store(&inverse, n, stored);
                fill(jacobian, &links[cell], ordering, start + i, dt, &inverse)
            })
            .collect();
        for update in new.into_iter().flatten() {
            updates[update.position].push(update);
        }
        updates[start..end].iter_mut().for_each(|done| *done = Vec::new());
        start = end;
    }
    stored
}

/// D_i by (d-ilu).
fn diagonal(jacobian: &SpaceJacobian, cell: usize, dt: f64, lambda: c64, updates: &[Update]) -> Parts {
    let n = jacobian.block;
    let mut parts = vec![diagonal_block(jacobian, cell, dt, lambda.re)];
    if !is_real(lambda) {
        parts.push(diagonal_block(jacobian, cell, 0.0, lambda.im));
    }
    let mut lifted = vec![0.0; n * n];
    for (number, part) in parts.iter_mut().enumerate() {
        lifted.fill(0.0);
        for update in updates {
            jacobian.traces.add_lifted(update.face, &update.parts[number], &mut lifted);
        }
        *part -= MatRef::from_row_major_slice(&lifted, n, n);
    }
    parts
}

fn inverse(parts: &Parts) -> Parts {
    let n = parts[0].nrows();
    match &parts[..] {
        [real] => vec![real.partial_piv_lu().inverse()],
        [re, im, ..] => {
            let inverse = Mat::from_fn(n, n, |i, j| c64::new(re[(i, j)], im[(i, j)])).partial_piv_lu().inverse();
            vec![Mat::from_fn(n, n, |i, j| inverse[(i, j)].re), Mat::from_fn(n, n, |i, j| inverse[(i, j)].im)]
        }
        [] => Vec::new(),
    }
}

fn store(parts: &Parts, n: usize, stored: &mut [f32]) {
    for (part, stored) in parts.iter().zip(stored.chunks_exact_mut(padded(n) * n)) {
        for (j, column) in stored.chunks_exact_mut(padded(n)).enumerate() {
            (0..n).for_each(|i| column[i] = part[(i, j)] as f32);
        }
    }
}

/// dt^2 A_jk D_k^{-1} A_kj for the later neighbours j of the cell k at `position`.
fn fill(
    jacobian: &SpaceJacobian,
    links: &[Link],
    ordering: &Ordering,
    position: usize,
    dt: f64,
    inverse: &Parts,
) -> Vec<Update> {
    let t = jacobian.traces.len();
    let later = links.iter().filter(|link| ordering.positions[link.cell] > position);
    let update = |link: &Link| {
        let there = coupling_block(jacobian, *link);
        let back = coupling_block(jacobian, Link { side: 1 - link.side, ..*link });
        let (there, back) = (MatRef::from_row_major_slice(there, t, t), MatRef::from_row_major_slice(back, t, t));
        let part = |inverse: &Mat<f64>| {
            let inner = traces_of(&jacobian.traces, link.face, jacobian.block, |i, j| inverse[(i, j)]);
            let product = back * MatRef::from_row_major_slice(&inner, t, t) * there;
            (0..t * t).map(|i| dt * dt * product[(i / t, i % t)]).collect()
        };
        Update {
            position: ordering.positions[link.cell],
            face: link.other_face,
            parts: inverse.iter().map(part).collect(),
        }
    };
    later.map(update).collect()
}
