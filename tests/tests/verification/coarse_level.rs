//! The coarse level of the preconditioner by blocks.

use crate::shares::between_walls;
use crate::slab_operator::{moving_slab_on, uniform_coefficients};
use coupled::preconditioner::{CoarseLevelUse, TimeScales, TwoLevel};
use fem::{Blocks, Bottom, Orders, Share, SlabOperator, StateField};
use mesh::{BoxMesh, Curving, Mesh};
use navier_stokes::exact::FreeStream;
use navier_stokes::{Boundary, Compiled, Exact, NavierStokes, Riemann, Viscosity};
use newton_krylov::operator::Preconditioner;
use ranks::{Communicator, Sums, Threads};
use std::sync::Arc;
use verification::{Noise, RULES, free_stream, law, own_part, prescribed, relative_difference};

const N: usize = 3;

/// The right-hand sides of the sweeps are in single precision.
const SINGLE: f64 = 1e-5;

/// A box of `cells` per axis whose reference cells are turned at random, periodic along axes with one cell.
fn turned_box<const D: usize>(cells: [usize; D]) -> Mesh<D> {
    let periodic = cells.map(|cells| cells == 1);
    let plain = BoxMesh { lower: [0.0; D], upper: [1.0; D], cells, order: N, curving: Curving::None, periodic };
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
fn error_on_coarse_space<const D: usize, const M: usize>(
    cells: [usize; D],
    viscosity: Viscosity,
    (time, most): (usize, usize),
) -> f64
where
    Exact<FreeStream<D>>: StateField<D, M>,
    NavierStokes<D>: Compiled<D, M, Boundary = Boundary<D>>,
{
    let (orders, mesh) = (Orders { flow: N, mesh: N, time }, turned_box(cells));
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
            let error = error_on_coarse_space::<2, 4>([3, 3], viscosity, (time, most));
            assert!(error < SINGLE, "2-D, {viscosity:?}, N_t = {time}, {most} aggregates: {error:.1e}");
        }
        for (time, most) in [(1, 27), (2, 5)] {
            let error = error_on_coarse_space::<3, 5>([3, 3, 3], viscosity, (time, most));
            assert!(error < SINGLE, "3-D, {viscosity:?}, N_t = {time}, {most} aggregates: {error:.1e}");
        }
    }
}

/// Across a periodic boundary a cell is its own neighbour. That coupling was lost.
#[test]
fn the_coarse_level_is_exact_on_meshes_one_cell_wide() {
    for viscosity in [Viscosity::Inviscid, Viscosity::Constant(0.02)] {
        for most in [5, 2] {
            let error = error_on_coarse_space::<2, 4>([5, 1], viscosity, (2, most));
            assert!(error < SINGLE, "2-D, {viscosity:?}, {most} aggregates: {error:.1e}");
        }
        let error = error_on_coarse_space::<3, 5>([3, 1, 2], viscosity, (1, 6));
        assert!(error < SINGLE, "3-D, {viscosity:?}: {error:.1e}");
    }
}

/// A slab of uniform flow between walls on the cells of a share.
fn slab_of(mesh: &Mesh<2>, share: Share) -> SlabOperator<2, 4> {
    let law = law(Viscosity::Constant(0.02), Riemann::Roe);
    let orders = Orders { flow: N, mesh: N, time: 2 };
    let mut operator: SlabOperator<2, 4> = between_walls(mesh, &law, orders, RULES[0].0, share);
    let uniform = |slots| uniform_coefficients(&operator, &free_stream::<2, 4>(&law).value(&[0.0; 2], 0.0), slots);
    let (bottom, state, rest) = (uniform(1), uniform(2), vec![0.0; 2 * operator.mesh.field_len()]);
    operator.begin_slab(0.0, 0.1, Bottom::new(&bottom, &rest[..rest.len() / 2]));
    operator.set_mesh(&rest);
    operator.linearise(&state);
    operator
}

/// The bits of z = P^{-1} r on the whole mesh, for a random r, found by so many `ranks`.
fn applied(mesh: &Mesh<2>, blocks: &Blocks, most: usize, ranks: usize) -> Vec<u64> {
    let count = blocks.of_cell.iter().max().map_or(0, |block| block + 1);
    let of_rank = |communicator: Arc<dyn Communicator>| -> Vec<u64> {
        let share = Share::new(mesh, blocks, Arc::new(Sums::new(communicator, count)));
        let operator = slab_of(mesh, share);
        let scales = TimeScales { dt: 0.1, damping: 0.0 };
        let mut levels = TwoLevel::<f32>::with_aggregates(&operator, scales, None, (CoarseLevelUse::Always, most));
        let r = own_part(&operator.share, &Noise::new(3).vector(mesh.n_cells() * operator.layout.cell_len(), 1.0));
        let mut z = vec![0.0; r.len()];
        levels.apply(&r, &mut z);
        operator.share.join(&z).iter().map(|z| z.to_bits()).collect()
    };
    Threads::run(ranks, of_rank).swap_remove(0)
}

/// Aggregates lie within blocks, and every rank solves for all of them.
#[test]
fn the_coarse_level_has_the_same_bits_on_any_number_of_ranks() {
    let mesh = turned_box([6, 6]);
    let blocks = Blocks { of_cell: mesh::blocks(&mesh, 4).expect("blocks"), groups: 1 };
    for most in [36, 12, 4] {
        let alone = applied(&mesh, &blocks, most, 1);
        assert!(alone.iter().any(|z| f64::from_bits(*z) != 0.0));
        for ranks in [2, 3, 4] {
            assert!(applied(&mesh, &blocks, most, ranks) == alone, "{ranks} ranks, {most} aggregates");
        }
    }
}
