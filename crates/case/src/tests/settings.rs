//! What a case sets becomes what the program needs.

use super::*;

/// The low-order preconditioner of a flow in three dimensions took twice the time of blocks where the flow moves a plate.
#[test]
fn flows_that_move_bodies_have_blocks_as_long_as_these_are_small() {
    let preconditioner = |name: &str, order: usize| {
        let file = case_files().into_iter().find(|file| file.ends_with(format!("{name}.toml"))).unwrap();
        match AnyCase::read(&file, &[format!("flow.order={order}")]).unwrap() {
            AnyCase::Space(case) => case.preconditioner(),
            AnyCase::Plane(case) => case.preconditioner(),
        }
    };
    assert_eq!(preconditioner("flexible_plate_3d", 3), Preconditioner::Blocks);
    assert_eq!(preconditioner("flexible_plate_3d", 8), Preconditioner::LowOrder, "4 GB of blocks");
    assert_eq!(preconditioner("taylor_green_3d", 3), Preconditioner::LowOrder);
    assert_eq!(preconditioner("taylor_green_3d", 2), Preconditioner::Blocks);
    assert_eq!(preconditioner("turek_hron_fsi1", 8), Preconditioner::Blocks);
}

#[test]
fn what_the_user_wrote_becomes_what_the_program_needs() {
    let case = plane(BASE, &[]);
    assert_eq!((case.about.name.as_str(), case.mesh.n_cells(), case.mesh.order()), ("base", 8, 3));
    assert_eq!((case.time.slabs, case.time.step, case.time.order), (4, 0.3, 2));
    let flow = case.flow.unwrap();
    assert_eq!((flow.order, flow.law.riemann, flow.is_manufactured()), (4, Riemann::Roe, false));
    assert_eq!(flow.exact, None);
    let walls: Vec<bool> = flow.boundary.iter().map(|data| data.condition.is_wall()).collect();
    assert_eq!(case.mesh.boundary_names(), ["left", "right", "bottom", "top"]);
    assert_eq!(walls, [true, false, false, false]);
    let Some(Motion::Elastic { poisson_ratio, stiffness, solver, boundary, .. }) = case.motion else {
        panic!("elastic")
    };
    assert_eq!((poisson_ratio, stiffness), (0.3, Stiffness::InverseJacobian { power: 1.0 }));
    assert_eq!(solver, elasticity::Solver::Automatic);
    let Some(BoundaryMotion::Formulas(left)) = &boundary[0] else { panic!("by formulas") };
    assert_eq!((left.value(&[0.0, 0.5], 2.0), left.rate(&[0.0, 0.5], 2.0)), ([0.2, 0.0], [0.1, 0.0]));
    assert_eq!(boundary[1..], [const { None }; 3]);
}

/// In two dimensions the sign of the moment is chosen. In three the moment is a vector, and the axis of its coefficient is
/// chosen.
#[test]
fn moments_are_positive_about_the_axis_that_is_asked_for() {
    let force = navier_stokes::WallForce::<2> { moment: [0.0, 0.0, 3.0], ..Default::default() };
    for (choice, moment) in [("counter_clockwise", 3.0), ("nose_up", -3.0)] {
        let wall = plane(BASE, &[&format!("flow.forces.left.moment_positive={choice}")]).flow.unwrap().walls.remove(0);
        assert_eq!((wall.moments(&force), wall.scales.coefficients(&force).moment), (vec![moment], moment / 0.125));
    }
    assert_eq!(plane(BASE, &[]).flow.unwrap().walls[0].moments(&force), [3.0]);
    let axis = ["flow.forces.left.moment_positive={ axis = [0, 0, -1] }"];
    let message = check_text(BASE, &axis).unwrap_err().to_string();
    assert!(message.contains("a moment has no axis but that along z"), "{message}");

    let text = "[mesh]\norder = 2\ngenerate.box = { lower = [0, 0, 0], upper = [1, 1, 1], cells = [1, 1, 1] }\n[flow]\norder = 2\ninitial.uniform = { velocity = [1, 0, 0], pressure = 1 }\nboundary.others = \"slip_wall\"\n[time]\norder = 1\nend = 1\nslabs = 1\n";
    let force = navier_stokes::WallForce::<3> { moment: [1.0, 2.0, 3.0], ..Default::default() };
    for (choice, moment) in [("nose_up", -3.0), ("{ axis = [0, -5, 0] }", -2.0)] {
        let options = [format!("flow.forces.others.moment_positive={choice}")];
        let Ok(AnyCase::Space(case)) = check_text(text, &[&options[0]]) else { panic!("in space") };
        let wall = case.flow.unwrap().walls.remove(0);
        assert_eq!(wall.moments(&force), [1.0, 2.0, 3.0]);
        assert_eq!(wall.scales.coefficients(&force).moment, moment / 0.5);
    }
    let message =
        check_text(text, &["flow.forces.others.moment_positive={ axis = [0, 0, 0] }"]).unwrap_err().to_string();
    assert!(message.contains("three numbers that are not all zero"), "{message}");
}

