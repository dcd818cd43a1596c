//! The work of one application of K.

use super::{LineTables, Operator};

impl LineTables {
    /// Multiplications of one cell in the passes along axes, for D components:
    ///
    /// ```text
    /// 2 D sum_a q^(a+1) n^(D-a)  +  2 D D q^(D+1)                                                                 (work)
    /// ```
    ///
    /// to the points and back, then derivatives along every axis and their transposes, with n nodes and q points per direction. The
    /// law takes a constant number of operations at each of q^D points.
    fn multiplications<const D: usize>(&self) -> usize {
        let (q, n) = (self.interpolate.rows(), self.interpolate.cols());
        let to_points: usize = (0..D as u32).map(|a| q.pow(a + 1) * n.pow(D as u32 - a)).sum();
        2 * D * (to_points + D * q.pow(D as u32 + 1))
    }
}

impl<const D: usize> Operator<D> {
    /// Multiplications of the sum factorisation of one application, in all cells.
    pub(crate) fn multiplications(&self) -> usize {
        self.batches.cells() * self.lines.multiplications::<D>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::quadrature_points;
    use basis::gauss;

    /// Multiplications per unknown of a large mesh: (n - 1)^D nodes per cell.
    fn per_unknown<const D: usize>(order: usize) -> f64 {
        let lines = LineTables::new(order, &gauss(quadrature_points(D, order)).points);
        lines.multiplications::<D>() as f64 / (D * (order - 1).pow(D as u32)) as f64
    }

    fn assert_linear<const D: usize>() {
        for order in 2..=16 {
            let growth = per_unknown::<D>(order) / per_unknown::<D>(2);
            assert!(growth <= order as f64 / 2.0, "D = {D}, N = {order}: {growth}");
        }
        for order in [2, 4, 8] {
            let growth = per_unknown::<D>(2 * order) / per_unknown::<D>(order);
            assert!(growth <= 2.0, "D = {D}, N = {order} to {}: {growth}", 2 * order);
        }
    }

    /// A dense matrix per cell needs 2^D times as many for every doubling of n.
    #[test]
    fn work_per_unknown_grows_no_faster_than_the_order() {
        assert_linear::<2>();
        assert_linear::<3>();
    }
}
