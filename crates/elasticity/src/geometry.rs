//! The reference mesh and its stiffness at points of the cells.

use crate::solid::{Relative, Solid};
use crate::{ElasticityError, Lame, Stiffness};
use basis::{Rule, gauss_lobatto};
use mesh::{CellMap, Mesh, NodeNumbering};
use tensor::{cofactor, determinant, norm};

/// Gauss points per direction that integrate K.
///
/// A linear displacement has constant stress. K maps it to zero inside (the patch test) if the integral of `grad_xi w . cof J`, of
/// degree D (N - 1) - 1 per direction, is exact. N + 1 points integrate affine cells with two degrees to spare. They suffice in 2-D,
/// and in 3-D up to N = 5; higher orders need more.
pub(crate) fn quadrature_points(dimension: usize, order: usize) -> usize {
    (dimension * (order - 1)).div_ceil(2).max(order + 1)
}

/// The reference map and the stiffness at one point of a cell.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sample<const D: usize> {
    pub(crate) position: [f64; D],
    /// det J, J = dx/dxi.
    pub(crate) determinant: f64,
    /// G = J^{-1}, `[a][j]` = d xi_a / d x_j.
    pub(crate) inverse_jacobian: [[f64; D]; D],
    /// The factor on the constants of Lame.
    pub(crate) stiffness: f64,
    /// The contribution to the first constant beyond that.
    pub(crate) excess: f64,
}

/// The source of the stiffness at a point.
enum Source<'a, const D: usize> {
    /// A mesh.
    Mesh(Stiffness<'a, D>),
    /// A structure, relative to constants.
    Solid(&'a Solid<D>, Lame),
}

/// How far from its faces, in reference coordinates, the constants of a solid are evaluated at the least.
const INSIDE: f64 = 1e-6;

/// The reference coordinates `points` of a cell where the constants of a solid are evaluated: just inside of it. Materials are formulas of the
/// position, and two of them meet on faces. There each cell must find its own.
pub fn just_inside(points: &[f64]) -> Vec<f64> {
    points.iter().map(|xi| xi.clamp(INSIDE - 1.0, 1.0 - INSIDE)).collect()
}

/// Samples the reference map and the stiffness of every cell at the points of a quadrature rule.
pub(crate) struct StiffnessSampler<'a, const D: usize> {
    rule: Rule,
    mesh: &'a Mesh<D>,
    source: Source<'a, D>,
    mean_determinant: f64,
    map: CellMap<D>,
    /// The map to the points where the constants of a solid are evaluated.
    inside: CellMap<D>,
}

impl<'a, const D: usize> StiffnessSampler<'a, D> {
    /// For `rule` along every axis.
    pub(crate) fn new(mesh: &'a Mesh<D>, stiffness: Stiffness<'a, D>, rule: Rule) -> Self {
        Self::with_source(mesh, Source::Mesh(stiffness), rule)
    }

    /// The same for a structure of `solid`, relative to the constants `base`.
    pub(crate) fn of_solid(mesh: &'a Mesh<D>, solid: &'a Solid<D>, base: Lame, rule: Rule) -> Self {
        Self::with_source(mesh, Source::Solid(solid, base), rule)
    }

    fn with_source(mesh: &'a Mesh<D>, source: Source<'a, D>, rule: Rule) -> Self {
        let reference_volume = (mesh.n_cells() << D) as f64;
        let mean_determinant = mesh.volume() / reference_volume;
        let map = CellMap::on_grid(mesh.order(), &rule.points);
        let inside = CellMap::on_grid(mesh.order(), &just_inside(&rule.points));
        StiffnessSampler { rule, mesh, source, mean_determinant, map, inside }
    }

    /// The rule along every axis.
    pub(crate) fn rule(&self) -> &Rule {
        &self.rule
    }

    /// The samples of `cell`, axis 0 fastest.
    ///
    /// # Errors
    /// [`ElasticityError::Stiffness`] if the modulus is not positive and finite, [`ElasticityError::MaterialAt`] if the constants of a
    /// solid are out of range.
    pub(crate) fn cell(&self, cell: usize) -> Result<Vec<Sample<D>>, ElasticityError> {
        let nodes = self.mesh.cell_coordinates(cell);
        let positions = self.map.positions(nodes);
        let places = match self.source {
            Source::Mesh(_) => positions.clone(),
            Source::Solid(..) => self.inside.positions(nodes),
        };
        let points = positions.into_iter().zip(places).zip(self.map.jacobians(nodes));
        points.map(|((position, place), jacobian)| self.sample(cell, [position, place], &jacobian)).collect()
    }

