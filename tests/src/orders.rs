//! Orders of accuracy as numbers.

/// log(e_1 / e_2) / log(h_1 / h_2): the order between two errors on meshes of sizes h.
pub fn order(coarse: (f64, f64), fine: (f64, f64)) -> f64 {
    (coarse.1 / fine.1).ln() / (coarse.0 / fine.0).ln()
}

/// Prints a table of (h, error) with the orders between its rows, and returns the last order.
pub fn table(title: &str, rows: &[(f64, f64)]) -> f64 {
    println!("{title}");
    let mut last = f64::NAN;
    for (i, row) in rows.iter().enumerate() {
        if i > 0 {
            last = order(rows[i - 1], *row);
        }
        println!("  h = {:.4}  error {:.3e}  order {last:.2}", row.0, row.1);
    }
    last
}
