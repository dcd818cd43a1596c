//! A single suspicious fact, in a run that is otherwise in order, makes its cause the likeliest.

#![allow(clippy::unwrap_used)]

use super::*;
use crate::failure::data::{
    Attempt, BadLoad, Bodies, Extreme, FlowStart, Gas, Mesh, Mismatch, Moment, Motion, Newton, OpeningMisuse, Settling,
    StructureData, Undefined,
};
use crate::openings::{Misuse, Record, Seen};

/// Newton has failed, and nothing is suspicious.
fn nothing_suspicious() -> FailureData {
    let mild = |value| Extreme { quantity: "pressure", value, cell: 7 };
    let moment = Moment { lowest: mild(0.8), steepest: mild(0.1), mismatch: None };
    FailureData {
        gave_up: GaveUp::Newton,
        attempt: Attempt { length: 0.1, slabs_done: 3, ..Attempt::default() },
        newton: Some(Newton {
            round_off: None,
            residuals: vec![1.0, 0.9, 0.8, 0.75],
            steps_allowed: 30,
            steps_used_up: true,
            unfinished_linear_solves: 0.0,
            krylov_allowed: 200,
            has_blocks: true,
            settling: None,
        }),
        mesh: Mesh { smallest_det_j: 0.9, aspect_ratio: 2.0, evenness: 0.8, ..Mesh::default() },
        gas: Some(Gas {
            at_start: moment.clone(),
            last: moment,
            waves_per_slab: 5.0,
            cell_reynolds: None,
            quadrature: [6, 6],
            mach: 0.5,
            captures_shocks: false,
            order: 4,
            is_split: false,
            kick: 0.0,
            start: FlowStart::OtherState,
            openings: Vec::new(),
            not_positive: None,
            without_value: None,
        }),
        structure: None,
        bodies: None,
    }
}

/// The first cause after `change`, and all causes.
fn first(change: impl FnOnce(&mut FailureData)) -> &'static str {
    let mut data = nothing_suspicious();
    change(&mut data);
    let causes = causes(&data);
    assert!((1..=NAMED).contains(&causes.len()), "{causes:?}");
    assert!(causes.iter().all(|cause| (UNLIKELY..=1.0).contains(&cause.likelihood)), "{causes:?}");
    causes[0].name
}

fn gas(data: &mut FailureData) -> &mut Gas {
    data.gas.as_mut().unwrap()
}

fn newton(data: &mut FailureData) -> &mut Newton {
    data.newton.as_mut().unwrap()
}

#[test]
fn a_fact_of_the_gas_names_its_cause() {
    let mismatch =
        Mismatch { boundary: "top".into(), quantity: "pressure", inside: 1.0, target_state: 10.0, size: 2.3 };
    assert_eq!(first(|_| {}), "not_resolved");
    assert_eq!(first(|e| gas(e).at_start.lowest.value = 1e-3), "near_vacuum");
    assert_eq!(first(|e| gas(e).at_start.mismatch = Some(mismatch.clone())), "boundary_condition");
    // A run that failed beside a wall at rest was told that "it asks for a temperature of 1, the gas has 1".
    let agrees = Mismatch { inside: 1.0, target_state: 1.0, size: 1e-9, ..mismatch.clone() };
    let mut data = nothing_suspicious();
    gas(&mut data).at_start.mismatch = Some(agrees);
    assert!(causes(&data).iter().all(|cause| cause.name != "boundary_condition"));
    assert_eq!(first(|e| gas(e).kick = 1.0), "impulsive_motion");
    assert_eq!(first(|e| gas(e).at_start.steepest.value = 4.0), "steep_initial_state");
    assert_eq!(first(|e| gas(e).last.steepest.value = 4.0), "not_resolved");
    assert_eq!(first(|e| gas(e).quadrature = [4, 6]), "quadrature");
    // Smaller cells were the advice for a flow in which viscosity damps all scales.
    let is_told = |reynolds: f64| {
        let mut data = nothing_suspicious();
        gas(&mut data).cell_reynolds = Some(reynolds);
        causes(&data).iter().any(|cause| cause.name == "not_resolved")
    };
    assert!(is_told(10.0) && !is_told(1e-5));
}

