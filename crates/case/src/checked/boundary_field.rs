//! What a boundary condition takes at points, for the kernels.

use super::boundary_data::{BoundaryData, Data};
use super::given_values::positive_formulas;
use crate::expression::Program;
use crate::point_data::PointData;
use crate::state::State;
use fem::StateField;
use navier_stokes::{Conserved, ExactState};
use std::sync::Arc;
use tensor::Dual;

/// Numbers by formulas. If one that must be positive is not, all are NaN: no flow has that value.
struct GivenValues<const D: usize> {
    values: PointData<D>,
    /// Whether the first and the last number must be positive.
    positive: [bool; 2],
}

impl<const D: usize, const M: usize> StateField<D, M> for GivenValues<D> {
    fn value(&self, x: &[f64; D], t: f64) -> [f64; M] {
        let numbers: [f64; M] = self.values.evaluate(x, t);
        let [first, last] = self.positive;
        let fits = (!first || numbers[0] > 0.0) && (!last || numbers[1 + D] > 0.0);
        if fits { numbers } else { [f64::NAN; M] }
    }
    fn dual(&self, x: &[Dual<f64>; D], t: f64) -> [Dual<f64>; M] {
        self.values.evaluate(x, Dual::from(t))
    }
}

/// A state. Without a positive density and a positive pressure it is NaN: no flow has that state.
struct GivenState<const D: usize>(State<D>);

impl<const D: usize, const M: usize> StateField<D, M> for GivenState<D> {
    fn value(&self, x: &[f64; D], t: f64) -> [f64; M] {
        let state: [f64; M] = self.0.state(x, t);
        let Conserved { density, momentum, energy } = Conserved::<f64, D>::unpack(&state);
        let kinetic = 0.5 * momentum.iter().map(|m| m * m).sum::<f64>() / density;
        if density > 0.0 && energy > kinetic { state } else { [f64::NAN; M] }
    }
    fn dual(&self, x: &[Dual<f64>; D], t: f64) -> [Dual<f64>; M] {
        self.0.state(x, Dual::from(t))
    }
}

impl<const D: usize> BoundaryData<D> {
    /// What the condition takes at every point, if it does: NaN where its formulas give a state that no gas has.
    pub fn field<const M: usize>(&self) -> Option<Arc<dyn StateField<D, M>>> {
        let values = match self.data.as_ref()? {
            Data::State(state) => return Some(Arc::new(GivenState(state.clone()))),
            Data::Values(values) => values,
        };
        let formulas = positive_formulas(self);
        let is_positive = |formula: &Program| formulas.iter().any(|(_, positive)| std::ptr::eq(*positive, formula));
        let positive = [is_positive(&values.first), is_positive(&values.last)];
        Some(Arc::new(GivenValues { values: PointData::clone(values), positive }))
    }
}
