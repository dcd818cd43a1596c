//! Viscous order on a curved moving mesh.

use verification::orders::table;
use verification::viscous::error;

#[test]
fn viscous_order_is_n_s() {
    for (order, cells) in [(2, [12, 24]), (3, [8, 16]), (4, [6, 12]), (5, [4, 8]), (6, [3, 6])] {
        let rows = cells.map(|cells| (1.0 / cells as f64, error(order, 3, cells, 4)));
        let measured = table(&format!("manufactured viscous flow, N_s = {order}"), &rows);
        assert!(measured >= order as f64 - 0.2, "N_s = {order}: {measured:.2}");
    }
}
