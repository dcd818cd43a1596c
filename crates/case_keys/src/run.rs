//! `[time]`, `[restart]` and `[output]`

use super::Axis;
use super::formula::Formula;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// The time to cover, slab by slab: give `step` or `slabs`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Time {
    /// N_t, the nodes in time of a slab, 1 to 16: order of accuracy 2 N_t - 1 at the end of a slab, less with boundary values that change in time.
    /// The force of gas that accelerates with its walls has order N_t there.
    pub order: usize,
    /// The start. With `[restart]` the run goes on from where the other one stands; only its slabs count from here.
    #[serde(default)]
    pub start: f64,
    /// The end. It may equal the start, if only the steady flow is wanted.
    pub end: f64,
    /// The length of a slab. The last slab may be shorter. With `adaptive`, the length of the first; after a
    /// restart the first may be shorter.
    pub step: Option<f64>,
    /// Instead of the step: the number of slabs, all of the same length, from the start to the end. A run with `[restart]` makes those that are left.
    /// `--set time.step` replaces it, and the other way round.
    pub slabs: Option<usize>,
    /// Adapts the length of the slabs to the changes of the flow; only together with `[flow]`. Default: all slabs have the same length.
    pub adaptive: Option<Adaptive>,
}

/// Slabs as long as the jump of the flow from slab to slab allows. The jump is of order N_t, like the error inside the slab; the
/// error at its end is much smaller.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Adaptive {
    /// The target of the jump: its L2 norm over the domain, every component in units of its scale, divided by the power D/2 of the length
    /// from which scales of time follow. With `flow.reference` the scales are rho U / c of the density, rho U of the momentum and rho c U / (gamma - 1)
    /// of the energy. The jumps of the velocities of bodies and structures count with their masses, in units of the
    /// reference density and speed. A run with fixed slabs that are short enough has jumps of the right size in the column `jump` of history.csv:
    /// 0.004 to 0.007 in the middle of `naca0012_wave` and `naca0012_heave`.
    pub tolerance: f64,
    /// The shortest slab, which is accepted with any jump. Default: a thousandth of the step.
    pub smallest: Option<f64>,
    /// The longest slab. A slab sees motions, boundary values and sources at a few times only: choose `largest` shorter than an event that begins
    /// after a rest. Default: as long as the run.
    pub largest: Option<f64>,
}

/// A run that starts from the result of another one, with the same mesh at rest and the same gas unless `allow` names
/// them. The orders of the flow and in time,
/// slabs and solver may differ. Flow, mesh and its motion, time, sums and history are carried over; mass, momentum and energy are
/// kept. Another mesh, another gas and a motion that jumps are errors unless `allow` names them. Sources, boundary conditions,
/// the rotation of the frame, masses and springs of bodies and the material of a structure may change: the run goes on with the new ones.
/// Only a flow can start so, with or without a structure beside it: a structure or a mesh alone cannot.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Restart {
    /// The result file of the other run, or its directory, relative to the case file. It is continued after its last checkpoint.
    /// If that is its steady start, and the steady flow of this case is another one, it is solved from there.
    pub from: PathBuf,
    /// Intended differences to the other run: `["viscosity"]` leads from the steady flow of one Reynolds number to the steady flow of
    /// the next.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub allow: Vec<AllowedChange>,
}

/// A difference that a restart may have.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum AllowedChange {
    /// `flow.gas.viscosity`.
    Viscosity,
    /// The Mach number: `flow.gas.mach` or `flow.gas.gas_constant`. Density and velocity are kept, and the pressure is shifted everywhere
    /// by the difference of the reference pressures.
    Mach,
    /// The motion of the mesh, even if its boundary jumps. It makes its way in the first slab, which `time.adaptive` does not shorten.
    Motion,
    /// The mesh and its order: a finer one for a flow that has developed on a coarse one, for instance. The flow is interpolated at the new
    /// nodes; where the other mesh does not reach, it is that of the nearest place. Neither mesh may have moved by then, and there may be no
    /// structure. Boundaries have the same names in the same order. Averages and distributions begin anew, and so do the balances of mass and energy.
    Mesh,
}

