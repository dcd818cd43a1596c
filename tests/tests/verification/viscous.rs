//! Orders of viscous flows on moving meshes, at low and high speed.

use verification::viscous::{Setting, orders};

const CURVED: f64 = 0.03;

/// The number of slabs with which the error in time is below the error in space, for N_s.
fn slabs(order: usize) -> usize {
    [4, 8, 8, 12, 16][order - 2]
}

fn assert_order_is_n_s(setting: Setting, cells: [usize; 2]) {
    let measured = orders(setting, cells);
    let wanted = setting.order as f64 - 0.2;
    assert!(measured.iter().all(|&order| order >= wanted), "{setting:?}: {measured:.2?}");
}

/// About as fast as sound, on a curved mesh.
#[test]
fn viscous_order_is_n_s() {
    for (order, cells) in [(2, [8, 16]), (3, [8, 16]), (4, [5, 10]), (5, [8, 16]), (6, [5, 10])] {
        let setting = Setting { order, cells: 0, slabs: slabs(order), mach: 1.3, viscosity: 0.05, curving: CURVED };
        assert_order_is_n_s(setting, cells);
    }
}

/// At the speed of the workshop's airfoils. Density and energy of even degrees (N_s = 3, 5) once lost up to a full order: where viscosity
/// dominates in a cell, nothing damped the Legendre polynomial of the highest degree.
#[test]
fn viscous_order_is_n_s_at_mach_0_2() {
    for (order, cells, curving) in
        [(2, [8, 16], CURVED), (3, [16, 32], CURVED), (4, [6, 12], 0.0), (5, [8, 16], 0.0), (6, [4, 8], 0.0)]
    {
        let setting = Setting { order, cells: 0, slabs: slabs(order), mach: 0.2, viscosity: 0.001, curving };
        assert_order_is_n_s(setting, cells);
    }
}

/// Also at cell Reynolds numbers below one, and at M = 0.05.
#[test]
fn even_degrees_keep_their_order_where_viscosity_governs_the_cells() {
    for (order, cells, mach, viscosity) in [(3, [8, 16], 0.2, 0.05), (3, [8, 16], 0.05, 0.005), (5, [5, 10], 0.2, 0.01)]
    {
        let setting = Setting { order, cells: 0, slabs: slabs(order), mach, viscosity, curving: 0.0 };
        assert_order_is_n_s(setting, cells);
    }
}

/// The bound derived in theory.md. Where viscosity dominates in the cells, momentum keeps N_s. Pressure, and with it density and energy, is
/// at worst as accurate as the viscous stress, N_s - 1.
#[test]
fn odd_degrees_lose_at_most_an_order_of_the_pressure_where_viscosity_governs_the_cells() {
    let setting = Setting { order: 4, cells: 0, slabs: 8, mach: 0.05, viscosity: 0.05, curving: 0.0 };
    let [density, momentum, energy] = orders(setting, [6, 12]);
    assert!(momentum >= 3.8 && density.min(energy) >= 3.0, "{density:.2} {momentum:.2} {energy:.2}");
}
