//! Writes the tree of a CGNS file as libcgns does.

use hdf5::types::FixedAscii;
use hdf5::{Group, H5Type};
use std::path::Path;

/// A file with one base.
pub(super) struct File {
    root: Group,
    _file: hdf5::File,
}

/// A node of the tree.
pub(super) struct Node(Group);

fn attributes(group: &Group, name: &str, label: &str, kind: &str) {
    for (key, value) in [("name", name), ("label", label), ("type", kind)] {
        let value: FixedAscii<33> = FixedAscii::from_ascii(value).unwrap();
        group.new_attr::<FixedAscii<33>>().create(key).unwrap().write_scalar(&value).unwrap();
    }
}

impl File {
    pub(super) fn create(path: &Path) -> File {
        let file = hdf5::File::create(path).unwrap();
        let root = file.group("/").unwrap();
        attributes(&root, "HDF5 MotherNode", "Root Node of HDF5 File", "MT");
        File { root, _file: file }
    }

    /// A base with cells of dimension `cells`, after the version.
    pub(super) fn base(&self, cells: i32, space: i32) -> Node {
        let root = Node(self.root.clone());
        root.array("CGNSLibraryVersion", "CGNSLibraryVersion_t", "R4", &[4.3_f32]);
        root.array("Base", "CGNSBase_t", "I4", &[cells, space])
    }
}

impl Node {
    /// A child without data.
    pub(super) fn node(&self, name: &str, label: &str) -> Node {
        self.with_type(name, label, "MT")
    }

    pub(super) fn with_type(&self, name: &str, label: &str, kind: &str) -> Node {
        let group = self.0.create_group(name).unwrap();
        attributes(&group, name, label, kind);
        Node(group)
    }

    pub(super) fn array<T: H5Type>(&self, name: &str, label: &str, kind: &str, values: &[T]) -> Node {
        let node = self.with_type(name, label, kind);
        node.0.new_dataset_builder().with_data(values).create(" data").unwrap();
        node
    }

    /// A group and a data set that are no nodes of CGNS.
    pub(super) fn foreign(&self, name: &str) {
        self.0.create_group(name).unwrap();
        self.0.new_dataset_builder().with_data(&[1.0]).create("values").unwrap();
    }

    pub(super) fn integers(&self, name: &str, label: &str, values: &[i64]) -> Node {
        self.array(name, label, "I8", values)
    }

    pub(super) fn text(&self, name: &str, label: &str, text: &str) -> Node {
        let bytes: Vec<i8> = text.bytes().map(|byte| byte as i8).collect();
        self.array(name, label, "C1", &bytes)
    }

    /// A zone with its coordinates, as many as `dimension`.
    pub(super) fn zone<const D: usize>(&self, name: &str, kind: &str, sizes: &[i64], positions: &[[f64; D]]) -> Node {
        let zone = self.integers(name, "Zone_t", sizes);
        zone.text("ZoneType", "ZoneType_t", kind);
        let grid = zone.node("GridCoordinates", "GridCoordinates_t");
        for (axis, name) in ["CoordinateX", "CoordinateY", "CoordinateZ"].into_iter().enumerate().take(D) {
            let values: Vec<f64> = positions.iter().map(|position| position[axis]).collect();
            grid.array(name, "DataArray_t", "R8", &values);
        }
        zone
    }

    /// A zone of sections with `cells` cells.
    pub(super) fn unstructured<const D: usize>(&self, name: &str, cells: i64, positions: &[[f64; D]]) -> Node {
        self.zone(name, "Unstructured", &[positions.len() as i64, cells, 0], positions)
    }

    /// A section of `count` elements, the first one with the number `first`.
    pub(super) fn section(&self, name: &str, code: i64, first: i64, count: i64, nodes: &[i64]) -> Node {
        let section = self.array(name, "Elements_t", "I4", &[code as i32, 0]);
        section.integers("ElementRange", "IndexRange_t", &[first, first + count - 1]);
        section.integers("ElementConnectivity", "DataArray_t", nodes);
        section
    }

    /// A boundary condition with the numbers `values` in its child `points`.
    pub(super) fn condition(&self, name: &str, points: &str, values: &[i64], location: Option<&str>) -> Node {
        let condition = self.text(name, "BC_t", "FamilySpecified");
        let label = if points.ends_with("List") { "IndexArray_t" } else { "IndexRange_t" };
        condition.integers(points, label, values);
        if let Some(location) = location {
            condition.text("GridLocation", "GridLocation_t", location);
        }
        condition
    }
}
