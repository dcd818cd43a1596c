//! A small curved mesh, and writers of all layouts of the format.

use std::fmt::Write;

/// The format of a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Encoding {
    Text,
    LittleEndian,
    BigEndian,
}

impl Encoding {
    pub(super) const ALL: [Encoding; 3] = [Encoding::Text, Encoding::LittleEndian, Encoding::BigEndian];
}

/// Two curved cells of degree 2, x in [0, 2], on a lattice of 5 x 3 nodes numbered from 1.
#[derive(Clone, Copy)]
pub(super) struct Sample {
    /// Whether the nodes of cells run clockwise.
    pub(super) left_handed: bool,
}

pub(super) fn two_cells() -> Sample {
    Sample { left_handed: false }
}

/// Type, physical group, nodes.
type Element = (i32, i32, Vec<usize>);

const GROUPS: [(i32, i32, &str); 4] = [(1, 1, "inflow"), (1, 2, "wall"), (1, 3, "outflow"), (2, 4, "fluid")];

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

    pub(super) fn version2(&self, encoding: Encoding) -> Vec<u8> {
        let mut file = Writer::new("2.2", encoding);
        let (nodes, elements) = (self.nodes(), self.elements());
        file.text(&format!("$Nodes\n{}\n", nodes.len()));
        for (k, x) in nodes.iter().enumerate() {
            file.ints(&[k as i32 + 1]);
            file.reals(x);
        }
        file.text(&format!("\n$EndNodes\n$Elements\n{}\n", elements.len()));
        for (k, (kind, group, nodes)) in elements.iter().enumerate() {
            let number = k as i32 + 1;
            match encoding {
                Encoding::Text => file.ints(&[number, *kind, 2, *group, 1]),
                _ => file.ints(&[*kind, 1, 2, number, *group, 1]),
            }
            nodes.iter().for_each(|&node| file.ints(&[node as i32]));
            file.end_of_record();
        }
        file.text("\n$EndElements\n");
        file.bytes
    }

    pub(super) fn version4(&self, encoding: Encoding) -> Vec<u8> {
        let mut file = Writer::new("4.1", encoding);
        let (nodes, elements) = (self.nodes(), self.elements());
        file.text("$Entities\n");
        file.sizes(&[0, 3, 1, 0]);
        for (_, group, _) in GROUPS {
            file.ints(&[group]);
            file.reals(&[0.0; 6]);
            file.sizes(&[1]);
            file.ints(&[group]);
            file.sizes(&[0]);
        }
        file.text("\n$EndEntities\n$Nodes\n");
        file.sizes(&[1, 15, 1, 15]);
        file.ints(&[2, 4, 0]);
        file.sizes(&[15]);
        (1..=15).for_each(|k| file.sizes(&[k]));
        nodes.iter().for_each(|x| file.reals(x));
        file.text("\n$EndNodes\n$Elements\n");
        file.sizes(&[elements.len(), elements.len(), 1, elements.len()]);
        for (k, (kind, group, nodes)) in elements.iter().enumerate() {
            file.ints(&[if *kind == 8 { 1 } else { 2 }, *group, *kind]);
            file.sizes(&[1, k + 1]);
            file.sizes(nodes);
        }
        file.text("\n$EndElements\n");
        file.bytes
    }
}

struct Writer {
    encoding: Encoding,
    bytes: Vec<u8>,
}

impl Writer {
    /// Format and names.
    fn new(version: &str, encoding: Encoding) -> Self {
        let mut file = Writer { encoding, bytes: Vec::new() };
        let binary = i32::from(encoding != Encoding::Text);
        file.text(&format!("$MeshFormat\n{version} {binary} 8\n"));
        if binary == 1 {
            file.ints(&[1]);
        }
        let mut names = String::new();
        GROUPS.iter().for_each(|(dimension, group, name)| writeln!(names, "{dimension} {group} \"{name}\"").unwrap());
        file.text(&format!("\n$EndMeshFormat\n$PhysicalNames\n4\n{names}$EndPhysicalNames\n"));
        file
    }

    fn text(&mut self, text: &str) {
        self.bytes.extend_from_slice(text.as_bytes());
    }

    fn ints(&mut self, values: &[i32]) {
        values.iter().for_each(|x| self.number(x.to_string(), x.to_le_bytes(), x.to_be_bytes()));
    }

    fn sizes(&mut self, values: &[usize]) {
        values.iter().map(|&x| x as u64).for_each(|x| self.number(x.to_string(), x.to_le_bytes(), x.to_be_bytes()));
    }

    fn reals(&mut self, values: &[f64]) {
        values.iter().for_each(|x| self.number(x.to_string(), x.to_le_bytes(), x.to_be_bytes()));
    }

    fn number<const N: usize>(&mut self, text: String, little: [u8; N], big: [u8; N]) {
        match self.encoding {
            Encoding::Text => self.text(&format!("{text} ")),
            Encoding::LittleEndian => self.bytes.extend(little),
            Encoding::BigEndian => self.bytes.extend(big),
        }
    }

    fn end_of_record(&mut self) {
        if self.encoding == Encoding::Text {
            self.bytes.pop();
            self.text("\n");
        }
    }
}
