//! The coupled vortex: orders, conservation, the mesh, the solver.

use coupled::{MeshMarch, Predictor, Schedule, StepControl};
use verification::orders::table;
use verification::vortex::{Setting, VortexRun};

const SETTING: Setting =
    Setting { order: 4, time_order: 2, cells: 8, slabs: 10, end: 1.0, tolerance: 1e-8, predictor: Predictor::Elastic };

/// Runs to the end; returns the largest mass error of the run, relative to the mass.
fn finish(run: &mut VortexRun) -> f64 {
    let (before, mut out, mut worst) = (run.march.totals()[0], 0.0, 0.0_f64);
    while !run.march.is_done() {
        let report = run.march.advance().unwrap();
        out += fem::left_during_slab(&report.fluxes)[0];
        worst = worst.max((report.totals[0] - before + out).abs() / before);
    }
    worst
}

fn density_error(setting: Setting) -> f64 {
    let mut run = VortexRun::new(setting);
    finish(&mut run);
    run.density_error()
}

/// The order of the density at t = 1, on meshes in which the vortex has the same position relative to cells.
fn spatial_order(order: usize, time_order: usize, slabs: usize, cells: &[usize]) -> f64 {
    let at = |&cells: &usize| {
        let setting = Setting { order, time_order, cells, slabs, tolerance: 1e-10, ..SETTING };
        (10.0 / cells as f64, density_error(setting))
    };
    let rows: Vec<_> = cells.iter().map(at).collect();
    table(&format!("vortex, N_s = {order}"), &rows)
}

#[test]
fn order_in_space_is_n_s() {
    for (order, time_order, slabs, cells) in
        [(2, 3, 5, [30, 60]), (3, 3, 5, [20, 36]), (4, 3, 5, [14, 24]), (6, 4, 12, [20, 28]), (8, 4, 12, [7, 9])]
    {
        let measured = spatial_order(order, time_order, slabs, &cells);
        assert!(measured >= order as f64 - 0.2, "N_s = {order}: {measured:.2}");
    }
}

#[test]
fn order_in_time_at_slab_ends_is_2_n_t_minus_1() {
    let run = |time_order: usize, slabs: usize| {
        let setting = Setting { order: 6, cells: 5, time_order, slabs, tolerance: 1e-11, ..SETTING };
        let mut run = VortexRun::new(setting);
        finish(&mut run);
        run.march.state.u
    };
    let reference = run(4, 32);
    for (time_order, slabs) in [(1, [32, 64]), (2, [16, 32]), (3, [8, 16])] {
        let error = |slabs: usize| {
            let u = run(time_order, slabs);
            let squares = u.iter().zip(&reference).map(|(a, b)| (a - b).powi(2));
            (1.0 / slabs as f64, squares.sum::<f64>().sqrt())
        };
        let measured = table(&format!("vortex, N_t = {time_order}"), &slabs.map(error));
        assert!(measured >= 2.0 * time_order as f64 - 1.2, "N_t = {time_order}: {measured:.2}");
    }
}

#[test]
fn mass_is_kept_and_the_mesh_follows_the_affine_map() {
    for predictor in [Predictor::Elastic, Predictor::Extrapolated] {
        let mut run = VortexRun::new(Setting { slabs: 20, end: 8.0, predictor, ..SETTING });
        let mut worst = 0.0_f64;
        let (before, mut out) = (run.march.totals()[0], 0.0);
        while !run.march.is_done() {
            let report = run.march.advance().unwrap();
            out += fem::left_during_slab(&report.fluxes)[0];
            let mass = (report.totals[0] - before + out).abs() / before;
            assert!(mass <= 1e-12, "{predictor:?}: mass error {mass:.1e} at t = {}", run.march.state.time);
            worst = worst.max(run.displacement_error());
        }
        println!("{predictor:?}: displacement against the affine map {worst:.1e}");
        assert!(worst <= 1e-10, "{predictor:?}: {worst:.1e}");
        // After the period the mesh equals the initial one, 8 further to the right.
        let back = run.march.state.d.chunks_exact(2).map(|d| (d[0] - 8.0).abs().max(d[1].abs()));
        let back = back.fold(0.0, f64::max);
        assert!(back <= 1e-10, "{predictor:?}: {back:.1e}");
    }
}

/// Newton steps and Krylov iterations of a slab, averaged over a few.
fn iterations(setting: Setting) -> (f64, f64) {
    let mut run = VortexRun::new(setting);
    let (mut newton, mut krylov, mut slabs) = (0, 0, 0);
    while !run.march.is_done() {
        let report = run.march.advance().unwrap();
        newton += report.newton.steps.len();
        krylov += report.newton.krylov_iterations;
        slabs += 1;
    }
    (newton as f64 / slabs as f64, krylov as f64 / slabs as f64)
}

