//! The Q criterion without jumps between cells.
//!
//! The velocity gradient jumps between cells, and an iso-surface of its Q would have gaps there. At nodes of the flow that several cells share
//! Q takes the mean of their values. Inside a cell it is the polynomial through its nodes.

use super::super::bounds::in_space;
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
        let of_cell = |&cell: &usize| -> Option<(usize, NodalNumbers)> {
            let q = snapshot.q_at_nodes::<M>(cell)?;
            Some((cell, (snapshot.flow_nodes(cell).iter().map(in_space).collect(), q)))
        };
        let (cells, found): (Vec<usize>, Vec<NodalNumbers>) = cells.par_iter().filter_map(of_cell).unzip();
        ContinuousQ { nodal: cells.into_iter().zip(common(&found, Places::new(length))).collect() }
    }

    /// Q at the points of a cell cut into parts; `None` for a cell without a flow.
    pub fn at<const D: usize>(&self, snapshot: &Snapshot<D>, cell: usize, fineness: usize) -> Option<Vec<f64>> {
        self.nodal.get(&cell).map(|nodal| snapshot.interpolated(nodal, fineness))
    }
}

/// The nodes of a cell and a number at each.
type NodalNumbers = (Vec<[f64; 3]>, Vec<f64>);

/// The numbers of all cells, with the mean of all cells where they share a node.
fn common(cells: &[NodalNumbers], places: Places) -> Vec<Vec<f64>> {
    // In the order of the cells, so that sums have the same bits for any number of threads.
    let numbers = cells.iter().flat_map(|(points, numbers)| points.iter().zip(numbers));
    let sums = places.sums(numbers.map(|(point, number)| (point, [*number, 1.0])));
    let mean = |point: &[f64; 3]| sums.get(&places.of(point)).map_or(f64::NAN, |[sum, count]| sum / count);
    cells.iter().map(|(points, _)| points.iter().map(mean).collect()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_have_one_number_at_the_nodes_they_share() {
        let left = (vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]], vec![5.0, 1.0, 2.0]);
        let right = (vec![[1.0, 1.0, 1e-17], [1.0 + 1e-15, 0.0, 0.0], [2.0, 0.0, 0.0]], vec![4.0, 3.0, 7.0]);
        let common = common(&[left, right], Places::new(2.0));
        assert_eq!(common, [vec![5.0, 2.0, 3.0], vec![3.0, 2.0, 7.0]]);
    }
}