#[test]
fn a_case_without_anything_to_solve_is_refused() {
    let text = "[mesh]\norder = 2\ngenerate.box = { lower = [0,0], upper = [1,1], cells = [1,1] }\n[time]\norder = 1\nend = 1\nslabs = 1\n";
    assert!(check_text(text, &[]).unwrap_err().to_string().contains("nothing to solve"));
    assert!(check_text("", &[]).unwrap_err().to_string().contains("missing key `mesh`"));
}

#[test]
fn slabs_cover_the_time() {
    for (step, end, slabs) in [("0.1", "1", 10), ("0.3", "1", 4), ("2", "1", 1), ("0.1", "8", 80), ("0.3", "0.9", 3)] {
        let time = plane(BASE, &[&format!("time.step={step}"), &format!("time.end={end}")]).time;
        assert_eq!(time.slabs, slabs, "{step} {end}");
        assert!(time.step * (time.slabs as f64 - 1.0) < time.end && time.step * time.slabs as f64 > time.end - 1e-12);
    }
}

#[test]
fn the_end_is_the_number_that_a_longer_run_passes() {
    let end = |end: &str| plane(BASE, &["time.step=0.1", &format!("time.end={end}")]).time.end;
    assert_eq!([end("0.3"), end("0.35"), end("0.7")], [0.1 * 3.0, 0.35, 0.1 * 7.0]);
    assert_ne!(0.1 * 3.0, 0.3);
}

#[test]
fn every_shipped_case_is_valid_and_says_what_it_shows() {
    for file in case_files() {
        let case = AnyCase::read(&file, &[]).unwrap_or_else(|error| panic!("{error}"));
        assert!(!case.about().title.is_empty(), "{file:?}");
        let text = std::fs::read_to_string(&file).unwrap();
        for part in ["What it shows", "here it comes from", "hat to expect", "What it costs"] {
            assert!(text.contains(part), "{file:?}: {part}");
        }
    }
}

#[test]
fn settings_reach_the_newton_driver() {
    let newton = |options: &[&str]| plane(BASE, options).solver.newton();
    assert_eq!(newton(&[]), newton_krylov::newton::Settings::default());
    let changed = newton(&["solver.krylov_tolerance=1e-4", "solver.newton_steps=3", "solver.pseudo_time.power=2"]);
    assert_eq!((changed.forcing.initial, changed.forcing.minimum, changed.forcing.maximum), (1e-4, 1e-4, 1e-4));
    assert_eq!((changed.max_steps, changed.pseudo_time.power), (3, 2.0));
}

#[test]
fn a_reynolds_number_gives_the_viscosity() {
    let viscosity = |options: &[&str]| {
        let gas = plane(BASE, options).flow.unwrap().law.gas;
        gas.dynamic_viscosity(1.0)
    };
    let reynolds = "flow.gas.viscosity={ reynolds = 50 }";
    assert!((viscosity(&[reynolds]) - 0.01).abs() < 1e-17, "of the stream, and the length 1");
    let reference = "flow.reference={ density = 2, speed = 3, pressure = 1, length = 5 }";
    assert!((viscosity(&[reynolds, reference]) - 0.6).abs() < 1e-15);
    let gas = plane(BASE, &[]).flow.unwrap().law.gas;
    assert_eq!(gas.dynamic_viscosity(1.0), 0.0);
    let message = check_text(BASE, &["flow.gas.viscosity={ reynolds = 0 }"]).unwrap_err().to_string();
    assert!(message.contains("the Reynolds number is out of range"), "{message}");
    let rest = ["initial.uniform", "boundary.others.far_field"].map(|state| format!("flow.{state}.velocity=[0,0]"));
    for options in [&[&rest[0][..], &rest[1]][..], &[reynolds, &rest[0], &rest[1]]] {
        let message = check_text(BASE, options).unwrap_err().to_string();
        let parts = ["`flow.reference`", "cannot be told", "reference = { density, speed, pressure }", "typical"];
        parts.iter().for_each(|part| assert!(message.contains(part), "{message}"));
    }
}
