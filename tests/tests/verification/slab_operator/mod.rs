//! Identities of the space-time operator of one slab.

mod artificial_viscosity;
mod blocks;
mod free_stream;
mod operations;
mod products;

use fem::{Bottom, Orders, SlabOperator, StateField};
use navier_stokes::exact::FreeStream;
use navier_stokes::{
    AdiabaticWall, Boundary, Compiled, Exact, FarField, Inflow, IsothermalWall, NavierStokes, Outflow, Riemann,
    ShockCapturing, SlipWall, SupersonicInflow, VelocityInflow, Viscosity, WallFlux,
};
use verification::{
    Noise, RULES, Rule, curved_box, free_stream, law, operator_by, prescribed, relative_difference, uniform,
};

pub(crate) type Operator<const D: usize, const M: usize> = SlabOperator<D, M>;

/// A slab whose mesh moves smoothly in space and randomly in time, and the uniform state in it.
pub(crate) fn moving_slab<const D: usize, const M: usize>(
    orders: Orders,
    viscosity: Viscosity,
    riemann: Riemann,
    cells: usize,
    condition: Boundary<D>,
) -> (Operator<D, M>, Vec<f64>)
where
    Exact<FreeStream<D>>: StateField<D, M>,
    NavierStokes<D>: Compiled<D, M, Boundary = Boundary<D>>,
{
    let mesh = curved_box::<D>(cells, orders.mesh);
    moving_slab_on(RULES[0], &mesh, 0.0, orders, law(viscosity, riemann), condition)
}

/// The same by any rule on `mesh`, which has moved by `way` along every axis before.
pub(crate) fn moving_slab_on<const D: usize, const M: usize>(
    (quadrature, volume_flux): Rule,
    mesh: &mesh::Mesh<D>,
    way: f64,
    orders: Orders,
    law: NavierStokes<D>,
    condition: Boundary<D>,
) -> (Operator<D, M>, Vec<f64>)
where
    Exact<FreeStream<D>>: StateField<D, M>,
    NavierStokes<D>: Compiled<D, M, Boundary = Boundary<D>>,
{
    let law = NavierStokes { volume_flux, ..law };
    let data = free_stream::<D, M>(&law);
    let state = data.value(&[0.0; D], 0.0);
    let mut operator = operator_by(quadrature, mesh, law, orders, condition, data);
    let bottom: Vec<f64> = uniform_coefficients(&operator, &state, 1);
    let positions = node_positions(mesh, orders.mesh);
    let field = |amplitude: f64, phase: f64| -> Vec<f64> {
        (positions.iter().enumerate())
            .map(|(i, x)| {
                amplitude * (3.0 * x[0] + 2.0 * x[1] + phase + (i % D) as f64).sin() * (2.0 * x[D - 1] + phase).cos()
            })
            .collect()
    };
    let displacement: Vec<f64> = field(0.02, 0.4).iter().map(|d| way + d).collect();
    operator.begin_slab(0.3, 0.1, Bottom::new(&bottom, &displacement));
    let velocities: Vec<f64> = (0..orders.time).flat_map(|b| field(0.3, 1.0 + 2.0 * b as f64)).collect();
    operator.set_mesh(&velocities);
    let state = uniform_coefficients(&operator, &state, orders.time);
    (operator, state)
}

pub(crate) fn uniform_coefficients<const D: usize, const M: usize>(
    operator: &Operator<D, M>,
    state: &[f64; M],
    slots: usize,
) -> Vec<f64> {
    let layout = operator.layout;
    let one = state.iter().flat_map(|&u| vec![u; layout.nodes]);
    one.cycle().take(layout.cells * slots * layout.time_len()).collect()
}

/// For each entry of a C0 field, the position of its node.
fn node_positions<const D: usize>(mesh: &mesh::Mesh<D>, order: usize) -> Vec<[f64; D]> {
    let numbering = mesh::NodeNumbering::new(mesh, order);
    numbering.positions(mesh).into_iter().flat_map(|x| [x; D]).collect()
}

