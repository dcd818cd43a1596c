//! Work whose code is large: it is compiled here for every kind of numbers, and not anew in every crate that factors a matrix.

use crate::elimination_tree::EliminationTree;
use crate::factorisation::{Assembly, Factorisation};
use crate::{Error, Kind};
use faer::{c32, c64};
use std::sync::Arc;

/// The methods of [`Factorisation`] for one kind of numbers.
pub trait Compiled: Sized {
    /// See [`Factorisation::new`].
    fn factor(
        tree: Arc<EliminationTree>,
        block: usize,
        kind: Kind,
        assemble: &Assembly<Self>,
    ) -> Result<Factorisation<Self>, Error>;
    /// See [`Factorisation::eliminate`].
    fn eliminate(factors: &Factorisation<Self>, x: &mut [Self], count: usize, work: &mut Vec<Self>);
    /// See [`Factorisation::substitute`].
    fn substitute(factors: &Factorisation<Self>, x: &mut [Self], count: usize, work: &mut Vec<Self>);
}

macro_rules! compiled {
    ($($number:ty)*) => {$(
        impl Compiled for $number {
            fn factor(
                tree: Arc<EliminationTree>,
                block: usize,
                kind: Kind,
                assemble: &Assembly<Self>,
            ) -> Result<Factorisation<Self>, Error> {
                Factorisation::factored(tree, block, kind, assemble)
            }
            fn eliminate(factors: &Factorisation<Self>, x: &mut [Self], count: usize, work: &mut Vec<Self>) {
                factors.forward_sweep(x, count, work);
            }
            fn substitute(factors: &Factorisation<Self>, x: &mut [Self], count: usize, work: &mut Vec<Self>) {
                factors.backward_sweep(x, count, work);
            }
        }
    )*};
}

compiled!(f64 f32 c64 c32);
