//! Stages: cells that all blocks eliminate at the same time.
//!
//! The order of elimination of the whole mesh goes from block to block and back. The depth of a cell is the largest number of cuts on a way
//! to it that the order follows. With a stage for every depth, blocks wait for each other and keep the order exactly. With fewer, depths
//! are joined into groups. In a group the cells at cuts come after the others, in colours: neighbours in different blocks have different
//! ones. So all blocks work at the same time on most of their cells.

use super::graph::Graph;
use std::collections::BTreeSet;

/// The stage of every cell for an elimination in `order`, in at most so many `groups` of depths. Neighbours in different blocks have different
/// stages. One block has one stage.
pub fn stages(graph: &Graph, order: &[usize], groups: usize) -> Vec<usize> {
    let mut position = vec![0; order.len()];
    order.iter().enumerate().for_each(|(place, &cell)| position[cell] = place);
    let depths = depths(graph, order, &position);
    let deepest = depths.iter().max().map_or(0, |depth| depth + 1);
    let groups = groups.min(deepest);
    let group: Vec<usize> = depths.iter().map(|depth| depth * groups / deepest).collect();
    let within = within_groups(graph, order, &position, &group);
    let places: Vec<(usize, usize)> = group.into_iter().zip(within).collect();
    let used: Vec<(usize, usize)> = places.iter().copied().collect::<BTreeSet<_>>().into_iter().collect();
    places.iter().map(|place| used.partition_point(|other| other < place)).collect()
}

/// For every cell the largest number of cuts on a way to it along earlier neighbours.
fn depths(graph: &Graph, order: &[usize], position: &[usize]) -> Vec<usize> {
    let mut depths = vec![0; order.len()];
    for &cell in order {
        let earlier = graph.edges[cell].iter().filter(|edge| position[edge.cell] < position[cell]);
        let depth = earlier.map(|edge| depths[edge.cell] + usize::from(graph.is_cut(cell, edge))).max();
        depths[cell] = depth.unwrap_or(0);
    }
    depths
}

/// The stage of every cell in its group: 0 for a cell whose neighbours in the group lie in its block. A cell at a cut takes the first stage
/// that no earlier neighbour in another block has.
fn within_groups(graph: &Graph, order: &[usize], position: &[usize], group: &[usize]) -> Vec<usize> {
    let mut stages = vec![0; order.len()];
    for &cell in order {
        let is_earlier = |other: usize| position[other] < position[cell] && group[other] == group[cell];
        let across = graph.edges[cell].iter().filter(|edge| is_earlier(edge.cell) && graph.is_cut(cell, edge));
        let taken: Vec<usize> = across.map(|edge| stages[edge.cell]).collect();
        stages[cell] = (0..).find(|stage| !taken.contains(stage)).unwrap_or(0);
    }
    stages
}

#[cfg(test)]
mod tests {
    use super::super::graph::Edge;
    use super::super::minimum_discarded_fill::eliminate;
    use super::*;

    /// A lattice of cells in square blocks, whose couplings are stronger in one direction and to the right.
    fn lattice(size: usize, block: usize) -> Graph {
        let number = |x: usize, y: usize| y * size + x;
        let mut graph = Graph { edges: vec![Vec::new(); size * size], blocks: vec![0; size * size] };
        for y in 0..size {
            for x in 0..size {
                graph.blocks[number(x, y)] = y / block * size + x / block;
                let strength = 1.0 + ((7 * x + 3 * y) % 5) as f64;
                let mut join = |cell: usize, other: usize, face: usize, strength: f64| {
                    let edge = Edge { cell: other, face, other_face: face ^ 1, strength };
                    graph.edges[cell].push(edge);
                };
                if x + 1 < size {
                    join(number(x, y), number(x + 1, y), 1, strength);
                    join(number(x + 1, y), number(x, y), 0, 0.3);
                }
                if y + 1 < size {
                    join(number(x, y), number(x, y + 1), 3, 0.1 * strength);
                    join(number(x, y + 1), number(x, y), 2, 0.2);
                }
            }
        }
        graph
    }

    /// Neighbours whose order is not that of the elimination, when stages come one after the other.
    fn turned(graph: &Graph, order: &[usize], stages: &[usize]) -> usize {
        let mut position = vec![0; order.len()];
        order.iter().enumerate().for_each(|(place, &cell)| position[cell] = place);
        let place = |cell: usize| (stages[cell], position[cell]);
        let turned = |cell: usize, other: usize| position[other] < position[cell] && place(other) > place(cell);
        let pairs = (0..order.len()).flat_map(|cell| graph.edges[cell].iter().map(move |edge| (cell, edge.cell)));
        pairs.filter(|&(cell, other)| turned(cell, other)).count()
    }

    #[test]
    fn neighbours_across_cuts_have_different_stages() {
        let graph = lattice(12, 3);
        let order = eliminate(&graph);
        for groups in [1, 2, 3, 8, usize::MAX] {
            let stages = stages(&graph, &order, groups);
            for (cell, edges) in graph.edges.iter().enumerate() {
                let cut = edges.iter().filter(|edge| graph.is_cut(cell, edge));
                cut.for_each(|edge| assert_ne!(stages[cell], stages[edge.cell], "{groups} groups"));
            }
            // Every stage has cells.
            let used: BTreeSet<usize> = stages.iter().copied().collect();
            assert!(used.into_iter().eq(0..=stages.iter().copied().max().unwrap_or(0)));
        }
    }

    /// Blocks wait for each other only while they eliminate the cells of later stages, which lie at cuts.
    #[test]
    fn all_blocks_begin_with_the_cells_inside_of_them() {
        let graph = lattice(12, 4);
        let stages = stages(&graph, &eliminate(&graph), 1);
        let inside = |cell: usize| graph.edges[cell].iter().all(|edge| !graph.is_cut(cell, edge));
        assert!((0..144).filter(|&cell| inside(cell)).all(|cell| stages[cell] == 0));
        let later = stages.iter().filter(|&&stage| stage > 0).count();
        assert!(later < 144 / 3, "{later} cells in later stages");
    }

    #[test]
    fn more_groups_keep_more_of_the_order_and_the_exact_order_keeps_all() {
        let graph = lattice(12, 3);
        let order = eliminate(&graph);
        let turned = |groups: usize| turned(&graph, &order, &stages(&graph, &order, groups));
        assert!(turned(1) > turned(4), "{} {}", turned(1), turned(4));
        assert_eq!(turned(usize::MAX), 0);
    }

    #[test]
    fn one_block_is_one_stage() {
        let graph = lattice(6, 6);
        let order = eliminate(&graph);
        assert_eq!(stages(&graph, &order, usize::MAX), [0; 36]);
        assert_eq!(stages(&graph, &order, 1), [0; 36]);
    }
}
