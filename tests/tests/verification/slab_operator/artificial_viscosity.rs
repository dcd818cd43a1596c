//! An artificial viscosity conserves, and leaves a uniform flow alone.

use super::{capturing, moving_slab_on, perturbed};
use fem::Orders;
use navier_stokes::{Boundary, FarField, NavierStokes, Riemann, Viscosity};
use verification::{RULES, curved_box, law, prescribed, relative_difference, uniform};

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
