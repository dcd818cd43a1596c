//! The memory that the mesh takes in a run, by its order: nodes, traces of facets, and the proof that cells stay valid.

use case::Case;

/// The number of vectors as long as the coordinates of all cells that a run keeps at any time: coordinates and node numbers where they
/// are needed, and fields for the result file. It is measured, like the next two.
const VECTORS: usize = 20;

/// The same for each time node of a slab: velocities, residuals, fields.
const VECTORS_IN_TIME: usize = 7;

/// Arrays as long as the values of mesh velocities on all faces. One holds derivatives along the axis that leaves the face. Mesh and direction have two
/// each: the values on one side of facets, and the derivatives on both.
const TRACES: usize = 1 + 2 * 2;

/// Arrays of values of det J_0 at the points of the proof.
const DETERMINANTS: usize = 5;

/// Lanes of a pack, the number of cells that a thread bounds at a time.
const LANES: usize = 8;

/// Bytes that depend on the order of the mesh of `case`, for any motion, without those of an elastic solver.
pub fn bytes<const D: usize>(case: &Case<D>) -> usize {
    let (cells, order, time_order) = (case.mesh.n_cells(), case.mesh.order(), case.time.order);
    let nodes = D * order.pow(D as u32);
    let face_nodes = 2 * D * D * order.pow(D as u32 - 1);
    let vectors = nodes * (VECTORS + VECTORS_IN_TIME * time_order);
    let traces = face_nodes * TRACES * (time_order + 1);
    let determinants = DETERMINANTS * points::<D>(order);
    8 * (cells * (vectors + traces + determinants) + rayon::current_num_threads() * proof::<D>(order, time_order))
}

/// The number of points that determine det J, of degree D (N - 1) - 1 along each axis.
fn points<const D: usize>(order: usize) -> usize {
    (D * (order - 1)).pow(D as u32)
}

/// The count of numbers with which a thread bounds det J. Each point in space and, of degree D N_t, in time has the D^2 entries of
/// J, four arrays of determinants and 2 D arrays between contractions. To these come two arrays of det J_0, and positions at times
/// and at points in time.
fn proof<const D: usize>(order: usize, time_order: usize) -> usize {
    let (points, time_points) = (points::<D>(order), D * time_order + 1);
    let positions = D * order.pow(D as u32) * (time_order + 1 + time_points);
    LANES * (points * (time_points * (D * D + 4 + 2 * D) + 2) + positions)
}
