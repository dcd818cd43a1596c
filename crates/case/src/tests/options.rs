//! Options write over the file; the defaults that a case takes are listed.

use super::*;

#[test]
fn defaults_taken_are_listed_and_given_values_are_not() {
    let defaults = plane(BASE, &["solver.newton_steps=7"]).about.defaults;
    let of = |key: &str| defaults.iter().find(|(k, _)| k == key).map(|(_, value)| value.as_str());
    assert_eq!(of("flow.gas.gamma"), Some("1.4"));
    assert_eq!(of("solver.newton_tolerance"), Some("1e-8"));
    assert_eq!(of("flow.initial.uniform.density"), Some("1.0"));
    assert_eq!(of("flow.gas.gas_constant"), Some("1.0"));
    for given in ["solver.newton_steps", "flow.order", "motion.elasticity.poisson_ratio", "time.step"] {
        assert_eq!(of(given), None, "{given}");
    }
}

#[test]
fn the_case_in_full_is_a_case_without_defaults() {
    let once = plane(BASE, &["time.end=2"]);
    let twice = plane(&once.about.resolved, &[]);
    assert_eq!(once.about.resolved, twice.about.resolved);
    assert_eq!((once.flow, once.time), (twice.flow, twice.time));
    let alone = ["flow.gas.gas_constant", "flow.reference", "flow.reference.length"];
    assert!(twice.about.defaults.iter().all(|(key, _)| alone.contains(&key.as_str())));
}

/// The resolved case has its constants in the order of the alphabet, in which the first one was not known to the second.
#[test]
fn constants_may_use_others_in_any_order() {
    for set in [["constants.zulu=2", "constants.early=\"zulu/4\""], ["constants.early=\"zulu/4\"", "constants.zulu=2"]]
    {
        let once = plane(BASE, &[&set[..], &["time.end=\"early*4\""]].concat());
        let twice = plane(&once.about.resolved, &[]);
        assert_eq!((once.time.end, twice.time.end), (2.0, 2.0));
        assert_eq!(once.about.resolved, twice.about.resolved);
    }
}

#[test]
fn options_write_over_the_file() {
    let case = plane(BASE, &["flow.riemann=hllc", "time={order=1,end=2,slabs=5}", "constants.a=0.5", "mesh.order = 4"]);
    assert_eq!((case.flow.unwrap().law.riemann, case.time.slabs, case.mesh.order()), (Riemann::Hllc, 5, 4));
    let Some(Motion::Elastic { boundary, .. }) = case.motion else { panic!("elastic") };
    assert_eq!(boundary[0].as_ref().unwrap().displacement(0, &[0.0, 0.5], 1.0), [0.5, 0.0]);
    let cg = plane(BASE, &["motion.elasticity.solver=cg"]).motion;
    assert!(matches!(cg, Some(Motion::Elastic { solver: elasticity::Solver::ConjugateGradients, .. })));
    let replaced = plane(BASE, &[r#"flow.boundary={others="symmetry"}"#]).flow.unwrap();
    assert!(replaced.boundary.iter().all(|data| matches!(data.condition, Boundary::Symmetry(_))));
}

/// The key ended at the `=` in the name, and the whole table `output` was replaced.
#[test]
fn an_equals_sign_in_a_quoted_name_does_not_end_the_key() {
    let case =
        plane(BASE, &["output.every=3", r#"output.probes."p=1".at=[0.5,0.5]"#, "output.probes.'q=2'.at=[0.5,0.5]"]);
    assert_eq!(case.output.every, 3);
    let names: Vec<&str> = case.observed.probes.iter().map(|probe| &probe.name[..]).collect();
    assert_eq!(names, ["p=1", "q=2"]);
}