/// The output.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Output {
    /// The directory, relative to the case file. Default: `runs/<case name>` in the working directory.
    pub directory: Option<PathBuf>,
    /// The number of slabs between checkpoints, from which a run can be resumed. A checkpoint is also written at the end. Each one copies
    /// the whole result file. Default: 10 or more slabs, so many that the run goes on for 20 times as long as a checkpoint takes. The results do not
    /// depend on it.
    pub checkpoint_every: Option<usize>,
    /// The number of slabs between outputs of the fields. They are also written at the start and the end, and where a run stops early.
    pub every: usize,
    /// The fields for display. The exact coefficients are always written.
    pub fields: Vec<Field>,
    /// Distributions of pressure, friction and heat along walls, in files surface_NAME.csv and surface_NAME.vtkhdf.
    pub surfaces: Option<Surfaces>,
    /// Averages over time at the points of the mesh, which go to the result with the other fields.
    pub averages: Option<Averages>,
    /// Integrals over the flow that go to history.csv after every slab, by a fine rule on the curved cells. With a collocated `flow.quadrature`
    /// the scheme conserves sums of its own points, so the momentum here drifts by the error of that rule.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub integrals: Vec<Integral>,
    /// Points whose fields go to history.csv after every slab, by name.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub probes: BTreeMap<String, Probe>,
    /// Straight lines whose fields go to files line_NAME.csv, by name.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub lines: BTreeMap<String, Line>,
    /// Planes through a three-dimensional mesh whose fields go to files for ParaView, slice_NAME.pvd, by name.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub slices: BTreeMap<String, Slice>,
    /// Fields by formulas, by name: in position, time and the fields of the flow, such as `"pressure / density^1.4"`. They are written with all
    /// other fields: to the result, for points, lines and slices.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub formulas: BTreeMap<String, Formula>,
}

/// Distributions along walls: pressure, friction, heat, and their coefficients.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Surfaces {
    /// The walls, by name.
    pub walls: Vec<String>,
    /// The number of slabs between two distributions; that of a steady start comes first. Default: only the one at the end of the run.
    pub every: Option<usize>,
}

/// Averages over time of the flow at the points of the mesh: with a mesh that moves, they follow these points.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Averages {
    /// The time at which they begin. It may be inside a slab. A run that ends before has no averages.
    pub from: Formula,
    /// The time at which they end. Default: the end of the run.
    pub to: Option<Formula>,
    /// The length of a period, counted from `from`, for averages over phases of it.
    pub period: Option<Formula>,
    /// The number of equal phases in a period. Their averages go to phases.vtkhdf.
    pub phases: Option<usize>,
    /// Directions along which they are averaged, too, such as `["z"]` for a span. These means go to averages_along.csv, and from three
    /// dimensions to the plane to averages_along.vtkhdf. The cells must be extruded along them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub along: Vec<Axis>,
    /// The averages.
    #[serde(default = "usual_averages")]
    pub fields: Vec<Average>,
}

/// An average over time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Average {
    /// The mean density, field `mean_density`.
    Density,
    /// The mean velocity of the gas, `mean_velocity`.
    Velocity,
    /// The mean pressure, `mean_pressure`.
    Pressure,
    /// The mean temperature, `mean_temperature`.
    Temperature,
    /// The mean momentum per volume, `mean_momentum`. Over the mean density it is the velocity averaged by mass.
    Momentum,
    /// The means of the products of velocity fluctuations, `reynolds_stress_xx`, `_xy`, ...
    ReynoldsStress,
    /// The root mean square of the fluctuation of the density, `rms_density`.
    RmsDensity,
    /// That of the pressure, `rms_pressure`.
    RmsPressure,
    /// That of the temperature, `rms_temperature`.
    RmsTemperature,
    /// The terms of the budget of the kinetic energy of fluctuations: `production`, `dissipation`, `pressure_dilatation`, and the fluxes
    /// `turbulent_flux`, `pressure_flux` and `viscous_flux`.
    KineticEnergyBudget,
}

fn usual_averages() -> Vec<Average> {
    vec![Average::Density, Average::Velocity, Average::Pressure, Average::ReynoldsStress, Average::RmsPressure]
}

