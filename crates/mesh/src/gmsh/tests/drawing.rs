//! Meshes of any shapes: straight elements given by their corners, then curved by a polynomial.

use super::contents::Contents;
use crate::gmsh::element::Kind;
use crate::gmsh::shape::Shape;
use crate::random::SplitMix64;
use std::collections::BTreeMap;

/// The boundaries and regions of a plane drawing.
const PLANE: &[(i32, i32, &str)] = &[(1, 1, "left"), (1, 2, "right"), (1, 3, "other"), (2, 4, "near"), (2, 5, "far")];
/// The same in space.
const SPACE: &[(i32, i32, &str)] = &[(2, 1, "left"), (2, 2, "right"), (2, 3, "other"), (3, 4, "near"), (3, 5, "far")];

type Position = [f64; 3];

/// Cells with straight edges. The region "near" has the cells with a centre at x < 1/2, "far" the others. Sides at
/// x = 0 are the boundary "left", at x = 1 "right", the rest "other".
#[derive(Clone)]
pub(super) struct Drawing {
    pub(super) dimension: usize,
    pub(super) corners: Vec<Position>,
    pub(super) cells: Vec<(Shape, Vec<usize>)>,
}

impl Drawing {
    /// The file of degree `degree` with all nodes moved by `map`.
    pub(super) fn file(&self, degree: usize, map: impl Fn(Position) -> Position) -> Contents {
        let (mut nodes, mut numbers) = (Vec::new(), BTreeMap::new());
        let mut number = |x: Position| {
            // Nodes at the same place are the same node.
            *numbers.entry(x.map(|x| (x * 1e9).round() as i64)).or_insert_with(|| {
                nodes.push(map(x));
                nodes.len()
            })
        };
        let elements = self.sides().into_iter().chain(self.cells_with_groups()).map(|(shape, group, corners)| {
            let kind = Kind { shape, degree };
            let corners: Vec<Position> = corners.iter().map(|&corner| self.corners[corner]).collect();
            let places = kind.nodes().into_iter().map(|node| place(kind, node, &corners));
            (kind.code() as i32, group, places.map(&mut number).collect())
        });
        let elements = elements.collect();
        Contents { groups: if self.dimension == 2 { PLANE } else { SPACE }, nodes, elements }
    }

    fn centre(&self, corners: &[usize]) -> Position {
        std::array::from_fn(|i| corners.iter().map(|&c| self.corners[c][i]).sum::<f64>() / corners.len() as f64)
    }

    fn cells_with_groups(&self) -> Vec<(Shape, i32, Vec<usize>)> {
        let group = |corners: &Vec<usize>| if self.centre(corners)[0] < 0.5 { 4 } else { 5 };
        self.cells.iter().map(|(shape, corners)| (*shape, group(corners), corners.clone())).collect()
    }

    /// The sides of cells without a neighbour, with their groups.
    fn sides(&self) -> Vec<(Shape, i32, Vec<usize>)> {
        let all: Vec<_> = self.cells.iter().flat_map(|(shape, corners)| sides(*shape, corners)).collect();
        let key = |corners: &Vec<usize>| {
            let mut key = corners.clone();
            key.sort_unstable();
            key
        };
        let mut count = BTreeMap::new();
        all.iter().for_each(|(_, corners)| *count.entry(key(corners)).or_insert(0) += 1);
        let at = |corners: &[usize], x: f64| corners.iter().all(|&c| self.corners[c][0] == x);
        let group = |corners: &[usize]| [at(corners, 0.0), at(corners, 1.0), true].iter().position(|&is| is).unwrap();
        let outer = all.into_iter().filter(|(_, corners)| count[&key(corners)] == 1);
        outer.map(|(shape, corners)| (shape, 1 + group(&corners) as i32, corners)).collect()
    }

    /// Every corner inside of the unit square or cube moved at random, and the corners of triangles and tetrahedra
    /// listed in random order.
    pub(super) fn shaken(mut self, seed: u64) -> Self {
        let (mut random, dimension) = (SplitMix64::new(seed), self.dimension);
        for x in &mut self.corners {
            if x[..dimension].iter().all(|x| 0.0 < *x && *x < 1.0) {
                (0..dimension).for_each(|i| x[i] += 0.06 * random.symmetric());
            }
        }
        for (_, corners) in self.cells.iter_mut().filter(|(shape, _)| shape.factors() == [dimension]) {
            (1..corners.len()).for_each(|k| corners.swap(k, random.below(k + 1)));
        }
        self
    }
}

/// The position of a node in an element with straight edges.
fn place(kind: Kind, node: [usize; 3], corners: &[Position]) -> Position {
    let x = node.map(|k| k as f64 / kind.degree as f64);
    let weight = |corner: &[usize; 3]| {
        let mut axis = 0;
        let of_simplex = |&d: &usize| {
            let axes = axis..axis + d;
            axis += d;
            let rest = 1.0 - axes.clone().map(|a| x[a]).sum::<f64>();
            axes.clone().find(|&a| corner[a] == 1).map_or(rest, |a| x[a])
        };
        kind.shape.factors().iter().map(of_simplex).product::<f64>()
    };
    let weights: Vec<f64> = kind.shape.corners().iter().map(weight).collect();
    std::array::from_fn(|i| weights.iter().zip(corners).map(|(weight, x)| weight * x[i]).sum())
}

