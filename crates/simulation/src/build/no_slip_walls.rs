//! The velocities of no-slip walls at the start of a run, and the boundary layer that an initial state may get there.

use case::{Case, Data, Flow};
use coupled::{LayerWall, MeshMover, StartLayer};
use fem::StateField;
use navier_stokes::{Boundary, Conserved, Exact};
use newton_krylov::inner_product::largest;
use std::array::from_fn;
use tensor::{dot, norm};

/// An initial state contradicts a wall if their velocities differ by more than this part of the largest velocity of gas and walls. Below, a
/// boundary layer in place of the initial state would change more than it helps.
const CONTRADICTION: f64 = 0.1;

/// A wall to which gas sticks.
pub(super) struct NoSlipWall<const D: usize> {
    boundary: usize,
    /// Position and velocity of the wall at its C0 nodes.
    nodes: Vec<[[f64; D]; 2]>,
}

/// The walls to which gas sticks.
pub(super) fn no_slip_walls<const D: usize>(
    case: &Case<D>,
    flow: &Flow<D>,
    mover: &MeshMover<D>,
) -> Vec<NoSlipWall<D>> {
    let start = case.time.start;
    let mut of_mesh = vec![0.0; mover.field_len()];
    mover.prescribe_velocity(start, &mut of_mesh);
    let of_wall = |wall: &case::Wall<D>| {
        let boundary = wall.boundary;
        let slide = slide(flow, boundary)?;
        let normals = case.mesh.boundary_normals(&mover.numbering, boundary).unwrap_or_default();
        let node = |node: usize| {
            let (x, n) = (mover.positions()[node], normals.get(&node).copied().unwrap_or([0.0; D]));
            let slide = slide(&x, start);
            let along_normal = dot(&slide, &n);
            [x, from_fn(|i| of_mesh[node * D + i] + slide[i] - along_normal * n[i])]
        };
        let nodes = mover.numbering.on_boundary(&case.mesh, boundary).into_iter().map(node).collect();
        Some(NoSlipWall { boundary, nodes })
    };
    flow.walls.iter().filter_map(of_wall).collect()
}

/// The velocity with which a no-slip wall slides, by position and time. `None` for other boundaries.
type Slide<'a, const D: usize> = Box<dyn Fn(&[f64; D], f64) -> [f64; D] + 'a>;

fn slide<const D: usize>(flow: &Flow<D>, boundary: usize) -> Option<Slide<'_, D>> {
    let data = &flow.boundary[boundary];
    let uniform = match &data.condition {
        Boundary::AdiabaticWall(wall) => wall.slide(),
        Boundary::IsothermalWall(wall) => wall.slide(),
        _ => return None,
    };
    match (uniform, &data.data) {
        (None, Some(Data::Values(values))) => Some(Box::new(|x, t| values.vector.evaluate(x, t))),
        (slide, _) => Some(Box::new(move |_, _| slide.unwrap_or([0.0; D]))),
    }
}

/// The layer at these walls.
pub(super) fn layer_at<const D: usize>(walls: &[NoSlipWall<D>]) -> StartLayer {
    let mean = |wall: &NoSlipWall<D>| {
        let total = |axis: usize| wall.nodes.iter().map(|[_, w]| w[axis]).sum::<f64>();
        let velocity = (0..D).map(|axis| total(axis) / wall.nodes.len().max(1) as f64).collect();
        LayerWall { boundary: wall.boundary, velocity }
    };
    StartLayer::new(walls.iter().map(mean).collect())
}

/// Whether the initial state has another velocity than a wall somewhere.
pub(super) fn contradicts<const D: usize, const M: usize>(
    walls: &[NoSlipWall<D>],
    flow: &Flow<D>,
    mover: &MeshMover<D>,
    start: f64,
) -> bool {
    let initial = Exact(flow.initial.clone());
    let of_gas = |x: &[f64; D]| {
        let u: [f64; M] = initial.value(x, start);
        Conserved::<f64, D>::unpack(&u).velocity()
    };
    let nodes = || walls.iter().flat_map(|wall| &wall.nodes);
    let speeds = mover.positions().iter().map(|x| norm(&of_gas(x))).chain(nodes().map(|[_, w]| norm(w)));
    let jump = |[x, w]: &[[f64; D]; 2]| {
        let of_gas = of_gas(x);
        norm(&from_fn::<f64, D, _>(|i| of_gas[i] - w[i]))
    };
    largest(nodes().map(jump)) > CONTRADICTION * largest(speeds)
}