/// Supersonic flow through `inflow` is named as the first cause.
#[test]
fn a_misused_opening_is_named_first() {
    let seen = |misuse, share| {
        let record = Record { since: 0.5, now: Seen { boundary: 0, misuse, share, mach: 2.0 }, largest_share: share };
        OpeningMisuse { boundary: "inlet".into(), told: record.told("inlet").to_string(), record }
    };
    let mismatch =
        Mismatch { boundary: "inlet".into(), quantity: "pressure", inside: 1.0, target_state: 10.0, size: 2.3 };
    for misuse in [Misuse::Supersonic, Misuse::Subsonic] {
        assert_eq!(
            first(|e| {
                gas(e).openings = vec![seen(misuse, 1.0)];
                gas(e).at_start.mismatch = Some(mismatch.clone());
                gas(e).last.steepest.value = 4.0;
            }),
            "opening"
        );
    }
    for misuse in [Misuse::Leaving, Misuse::Backflow] {
        assert_eq!(first(|e| gas(e).openings = vec![seen(misuse, 0.3)]), "opening");
        assert_eq!(first(|e| gas(e).openings = vec![seen(misuse, 0.01)]), "not_resolved");
    }
    let mut data = nothing_suspicious();
    gas(&mut data).openings = vec![seen(Misuse::Backflow, 0.01), seen(Misuse::Supersonic, 0.5)];
    let Cause { what, remedy, .. } = &causes(&data)[0];
    assert!(what.contains("`inlet` faster than sound") && what.contains("50 % of it, since t = 0.5"), "{what}");
    assert!(remedy.contains("supersonic_inflow"), "{remedy}");
}

#[test]
fn a_fact_of_the_solver_names_its_cause() {
    assert_eq!(first(|e| newton(e).residuals = vec![1.0, 1e-2, 1e-4]), "newton_steps");
    // A residual that rises does not fall: the square of its factor was taken.
    let mut rising = nothing_suspicious();
    newton(&mut rising).residuals = vec![1.0, 0.5, 5.0];
    assert!(causes(&rising).iter().all(|cause| cause.name != "newton_steps"), "{:?}", causes(&rising));
    let stalls = |e: &mut FailureData, round_off| {
        newton(e).residuals = vec![1.0, 1e-6, 1e-9, 1e-9, 0.9e-9];
        newton(e).round_off = round_off;
    };
    assert_eq!(first(|e| stalls(e, Some(1e-10))), "tolerance");
    // A residual that stagnates far above its rounding has another cause.
    assert_ne!(first(|e| stalls(e, Some(1e-13))), "tolerance");
    assert_ne!(first(|e| stalls(e, None)), "tolerance");
    assert_eq!(
        first(|e| {
            newton(e).unfinished_linear_solves = 1.0;
            newton(e).krylov_allowed = 5;
        }),
        "linear_solver"
    );
    // Another preconditioner was not named.
    let mut cut_short = nothing_suspicious();
    let newton = cut_short.newton.as_mut().unwrap();
    (newton.unfinished_linear_solves, newton.has_blocks) = (1.0, false);
    let causes = causes(&cut_short);
    let remedy = &causes.iter().find(|cause| cause.name == "linear_solver").unwrap().remedy;
    assert!(remedy.contains("`solver.preconditioner = \"blocks\"`"), "{remedy}");
    assert_eq!(first(|e| gas(e).waves_per_slab = 1e5), "time_step");
}