/// A state near the uniform one, and a direction.
pub(crate) fn perturbed(state: &[f64], seed: u64) -> (Vec<f64>, Vec<f64>) {
    let mut noise = Noise::new(seed);
    let state = state.iter().map(|u| u + 0.05 * noise.number()).collect::<Vec<_>>();
    let direction = noise.vector(state.len(), 1.0);
    (state, direction)
}

/// The same for any slab near a uniform state.
pub(crate) fn errors_of_products<const D: usize, const M: usize>(
    (mut operator, state): (Operator<D, M>, Vec<f64>),
) -> (f64, f64) {
    let (state, direction) = perturbed(&state, 1);
    let (n, orders) = (state.len(), operator.tables.orders);
    let velocities = Noise::new(5).vector(operator.mesh.field_len() * orders.time, 0.2);
    let along = Noise::new(6).vector(velocities.len(), 1.0);
    operator.set_mesh(&velocities);
    // Small, because fluxes have kinks (the larger of two wave speeds) that a larger step would cross.
    let h = 2e-6;
    let shifted = |u: &[f64], d: &[f64], h: f64| -> Vec<f64> { u.iter().zip(d).map(|(u, d)| u + h * d).collect() };
    let mut at = |h: f64, mesh: bool| -> Vec<f64> {
        operator.set_mesh(&shifted(&velocities, &along, if mesh { h } else { 0.0 }));
        let mut r = vec![0.0; n];
        operator.residual(&shifted(&state, &direction, h), &mut r).unwrap();
        r
    };
    let mut difference = |mesh: bool| -> Vec<f64> {
        let (ahead, behind) = (at(h, mesh), at(-h, mesh));
        (0..n).map(|i| (ahead[i] - behind[i]) / (2.0 * h)).collect()
    };
    let (state_difference, both_difference) = (difference(false), difference(true));
    operator.set_mesh(&velocities);
    operator.linearise(&state);
    let mut product = vec![0.0; n];
    operator.product(&direction, &mut product);
    let first = relative_difference(&product, &state_difference);
    operator.product_with_mesh(&direction, &along, &mut product);
    (first, relative_difference(&product, &both_difference))
}

/// Every boundary condition, with parameters that suit the uniform state.
pub(crate) fn every_condition<const D: usize>() -> Vec<Boundary<D>> {
    let stream = uniform::<D>();
    let slide = [0.2; D];
    vec![
        prescribed(),
        Boundary::FarField(FarField::new(stream).unwrap()),
        Boundary::AdiabaticWall(AdiabaticWall::new(slide).unwrap()),
        Boundary::IsothermalWall(IsothermalWall::new(1.4, slide).unwrap()),
        Boundary::SlipWall(SlipWall),
        Boundary::Symmetry(SlipWall),
        Boundary::Inflow(Inflow::new(2.0, 1.7, stream.velocity).unwrap()),
        Boundary::Outflow(Outflow::new(1.5, 1.6).unwrap()),
        Boundary::VelocityInflow(VelocityInflow::OfVelocity),
        Boundary::VelocityInflow(VelocityInflow::OfMassFlux),
        Boundary::SupersonicInflow(SupersonicInflow),
        Boundary::Inflow(Inflow::at_points()),
        Boundary::Outflow(Outflow::at_points()),
        Boundary::AdiabaticWall(AdiabaticWall::at_points()),
        Boundary::IsothermalWall(IsothermalWall::at_points()),
    ]
}

/// A law with an artificial viscosity, and walls that resist the velocity through them.
fn capturing<const D: usize>(viscosity: Viscosity) -> NavierStokes<D> {
    let shock_capturing = ShockCapturing::new(2.0, 0.02).unwrap();
    NavierStokes {
        shock_capturing: Some(shock_capturing),
        wall_flux: WallFlux::Mirrored,
        ..law(viscosity, Riemann::Roe)
    }
}
