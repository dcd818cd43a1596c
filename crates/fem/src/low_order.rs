//! The operator of space on the control volumes of the nodes: a finite-volume method of first order with the unknowns of the flow, for
//! preconditioners (low-order refinement; Canuto, Quarteroni 1985; Pazner 2020).
//!
//! The control volume of a Gauss-Lobatto node has the extents omega_i of its quadrature weights. Faces inside a cell lie at b_i = -1 +
//! omega_1 + .. + omega_i. With the cofactors S_k of the map for the axis k normal to a face,
//!
//! ```text
//! R_i = sum over the faces of i:  Fhat |S_k| prod_(l /= k) omega_l,      M_i = J prod_l omega_l                      (low order)
//! Fhat = theta F*(u-, u+) + (1 - theta)/2 (F_c(u-) + F_c(u+)) . n - F_v({u}, (u+ - u-) n / h) . n                  (two-point)
//! ```
//!
//! Inside a cell theta = 1/2 and h is the distance of the two nodes. Between cells theta = 1, and 1/h is the penalty sigma of (sip): there the
//! nodes of both cells coincide, and Fhat is the scheme's own flux without the terms with gradients. The same holds on boundaries. An
//! unknown is coupled to 2 D others, whatever the order.

use crate::facet::penalty;
use crate::kernels::Kernels;
use crate::operator::SlabOperator;
use crate::parallel::{self, Grain};
use crate::per_thread::PerThread;
use crate::sub_cells::{CellMap, SubCells};
use crate::time_points::TimePoint;
use crate::two_point::FacePairs;
use mesh::{Side, axis_and_side, face_nodes};
use tensor::{WIDTH, norm};

/// theta of (two-point) on faces inside a cell. First-order dissipation is too strong for smooth polynomials; half of it needs the fewest
/// iterations.
const DISSIPATION_INSIDE: f64 = 0.5;

/// Marks a face node without a neighbour.
pub const NO_NEIGHBOUR: u32 = u32::MAX;

/// (low order) at one time of a slab, cell by cell.
pub struct LowOrder<'a, const D: usize, const M: usize> {
    operator: &'a SlabOperator<D, M>,
    sub_cells: SubCells,
    /// The flow at that time, `[cell][component][node]`.
    state: Vec<f64>,
    /// Weights of positions and velocities of the slots at that time.
    slots: [Vec<f64>; 2],
    time: f64,
    /// sigma of every cell at its face nodes, `[cell][face][face node]`.
    penalties: Vec<f32>,
    scratch: PerThread<Scratch>,
}

struct Scratch {
    map: CellMap,
    pairs: FacePairs,
    rows: LowOrderRows,
}

/// The rows of the nodes of a cell.
pub struct LowOrderRows {
    /// dR_i/du_i, `[node][column][row]`.
    pub diagonal: Vec<f64>,
    /// dR_i/du_j for the neighbour j across each face of the control volume, `[node][face][column][row]`. Blocks without a neighbour are 0.
    pub couplings: Vec<f64>,
}

/// The neighbours across the faces of every cell. A cell that is its own neighbour has none.
pub struct Neighbours {
    /// The number of the coinciding node of the neighbour, cell times nodes plus node, or [`NO_NEIGHBOUR`]; `[cell][face][face node]`.
    pub nodes: Vec<u32>,
    /// The face of the neighbour, `[cell][face]`.
    pub faces: Vec<u8>,
}

impl Neighbours {
    /// Those of the cells of `operator`.
    pub fn of<const D: usize, const M: usize>(operator: &SlabOperator<D, M>) -> Self {
        let nodes = operator.layout.nodes;
        let face_nodes: Vec<_> = (0..2 * D).map(|face| face_nodes(D, operator.tables.orders.flow, face)).collect();
        let of_face = |number: usize| -> Vec<u32> {
            let (cell, face) = (number / (2 * D), number % (2 * D));
            let across = |i: usize| match Opposite::of(operator, cell, face) {
                Opposite::Cell { cell: other, face, permutation, own_side } if other != cell => {
                    (other * nodes + face_nodes[face][opposite_node(permutation, own_side, i)]) as u32
                }
                _ => NO_NEIGHBOUR,
            };
            (0..face_nodes[face].len()).map(across).collect()
        };
        let face_across = |number: usize| match Opposite::of(operator, number / (2 * D), number % (2 * D)) {
            Opposite::Cell { face, .. } => face as u8,
            Opposite::Boundary(_) => 0,
        };
        let faces = operator.layout.cells * 2 * D;
        Neighbours {
            nodes: parallel::map(faces, Grain::Any, &of_face).concat(),
            faces: (0..faces).map(face_across).collect(),
        }
    }
}

