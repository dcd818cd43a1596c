//! Fluxes through boundaries, and loads of walls.

use crate::slab_operator::{Operator, every_condition, moving_slab, perturbed};
use fem::{Bottom, FluxesAt, Orders, SlabEnd, StateField, left_during_slab};
use navier_stokes::exact::FreeStream;
use navier_stokes::{Boundary, Compiled, Exact, NavierStokes, Primitive, Riemann, SlipWall, Viscosity, WallForce};
use verification::{curved_box, curved_box_at, free_stream, law, operator};

/// The integrals of the components of a state at an end of the slab.
fn totals<const D: usize, const M: usize>(operator: &Operator<D, M>, u: &[f64], end: SlabEnd) -> [f64; M] {
    let one = operator.layout.at_one_time();
    let mut mass_product = vec![0.0; one.len()];
    operator.mass_product(u, end, &mut mass_product);
    std::array::from_fn(|m| {
        (0..one.cells).flat_map(|c| &mass_product[one.cell(c)][m * one.nodes..(m + 1) * one.nodes]).sum()
    })
}

/// Test functions sum to one. So the sum of all residuals of a component is the amount at the top minus the amount at the
/// bottom, plus the amount that has left. Returns the largest difference, relative to the amount.
fn balance_error<const D: usize, const M: usize>(condition: Boundary<D>) -> f64
where
    Exact<FreeStream<D>>: StateField<D, M>,
    NavierStokes<D>: Compiled<D, M, Boundary = Boundary<D>>,
{
    let orders = Orders { flow: 3, mesh: 3, time: 2 };
    let (mut operator, uniform) = moving_slab::<D, M>(orders, Viscosity::Constant(0.02), Riemann::Roe, 2, condition);
    let (layout, cells) = (operator.layout, operator.layout.cells);
    let at_node =
        |u: &[f64], a: usize| -> Vec<f64> { (0..cells).flat_map(|c| u[layout.cell_at(c, a)].to_vec()).collect() };
    let (state, _) = perturbed(&uniform, 4);
    let mut residual = vec![0.0; state.len()];
    operator.residual(&state, &mut residual).unwrap();

    let bottom = totals(&operator, &at_node(&uniform, 0), SlabEnd::Bottom);
    let top = totals(&operator, &at_node(&state, orders.time - 1), SlabEnd::Top);
    let fluxes = operator.boundary_fluxes(None);
    if condition.is_wall() {
        assert_work_and_heat_are_the_energy(&fluxes, &condition);
    }
    let left = left_during_slab(&fluxes);
    let error = |m: usize| {
        let sum: f64 = residual.chunks_exact(layout.nodes).skip(m).step_by(M).flatten().sum();
        (sum - (top[m] - bottom[m] + left[m])).abs() / bottom[0]
    };
    (0..M).map(error).fold(0.0, f64::max)
}

/// The energy that leaves the gas through a wall is work and heat; there is heat only at an isothermal wall. At the top, which has no weight, the penalty
/// is that of times before, when the wall had other velocities: the heat is that which it took up then.
fn assert_work_and_heat_are_the_energy<const D: usize, const M: usize>(fluxes: &[FluxesAt<M>], wall: &Boundary<D>) {
    for (weight, flux) in fluxes.iter().flat_map(|at| at.boundaries.iter().map(|flux| (at.weight, flux))) {
        let (energy, size) = (flux.total()[M - 1], flux.work.abs() + flux.heat.abs());
        let rest = (energy - flux.work - flux.heat).abs();
        assert!(size > 1e-6 && (weight == 0.0 || rest < 1e-13 * (1.0 + size)), "{wall:?}: {flux:?}");
        let conducts = matches!(wall, Boundary::IsothermalWall(_));
        assert_eq!(flux.heat.abs() > 1e-13, conducts, "{wall:?}: {flux:?}");
    }
}

#[test]
fn what_the_gas_gains_is_what_the_residual_says_has_entered() {
    for condition in every_condition::<2>() {
        let error = balance_error::<2, 4>(condition);
        assert!(error < 1e-14, "2-D, {condition:?}: {error:.1e}");
    }
    for condition in every_condition::<3>() {
        let error = balance_error::<3, 5>(condition);
        assert!(error < 1e-14, "3-D, {condition:?}: {error:.1e}");
    }
}

