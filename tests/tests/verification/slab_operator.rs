//! Identities of the space-time operator of one slab.

use fem::{Bottom, Differentiate, Orders, SlabEnd, SlabOperator, StateField};
use navier_stokes::exact::FreeStream;
use navier_stokes::{
    AdiabaticWall, Boundary, Compiled, Exact, FarField, Inflow, IsothermalWall, NavierStokes, Outflow, Riemann,
    ShockCapturing, SlipWall, SupersonicInflow, VelocityInflow, Viscosity, WallFlux,
};
use verification::{
    Noise, RULES, Rule, curved_box, curved_box_at, free_stream, law, operator_by, prescribed, relative_difference,
    uniform,
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

/// The residual of a uniform flow on any motion is round-off, relative to the moments of the state.
fn free_stream_residual<const D: usize, const M: usize>(
    rule: Rule,
    orders: Orders,
    viscosity: Viscosity,
    cells: usize,
) -> f64
where
    Exact<FreeStream<D>>: StateField<D, M>,
    NavierStokes<D>: Compiled<D, M, Boundary = Boundary<D>>,
{
    free_stream_residual_on::<D, M>(rule, &curved_box(cells, orders.mesh), 0.0, orders, viscosity)
}

/// The same on `mesh`, which has moved by `way` along every axis before.
fn free_stream_residual_on<const D: usize, const M: usize>(
    rule: Rule,
    mesh: &mesh::Mesh<D>,
    way: f64,
    orders: Orders,
    viscosity: Viscosity,
) -> f64
where
    Exact<FreeStream<D>>: StateField<D, M>,
    NavierStokes<D>: Compiled<D, M, Boundary = Boundary<D>>,
{
    let (mut operator, state) =
        moving_slab_on::<D, M>(rule, mesh, way, orders, law(viscosity, Riemann::Hllc), prescribed());
    let mut residual = vec![0.0; state.len()];
    operator.residual(&state, &mut residual).unwrap();
    let mut mass_product = vec![0.0; operator.layout.at_one_time().len()];
    operator.mass_product(&state[..mass_product.len()], SlabEnd::Bottom, &mut mass_product);
    let size = |v: &[f64]| v.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    size(&residual) / size(&mass_product)
}

#[test]
fn free_stream_has_no_residual_in_2d() {
    for (rule, flow, time) in RULES.iter().flat_map(|&rule| each_order(rule, &[2, 3, 4, 6, 8], &[1, 2, 3, 4])) {
        for viscosity in [Viscosity::Inviscid, Viscosity::Constant(0.01)] {
            let orders = Orders { flow, mesh: flow, time };
            let residual = free_stream_residual::<2, 4>(rule, orders, viscosity, 3);
            assert!(residual < 1e-12, "{rule:?}, N_s = {flow}, N_t = {time}, {viscosity:?}: {residual:.1e}");
        }
    }
    // Different orders.
    for (rule, flow, mesh) in RULES.iter().flat_map(|&rule| each_order(rule, &[3, 5], &[2, 3, 4, 5])) {
        let orders = Orders { flow, mesh, time: 2 };
        let residual = free_stream_residual::<2, 4>(rule, orders, Viscosity::Constant(0.01), 3);
        assert!(residual < 1e-12, "{rule:?}, N_s = {flow}, N_m = {mesh}: {residual:.1e}");
    }
}

fn each_order(rule: Rule, first: &[usize], second: &[usize]) -> Vec<(Rule, usize, usize)> {
    first.iter().flat_map(|&a| second.iter().map(move |&b| (rule, a, b))).collect()
}

#[test]
fn free_stream_has_no_residual_in_3d() {
    for rule in RULES {
        for (flow, mesh, time) in [(2, 2, 1), (3, 3, 2), (4, 4, 3), (3, 4, 4), (5, 3, 2), (8, 8, 1)] {
            let orders = Orders { flow, mesh, time };
            let residual = free_stream_residual::<3, 5>(rule, orders, Viscosity::Constant(0.01), 2);
            assert!(residual < 1e-12, "{rule:?}, N_s = {flow}, N_m = {mesh}, N_t = {time}: {residual:.1e}");
        }
    }
}

/// Metric terms from absolute positions once lost the digits that these have in common: 1e-7 of the residual at x =
/// 1e6.
#[test]
fn free_stream_has_no_residual_far_from_the_origin() {
    for (rule, (lower, way)) in RULES
        .iter()
        .flat_map(|rule| [(100.0, 0.0), (1e6, 0.0), (-1e6, 0.0), (0.0, 1e6), (0.0, -1e6)].map(|x| (*rule, x)))
    {
        for viscosity in [Viscosity::Inviscid, Viscosity::Constant(0.01)] {
            for order in [3, 6] {
                let orders = Orders { flow: order, mesh: order, time: 2 };
                let residual =
                    free_stream_residual_on::<2, 4>(rule, &curved_box_at(lower, 3, order), way, orders, viscosity);
                assert!(
                    residual < 1e-12,
                    "{rule:?}, 2-D, x = {lower} + {way}, N = {order}, {viscosity:?}: {residual:.1e}"
                );
            }
            let orders = Orders { flow: 4, mesh: 4, time: 2 };
            let residual = free_stream_residual_on::<3, 5>(rule, &curved_box_at(lower, 2, 4), way, orders, viscosity);
            assert!(residual < 1e-12, "{rule:?}, 3-D, x = {lower} + {way}, {viscosity:?}: {residual:.1e}");
        }
    }
}

/// A state near the uniform one, and a direction.
pub(crate) fn perturbed(state: &[f64], seed: u64) -> (Vec<f64>, Vec<f64>) {
    let mut noise = Noise::new(seed);
    let state = state.iter().map(|u| u + 0.05 * noise.number()).collect::<Vec<_>>();
    let direction = noise.vector(state.len(), 1.0);
    (state, direction)
}

/// Jacobian products against central differences of the residual, in state and mesh.
fn product_errors<const D: usize, const M: usize>(
    rule: Rule,
    law: NavierStokes<D>,
    condition: Boundary<D>,
) -> (f64, f64)
where
    Exact<FreeStream<D>>: StateField<D, M>,
    NavierStokes<D>: Compiled<D, M, Boundary = Boundary<D>>,
{
    let orders = Orders { flow: 3, mesh: 3, time: 2 };
    let mesh = curved_box::<D>(2, orders.mesh);
    errors_of_products(moving_slab_on::<D, M>(rule, &mesh, 0.0, orders, law, condition))
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

fn products_agree<const D: usize, const M: usize>(law: NavierStokes<D>, condition: Boundary<D>)
where
    Exact<FreeStream<D>>: StateField<D, M>,
    NavierStokes<D>: Compiled<D, M, Boundary = Boundary<D>>,
{
    for rule in RULES {
        let (state, both) = product_errors::<D, M>(rule, law, condition);
        let case = format!("{rule:?}, {law:?}, {condition:?}");
        assert!(state < 1e-7, "{case}: along the state {state:.1e}");
        assert!(both < 1e-7, "{case}: along state and mesh {both:.1e}");
    }
}

#[test]
fn products_are_the_derivative_for_every_flux() {
    let sutherland = Viscosity::Sutherland { viscosity: 0.02, temperature: 1.5, constant: 0.6 };
    for riemann in [Riemann::LaxFriedrichs, Riemann::Hllc, Riemann::Roe] {
        for viscosity in [Viscosity::Inviscid, Viscosity::Constant(0.02), sutherland] {
            products_agree::<2, 4>(law(viscosity, riemann), prescribed());
            products_agree::<3, 5>(law(viscosity, riemann), prescribed());
        }
    }
}

#[test]
fn products_are_the_derivative_for_every_boundary_condition() {
    for viscosity in [Viscosity::Inviscid, Viscosity::Constant(0.02)] {
        for condition in every_condition::<2>() {
            products_agree::<2, 4>(law(viscosity, Riemann::Roe), condition);
        }
        for condition in every_condition::<3>() {
            products_agree::<3, 5>(law(viscosity, Riemann::Roe), condition);
        }
    }
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

#[test]
fn products_are_the_derivative_with_an_artificial_viscosity() {
    for viscosity in [Viscosity::Inviscid, Viscosity::Constant(0.02)] {
        for condition in every_condition::<2>() {
            products_agree::<2, 4>(capturing(viscosity), condition);
        }
        for condition in every_condition::<3>() {
            products_agree::<3, 5>(capturing(viscosity), condition);
        }
    }
}

/// The artificial viscosity is zero, exactly, in a flow that is not compressed.
#[test]
fn an_artificial_viscosity_leaves_a_free_stream_alone() {
    for rule in RULES {
        let orders = Orders { flow: 4, mesh: 4, time: 2 };
        let mesh = curved_box::<2>(3, orders.mesh);
        let residual = |law: NavierStokes<2>| {
            let (mut operator, state) = moving_slab_on::<2, 4>(rule, &mesh, 0.0, orders, law, prescribed());
            let mut residual = vec![0.0; state.len()];
            operator.residual(&state, &mut residual).unwrap();
            residual
        };
        let with = residual(capturing(Viscosity::Constant(0.02)));
        assert_eq!(with, residual(law(Viscosity::Constant(0.02), Riemann::Roe)), "{rule:?}");
    }
}

/// A residual sums to what crosses the boundary: terms of an artificial viscosity add nothing.
#[test]
fn an_artificial_viscosity_conserves() {
    for rule in RULES {
        let orders = Orders { flow: 3, mesh: 3, time: 2 };
        let mesh = curved_box::<2>(2, orders.mesh);
        let sums = |law: NavierStokes<2>| {
            // No viscous flux crosses it.
            let far_field = Boundary::FarField(FarField::new(uniform()).unwrap());
            let (mut operator, state) = moving_slab_on::<2, 4>(rule, &mesh, 0.0, orders, law, far_field);
            let (state, _) = perturbed(&state, 3);
            let mut residual = vec![0.0; state.len()];
            operator.residual(&state, &mut residual).unwrap();
            let nodes = operator.layout.nodes;
            let mut sums = [0.0; 4];
            residual.chunks(nodes).enumerate().for_each(|(tensor, r)| sums[tensor % 4] += r.iter().sum::<f64>());
            (sums, residual)
        };
        let (plain, of_plain) = sums(law(Viscosity::Inviscid, Riemann::Roe));
        let (with, of_with) = sums(capturing(Viscosity::Inviscid));
        assert!(relative_difference(&of_with, &of_plain) > 1e-3, "{rule:?}: the viscosity acts");
        for (with, plain) in with.iter().zip(plain) {
            assert!((with - plain).abs() < 1e-13, "{rule:?}: {:e}", with - plain);
        }
    }
}

/// On a mesh at rest with one node in time the slab's Jacobian is dt A + M: the blocks are compared with the product.
fn block_error<const D: usize, const M: usize>(rule: Rule, law: NavierStokes<D>) -> f64
where
    Exact<FreeStream<D>>: StateField<D, M>,
    NavierStokes<D>: Compiled<D, M, Boundary = Boundary<D>>,
{
    let orders = Orders { flow: 3, mesh: 3, time: 1 };
    let mesh = curved_box::<D>(2, orders.mesh);
    let (mut operator, state) = moving_slab_on::<D, M>(rule, &mesh, 0.0, orders, law, prescribed());
    operator.set_mesh(&vec![0.0; operator.mesh.field_len()]);
    let (state, x) = perturbed(&state, 2);
    operator.linearise(&state);
    let mut product = vec![0.0; state.len()];
    operator.product(&x, &mut product);

    let a = operator.space_jacobian::<f64>(0.5);
    let (dt, n) = (operator.interval().1, a.block);
    let nodes = a.traces.nodes;
    let mut blocks = vec![0.0; state.len()];
    for cell in 0..operator.layout.cells {
        for i in 0..n {
            let row = a.diagonal[cell * n * n + i..].iter().step_by(n).take(n);
            blocks[cell * n + i] += dt * row.zip(&x[cell * n..]).map(|(a, x)| a * x).sum::<f64>();
            let mass = a.mass[cell * nodes * nodes + i % nodes..].iter().step_by(nodes);
            let component = &x[cell * n + i / nodes * nodes..][..nodes];
            blocks[cell * n + i] += mass.zip(component).map(|(m, x)| m * x).sum::<f64>();
        }
    }
    for coupling in &a.couplings {
        for (row, column, b) in [(0, 1, &coupling.minus_plus), (1, 0, &coupling.plus_minus)] {
            let (t, from) = (a.traces.len(), coupling.cells[column] * n);
            let trace = |k: usize| -> f64 {
                let (offset, functional) = a.traces.functional(coupling.faces[column], k);
                functional.iter().map(|&(node, w)| w * x[from + offset + node]).sum()
            };
            let traces: Vec<f64> = (0..t).map(trace).collect();
            for k in 0..t {
                let value: f64 = b[k..].iter().step_by(t).zip(&traces).map(|(b, t)| b * t).sum();
                let (offset, functional) = a.traces.functional(coupling.faces[row], k);
                for &(node, w) in functional {
                    blocks[coupling.cells[row] * n + offset + node] += dt * w * value;
                }
            }
        }
    }
    relative_difference(&blocks, &product)
}

#[test]
fn blocks_make_the_jacobian() {
    for (rule, viscosity) in RULES
        .iter()
        .flat_map(|rule| [Viscosity::Inviscid, Viscosity::Constant(0.02)].map(|viscosity| (*rule, viscosity)))
    {
        let error = block_error::<2, 4>(rule, law(viscosity, Riemann::Roe));
        assert!(error < 1e-12, "{rule:?}, 2-D, {viscosity:?}: {error:.1e}");
        let error = block_error::<3, 5>(rule, law(viscosity, Riemann::Roe));
        assert!(error < 1e-12, "{rule:?}, 3-D, {viscosity:?}: {error:.1e}");
    }
}

#[test]
fn blocks_make_the_jacobian_with_an_artificial_viscosity() {
    for rule in RULES {
        let error = block_error::<2, 4>(rule, capturing(Viscosity::Inviscid));
        assert!(error < 1e-12, "{rule:?}, 2-D: {error:.1e}");
        let error = block_error::<3, 5>(rule, capturing(Viscosity::Inviscid));
        assert!(error < 1e-12, "{rule:?}, 3-D: {error:.1e}");
    }
}

/// Floating-point operations per unknown, counted: of a residual and of a product, N = 4, N_t = 2, viscous.
fn operations_per_unknown<const D: usize, const M: usize>(rule: Rule) -> [f64; 2]
where
    Exact<FreeStream<D>>: StateField<D, M>,
    NavierStokes<D>: Compiled<D, M, Boundary = Boundary<D>>,
{
    let orders = Orders { flow: 4, mesh: 4, time: 2 };
    let (mesh, viscosity) = (curved_box::<D>(2, orders.mesh), Viscosity::Constant(0.01));
    let (mut operator, state) =
        moving_slab_on::<D, M>(rule, &mesh, 0.0, orders, law(viscosity, Riemann::Roe), prescribed());
    operator.linearise(&state);
    let counted = |along| operator.operations(along).expect("the feature operation-counts");
    [Differentiate::Nothing, Differentiate::State].map(|along| counted(along) as f64 / state.len() as f64)
}

/// A change in the work of the kernels shows here, on any machine.
#[test]
fn operations_of_residual_and_product() {
    for (rule, golden) in [
        (RULES[0], [[469.507_812_5, 888.312_5], [2_309.237_5, 4_276.137_5]]),
        (RULES[1], [[200.562_5, 386.562_5], [414.1, 779.65]]),
        (RULES[2], [[128.562_5, 282.562_5], [242.1, 529.65]]),
    ] {
        let counted = [operations_per_unknown::<2, 4>(rule), operations_per_unknown::<3, 5>(rule)];
        println!("{rule:?}, operations per unknown, residual and product, N = 4: 2-D, 3-D {counted:?}");
        for (counted, golden) in counted.as_flattened().iter().zip(golden.as_flattened()) {
            assert!((counted - golden).abs() < 1e-6, "{rule:?}: {counted} operations, not {golden}");
        }
    }
}