#[test]
fn a_fact_of_a_body_names_its_cause() {
    let of =
        |travel, added_mass| first(|e| e.bodies = Some(Bodies { travel, added_mass, unheld: None, inverted: None }));
    assert_eq!(of(0.01, 0.1), "not_resolved");
    assert_eq!(of(3.0, 0.1), "body_far_in_one_slab");
    assert_eq!(of(0.01, 300.0), "light_body");
    let crushed = Bodies { travel: 0.01, added_mass: 300.0, unheld: None, inverted: Some(-2e-3) };
    assert_eq!(first(|e| e.bodies = Some(crushed)), "crushed_structure");
    let unheld = Some(["nothing holds it".to_owned(), "a spring".to_owned()]);
    for gave_up in [GaveUp::Newton, GaveUp::InvertedCell, GaveUp::Other] {
        let bodies = Some(Bodies { travel: 3.0, added_mass: 1e-4, unheld: unheld.clone(), inverted: None });
        assert_eq!(first(|e| (e.gave_up, e.bodies) = (gave_up, bodies)), "unheld_body");
    }
    // Nobody can look at a motion that the flow decides.
    let mut data = nothing_suspicious();
    data.gave_up = GaveUp::InvertedCell;
    data.mesh.motion = Motion::Elastic;
    data.bodies = Some(Bodies { travel: 0.01, added_mass: 0.1, unheld: None, inverted: None });
    assert!(causes(&data).iter().all(|cause| !cause.remedy.contains("stsolve motion")), "{:?}", causes(&data));
    data.mesh.motion = Motion::Prescribed;
    assert_eq!(causes(&data)[0].name, "folding_weights");
}

#[test]
fn a_fact_of_the_mesh_names_its_cause() {
    let moves = |e: &mut FailureData, motion, gave_up| (e.mesh.motion, e.gave_up) = (motion, gave_up);
    assert_eq!(
        first(|e| {
            moves(e, Motion::Elastic, GaveUp::Newton);
            e.mesh.smallest_det_j = 1e-3;
        }),
        "nearly_inverted"
    );
    assert_eq!(first(|e| moves(e, Motion::Elastic, GaveUp::InvertedCell)), "deformation");
    assert_eq!(
        first(|e| {
            moves(e, Motion::Graded, GaveUp::Equilibrium);
            e.mesh.travel = 20.0;
        }),
        "far_in_one_slab"
    );
    let mut data = nothing_suspicious();
    // Bodies move the mesh: no displacement is prescribed.
    moves(&mut data, Motion::Elastic, GaveUp::InvertedCell);
    for travel in [0.0, 0.00133] {
        data.mesh.travel = travel;
        assert!(causes(&data).iter().all(|cause| cause.name != "far_in_one_slab"), "{travel}");
    }
    let mut data = nothing_suspicious();
    moves(&mut data, Motion::Prescribed, GaveUp::InvertedCell);
    assert_eq!(causes(&data)[0].name, "folding_formula");
}

/// det J is NaN, or round-off, and does not indicate folds.
#[test]
fn a_motion_without_a_value_or_too_far_away_is_no_fold() {
    let moved = |motion, change: fn(&mut Mesh)| {
        let mut data = FailureData { gave_up: GaveUp::InvertedCell, ..nothing_suspicious() };
        data.mesh.motion = motion;
        change(&mut data.mesh);
        causes(&data)[0].clone()
    };
    for motion in [Motion::Prescribed, Motion::Graded] {
        let cause = moved(motion, |mesh| mesh.undefined = Some(Undefined { time: 0.25, position: vec![1.0, 2.0] }));
        assert_eq!(cause.name, "undefined_motion");
        assert!(cause.what.contains("[1.0, 2.0]") && cause.what.contains("t = 0.25"), "{}", cause.what);
        assert_eq!(moved(motion, |mesh| mesh.reach = 1e20).name, "far_away");
        assert_ne!(moved(motion, |mesh| mesh.reach = 1e3).name, "far_away");
    }
}

