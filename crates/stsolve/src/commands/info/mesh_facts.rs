//! Facts about the mesh of a file, as tables and as JSON.

use crate::commands::quality::least_orthogonal;
use crate::commands::table::Table;
use mesh::Mesh;
use serde_json::{Map, Value, json};
use std::path::Path;

/// Names, and the number of facets or cells that each has.
type Counts = Vec<(String, usize)>;

/// Facts about a valid mesh.
pub(super) struct MeshFacts {
    file: String,
    dimension: usize,
    cells: usize,
    order: usize,
    volume: f64,
    /// The cell with the largest aspect ratio, and that ratio.
    aspect_ratio: (usize, f64),
    scaled_jacobian: f64,
    /// The least orthogonal cell, and its orthogonality.
    orthogonality: (usize, f64),
    boundaries: Counts,
    regions: Counts,
    /// Boundaries between regions.
    interfaces: Counts,
    /// Boundaries that are translates of each other, and the translation.
    translated: Vec<([String; 2], Vec<f64>)>,
}

impl MeshFacts {
    /// The facts about the mesh of the file at `path`.
    pub(super) fn new<const D: usize>(path: &Path, mesh: &Mesh<D>) -> Self {
        MeshFacts {
            file: path.display().to_string(),
            dimension: D,
            cells: mesh.n_cells(),
            order: mesh.order(),
            volume: mesh.volume(),
            aspect_ratio: largest((0..mesh.n_cells()).map(|cell| mesh.aspect_ratio(cell))),
            scaled_jacobian: mesh.smallest_scaled_jacobian().1,
            orthogonality: least_orthogonal(mesh),
            boundaries: boundaries(mesh),
            regions: mesh.regions().iter().map(|region| (region.name.clone(), region.cells.len())).collect(),
            interfaces: mesh.interfaces().iter().map(|(name, sides)| (name.clone(), sides.len())).collect(),
            translated: translated(mesh),
        }
    }

    /// The tables that have rows.
    pub(super) fn tables(&self) -> Vec<Table> {
        let mut tables = vec![self.shape(), counts("boundaries", &[(&self.boundaries, "facets")])];
        let parts = [(&self.regions, "cells"), (&self.interfaces, "facets")];
        tables.push(counts("regions, and boundaries between them", &parts));
        tables.push(self.periodic());
        tables.into_iter().filter(|table| !table.is_empty()).collect()
    }

    fn shape(&self) -> Table {
        let (cell, aspect_ratio) = self.aspect_ratio;
        let mut shape = Table::new(&self.file);
        shape
            .row("dimension", self.dimension, "")
            .row("cells", self.cells, "")
            .row("order", self.order, "nodes per direction")
            .row("volume", self.volume, "")
            .row("largest aspect ratio", aspect_ratio, "")
            .row("  in cell", cell, "")
            .row("smallest scaled Jacobian", self.scaled_jacobian, "sampled")
            .row("smallest orthogonality", self.orthogonality.1, "1 is rectangular, 0 flat")
            .row("  in cell", self.orthogonality.0, "")
            // Every mesh that was read is valid.
            .row("valid", "yes", "det J > 0 is proved in every cell");
        shape
    }

    fn periodic(&self) -> Table {
        let mut periodic = Table::new("boundaries that are translates of each other and could be periodic");
        for ([minus, plus], translation) in &self.translated {
            periodic.row(&format!("{minus}, {plus}"), translation.clone(), "apart");
        }
        periodic
    }

    /// The same facts for programs. Lists without entries are there too.
    pub(super) fn json(&self) -> Map<String, Value> {
        let (cell, aspect_ratio) = self.aspect_ratio;
        let mesh = json!({
            "dimension": self.dimension, "cells": self.cells, "order": self.order, "volume": self.volume,
            "largest aspect ratio": aspect_ratio, "cell with the largest aspect ratio": cell,
            "smallest scaled Jacobian": self.scaled_jacobian, "smallest orthogonality": self.orthogonality.1,
            "least orthogonal cell": self.orthogonality.0, "valid": true,
        });
        let pair =
            |(names, translation): &([String; 2], Vec<f64>)| json!({ "boundaries": names, "translation": translation });
        let translated: Vec<Value> = self.translated.iter().map(pair).collect();
        let entries = [
            ("file", self.file.clone().into()),
            ("mesh", mesh),
            ("boundaries", object(&self.boundaries)),
            ("regions", object(&self.regions)),
            ("interfaces", object(&self.interfaces)),
            ("translated boundaries", translated.into()),
        ];
        entries.into_iter().map(|(key, value)| (key.to_owned(), value)).collect()
    }
}

fn boundaries<const D: usize>(mesh: &Mesh<D>) -> Counts {
    let mut counts: Counts = mesh.boundary_names().iter().map(|name| (name.clone(), 0)).collect();
    mesh.boundary_facets().iter().for_each(|facet| counts[facet.boundary].1 += 1);
    counts
}

fn translated<const D: usize>(mesh: &Mesh<D>) -> Vec<([String; 2], Vec<f64>)> {
    let name = |boundary: usize| mesh.boundary_names()[boundary].clone();
    let pairs = mesh.translated_boundaries();
    pairs.iter().map(|pair| ([name(pair.minus), name(pair.plus)], pair.translation.to_vec())).collect()
}

/// A table of counts, each list with its unit.
fn counts(title: &str, lists: &[(&Counts, &str)]) -> Table {
    let mut table = Table::new(title);
    for (list, unit) in lists {
        for (name, count) in *list {
            table.row(name, *count, *unit);
        }
    }
    table
}

fn object(counts: &Counts) -> Value {
    Value::Object(counts.iter().map(|(name, count)| (name.clone(), (*count).into())).collect())
}

/// The largest value, and its place.
fn largest(values: impl Iterator<Item = f64>) -> (usize, f64) {
    values.enumerate().fold((0, 0.0), |largest, value| if value.1 > largest.1 { value } else { largest })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;
    use mesh::{BoxMesh, Curving};

    fn two_squares(periodic: bool) -> MeshFacts {
        let (lower, upper, cells) = ([0.0; 2], [2.0, 1.0], [2, 1]);
        let curving = Curving::None;
        let mesh = BoxMesh { lower, upper, cells, order: 2, curving, periodic: [periodic; 2] }.build().unwrap();
        MeshFacts::new(Path::new("box.msh"), &mesh)
    }

    /// Defects that were: keys began with blanks, the name of the file was a key, and "valid" was a text.
    #[test]
    fn json_has_clean_keys() {
        let json = Value::Object(two_squares(false).json());
        assert_eq!((&json["file"], &json["mesh"]["valid"]), (&"box.msh".into(), &true.into()));
        let keys = |value: &Value| value.as_object().unwrap().keys().cloned().collect::<Vec<_>>();
        assert!(keys(&json).iter().chain(&keys(&json["mesh"])).all(|key| key.trim() == key && !key.contains("box")));
        let pairs = json["translated boundaries"].as_array().unwrap();
        let pair = pairs.iter().find(|pair| pair["boundaries"] == json!(["left", "right"])).unwrap();
        assert_eq!(pair["translation"], json!([2.0, 0.0]));
        assert_eq!((&json["boundaries"]["bottom"], &json["regions"]), (&2.into(), &json!({})));
    }

    /// A defect that was: headings stood above no rows.
    #[test]
    fn tables_without_rows_are_omitted() {
        assert_eq!(two_squares(false).tables().len(), 3);
        let tables = two_squares(true).tables();
        assert_eq!(tables.len(), 1);
        assert!(tables[0].text().contains("\n    in cell ") && tables[0].text().contains(" yes det J"));
    }
}
