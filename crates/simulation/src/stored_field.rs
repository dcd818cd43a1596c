//! A field of a result file: its polynomials in the cells.

use crate::cell_finder::{CellFinder, Place};
use crate::nodal::{by_node, dot_of};
use fem::functions_at;
use fem::parallel::{self, Grain};
use mesh::CellMap;

/// A field at one time, a polynomial in each cell with values at Gauss-Lobatto nodes.
pub struct StoredField<const D: usize> {
    order: usize,
    components: usize,
    /// `[cell][component][node]`
    coefficients: Vec<f64>,
}

impl<const D: usize> StoredField<D> {
    /// A field of `components` on so many `cells` with these coefficients, `[cell][component][node]`. `None` if their number does not fit.
    pub fn new(components: usize, coefficients: Vec<f64>, cells: usize) -> Option<Self> {
        let nodes = coefficients.len().checked_div(cells * components)?;
        let order = (nodes as f64).powf(1.0 / D as f64).round() as usize;
        let fits = order > 1 && order.pow(D as u32) * cells * components == coefficients.len();
        fits.then_some(StoredField { order, components, coefficients })
    }

    /// Nodes per direction.
    pub fn order(&self) -> usize {
        self.order
    }

    /// Components.
    pub fn components(&self) -> usize {
        self.components
    }

    /// The number of cells.
    pub fn cells(&self) -> usize {
        self.coefficients.len() / self.cell_length()
    }

    /// The coefficients of a cell, `[component][node]`.
    pub fn of_cell(&self, cell: usize) -> &[f64] {
        &self.coefficients[cell * self.cell_length()..][..self.cell_length()]
    }

    /// The components at the reference point `xi` of a cell.
    pub fn at(&self, cell: usize, xi: &[f64; D]) -> Vec<f64> {
        self.of_functions(cell, &functions_at(self.order, xi)).collect()
    }

    /// The components at reference points in all cells, `[cell][point][component]`.
    pub fn at_reference(&self, points: &[[f64; D]]) -> Vec<f64> {
        let functions: Vec<Vec<f64>> = points.iter().map(|xi| functions_at(self.order, xi)).collect();
        let of_cell = |cell| functions.iter().flat_map(move |functions| self.of_functions(cell, functions));
        (0..self.cells()).flat_map(of_cell).collect()
    }

    /// The components at `points`, `[point][component]`; NaN at points in none of the cells of `finder`.
    pub fn at_points(&self, finder: &CellFinder<D>, points: &[[f64; D]]) -> Vec<f64> {
        let at = |x: &[f64; D]| match finder.find(x) {
            Some((cell, xi)) => self.at(cell, &xi),
            None => vec![f64::NAN; self.components],
        };
        parallel::map(points.len(), Grain::Any, &|number| at(&points[number])).concat()
    }

    /// The components at `places` in its cells, `[place][component]`.
    pub fn at_places(&self, places: &[Place<D>]) -> Vec<f64> {
        parallel::map(places.len(), Grain::Any, &|number| self.at(places[number].cell, &places[number].xi)).concat()
    }

    /// The means of the components over the reference cell of a cell.
    pub fn means(&self, cell: usize) -> Vec<f64> {
        let weights = basis::gauss_lobatto(self.order).tensor_weights(D);
        let volume: f64 = weights.iter().sum();
        self.of_functions(cell, &weights).map(|sum| sum / volume).collect()
    }

    /// det J at reference points in all cells, `[cell][point]`, of a field of positions. `None` if the field has not D components.
    pub fn determinants(&self, points: &[[f64; D]]) -> Option<Vec<f64>> {
        let maps: Vec<CellMap<D>> = points.iter().map(|xi| CellMap::at(self.order, xi)).collect();
        let of_cell = |cell| {
            let nodes = by_node::<D>(self.of_cell(cell));
            maps.iter().flat_map(|map| map.determinants(&nodes)).collect::<Vec<f64>>()
        };
        (self.components == D).then(|| (0..self.cells()).flat_map(of_cell).collect())
    }

    fn cell_length(&self) -> usize {
        self.components * self.order.pow(D as u32)
    }

    fn of_functions<'a>(&'a self, cell: usize, functions: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
        self.of_cell(cell).chunks_exact(functions.len()).map(|nodal| dot_of(nodal, functions))
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    /// Two cells of order 3, [0, 1] x [0, 3] and [1, 2] x [0, 3]: their positions are x and y.
    fn positions() -> StoredField<2> {
        let nodes = basis::gauss_lobatto(3).points;
        let along = |axis: usize, i: usize| 0.5 * (1.0 + nodes[if axis == 0 { i % 3 } else { i / 3 }]);
        let cell = |shift: f64| (0..9).map(move |i| shift + along(0, i)).chain((0..9).map(move |i| 3.0 * along(1, i)));
        StoredField::new(2, cell(0.0).chain(cell(1.0)).collect(), 2).unwrap()
    }

    #[test]
    fn positions_and_determinants_are_those_of_the_rectangles() {
        let (field, points) = (positions(), [[0.0, 0.0], [1.0, -0.5]]);
        assert_eq!((field.order(), field.cells(), field.components()), (3, 2, 2));
        let expected = [0.5, 1.5, 1.0, 0.75, 1.5, 1.5, 2.0, 0.75];
        let close = |found: &[f64], expected: &[f64]| {
            assert_eq!(found.len(), expected.len());
            found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-14)
        };
        assert!(close(&field.at_reference(&points), &expected));
        assert!(close(&field.at(1, &points[1]), &expected[6..]));
        // det J = 1 / 2 * 3 / 2.
        assert!(close(&field.determinants(&points).unwrap(), &[0.75; 4]));
    }

    #[test]
    fn lengths_that_do_not_fit_are_refused() {
        for (components, length, cells) in [(2, 35, 2), (0, 36, 2), (2, 36, 0), (1, 4, 4), (5, 36, 2)] {
            assert!(
                StoredField::<2>::new(components, vec![0.0; length], cells).is_none(),
                "{components} {length} {cells}"
            );
        }
        let scalar = StoredField::<2>::new(1, vec![0.0; 18], 2).unwrap();
        assert!(scalar.determinants(&[[0.0; 2]]).is_none());
    }
}
