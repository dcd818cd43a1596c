//! The condition on a boundary, and its data.

use super::controls::Control;
use crate::point_data::PointData;
use crate::state::State;
use navier_stokes::{Boundary, ExactState};

/// The condition on a boundary, and its data.
#[derive(Clone, Debug, PartialEq)]
pub struct BoundaryData<const D: usize> {
    /// The condition.
    pub condition: Boundary<D>,
    /// What the condition takes at every point, if it does.
    pub data: Option<Data<D>>,
    /// A number in the data that the run changes after every slab.
    pub control: Option<Control>,
}

/// What a condition takes at every point.
#[derive(Clone, Debug, PartialEq)]
pub enum Data<const D: usize> {
    /// A state.
    State(State<D>),
    /// A pressure, a vector and a temperature by formulas; each condition takes a part of them.
    Values(Box<PointData<D>>),
}

impl<const D: usize> Data<D> {
    /// The numbers that the condition takes at `x` and `t`.
    pub fn at<const M: usize>(&self, x: &[f64; D], t: f64) -> [f64; M] {
        match self {
            Data::State(state) => state.state(x, t),
            Data::Values(values) => values.evaluate(x, t),
        }
    }
}

impl<const D: usize> BoundaryData<D> {
    /// A condition whose values are numbers.
    pub(super) fn uniform(condition: Boundary<D>) -> Self {
        BoundaryData { condition, data: None, control: None }
    }
    /// A condition that takes a state.
    pub(super) fn by_state(condition: Boundary<D>, state: State<D>) -> Self {
        BoundaryData { data: Some(Data::State(state)), ..BoundaryData::uniform(condition) }
    }
    /// A condition whose values are formulas.
    pub(super) fn by_formulas(condition: Boundary<D>, values: PointData<D>) -> Self {
        BoundaryData { data: Some(Data::Values(Box::new(values))), ..BoundaryData::uniform(condition) }
    }
}
