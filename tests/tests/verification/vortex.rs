//! The coupled vortex.

use coupled::Predictor;
use verification::vortex::{Setting, VortexRun};

#[test]
#[ignore = "an experiment: prints"]
fn experiment() {
    let get = |name: &str, default: f64| std::env::var(name).ok().map_or(default, |v| v.parse().unwrap());
    let setting = Setting {
        order: get("NS", 4.0) as usize,
        time_order: get("NT", 2.0) as usize,
        cells: get("CELLS", 10.0) as usize,
        slabs: get("SLABS", 40.0) as usize,
        end: get("END", 8.0),
        tolerance: get("TOL", 1e-8),
        predictor: if get("ELASTIC", 1.0) > 0.0 { Predictor::Elastic } else { Predictor::Extrapolated },
    };
    let start = std::time::Instant::now();
    let mut run = VortexRun::new(setting);
    let before = run.march.totals()[0];
    println!("set-up {:.2} s", start.elapsed().as_secs_f64());
    let mut out = 0.0;
    while !run.march.is_done() {
        let clock = std::time::Instant::now();
        let report = run.march.advance().unwrap();
        out += report.through.iter().map(|t| t[0]).sum::<f64>();
        let its: Vec<usize> = report.newton.steps.iter().map(|s| s.krylov_iterations).collect();
        println!(
            "{:3} t = {:.3} {:.2}s newton {:?} {:.1e} -> {:.1e} {:?} det {:.4} mass {:.2e}",
            report.slab,
            report.interval.end,
            clock.elapsed().as_secs_f64(),
            its,
            report.newton.initial_norm,
            report.newton.final_norm(),
            report.counts,
            report.quality.lower_bound,
            (report.totals[0] - before + out) / before
        );
    }
    let d = run.march.state.d.iter().fold(0.0, |m: f64, d| m.max(d.abs()));
    println!("{setting:?}: error {:.3e}, |d| {d:.2e}, {:.1} s", run.density_error(), start.elapsed().as_secs_f64());
}
