//! `summary.json`: the figures of a run for scripts and tests. An absent key means that it does not apply.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::cost::{Cost, Machine};
use crate::directory::RunDirectory;
use crate::error::OutputError;
use crate::files::{file_error, write_atomically};

/// Name of the summary in the run directory.
pub const SUMMARY_FILE: &str = "summary.json";

/// The figures of a run.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Summary {
    /// Name of the case.
    pub case: String,
    /// Version of the program.
    pub version: String,
    /// Whether the end time was reached.
    pub completed: bool,
    /// Why the run ended before its end time.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// Size of the mesh.
    pub mesh: MeshSize,
    /// Number of unknowns of a slab.
    pub unknowns: Unknowns,
    /// Slabs done.
    pub slabs: u64,
    /// Slabs that were repeated with a smaller step.
    pub rejected_slabs: u64,
    /// The thickness of the boundary layer that the initial state was given at walls, if it was.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub start_layer: Option<f64>,
    /// The time from which the flow is solved in a split form, if a slab could not be solved without.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub split_form_since: Option<f64>,
    /// Time reached.
    pub time: f64,
    /// Newton steps.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub newton: Option<Newton>,
    /// Krylov iterations.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub krylov: Option<Krylov>,
    /// Quality of the moving mesh over the run.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mesh_quality: Option<MeshQuality>,
    /// Errors of conserved quantities.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub conservation: Option<Conservation>,
    /// Distance to the exact solution at the end.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<ErrorNorms>,
    /// The steady flow from which the run starts.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub steady: Option<Steady>,
    /// Frequencies and energy of a structure.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub structure: Option<StructureSummary>,
    /// Forces on the walls, by name.
    #[serde(skip_serializing_if = "BTreeMap::is_empty", default)]
    pub walls: BTreeMap<String, Wall>,
    /// Rigid bodies that the flow moves, by name.
    #[serde(skip_serializing_if = "BTreeMap::is_empty", default)]
    pub bodies: BTreeMap<String, Body>,
    /// Mass flow and warnings of inflows and outflows, by name.
    #[serde(skip_serializing_if = "BTreeMap::is_empty", default)]
    pub openings: BTreeMap<String, Opening>,
    /// The machine.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub machine: Option<Machine>,
    /// The cost of the run.
    pub cost: Cost,
}

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

/// Frequencies and energy of a structure.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StructureSummary {
    /// Natural frequencies, periods per unit of time, in increasing order.
    pub natural_frequencies: Vec<f64>,
    /// Kinetic and strain energy at the start.
    pub energy_at_start: f64,
    /// Kinetic and strain energy at the end.
    pub energy: f64,
    /// Work of body force and tractions.
    pub load_work: f64,
    /// Work done by boundaries with a prescribed displacement.
    pub support_work: f64,
    /// Energy lost in the jumps between slabs.
    pub dissipation: f64,
    /// Imbalance of the energy: the part of its change that work and dissipation do not explain.
    pub energy_error: f64,
    /// Iterations of the linear solvers over the run.
    pub iterations: u64,
}

/// A rigid body.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Body {
    /// The displacement along each axis.
    pub displacement: Vec<f64>,
    /// The angle of rotation in radians.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rotation: Option<f64>,
    /// Its rotation vector, where it turns about several axes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rotation_vector: Option<Vec<f64>>,
    /// Its velocity.
    pub velocity: Vec<f64>,
    /// Its angular velocity.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub angular_velocity: Option<f64>,
    /// The vector of its angular velocity, where it turns about several axes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub angular_velocity_vector: Option<Vec<f64>>,
    /// The amplitude of the coordinate that oscillates most, over the last ten periods at most.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub amplitude: Option<f64>,
    /// Its frequency.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub frequency: Option<f64>,
    /// Every coordinate: "x", "y", "z", "rotation", "rotation_x" ... of a rigid body, the displacements of the observed points of a
    /// structure.
    pub coordinates: BTreeMap<String, Oscillation>,
    /// The work of the flow on it.
    pub work: f64,
    /// Its kinetic energy.
    pub kinetic_energy: f64,
    /// The energy in the springs of a rigid body.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub spring_energy: Option<f64>,
    /// The energy of the strain of a structure.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub strain_energy: Option<f64>,
    /// The work of the drives of prescribed coordinates.
    pub drive_work: f64,
    /// The work of the outer force.
    pub force_work: f64,
    /// The energy dissipated by its dampers.
    pub damped: f64,
    /// The energy dissipated by the time integration.
    pub numerical_dissipation: f64,
}

