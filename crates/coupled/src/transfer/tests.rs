#![allow(clippy::unwrap_used, clippy::print_stdout)]
use super::*;
use crate::motion::MeshMotion;
use crate::state::Interval;
use mesh::{BoxMesh, Curving, NodeNumbering};

const MESH: usize = 3;

/// Numbers in [-1, 1] that look random.
fn scattered(count: usize, seed: f64) -> Vec<f64> {
    (0..count).map(|i| (12.9898 * (i as f64 + seed) * (i as f64 + 1.7)).sin()).collect()
}

/// A curved mesh that has moved, and a state of `components` on it.
fn moved<const D: usize>(components: usize, orders: Orders) -> (MeshMover<D>, State) {
    let curving = Curving::Random { amplitude: 0.03, seed: 5 };
    let (lower, upper, cells, periodic) = ([0.0; D], [1.0; D], [2; D], [false; D]);
    let mesh = BoxMesh { lower, upper, cells, order: MESH, curving, periodic }.build().unwrap();
    let numbering = NodeNumbering::new(&mesh, MESH);
    let mover = MeshMover::new(MeshMotion::Still, mesh, numbering, orders.time);
    let len = mover.reference.n_cells() * components * orders.flow.pow(D as u32);
    let d: Vec<f64> = scattered(mover.field_len(), 0.5).iter().map(|d| 0.02 * d).collect();
    let past = Past {
        interval: Interval { start: 0.0, end: 0.1, halvings: 0 },
        dt: 0.1,
        bottom: vec![0.0; d.len()],
        u: scattered(orders.time * len, 2.0).into(),
        v: scattered(orders.time * d.len(), 3.0).into(),
        bodies: vec![scattered(orders.time * 3, 4.0), scattered(orders.time, 5.0)],
    };
    (mover, State { past: Some(past), slab: 1, ..State::new(0.1, scattered(len, 1.0), d) })
}

/// The integral of every component over every cell, by more points than are needed.
fn integrals<const D: usize>(mover: &MeshMover<D>, state: &State, order: usize) -> Vec<f64> {
    let rule = gauss(12);
    let sampler = Sampler::<D>::new(order, MESH, &rule.points);
    let cells = mover.reference.n_cells();
    let integral = |cell: usize| -> Vec<f64> {
        let jacobians = sampler.determinants(&mover.cell_positions(cell, &state.d));
        let values = sampler.state(&state.u[cell * state.u.len() / cells..(cell + 1) * state.u.len() / cells]);
        let weight = |p: usize| (0..D as u32).map(|d| rule.weights[p / 12_usize.pow(d) % 12]).product::<f64>();
        let component = |u: &[f64]| (0..u.len()).map(|p| weight(p) * jacobians[p] * u[p]).sum();
        values.chunks_exact(sampler.points()).map(component).collect()
    };
    (0..cells).flat_map(integral).collect()
}

fn largest_difference(x: &[f64], y: &[f64]) -> f64 {
    assert_eq!(x.len(), y.len());
    x.iter().zip(y).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max)
}

fn assert_integrals_are_kept<const D: usize>(from: usize, to: usize) {
    let [from, to] = [from, to].map(|flow| Orders { flow, mesh: MESH, time: 2 });
    let (mover, state) = moved::<D>(D + 2, from);
    let there = state.transfer(&mover, D + 2, from, to);
    let (before, after) = (integrals(&mover, &state, from.flow), integrals(&mover, &there, to.flow));
    let size = before.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    let error = largest_difference(&before, &after) / size;
    println!("{D}-D, N_s = {} to {}: integrals kept to {error:.1e}", from.flow, to.flow);
    // Round-off of sums of thousands of terms of both signs.
    assert!(error < 1e-14, "{D}-D, {} to {}: {error:e}", from.flow, to.flow);
}

#[test]
fn every_component_of_every_cell_is_kept() {
    for (from, to) in [(2, 5), (3, 4), (5, 4), (6, 2), (8, 5)] {
        assert_integrals_are_kept::<2>(from, to);
    }
    assert_integrals_are_kept::<3>(2, 4);
    assert_integrals_are_kept::<3>(4, 3);
}

/// What is embedded in a higher order, and in more nodes in time, comes back as it was: the polynomials are the same.
#[test]
fn there_and_back_nothing_is_lost() {
    let [low, high] = [(3, 2), (5, 4)].map(|(flow, time)| Orders { flow, mesh: MESH, time });
    let (mover, state) = moved::<2>(4, low);
    let there = state.transfer(&mover, 4, low, high);
    let lengths = |state: &State| state.past.as_ref().unwrap().bodies.iter().map(Vec::len).collect::<Vec<_>>();
    assert_eq!((lengths(&state), lengths(&there)), (vec![6, 2], vec![12, 4]), "unknowns of the bodies");
    let back = there.transfer(&mover, 4, high, low);
    assert!(largest_difference(&back.u, &state.u) < 1e-13);
    let (past, before) = (back.past.unwrap(), state.past.unwrap());
    assert!(largest_difference(&past.u, &before.u) < 1e-13);
    assert!(largest_difference(&past.v, &before.v) < 1e-13);
    assert!(largest_difference(&past.bodies.concat(), &before.bodies.concat()) < 1e-13);
    assert_eq!((back.time, back.slab, past.interval), (0.1, 1, before.interval));
}

/// (transfer) holds for every polynomial of the lower order: the difference to the projection is orthogonal to it.
#[test]
fn the_projection_is_the_nearest_polynomial() {
    let [from, to] = [6, 3].map(|flow| Orders { flow, mesh: MESH, time: 1 });
    let (mover, state) = moved::<2>(1, from);
    let nearest = state.transfer(&mover, 1, from, to);
    // In the higher order both can be compared.
    let squared_distance = |there: &State| {
        let embedded = there.transfer(&mover, 1, to, from);
        let product = State { u: state.u.iter().zip(&embedded.u).map(|(u, v)| u - v).collect(), ..state.clone() };
        let (rule, cells) = (gauss(12), mover.reference.n_cells());
        let sampler = Sampler::<2>::new(from.flow, MESH, &rule.points);
        let cell = |cell: usize| -> f64 {
            let jacobians = sampler.determinants(&mover.cell_positions(cell, &state.d));
            let values =
                sampler.state(&product.u[cell * product.u.len() / cells..(cell + 1) * product.u.len() / cells]);
            (0..144).map(|p| rule.weights[p % 12] * rule.weights[p / 12] * jacobians[p] * values[p].powi(2)).sum()
        };
        (0..cells).map(cell).sum::<f64>()
    };
    let least = squared_distance(&nearest);
    for (i, step) in [(0, 1e-3), (7, -1e-3), (13, 1e-3), (35, -1e-3)] {
        let mut other = nearest.clone();
        other.u[i] += step;
        assert!(squared_distance(&other) > least, "coefficient {i}");
    }
}
