//! Deluxe scaling: what each block takes of the residual at the pieces of its interface.

use crate::ElasticityError;
use crate::substructures::bddc::{cholesky, submatrix};
use crate::substructures::exchange::{Exchange, packed, packed_length, unpacked};
use crate::substructures::interface::Interface;
use faer::Mat;
use faer::linalg::solvers::{DenseSolveCore, Llt, Solve};
use fem::parallel::{self, Grain};
use std::collections::BTreeMap;

/// Shifts of S_b, relative to its diagonal, where it need not be definite.
const SHIFTS: [f64; 4] = [1e-9, 1e-6, 1e-3, 1e-1];

/// S_b,F of the own blocks, and the factor of their sums over all blocks, by pieces.
pub(super) struct Scaling<const D: usize> {
    pieces: BTreeMap<usize, Scaled>,
}

struct Scaled {
    of_own: BTreeMap<usize, Mat<f64>>,
    sum: Llt<f64>,
}

/// What both sides of a face know of it: S_b,F, and the Schur complement of S_b on F, with the rest of the block's interface free.
pub(super) struct Face {
    pub(super) stiff: [Mat<f64>; 2],
    pub(super) free: [Mat<f64>; 2],
}

/// The matrices of a piece in a block.
struct OfPiece {
    stiff: Mat<f64>,
    /// Of faces only.
    free: Option<Mat<f64>>,
}

/// By piece and block.
type OfPieces = BTreeMap<(usize, usize), OfPiece>;

impl<const D: usize> Scaling<D> {
    /// From the S_b of the own blocks; also the faces of the own blocks. A collective call.
    pub(super) fn new(
        interface: &Interface<D>,
        exchange: &Exchange,
        own: &[Mat<f64>],
    ) -> Result<(Self, BTreeMap<usize, Face>), ElasticityError> {
        let first = exchange.first_own();
        let of_block = |place: usize| pieces_of(interface, first + place, &own[place]);
        let found = parallel::map(own.len(), Grain::Any, &of_block).into_iter().collect::<Result<Vec<_>, _>>();
        let mut all: OfPieces = exchange.agree(found)?.into_iter().flatten().collect();
        receive(interface, exchange, &mut all);
        exchange.agree(Self::assembled(interface, exchange, all))
    }

    /// The same from the matrices of all pieces of own blocks.
    fn assembled(
        interface: &Interface<D>,
        exchange: &Exchange,
        mut all: OfPieces,
    ) -> Result<(Self, BTreeMap<usize, Face>), ElasticityError> {
        let (mut pieces, mut faces) = (BTreeMap::new(), BTreeMap::new());
        for (number, piece) in interface.pieces.iter().enumerate() {
            if !piece.blocks.iter().any(|&block| exchange.owns(block)) {
                continue;
            }
            let mut of_own = BTreeMap::new();
            let mut sum = Mat::zeros(piece.places.len() * D, piece.places.len() * D);
            let mut sides = Vec::new();
            for &block in &piece.blocks {
                let OfPiece { stiff, free } = all.remove(&(number, block)).expect("it is own or was received");
                sum += &stiff;
                if let Some(free) = free {
                    sides.push((stiff.clone(), free));
                }
                if exchange.owns(block) {
                    of_own.insert(block, stiff);
                }
            }
            if let Ok([(s_0, t_0), (s_1, t_1)]) = <[_; 2]>::try_from(sides) {
                faces.insert(number, Face { stiff: [s_0, s_1], free: [t_0, t_1] });
            }
            pieces.insert(number, Scaled { of_own, sum: cholesky(&sum, "a piece of the interface")? });
        }
        Ok((Scaling { pieces }, faces))
    }

    /// (sum_j S_j,F)^{-1} x on the pieces of own blocks.
    pub(super) fn over_sums(&self, interface: &Interface<D>, x: &[f64]) -> BTreeMap<usize, Vec<f64>> {
        let solved = |(&number, scaled): (&usize, &Scaled)| {
            let places = &interface.pieces[number].places;
            let of_piece: Vec<f64> = places.iter().flat_map(|place| &x[place * D..][..D]).copied().collect();
            (number, solution(&scaled.sum, &of_piece))
        };
        let pieces: Vec<_> = self.pieces.iter().collect();
        parallel::map(pieces.len(), Grain::Any, &|k| solved(pieces[k])).into_iter().collect()
    }

