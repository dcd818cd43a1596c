//! The derivative that a kernel computes: no derivative, by the state, or by the state and the mesh.

use tensor::pulp::Simd;
use tensor::{Dual, LaneNumber, Lanes, Over};

/// The number types of one run of the kernels. The same source serves the residual and both Jacobian products.
pub trait Mode: Send + Sync + Copy {
    /// Numbers of the geometry.
    type Geometry<S: Simd>: LaneNumber<S>;
    /// Numbers of the state.
    type State<S: Simd>: LaneNumber<S> + Over<Self::Geometry<S>>;
    /// Blocks of geometry arrays: 2 where the mesh is differentiated.
    const GEOMETRY_BLOCKS: usize;
    /// Blocks of state arrays: 2 where the state is differentiated.
    const STATE_BLOCKS: usize;
}

/// The residual itself.
#[derive(Clone, Copy, Debug)]
pub struct Values;

impl Mode for Values {
    type Geometry<S: Simd> = Lanes<S>;
    type State<S: Simd> = Lanes<S>;
    const GEOMETRY_BLOCKS: usize = 1;
    const STATE_BLOCKS: usize = 1;
}

/// The derivative along a direction of the state, on a fixed mesh.
#[derive(Clone, Copy, Debug)]
pub struct AlongState;

impl Mode for AlongState {
    type Geometry<S: Simd> = Lanes<S>;
    type State<S: Simd> = Dual<Lanes<S>>;
    const GEOMETRY_BLOCKS: usize = 1;
    const STATE_BLOCKS: usize = 2;
}

/// The derivative along a direction of the state and of the mesh.
#[derive(Clone, Copy, Debug)]
pub struct AlongStateAndMesh;

impl Mode for AlongStateAndMesh {
    type Geometry<S: Simd> = Dual<Lanes<S>>;
    type State<S: Simd> = Dual<Lanes<S>>;
    const GEOMETRY_BLOCKS: usize = 2;
    const STATE_BLOCKS: usize = 2;
}
