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

/// The load of the gas on the wall may be as inaccurate as its stress. On coarse meshes velocities of the solid at N_s = 4 feel that: between 4 and 8
/// cells their order is 3.7.
#[test]
fn the_order_in_space_is_n_s() {
    for (order, cells) in [(2, [4, 8]), (3, [4, 8]), (4, [8, 16]), (5, [3, 6])] {
        let setting = |cells| Setting { order, time_order: 3, cells, slabs: 4 * order };
        let [flow, displacement, velocity] = orders(cells.map(setting), 2.0);
        let wanted = order as f64 - 0.2;
        let least = flow.min(displacement).min(velocity);
        assert!(least >= wanted, "N_s = {order}: {flow:.2}, {displacement:.2}, {velocity:.2}");
    }
}

/// At N_t = 2 the rates of this stiff system have their order in short slabs only: 2.4 to 2.7 in longer ones.
#[test]
fn the_order_in_time_is_that_of_radau() {
    for (time_order, order, slabs) in [(1, 6, [8, 16]), (2, 8, [32, 64])] {
        let setting = |slabs| Setting { order, time_order, cells: 3, slabs };
        let [flow, displacement, velocity] = orders(slabs.map(setting), 2.0);
        let wanted = 2.0 * time_order as f64 - 1.0 - 0.2;
        let least = flow.min(displacement).min(velocity);
        assert!(least >= wanted, "N_t = {time_order}: {flow:.2}, {displacement:.2}, {velocity:.2}");
    }
}
