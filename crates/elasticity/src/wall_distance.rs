//! A mesh that is stiff near a moving boundary and soft near one at rest.

use mesh::BoundaryDistance;

/// The factor of Young's modulus of Diosady & Murman, AIAA 2018-0919, equation (5). It depends on the Euclidean distances in
/// the mesh at rest to an inner boundary, which moves, and an outer one, which rests:
///
/// ```text
/// E_Y = 1 + E_1 / (1 + (d_w / d_0)^2),  d_w = max(0, min(dist(x, inner) - d_0, dist(x, outer) + 2 d_0))        (wall distance)
/// ```
///
/// So E_Y = 1 + E_1 up to d_0 from the inner boundary, and it falls to 1 far from it. At the outer boundary, where d_w is 2 d_0,
/// it is at least 1 + E_1/5.
#[derive(Clone, Debug)]
pub struct WallDistance<const D: usize> {
    /// E_1.
    pub amplitude: f64,
    /// d_0.
    pub distance: f64,
    /// The boundary that moves.
    pub inner: BoundaryDistance<D>,
    /// The boundary that rests; without facets it is infinitely far.
    pub outer: BoundaryDistance<D>,
}

impl<const D: usize> WallDistance<D> {
    /// E_Y at the point `x` of the mesh at rest.
    pub fn modulus(&self, x: &[f64; D]) -> f64 {
        let d0 = self.distance;
        let d = (self.inner.at(x) - d0).min(self.outer.at(x) + 2.0 * d0).max(0.0);
        1.0 + self.amplitude / (1.0 + (d / d0).powi(2))
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use mesh::generate::RotatingBoxMesh;

    #[test]
    fn the_inner_boundary_is_stiff_and_the_outer_one_is_not_quite_soft() {
        let mesh = RotatingBoxMesh::unit(10, 3).build().unwrap();
        let of = |name: &str| {
            let boundary = mesh.boundary_names().iter().position(|known| known == name).unwrap();
            BoundaryDistance::new(&mesh, &[boundary])
        };
        let law = WallDistance { amplitude: 100.0, distance: 0.05, inner: of("inner"), outer: of("outer") };
        // dist_inner 0 and d_0: d = 0. dist_inner 2 d_0 beside a side and across a corner: d = d_0.
        assert_eq!(law.modulus(&[0.1, 0.05]), 101.0);
        assert!((law.modulus(&[0.15, 0.0]) - 101.0).abs() < 1e-10);
        assert!((law.modulus(&[0.2, 0.0]) - 51.0).abs() < 1e-10);
        let across = 0.1 + 0.1 / 2.0_f64.sqrt();
        assert!((law.modulus(&[across, across]) - 51.0).abs() < 1e-10);
        // dist_outer 0 and 0.1: d = 2 d_0 and 4 d_0.
        assert!((law.modulus(&[0.5, 0.3]) - 21.0).abs() < 1e-10);
        assert!((law.modulus(&[0.4, -0.35]) - (1.0 + 100.0 / 17.0)).abs() < 1e-10);
    }
}
