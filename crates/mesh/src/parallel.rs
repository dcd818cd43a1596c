//! Loops in parallel over cells, batches and facets.
//!
//! The work is a `dyn Fn`, and [`map`] has one loop of rayon for all kinds of results: the copies for every caller were a sixth of the code. Results
//! do not depend on how the loop is divided among threads.
//!
//! Residuals and their products of `fem` have loops of their own (`operator::evaluation`, `traces`, `mesh_traces`): here they took 6 to 10 % longer, because
//! less was inlined.

use rayon::prelude::*;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// How many iterations of a loop a task takes.
#[derive(Clone, Copy)]
pub enum Grain {
    /// As rayon divides the loop.
    Any,
    /// This many or more.
    AtLeast(usize),
    /// This many or fewer.
    AtMost(usize),
}

impl Grain {
    fn limit<I: IndexedParallelIterator>(self, iterations: I) -> impl IndexedParallelIterator<Item = I::Item> {
        let (least, most) = match self {
            Grain::Any => (1, usize::MAX),
            Grain::AtLeast(least) => (least, usize::MAX),
            Grain::AtMost(most) => (1, most),
        };
        iterations.with_min_len(least).with_max_len(most)
    }
}

/// Calls `work` with every number below `count`.
pub fn for_each(count: usize, grain: Grain, work: &(dyn Fn(usize) + Sync)) {
    grain.limit((0..count).into_par_iter()).for_each(work);
}

/// The `value` of every number below `count`, in order.
pub fn map<R: Send>(count: usize, grain: Grain, value: &(dyn Fn(usize) -> R + Sync)) -> Vec<R> {
    let results: Vec<Mutex<Option<R>>> = (0..count).map(|_| Mutex::new(None)).collect();
    for_each(count, grain, &|number| *locked(&results[number]) = Some(value(number)));
    let taken = |result: Mutex<Option<R>>| result.into_inner().unwrap_or_else(PoisonError::into_inner);
    results.into_iter().filter_map(taken).collect()
}

/// What no other task uses.
fn locked<T>(alone: &Mutex<T>) -> MutexGuard<'_, T> {
    alone.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Calls `work` with the number of every chunk of `len` values, and the chunk. The last one may be shorter.
pub fn for_each_chunk<T: Send>(values: &mut [T], len: usize, grain: Grain, work: &(dyn Fn(usize, &mut [T]) + Sync)) {
    grain.limit(values.par_chunks_mut(len).enumerate()).for_each(|(number, chunk)| work(number, chunk));
}

/// Work on the chunks of a number in two arrays.
pub type PairWork<'a, A, B> = dyn Fn(usize, &mut [A], &mut [B]) + Sync + 'a;

/// The same for the chunks of two arrays, as many as the one with fewer has.
pub fn for_each_pair<A: Send, B: Send>(
    (a, len_a): (&mut [A], usize),
    (b, len_b): (&mut [B], usize),
    grain: Grain,
    work: &PairWork<A, B>,
) {
    let pairs = a.par_chunks_mut(len_a).zip(b.par_chunks_mut(len_b)).enumerate();
    grain.limit(pairs).for_each(|(number, (a, b))| work(number, a, b));
}

/// The results of `work` with all chunks of `len` values, in order.
pub fn map_chunks<T: Send, R: Send>(
    values: &mut [T],
    len: usize,
    work: &(dyn Fn(usize, &mut [T]) -> R + Sync),
) -> Vec<R> {
    let chunks: Vec<Mutex<&mut [T]>> = values.chunks_mut(len).map(Mutex::new).collect();
    map(chunks.len(), Grain::Any, &|number| work(number, &mut locked(&chunks[number])))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_and_chunk_comes_once_and_in_order() {
        for grain in [Grain::Any, Grain::AtLeast(3), Grain::AtMost(2)] {
            assert_eq!(map(7, grain, &|k| 2 * k), [0, 2, 4, 6, 8, 10, 12]);
            let (mut a, mut b) = ([0; 7], [0; 4]);
            for_each_chunk(&mut a, 2, grain, &|k, chunk| chunk.fill(k + chunk.len()));
            assert_eq!(a, [2, 2, 3, 3, 4, 4, 4]);
            for_each_pair((&mut a, 2), (&mut b, 1), grain, &|k, a, b| b[0] = a[0] + k);
            assert_eq!(b, [2, 4, 6, 7]);
        }
        assert_eq!(map_chunks(&mut [5, 6, 7], 2, &|k, chunk| k + chunk.len()), [2, 2]);
    }
}