/// The oscillation of a coordinate.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Oscillation {
    /// Half of the distance between turning points.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub amplitude: Option<f64>,
    /// Periods per time.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub frequency: Option<f64>,
}

/// The mass flow through an inflow or outflow, and observed flow that its condition is not made for.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Opening {
    /// The mass that leaves the domain per time, at the end.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mass_flow: Option<f64>,
    /// Gas that entered a subsonic inflow faster than sound.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub supersonic: Option<Misused>,
    /// Gas that left through an inflow.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub leaving: Option<Misused>,
    /// Gas that came back through an outflow.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub backflow: Option<Misused>,
    /// Subsonic gas at a supersonic inflow.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub subsonic: Option<Misused>,
}

/// An observation of flow that a condition is not made for.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Misused {
    /// The time of the first observation.
    pub since: f64,
    /// The fraction of the area of the boundary, at the end.
    pub share: f64,
    /// The largest fraction over the run.
    pub largest_share: f64,
}

/// Impulse, work and heat that a wall received over the run.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Wall {
    /// Time integral of the force, one entry per direction.
    pub impulse: Vec<f64>,
    /// Its part due to pressure.
    pub pressure_impulse: Vec<f64>,
    /// Its part due to friction.
    pub friction_impulse: Vec<f64>,
    /// Time integral of the moment, one entry per axis of rotation: one in two dimensions, three in three.
    pub moment_impulse: Vec<f64>,
    /// Work of the force on the wall.
    pub work: f64,
    /// Heat that the wall takes up by conduction.
    pub heat: f64,
    /// Drag coefficient at the end.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub drag_coefficient: Option<f64>,
    /// Lift coefficient at the end.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lift_coefficient: Option<f64>,
    /// Moment coefficient at the end.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub moment_coefficient: Option<f64>,
}

/// The steady flow from which a run starts.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Steady {
    /// Newton steps.
    pub newton: u64,
    /// Krylov iterations.
    pub krylov: u64,
    /// The residual, relative to the residual of the initial state.
    pub residual: f64,
    /// The residual at the next higher order, relative to its inertial terms.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub next_order_residual: Option<f64>,
    /// The result of a march in time from the steady flow, if there was one.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub stability: Option<SteadyStability>,
    /// The coefficients of the walls, by name.
    #[serde(skip_serializing_if = "BTreeMap::is_empty", default)]
    pub walls: BTreeMap<String, SteadyWall>,
}

/// A march in time from a steady flow that was disturbed slightly.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SteadyStability {
    /// The factor by which the rate of change has grown.
    pub growth: f64,
    /// The time marched.
    pub duration: f64,
    /// Whether every slab could be solved.
    pub completed: bool,
    /// Whether the steady flow is unstable.
    pub unstable: bool,
}

/// The coefficients of a wall in steady flow.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SteadyWall {
    /// Drag coefficient.
    pub drag_coefficient: f64,
    /// Lift coefficient.
    pub lift_coefficient: f64,
    /// Moment coefficient.
    pub moment_coefficient: f64,
}

