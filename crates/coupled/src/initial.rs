//! The state at the start of a run.
//!
//! ```text
//! u = u_0 + sum_f g_f (1 - s_f)^(N_s - 1),   g_f = ( u_0(x_f + e) - u_0(x_f - e) ) / 2                            (initial)
//! ```
//!
//! The sum is over the faces f of a cell at which u_0 jumps between this cell and the next. x_f is the point of the face on the same line
//! of nodes. Along the line s_f grows from 0 at the face to 1 at the opposite face. The vector e is short and points out of the cell. Across a
//! periodic boundary x_f + e is in the cell there: formulas need not be periodic.
//!
//! So the state begins continuous and without overshoots: Newton's method hardly solves the first slabs of a jump. Between cells of equal
//! size the integral of u is that of u_0, because their g_f are opposite.

use fem::{Layout, SlabOperator, StateField};
use std::array::from_fn;

/// e, relative to the size of the cell.
const ASIDE: f64 = 1e-6;

/// The least change across a face that may be a jump, relative to the values.
const LEAST: f64 = 1e-3;

/// A smooth state changes along e / `CLOSER` by the same part of its change along e, a jump does not become smaller.
const CLOSER: f64 = 8.0;

/// The state (initial) at time `t` at the nodes of every cell, laid out at one time. The mesh is in the position last set at the bottom of
/// a slab, at first the reference position.
pub fn interpolate<const D: usize, const M: usize>(
    operator: &SlabOperator<D, M>,
    field: &dyn StateField<D, M>,
    t: f64,
) -> Vec<f64> {
    let (layout, orders) = (operator.layout.at_one_time(), operator.tables.orders);
    let nodes = basis::gauss_lobatto(orders.flow).points;
    let sampler = fem::Sampler::<D>::new(orders.flow, orders.mesh, &nodes);
    let (n, row) = (layout.nodes, operator.tables.bottom_row());
    let mut position = vec![0.0; operator.mesh.slot_len()];
    let (mut u, scales) = (vec![0.0; layout.len()], operator.problem.kernels.scales());
    for cell in 0..layout.cells {
        operator.mesh.positions(cell, row.row(0), &mut position);
        let x = sampler.positions(&position);
        let at = |i: usize| from_fn(|d| x[d * n + i]);
        let given = |x: &[f64; D]| field.value(x, t);
        let faces = (0..2 * D).filter(|face| operator.has_neighbour(cell, *face)).collect::<Vec<_>>();
        let period = |face: usize| operator.period_across(cell, face);
        let states = CellStart { nodes: &nodes, at: &at, period: &period, given: &given, scales }.states(&faces);
        put(&layout, cell, &states, &mut u);
    }
    u
}

/// Puts the states at the nodes of a cell into `u`.
fn put<const M: usize>(layout: &Layout, cell: usize, states: &[[f64; M]], u: &mut [f64]) {
    for (i, state) in states.iter().enumerate() {
        (0..M).for_each(|m| u[layout.index(cell, 0, m, i)] = state[m]);
    }
}

/// What (initial) needs of a cell.
struct CellStart<'a, const D: usize, const M: usize> {
    /// The nodes of a line in [-1, 1].
    nodes: &'a [f64],
    /// The position of a node.
    at: &'a dyn Fn(usize) -> [f64; D],
    /// How far the other side of a face is, by the period of the mesh.
    period: &'a dyn Fn(usize) -> [f64; D],
    /// The scales of the components.
    scales: [f64; M],
    /// u_0.
    given: &'a dyn Fn(&[f64; D]) -> [f64; M],
}

/// A node of a face at which u_0 jumps.
struct Jump<const M: usize> {
    node: usize,
    axis: usize,
    /// g_f of (initial).
    half: [f64; M],
}

