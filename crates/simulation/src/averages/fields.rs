//! Averages over the whole mesh: as coefficients, and as fields for a viewer.

use super::{AverageSums, Averaged, Moments};
use case::Averages;
use fem::Sampler;
use output::{ArraySpec, FieldSpec};
use std::ops::Range;

/// The averages of a case on its mesh.
pub struct AverageFields<'a> {
    moments: Moments,
    sums: &'a AverageSums,
    cells: usize,
    nodes: usize,
}

impl<'a> AverageFields<'a> {
    /// The averages `wanted` from `sums` over so many cells, each with so many nodes, in `D` dimensions.
    pub fn new<const D: usize>(wanted: &Averages, sums: &'a AverageSums, cells: usize, nodes: usize) -> Self {
        AverageFields { moments: Moments::new::<D>(&wanted.fields), sums, cells, nodes }
    }

    /// The averages.
    pub fn averages(&self) -> &[Averaged] {
        &self.moments.averages
    }

    /// The array of the coefficients of an average.
    pub fn array(&self, average: &Averaged) -> ArraySpec {
        let axes = [("cell", self.cells), ("component", average.components()), ("flow node", self.nodes)];
        ArraySpec::new(&average.name, &axes)
    }

    /// The coefficients of an average in `cells`, `[cell][component][node]`, over a phase or over the whole time.
    pub fn coefficients(&self, average: &Averaged, phase: Option<usize>, cells: Range<usize>) -> Vec<f64> {
        let of_cell = |cell| self.sums.of_cell(&self.moments, average, cell, self.nodes, phase);
        cells.flat_map(of_cell).collect()
    }
}

/// The storage of an average for a viewer.
pub fn spec(average: &Averaged) -> FieldSpec {
    match average.components() {
        1 => FieldSpec::scalar(&average.name),
        _ => FieldSpec::vector(&average.name),
    }
}

/// The values of an average with the given `coefficients` at the points of the `sampler`, `[cell][point][component]`.
pub fn drawn<const D: usize>(average: &Averaged, coefficients: &[f64], nodes: usize, sampler: &Sampler<D>) -> Vec<f64> {
    let (points, stored) = (sampler.points(), spec(average).components);
    let of_cell = |coefficients: &[f64]| -> Vec<f64> {
        let values = sampler.state(coefficients);
        let at = |i: usize| values.get(i % stored * points + i / stored).copied().unwrap_or(0.0);
        (0..stored * points).map(at).collect()
    };
    coefficients.chunks_exact(average.components() * nodes).flat_map(of_cell).collect()
}