impl Summary {
    /// Writes `summary.json`; an older file is replaced as a whole.
    ///
    /// # Errors
    /// [`OutputError::File`] if the system refuses.
    pub fn write(&self, directory: &RunDirectory) -> Result<(), OutputError> {
        let path = directory.path().join(SUMMARY_FILE);
        let text = serde_json::to_string_pretty(self).map_err(|error| file_error(&path, error.into()))?;
        write_atomically(&path, (text + "\n").as_bytes())
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use serde_json::{Value, json};

    fn full() -> Summary {
        Summary {
            case: "box".to_owned(),
            version: "0.1.0".to_owned(),
            completed: false,
            reason: Some("stopped by a signal".to_owned()),
            mesh: MeshSize { dimension: 2, cells: 16, order: 4 },
            unknowns: Unknowns { flow: Some(2048), mesh: Some(676), structure: Some(980) },
            slabs: 3,
            rejected_slabs: 1,
            start_layer: Some(0.02),
            split_form_since: Some(0.1),
            time: 0.3,
            newton: Some(Newton { total: 9, max: 4, per_slab: 3.0 }),
            krylov: Some(Krylov { total: 81, max_per_newton: 12, mean_per_newton: 9.0, elasticity_total: Some(40) }),
            mesh_quality: Some(MeshQuality {
                det_j_lower_bound: Some(0.5),
                det_j_sampled_min: Some(0.6),
                scaled_jacobian_min: Some(0.7),
                first_invalid_time: Some(1.5),
                first_invalid_time_sampled: Some(1.75),
            }),
            conservation: Some(Conservation {
                mass_error: Some(1e-15),
                energy_error: Some(3e-15),
                coupled_energy_error: None,
                free_stream_error: Some(2e-14),
            }),
            error: Some(ErrorNorms {
                density_l2: Some(1e-3),
                momentum_l2: Some(2e-3),
                energy_l2: Some(3e-3),
                displacement_max: Some(1e-12),
            }),
            steady: Some(Steady {
                newton: 12,
                krylov: 300,
                residual: 1e-10,
                next_order_residual: Some(2e-3),
                stability: Some(SteadyStability { growth: 1.5, duration: 8.0, completed: true, unstable: false }),
                walls: BTreeMap::from([(
                    "foil".to_owned(),
                    SteadyWall { drag_coefficient: 0.12, lift_coefficient: 0.25, moment_coefficient: 0.5 },
                )]),
            }),
            structure: Some(StructureSummary {
                natural_frequencies: vec![0.5, 1.5],
                energy_at_start: 1.0,
                energy: 1.25,
                load_work: 0.5,
                support_work: -0.125,
                dissipation: 0.125,
                energy_error: 1e-16,
                iterations: 99,
            }),
            bodies: BTreeMap::new(),
            walls: BTreeMap::from([(
                "foil".to_owned(),
                Wall {
                    impulse: vec![1.0, -2.0],
                    pressure_impulse: vec![0.75, -2.25],
                    friction_impulse: vec![0.25, 0.25],
                    moment_impulse: vec![3.0],
                    work: 0.5,
                    heat: 0.25,
                    drag_coefficient: Some(0.12),
                    lift_coefficient: Some(1.5),
                    moment_coefficient: Some(-0.5),
                },
            )]),
            openings: BTreeMap::from([(
                "outlet".to_owned(),
                Opening {
                    mass_flow: Some(0.25),
                    backflow: Some(Misused { since: 0.5, share: 0.0, largest_share: 0.125 }),
                    ..Opening::default()
                },
            )]),
            machine: Some(Machine {
                processor: Some("Fast 3000".to_owned()),
                processors: 2,
                system: "linux x86_64".to_owned(),
            }),
            cost: Cost {
                wall_seconds: 2.5,
                setup_seconds: 0.5,
                peak_memory_bytes: Some(1 << 20),
                threads: 2,
                residual_evaluations: 100,
                jacobian_products: 81,
                parts: BTreeMap::from([("product".to_owned(), crate::cost::Part { seconds: 1.5, calls: 81 })]),
            },
        }
    }

    /// Written out in full, because scripts rely on these names.
    fn contract() -> Value {
        json!({
            "case": "box", "version": "0.1.0", "completed": false, "reason": "stopped by a signal",
            "mesh": { "dimension": 2, "cells": 16, "order": 4 },
            "unknowns": { "flow": 2048, "mesh": 676, "structure": 980 },
            "slabs": 3, "rejected_slabs": 1, "start_layer": 0.02, "split_form_since": 0.1, "time": 0.3,
            "newton": { "total": 9, "max": 4, "per_slab": 3.0 },
            "krylov": { "total": 81, "max_per_newton": 12, "mean_per_newton": 9.0, "elasticity_total": 40 },
            "mesh_quality": { "det_j_lower_bound": 0.5, "det_j_sampled_min": 0.6, "scaled_jacobian_min": 0.7,
                              "first_invalid_time": 1.5, "first_invalid_time_sampled": 1.75 },
            "conservation": { "mass_error": 1e-15, "energy_error": 3e-15, "free_stream_error": 2e-14 },
            "error": { "density_l2": 1e-3, "momentum_l2": 2e-3, "energy_l2": 3e-3, "displacement_max": 1e-12 },
            "steady": { "newton": 12, "krylov": 300, "residual": 1e-10, "next_order_residual": 2e-3,
                "stability": { "growth": 1.5, "duration": 8.0, "completed": true, "unstable": false },
                "walls": { "foil": { "drag_coefficient": 0.12, "lift_coefficient": 0.25, "moment_coefficient": 0.5 } } },
            "walls": { "foil": { "impulse": [1.0, -2.0], "pressure_impulse": [0.75, -2.25],
                                 "friction_impulse": [0.25, 0.25], "moment_impulse": [3.0], "work": 0.5, "heat": 0.25,
                                 "drag_coefficient": 0.12, "lift_coefficient": 1.5, "moment_coefficient": -0.5 } },
            "openings": { "outlet": { "mass_flow": 0.25,
                                      "backflow": { "since": 0.5, "share": 0.0, "largest_share": 0.125 } } },
            "structure": { "natural_frequencies": [0.5, 1.5], "energy_at_start": 1.0, "energy": 1.25, "load_work": 0.5,
                           "support_work": -0.125, "dissipation": 0.125, "energy_error": 1e-16, "iterations": 99 },
            "machine": { "processor": "Fast 3000", "processors": 2, "system": "linux x86_64" },
            "cost": { "wall_seconds": 2.5, "setup_seconds": 0.5, "peak_memory_bytes": 1_048_576, "threads": 2,
                      "residual_evaluations": 100, "jacobian_products": 81,
                      "parts": { "product": { "seconds": 1.5, "calls": 81 } } }
        })
    }

    #[test]
    fn the_keys_are_those_of_the_contract() {
        assert_eq!(serde_json::to_value(full()).unwrap(), contract());
    }

    #[test]
    fn what_does_not_apply_is_absent() {
        let bare = serde_json::to_value(Summary::default()).unwrap();
        let keys: Vec<&str> = bare.as_object().unwrap().keys().map(String::as_str).collect();
        let always = ["case", "completed", "cost", "mesh", "rejected_slabs", "slabs", "time", "unknowns", "version"];
        assert_eq!(keys, always);
        assert!(!bare.to_string().contains("null"), "{bare}");
    }

    #[test]
    fn the_file_reads_back_and_replaces_the_older_one() {
        let directory = tempfile::tempdir().unwrap();
        let run = RunDirectory::open(directory.path()).unwrap();
        Summary::default().write(&run).unwrap();
        full().write(&run).unwrap();
        let text = std::fs::read_to_string(directory.path().join(SUMMARY_FILE)).unwrap();
        assert_eq!(serde_json::from_str::<Summary>(&text).unwrap(), full());
    }
}