impl<const D: usize, const M: usize> SlabOperator<D, M> {
    /// (low order) at position `s` of the slab, in the state and on the mesh last set.
    pub fn low_order(&self, s: f64) -> LowOrder<'_, D, M> {
        let (n, sub_cells) = (self.tables.orders.flow, SubCells::new::<D>(self.tables.orders));
        let (time_point, (_, dt)) = (TimePoint::of_space(&self.tables.time, s), self.interval());
        let slots = [time_point.position_row(dt).row(0).to_vec(), time_point.velocities.row(0).to_vec()];
        let face_nodes = n.pow(D as u32 - 1);
        let room = {
            let (map, nodes) = (sub_cells.clone(), self.layout.nodes);
            move || Scratch {
                map: CellMap::new::<D>(&map),
                pairs: FacePairs::new::<M>(),
                rows: LowOrderRows::new::<D, M>(nodes),
            }
        };
        let mut low_order = LowOrder {
            operator: self,
            sub_cells,
            state: self.state_at(s),
            slots,
            time: self.clock().time(s),
            penalties: vec![0.0; self.all_cells() * 2 * D * face_nodes],
            scratch: PerThread::new(room),
        };
        let mut penalties = std::mem::take(&mut low_order.penalties);
        parallel::for_each_chunk(&mut penalties, 2 * D * face_nodes, Grain::Any, &|cell, penalties| {
            low_order.scratch.with(|scratch| low_order.penalties_of(cell, &mut scratch.map, penalties));
        });
        low_order.penalties = penalties;
        low_order
    }
}

impl LowOrderRows {
    fn new<const D: usize, const M: usize>(nodes: usize) -> Self {
        let zeros = |blocks: usize| vec![0.0; nodes * blocks * M * M];
        LowOrderRows { diagonal: zeros(1), couplings: zeros(2 * D) }
    }
}

impl<const D: usize, const M: usize> LowOrder<'_, D, M> {
    /// Passes the rows of `cell` to `take`.
    pub fn with_rows<T>(&self, cell: usize, take: impl FnOnce(&LowOrderRows) -> T) -> T {
        self.scratch.with(|Scratch { map, pairs, rows }| {
            map.place::<D>(&self.operator.mesh, cell, &self.slots);
            rows.diagonal.fill(0.0);
            rows.couplings.fill(0.0);
            for axis in 0..D {
                map.evaluate_faces::<D>(&self.sub_cells, axis); // 1.
                self.faces_inside(cell, axis, map, pairs, rows); // 2.
                for side in 0..2 {
                    self.face_of_cell(cell, 2 * axis + side, map, pairs, rows); // 3.
                }
            }
            take(rows)
        })
    }

    /// M_i of the nodes of `cell`.
    pub fn masses(&self, cell: usize) -> Vec<f64> {
        self.scratch.with(|Scratch { map, .. }| {
            map.place::<D>(&self.operator.mesh, cell, &self.slots);
            map.evaluate_nodes::<D>(&self.sub_cells);
            let mass = |node: usize| map.area::<D>(node, 0).1 * self.sub_cells.weight::<D>(node, None);
            (0..self.operator.layout.nodes).map(mass).collect()
        })
    }

    fn kernels(&self) -> &dyn Kernels<D, M> {
        &*self.operator.problem.kernels
    }

    /// Nodes of a line.
    fn order(&self) -> usize {
        self.operator.tables.orders.flow
    }

    /// The state of a node, number cell times nodes plus node.
    fn state(&self, number: usize) -> [f64; M] {
        let nodes = self.operator.layout.nodes;
        let start = number / nodes * M * nodes + number % nodes;
        std::array::from_fn(|m| self.state[start + m * nodes])
    }

    /// Step 2: the faces across `axis` inside the cell.
    fn faces_inside(&self, cell: usize, axis: usize, map: &CellMap, pairs: &mut FacePairs, rows: &mut LowOrderRows) {
        let (n, nodes, tables) = (self.order(), self.operator.layout.nodes, &self.sub_cells);
        let stride = n.pow(axis as u32);
        let minus_nodes = || (0..nodes).filter(|node| node / stride % n + 1 < n);
        pairs.clear();
        for node in minus_nodes() {
            let point = tables.face_point(node, axis, 1);
            let (area, det) = map.area(point, axis);
            let near = norm(&area) / (det * tables.distance(node / stride % n));
            let weight = tables.weight::<D>(node, Some(axis));
            let states = [self.state(cell * nodes + node), self.state(cell * nodes + node + stride)];
            pairs.push::<D, M>(states, area.map(|a| a * weight), map.velocity(point), near);
        }
        self.kernels().two_point_fluxes(None, DISSIPATION_INSIDE, pairs);
        let [low, high] = [2 * axis, 2 * axis + 1];
        let face = |node: usize, face: usize| node * 2 * D + face;
        for (number, node) in minus_nodes().enumerate() {
            let next = node + stride;
            // The flux out of the node enters the next one.
            pairs.add(number, 0, 1.0, block::<M>(&mut rows.diagonal, node));
            pairs.add(number, 1, 1.0, block::<M>(&mut rows.couplings, face(node, high)));
            pairs.add(number, 1, -1.0, block::<M>(&mut rows.diagonal, next));
            pairs.add(number, 0, -1.0, block::<M>(&mut rows.couplings, face(next, low)));
        }
    }

    /// Step 3: a face of the cell, to a neighbour or on a boundary.
    fn face_of_cell(&self, cell: usize, face: usize, map: &CellMap, pairs: &mut FacePairs, rows: &mut LowOrderRows) {
        let (nodes, tables, (axis, side)) = (self.operator.layout.nodes, &self.sub_cells, axis_and_side(face));
        let opposite = Opposite::of(self.operator, cell, face);
        let outward = if side == 0 { -1.0 } else { 1.0 };
        pairs.clear();
        for (i, &node) in tables.face_nodes(face).iter().enumerate() {
            let point = tables.face_point(node, axis, side);
            let scale = outward * tables.weight::<D>(node, Some(axis));
            let area = map.area::<D>(point, axis).0.map(|a| a * scale);
            let own = self.penalty(cell, face, i);
            let (plus, penalty) = match opposite {
                Opposite::Boundary(boundary) => (self.prescribed(boundary, map.position(point)), own),
                Opposite::Cell { cell: other, face, permutation, own_side } => {
                    let j = opposite_node(permutation, own_side, i);
                    let number = other * nodes + tables.face_nodes(face)[j];
                    // Without its coupling, the viscous flux of a cell that is its own neighbour would hold the state in a thin cell.
                    let penalty = if other == cell { 0.0 } else { own.max(self.penalty(other, face, j)) };
                    (self.state(number), penalty)
                }
            };
            pairs.push::<D, M>([self.state(cell * nodes + node), plus], area, map.velocity(point), penalty);
        }
        let boundary = opposite.boundary();
        self.kernels().two_point_fluxes(boundary, 1.0, pairs);
        for (i, &node) in tables.face_nodes(face).iter().enumerate() {
            pairs.add(i, 0, 1.0, block::<M>(&mut rows.diagonal, node));
            if boundary.is_none() {
                pairs.add(i, 1, 1.0, block::<M>(&mut rows.couplings, node * 2 * D + face));
            }
        }
    }

    /// The data of the condition on a boundary at a point, 0 if it takes none.
    fn prescribed(&self, boundary: usize, x: [f64; D]) -> [f64; M] {
        self.operator.problem.data[boundary].as_ref().map_or([0.0; M], |field| field.value(&x, self.time))
    }

    /// sigma = N_s^2 |S| / J at the face nodes of a cell.
    fn penalties_of(&self, cell: usize, map: &mut CellMap, penalties: &mut [f32]) {
        let (n, tables) = (self.order(), &self.sub_cells);
        map.place::<D>(&self.operator.mesh, cell, &self.slots);
        map.evaluate_nodes::<D>(tables);
        for (face, penalties) in penalties.chunks_exact_mut(n.pow(D as u32 - 1)).enumerate() {
            for (sigma, &node) in penalties.iter_mut().zip(tables.face_nodes(face)) {
                let (area, det) = map.area::<D>(node, face / 2);
                *sigma = penalty(norm(&area), det.abs().recip(), n) as f32;
            }
        }
    }

    fn penalty(&self, cell: usize, face: usize, i: usize) -> f64 {
        let face_nodes = self.order().pow(D as u32 - 1);
        f64::from(self.penalties[(cell * 2 * D + face) * face_nodes + i])
    }
}

