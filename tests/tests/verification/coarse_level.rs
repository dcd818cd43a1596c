//! The coarse level of the preconditioner of steady flows.

use crate::slab_operator::moving_slab;
use coupled::preconditioner::{BlockIlu, CoarseLevel, TimeScales};
use fem::{Orders, StateField};
use navier_stokes::exact::FreeStream;
use navier_stokes::{Boundary, Compiled, Exact, NavierStokes, Riemann, Viscosity};
use verification::{Noise, prescribed, relative_difference};

const N: usize = 3;

/// A field that is linear along every axis of every cell, with random coefficients: `[cell][component][node]` at the nodes -1, 0, 1.
fn linear_field(dimension: u32, components: usize, seed: u64) -> Vec<f64> {
    let (mut noise, corners) = (Noise::new(seed), 2_usize.pow(dimension));
    (0..components)
        .flat_map(|_| {
            let values: Vec<f64> = (0..corners).map(|_| noise.number()).collect();
            (0..N.pow(dimension)).map(move |node| {
                let weight = |corner: usize, d: u32| {
                    let (x, side) = (node / N.pow(d) % N, corner / 2_usize.pow(d) % 2);
                    0.5 * if side == 1 { x as f64 } else { 2.0 - x as f64 }
                };
                let product = |corner: usize| (0..dimension).map(|d| weight(corner, d)).product::<f64>();
                (0..corners).map(|corner| values[corner] * product(corner)).sum()
            })
        })
        .collect()
}

/// z = P x and r = B z: the coarse level alone must recover z, for any sweeps.
fn error_on_coarse_space<const D: usize, const M: usize>(viscosity: Viscosity) -> f64
where
    Exact<FreeStream<D>>: StateField<D, M>,
    NavierStokes<D>: Compiled<D, M, Boundary = Boundary<D>>,
{
    let orders = Orders { flow: N, mesh: N, time: 1 };
    let (mut operator, state) = moving_slab::<D, M>(orders, viscosity, Riemann::Roe, 2, prescribed());
    operator.set_mesh(&vec![0.0; operator.mesh.field_len()]);
    operator.linearise(&state);
    let (layout, dt) = (operator.layout, operator.interval().1);
    let z = linear_field(D as u32, layout.cells * M, 5);
    let mut r = vec![0.0; z.len()];
    operator.product(&z, &mut r);

    let mut sweeps = BlockIlu::new(&operator, TimeScales { dt, damping: 0.0 }, None);
    let coarse = CoarseLevel::new(&sweeps, N).expect("memory suffices");
    let mut coarse = coarse.expect("the coarse matrix is regular");
    let mut found = vec![0.0; z.len()];
    coarse.apply(&mut sweeps, &r, &mut found);
    relative_difference(&found, &z)
}

#[test]
fn the_coarse_level_is_exact_on_its_space() {
    for viscosity in [Viscosity::Inviscid, Viscosity::Constant(0.02)] {
        let error = error_on_coarse_space::<2, 4>(viscosity);
        assert!(error < 1e-10, "2-D, {viscosity:?}: {error:.1e}");
        let error = error_on_coarse_space::<3, 5>(viscosity);
        assert!(error < 1e-10, "3-D, {viscosity:?}: {error:.1e}");
    }
}
