//! Cells that grow by a constant factor, and checks of their parameters.

use crate::MeshError;

/// Cells whose sizes are h, r h, r^2 h, .. with r = e^a. The first t cells, t not necessarily an integer, have the size
///
/// ```text
/// s(t) = h (r^t - 1) / (r - 1) = h (e^{a t} - 1) / (e^a - 1)                                             (growth)
/// ```
///
/// an entire function of t, so curved cells of any order resolve it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Growth {
    first: f64,
    log_factor: f64,
}

impl Growth {
    /// `cells` cells with the first of size `first` and the total size `total` (both positive). One cell alone has the total size.
    pub(super) fn new(cells: usize, first: f64, total: f64) -> Self {
        if cells == 1 {
            return Growth { first: total, log_factor: 0.0 };
        }
        // a = +-600 / cells is a ratio of e^600 between the last cell and the first, beyond every possible input.
        let limit = 600.0 / cells as f64;
        let (mut low, mut high) = (-limit, limit);
        // s(cells) increases with a. Each step halves the bracket.
        for _ in 0..64 {
            let log_factor = 0.5 * (low + high);
            let growth = Growth { first, log_factor };
            if growth.size(cells as f64) < total { low = log_factor } else { high = log_factor }
        }
        Growth { first, log_factor: 0.5 * (low + high) }
    }

    /// (growth)
    pub(super) fn size(&self, t: f64) -> f64 {
        let a = self.log_factor;
        // For a -> 0 the quotient is t (1 + a (t - 1) / 2 + ..).
        let quotient = if a.abs() < 1e-12 { t } else { (a * t).exp_m1() / a.exp_m1() };
        self.first * quotient
    }

    /// r, the size of a cell over the size of the one before.
    pub(super) fn factor(&self) -> f64 {
        self.log_factor.exp()
    }
}

/// Cells that grow by one factor up to a point and by another beyond it.
#[derive(Clone, Copy, Debug)]
pub(super) struct PiecewiseGrowth {
    /// Cells of the first piece and their total size; 0 if all grow alike.
    near: (usize, f64),
    pieces: [Growth; 2],
}

impl PiecewiseGrowth {
    /// `cells` cells with the first of size `first` and the total size `total`. With `near` = (m, size) the first m of them
    /// fill that size, and the next cell continues with the growth factor there.
    pub(super) fn new(near: Option<(usize, f64)>, cells: usize, first: f64, total: f64) -> Self {
        let Some((near_cells, size)) = near else {
            return PiecewiseGrowth { near: (0, 0.0), pieces: [Growth::new(cells, first, total); 2] };
        };
        let inner = Growth::new(near_cells, first, size);
        // If that does not fit into the remaining size, the cells there are equal.
        let next = inner.first * inner.factor().powi(near_cells as i32);
        let equal = (total - size) / (cells - near_cells) as f64;
        let outer = Growth::new(cells - near_cells, next.min(equal), total - size);
        PiecewiseGrowth { near: (near_cells, size), pieces: [inner, outer] }
    }

    /// The size of the first t cells together.
    pub(super) fn size(&self, t: f64) -> f64 {
        let (cells, size) = (self.near.0 as f64, self.near.1);
        if t <= cells { self.pieces[0].size(t) } else { size + self.pieces[1].size(t - cells) }
    }
}

/// Refuses numbers that a generator does not accept.
#[derive(Clone, Copy)]
pub(super) struct Check {
    /// The name of the generator.
    pub(super) mesh: &'static str,
}

impl Check {
    /// Whether `accepted` holds; otherwise the error.
    pub(super) fn that(
        self,
        fine: bool,
        quantity: &'static str,
        value: f64,
        accepted: &'static str,
    ) -> Result<(), MeshError> {
        if fine { Ok(()) } else { Err(MeshError::Parameter { mesh: self.mesh, quantity, value, accepted }) }
    }

    pub(super) fn positive(self, quantity: &'static str, value: f64) -> Result<(), MeshError> {
        self.that(value.is_finite() && value > 0.0, quantity, value, "a positive number")
    }

    /// The height of the first of so many `cells`: a part of their `total`. Others would have no height beside it.
    pub(super) fn first_cell(
        self,
        (cells, height): (usize, f64),
        total: f64,
        accepted: &'static str,
    ) -> Result<(), MeshError> {
        let fine = height < total || (cells == 1 && height == total);
        self.that(fine, "the height of the first cell", height, accepted)
    }

    /// At least one, and few enough to count and store.
    pub(super) fn count(self, quantity: &'static str, value: usize) -> Result<(), MeshError> {
        self.that((1..=100_000).contains(&value), quantity, value as f64, "1 to 100000")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_fill_the_total_and_grow_by_the_factor() {
        for (cells, first, total) in
            [(10, 0.1, 1.0), (12, 0.015, 100.0), (5, 0.5, 1.0), (40, 1e-6, 10.0), (1, 1.0, 1.0)]
        {
            let growth = Growth::new(cells, first, total);
            assert!((growth.size(cells as f64) / total - 1.0).abs() < 1e-12, "{growth:?}");
            assert!((growth.size(1.0) / first - 1.0).abs() < 1e-14);
            let size = |i: usize| growth.size((i + 1) as f64) - growth.size(i as f64);
            for i in 1..cells {
                assert!((size(i) / size(i - 1) / growth.factor() - 1.0).abs() < 1e-9);
            }
        }
    }

    /// Also between its ends, where the nodes of curved cells are.
    #[test]
    fn one_cell_fills_the_total() {
        for first in [0.01, 2.0, 5.0] {
            let growth = Growth::new(1, first, 2.0);
            assert_eq!([0.0, 0.25, 1.0].map(|t| growth.size(t)), [0.0, 0.5, 2.0]);
        }
        let growth = PiecewiseGrowth::new(Some((1, 1.0)), 4, 0.05, 20.0);
        assert_eq!([0.5, 1.0].map(|t| growth.size(t)), [0.5, 1.0]);
        assert!((growth.size(2.0) - 2.0).abs() < 1e-14 && (growth.size(4.0) - 20.0).abs() < 1e-12);
    }

    #[test]
    fn a_near_part_with_large_cells_leaves_room_for_the_rest() {
        for total in [1.2, 2.0, 50.0] {
            let growth = PiecewiseGrowth::new(Some((3, 1.0)), 5, 0.05, total);
            let sizes: Vec<f64> = (0..=5).map(|t| growth.size(f64::from(t))).collect();
            assert!((sizes[3] - 1.0).abs() < 1e-12 && (sizes[5] / total - 1.0).abs() < 1e-12, "{sizes:?}");
            assert!(sizes.windows(2).all(|pair| pair[1] > pair[0]), "{sizes:?}");
        }
    }
}
