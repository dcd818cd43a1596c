//! Products with the Jacobian are derivatives of the residual.

use super::{capturing, errors_of_products, every_condition, moving_slab_on};
use fem::{Orders, StateField};
use navier_stokes::exact::FreeStream;
use navier_stokes::{Boundary, Compiled, Exact, NavierStokes, Riemann, Viscosity};
use verification::{RULES, Rule, curved_box, law, prescribed};

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
