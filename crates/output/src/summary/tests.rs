//! The keys of summary.json.

#![allow(clippy::unwrap_used)]
use super::*;
use serde_json::{Value, json};

/// A summary in which every part is there.
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
        mesh_quality: Some(mesh_quality()),
        conservation: Some(conservation()),
        error: Some(error()),
        steady: Some(steady()),
        structure: Some(structure()),
        bodies: BTreeMap::new(),
        walls: BTreeMap::from([("foil".to_owned(), wall())]),
        openings: BTreeMap::from([("outlet".to_owned(), opening())]),
        machine: Some(machine()),
        cost: cost(),
    }
}

fn mesh_quality() -> MeshQuality {
    MeshQuality {
        det_j_lower_bound: Some(0.5),
        det_j_sampled_min: Some(0.6),
        scaled_jacobian_min: Some(0.7),
        first_invalid_time: Some(1.5),
        first_invalid_time_sampled: Some(1.75),
    }
}

fn conservation() -> Conservation {
    Conservation {
        mass_error: Some(1e-15),
        energy_error: Some(3e-15),
        coupled_energy_error: None,
        free_stream_error: Some(2e-14),
    }
}

fn error() -> ErrorNorms {
    ErrorNorms { density_l2: Some(1e-3), momentum_l2: Some(2e-3), energy_l2: Some(3e-3), displacement_max: Some(1e-12) }
}

fn steady() -> Steady {
    Steady {
        newton: 12,
        krylov: 300,
        residual: 1e-10,
        next_order_residual: Some(2e-3),
        stability: Some(SteadyStability { growth: 1.5, duration: 8.0, completed: true, unstable: false }),
        walls: BTreeMap::from([(
            "foil".to_owned(),
            SteadyWall { drag_coefficient: 0.12, lift_coefficient: 0.25, moment_coefficient: 0.5 },
        )]),
    }
}

fn structure() -> StructureSummary {
    StructureSummary {
        natural_frequencies: vec![0.5, 1.5],
        loaded_frequencies: vec![0.25, 1.375],
        least_stiffness: Some(-0.25),
        buckling_factor: Some(0.8),
        energy_at_start: 1.0,
        energy: 1.25,
        load_work: 0.5,
        support_work: -0.125,
        dissipation: 0.125,
        energy_error: 1e-16,
        iterations: 99,
    }
}

fn wall() -> Wall {
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
    }
}

fn opening() -> Opening {
    Opening {
        mass_flow: Some(0.25),
        backflow: Some(Misused { since: 0.5, share: 0.0, largest_share: 0.125 }),
        ..Opening::default()
    }
}

fn machine() -> Machine {
    Machine { processor: Some("Fast 3000".to_owned()), processors: 2, system: "linux x86_64".to_owned() }
}

fn cost() -> Cost {
    Cost {
        wall_seconds: 2.5,
        setup_seconds: 0.5,
        peak_memory_bytes: Some(1 << 20),
        peak_memory_of_processes: vec![1 << 20, 1 << 19],
        threads: 2,
        residual_evaluations: 100,
        jacobian_products: 81,
        parts: BTreeMap::from([("product".to_owned(), crate::cost::Part { seconds: 1.5, calls: 81 })]),
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
        "structure": { "natural_frequencies": [0.5, 1.5], "loaded_frequencies": [0.25, 1.375], "least_stiffness": -0.25, "buckling_factor": 0.8, "energy_at_start": 1.0, "energy": 1.25, "load_work": 0.5,
                       "support_work": -0.125, "dissipation": 0.125, "energy_error": 1e-16, "iterations": 99 },
        "machine": { "processor": "Fast 3000", "processors": 2, "system": "linux x86_64" },
        "cost": { "wall_seconds": 2.5, "setup_seconds": 0.5, "peak_memory_bytes": 1_048_576,
            "peak_memory_of_processes": [1_048_576, 524_288], "threads": 2,
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
