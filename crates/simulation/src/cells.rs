//! Numbers of the flow in some cells. With several ranks no rank has the whole flow: rank 0 receives what it asks for.

use std::borrow::Cow;
use std::collections::HashMap;
use std::ops::Range;

/// At most so many numbers are made or received at a time: 2 MB.
const PART: usize = 1 << 18;

/// All of so many `cells`, in ranges of at most [`PART`] numbers, where each cell has `len`.
pub fn ranges(cells: usize, len: usize) -> impl Iterator<Item = Range<usize>> + Clone {
    let step = (PART / len.max(1)).max(1);
    (0..cells).step_by(step).map(move |start| start..cells.min(start + step))
}

/// All of so many `cells` in rounds, each with a range for every one of so many `ranks`, which may be empty. Each range has at most [`PART`] numbers,
/// where each cell has `len`.
pub fn rounds(cells: usize, len: usize, ranks: usize) -> impl Iterator<Item = Vec<Range<usize>>> {
    let step = (PART / len.max(1)).clamp(1, cells.div_ceil(ranks).max(1));
    let range = move |start: usize| start.min(cells)..cells.min(start + step);
    (0..cells).step_by(step * ranks).map(move |start| (0..ranks).map(|rank| range(start + rank * step)).collect())
}

/// Where the state in some cells comes from; they may be listed twice.
pub type StateSource<'a> = dyn Fn(Vec<usize>) -> StateInCells<'a> + 'a;

/// The state at one time, or the states of a slab, in some cells or in all.
pub struct StateInCells<'a> {
    /// `[component][node]` for each cell.
    values: Cow<'a, [f64]>,
    /// Numbers in a cell.
    len: usize,
    /// Where the values of a cell are; in all cells they are in order.
    places: Option<HashMap<usize, usize>>,
}

impl<'a> StateInCells<'a> {
    /// In all cells, with `len` numbers each.
    pub fn whole(values: &'a [f64], len: usize) -> Self {
        StateInCells { values: values.into(), len, places: None }
    }

    /// In `cells`, with `len` numbers each.
    pub fn some(cells: &[usize], values: Vec<f64>, len: usize) -> Self {
        StateInCells { values: values.into(), len, places: Some(cells.iter().copied().zip(0..).collect()) }
    }

    /// The state at a time of the slabs that these states are, `[time node][component][node]`: sum_a phi_a u_a.
    pub fn at_time(&self, phi: &[f64]) -> StateInCells<'static> {
        let len = self.len / phi.len();
        let at = |slab: &[f64]| {
            let at_time = Combination { factors: phi.to_vec(), fields: slab.chunks_exact(len).collect() };
            (0..len).map(|entry| at_time.at(entry)).collect::<Vec<f64>>()
        };
        let values: Vec<f64> = self.values.chunks_exact(self.len).flat_map(at).collect();
        StateInCells { values: values.into(), len, places: self.places.clone() }
    }

    /// The state in `cell`, `[component][node]`.
    ///
    /// # Panics
    /// If `cell` is not among the cells.
    pub fn of(&self, cell: usize) -> &[f64] {
        let place = self.places.as_ref().map_or(cell, |places| places[&cell]);
        &self.values[place * self.len..][..self.len]
    }
}

/// A combination of fields of one length: sum_a factors_a fields_a. Without fields it is zero.
pub struct Combination<'a> {
    /// The factors.
    pub factors: Vec<f64>,
    /// The fields.
    pub fields: Vec<&'a [f64]>,
}

impl<'a> Combination<'a> {
    /// One field.
    pub fn of_one(field: &'a [f64]) -> Self {
        Combination { factors: vec![1.0], fields: vec![field] }
    }

    /// An entry.
    pub fn at(&self, entry: usize) -> f64 {
        self.factors.iter().zip(&self.fields).fold(0.0, |sum, (factor, field)| sum + factor * field[entry])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slabs_are_combined_cell_by_cell() {
        // Two cells with two time nodes and two numbers each.
        let slabs = StateInCells::some(&[5, 3], vec![1.0, 2.0, 3.0, 4.0, 10.0, 20.0, 30.0, 40.0], 4);
        let at_time = slabs.at_time(&[0.5, 2.0]);
        assert_eq!([at_time.of(5), at_time.of(3)], [&[6.5, 9.0], &[65.0, 90.0]]);
    }

    #[test]
    fn ranges_cover_all_cells_once() {
        for (cells, len) in [(0, 5), (1, 1 << 22), (7, 1 << 19), (1000, 640), (3, 0)] {
            let covered: Vec<usize> = ranges(cells, len).flatten().collect();
            assert_eq!(covered, (0..cells).collect::<Vec<_>>());
            assert!(ranges(cells, len).all(|range| range.len() == 1 || range.len() * len <= PART));
        }
    }

    #[test]
    fn rounds_cover_all_cells_once() {
        for (cells, len, ranks) in [(0, 5, 2), (1, 1 << 22, 3), (7, 1 << 19, 4), (1000, 640, 3), (3, 0, 2), (10, 1, 1)]
        {
            let rounds: Vec<Vec<Range<usize>>> = rounds(cells, len, ranks).collect();
            assert_eq!(rounds.iter().flatten().cloned().flatten().collect::<Vec<_>>(), (0..cells).collect::<Vec<_>>());
            assert!(rounds.iter().all(|ranges| ranges.len() == ranks));
            assert!(rounds.iter().flatten().all(|range| range.len() <= 1 || range.len() * len <= PART));
        }
    }

    #[test]
    fn a_cell_has_the_same_state_in_some_cells_as_in_all() {
        let values = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0];
        let some = StateInCells::some(&[2, 0], vec![4.0, 5.0, 0.0, 1.0], 2);
        let whole = StateInCells::whole(&values, 2);
        assert_eq!([some.of(0), some.of(2)], [whole.of(0), whole.of(2)]);
    }
}
