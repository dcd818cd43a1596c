//! The Q criterion without jumps between cells.
//!
//! The velocity gradient jumps between cells, and an iso-surface of its Q would have gaps there. At nodes of the flow that several cells share
//! Q takes the mean of their values. Inside a cell it is the polynomial through its nodes.

use super::cuboid::in_space;
use super::places::Places;
use crate::pictures::snapshot::Snapshot;
use rayon::prelude::*;
use std::collections::HashMap;

/// Q at the nodes of cells of the flow.
pub struct ContinuousQ {
    /// By cell; cells without a flow are left out.
    nodal: HashMap<usize, Vec<f64>>,
}

impl ContinuousQ {
    /// Q of some `cells` in a domain of this length. M = D + 2.
    pub fn new<const D: usize, const M: usize>(snapshot: &Snapshot<D>, cells: &[usize], length: f64) -> Self {
        let places = Places::new(length);
        let of_cell = |&cell: &usize| -> Option<(usize, Vec<[f64; 3]>, Vec<f64>)> {
            let q = snapshot.q_at_nodes::<M>(cell)?;
            Some((cell, snapshot.flow_nodes(cell).iter().map(in_space).collect(), q))
        };
        let found: Vec<_> = cells.par_iter().filter_map(of_cell).collect();
        // In the order of the cells, so that sums have the same bits for any number of threads.
        let numbers = found.iter().flat_map(|(_, points, q)| points.iter().zip(q));
        let sums = places.sums(numbers.map(|(point, q)| (point, [*q, 1.0])));
        let mean = |point: &[f64; 3]| sums.get(&places.of(point)).map_or(f64::NAN, |[sum, count]| sum / count);
        let nodal = found.iter().map(|(cell, points, _)| (*cell, points.iter().map(mean).collect())).collect();
        ContinuousQ { nodal }
    }

    /// Q at the points of a cell cut into parts; `None` for a cell without a flow.
    pub fn at<const D: usize>(&self, snapshot: &Snapshot<D>, cell: usize, fineness: usize) -> Option<Vec<f64>> {
        self.nodal.get(&cell).map(|nodal| snapshot.interpolated(nodal, fineness))
    }
}
