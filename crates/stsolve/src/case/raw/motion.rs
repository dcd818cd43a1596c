//! `[motion]`

use super::formula::Formula;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// How the mesh moves: either `displacement` everywhere, or `boundary` with an elastic interior.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Motion {
    /// The displacement of every point of the mesh, a formula per axis in the position x, y, z at rest and the time t. It must be
    /// zero at the start. Bypasses elasticity.
    pub displacement: Option<Vec<Formula>>,
    /// The elastic body that carries the motion of the boundary inside.
    pub elasticity: Option<Elasticity>,
    /// How each boundary moves, by name; `others` stands for all that are not named.
    #[serde(default)]
    pub boundary: BTreeMap<String, BoundaryMotion>,
}

/// The mesh as an elastic body; in two dimensions its strain is plane.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Elasticity {
    /// Poisson's ratio nu, -1 < nu < 0.5. The nearer to 0.5, the better cells keep their volume.
    #[serde(default = "poisson_ratio")]
    pub poisson_ratio: f64,
    /// Young's modulus over the mesh. Only its variation matters, not its size.
    #[serde(default)]
    pub stiffness: Stiffness,
    /// How the equations of the mesh are solved.
    #[serde(default)]
    pub solver: ElasticitySolver,
    /// The energy that the mesh minimises.
    #[serde(default)]
    pub law: Law,
    /// The mesh from which strain is counted; of the linear law.
    pub reference: Option<ReferenceMesh>,
    /// Where Newton's method stops, an error of position relative to the distance of nodes; of the neo-Hookean law. With a flow the mesh
    /// is found to round-off.
    pub tolerance: Option<f64>,
}

/// The energy that the mesh minimises.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Law {
    /// Linear elasticity: one linear solve per time node, for rotations up to 60 degrees at best.
    #[default]
    Linear,
    /// mu/2 (|F|^2 - D - 2 ln J) + lambda/2 (ln J)^2 with F = I + grad d and J = det F: some Newton steps per slab, for large rotations.
    NeoHookean,
}

/// The mesh from which strain is counted.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ReferenceMesh {
    /// The one at the start: the mesh depends on the position of its boundary alone, and returns with it.
    Initial,
    /// The one at the start of each slab: larger motions, but the mesh depends on its past.
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

/// How the equations of the mesh are solved.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ElasticitySolver {
    /// Direct where that is cheap, multigrid for large meshes in space. `stsolve check` names the choice.
    #[default]
    Automatic,
    /// Elimination, factored once per run; no iterations.
    Direct,
    /// Conjugate gradients with a factored low-order preconditioner.
    Cg,
    /// Conjugate gradients with algebraic multigrid: the least memory.
    Multigrid,
}

/// Young's modulus over the mesh.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "snake_case")]
pub enum Stiffness {
    /// The same everywhere.
    Constant,
    /// (det J)^-power, with the Jacobian J of each cell: small cells are stiff, large ones take the deformation.
    InverseJacobian {
        /// The power.
        #[serde(default = "one")]
        power: f64,
    },
    /// A positive formula in the position x, y, z at rest.
    Expression(Formula),
}

fn one() -> f64 {
    1.0
}

impl Default for Stiffness {
    fn default() -> Self {
        Stiffness::InverseJacobian { power: one() }
    }
}

/// How a boundary moves.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "snake_case")]
pub enum BoundaryMotion {
    /// It rests.
    Fixed,
    /// Its displacement, a formula per axis in the position x, y, z at rest and the time t; zero at the start.
    Displacement(Vec<Formula>),
}