/// The limitation that the paper admits: poorer convergence with smaller time steps.
#[test]
fn krylov_iterations_do_not_grow_when_the_slab_is_halved() {
    for predictor in [Predictor::Elastic, Predictor::Extrapolated] {
        let mut fewest = f64::INFINITY;
        for halvings in 0..=6 {
            let end = 0.8 / f64::from(1 << halvings);
            let (newton, krylov) = iterations(Setting { slabs: 4, end, predictor, ..SETTING });
            println!("{predictor:?}, dt = {:.5}: {newton} Newton steps, {krylov} Krylov iterations", end / 4.0);
            assert!(krylov <= fewest + 2.0, "{predictor:?}: {krylov} after {fewest}");
            fewest = fewest.min(krylov);
        }
    }
}

/// The jump at the bottom of a slab, the estimate of the step control, is of order N_t.
#[test]
fn the_jump_has_the_order_in_time() {
    for time_order in 1..=3 {
        // The last slab up to t = 1.2; well resolved in space.
        let jump = |slabs: usize| {
            let setting = Setting { order: 8, slabs, end: 1.2, time_order, tolerance: 1e-10, ..SETTING };
            let mut run = VortexRun::new(setting);
            (0..slabs).map(|_| run.march.advance().unwrap().jump).last().unwrap()
        };
        let (coarse, fine) = (jump(3), jump(6));
        let order = (coarse / fine).log2();
        println!("N_t = {time_order}: jump {coarse:.2e}, {fine:.2e}, order {order:.2}");
        assert!((order - time_order as f64).abs() < 0.35, "{order}");
    }
}

/// Slabs that start a hundred times too short grow until the jump meets the tolerance, and no jump is twice as large.
#[test]
fn slabs_adapt_to_the_jump() {
    let mut run = VortexRun::new(Setting { slabs: 400, end: 2.0, ..SETTING });
    let control = StepControl { tolerance: 2e-3, smallest: 1e-3, largest: 1.0 };
    run.march.adapt(control);
    let mut reports = Vec::new();
    while !run.march.is_done() {
        reports.push(run.march.advance().unwrap());
    }
    let lengths: Vec<f64> = reports.iter().map(|r| r.interval.end - r.interval.start).collect();
    let jumps: Vec<f64> = reports.iter().map(|r| r.jump).collect();
    println!("{lengths:.3?}\n{jumps:.5?}");
    assert!(reports.len() < 25 && run.march.state.time == 2.0);
    assert!(jumps.iter().all(|&jump| jump <= 2.0 * control.tolerance));
    assert!(jumps[reports.len() - 2] > 0.3 * control.tolerance);
}

#[test]
fn newton_ends_quadratically_and_at_round_off() {
    let mut run = VortexRun::new(Setting { slabs: 1, end: 0.5, predictor: Predictor::Constant, ..SETTING });
    let newton = &mut run.march.solver.newton;
    (newton.relative_tolerance, newton.forcing.minimum) = (1e-13, 1e-6);
    let report = run.march.advance().unwrap();
    let history = report.newton.residual_history();
    println!("{history:?}");
    let relative = history[history.len() - 1] / history[0];
    assert!(relative <= 1e-12, "{relative:.1e}");
    // The last step but one above round-off: |R_k+1| <= C |R_k|^2 with |R_k| already small.
    let quadratic = history.windows(2).filter(|r| r[0] < 1e-2 * history[0] && r[0] > 1e-8 * history[0]);
    let mut seen = 0;
    for r in quadratic {
        let order = (r[1] / history[0]).ln() / (r[0] / history[0]).ln();
        assert!(order > 1.7, "order {order:.2} in {history:?}");
        seen += 1;
    }
    assert!(seen > 0, "no step in the range of quadratic convergence: {history:?}");
}

/// The coupled solve against elasticity alone and the flow on the resulting mesh: counted work; seconds are printed.
#[test]
fn coupling_costs_no_more_than_its_parts() {
    let setting = Setting { slabs: 10, end: 1.0, ..SETTING };
    let (mut totals, mut seconds) = (Vec::new(), Vec::new());
    for prescribed in [false, true] {
        let mut run = if prescribed { VortexRun::prescribed(setting) } else { VortexRun::new(setting) };
        let start = std::time::Instant::now();
        let (mut products, mut residuals) = (0, 0);
        while !run.march.is_done() {
            let report = run.march.advance().unwrap();
            products += report.counts.products + report.counts.mesh_products;
            residuals += report.counts.residuals;
        }
        seconds.push(start.elapsed().as_secs_f64());
        println!(
            "prescribed {prescribed}: {products} products, {residuals} residuals, {:.2} s",
            seconds[seconds.len() - 1]
        );
        totals.push((products + residuals) as f64);
    }
    let mover = VortexRun::new(setting).march.solver.system.mesh.mover;
    let mut mesh = MeshMarch::new(mover, Schedule::uniform(setting.end, setting.slabs), 0);
    let start = std::time::Instant::now();
    while !mesh.is_done() {
        mesh.advance().unwrap();
    }
    let alone = start.elapsed().as_secs_f64();
    println!("elasticity alone {alone:.2} s; coupled over the parts {:.2}", seconds[0] / (alone + seconds[1]));
    assert!(totals[0] <= 1.1 * totals[1], "{totals:?}");
}
