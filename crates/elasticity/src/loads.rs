//! The forces on a structure: body force in the cells, traction on boundaries, as functions of position and time.
//!
//! ```text
//! f_k(t) = int phi_k b(x, t) dx + sum over loaded boundaries of  int phi_k q(x, n, t) ds                       (load)
//! ```
//!
//! Positions x and outward normals n are those at rest. On a face normal to axis a, ds = |cof J e_a| dxi, and n is this vector, pointing
//! outwards, divided by its length. A follower pressure p acts against the current normal, with the Jacobian of x + d,
//!
//! ```text
//! f_k(d, t) = - sum_facets int phi_k p(x, t) cof J(x + d) e_a dxi                                              (follower pressure)
//! ```

use crate::mass::Mass;
use basis::{Lagrange, Matrix, gauss};
use fem::NodalBatches;
use mesh::{BoundaryFacet, CellMap, Mesh, NodeNumbering, axis_and_side, outward_sign};
use tensor::{Real, cofactor, norm};

/// b(x, t): force per volume.
pub type BodyForce<const D: usize> = Box<dyn Fn(&[f64; D], f64) -> [f64; D] + Send + Sync>;

/// q(x, n, t): force per area at rest; a pressure p is q = -p n.
pub type Traction<const D: usize> = Box<dyn Fn(&SurfacePoint<D>, f64) -> [f64; D] + Send + Sync>;

/// p(x, t): force per current area, against the current normal. x is the position at rest.
pub type Pressure<const D: usize> = Box<dyn Fn(&[f64; D], f64) -> f64 + Send + Sync>;

/// A point of the boundary at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint<const D: usize> {
    /// x
    pub position: [f64; D],
    /// n, outwards, of length 1.
    pub normal: [f64; D],
}

/// All forces on a structure.
#[derive(Default)]
pub struct Loads<const D: usize> {
    /// b, if there is one.
    pub body_force: Option<BodyForce<D>>,
    /// Tractions, by the index of their boundary in `Mesh::boundary_names`. Boundaries that are not listed are free.
    pub tractions: Vec<(usize, Traction<D>)>,
    /// Follower pressures, by the index of their boundary.
    pub pressures: Vec<(usize, Pressure<D>)>,
}

/// The points of all boundary facets and the functions there.
pub(crate) struct Surface<const D: usize> {
    facets: Vec<Facet<D>>,
    /// phi_k at the points of a face, `[point][node]`, in the order of the face's lattice.
    functions: Matrix,
    /// Its derivatives along the axes of the face.
    derivatives: Vec<Matrix>,
}

/// One boundary facet.
struct Facet<const D: usize> {
    boundary: usize,
    face: usize,
    /// Its C0 nodes.
    nodes: Vec<usize>,
    /// Its points, each with w ds.
    points: Vec<(SurfacePoint<D>, f64)>,
    /// J at the points, each with w.
    jacobians: Vec<([[f64; D]; D], f64)>,
}

/// Gauss points per direction of a facet. They are exact for resultant and moment of a constant pressure. For a geometry of order G the
/// integrand phi_k n ds has the degree (N - 1) + (D - 1) (G - 1) - 1. Two more points serve integrands that are not polynomials.
fn quadrature_points(dimension: usize, order: usize, geometry: usize) -> usize {
    ((order - 1) + (dimension - 1) * (geometry - 1)).div_ceil(2).max(order) + 2
}

impl<const D: usize> Surface<D> {
    /// The boundary of `mesh` with the nodes of `numbering`.
    pub(crate) fn new(mesh: &Mesh<D>, numbering: &NodeNumbering) -> Self {
        let rule = gauss(quadrature_points(D, numbering.order(), mesh.order()));
        let maps: Vec<CellMap<D>> = (0..2 * D).map(|face| CellMap::on_face(mesh.order(), face, &rule.points)).collect();
        let weights = tensor_power(&Matrix::new(1, rule.weights.len(), rule.weights.clone()), D - 1);
        let facet = |facet: &BoundaryFacet| {
            let (face, nodes) = (facet.side.face, mesh.cell_coordinates(facet.side.cell));
            let jacobians = maps[face].jacobians(nodes).into_iter().zip(weights.values().iter().copied());
            Facet {
                boundary: facet.boundary,
                face,
                nodes: numbering.face::<D>(facet.side),
                points: face_points(&maps[face], face, nodes, weights.values()),
                jacobians: jacobians.collect(),
            }
        };
        let lagrange = Lagrange::gauss_lobatto(numbering.order());
        let (values, slopes) = (lagrange.value_matrix(&rule.points), lagrange.derivative_matrix(&rule.points));
        let along = |axis: usize| tensor_product((0..D - 1).map(|a| if a == axis { &slopes } else { &values }));
        Surface {
            facets: mesh.boundary_facets().iter().map(facet).collect(),
            functions: tensor_power(&values, D - 1),
            derivatives: (0..D - 1).map(along).collect(),
        }
    }

