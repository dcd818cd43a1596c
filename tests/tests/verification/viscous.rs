//! Viscous order on a curved moving mesh.

use verification::orders::table;
use verification::viscous::error;

#[test]
fn viscous_order_is_n_s() {
    for (order, slabs, cells) in [(2, 4, [8, 16]), (3, 4, [8, 16]), (4, 8, [5, 10]), (5, 16, [8, 16]), (6, 16, [5, 10])]
    {
        let rows = cells.map(|cells| (1.0 / cells as f64, error(order, 3, cells, slabs)));
        let measured = table(&format!("manufactured viscous flow, N_s = {order}"), &rows);
        assert!(measured >= order as f64 - 0.2, "N_s = {order}: {measured:.2}");
    }
}