/// An integral over the flow.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Integral {
    /// The kinetic energy, int rho v.v / 2 dx.
    KineticEnergy,
    /// The enstrophy, int rho w.w / 2 dx of the vorticity w.
    Enstrophy,
    /// The entropy, int rho ln(p / rho^gamma) dx.
    Entropy,
    /// The momentum along x, int rho v_x dx.
    MomentumX,
    /// The momentum along y.
    MomentumY,
    /// The momentum along z; zero in two dimensions.
    MomentumZ,
}

/// A point at which the flow is observed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Probe {
    /// Its position, that at rest if the mesh carries it.
    pub at: Vec<f64>,
    /// Whether it moves with the mesh. Otherwise it is fixed in space, and has no value where the mesh has left it.
    #[serde(default)]
    pub carried: bool,
    /// Its fields; without this key density, velocity and pressure.
    #[serde(default = "observed", skip_serializing_if = "is_observed")]
    pub fields: Vec<Field>,
}

/// A straight line along which the flow is observed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Line {
    /// Its start, that at rest if the mesh carries it.
    pub from: Vec<f64>,
    /// Its end.
    pub to: Vec<f64>,
    /// The number of points, at equal distances, with both ends; 2 to 100000.
    #[serde(default = "points_of_a_line")]
    pub points: usize,
    /// The number of slabs between outputs. The start and the end are also written.
    #[serde(default = "every_slab")]
    pub every: usize,
    /// Whether its points move with the mesh. Otherwise they are fixed in space, and have no value where there is no mesh.
    #[serde(default)]
    pub carried: bool,
    /// Its fields.
    #[serde(default = "observed")]
    pub fields: Vec<Field>,
}

/// A plane through a three-dimensional mesh.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Slice {
    /// A point of the plane.
    pub point: Vec<f64>,
    /// Its normal, of any length.
    pub normal: Vec<f64>,
    /// The number of slabs between outputs. The start and the end are also written.
    #[serde(default = "every_slab")]
    pub every: usize,
    /// The number of parts into which each edge of a cell is divided, 1 to 32. Default: one less than the nodes of the flow.
    pub parts: Option<usize>,
    /// Whether a table of its points is written too, slab_NNNNNN.csv beside each file for ParaView.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub csv: bool,
    /// Its fields.
    #[serde(default = "observed")]
    pub fields: Vec<Field>,
}

fn points_of_a_line() -> usize {
    101
}

fn every_slab() -> usize {
    1
}

fn observed() -> Vec<Field> {
    vec![Field::Density, Field::Velocity, Field::Pressure]
}

fn is_observed(fields: &[Field]) -> bool {
    fields == observed()
}

impl Default for Output {
    fn default() -> Self {
        let fields = vec![Field::Density, Field::Velocity, Field::Pressure, Field::Mach];
        Output {
            directory: None,
            checkpoint_every: None,
            every: 1,
            fields,
            surfaces: None,
            averages: None,
            integrals: Vec::new(),
            probes: BTreeMap::new(),
            lines: BTreeMap::new(),
            slices: BTreeMap::new(),
            formulas: BTreeMap::new(),
        }
    }
}

/// A field for display.
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
    /// The pressure coefficient, (p - p_ref) / (rho_ref U_ref^2 / 2), of `flow.reference`.
    PressureCoefficient,
    /// The total pressure by the velocity in the frame of the case.
    TotalPressure,
    /// The total temperature by the velocity in the frame of the case.
    TotalTemperature,
    /// The entropy ln(p / rho^gamma), in units of the specific heat at constant volume.
    Entropy,
    /// The curl of the velocity.
    Vorticity,
    /// The Q criterion: half the difference of the squared rates of rotation and of strain, positive in vortices.
    QCriterion,
    /// The velocity of the mesh.
    MeshVelocity,
    /// det J of the motion of the mesh.
    Jacobian,
    /// The displacement of the mesh, and of a structure.
    Displacement,
    /// The von Mises stress of a structure.
    VonMises,
    /// The principal stresses of a structure, the largest first.
    PrincipalStress,
}
