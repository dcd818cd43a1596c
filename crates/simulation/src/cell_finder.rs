//! The cells of many points.

mod enclosure;

use crate::nodal::{by_component, by_node};
use crate::stored_field::StoredField;
use enclosure::{Enclosure, to_legendre};
use fem::parallel::{self, Grain};
use mesh::{locate_in_cell, nearest_in_cell};
use std::array::from_fn;

/// Finds the cells of points. An enclosure of each cell excludes nearly all cells, before any equation is solved.
pub struct CellFinder<const D: usize> {
    order: usize,
    /// Positions of the nodes of every cell, `[node][component]`.
    nodes: Vec<Vec<f64>>,
    enclosures: Vec<Enclosure<D>>,
}

/// A place in a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place<const D: usize> {
    /// The cell.
    pub cell: usize,
    /// The reference point.
    pub xi: [f64; D],
    /// The distance from the point that was looked for.
    pub distance: f64,
}

impl<const D: usize> CellFinder<D> {
    /// The cells with these positions.
    pub fn new(positions: &StoredField<D>) -> Self {
        let nodes = (0..positions.cells()).map(|cell| by_node::<D>(positions.of_cell(cell)));
        Self::of_nodes(positions.order(), nodes.collect())
    }

    /// The cells of order `order` with nodes at `nodes`: `[node][component]` for every cell.
    pub fn of_nodes(order: usize, nodes: Vec<Vec<f64>>) -> Self {
        let to_legendre = to_legendre(order);
        let enclosure = |nodes: &Vec<f64>| Enclosure::new(&to_legendre, &by_component::<D>(nodes));
        let enclosures = parallel::map(nodes.len(), Grain::Any, &|cell| enclosure(&nodes[cell]));
        CellFinder { order, nodes, enclosures }
    }

    /// The first cell that contains `x`, boundary included, and the reference point there; `None` outside of the mesh.
    pub fn find(&self, x: &[f64; D]) -> Option<(usize, [f64; D])> {
        self.near(x).find_map(|cell| Some((cell, locate_in_cell(self.order, &self.nodes[cell], x)?)))
    }

    /// The places of `points`, or the nearest ones. Each `group` of points is close together: the nodes of a cell.
    ///
    /// # Panics
    /// If there are no cells.
    pub fn places(&self, points: &[[f64; D]], group: usize) -> Vec<Place<D>> {
        let places = |points: &[[f64; D]]| {
            let bound = |pick: fn(f64, f64) -> f64, i: usize| points.iter().map(|x| x[i]).fold(points[0][i], pick);
            let [lower, upper] = [f64::min, f64::max].map(|pick| from_fn(|i| bound(pick, i)));
            let cells = self.around([&lower, &upper]);
            let place = |x| self.nearest(&cells, x).expect("a mesh has cells");
            points.iter().map(place).collect::<Vec<_>>()
        };
        let groups: Vec<&[[f64; D]]> = points.chunks(group).collect();
        parallel::map(groups.len(), Grain::Any, &|number| places(groups[number])).concat()
    }

    /// The cells that may contain points of the box from `lower` to `upper`, in ascending order.
    pub fn around(&self, [lower, upper]: [&[f64; D]; 2]) -> Vec<usize> {
        (0..self.enclosures.len()).filter(|&cell| self.enclosures[cell].meets(lower, upper)).collect()
    }

    /// The place of `x` in the first of these `cells` that contains it, otherwise the nearest place, see [`nearest_in_cell`]. `None` without cells.
    pub fn nearest(&self, cells: &[usize], x: &[f64; D]) -> Option<Place<D>> {
        let contains = |cell: &&usize| self.enclosures[**cell].contains(x);
        let inside = |&cell: &usize| Some((cell, locate_in_cell(self.order, &self.nodes[cell], x)?));
        match cells.iter().filter(contains).find_map(inside) {
            Some((cell, xi)) => Some(Place { cell, xi, distance: 0.0 }),
            None => self.nearest_outside(x),
        }
    }

    /// The nearest place to `x`, which is in no cell. Cells whose enclosures are further than a place that was found need no search.
    fn nearest_outside(&self, x: &[f64; D]) -> Option<Place<D>> {
        let mut cells: Vec<(f64, usize)> =
            self.enclosures.iter().map(|enclosure| enclosure.distance(x)).zip(0..).collect();
        cells.sort_by(|one, other| one.0.total_cmp(&other.0));
        let mut best: Option<Place<D>> = None;
        for (least, cell) in cells {
            if best.as_ref().is_some_and(|best| least > best.distance) {
                break;
            }
            let (xi, distance) = nearest_in_cell(self.order, &self.nodes[cell], x);
            if best.as_ref().is_none_or(|best| distance < best.distance) {
                best = Some(Place { cell, xi, distance });
            }
        }
        best
    }

    /// The size of a cell: the diagonal of the box around it.
    pub fn size(&self, cell: usize) -> f64 {
        self.enclosures[cell].diagonal()
    }