    /// The sample at a point of `cell`, with the place of the material for it.
    fn sample(
        &self,
        cell: usize,
        [position, place]: [[f64; D]; 2],
        jacobian: &[[f64; D]; D],
    ) -> Result<Sample<D>, ElasticityError> {
        let (determinant, inverse_jacobian) = determinant_and_inverse(jacobian);
        let Relative { stiffness, excess } = match &self.source {
            Source::Mesh(stiffness) => {
                Relative { stiffness: stiffness.at(&position, determinant / self.mean_determinant), excess: 0.0 }
            }
            Source::Solid(solid, base) => solid.relative(*base, &place)?,
        };
        if !(stiffness > 0.0 && stiffness.is_finite()) {
            return Err(ElasticityError::Stiffness { cell, position: position.to_vec(), value: stiffness });
        }
        Ok(Sample { position, determinant, inverse_jacobian, stiffness, excess })
    }
}

/// The reference position of every C0 node. A node with several positions by periodicity has the one in its first cell.
pub(crate) fn nodal_coordinates<const D: usize>(mesh: &Mesh<D>, numbering: &NodeNumbering) -> Vec<[f64; D]> {
    let map = CellMap::on_grid(mesh.order(), &gauss_lobatto(numbering.order()).points);
    let mut coordinates = vec![[0.0; D]; numbering.count];
    for cell in (0..mesh.n_cells()).rev() {
        for (&node, position) in numbering.cell(cell).iter().zip(map.positions(mesh.cell_coordinates(cell))) {
            coordinates[node] = position;
        }
    }
    coordinates
}

/// The distance of every C0 node to the nearest neighbour on its lines.
pub(crate) fn node_spacing<const D: usize>(mesh: &Mesh<D>, numbering: &NodeNumbering) -> Vec<f64> {
    let n = numbering.order();
    let map = CellMap::<D>::on_grid(mesh.order(), &gauss_lobatto(n).points);
    let mut spacing = vec![f64::INFINITY; numbering.count];
    for cell in 0..mesh.n_cells() {
        let (x, numbers) = (map.relative_positions(mesh.cell_coordinates(cell)), numbering.cell(cell));
        for i in 0..numbers.len() {
            for stride in (0..D).map(|axis| n.pow(axis as u32)).filter(|stride| i / stride % n + 1 < n) {
                let edge: [f64; D] = std::array::from_fn(|d| x[i + stride][d] - x[i][d]);
                for node in [numbers[i], numbers[i + stride]] {
                    spacing[node] = spacing[node].min(norm(&edge));
                }
            }
        }
    }
    spacing
}

/// det J and J^{-1}.
pub(crate) fn determinant_and_inverse<const D: usize>(jacobian: &[[f64; D]; D]) -> (f64, [[f64; D]; D]) {
    let cofactor = cofactor(jacobian);
    let determinant = determinant(jacobian, &cofactor);
    // cofactor / det is J^{-T}
    (determinant, std::array::from_fn(|a| std::array::from_fn(|j| cofactor[j][a] / determinant)))
}

/// The translations and the infinitesimal rotations x_a e_b - x_b e_a at x.
pub(crate) fn rigid_motions<const D: usize>(x: &[f64; D]) -> impl Iterator<Item = [f64; D]> {
    let translation = |i: usize| std::array::from_fn(|j| f64::from(u8::from(i == j)));
    let rotation = |(a, b): (usize, usize)| {
        let mut motion = [0.0; D];
        (motion[a], motion[b]) = (-x[b], x[a]);
        motion
    };
    let planes = (0..D).flat_map(|b| (0..b).map(move |a| (a, b)));
    (0..D).map(translation).chain(planes.map(rotation))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn enough_points_for_the_patch_test() {
        for order in 2..=16 {
            for dimension in [2, 3] {
                let n = quadrature_points(dimension, order);
                assert!(n > order, "affine cells");
                assert!(2 * n >= dimension * (order - 1), "patch test");
            }
        }
        assert_eq!([2, 5, 6, 8, 16].map(|order| quadrature_points(3, order)), [3, 6, 8, 11, 23]);
    }

    #[test]
    fn inverse_of_a_shear_in_space() {
        let jacobian = [[2.0, 1.0, 0.0], [0.0, 4.0, 3.0], [0.5, 0.0, 1.0]];
        let (det, inverse) = determinant_and_inverse(&jacobian);
        assert_eq!(det, 9.5);
        for i in 0..3 {
            for j in 0..3 {
                let product: f64 = (0..3).map(|k| jacobian[i][k] * inverse[k][j]).sum();
                assert!((product - if i == j { 1.0 } else { 0.0 }).abs() < 1e-15);
            }
        }
    }
}
