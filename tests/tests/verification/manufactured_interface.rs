//! Orders of a gas and a solid that move each other, by a manufactured solution.

use verification::manufactured_interface::{Errors, Setting};

/// Errors of the flow, of displacement and velocity.
fn list(errors: Errors) -> [f64; 3] {
    [errors.flow, errors.displacement, errors.velocity]
}

/// The orders between two settings, the second one finer by the factor `ratio`; printed with the errors.
fn orders([coarse, fine]: [Setting; 2], ratio: f64) -> [f64; 3] {
    let errors = [coarse, fine].map(|setting| list(setting.errors()));
    let orders = [0, 1, 2].map(|i| (errors[0][i] / errors[1][i]).ln() / ratio.ln());
    let last = errors[1].map(|error| format!("{error:.1e}")).join(", ");
    println!("{fine:?}: orders of flow, displacement, velocity {orders:.2?}, errors {last}");
    orders
}

#[test]
fn the_order_in_space_is_n_s() {
    for (order, cells) in [(2, [4, 8]), (3, [4, 8]), (4, [3, 6]), (5, [4, 8])] {
        let setting = |cells| Setting { order, time_order: 3, cells, slabs: 3 * order };
        let measured = orders(cells.map(setting), cells[1] as f64 / cells[0] as f64);
        assert!(measured.iter().all(|measured| *measured >= order as f64 - 0.2), "N_s = {order}: {measured:.2?}");
    }
}

/// 2 N_t - 1 at the ends of slabs.
#[test]
fn the_order_in_time_is_that_of_radau() {
    for (time_order, slabs) in [(1, [8, 16]), (2, [8, 16]), (2, [16, 32]), (3, [4, 8])] {
        let setting = |slabs| Setting { order: 8, time_order, cells: 2, slabs };
        let measured = orders(slabs.map(setting), 2.0);
        let wanted = 2.0 * time_order as f64 - 1.2;
        assert!(measured.iter().all(|measured| *measured >= wanted), "N_t = {time_order}: {measured:.2?}");
    }
}
