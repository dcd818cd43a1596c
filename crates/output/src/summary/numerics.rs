//! Sizes, the work of the solver, and errors.

use serde::{Deserialize, Serialize};

/// Size of the mesh.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MeshSize {
    /// 2 or 3.
    pub dimension: usize,
    /// Number of cells.
    pub cells: usize,
    /// Nodes per direction of the geometry.
    pub order: usize,
}

/// Number of unknowns of a slab.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Unknowns {
    /// Of the flow.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub flow: Option<usize>,
    /// Of the mesh motion.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mesh: Option<usize>,
    /// Of a structure.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub structure: Option<usize>,
}

/// Newton steps.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Newton {
    /// Over the run.
    pub total: u64,
    /// The largest number in a slab.
    pub max: u64,
    /// Mean over the slabs.
    pub per_slab: f64,
}

/// Krylov iterations.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Krylov {
    /// Over the run.
    pub total: u64,
    /// The largest number in a Newton step.
    pub max_per_newton: u64,
    /// Mean over the Newton steps.
    pub mean_per_newton: f64,
    /// Conjugate-gradient iterations of the elasticity preconditioner over the run.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub elasticity_total: Option<u64>,
}

/// Quality of the moving mesh: the worst over the run.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MeshQuality {
    /// Proven lower bound of det J, relative to the mesh at rest.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub det_j_lower_bound: Option<f64>,
    /// Smallest det J at a sampled point, relative to the mesh at rest.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub det_j_sampled_min: Option<f64>,
    /// Smallest scaled Jacobian.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scaled_jacobian_min: Option<f64>,
    /// First time at which a cell is not proved to be valid.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub first_invalid_time: Option<f64>,
    /// First time at which det J is not positive at one of 2N Gauss points per direction of a cell.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub first_invalid_time_sampled: Option<f64>,
}

/// Errors of conserved quantities.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Conservation {
    /// Mass gained minus mass flown in, relative to the mass.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mass_error: Option<f64>,
    /// Energy gained minus energy flown in, relative to the energy.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub energy_error: Option<f64>,
    /// Energy that gas and bodies gained minus energy that came in, relative to the energy of the gas at the start.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub coupled_energy_error: Option<f64>,
    /// Largest deviation from a free stream.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub free_stream_error: Option<f64>,
}

/// Distance to the exact solution.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ErrorNorms {
    /// L2 norm, density.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub density_l2: Option<f64>,
    /// L2 norm, momentum.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub momentum_l2: Option<f64>,
    /// L2 norm, total energy per volume.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub energy_l2: Option<f64>,
    /// Largest deviation of the mesh displacement.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub displacement_max: Option<f64>,
}
