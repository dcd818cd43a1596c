//! The constraints: functionals of the displacement of a piece that the coarse problem keeps equal in all blocks.

use crate::ElasticityError;
use crate::geometry;
use crate::substructures::bddc::cholesky;
use crate::substructures::bddc::scaling::Face;
use crate::substructures::exchange::Exchange;
use crate::substructures::interface::{Interface, Piece};
use faer::linalg::solvers::Solve;
use faer::{Mat, Side};
use fem::parallel::{self, Grain};
use newton_krylov::inner_product::{Euclidean, InnerProduct, axpy};
use std::collections::BTreeMap;
use std::ops::Range;

/// Modes of a face whose energy grows by more than this factor when blocks are averaged become constraints.
const LARGEST_EIGENVALUE: f64 = 10.0;

/// A functional that is this near to others is left out.
const DEPENDENT: f64 = 1e-8;

/// The constraints of all pieces.
pub(super) struct Constraints {
    /// The functionals of the pieces of own blocks, `[functional][node][component]`.
    pub(super) of_piece: BTreeMap<usize, Vec<Vec<f64>>>,
    /// The number of all functionals.
    pub(super) count: usize,
    /// The numbers of the functionals of each block.
    pub(super) of_block: Vec<Vec<usize>>,
}

impl Constraints {
    /// A collective call.
    pub(super) fn new<const D: usize>(
        interface: &Interface<D>,
        exchange: &Exchange,
        faces: &BTreeMap<usize, Face>,
    ) -> Result<Self, ElasticityError> {
        let is_own = |piece: &Piece| piece.blocks.iter().any(|&block| exchange.owns(block));
        let own: Vec<usize> = (0..interface.pieces.len()).filter(|&k| is_own(&interface.pieces[k])).collect();
        let of_piece = |k: usize| -> Result<_, ElasticityError> {
            let number = own[k];
            let mut rows = rows(interface, &interface.pieces[number]);
            if let Some(face) = faces.get(&number) {
                add_adaptive_constraints(face, &mut rows)?;
            }
            Ok((number, rows))
        };
        let found = parallel::map(own.len(), Grain::Any, &of_piece);
        let found = found.into_iter().collect::<Result<BTreeMap<usize, Vec<Vec<f64>>>, _>>();
        let of_piece = exchange.agree(found)?;
        let counts = counts(interface, exchange, &of_piece);
        let mut next = 0;
        let numbers: Vec<Range<usize>> =
            counts.into_iter().map(|count| (next..next + count, next += count).0).collect();
        let of_block = |block| interface.pieces_of(block).flat_map(|(piece, _)| numbers[piece].clone()).collect();
        let of_block = (0..interface.of_block.len()).map(of_block).collect();
        Ok(Constraints { of_piece, of_block, count: next })
    }
}

/// The number of functionals of every piece, which the owner of its first block tells.
fn counts<const D: usize>(
    interface: &Interface<D>,
    exchange: &Exchange,
    of_piece: &BTreeMap<usize, Vec<Vec<f64>>>,
) -> Vec<usize> {
    let own = (0..interface.of_block.len()).filter(|&block| exchange.owns(block));
    let parts = own.map(|block| interface.led_by(block).map(|piece| of_piece[&piece].len() as f64).collect());
    let all = exchange.gather(parts.collect(), |block| interface.led_by(block).count());
    let mut counts = vec![0; interface.pieces.len()];
    for (block, part) in all.iter().enumerate() {
        interface.led_by(block).zip(part).for_each(|(piece, count)| counts[piece] = *count as usize);
    }
    counts
}

/// The functionals of a piece without regard to its stiffness: all values at a vertex, the moments with rigid motions otherwise.
fn rows<const D: usize>(interface: &Interface<D>, piece: &Piece) -> Vec<Vec<f64>> {
    let length = piece.places.len() * D;
    let held = |k: usize| interface.held[piece.places[k / D]][k % D];
    let free = (0..length).filter(|&k| !held(k));
    if piece.is_vertex::<D>() {
        return free.map(|k| (0..length).map(|other| f64::from(u8::from(k == other))).collect()).collect();
    }
    let mut motions = rigid_motions(interface, piece);
    motions.iter_mut().for_each(|motion| (0..length).filter(|&k| held(k)).for_each(|k| motion[k] = 0.0));
    orthonormal(motions)
}

/// The rigid motions of a piece about its centre.
fn rigid_motions<const D: usize>(interface: &Interface<D>, piece: &Piece) -> Vec<Vec<f64>> {
    let centre = interface.centre(&piece.places);
    let mut motions = vec![Vec::new(); D * (D + 1) / 2];
    for &place in &piece.places {
        let x = std::array::from_fn(|i| interface.positions[place][i] - centre[i]);
        motions.iter_mut().zip(geometry::rigid_motions::<D>(&x)).for_each(|(all, motion)| all.extend(motion));
    }
    motions
}

