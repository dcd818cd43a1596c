//! The entropy that the volume terms produce or destroy in a flow that the mesh does not resolve, with and without (entropy viscosity).

use fem::{Bottom, ConservationLaw, Orders, PointFamily, Quadrature, SlabOperator};
use mesh::{BoxMesh, Curving, Mesh};
use navier_stokes::exact::FreeStream;
use navier_stokes::{Boundary, Compiled, Exact, NavierStokes, Primitive, Riemann, Viscosity, VolumeFlux};
use std::f64::consts::TAU;
use verification::{free_stream, gas, law, operator_by, prescribed};

const N: usize = 4;

fn periodic_box<const D: usize>() -> Mesh<D> {
    let curving = Curving::Random { amplitude: 0.03, seed: 7 };
    BoxMesh { lower: [0.0; D], upper: [1.0; D], cells: [3; D], order: N, curving, periodic: [true; D] }
        .build()
        .unwrap()
        .scrambled(3)
}

/// A continuous state with waves of a few nodes; `sign` reverses the flow.
fn waves<const D: usize, const M: usize>(x: [f64; D], sign: f64) -> [f64; M] {
    let phase: f64 = x.iter().enumerate().map(|(d, x)| x * (1 + d) as f64).sum();
    let wave = |shift: f64| (TAU * phase + shift).sin();
    let velocity: [_; D] = std::array::from_fn(|d| sign * (0.3 + 0.5 * wave(d as f64)));
    Primitive { density: 1.0 + 0.3 * wave(0.5), velocity, pressure: 1.5 + 0.6 * wave(2.0) }
        .pack(&gas(Viscosity::Inviscid))
}

/// The coefficients of the waves, `[cell][component][node]`.
fn coefficients<const D: usize, const M: usize>(mesh: &Mesh<D>, sign: f64) -> Vec<f64> {
    let nodes = N.pow(D as u32);
    let of_cell = |cell: usize| {
        let x = mesh.cell_coordinates(cell);
        let states: Vec<[f64; M]> =
            (0..nodes).map(|i| waves::<D, M>(std::array::from_fn(|d| x[D * i + d]), sign)).collect();
        (0..M).flat_map(move |m| states.iter().map(|u| u[m]).collect::<Vec<_>>())
    };
    (0..mesh.n_cells()).flat_map(of_cell).collect()
}

/// v . R for a state that is the same at the bottom and in the slab: R are the terms of space alone. The state is continuous, so facets
/// neither produce nor destroy entropy.
fn produced<const D: usize, const M: usize>(volume_flux: VolumeFlux, sign: f64) -> f64
where
    Exact<FreeStream<D>>: fem::StateField<D, M>,
    NavierStokes<D>: Compiled<D, M, Boundary = Boundary<D>>,
{
    let (mesh, orders) = (periodic_box::<D>(), Orders { flow: N, mesh: N, time: 1 });
    let law = NavierStokes { volume_flux, ..law(Viscosity::Inviscid, Riemann::LaxFriedrichs) };
    let rule = Quadrature::Collocated(PointFamily::Lobatto);
    let data = free_stream::<D, M>(&law);
    let mut operator: SlabOperator<D, M> = operator_by(rule, &mesh, law, orders, prescribed(), data);
    let state = coefficients::<D, M>(&mesh, sign);
    let at_rest = vec![0.0; operator.mesh.field_len()];
    operator.begin_slab(0.0, 1.0, Bottom::new(&state, &at_rest));
    operator.set_mesh(&at_rest);
    let mut residual = vec![0.0; state.len()];
    operator.residual(&state, &mut residual).unwrap();
    let nodes = N.pow(D as u32);
    let of_node = |(r, u): (&[f64], &[f64]), i: usize| -> f64 {
        let variables = ConservationLaw::<D, M>::entropy_variables(&law, &std::array::from_fn(|m| u[m * nodes + i]));
        (0..M).map(|m| variables[m] * r[m * nodes + i]).sum()
    };
    let cells = residual.chunks_exact(M * nodes).zip(state.chunks_exact(M * nodes));
    cells.flat_map(|cell| (0..nodes).map(move |i| (cell, i))).map(|(cell, i)| of_node(cell, i)).sum()
}

/// The production of all cells changes its sign with that of the flow.
fn no_cell_destroys_entropy<const D: usize, const M: usize>()
where
    Exact<FreeStream<D>>: fem::StateField<D, M>,
    NavierStokes<D>: Compiled<D, M, Boundary = Boundary<D>>,
{
    let [forth, back] = [1.0, -1.0].map(|sign| produced::<D, M>(VolumeFlux::Central, sign));
    assert!(forth.abs() > 0.1 && (forth + back).abs() < 1e-12, "{forth:e} {back:e}");
    for (sign, central) in [(1.0, forth), (-1.0, back)] {
        let two_point = produced::<D, M>(VolumeFlux::Entropy, sign);
        assert!(two_point.abs() < 1e-12, "two-point flux: {two_point:e}");
        let corrected = produced::<D, M>(VolumeFlux::EntropyViscosity, sign);
        // Less x_r.
        assert!(corrected > central.max(0.0) - 1e-9, "{sign}: {corrected:e} {central:e}");
    }
}

#[test]
fn no_cell_destroys_entropy_in_2d() {
    no_cell_destroys_entropy::<2, 4>();
}

#[test]
fn no_cell_destroys_entropy_in_3d() {
    no_cell_destroys_entropy::<3, 5>();
}
