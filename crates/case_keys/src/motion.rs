//! `[motion]`

use super::formula::Formula;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The motion of the mesh: either `displacement` everywhere, or `boundary` with an elastic interior.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Motion {
    /// The displacement of every point of the mesh, a formula per axis in the position x, y, z at rest and the time t. It must be
    /// zero at the start. Elasticity is not used.
    pub displacement: Option<Vec<Formula>>,
    /// The elastic body that extends the motion of the boundary to the interior.
    pub elasticity: Option<Elasticity>,
    /// The motion of each boundary, by name; `others` stands for all that are not named.
    #[serde(default)]
    pub boundary: BTreeMap<String, BoundaryMotion>,
}

/// The mesh as an elastic body, in two dimensions in plane strain.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Elasticity {
    /// Poisson's ratio nu, -1 < nu < 0.5. Values near 0.5 keep the volumes of cells nearly constant.
    #[serde(default = "poisson_ratio")]
    pub poisson_ratio: f64,
    /// Young's modulus over the mesh. Only its variation matters, not its magnitude. Default: `{ inverse_jacobian = { power = 1 } }`.
    #[serde(default)]
    pub stiffness: Stiffness,
    /// The solver of the mesh equations.
    #[serde(default)]
    pub solver: ElasticitySolver,
    /// The energy that the mesh minimises.
    #[serde(default)]
    pub law: Law,
    /// The mesh to which strain refers, for the linear law. Default: `"initial"`.
    pub reference: Option<ReferenceMesh>,
    /// The tolerance of Newton's method for the neo-Hookean law, a root mean square error of position relative to the node spacing. At
    /// most 1e-3; default 1e-6. With a flow the mesh is solved to round-off.
    pub tolerance: Option<f64>,
}

/// The energy that the mesh minimises.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Law {
    /// Linear elasticity: one linear solve per time node. It suits rotations up to 60 degrees at best.
    #[default]
    Linear,
    /// mu/2 (|F|^2 - D - 2 ln J) + lambda/2 (ln J)^2 with F = I + grad d and J = det F: some Newton steps per slab, for large rotations.
    NeoHookean,
}

/// The mesh to which strain refers.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ReferenceMesh {
    /// The mesh at the start: the mesh depends only on the position of its boundary, and returns with it.
    Initial,
    /// The mesh at the start of each slab: larger motions, but the mesh depends on its past.
    Updated,
}

fn poisson_ratio() -> f64 {
    0.4
}

impl Default for Elasticity {
    fn default() -> Self {
        Elasticity {
            poisson_ratio: poisson_ratio(),
            stiffness: Stiffness::default(),
            law: Law::default(),
            reference: None,
            tolerance: None,
            solver: ElasticitySolver::default(),
        }
    }
}

/// The solver of the mesh equations.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ElasticitySolver {
    /// Direct if that is cheap, multigrid for large three-dimensional meshes. `stsolve check` names the choice.
    #[default]
    Automatic,
    /// Elimination, factored once per run, without iterations.
    Direct,
    /// Conjugate gradients with a factored low-order preconditioner.
    Cg,
    /// Conjugate gradients with algebraic multigrid, which needs the least memory.
    Multigrid,
    /// Conjugate gradients with balancing domain decomposition by constraints (BDDC). Every block of `parallel.blocks` is factored alone, so
    /// processes share the work and the memory.
    Bddc,
}

/// Young's modulus over the mesh.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "snake_case")]
pub enum Stiffness {
    /// Constant.
    Constant,
    /// (det J)^-power, with the Jacobian J of each cell: small cells are stiff, large ones take the deformation.
    InverseJacobian {
        /// The power.
        #[serde(default = "one")]
        power: f64,
    },
    /// A positive formula in the position x, y, z at rest.
    Expression(Formula),
    /// 1 + amplitude / (1 + (d / distance)^2): stiff near the boundaries that move, where d = 0, softer elsewhere. With the distances
    /// to the inner and to the outer boundaries, d = max(0, min(to inner - distance, to outer + 2 distance)).
    WallDistance(WallDistance),
}

/// Stiffness by the distance to boundaries, at rest.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct WallDistance {
    /// The additional stiffness at the inner boundaries relative to the stiffness far from them.
    #[serde(default = "hundred")]
    pub amplitude: f64,
    /// The distance up to which the mesh is as stiff as at the inner boundaries.
    pub distance: f64,
    /// The boundaries that move, by name.
    pub inner: Vec<String>,
    /// The boundaries that rest, by name; there may be none.
    #[serde(default)]
    pub outer: Vec<String>,
}

fn hundred() -> f64 {
    100.0
}

fn one() -> f64 {
    1.0
}

impl Default for Stiffness {
    fn default() -> Self {
        Stiffness::InverseJacobian { power: one() }
    }
}

/// The motion of a boundary.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "snake_case")]
pub enum BoundaryMotion {
    /// At rest.
    Fixed,
    /// Its nodes slide in its plane, which must be normal to an axis: displacements along the normal are zero, along the plane they follow
    /// the elastic interior. A node that it shares with another boundary moves with that one. Not for no-slip walls.
    Slide,
    /// A displacement, a formula per axis in the position x, y, z at rest and the time t; zero at the start.
    Displacement(Vec<Formula>),
    /// A rigid motion: a list of steps, applied in order. At the start the displacement must be zero.
    Rigid(Vec<RigidStep>),
    /// A displacement along the unit normal at rest, which points out of the mesh: positive into the wall. It is a formula in the
    /// position x, y, z at rest and the time t. On a closed curve, also on one that is extruded along z, it may contain s, the length along
    /// the curve as a fraction of the whole. The length starts from 0 at the point with the largest x and increases with the mesh on the right,
    /// which is counter-clockwise around a body. At an edge or a corner the normal is the mean of the facets' normals. Zero at the
    /// start.
    Normal(Formula),
}

/// A step of a rigid motion.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "snake_case")]
pub enum RigidStep {
    /// A uniform displacement: a formula per axis in the time t.
    Translate(Vec<Formula>),
    /// A rotation about a point.
    Rotate(Rotation),
}

/// A rotation about a point that may move.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Rotation {
    /// The angle in radians, counter-clockwise: a formula in the time t. For degrees write "deg(...)".
    pub angle: Formula,
    /// The point, a formula per axis in the time t. Default: the origin.
    pub centre: Option<Vec<Formula>>,
    /// In three dimensions, the direction of the axis, of any length. Default: along z.
    pub axis: Option<[f64; 3]>,
}
