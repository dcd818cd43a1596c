//! The blocks of the preconditioner make the Jacobian.

use super::{capturing, moving_slab_on, perturbed};
use fem::{Orders, StateField};
use navier_stokes::exact::FreeStream;
use navier_stokes::{Boundary, Compiled, Exact, NavierStokes, Riemann, Viscosity};
use verification::{RULES, Rule, curved_box, law, prescribed, relative_difference};

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
