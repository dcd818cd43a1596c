//! The floating-point operations of a residual and of a product.

use super::moving_slab_on;
use fem::{Differentiate, Orders, StateField};
use navier_stokes::exact::FreeStream;
use navier_stokes::{Boundary, Compiled, Exact, NavierStokes, Riemann, Viscosity};
use verification::{RULES, Rule, curved_box, law, prescribed};

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
