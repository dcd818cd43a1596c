//! Where and how a state is inadmissible.

use crate::operator::{SlabOperator, Violation};
use tensor::{cofactor, determinant};

impl<const D: usize, const M: usize> SlabOperator<D, M> {
    /// Looks through the quadrature points of `cell` for the first inadmissible quantity.
    pub(crate) fn describe_violation(&self, cell: usize) -> Violation {
        let (start, dt) = self.interval();
        for (instant, row) in self.tables.instants.iter().chain([&self.tables.top]).zip(&self.position_rows) {
            let time = start + dt * instant.s;
            if let Some((quantity, value)) = self.violation_at(cell, instant.values.row(0), row.row(0)) {
                return Violation { quantity, value, cell, time };
            }
        }
        Violation { quantity: "residual (not a number)", value: f64::NAN, cell, time: start }
    }

    fn violation_at(&self, cell: usize, phi: &[f64], row: &[f64]) -> Option<(&'static str, f64)> {
        let mut position = vec![0.0; self.mesh.slot_len()];
        self.mesh.positions(cell, row, &mut position);
        let mut state = vec![0.0; self.layout.time_len()];
        for (a, weight) in phi.iter().enumerate() {
            let nodal = &self.linearisation()[self.layout.cell_at(cell, a)];
            state.iter_mut().zip(nodal).for_each(|(u, value)| *u += weight * value);
        }
        let points = self.tables.volume_points();
        (0..points).find_map(|p| self.violation_at_point(p, &position, &state))
    }

    fn violation_at_point(&self, p: usize, position: &[f64], state: &[f64]) -> Option<(&'static str, f64)> {
        let q = self.tables.rule.points.len();
        let index: [usize; D] = std::array::from_fn(|d| p / q.pow(d as u32) % q);
        let (mesh, flow) = (&self.tables.mesh, &self.tables.flow);
        let tensor = |nodal: &[f64], line: &crate::tables::Line, derivative: Option<usize>| -> f64 {
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
            std::array::from_fn(|j| tensor(&position[i * nodes..(i + 1) * nodes], mesh, Some(j)))
        });
        let det = determinant(&jacobian, &cofactor(&jacobian));
        if det.is_nan() || det <= 0.0 {
            return Some(("det J", det));
        }
        let nodes = self.layout.nodes;
        let u: [f64; M] = std::array::from_fn(|m| tensor(&state[m * nodes..(m + 1) * nodes], flow, None));
        self.problem.kernels.inadmissible(&u)
    }
}
