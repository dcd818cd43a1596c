//! The modes that count operations, with the feature `operation-counts`.

use crate::mode::Mode;
use tensor::pulp::Simd;
use tensor::{Counted, Dual, Lanes};

/// The residual with its operations counted.
#[derive(Clone, Copy, Debug)]
pub struct CountedValues;

impl Mode for CountedValues {
    type Geometry<S: Simd> = Counted<Lanes<S>>;
    type State<S: Simd> = Counted<Lanes<S>>;
    const GEOMETRY_BLOCKS: usize = 1;
    const STATE_BLOCKS: usize = 1;
}

/// The derivative along a direction of the state with its operations counted.
#[derive(Clone, Copy, Debug)]
pub struct CountedAlongState;

impl Mode for CountedAlongState {
    type Geometry<S: Simd> = Counted<Lanes<S>>;
    type State<S: Simd> = Dual<Counted<Lanes<S>>>;
    const GEOMETRY_BLOCKS: usize = 1;
    const STATE_BLOCKS: usize = 2;
}
