#[test]
#[ignore = "prints"]
fn viscous() {
    let get = |name: &str, default: usize| std::env::var(name).ok().map_or(default, |v| v.parse().unwrap());
    let order = get("N", 3);
    let rows: Vec<_> = [1, 2, 4]
        .iter()
        .map(|&k| get("CELLS", 8) * k)
        .map(|c| (1.0 / c as f64, verification::viscous::error(order, 3, c, get("SLABS", 4))))
        .collect();
    verification::orders::table(&format!("N {order}"), &rows);
}
#[test]
#[ignore = "prints"]
fn vtx() {
    use coupled::Predictor;
    use verification::vortex::{Setting, VortexRun};
    for (order, list) in [(6, vec![8, 10, 12, 14, 16, 20]), (8, vec![5, 7, 9, 11, 13])] {
        let rows: Vec<_> = list
            .iter()
            .map(|&cells| {
                let mut run = VortexRun::new(Setting {
                    order,
                    time_order: 4,
                    cells,
                    slabs: 12,
                    end: 1.0,
                    tolerance: 1e-10,
                    predictor: Predictor::Elastic,
                });
                while !run.march.is_done() {
                    run.march.advance().unwrap();
                }
                (10.0 / cells as f64, run.density_error())
            })
            .collect();
        verification::orders::table(&format!("vortex N {order}"), &rows);
    }
}