/// A remedy already in use is not suggested, and a tolerance chosen in the case is named.
#[test]
fn a_neo_hookean_mesh_is_not_told_to_be_neo_hookean() {
    let deformation = |change: fn(&mut Mesh)| {
        let mut data = nothing_suspicious();
        (data.mesh.motion, data.gave_up) = (Motion::Elastic, GaveUp::Equilibrium);
        change(&mut data.mesh);
        let cause = causes(&data).into_iter().find(|cause| cause.name == "deformation").unwrap();
        (cause.what, cause.remedy)
    };
    let (what, remedy) = deformation(|_| {});
    assert!(!what.contains("tolerance"), "{what}");
    assert!(remedy.contains("neo_hookean") && remedy.contains("stsolve motion"), "{remedy}");
    let (what, remedy) = deformation(|mesh| (mesh.tolerance, mesh.alone) = (Some(1e-3), true));
    assert!(what.contains("0.001 distances of nodes (`motion.elasticity.tolerance`)"), "{what}");
    assert!(!remedy.contains("neo_hookean") && !remedy.contains("stsolve motion"), "{remedy}");
    assert!(remedy.contains("motion.elasticity.stiffness"), "{remedy}");
}

/// A structure has failed, and nothing is suspicious.
fn structure(change: fn(&mut StructureData, &mut Mesh), gave_up: GaveUp) -> FailureData {
    let mut data = FailureData { gave_up, newton: None, gas: None, ..nothing_suspicious() };
    let mut structure = StructureData {
        poisson_ratio: 0.3,
        waves_per_slab: Some(10.0),
        is_nonlinear: false,
        smallest_volume_ratio: 0.9,
        bad_load: None,
    };
    change(&mut structure, &mut data.mesh);
    FailureData { structure: Some(structure), ..data }
}

#[test]
fn a_fact_of_the_structure_names_its_cause() {
    let names =
        |change, gave_up| -> Vec<_> { causes(&structure(change, gave_up)).iter().map(|cause| cause.name).collect() };
    assert_eq!(names(|s, _| s.waves_per_slab = Some(1e6), GaveUp::Structure)[0], "long_slab");
    assert_eq!(
        names(|s, _| (s.is_nonlinear, s.smallest_volume_ratio) = (true, 1e-3), GaveUp::Structure)[0],
        "squeezed"
    );
    let mut at_start = structure(|s, _| s.smallest_volume_ratio = -2.0, GaveUp::Structure);
    at_start.attempt.slabs_done = 0;
    assert_eq!(causes(&at_start)[0].name, "inverted_start");
    // A limit load was told as round-off, and as a long slab where there is no inertia.
    let limit = names(|s, _| (s.is_nonlinear, s.waves_per_slab) = (true, None), GaveUp::Structure);
    assert!(limit[0] == "limit_load" && !limit.contains(&"long_slab"), "{limit:?}");
    assert_eq!(names(|_, m| m.aspect_ratio = 1e5, GaveUp::Structure)[0], "slender_cells");
    assert_eq!(names(|s, _| s.poisson_ratio = 0.499_999, GaveUp::Structure)[0], "nearly_incompressible");
    let load = |s: &mut StructureData, _: &mut Mesh| s.bad_load = Some(BadLoad { time: 0.5, position: vec![1.0, 0.0] });
    assert_eq!(names(load, GaveUp::Load), ["bad_load"]);
}

#[test]
fn of_other_failures_no_cause_is_made_up() {
    let data = FailureData { gave_up: GaveUp::Other, ..nothing_suspicious() };
    assert_eq!(causes(&data), []);
}

#[test]
fn numbers_are_rounded_in_sentences() {
    for (value, text) in [(0.0, "0"), (774.93, "775"), (1.5e-7, "1.5e-7"), (-0.125, "-0.125"), (2.5e6, "2.5e6")] {
        assert_eq!(number(value), text);
    }
}