impl<const D: usize, const M: usize> CellStart<'_, D, M> {
    /// (initial) at the nodes, with neighbours at these `faces`.
    fn states(&self, faces: &[usize]) -> Vec<[f64; M]> {
        let jumps: Vec<Jump<M>> = faces.iter().flat_map(|face| self.jumps(*face)).collect();
        let mut aside = vec![[0.0; D]; self.nodes.len().pow(D as u32)];
        for Jump { node, axis, .. } in &jumps {
            let e = self.inward(*node, *axis, ASIDE);
            (0..D).for_each(|d| aside[*node][d] += e[d]);
        }
        let mut states: Vec<[f64; M]> =
            aside.iter().enumerate().map(|(i, e)| (self.given)(&moved(&(self.at)(i), e, 1.0))).collect();
        for Jump { node, axis, half } in &jumps {
            for k in 0..self.nodes.len() {
                let (i, s) = (self.along(*node, *axis, k), 0.5 * (1.0 + self.nodes[k]));
                let factor = (1.0 - s).powi(self.nodes.len() as i32 - 1);
                (0..M).for_each(|m| states[i][m] += half[m] * factor);
            }
        }
        states
    }

    /// The nodes of `face` at which u_0 jumps.
    fn jumps(&self, face: usize) -> Vec<Jump<M>> {
        let ((axis, _), period) = (mesh::axis_and_side(face), (self.period)(face));
        let nodes = mesh::face_nodes(D, self.nodes.len(), face).into_iter();
        nodes.filter_map(|node| Some(Jump { node, axis, half: self.half_jump(node, axis, &period)? })).collect()
    }

    /// g_f at a node of a face normal to `axis`, if u_0 jumps there. The other side lies a `period` away.
    fn half_jump(&self, node: usize, axis: usize, period: &[f64; D]) -> Option<[f64; M]> {
        let x = (self.at)(node);
        let beside = |size: f64| {
            let e = self.inward(node, axis, size);
            [moved(&x, &e, 1.0), moved(&moved(&x, &e, -1.0), period, 1.0)].map(|x| (self.given)(&x))
        };
        let change = |[a, b]: &[[f64; M]; 2], m: usize| (a[m] - b[m]).abs();
        // A vortex that decays is not quite periodic.
        let is_periodic = period.iter().any(|d| *d != 0.0);
        let least = |m: usize| if is_periodic { self.scales[m] } else { 0.0 };
        let size = |pair: &[[f64; M]; 2], m: usize| (pair[0][m].abs() + pair[1][m].abs()).max(least(m));
        let changes = |pair: &[[f64; M]; 2], m: usize| change(pair, m) > LEAST * size(pair, m);
        let far = beside(ASIDE);
        // Nearly all states are smooth: then two values are enough.
        if !(0..M).any(|m| changes(&far, m)) {
            return None;
        }
        let (near, [inside, outside]) = (beside(ASIDE / CLOSER), far);
        let jumps = |m: usize| changes(&near, m) && change(&near, m) > 0.5 * change(&far, m);
        (0..M).any(jumps).then(|| from_fn(|m| 0.5 * (outside[m] - inside[m])))
    }

    /// - e at a node of a face normal to `axis`, with the `size` of e relative to the cell.
    fn inward(&self, node: usize, axis: usize, size: f64) -> [f64; D] {
        let last = self.nodes.len() - 1;
        let (here, opposite) = ((self.at)(node), (self.at)(self.along(node, axis, last)));
        from_fn(|d| size * (opposite[d] - here[d]))
    }

    /// The node `k` steps away from `node` on a face, along its line normal to the face.
    fn along(&self, node: usize, axis: usize, k: usize) -> usize {
        let (n, stride) = (self.nodes.len(), self.nodes.len().pow(axis as u32));
        let digit = node / stride % n;
        let there = if digit == 0 { k } else { n - 1 - k };
        node - digit * stride + there * stride
    }
}

/// x + sign e.
fn moved<const D: usize>(x: &[f64; D], e: &[f64; D], sign: f64) -> [f64; D] {
    from_fn(|d| x[d] + sign * e[d])
}