    /// S_b,F x on every piece of an own block, from the x of the pieces.
    pub(super) fn share<'a>(
        &self,
        interface: &Interface<D>,
        block: usize,
        of_piece: impl Fn(usize) -> &'a Vec<f64>,
    ) -> Vec<f64> {
        let mut share = vec![0.0; interface.of_block[block].len() * D];
        for (number, rows) in interface.pieces_of(block) {
            let (stiff, x) = (&self.pieces[&number].of_own[&block], of_piece(number));
            for (column, x) in x.iter().enumerate() {
                let entries = rows.iter().zip(stiff.col_as_slice(column));
                entries.for_each(|(&row, entry)| share[row] += entry * x);
            }
        }
        share
    }

    /// Sets `u` on all ranks to the values on pieces, each from the owner of its first block. A collective call.
    pub(super) fn collect(
        &self,
        interface: &Interface<D>,
        exchange: &Exchange,
        values: &BTreeMap<usize, Vec<f64>>,
        u: &mut [f64],
    ) {
        let own = (0..interface.of_block.len()).filter(|&block| exchange.owns(block));
        let of_block = |block| interface.led_by(block).flat_map(|piece| values[&piece].iter().copied()).collect();
        let length = |block| interface.led_by(block).map(|piece| interface.pieces[piece].places.len() * D).sum();
        for (block, part) in exchange.gather(own.map(of_block).collect(), length).iter().enumerate() {
            let places = interface.led_by(block).flat_map(|piece| &interface.pieces[piece].places);
            for (place, value) in places.zip(part.chunks_exact(D)) {
                u[place * D..][..D].copy_from_slice(value);
            }
        }
    }

    pub(super) fn bytes(&self) -> usize {
        let entries = |scaled: &Scaled| {
            let size = scaled.sum.L().nrows();
            (1 + scaled.of_own.len()) * size * size
        };
        self.pieces.values().map(entries).sum::<usize>() * size_of::<f64>()
    }
}

/// The solution of a system, and the inverse of its matrix. Compiled here once, and not for every dimension.
fn solution(factor: &Llt<f64>, right_side: &[f64]) -> Vec<f64> {
    factor.solve(Mat::from_fn(right_side.len(), 1, |i, _| right_side[i])).col_as_slice(0).to_vec()
}

fn inverse(factor: &Llt<f64>) -> Mat<f64> {
    factor.inverse()
}

/// The matrices of the pieces of a block, by (piece, block).
fn pieces_of<const D: usize>(
    interface: &Interface<D>,
    block: usize,
    s: &Mat<f64>,
) -> Result<OfPieces, ElasticityError> {
    let flexibility = shifted_inverse(s)?;
    let of_piece = |(number, rows): (usize, &[usize])| {
        let is_face = interface.pieces[number].is_face::<D>();
        let free = is_face.then(|| cholesky(&submatrix(&flexibility, rows), "a face").map(|factor| inverse(&factor)));
        Ok(((number, block), OfPiece { stiff: submatrix(s, rows), free: free.transpose()? }))
    };
    interface.pieces_of(block).map(of_piece).collect()
}

/// The inverse of S_b with the least of [`SHIFTS`] that makes it positive definite. Rotations of a block that touches no support cost no energy;
/// where it is stressed and its law is not linear, they may even set some free.
fn shifted_inverse(s: &Mat<f64>) -> Result<Mat<f64>, ElasticityError> {
    let factored = |shift: f64| {
        let mut shifted = s.clone();
        (0..s.nrows()).for_each(|i| shifted[(i, i)] *= 1.0 + shift);
        cholesky(&shifted, "the interface of a block")
    };
    let [least, larger @ ..] = SHIFTS;
    let factor = larger.iter().fold(factored(least), |factor, shift| factor.or_else(|_| factored(*shift)));
    Ok(inverse(&factor?))
}

/// Exchanges the matrices of pieces that several ranks have. A collective call.
fn receive<const D: usize>(interface: &Interface<D>, exchange: &Exchange, all: &mut OfPieces) {
    let shared = |from: usize, to: usize| -> Vec<(usize, usize)> {
        let pairs = interface.pieces.iter().enumerate().flat_map(|(number, piece)| {
            let needs = piece.blocks.iter().any(|&block| exchange.rank_of(block) == to);
            piece.blocks.iter().filter(move |_| needs).map(move |&block| (number, block))
        });
        pairs.filter(|(_, block)| exchange.rank_of(*block) == from).collect()
    };
    let size = |number: usize| interface.pieces[number].places.len() * D;
    let matrices = |number: usize| if interface.pieces[number].is_face::<D>() { 2 } else { 1 };
    let length = |(number, _): &(usize, usize)| matrices(*number) * packed_length(size(*number));
    let message = |pair: &(usize, usize)| {
        let OfPiece { stiff, free } = &all[pair];
        [Some(stiff), free.as_ref()].into_iter().flatten().flat_map(packed).collect::<Vec<f64>>()
    };
    let received = exchange.between_ranks(
        |to| shared(exchange.rank(), to).iter().flat_map(message).collect(),
        |from| shared(from, exchange.rank()).iter().map(length).sum(),
    );
    for (from, numbers) in received {
        let mut rest = &numbers[..];
        for pair in shared(from, exchange.rank()) {
            let (own, behind) = rest.split_at(length(&pair));
            let mut of_pair = own.chunks_exact(packed_length(size(pair.0))).map(|m| unpacked(m, size(pair.0)));
            let stiff = of_pair.next().expect("a piece has nodes");
            all.insert(pair, OfPiece { stiff, free: of_pair.next() });
            rest = behind;
        }
    }
}
