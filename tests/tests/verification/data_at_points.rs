//! Conditions whose values vary with position and time, and sources: residuals and products with the Jacobian.

use crate::slab_operator::{Operator, errors_of_products, moving_slab_on, perturbed};
use fem::{Orders, StateField};
use navier_stokes::exact::FreeStream;
use navier_stokes::{
    AdiabaticWall, Boundary, Compiled, Exact, Inflow, IsothermalWall, NavierStokes, Outflow, Riemann, Source,
    VelocityInflow, Viscosity,
};
use std::sync::Arc;
use tensor::{Dual, Transcendental};
use verification::{RULES, curved_box, law, relative_difference, uniform};

const ORDERS: Orders = Orders { flow: 3, mesh: 3, time: 2 };

/// [first, vector, last] with a part that varies in space and time.
#[derive(Clone, Copy)]
struct Varying<const D: usize> {
    first: f64,
    vector: [f64; D],
    last: f64,
    amplitude: f64,
}

impl<const D: usize> Varying<D> {
    fn at<T: Transcendental, const M: usize>(&self, x: &[T; D], t: T) -> [T; M] {
        let mean = |m: usize| match m {
            0 => self.first,
            m if m <= D => self.vector[m - 1],
            _ => self.last,
        };
        let wave = |m: usize| (x[0] * 2.0 + x[D - 1] * (1.0 + m as f64) + t * 3.0).sin() * self.amplitude;
        std::array::from_fn(|m| wave(m) * mean(m) + mean(m))
    }
}

impl<const D: usize, const M: usize> StateField<D, M> for Varying<D> {
    fn value(&self, x: &[f64; D], t: f64) -> [f64; M] {
        self.at(x, t)
    }
    fn dual(&self, x: &[Dual<f64>; D], t: f64) -> [Dual<f64>; M] {
        self.at(x, Dual::from(t))
    }
}

/// Values that suit the uniform state, as numbers and at points.
fn conditions<const D: usize>() -> (Varying<D>, [[Boundary<D>; 2]; 4]) {
    let (first, vector, last) = (2.0, uniform::<D>().velocity, 1.7);
    let pairs = [
        [Boundary::Inflow(Inflow::new(first, last, vector).unwrap()), Boundary::Inflow(Inflow::at_points())],
        [Boundary::Outflow(Outflow::new(first, last).unwrap()), Boundary::Outflow(Outflow::at_points())],
        [
            Boundary::AdiabaticWall(AdiabaticWall::new(vector).unwrap()),
            Boundary::AdiabaticWall(AdiabaticWall::at_points()),
        ],
        [
            Boundary::IsothermalWall(IsothermalWall::new(last, vector).unwrap()),
            Boundary::IsothermalWall(IsothermalWall::at_points()),
        ],
    ];
    (Varying { first, vector, last, amplitude: 0.0 }, pairs)
}

/// A moving slab with `condition` on all boundaries, its data, and a source of the law.
fn slab<const D: usize, const M: usize>(
    condition: Boundary<D>,
    data: Varying<D>,
    source: Option<(Source<D>, Varying<D>)>,
) -> (Operator<D, M>, Vec<f64>)
where
    Exact<FreeStream<D>>: StateField<D, M>,
    NavierStokes<D>: Compiled<D, M, Boundary = Boundary<D>>,
{
    let law = law(Viscosity::Constant(0.02), Riemann::Roe);
    let law = NavierStokes { source: source.map_or(Source::Given, |(meaning, _)| meaning), ..law };
    let (mut operator, state) =
        moving_slab_on::<D, M>(RULES[0], &curved_box(2, ORDERS.mesh), 0.0, ORDERS, law, condition);
    for given in operator.problem.data.iter_mut().flatten() {
        *given = Arc::new(data);
    }
    operator.problem.source = source.map(|(_, field)| Arc::new(field) as Arc<dyn StateField<D, M>>);
    (operator, state)
}

fn residual<const D: usize, const M: usize>((mut operator, state): (Operator<D, M>, Vec<f64>)) -> Vec<f64> {
    let (state, _) = perturbed(&state, 3);
    let mut residual = vec![0.0; state.len()];
    operator.residual(&state, &mut residual).unwrap();
    residual
}

fn check_constants<const D: usize, const M: usize>()
where
    Exact<FreeStream<D>>: StateField<D, M>,
    NavierStokes<D>: Compiled<D, M, Boundary = Boundary<D>>,
{
    let (data, pairs) = conditions::<D>();
    for [numbers, at_points] in pairs {
        let expected = residual(slab::<D, M>(numbers, data, None));
        let error = relative_difference(&residual(slab::<D, M>(at_points, data, None)), &expected);
        assert!(error < 1e-14, "{at_points:?}: {error:.1e}");
        let other = Varying { amplitude: 0.01, ..data };
        let changed = relative_difference(&residual(slab::<D, M>(at_points, other, None)), &expected);
        assert!(changed > 1e-6, "{at_points:?}: the data act, {changed:.1e}");
    }
}

/// Data that are the same everywhere give the residual of the numbers.
#[test]
fn constant_data_give_the_residual_of_the_numbers() {
    check_constants::<2, 4>();
    check_constants::<3, 5>();
}

fn check_products<const D: usize, const M: usize>()
where
    Exact<FreeStream<D>>: StateField<D, M>,
    NavierStokes<D>: Compiled<D, M, Boundary = Boundary<D>>,
{
    let (data, pairs) = conditions::<D>();
    let data = Varying { amplitude: 0.05, ..data };
    let others = [VelocityInflow::OfVelocity, VelocityInflow::OfMassFlux].map(Boundary::VelocityInflow);
    for condition in pairs.into_iter().map(|[_, at_points]| at_points).chain(others) {
        let (state, both) = errors_of_products(slab::<D, M>(condition, data, None));
        assert!(state < 1e-7 && both < 1e-7, "{condition:?}: {state:.1e} {both:.1e}");
    }
    let target = uniform::<D>().to_conserved(&law::<D>(Viscosity::Inviscid, Riemann::Roe).gas);
    let forcing = Varying { first: 3.0, vector: [0.4; D], last: 0.2, amplitude: 0.3 };
    for source in [Source::Given, Source::Acceleration, Source::Sponge { target }] {
        let (state, both) = errors_of_products(slab::<D, M>(pairs[1][0], data, Some((source, forcing))));
        assert!(state < 1e-7 && both < 1e-7, "{source:?}: {state:.1e} {both:.1e}");
    }
}

/// Data and strengths of sources that vary in space change with the mesh, and products with the Jacobian know it.
#[test]
fn products_are_the_derivative_for_data_and_sources_that_vary() {
    check_products::<2, 4>();
    check_products::<3, 5>();
}
