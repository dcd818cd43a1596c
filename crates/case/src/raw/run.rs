//! `[time]`, `[restart]` and `[output]`

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// The time to cover, slab by slab: give `step` or `slabs`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Time {
    /// N_t, the nodes in time of a slab, 1 to 16: order of accuracy 2 N_t - 1 at the end of a slab.
    pub order: usize,
    /// The start.
    #[serde(default)]
    pub start: f64,
    /// The end. The start itself, if the steady flow is all that is wanted.
    pub end: f64,
    /// The length of a slab. The last one may be shorter. With `adaptive`, the length of the first.
    pub step: Option<f64>,
    /// Instead of the step: the number of slabs, all of the same length.
    pub slabs: Option<usize>,
    /// Adapts the length of the slabs of a flow to what happens in it. Default: all are of the same length.
    pub adaptive: Option<Adaptive>,
}

/// Slabs as long as the jump of the flow from slab to slab allows. The jump is of order N_t, an error inside of the slab; at its end
/// the error is much smaller.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Adaptive {
    /// The jump to aim at: its L2 norm over the domain, every component in units of `flow.reference`.
    pub tolerance: f64,
    /// The shortest slab, which is taken whatever its jump. Default: a thousandth of the step.
    pub smallest: Option<f64>,
    /// The longest slab. Default: as long as the run.
    pub largest: Option<f64>,
}

/// A run that starts where another one stands, with the same mesh at rest and the same gas. The orders of the flow and in time, slabs
/// and solver may differ: flow, mesh and its motion, time, sums and history are carried over, mass, momentum and energy kept. Other
/// differences are errors unless `allow` names them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Restart {
    /// The result file of the other run, or its directory, relative to the case file. It is continued after its last checkpoint.
    /// If that is its steady start, the steady flow is found anew from there.
    pub from: PathBuf,
    /// What may differ from the other run, on purpose: `["viscosity"]` leads from the steady flow of one Reynolds number to that of the
    /// next.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub allow: Vec<AllowedChange>,
}

/// What a restart may change.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum AllowedChange {
    /// `flow.gas.viscosity`.
    Viscosity,
    /// The Mach number: `flow.gas.mach` or `flow.gas.gas_constant`. Density and velocity are kept, and the pressure is shifted everywhere
    /// by the difference of the reference pressures.
    Mach,
    /// The motion of the mesh, even if its boundary jumps.
    Motion,
}

/// What is written, and where.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Output {
    /// The directory, relative to the case file. Default: `runs/<case name>` where the program is started.
    pub directory: Option<PathBuf>,
    /// A checkpoint, from which a run can be resumed, is written after every so many slabs, and at the end.
    pub checkpoint_every: usize,
    /// The fields are written after every so many slabs, and at the start and the end.
    pub every: usize,
    /// The fields for drawing. The exact coefficients are always written.
    pub fields: Vec<Field>,
}

impl Default for Output {
    fn default() -> Self {
        let fields = vec![Field::Density, Field::Velocity, Field::Pressure, Field::Mach];
        Output { directory: None, checkpoint_every: 10, every: 1, fields }
    }
}

/// A field for drawing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Field {
    /// The density.
    Density,
    /// The velocity of the gas.
    Velocity,
    /// The pressure.
    Pressure,
    /// The temperature.
    Temperature,
    /// The Mach number.
    Mach,
    /// The curl of the velocity.
    Vorticity,
    /// The velocity of the mesh.
    MeshVelocity,
    /// det J of the motion of the mesh.
    Jacobian,
}
