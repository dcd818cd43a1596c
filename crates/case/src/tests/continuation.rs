//! Conditions for continuing the run of another case.

use super::*;

/// The keys of all differences that `options` make to BASE, and of those in the lasting part.
fn changed(options: &[&str]) -> (Vec<String>, Vec<String>) {
    let resolved = |options: &[&str]| plane(BASE, options).about;
    let (before, now) = (resolved(&[]), resolved(options));
    let Differences { all, lasting, .. } = differences(&before.resolved, &now.resolved).unwrap();
    assert_eq!(lasting.is_empty(), before.lasting == now.lasting, "{options:?}");
    let keys = |differences: Vec<Difference>| differences.into_iter().map(|difference| difference.key).collect();
    (keys(all), keys(lasting))
}

#[test]
fn how_closely_and_how_far_may_change() {
    for option in [
        "title=longer",
        "time.end=5",
        "output.every=3",
        "output.checkpoint_every=1",
        "solver.newton_tolerance=1e-9",
        "solver.newton_absolute_tolerance=1e-11",
        "solver.newton_steps=7",
        "solver.krylov_tolerance=1e-4",
        "solver.krylov_iterations=20",
        "solver.krylov_restart=20",
        "solver.jacobian=finite_difference",
        "solver.predictor=constant",
        "solver.pseudo_time.initial_inverse=1",
        "solver.slab_halvings=1",
    ] {
        let key = option.split_once('=').unwrap().0.to_owned();
        assert_eq!(changed(&[option]), (vec![key], vec![]), "{option}");
    }
    assert_eq!(changed(&["time={order=2,end=1.5,slabs=5}"]).1, [""; 0], "slabs of the same length");
    // 2.7 / 9 is not 0.3 to the bit, and the run was refused.
    assert_eq!(changed(&["time={order=2,end=2.7,slabs=9}"]).1, [""; 0], "slabs of the same length to round-off");
}

/// A run was refused that differed in such a constant.
#[test]
fn constants_of_the_end_alone_may_change() {
    let text = BASE.replace("b = \"2*a\"", "periods = 2").replace("end = 1", "end = \"0.6*periods\"");
    let [before, now] = [&[][..], &["constants.periods=4"]].map(|options| plane(&text, options).about);
    assert_eq!(before.lasting, now.lasting);
    let Differences { all, lasting, .. } = differences(&before.resolved, &now.resolved).unwrap();
    assert_eq!((all.len(), lasting.len()), (2, 0), "{all:?} {lasting:?}");
}

#[test]
fn what_the_state_means_may_not() {
    for option in [
        "time.order=1",
        "time.step=0.25",
        "flow.order=5",
        "flow.riemann=hllc",
        "flow.quadrature=double",
        "flow.gas.gamma=1.3",
        "mesh.order=4",
        "constants.a=0.2",
        "motion.elasticity.poisson_ratio=0.2",
        "motion.boundary.left.displacement=[0,0]",
        "solver.steady={}",
        "time.adaptive.tolerance=1e-3",
        "output.fields=[]",
    ] {
        let (all, lasting) = changed(&[option]);
        let key = option.split_once('=').unwrap().0.trim_end_matches(".tolerance");
        assert!(all.contains(&key.to_owned()) && lasting == [key], "{option}: {all:?} {lasting:?}");
    }
}

#[test]
fn a_difference_tells_both_values() {
    let about = |options: &[&str]| plane(BASE, options).about.resolved;
    let all = |options: &[&str]| differences(&about(&[]), &about(options)).unwrap().all;
    assert_eq!(all(&["flow.order=5"])[0].to_string(), "`flow.order` was 4 and is 5");
    assert_eq!(all(&["solver.newton_tolerance=1e-9"])[0].to_string(), "`solver.newton_tolerance` was 1e-8 and is 1e-9");
    let steady = &all(&["solver.steady={}"])[0];
    assert_eq!((steady.key.as_str(), &steady.before), ("solver.steady", &None));
    assert!(steady.to_string().starts_with("`solver.steady` was not there and is {"), "{steady}");
    assert!(differences("order = 4", &about(&[])).is_err(), "a text of another version");
}

/// Long texts that differ at their ends were shown alike.
#[test]
fn long_texts_are_shown_where_they_differ() {
    let (before, now) = ("density + ".repeat(30) + "0.1*pressure", "density + ".repeat(30) + "0.2*pressure");
    let difference = Difference { key: "a".to_owned(), before: Some(before), now: Some(now) };
    let [before, now] = difference.shortened();
    assert!(
        before.starts_with("... ") && before.ends_with("0.1*pressure") && now.ends_with("0.2*pressure"),
        "{before}"
    );
    let none = Difference { before: None, ..difference };
    assert!(none.shortened()[0] == "not there" && none.shortened()[1].ends_with(" ..."));
}

/// Only the part of a table that a run has used must stay, where formulas take it at the time.
#[test]
fn a_longer_table_continues_a_shorter_one() {
    let sine = |end: i32| {
        let t: Vec<f64> = (0..=end).map(|k| 0.05 * f64::from(k)).collect();
        let values: Vec<f64> = t.iter().map(|t| t.powi(3) * (1.0 - t)).collect();
        format!("tables.way={{t={t:?},values={values:?}}}")
    };
    let lasting = |formula: &str, reached: f64| {
        let moved = format!("motion.boundary.left.displacement=[\"{formula}\",0]");
        let about = |end: i32| plane(BASE, &[&moved, &sine(end)]).about;
        let (before, now) = (about(60), about(80));
        assert_eq!(lasting_of(&before.resolved).unwrap(), before.lasting);
        let Differences { all, lasting, longer_tables } =
            differences_after(&before.resolved, &now.resolved, reached).unwrap();
        assert!(all.iter().any(|difference| difference.key == "tables.way.t"));
        (lasting.len(), longer_tables.first().map_or_else(String::new, ToString::to_string))
    };
    assert_eq!(lasting("way(t)*y*(1-y)", 1.0), (0, String::new()));
    // The message once gave the first numbers of both tables, which were the same.
    let (differ, because) = lasting("way(t)*y*(1-y)", 2.9);
    assert_ne!(differ, 0);
    assert!(because.contains("at t = 2.9 too: the table ended at t = 3, 2 points after the checkpoint"), "{because}");
    let (differ, because) = lasting("way(3*t)*y*(1-y)", 1.0);
    assert!(differ > 0 && because.contains("at more than the present time"), "{because}");
}

/// A table from a file is written out, so that a run detects a change of the file.
#[test]
fn what_a_table_holds_counts() {
    let directory = tempfile::tempdir().unwrap();
    let (case, way) = (directory.path().join("case.toml"), directory.path().join("way.csv"));
    let moved = "motion.boundary.left.displacement=[\"way(t)*y*(1-y)\",0]";
    let text = BASE.to_owned() + "[tables.way]\nfile = \"way.csv\"\nends = \"at_rest\"\n";
    let about = |table: &str| {
        std::fs::write(&way, table).unwrap();
        AnyCase::check(&Document::parse(&case, text.clone(), &[moved.to_owned()]).unwrap()).unwrap().about().clone()
    };
    let (before, now) = (about("0 0\n1 0.1\n"), about("0 0\n1 0.2\n"));
    let difference = &differences(&before.resolved, &now.resolved).unwrap().lasting[0];
    assert_eq!(difference.to_string(), "`tables.way.values` was [0.0, 0.1] and is [0.0, 0.2]");
    assert!(!before.resolved.contains("way.csv") && before.defaults.iter().all(|(key, _)| !key.starts_with("tables")));
}
