//! The blocks of a slab: their unknowns, and the quantities that they exchange.
//!
//! ```text
//! z = (z_1, ..., z_n),    R_k(z_k; what block k reads) = 0                                                      (blocks)
//! ```
//!
//! Bodies come first, then the mesh, then the flow. A body writes the displacement of its wall nodes. The mesh reads it and writes its
//! velocity. The flow reads that and writes the loads on its walls, which bodies read. Without bodies nothing is read from a later block:
//! the Jacobian is block lower triangular, and the mesh can be solved ahead of the flow.

use crate::slab_error::SlabError;
use crate::state::{Interval, State};
use fem::Clock;
use newton_krylov::problem::Inadmissible;

/// A quantity that one block passes to others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// The displacement of wall nodes that a body moves.
    WallDisplacement,
    /// The velocity of the mesh.
    MeshVelocity,
    /// The loads of the flow on the walls of bodies.
    WallLoads,
}

/// The quantities that a block reads and writes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Couplings {
    /// Read from other blocks.
    pub reads: &'static [Quantity],
    /// Written for other blocks.
    pub writes: &'static [Quantity],
}

/// The quantities that blocks exchange at a point z; in a product, their derivatives along the direction.
#[derive(Clone, Debug, Default)]
pub struct Exchange {
    /// Displacement at the time nodes, `[time node][C0 node][component]`; only constrained entries are read. It is first set to the
    /// prescribed one, then bodies add to it.
    pub wall_displacement: Vec<f64>,
    /// Velocity of the mesh, `[time node][C0 node][component]`.
    pub mesh_velocity: Vec<f64>,
    /// Whether that velocity is not zero everywhere; set in products and preconditioners alone.
    pub mesh_moves: bool,
    /// Whether the flow keeps the effect of bodies that the whole mesh follows. Then the mesh writes nothing in products and
    /// preconditioners.
    pub effect_is_kept: bool,
    /// Loads on the walls of bodies, `[time point][loaded node][component]`, see [`fem::SlabOperator::loads`].
    pub wall_loads: Vec<f64>,
}

/// One field of the unknowns of a slab, with its equations.
///
/// [`Self::residual`], [`Self::product`] and [`Self::precondition`] are called in the order of the blocks. What a block reads from a later
/// block it adds in [`Self::receive`] and [`Self::receive_product`], which follow.
pub trait Block: Send {
    /// The name of its equations in reports.
    fn field(&self) -> &'static str;

    /// The quantities that it reads and writes.
    fn couplings(&self) -> Couplings;

    /// Its weights in the norm of residuals, one for each unknown. They make the norm an error of position relative to the spacing of
    /// nodes, or an error of the state relative to its scales.
    fn weights(&self) -> Vec<f64>;

    /// Moves to the slab `interval` on top of `state`. Data that depend on time are those of `clock`.
    ///
    /// # Errors
    /// [`SlabError`] if the block cannot begin there.
    fn begin_slab(&mut self, interval: Interval, clock: Clock, state: &State) -> Result<(), SlabError>;

    /// r := R(z) without the terms that later blocks determine; writes its quantities.
    ///
    /// # Errors
    /// [`Inadmissible`] if R is not defined at z.
    fn residual(&mut self, z: &[f64], exchange: &mut Exchange, r: &mut [f64]) -> Result<(), Inadmissible>;

    /// Adds to `r` the terms that later blocks determine.
    fn receive(&mut self, _exchange: &Exchange, _r: &mut [f64]) {}

    /// Fixes the point of linearisation and 1/dtau.
    fn linearise(&mut self, z: &[f64], exchange: &mut Exchange, inverse_pseudo_time: f64);

    /// out := dR/dz x without the terms that later blocks determine; writes the derivatives of its quantities. For those of bodies see
    /// [`Body::move_walls`].
    fn product(&mut self, x: &[f64], tangent: &mut Exchange, out: &mut [f64]);

    /// Adds to `out` the derivative of the terms that later blocks determine.
    fn receive_product(&mut self, _tangent: &Exchange, _out: &mut [f64]) {}

    /// x := P^-1 (r minus the effect of earlier blocks), where P approximates dR/dz + T_tau; writes the derivatives of its quantities along
    /// x.
    fn precondition(&mut self, r: &[f64], tangent: &mut Exchange, x: &mut [f64]);

    /// out := out + T_tau x with the 1/dtau last set.
    fn add_pseudo_time(&mut self, x: &[f64], out: &mut [f64]);

    /// The largest step from z along dz for which the block is known to be admissible; 1 if nothing is known.
    fn largest_step(&mut self, _z: &[f64], _dz: &[f64]) -> f64 {
        1.0
    }
}