/// Gram-Schmidt, twice; vectors that depend on those before are left out.
fn orthonormal(vectors: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let mut basis: Vec<Vec<f64>> = Vec::new();
    for mut vector in vectors {
        let size = Euclidean.norm(&vector);
        for _ in 0..2 {
            for q in &basis {
                let along = Euclidean.dot(q, &vector);
                axpy(-along, q, &mut vector);
            }
        }
        let rest = Euclidean.norm(&vector);
        if rest > DEPENDENT * size {
            vector.iter_mut().for_each(|x| *x /= rest);
            basis.push(vector);
        }
    }
    basis
}

/// Adds the functionals of the modes v of a face for which (S_0 : S_1) v = l (T_0 : T_1) v with a large l, among those where `rows`
/// vanish. A : B = A (A + B)^{-1} B is the parallel sum, S_b the stiffness of the face in block b, and T_b the same with the rest of the
/// block's interface free (Mandel, Sousedik & Sistek 2012).
///
/// 1. Scale: both parallel sums in the variables x / d, where d makes the diagonal of S_0 + S_1 one.
/// 2. Restrict them to Z, a basis of the vectors where `rows` vanish.
/// 3. Z^T (T_0 : T_1) Z y = w Z^T (S_0 : S_1) Z y by a Cholesky factor of the right side.
/// 4. Every mode with w < 1 / LARGEST_EIGENVALUE gives the functional (S_0 : S_1) v.
fn add_adaptive_constraints(face: &Face, rows: &mut Vec<Vec<f64>>) -> Result<(), ElasticityError> {
    let [s_0, s_1] = &face.stiff;
    let d: Vec<f64> = (0..s_0.nrows()).map(|i| 1.0 / (s_0[(i, i)] + s_1[(i, i)]).sqrt()).collect();
    let scaled = |m: &Mat<f64>| Mat::from_fn(d.len(), d.len(), |i, j| d[i] * m[(i, j)] * d[j]);
    let stiff = parallel_sum(face.stiff.each_ref().map(scaled))?;
    let free = parallel_sum(face.free.each_ref().map(scaled))?;
    let z = null_space(rows, &d);
    if z.ncols() == 0 {
        return Ok(());
    }
    let factor = cholesky(&(z.transpose() * &stiff * &z), "a face")?;
    let half = |m: &Mat<f64>| {
        let mut m = m.clone();
        faer::linalg::triangular_solve::solve_lower_triangular_in_place(factor.L(), m.as_mut(), faer::Par::Seq);
        m
    };
    let reduced = half(&half(&(z.transpose() * &free * &z)).transpose().to_owned());
    let eigen = reduced.self_adjoint_eigen(Side::Lower);
    let eigen = eigen.map_err(|cause| ElasticityError::NotDefinite { cause: format!("a face: {cause:?}") })?;
    let values = eigen.S().column_vector();
    let adaptive = (0..values.nrows()).take_while(|&k| values[k] < 1.0 / LARGEST_EIGENVALUE).count();
    let mut y = eigen.U().subcols(0, adaptive).to_owned();
    let upper = factor.L().transpose();
    faer::linalg::triangular_solve::solve_upper_triangular_in_place(upper, y.as_mut(), faer::Par::Seq);
    let functionals = &stiff * &z * &y;
    let new = (0..adaptive).map(|k| functionals.col_as_slice(k).iter().zip(&d).map(|(f, d)| f / d).collect());
    let all = rows.drain(..).chain(new.map(|row: Vec<f64>| unit(row))).collect();
    *rows = orthonormal(all);
    Ok(())
}

fn unit(mut row: Vec<f64>) -> Vec<f64> {
    let size = Euclidean.norm(&row);
    row.iter_mut().for_each(|x| *x /= size);
    row
}

/// A (A + B)^{-1} B, made symmetric.
fn parallel_sum([a, b]: [Mat<f64>; 2]) -> Result<Mat<f64>, ElasticityError> {
    let mut sum = &a + &b;
    (0..sum.nrows()).for_each(|i| sum[(i, i)] *= 1.0 + 1e-12);
    let product = &a * cholesky(&sum, "a face")?.solve(&b);
    Ok(Mat::from_fn(a.nrows(), a.nrows(), |i, j| 0.5 * (product[(i, j)] + product[(j, i)])))
}

/// An orthonormal basis of the x for which all `rows` of d x vanish.
fn null_space(rows: &[Vec<f64>], d: &[f64]) -> Mat<f64> {
    let columns = Mat::from_fn(d.len(), rows.len(), |i, k| rows[k][i] * d[i]);
    columns.qr().compute_Q().subcols(rows.len(), d.len() - rows.len()).to_owned()
}
