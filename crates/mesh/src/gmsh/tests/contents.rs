//! The contents of a file, and writers of all layouts of the format.

use crate::gmsh::element::Kind;
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

/// Type, physical group, nodes.
pub(super) type Element = (i32, i32, Vec<usize>);

/// Groups (dimension, number and name, by increasing dimension), nodes numbered from 1, elements.
pub(super) struct Contents {
    pub(super) groups: &'static [(i32, i32, &'static str)],
    pub(super) nodes: Vec<[f64; 3]>,
    pub(super) elements: Vec<Element>,
}

impl Contents {
    pub(super) fn version2(&self, encoding: Encoding) -> Vec<u8> {
        let mut file = self.beginning("2.2", encoding);
        let (nodes, elements) = (&self.nodes, &self.elements);
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
        let mut file = self.beginning("4.1", encoding);
        let (nodes, elements) = (&self.nodes, &self.elements);
        file.text("$Entities\n");
        let count = |dimension: i32| self.groups.iter().filter(|group| group.0 == dimension).count();
        file.sizes(&[0, count(1), count(2), count(3)]);
        for (_, group, _) in self.groups {
            file.ints(&[*group]);
            file.reals(&[0.0; 6]);
            file.sizes(&[1]);
            file.ints(&[*group]);
            file.sizes(&[0]);
        }
        file.text("\n$EndEntities\n$Nodes\n");
        let count = nodes.len();
        file.sizes(&[1, count, 1, count]);
        let (dimension, group, _) = self.groups[self.groups.len() - 1];
        file.ints(&[dimension, group, 0]);
        file.sizes(&[count]);
        (1..=count).for_each(|k| file.sizes(&[k]));
        nodes.iter().for_each(|x| file.reals(x));
        file.text("\n$EndNodes\n$Elements\n");
        file.sizes(&[elements.len(), elements.len(), 1, elements.len()]);
        for (k, (kind, group, nodes)) in elements.iter().enumerate() {
            let dimension = Kind::from_code((*kind).into()).unwrap().dimension() as i32;
            file.ints(&[dimension, *group, *kind]);
            file.sizes(&[1, k + 1]);
            file.sizes(nodes);
        }
        file.text("\n$EndElements\n");
        file.bytes
    }

    /// Format and names.
    fn beginning(&self, version: &str, encoding: Encoding) -> Writer {
        let mut file = Writer { encoding, bytes: Vec::new() };
        let binary = i32::from(encoding != Encoding::Text);
        file.text(&format!("$MeshFormat\n{version} {binary} 8\n"));
        if binary == 1 {
            file.ints(&[1]);
        }
        let mut names = format!("{}\n", self.groups.len());
        self.groups
            .iter()
            .for_each(|(dimension, group, name)| writeln!(names, "{dimension} {group} \"{name}\"").unwrap());
        file.text(&format!("\n$EndMeshFormat\n$PhysicalNames\n{names}$EndPhysicalNames\n"));
        file
    }
}

struct Writer {
    encoding: Encoding,
    bytes: Vec<u8>,
}

impl Writer {
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
