//! Conditions at boundaries of a flow.

use super::*;
use crate::formula::Formula;
use crate::openings::{Inflow, Outflow, VelocityInflow};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A condition on a boundary.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "snake_case")]
pub enum Condition {
    /// A free stream far away.
    FarField(FreeStream),
    /// The exact state.
    Exact,
    /// A state as a function of position and time.
    PrescribedState(State),
    /// An adiabatic no-slip wall that moves with the mesh.
    AdiabaticWall(AdiabaticWall),
    /// An isothermal no-slip wall that moves with the mesh.
    IsothermalWall(IsothermalWall),
    /// A frictionless wall.
    SlipWall,
    /// A plane of symmetry.
    Symmetry,
    /// Subsonic inflow from a reservoir.
    Inflow(Inflow),
    /// Subsonic inflow of given velocity or mass flux.
    VelocityInflow(VelocityInflow),
    /// Supersonic inflow of a state as a function of position and time: the whole state enters for any gas inside.
    SupersonicInflow(State),
    /// Outflow.
    Outflow(Outflow),
}

impl Condition {
    /// Whether it is that of a wall, with or without slip; a plane of symmetry is no wall.
    pub fn is_wall(&self) -> bool {
        match self {
            Condition::AdiabaticWall(_) | Condition::IsothermalWall(_) | Condition::SlipWall => true,
            Condition::FarField(_)
            | Condition::Exact
            | Condition::PrescribedState(_)
            | Condition::Symmetry
            | Condition::Inflow(_)
            | Condition::VelocityInflow(_)
            | Condition::SupersonicInflow(_)
            | Condition::Outflow(_) => false,
        }
    }
}

/// An adiabatic no-slip wall.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AdiabaticWall {
    /// The velocity with which the wall slides in its plane, relative to the mesh: a formula per axis in x, y, z and t. Default: zero.
    pub slide: Option<Vec<Formula>>,
}

/// An isothermal no-slip wall.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct IsothermalWall {
    /// The temperature: a formula in x, y, z and t.
    pub temperature: Formula,
    /// The velocity with which the wall slides in its plane, relative to the mesh: a formula per axis in x, y, z and t. Default: zero.
    pub slide: Option<Vec<Formula>>,
}
