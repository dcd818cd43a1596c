//! Location and quantity of an inadmissible state.

use crate::operator::{SlabOperator, Violation};
use crate::share::Share;
use crate::tables::Shape1d;
use tensor::det;

/// The polynomials of mesh and flow at the quadrature points and the ends of a direction. In a cell these are all points at
/// which kernels evaluate the state, including its faces.
struct Points {
    mesh: Shape1d,
    flow: Shape1d,
    per_direction: usize,
}

impl<const D: usize, const M: usize> SlabOperator<D, M> {
    /// Finds the first inadmissible quantity behind a NaN in the residual of `cell`: in the cell itself, then in those across its
    /// faces.
    pub(crate) fn describe_violation(&self, cell: usize) -> Violation {
        let points = self.points();
        let around = std::iter::once(cell).chain((0..2 * D).map(|face| self.across_face(cell, face).cell));
        let (quantity, time) = ("residual (not a number)".to_string(), self.clock().time(0.0));
        let nothing = || Violation { quantity, value: f64::NAN, cell: self.in_whole(cell), time };
        around.into_iter().find_map(|cell| self.violation_in(&points, cell)).unwrap_or_else(nothing)
    }

    /// The number of a cell in the whole mesh.
    fn in_whole(&self, cell: usize) -> usize {
        self.share.cells().nth(cell).unwrap_or(cell)
    }

    fn points(&self) -> Points {
        let orders = self.tables.orders;
        let points = [&[-1.0], &self.tables.rule.points[..], &[1.0]].concat();
        let line = |order: usize| Shape1d::new(order, &points);
        Points { mesh: line(orders.mesh), flow: line(orders.flow), per_direction: points.len() }
    }

    fn violation_in(&self, points: &Points, cell: usize) -> Option<Violation> {
        let time_points = self.tables.time_points.iter().chain([&self.tables.top]).zip(&self.position_rows);
        time_points.into_iter().find_map(|(time_point, row)| {
            let found = self.violation_at(points, cell, time_point.values.row(0), row.row(0));
            let (cell, time) = (self.in_whole(cell), self.clock().time(time_point.s));
            found.map(|(quantity, value)| Violation { quantity: quantity.to_string(), value, cell, time })
        })
    }

    fn violation_at(&self, points: &Points, cell: usize, phi: &[f64], row: &[f64]) -> Option<(&'static str, f64)> {
        let mut position = vec![0.0; self.mesh.slot_len()];
        self.mesh.relative_positions(cell, row, &mut position);
        let mut state = vec![0.0; self.layout.time_len()];
        for (weight, nodal) in phi.iter().zip(self.traced_state().cell(cell).chunks_exact(self.layout.time_len())) {
            state.iter_mut().zip(nodal).for_each(|(u, value)| *u += weight * value);
        }
        let number = points.per_direction.pow(D as u32);
        (0..number).find_map(|p| self.violation_at_point(points, p, &position, &state))
    }

    fn violation_at_point(
        &self,
        points: &Points,
        p: usize,
        position: &[f64],
        state: &[f64],
    ) -> Option<(&'static str, f64)> {
        let index: [usize; D] = std::array::from_fn(|d| p / points.per_direction.pow(d as u32) % points.per_direction);
        let tensor = |nodal: &[f64], line: &Shape1d, derivative: Option<usize>| -> f64 {
            let weight = |i: usize| -> f64 {
                (0..D)
                    .map(|d| {
                        let matrix = if derivative == Some(d) { &line.derivatives } else { &line.values };
                        matrix[(index[d], i / line.order.pow(d as u32) % line.order)]
                    })
                    .product()
            };
            nodal.iter().enumerate().map(|(i, value)| weight(i) * value).sum()
        };
        let nodes = position.len() / D;
        let jacobian: [[f64; D]; D] = std::array::from_fn(|i| {
            std::array::from_fn(|j| tensor(&position[i * nodes..(i + 1) * nodes], &points.mesh, Some(j)))
        });
        let det = det(&jacobian);
        if det.is_nan() || det <= 0.0 {
            return Some(("det J", det));
        }
        let nodes = self.layout.nodes;
        let u: [f64; M] = std::array::from_fn(|m| tensor(&state[m * nodes..(m + 1) * nodes], &points.flow, None));
        self.problem.kernels.inadmissible(&u)
    }
}

impl Share {
    /// Of the violations that ranks have found, that in the first cell. A collective call.
    pub fn first_violation(&self, own: Option<Violation>) -> Option<Violation> {
        if !self.is_distributed() {
            return own;
        }
        let numbers = own.map_or(Vec::new(), |Violation { quantity, value, cell, time }| {
            [cell as f64, value, time].into_iter().chain(quantity.bytes().map(f64::from)).collect()
        });
        let found = self.sums.communicator().all_gather(&numbers).into_iter().filter(|numbers| numbers.len() > 3);
        let first = found.min_by(|a, b| a[0].total_cmp(&b[0]))?;
        let quantity = first[3..].iter().map(|&byte| byte as u8 as char).collect();
        Some(Violation { quantity, value: first[1], cell: first[0] as usize, time: first[2] })
    }
}
