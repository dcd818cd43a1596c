//! The length from which the scales of time follow where the case gives none.

use super::boundary_data::BoundaryData;
use super::mesh_crate::{BoundaryFacet, Mesh, face_nodes};

/// The length in `mesh` that a flow passes, with two digits, so that shapes that are almost alike have the same scales of time; and the largest
/// length that may be meant.
///
/// A body is a wall, or a `symmetry`, between the ends of the mesh along an axis. The length is that of the longest body. Without a body it is that of the mesh, or
/// any up to its largest extent.
pub(super) fn of_mesh<const D: usize>(mesh: &Mesh<D>, conditions: &[BoundaryData<D>]) -> [f64; 2] {
    let whole = Extent::of(mesh.coordinates().as_chunks::<D>().0);
    let is_solid = |boundary: &usize| conditions[*boundary].condition.is_solid();
    let solid = (0..conditions.len()).filter(is_solid);
    let body = solid.map(|boundary| Extent::of_boundary(mesh, boundary).of_body(&whole)).fold(0.0, f64::max);
    let all = std::array::from_fn::<f64, D, _>(|axis| whole.along(axis));
    let lengths = if body > 0.0 { [body; 2] } else { [middle(&all), all.into_iter().fold(0.0, f64::max)] };
    lengths.map(with_two_digits)
}

fn with_two_digits(length: f64) -> f64 {
    format!("{length:.1e}").parse().unwrap_or(length)
}

/// A box along the axes.
struct Extent<const D: usize> {
    lower: [f64; D],
    upper: [f64; D],
}

impl<const D: usize> Extent<D> {
    fn of<'a>(points: impl IntoIterator<Item = &'a [f64; D]>) -> Self {
        let (mut lower, mut upper) = ([f64::INFINITY; D], [f64::NEG_INFINITY; D]);
        for x in points {
            (0..D).for_each(|i| (lower[i], upper[i]) = (lower[i].min(x[i]), upper[i].max(x[i])));
        }
        Extent { lower, upper }
    }

    fn of_boundary(mesh: &Mesh<D>, boundary: usize) -> Self {
        let facets = mesh.boundary_facets().iter().filter(|facet| facet.boundary == boundary);
        let nodes = facets.flat_map(|BoundaryFacet { side, .. }| {
            let x = mesh.cell_coordinates(side.cell).as_chunks::<D>().0;
            face_nodes(D, mesh.order(), side.face).into_iter().map(|node| &x[node])
        });
        Extent::of(nodes)
    }

    fn along(&self, axis: usize) -> f64 {
        self.upper[axis] - self.lower[axis]
    }

    /// The length of this box along the axes on which both of its ends lie inside the box `whole`; 0 if there is no such axis. So the span of a wing
    /// from wall to wall does not count, nor that of a wing that is longer than its chord.
    fn of_body(&self, whole: &Self) -> f64 {
        /// Nodes on a plane differ by round-off, or by that of a file.
        const LITTLE: f64 = 1e-6;
        let ends_before = |axis: &usize| {
            let least = LITTLE * whole.along(*axis);
            self.lower[*axis] - whole.lower[*axis] > least && whole.upper[*axis] - self.upper[*axis] > least
        };
        let inside: Vec<f64> = (0..D).filter(ends_before).map(|axis| self.along(axis)).collect();
        if inside.len() == 3 { middle(&inside) } else { inside.into_iter().fold(0.0, f64::max) }
    }
}

/// The second largest of some lengths: the height of a channel, the chord of a wing.
fn middle(lengths: &[f64]) -> f64 {
    let mut sorted = lengths.to_vec();
    sorted.sort_by(|a, b| b.total_cmp(a));
    sorted[1]
}