/// Only a march in time can decide; its result precedes guesses.
#[test]
fn a_flow_that_does_not_settle_is_called_unsteady() {
    let settling = |late: f64, calms_down| {
        let is_unsteady = late >= 0.5;
        Settling { early: 0.5, late, duration: 8.0, calms_down, is_unsteady }
    };
    let with = |settling| {
        first(|e| {
            e.attempt.steady = true;
            newton(e).steps_used_up = false;
            newton(e).settling = Some(settling);
        })
    };
    assert_eq!(with(settling(0.6, false)), "unsteady_flow");
    assert_eq!(with(settling(0.45, false)), "slow_settling");
    assert_ne!(first(|e| e.attempt.steady = true), "unsteady_flow");
    assert_ne!(with(settling(0.01, true)), "unsteady_flow");
}

/// A transonic steady start once named a boundary condition, and advised the steady start that had just failed.
#[test]
fn a_transonic_flow_without_shock_capturing_is_told_to_capture_shocks() {
    let mismatch =
        Mismatch { boundary: "wall".into(), quantity: "velocity along x", inside: 0.8, target_state: 0.0, size: 0.8 };
    let transonic = |steady, mach, captures_shocks| {
        let mut data = nothing_suspicious();
        data.attempt.steady = steady;
        data.mesh.motion = Motion::Elastic;
        data.mesh.smallest_det_j = 1.0;
        let start = if steady { FlowStart::SteadyFlow } else { FlowStart::OtherState };
        *gas(&mut data) = Gas { mach, captures_shocks, start, ..gas(&mut data).clone() };
        gas(&mut data).at_start.mismatch = Some(mismatch.clone());
        causes(&data)
    };
    assert_eq!(transonic(true, 0.8, false)[0].name, "shock");
    assert_eq!(transonic(false, 1.3, false)[0].name, "shock");
    for (steady, mach, captures) in [(true, 0.8, true), (true, 0.3, false), (false, 0.8, false), (false, 1.3, true)] {
        let causes = transonic(steady, mach, captures);
        assert!(causes.iter().all(|cause| cause.name != "shock"), "{causes:?}");
        let tells = |part: &str| causes.iter().any(|cause| cause.remedy.contains(part));
        assert_eq!(tells("`solver.steady = {}`"), !steady, "{causes:?}");
        assert_eq!(tells("needs `flow.shock_capturing`"), !captures, "{causes:?}");
        assert_eq!(tells("`flow.order = 2` for a very strong shock"), captures, "{causes:?}");
        assert!(causes.iter().all(|cause| !cause.what.contains("down to 1")), "{causes:?}");
    }
}

/// The first cause of a sudden transonic start was a shock, and its remedy did not name the steady start, which was all that it took.
#[test]
fn a_sudden_start_from_a_uniform_stream_is_told_first_to_start_from_the_steady_flow() {
    let remedy = |start, slabs_done, steady| {
        let mut data = nothing_suspicious();
        data.attempt = Attempt { slabs_done, steady, ..data.attempt };
        (gas(&mut data).mach, gas(&mut data).start) = (2.0, start);
        let cause = causes(&data)[0].clone();
        assert_eq!(cause.name, "shock");
        cause.remedy
    };
    assert!(
        remedy(FlowStart::UniformStream, 1, false).starts_with("start from the steady flow (`solver.steady = {}`)")
    );
    for (start, slabs_done, steady) in [
        (FlowStart::SteadyFlow, 0, true),
        (FlowStart::SteadyFlow, 1, false),
        (FlowStart::OtherState, 1, false),
        (FlowStart::UniformStream, 500, false),
    ] {
        let remedy = remedy(start, slabs_done, steady);
        assert!(!remedy.contains("steady") && remedy.contains("[flow.shock_capturing]"), "{remedy}");
    }
}

#[test]
fn what_is_unlikely_is_not_named() {
    let names: Vec<_> = causes(&nothing_suspicious()).iter().map(|cause| cause.name).collect();
    assert_eq!(names, ["not_resolved", "time_step"]);
}