    /// The integral of phi_k n n^T over the facets with `wet` nodes only, for every node k.
    pub(crate) fn areas(&self, wet: &[bool]) -> Vec<[[f64; D]; D]> {
        let mut areas = vec![[[0.0; D]; D]; wet.len()];
        for facet in self.facets.iter().filter(|facet| facet.nodes.iter().all(|node| wet[*node])) {
            for (row, (SurfacePoint { normal: n, .. }, area)) in facet.points.iter().enumerate() {
                for (phi, node) in self.functions.row(row).iter().zip(&facet.nodes) {
                    (0..D).for_each(|i| (0..D).for_each(|j| areas[*node][i][j] += area * phi * n[i] * n[j]));
                }
            }
        }
        areas
    }

    /// out += int phi_k q on one boundary, for every node k.
    fn add(&self, boundary: usize, q: impl Fn(&SurfacePoint<D>) -> [f64; D], out: &mut [f64]) {
        for facet in self.facets.iter().filter(|facet| facet.boundary == boundary) {
            for (row, (point, area)) in facet.points.iter().enumerate() {
                let traction = q(point);
                for (phi, node) in self.functions.row(row).iter().zip(&facet.nodes) {
                    (0..D).for_each(|i| out[node * D + i] += area * phi * traction[i]);
                }
            }
        }
    }
}

impl<const D: usize> Surface<D> {
    /// out += (follower pressure) on one boundary for the displacement `d`, in any number type.
    fn add_pressure<T: Real>(&self, boundary: usize, p: impl Fn(&[f64; D]) -> f64, d: &[T], out: &mut [T]) {
        for facet in self.facets.iter().filter(|facet| facet.boundary == boundary) {
            for (row, ((point, _), (jacobian, weight))) in facet.points.iter().zip(&facet.jacobians).enumerate() {
                let factor = -weight * p(&point.position);
                let area = self.area_vector(facet, row, jacobian, d);
                for (phi, node) in self.functions.row(row).iter().zip(&facet.nodes) {
                    (0..D).for_each(|i| out[node * D + i] += area[i] * (factor * phi));
                }
            }
        }
    }

    /// cof J(x + d) e_a, outwards, at a point of a face normal to axis a.
    fn area_vector<T: Real>(&self, facet: &Facet<D>, row: usize, jacobian: &[[f64; D]; D], d: &[T]) -> [T; D] {
        let (axis, _) = axis_and_side(facet.face);
        // The column of the axis itself does not matter.
        let mut moved = jacobian.map(|row| row.map(|j| d[0].constant(j)));
        for (derivatives, column) in self.derivatives.iter().zip((0..D).filter(|a| *a != axis)) {
            for (slope, node) in derivatives.row(row).iter().zip(&facet.nodes) {
                (0..D).for_each(|i| moved[i][column] += d[node * D + i] * *slope);
            }
        }
        let cofactor = cofactor(&moved);
        std::array::from_fn(|i| cofactor[i][axis] * outward_sign(facet.face))
    }
}

impl<const D: usize> Loads<D> {
    /// out += (follower pressure) at `t`, in any number type.
    pub(crate) fn add_pressures<T: Real>(&self, surface: &Surface<D>, t: f64, d: &[T], out: &mut [T]) {
        for (boundary, p) in &self.pressures {
            surface.add_pressure(*boundary, |x| p(x, t), d, out);
        }
    }

    /// out = f(t) by (load), `[C0 node][component]`.
    pub(crate) fn assemble(
        &self,
        mass: &Mass<D>,
        batches: &NodalBatches<D>,
        surface: &Surface<D>,
        t: f64,
        out: &mut [f64],
    ) {
        match &self.body_force {
            Some(b) => mass.load(batches, |x| b(x, t), out),
            None => out.fill(0.0),
        }
        for (boundary, q) in &self.tractions {
            surface.add(*boundary, |point| q(point, t), out);
        }
    }
}

/// The points of a face of the cell with the nodes `nodes`, axis 0 fastest, each with w ds.
fn face_points<const D: usize>(
    map: &CellMap<D>,
    face: usize,
    nodes: &[f64],
    weights: &[f64],
) -> Vec<(SurfacePoint<D>, f64)> {
    let (axis, _) = axis_and_side(face);
    let points = map.positions(nodes).into_iter().zip(map.jacobians(nodes)).zip(weights);
    let point = |((position, jacobian), weight): (([f64; D], [[f64; D]; D]), &f64)| {
        let cofactor = cofactor(&jacobian);
        let area_vector: [f64; D] = std::array::from_fn(|i| outward_sign(face) * cofactor[i][axis]);
        let area = norm(&area_vector);
        (SurfacePoint { position, normal: area_vector.map(|n| n / area) }, weight * area)
    };
    points.map(point).collect()
}

/// The tensor product of `count` copies of a matrix, first axis fastest.
fn tensor_power(matrix: &Matrix, count: usize) -> Matrix {
    tensor_product(std::iter::repeat_n(matrix, count))
}

/// The tensor product of matrices, the first one along the fastest axis.
fn tensor_product<'a>(matrices: impl Iterator<Item = &'a Matrix>) -> Matrix {
    matrices.fold(Matrix::identity(1), |product, matrix| {
        let (rows, cols) = (product.rows(), product.cols());
        Matrix::from_fn(rows * matrix.rows(), cols * matrix.cols(), |i, j| {
            product[(i % rows, j % cols)] * matrix[(i / rows, j / cols)]
        })
    })
}

#[cfg(test)]
mod tests;