/// The energy that a body has gained and lost since the start of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ledger {
    /// Work of the flow on the body.
    pub flow: f64,
    /// Work of the drives of coordinates.
    pub drive: f64,
    /// Work of the outer force.
    pub force: f64,
    /// Energy that dampers have taken.
    pub damped: f64,
    /// Energy that jumps in time have taken: the error of the time integration.
    pub numerical: f64,
    /// Error of the balance, because the equations are solved to a tolerance.
    pub defect: f64,
}

impl Ledger {
    /// The number of its entries.
    pub const LEN: usize = 6;

    /// Its entries.
    pub fn numbers(&self) -> [f64; Self::LEN] {
        [self.flow, self.drive, self.force, self.damped, self.numerical, self.defect]
    }

    /// The ledger with these entries.
    pub fn read(numbers: &[f64]) -> Self {
        let at = |i: usize| numbers.get(i).copied().unwrap_or(0.0);
        Ledger { flow: at(0), drive: at(1), force: at(2), damped: at(3), numerical: at(4), defect: at(5) }
    }
}

/// A body between two slabs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BodyState {
    /// Its coordinates; the displacements of the observed points of an elastic body.
    pub position: Vec<f64>,
    /// Their rates.
    pub rate: Vec<f64>,
    /// Kinetic energy.
    pub kinetic_energy: f64,
    /// The energy of springs or strain.
    pub potential_energy: f64,
    /// The balance of its energy.
    pub ledger: Ledger,
    /// The mean forces of its supports over the slab that has ended; not numbers before the first one.
    pub reactions: Vec<f64>,
}

impl BodyState {
    /// Kinetic and potential energy.
    pub fn energy(&self) -> f64 {
        self.kinetic_energy + self.potential_energy
    }

    /// The number of coordinates of a body that is stored as its position, its rate and its ledger.
    pub fn coordinates(stored: &[f64]) -> usize {
        stored.len().saturating_sub(Ledger::LEN) / 2
    }
}

/// A body: it moves walls, and the flow loads it. Its block precedes the mesh.
pub trait Body: Block {
    /// The numbers that store its state at the start of a run.
    fn initial(&self) -> Vec<f64>;

    /// Its state from the numbers `stored`.
    fn read(&self, stored: &[f64]) -> BodyState;

    /// How far the body travels in the slab with the unknowns `z`, in the units of residuals in the norm of its weights.
    fn travel(&self, z: &[f64]) -> f64;

    /// Twice the kinetic energy of the jump of the rates at the bottom of the slab with the unknowns `z`.
    fn jump(&self, _z: &[f64]) -> f64 {
        0.0
    }

    /// A change of the unknowns `z` that has the effect of one of the last digit of rates and positions.
    fn last_digits(&self, z: &[f64]) -> Vec<f64> {
        z.iter().map(|rate| f64::EPSILON * rate).collect()
    }

    /// z := the guess for the slab that [`Block::begin_slab`] has set; writes the displacement of its walls. `past` holds the unknowns and
    /// the length of the slab before, if there was one.
    fn guess(&mut self, past: Option<(&[f64], f64)>, exchange: &mut Exchange, z: &mut [f64]);

    /// Adds to `displacement`, `[time node][C0 node][component]`, the derivative of that of its walls along the unknowns `x`. It is called before
    /// the [products](Block::product) of later blocks, and where they are preconditioned.
    fn move_walls(&mut self, x: &[f64], displacement: &mut [f64]);

    /// The C0 nodes where [`Body::add_velocity_at_top`] replaces the velocity of the mesh; several bodies may move one.
    fn nodes_with_velocity_at_top(&self) -> Vec<usize> {
        Vec::new()
    }

    /// Adds its own velocity at the top of the slab with the unknowns `z`, `[C0 node][component]`. The polynomials of the mesh meet positions;
    /// the velocity of a node that turns is only nearly that of the body. Elastic bodies need no replacement: their nodes have the same
    /// polynomials.
    fn add_velocity_at_top(&self, _z: &[f64], _velocity: &mut [f64]) {}

    /// Whether the motion of the body in the slab with the unknowns `z` can be accepted.
    ///
    /// # Errors
    /// [`SlabError::EnergyGain`] or [`SlabError::FullTurn`] if not.
    fn check_slab(&self, _z: &[f64]) -> Result<(), SlabError> {
        Ok(())
    }

    /// Replaces its `stored` state by that at the top of the slab with the unknowns `z`.
    fn end_slab(&mut self, z: &[f64], stored: &mut Vec<f64>);
}