/// Gas at rest in a curved box whose pressure rises linearly: the loads of the walls are F = int grad p and M = int (x - x_p) x
/// grad p. Returns the errors of force and moment.
fn hydrostatic_errors<const D: usize, const M: usize>(
    mesh: &mesh::Mesh<D>,
    gradient: [f64; D],
    point: [f64; D],
) -> [f64; 2]
where
    Exact<FreeStream<D>>: StateField<D, M>,
    NavierStokes<D>: Compiled<D, M, Boundary = Boundary<D>>,
{
    let orders = Orders { flow: 4, mesh: 4, time: 1 };
    let law = law::<D>(Viscosity::Inviscid, Riemann::Roe);
    let mut operator = operator(mesh, law, orders, Boundary::SlipWall(SlipWall), free_stream::<D, M>(&law));
    let layout = operator.layout;
    let mut state = vec![0.0; layout.len()];
    for cell in 0..layout.cells {
        for (i, x) in mesh.cell_coordinates(cell).chunks_exact(D).enumerate() {
            let pressure = 1.0 + (0..D).map(|d| gradient[d] * x[d]).sum::<f64>();
            let u: [f64; M] = Primitive { density: 1.0, velocity: [0.0; D], pressure }.pack(&law.gas);
            (0..M).for_each(|m| state[layout.index(cell, 0, m, i)] = u[m]);
        }
    }
    operator.begin_slab(0.0, 1.0, Bottom::new(&state, &vec![0.0; operator.mesh.field_len()]));
    operator.set_mesh(&vec![0.0; operator.mesh.field_len()]);
    operator.linearise(&state);
    let fluxes = operator.boundary_fluxes(None);
    let mut wall = WallForce::default();
    (0..mesh.boundary_names().len()).for_each(|b| wall += WallForce::during_slab(&fluxes, b, |_| point));

    let cells = mesh.volumes_and_centroids();
    let volume: f64 = cells.iter().map(|(volume, _)| volume).sum();
    let lever: [f64; D] =
        std::array::from_fn(|d| cells.iter().map(|(volume, centre)| volume * (centre[d] - point[d])).sum());
    let force_error = (0..D).map(|d| (wall.force()[d] - volume * gradient[d]).abs()).fold(0.0, f64::max);
    let at = |v: &[f64; D], i: usize| v.get(i % 3).copied().unwrap_or(0.0);
    let moment = |i| at(&lever, i + 1) * at(&gradient, i + 2) - at(&lever, i + 2) * at(&gradient, i + 1);
    let moment_error = (0..3).map(|i| (wall.moment[i] - moment(i)).abs()).fold(wall.power.abs(), f64::max);
    [force_error, moment_error]
}

#[test]
fn walls_feel_the_weight_of_gas_at_rest() {
    let plane = hydrostatic_errors::<2, 4>(&curved_box(2, 4), [0.3, -0.7], [2.0, -1.0]);
    assert!(plane.iter().all(|error| *error < 1e-13), "{plane:?}");
    let space = hydrostatic_errors::<3, 5>(&curved_box(2, 4), [0.3, -0.7, 0.2], [2.0, -1.0, 0.5]);
    assert!(space.iter().all(|error| *error < 1e-13), "{space:?}");
}

/// A uniform pressure on a closed surface has no resultant and no moment, at any place. Moments about the origin of coordinates, shifted
/// to a point near the body, once lost ten digits here.
#[test]
fn a_uniform_pressure_turns_nothing_far_from_the_origin() {
    let plane = hydrostatic_errors::<2, 4>(&curved_box_at(1e6, 2, 4), [0.0; 2], [1e6 + 2.0, 1e6 - 1.0]);
    assert!(plane.iter().all(|error| *error < 1e-13), "{plane:?}");
    let space = hydrostatic_errors::<3, 5>(&curved_box_at(1e6, 2, 4), [0.0; 3], [1e6 + 2.0, 1e6 - 1.0, 1e6]);
    assert!(space.iter().all(|error| *error < 1e-13), "{space:?}");
}
