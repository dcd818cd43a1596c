//! Errors of elastic meshes and structures.

use newton_krylov::problem::Inadmissible;
use newton_krylov::{cg, fgmres, newton};
use thiserror::Error;

/// Why an elastic mesh cannot be built or solved.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum ElasticityError {
    /// A material constant is outside its range.
    #[error("{constant} of the elastic material is {value}, expected {accepted}")]
    Material {
        /// The name of the constant.
        constant: &'static str,
        /// Its value.
        value: f64,
        /// The accepted range.
        accepted: &'static str,
    },
    /// The stiffness model gives a modulus that is not a positive number.
    #[error("the stiffness in cell {cell} at {position:?} is {value}: it must be positive and finite")]
    Stiffness {
        /// The cell.
        cell: usize,
        /// The physical point.
        position: Vec<f64>,
        /// The modulus there.
        value: f64,
    },
    /// The cell between neighbouring Gauss-Lobatto nodes is inverted, although the curved cell that contains it may be valid.
    #[error(
        "cell {cell}: the sub-cell of its Gauss-Lobatto nodes at {position:?} is inverted (det = {determinant:e}), so the \
         low-order preconditioner does not exist: curve the cell less, or take more cells"
    )]
    SubCell {
        /// The cell.
        cell: usize,
        /// A corner of the sub-cell.
        position: Vec<f64>,
        /// The determinant of the edges there.
        determinant: f64,
    },
    /// The displacement inverts a cell.
    #[error(transparent)]
    Inverted(#[from] Inversion),
    /// An array does not have the length that mesh and order imply.
    #[error("{array} has {found} entries, expected {expected}")]
    Length {
        /// Which array.
        array: &'static str,
        /// Its length.
        found: usize,
        /// The length that mesh and order imply.
        expected: usize,
    },
    /// No node is constrained along an axis: a translation along it costs no energy.
    #[error(
        "no node of the mesh is constrained along axis {axis}: prescribe the displacement on at least one boundary"
    )]
    Unconstrained {
        /// The axis, counted from 0.
        axis: usize,
    },
    /// The factorisation of the low-order matrix met a pivot that is not positive.
    #[error(
        "the stiffness matrix is not positive definite ({cause}): prescribe the displacement on more of the boundary, or check the stiffness"
    )]
    NotDefinite {
        /// The error of the factorisation.
        cause: String,
    },
    /// The supports of a structure leave it a rigid motion, which takes no energy.
    #[error(
        "the structure can move as a rigid body, and has no equilibrium then: give a support in `structure.boundary`, \"fixed\" or held along \
         more axes"
    )]
    RigidMotion,
    /// The stiffness matrix is not factored, for another reason.
    #[error("the stiffness matrix is not factored")]
    Factorisation(#[source] sparse::Error),
    /// The constants of the material are out of range at a point.
    #[error("the material at {position:?} is not possible: check the formulas of its constants")]
    MaterialAt {
        /// The point, at rest.
        position: Vec<f64>,
        /// The cause.
        source: Box<ElasticityError>,
    },
    /// CG did not reach the tolerance.
    #[error("the elasticity solve failed")]
    Solver(#[from] cg::Error),
    /// FGMRES did not reach the tolerance for a pair of temporal modes.
    #[error("the solve of a time slab of the structure failed")]
    SlabSolver(#[from] fgmres::Error),
    /// Round-off prevents the solution of a slab.
    #[error(
        "the structure in the slab from t = {time} cannot be solved further than to {residual:e} of the forces in it: round-off; \
         it may be too slender for its mesh, or the slab too long"
    )]
    Stalled {
        /// The bottom of the slab.
        time: f64,
        /// The residual relative to the forces.
        residual: f64,
    },
    /// A law that is not linear in plane stress.
    #[error("plane stress is for the linear law only: take plane strain, or the linear law")]
    PlaneStress,
    /// Newton's method did not find the motion or the equilibrium of a structure.
    #[error(
        "the large displacement of the structure was not found near t = {time}: take shorter slabs, or apply loads and \
         displacements in smaller steps"
    )]
    LargeDisplacement {
        /// The bottom of the slab; without inertia the time node.
        time: f64,
        /// Why.
        source: Box<newton::Error>,
    },
    /// A load is not a number.
    #[error("the force on the structure at t = {time} near {position:?} is {value}: check the formulas of its loads")]
    Load {
        /// The time.
        time: f64,
        /// A node that the load acts on.
        position: Vec<f64>,
        /// The nodal force.
        value: f64,
    },
    /// There are fewer natural modes than requested.
    #[error(
        "`structure.natural_modes` = {wanted}, but the structure has only {free}: ask for fewer, or refine the mesh"
    )]
    TooManyModes {
        /// The number of modes requested.
        wanted: usize,
        /// Entries of a displacement that are free.
        free: usize,
    },
    /// Natural modes did not converge.
    #[error("{wanted} natural modes did not converge in {iterations} iterations: ask for fewer, or refine the mesh")]
    Modes {
        /// The number of modes requested.
        wanted: usize,
        /// The iterations done.
        iterations: usize,
    },
    /// Newton's method did not find the equilibrium of a nonlinear law.
    #[error("the equilibrium of the mesh was not found to the tolerance {tolerance:e}, in distances of nodes")]
    Newton {
        /// The error of position allowed, relative to the distance of nodes.
        tolerance: f64,
        /// The cause.
        source: Box<newton::Error>,
    },
}

/// The displacement inverts a cell at a point where its energy is integrated: laws of large displacement have no stress there.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error("the displacement d inverts cell {cell}: det(I + grad d) = {volume_ratio:e} at a point of its energy")]
pub struct Inversion {
    /// The cell.
    pub cell: usize,
    /// The smallest det(I + grad d) of the mesh.
    pub volume_ratio: f64,
}

/// The quantity of an [`Inversion`], as messages call it.
pub const VOLUME_RATIO: &str = "det(I + grad d)";

impl From<Inversion> for Inadmissible {
    fn from(Inversion { cell, volume_ratio }: Inversion) -> Self {
        let location = format!("in cell {cell} at a point of its elastic energy");
        Inadmissible { quantity: VOLUME_RATIO.into(), value: volume_ratio, location }
    }
}

impl From<sparse::Error> for ElasticityError {
    fn from(error: sparse::Error) -> Self {
        match error {
            sparse::Error::NotDefinite { cause } => ElasticityError::NotDefinite { cause },
            error => ElasticityError::Factorisation(error),
        }
    }
}