/// The neighbour across a face of a cell.
#[derive(Clone, Copy)]
enum Opposite<'a> {
    Boundary(usize),
    /// A face of another cell, the permutation of the facet's nodes if there is one, and the side of the facet that the first cell is on.
    Cell {
        cell: usize,
        face: usize,
        permutation: Option<&'a [usize]>,
        own_side: u8,
    },
}

impl<'a> Opposite<'a> {
    fn of<const D: usize, const M: usize>(operator: &'a SlabOperator<D, M>, cell: usize, face: usize) -> Self {
        let facets = &operator.facets;
        let (slot, own_side) = facets.of_face[cell * 2 * D + face];
        let (batch, lane) = (&facets.batches[slot as usize / WIDTH], slot as usize % WIDTH);
        let Side { cell, face } = batch.ends(1 - own_side as usize)[lane];
        let permutation = facets.permutation(batch, lane, 1).map(|permutation| &permutation.flow[..]);
        batch.boundary.map_or(Opposite::Cell { cell, face, permutation, own_side }, Opposite::Boundary)
    }

    fn boundary(self) -> Option<usize> {
        if let Opposite::Boundary(number) = self { Some(number) } else { None }
    }
}

/// The face node of the neighbour that coincides with face node `i`.
fn opposite_node(permutation: Option<&[usize]>, own_side: u8, i: usize) -> usize {
    match permutation {
        None => i,
        Some(plus_of_minus) if own_side == 0 => plus_of_minus[i],
        Some(plus_of_minus) => plus_of_minus.iter().position(|&plus| plus == i).unwrap_or(i),
    }
}

fn block<const M: usize>(blocks: &mut [f64], number: usize) -> &mut [f64] {
    &mut blocks[number * M * M..(number + 1) * M * M]
}
