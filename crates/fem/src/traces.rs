//! Traces of cell coefficients on faces, and the way back.

use crate::tables::Line;
use mesh::{axis_and_side, face_nodes};

/// Where the traces of a set of cell coefficients lie: `[cell][face][kind][slot][component][face node]`.
///
/// Kind 0 are values on the face's lattice, kind 1 derivatives along the reference axis that leaves the face. Slots are
/// time nodes of the flow, or bottom position and velocities of the mesh.
#[derive(Clone, Copy, Debug)]
pub struct TraceLayout {
    /// Faces of a cell, 2 D.
    pub faces: usize,
    /// Slots.
    pub slots: usize,
    /// Components.
    pub components: usize,
    /// Nodes of a cell.
    pub nodes: usize,
    /// Nodes of a face.
    pub face_nodes: usize,
}

impl TraceLayout {
    /// Length of one kind on one face.
    pub fn kind_len(&self) -> usize {
        self.slots * self.components * self.face_nodes
    }
    /// Length of one face.
    pub fn face_len(&self) -> usize {
        2 * self.kind_len()
    }
    /// Length of one cell.
    pub fn cell_len(&self) -> usize {
        self.faces * self.face_len()
    }
    /// The start of a kind on a face of a cell.
    pub fn start(&self, cell: usize, face: usize, kind: usize) -> usize {
        cell * self.cell_len() + face * self.face_len() + kind * self.kind_len()
    }
}

/// The nodes that a face reads, for one order and dimension.
pub struct FaceMaps {
    faces: Vec<FaceMap>,
    nodes: usize,
}

struct FaceMap {
    /// Cell nodes of the face's lattice: the low end of each line that leaves the face.
    line_starts: Vec<usize>,
    /// Cell nodes of the face's lattice, on the face.
    on_face: Vec<usize>,
    /// Distance of the nodes on a leaving line.
    stride: usize,
    /// Derivatives at the face of the nodal polynomials along the leaving line.
    derivatives: Vec<f64>,
}

impl FaceMaps {
    /// Maps for the polynomials of `line` in `dimension` directions.
    pub fn new(line: &Line, dimension: usize) -> Self {
        let n = line.order;
        let face = |face| {
            let (axis, side) = axis_and_side(face);
            FaceMap {
                line_starts: face_nodes(dimension, n, 2 * axis),
                on_face: face_nodes(dimension, n, face),
                stride: n.pow(axis as u32),
                derivatives: line.end_derivatives[side].clone(),
            }
        };
        FaceMaps { faces: (0..2 * dimension).map(face).collect(), nodes: n.pow(dimension as u32) }
    }

    /// The functionals on the nodal values of one component whose values are the traces on `face`: kind 0 then kind 1, each
    /// in the order of the face's lattice; a functional is a list of (cell node, weight).
    pub fn functionals(&self, face: usize, both: bool) -> Vec<Vec<(usize, f64)>> {
        let map = &self.faces[face];
        let values = map.on_face.iter().map(|&node| vec![(node, 1.0)]);
        let line =
            |start: &usize| map.derivatives.iter().enumerate().map(|(k, &w)| (start + k * map.stride, w)).collect();
        let derivatives = map.line_starts.iter().map(line);
        if both { values.chain(derivatives).collect() } else { values.collect() }
    }

    /// The traces of the tensors `coefficients[slot and component][node]` on `face`: kind 0 into `values`, and kind 1 into
    /// `derivatives` unless that is empty.
    pub fn extract(&self, face: usize, coefficients: &[f64], values: &mut [f64], derivatives: &mut [f64]) {
        let map = &self.faces[face];
        let n = map.on_face.len();
        for (tensor, values) in coefficients.chunks_exact(self.nodes).zip(values.chunks_exact_mut(n)) {
            for (value, &node) in values.iter_mut().zip(&map.on_face) {
                *value = tensor[node];
            }
        }
        for (tensor, derivatives) in coefficients.chunks_exact(self.nodes).zip(derivatives.chunks_exact_mut(n)) {
            derivatives.fill(0.0);
            for (k, weight) in map.derivatives.iter().enumerate() {
                for (derivative, &start) in derivatives.iter_mut().zip(&map.line_starts) {
                    *derivative += weight * tensor[start + k * map.stride];
                }
            }
        }
    }

    /// The transpose of [`FaceMaps::extract`]: adds terms tested with traces to terms tested with cell functions.
    pub fn lift(&self, face: usize, values: &[f64], derivatives: &[f64], coefficients: &mut [f64]) {
        let map = &self.faces[face];
        let n = map.on_face.len();
        for (tensor, values) in coefficients.chunks_exact_mut(self.nodes).zip(values.chunks_exact(n)) {
            for (value, &node) in values.iter().zip(&map.on_face) {
                tensor[node] += value;
            }
        }
        for (tensor, derivatives) in coefficients.chunks_exact_mut(self.nodes).zip(derivatives.chunks_exact(n)) {
            for (k, weight) in map.derivatives.iter().enumerate() {
                for (derivative, &start) in derivatives.iter().zip(&map.line_starts) {
                    tensor[start + k * map.stride] += weight * derivative;
                }
            }
        }
    }
}

/// Traces of all cells for one set of coefficients.
#[derive(Clone, Debug)]
pub struct Traces {
    /// Where they lie.
    pub layout: TraceLayout,
    /// The numbers.
    pub data: Vec<f64>,
}

impl Traces {
    /// Room for the traces of `cells` cells.
    pub fn new(layout: TraceLayout, cells: usize) -> Self {
        Traces { layout, data: vec![0.0; cells * layout.cell_len()] }
    }

    /// Takes the traces of `coefficients[cell][slot][component][node]`; derivatives only where `both`.
    pub fn take(&mut self, maps: &FaceMaps, coefficients: &[f64], both: bool) {
        use rayon::prelude::*;
        let layout = self.layout;
        let per_cell = layout.slots * layout.components * layout.nodes;
        let cells = coefficients.par_chunks_exact(per_cell).with_min_len(8);
        cells.zip(self.data.par_chunks_exact_mut(layout.cell_len())).for_each(|(cell, traces)| {
            for (face, traces) in traces.chunks_exact_mut(layout.face_len()).enumerate() {
                let (values, derivatives) = traces.split_at_mut(layout.kind_len());
                maps.extract(face, cell, values, if both { derivatives } else { &mut [] });
            }
        });
    }

    /// One kind on one face.
    pub fn of(&self, cell: usize, face: usize, kind: usize) -> &[f64] {
        let start = self.layout.start(cell, face, kind);
        &self.data[start..start + self.layout.kind_len()]
    }
}
