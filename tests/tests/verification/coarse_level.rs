//! The coarse level of the preconditioner by blocks.

use crate::slab_operator::moving_slab_on;
use coupled::preconditioner::{CoarseLevelUse, TimeScales, TwoLevel};
use fem::{Orders, StateField};
use mesh::{BoxMesh, Curving, Mesh};
use navier_stokes::exact::FreeStream;
use navier_stokes::{Boundary, Compiled, Exact, NavierStokes, Riemann, Viscosity};
use newton_krylov::operator::Preconditioner;
use verification::{Noise, RULES, law, prescribed, relative_difference};

const N: usize = 3;

/// The right-hand sides of the sweeps are in single precision.
const SINGLE: f64 = 1e-5;

/// A box of `cells` per axis whose reference cells are turned at random.
fn turned_box<const D: usize>(cells: usize) -> Mesh<D> {
    let cells = [cells; D];
    let plain =
        BoxMesh { lower: [0.0; D], upper: [1.0; D], cells, order: N, curving: Curving::None, periodic: [false; D] };
    plain.build().expect("a box").scrambled(3)
}

/// A field with the `values` of its corners, linear in every direction.
fn multilinear(values: &[f64], x: &[f64]) -> f64 {
    let factor = |corner: usize, d: usize| if corner >> d & 1 == 1 { x[d] } else { 1.0 - x[d] };
    let weight = |corner: usize| (0..x.len()).map(|d| factor(corner, d)).product::<f64>();
    values.iter().enumerate().map(|(corner, value)| value * weight(corner)).sum()
}

/// Random fields at all time nodes: linear in every direction of each cell, or of the whole box. All aggregates have the latter.
fn coarse_vector<const D: usize>(mesh: &Mesh<D>, components: usize, times: usize, in_cells: bool) -> Vec<f64> {
    let mut noise = Noise::new(5);
    let mut values = || -> Vec<f64> { (0..1 << D).map(|_| noise.number()).collect() };
    let (count, cells) = (times * components, if in_cells { mesh.n_cells() } else { 1 });
    let fields: Vec<Vec<f64>> = (0..count * cells).map(|_| values()).collect();
    let nodes = [0.0, 0.5, 1.0];
    let of_cell = |cell: usize, fields: &[Vec<f64>]| -> Vec<f64> {
        let at = |node: usize| -> [f64; D] {
            let reference = std::array::from_fn(|d| nodes[node / N.pow(d as u32) % N]);
            if in_cells { reference } else { std::array::from_fn(|d| mesh.cell_coordinates(cell)[node * D + d]) }
        };
        fields.iter().flat_map(|values| (0..N.pow(D as u32)).map(|node| multilinear(values, &at(node)))).collect()
    };
    let first = |cell: usize| if in_cells { cell * count } else { 0 };
    (0..mesh.n_cells()).flat_map(|cell| of_cell(cell, &fields[first(cell)..][..count])).collect()
}

/// z = P x and r = B z: the coarse level alone must recover z, for any sweeps. The mesh rests and the flow is uniform, so that (decoupled)
/// is exact.
fn error_on_coarse_space<const D: usize, const M: usize>(viscosity: Viscosity, time: usize, most: usize) -> f64
where
    Exact<FreeStream<D>>: StateField<D, M>,
    NavierStokes<D>: Compiled<D, M, Boundary = Boundary<D>>,
{
    let (orders, mesh) = (Orders { flow: N, mesh: N, time }, turned_box::<D>(3));
    let law = law(viscosity, Riemann::Roe);
    let (mut operator, state) = moving_slab_on::<D, M>(RULES[0], &mesh, 0.0, orders, law, prescribed());
    operator.set_mesh(&vec![0.0; time * operator.mesh.field_len()]);
    operator.linearise(&state);
    let z = coarse_vector(&mesh, M, time, most >= mesh.n_cells());
    let mut r = vec![0.0; z.len()];
    operator.product(&z, &mut r);

    let scales = TimeScales { dt: operator.interval().1, damping: 0.0 };
    let mut levels = TwoLevel::<f64>::with_aggregates(&operator, scales, None, (CoarseLevelUse::Always, most));
    let mut found = vec![0.0; z.len()];
    levels.apply(&r, &mut found);
    relative_difference(&found, &z)
}

/// Cells alone, pairs, and aggregates of many cells; real and complex modes.
#[test]
fn the_coarse_level_is_exact_on_its_space() {
    for viscosity in [Viscosity::Inviscid, Viscosity::Constant(0.02)] {
        for (time, most) in [(1, 9), (1, 5), (3, 9), (3, 3), (2, 1)] {
            let error = error_on_coarse_space::<2, 4>(viscosity, time, most);
            assert!(error < SINGLE, "2-D, {viscosity:?}, N_t = {time}, {most} aggregates: {error:.1e}");
        }
        for (time, most) in [(1, 27), (2, 5)] {
            let error = error_on_coarse_space::<3, 5>(viscosity, time, most);
            assert!(error < SINGLE, "3-D, {viscosity:?}, N_t = {time}, {most} aggregates: {error:.1e}");
        }
    }
}