    /// The cells whose enclosure contains `x`.
    fn near(&self, x: &[f64; D]) -> impl Iterator<Item = usize> {
        self.enclosures.iter().enumerate().filter(|(_, enclosure)| enclosure.contains(x)).map(|(cell, _)| cell)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use mesh::{BoxMesh, CellMap, Curving, Mesh};
    use tensor::norm;

    fn curved<const D: usize>() -> (Mesh<D>, CellFinder<D>) {
        let curving = Curving::Wavy { amplitude: 0.05 };
        let mesh = BoxMesh { lower: [0.0; D], upper: [1.0; D], cells: [4; D], order: 5, curving, periodic: [false; D] };
        let mesh = mesh.build().unwrap();
        let nodes = |cell| by_component::<D>(mesh.cell_coordinates(cell));
        let positions = StoredField::new(D, (0..mesh.n_cells()).flat_map(nodes).collect(), mesh.n_cells()).unwrap();
        let finder = CellFinder::new(&positions);
        (mesh, finder)
    }

    /// A search among all cells finds the same, and the enclosures leave few cells: fewer than 2 D for each point of a strongly
    /// curved mesh.
    fn finds_what_the_mesh_finds<const D: usize>() {
        let (mesh, finder) = curved::<D>();
        let mut candidates = 0;
        for number in 0..200 {
            let x: [f64; D] = std::array::from_fn(|i| (0.37 + 0.618 * (number * (i + 1)) as f64).fract() * 1.1 - 0.05);
            assert_eq!(finder.find(&x), mesh.locate(&x), "{x:?}");
            candidates += finder.near(&x).count();
        }
        assert!(candidates < 200 * 2 * D, "{candidates} cells for 200 points");
    }

    #[test]
    fn points_are_in_the_first_cell_that_holds_them() {
        finds_what_the_mesh_finds::<2>();
        finds_what_the_mesh_finds::<3>();
    }

    /// A corner of the lattice of cells belongs to 2^D of them: the first counts.
    #[test]
    fn corners_of_cells_are_found() {
        let (mesh, finder) = curved::<2>();
        let corners = CellMap::<2>::on_grid(5, &[-1.0, 1.0]);
        for cell in 0..mesh.n_cells() {
            for x in corners.positions(mesh.cell_coordinates(cell)) {
                assert_eq!(finder.find(&x), mesh.locate(&x));
                assert!(finder.near(&x).any(|near| near == cell));
            }
        }
    }

    /// Lines looked at every cell whose box, enlarged by half, holds a point, and found the same.
    #[test]
    fn nodes_of_cells_give_the_same_finder() {
        let (mesh, finder) = curved::<3>();
        let nodes = (0..mesh.n_cells()).map(|cell| mesh.cell_coordinates(cell).to_vec()).collect();
        let of_nodes = CellFinder::<3>::of_nodes(mesh.order(), nodes);
        for number in 0..50 {
            let x = std::array::from_fn(|i| (0.37 + 0.618 * (number * (i + 1)) as f64).fract());
            assert_eq!(of_nodes.find(&x), finder.find(&x));
            assert!(of_nodes.near(&x).eq(finder.near(&x)));
        }
    }

    fn is_near_points_outside<const D: usize>() {
        let (mesh, finder) = curved::<D>();
        let nearest = |x: &[f64; D]| finder.nearest(&finder.around([x, x]), x).unwrap();
        for number in 0..10 {
            let mut inside: [f64; D] = from_fn(|i| 0.2 + 0.6 * (0.37 + 0.618 * (number * (i + 1)) as f64).fract());
            let Place { cell, xi, distance } = nearest(&inside);
            assert_eq!((Some((cell, xi)), distance), (finder.find(&inside), 0.0));
            // The wavy boundary reaches 1.05.
            inside[0] = 1.2;
            let Place { cell, xi, distance } = nearest(&inside);
            let from = |place: [f64; D]| norm(&from_fn::<f64, D, _>(|i| place[i] - inside[i]));
            assert!((from(mesh.position(cell, &xi)) - distance).abs() < 1e-14);
            let least = samples::<D>()
                .map(|xi| (0..mesh.n_cells()).map(|cell| from(mesh.position(cell, &xi))).fold(1.0, f64::min));
            let least = least.fold(1.0, f64::min);
            assert!(distance <= least, "{inside:?}: {distance} for {least}");
        }
    }

    /// Seven reference points along each axis.
    fn samples<const D: usize>() -> impl Iterator<Item = [f64; D]> {
        (0..7_usize.pow(D as u32)).map(|k| from_fn(|i| (k / 7_usize.pow(i as u32) % 7) as f64 / 3.0 - 1.0))
    }

    #[test]
    fn points_outside_take_the_nearest_place() {
        is_near_points_outside::<2>();
        is_near_points_outside::<3>();
    }

    /// The nearest node is on the other side of a slit: its cells were the only ones that were asked.
    #[test]
    fn points_in_a_slit_take_the_nearer_side() {
        let below = vec![0.0, -1.0, 1.0, -1.0, 0.0, 0.0, 1.0, 0.0];
        let above = [0.5, 1.5].map(|x| vec![x - 1.0, 0.01, x, 0.01, x - 1.0, 1.0, x, 1.0]);
        let [left, right] = above;
        let finder = CellFinder::<2>::of_nodes(2, vec![below, left, right]);
        let x = [0.5, 0.004];
        let place = finder.nearest(&finder.around([&x, &x]), &x).unwrap();
        assert!(place.cell == 0 && (place.distance - 0.004).abs() < 1e-12, "{place:?}");
    }
}