/// The sides of a cell: their shapes and corners.
fn sides(shape: Shape, corners: &[usize]) -> Vec<(Shape, Vec<usize>)> {
    if shape.dimension() == 2 {
        return shape.edges().iter().map(|edge| (Shape::Line, edge.map(|k| corners[k]).to_vec())).collect();
    }
    let places = shape.corners();
    let opposite = |[o, f, s]: [usize; 3]| {
        let place = std::array::from_fn(|a| places[f][a] + places[s][a] - places[o][a]);
        places.iter().position(|known| *known == place).unwrap()
    };
    let side = |&(side, [o, f, s]): &(Shape, [usize; 3])| {
        let of_side = if side == Shape::Triangle { vec![o, f, s] } else { vec![o, f, opposite([o, f, s]), s] };
        (side, of_side.into_iter().map(|k| corners[k]).collect())
    };
    shape.faces().iter().map(side).collect()
}

/// The unit square as n x n squares; those for which `cut` holds are two triangles.
pub(super) fn square(n: usize, cut: impl Fn(usize, usize) -> bool) -> Drawing {
    let at = |i: usize, j: usize| i + (n + 1) * j;
    let corners = (0..(n + 1) * (n + 1)).map(|k| [(k % (n + 1)) as f64, (k / (n + 1)) as f64, 0.0]);
    let corners = corners.map(|x| x.map(|x| x / n as f64)).collect();
    let mut cells = Vec::new();
    for (i, j) in (0..n * n).map(|k| (k % n, k / n)) {
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        match (cut(i, j), (i + j) % 2) {
            (false, _) => cells.push((Shape::Quadrilateral, vec![a, b, c, d])),
            (true, 0) => cells.extend([(Shape::Triangle, vec![a, b, c]), (Shape::Triangle, vec![a, c, d])]),
            (true, _) => cells.extend([(Shape::Triangle, vec![a, b, d]), (Shape::Triangle, vec![b, c, d])]),
        }
    }
    Drawing { dimension: 2, corners, cells }
}

/// The same with `layers` layers along z: prisms and hexahedra.
pub(super) fn extruded(plane: &Drawing, layers: usize) -> Drawing {
    let per_layer = plane.corners.len();
    let layer = |k: usize| plane.corners.iter().map(move |x| [x[0], x[1], k as f64 / layers as f64]);
    let cell = |(shape, corners): &(Shape, Vec<usize>), k: usize| {
        let shape = if *shape == Shape::Triangle { Shape::Prism } else { Shape::Hexahedron };
        let at = |k: usize| corners.iter().map(move |corner| corner + k * per_layer);
        (shape, at(k).chain(at(k + 1)).collect())
    };
    let cells = (0..layers).flat_map(|k| plane.cells.iter().map(move |of_plane| cell(of_plane, k))).collect();
    Drawing { dimension: 3, corners: (0..=layers).flat_map(layer).collect(), cells }
}

/// The unit cube as n^3 cubes of six tetrahedra each: the orders in which a path from corner to corner takes the axes.
pub(super) fn tetrahedra(n: usize) -> Drawing {
    let boxes = extruded(&square(n, |_, _| false), n);
    let mut cells = Vec::new();
    for (_, corners) in &boxes.cells {
        let corner = |[x, y, z]: [usize; 3]| corners[[0, 1, 3, 2][x + 2 * y] + 4 * z];
        for path in [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]] {
            let reached = |steps: usize| corner(std::array::from_fn(|a| usize::from(path[..steps].contains(&a))));
            cells.push((Shape::Tetrahedron, (0..4).map(reached).collect()));
        }
    }
    Drawing { dimension: 3, corners: boxes.corners, cells }
}

/// A hexahedron between prisms whose triangles lie in z = constant and in y = constant, and tetrahedra on the former.
pub(super) fn all_shapes() -> Drawing {
    let corners = [
        [0, 0, 0],
        [1, 0, 0],
        [1, 1, 0],
        [0, 1, 0],
        [0, 0, 1],
        [1, 0, 1],
        [1, 1, 1],
        [0, 1, 1],
        [2, 0, 0],
        [2, 1, 0],
        [2, 0, 1],
        [2, 1, 1],
        [3, 0, 0],
        [3, 1, 0],
    ];
    let mut corners: Vec<Position> = corners.iter().map(|x| x.map(f64::from)).collect();
    corners.push([0.4, 0.5, 1.8]);
    let cells = vec![
        (Shape::Prism, vec![0, 1, 2, 4, 5, 6]),
        (Shape::Prism, vec![0, 2, 3, 4, 6, 7]),
        (Shape::Tetrahedron, vec![4, 5, 6, 14]),
        (Shape::Tetrahedron, vec![7, 14, 4, 6]),
        (Shape::Hexahedron, vec![1, 8, 9, 2, 5, 10, 11, 6]),
        (Shape::Prism, vec![8, 12, 10, 9, 13, 11]),
    ];
    Drawing { dimension: 3, corners, cells }
}
