//! A small curved mesh.

use super::contents::{Contents, Element, Encoding};

/// Two curved cells of degree 2, x in [0, 2], on a lattice of 5 x 3 nodes numbered from 1.
#[derive(Clone, Copy)]
pub(super) struct Sample {
    /// Whether the nodes of cells run clockwise.
    pub(super) left_handed: bool,
}

pub(super) fn two_cells() -> Sample {
    Sample { left_handed: false }
}

const GROUPS: &[(i32, i32, &str)] = &[(1, 1, "inflow"), (1, 2, "wall"), (1, 3, "outflow"), (2, 4, "fluid")];

impl Sample {
    /// y is raised by a parabola, the same over both cells.
    pub(super) fn position(&self, i: usize, j: usize) -> [f64; 2] {
        let bump = if i % 2 == 1 { 0.125 } else { 0.0 };
        [0.5 * i as f64, 0.5 * j as f64 + bump]
    }

    pub(super) fn area(&self) -> f64 {
        2.0
    }

    fn nodes(&self) -> Vec<[f64; 3]> {
        let place = |k: usize| self.position(k % 5, k / 5);
        (0..15).map(place).map(|[x, y]| [x, y, 0.0]).collect()
    }

    fn elements(&self) -> Vec<Element> {
        let node = |i: usize, j: usize| 1 + i + 5 * j;
        let line = |group, a, b, middle| (8, group, vec![a, b, middle]);
        let mut elements = vec![
            line(1, node(0, 0), node(0, 2), node(0, 1)),
            line(2, node(0, 0), node(2, 0), node(1, 0)),
            line(2, node(2, 0), node(4, 0), node(3, 0)),
            line(2, node(0, 2), node(2, 2), node(1, 2)),
            line(2, node(4, 2), node(2, 2), node(3, 2)),
            line(3, node(4, 0), node(4, 2), node(4, 1)),
        ];
        for i in [0, 2] {
            let at = |(a, b): (usize, usize)| node(i + a, b);
            let ring = [(0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1), (1, 1)];
            let clockwise = [(0, 0), (0, 2), (2, 2), (2, 0), (0, 1), (1, 2), (2, 1), (1, 0), (1, 1)];
            let order = if self.left_handed { clockwise } else { ring };
            elements.push((10, 4, order.map(at).to_vec()));
        }
        elements
    }

    fn contents(&self) -> Contents {
        Contents { groups: GROUPS, nodes: self.nodes(), elements: self.elements() }
    }

    pub(super) fn version2(&self, encoding: Encoding) -> Vec<u8> {
        self.contents().version2(encoding)
    }

    pub(super) fn version4(&self, encoding: Encoding) -> Vec<u8> {
        self.contents().version4(encoding)
    }
}
