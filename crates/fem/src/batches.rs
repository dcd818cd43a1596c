//! Cells and facets in batches of one per SIMD lane, and the relation of facets and cells.

use mesh::{Mesh, Orientation, Side, face_nodes};
use std::collections::BTreeMap;
use tensor::{Pack, WIDTH};

/// The order of the nodes of the plus side in the lattice of the minus side: entry i is the plus index of minus node i.
pub struct Permutation {
    /// For the nodes of the flow.
    pub flow: Vec<usize>,
    /// For the nodes of the mesh.
    pub mesh: Vec<usize>,
    /// For each face of the plus cell, the flow nodes of that cell in the lattice of the minus side.
    pub flow_of_cell: Vec<Vec<usize>>,
    /// The same for the nodes of the mesh.
    pub mesh_of_cell: Vec<Vec<usize>>,
}

/// Up to [`WIDTH`] facets of the same kind. Unused lanes repeat the last facet.
pub struct FacetBatch {
    /// Its number.
    pub number: usize,
    /// Lanes in use.
    pub count: usize,
    /// Minus sides.
    pub minus: [Side; WIDTH],
    /// Plus sides and their permutations (index into [`FacetBatches::permutations`]); on a boundary repeats `minus`.
    pub plus: [(Side, usize); WIDTH],
    /// The boundary, if it is one.
    pub boundary: Option<usize>,
    /// See [`crate::scratch::FacetScratch::normal_sign`].
    pub normal_sign: Pack,
}

/// All facets of a mesh in batches.
pub struct FacetBatches {
    /// Interior batches first.
    pub batches: Vec<FacetBatch>,
    /// The permutations that occur; number 0 is the identity.
    pub permutations: Vec<Permutation>,
    /// For `[cell][face]`: the slot of its facet (batch * WIDTH + lane), and the side of the facet that the face is (0
    /// minus, 1 plus).
    pub of_face: Vec<(u32, u8)>,
}

impl FacetBatch {
    /// Sides in use: one on a boundary.
    pub fn sides(&self) -> usize {
        if self.boundary.is_none() { 2 } else { 1 }
    }

    /// All sides of all lanes.
    pub fn sides_of_all(&self) -> impl Iterator<Item = Side> {
        self.minus.into_iter().chain(self.ends(self.sides() - 1))
    }

    /// The sides of all lanes: 0 minus, 1 plus.
    pub fn ends(&self, side: usize) -> [Side; WIDTH] {
        if side == 0 { self.minus } else { self.plus.map(|(end, _)| end) }
    }
}

impl FacetBatches {
    /// Whether the facet of a face, `[cell][face]`, lies between two cells.
    pub fn is_interior(&self, face: usize) -> bool {
        let slot = self.of_face[face].0 as usize;
        self.batches[slot / WIDTH].boundary.is_none()
    }

    /// The permutation to the lattice of the plus side of a facet; `None` if both lattices are the same.
    pub fn permutation(&self, batch: &FacetBatch, lane: usize, side: usize) -> Option<&Permutation> {
        let number = if side == 0 { 0 } else { batch.plus[lane].1 };
        (number != 0).then(|| &self.permutations[number])
    }

    /// The permutation from the lattice of the minus side to that of `side`.
    pub fn lattice(&self, batch: &FacetBatch, lane: usize, side: usize) -> &Permutation {
        &self.permutations[if side == 0 { 0 } else { batch.plus[lane].1 }]
    }

    /// Batches the facets of `mesh` for a flow and a mesh of the given orders.
    pub fn new<const D: usize>(mesh: &Mesh<D>, flow_order: usize, mesh_order: usize) -> Self {
        let mut permutations = Vec::new();
        let mut known: BTreeMap<Orientation, usize> = BTreeMap::new();
        let identity = Orientation::default();
        let mut number = |orientation: Orientation| {
            *known.entry(orientation).or_insert_with(|| {
                let map = |n: usize| -> Vec<usize> {
                    (0..n.pow(D as u32 - 1)).map(|i| orientation.plus_index(D - 1, n, i)).collect()
                };
                let (flow, mesh) = (map(flow_order), map(mesh_order));
                let of_cell = |n: usize, map: &[usize]| {
                    let faces = (0..2 * D).map(|face| face_nodes(D, n, face));
                    faces.map(|nodes| map.iter().map(|&i| nodes[i]).collect()).collect()
                };
                let [flow_of_cell, mesh_of_cell] = [of_cell(flow_order, &flow), of_cell(mesh_order, &mesh)];
                permutations.push(Permutation { flow, mesh, flow_of_cell, mesh_of_cell });
                permutations.len() - 1
            })
        };
        let same = number(identity);
        let interior: Vec<_> =
            mesh.interior_facets().iter().map(|f| (f.minus, (f.plus, number(f.orientation)), None)).collect();
        let boundary: Vec<_> =
            mesh.boundary_facets().iter().map(|f| (f.side, (f.side, same), Some(f.boundary))).collect();
        let mut batches: Vec<FacetBatch> = interior.chunks(WIDTH).map(batch::<D>).collect();
        batches.extend(boundary.chunk_by(|a, b| a.2 == b.2).flat_map(|same| same.chunks(WIDTH)).map(batch::<D>));
        batches.iter_mut().enumerate().for_each(|(number, batch)| batch.number = number);
        let of_face = faces_to_facets(&batches, mesh.n_cells() * 2 * D, 2 * D);
        FacetBatches { batches, permutations, of_face }
    }
}

fn batch<const D: usize>(facets: &[(Side, (Side, usize), Option<usize>)]) -> FacetBatch {
    let at = |lane: usize| &facets[lane.min(facets.len() - 1)];
    // The last column of cofactors is the cross product of the tangents in 3-D, and the tangent turned by -90 degrees in
    // 2-D.
    let turn = if D == 2 { -1.0 } else { 1.0 };
    FacetBatch {
        number: 0,
        count: facets.len(),
        minus: std::array::from_fn(|lane| at(lane).0),
        plus: std::array::from_fn(|lane| at(lane).1),
        boundary: facets[0].2,
        normal_sign: Pack(std::array::from_fn(|lane| turn * mesh::tangent_sign(at(lane).0.face))),
    }
}

fn faces_to_facets(batches: &[FacetBatch], faces: usize, per_cell: usize) -> Vec<(u32, u8)> {
    let mut of_face = vec![(u32::MAX, 0); faces];
    for (b, batch) in batches.iter().enumerate() {
        for lane in 0..batch.count {
            let slot = (b * WIDTH + lane) as u32;
            let (minus, plus) = (batch.minus[lane], batch.plus[lane].0);
            if batch.boundary.is_none() {
                of_face[plus.cell * per_cell + plus.face] = (slot, 1);
            }
            of_face[minus.cell * per_cell + minus.face] = (slot, 0);
        }
    }
    of_face
}

/// The largest number of batches that a thread takes at a time. It is small, so that no thread waits long for the last one and
/// goes to sleep.
pub const BATCHES_PER_TASK: usize = 4;

/// The cells of batch `batch`; the last one is repeated if there are fewer than [`WIDTH`].
pub fn cells_of(batch: usize, cells: usize) -> [usize; WIDTH] {
    std::array::from_fn(|lane| (batch * WIDTH + lane).min(cells - 1))
}
