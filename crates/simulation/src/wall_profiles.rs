//! The distribution of pressure, friction and heat along walls: a file `wall_NAME.csv` for each that the case asks for.
//!
//! ```text
//! c_p = (p - p_ref) / q,   c_f = |tau_t| / q,   y+ = rho u_tau y / mu,   u_tau = (|tau_t| / rho)^1/2,   q = rho_ref U_ref^2 / 2      (profile)
//! ```
//!
//! tau_t is the part along the wall of the viscous traction of the fluid on it, y the distance of the first nodes from the wall. The points are
//! Gauss points of the facets; the column `area` is the weight of each, so that sums over rows are integrals. The penalty of the scheme at
//! walls is left out: it vanishes as the mesh is refined.

use super::opening_states::{FacePoints, by_node, dot_of};
use case::{Flow, Wall};
use coupled::MeshMover;
use fem::ConservationLaw;
use mesh::{BoundaryFacet, axis_and_side, outward_area, outward_sign};
use navier_stokes::{NavierStokes, Primitive};
use std::collections::BTreeMap;
use tensor::{cofactor, determinant, dot, norm};

/// The flow at one time.
pub struct WallProfiles<'a, const D: usize> {
    /// The flow of the case.
    pub flow: &'a Flow<D>,
    /// The mesh.
    pub mover: &'a MeshMover<D>,
    /// Its displacement.
    pub displacement: &'a [f64],
    /// The state of a cell, `[component][node]`.
    pub state: &'a dyn Fn(usize) -> &'a [f64],
}

impl<const D: usize> WallProfiles<'_, D> {
    /// The first line of the file.
    pub fn columns() -> String {
        let axes = &["x", "y", "z"][..D];
        let of = |name: &str| axes.iter().map(|axis| format!("{name}{axis}")).collect::<Vec<_>>();
        let scalars = ["pressure", "pressure_coefficient", "friction_coefficient", "heat_flux", "y_plus"];
        let named = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>();
        let first = [named(&["s"]), of(""), of("normal_"), named(&["area"])].concat();
        [first, named(&scalars[..2]), of("friction_"), named(&scalars[2..])].concat().join(",")
    }

    /// The rows of a wall, facet by facet.
    pub fn rows<const M: usize>(&self, wall: &Wall<D>) -> Vec<Vec<f64>>
    where
        NavierStokes<D>: ConservationLaw<D, M>,
    {
        let mesh = &self.mover.reference;
        let arc = mesh.arc_fractions(&self.mover.numbering, wall.boundary).unwrap_or_default();
        let faces: Vec<FacePoints<D>> =
            (0..2 * D).map(|face| FacePoints::new(face, self.flow.order, mesh.order())).collect();
        let facets = mesh.boundary_facets().iter().filter(|facet| facet.boundary == wall.boundary);
        facets.flat_map(|facet| self.of_facet::<M>(wall, facet, &faces[facet.side.face], &arc)).collect()
    }

    fn of_facet<const M: usize>(
        &self,
        wall: &Wall<D>,
        facet: &BoundaryFacet,
        points: &FacePoints<D>,
        arc: &BTreeMap<usize, f64>,
    ) -> Vec<Vec<f64>>
    where
        NavierStokes<D>: ConservationLaw<D, M>,
    {
        let (cell, face) = (facet.side.cell, facet.side.face);
        let nodal = by_node::<D>(&self.mover.cell_positions(cell, self.displacement));
        let (x, jacobians) = (points.map.positions(&nodal), points.map.jacobians(&nodal));
        let nodes = self.mover.numbering.cell(cell);
        let at = |p: usize| {
            let s = along_arc(nodes.iter().map(|node| arc.get(node).copied()), &points.functions[p][1]);
            let [state, _] = &points.functions[p];
            let coefficients = (self.state)(cell);
            let value = |m: usize, functions: &[f64]| dot_of(&coefficients[m * functions.len()..], functions);
            let u: [f64; M] = std::array::from_fn(|m| value(m, state));
            let slopes: [[f64; M]; D] =
                std::array::from_fn(|j| std::array::from_fn(|m| value(m, &points.slopes[p][j])));
            let here = Here { wall, face, u, gradient: physical(&slopes, &jacobians[p]), jacobian: jacobians[p] };
            [&[s][..], &x[p], &self.values(&here, points.weights[p])].concat()
        };
        (0..points.weights.len()).map(at).collect()
    }

    /// The columns from the normal on.
    fn values<const M: usize>(&self, here: &Here<'_, D, M>, weight: f64) -> Vec<f64>
    where
        NavierStokes<D>: ConservationLaw<D, M>,
    {
        let (law, q) = (&self.flow.law, here.wall.scales.dynamic_pressure);
        let area = outward_area(&here.jacobian, here.face);
        let size = norm(&area);
        let normal = area.map(|a| a / size);
        let gas = Primitive::<f64, D>::unpack(&law.gas, &here.u);
        let viscous = match law.is_viscous() {
            true => law.viscous_flux(&here.u, &here.gradient),
            false => [[0.0; M]; D],
        };
        let through: [f64; M] = std::array::from_fn(|m| (0..D).map(|i| viscous[i][m] * normal[i]).sum());
        // The fluid takes the traction tau n at its boundary; the wall feels the opposite.
        let traction: [f64; D] = std::array::from_fn(|i| -through[1 + i]);
        let across = dot(&traction, &normal);
        let friction: [f64; D] = std::array::from_fn(|i| traction[i] - across * normal[i]);
        let heat = -(through[M - 1] - (0..D).map(|i| through[1 + i] * gas.velocity[i]).sum::<f64>());
        let pressure_coefficient = (gas.pressure - self.flow.reference_pressure()) / q;
        let plus = self.y_plus(here, &gas, norm(&friction), &normal);
        let scalars = [norm(&friction) / q, heat, plus];
        [&normal[..], &[weight * size, gas.pressure, pressure_coefficient], &friction, &scalars].concat()
    }

    /// y+ of the first nodes.
    fn y_plus<const M: usize>(
        &self,
        here: &Here<'_, D, M>,
        gas: &Primitive<f64, D>,
        friction: f64,
        n: &[f64; D],
    ) -> f64 {
        let (axis, _) = axis_and_side(here.face);
        let nodes = basis::gauss_lobatto(self.flow.order).points;
        let step = outward_sign(here.face) * (nodes[1] - nodes[0]);
        let inwards: [f64; D] = std::array::from_fn(|i| here.jacobian[i][axis] * step);
        let viscosity = self.flow.law.gas.dynamic_viscosity(self.flow.law.gas.temperature(gas.density, gas.pressure));
        gas.density * (friction / gas.density).sqrt() * dot(&inwards, n).abs() / viscosity
    }
}

/// A point of a wall.
struct Here<'a, const D: usize, const M: usize> {
    wall: &'a Wall<D>,
    face: usize,
    u: [f64; M],
    /// grad u, `[direction][component]`.
    gradient: [[f64; M]; D],
    /// dx/dxi
    jacobian: [[f64; D]; D],
}

/// grad_x u = J^-T grad_xi u.
pub fn physical<const D: usize, const M: usize>(slopes: &[[f64; M]; D], jacobian: &[[f64; D]; D]) -> [[f64; M]; D] {
    let cof = cofactor(jacobian);
    let det = determinant(jacobian, &cof);
    std::array::from_fn(|k| std::array::from_fn(|m| (0..D).map(|j| cof[k][j] * slopes[j][m]).sum::<f64>() / det))
}

/// The fraction of the arc at a point of a facet, from those of its nodes; NaN where the wall is no closed curve.
fn along_arc(nodes: impl Iterator<Item = Option<f64>>, functions: &[f64]) -> f64 {
    let known: Vec<(f64, f64)> = nodes.zip(functions).filter_map(|(s, phi)| Some((s?, *phi))).collect();
    let largest = known.iter().fold(f64::NEG_INFINITY, |most: f64, (s, _)| most.max(*s));
    // Zero and one are the same place.
    let sum: f64 = known.iter().map(|(s, phi)| phi * if largest - s > 0.5 { s + 1.0 } else { *s }).sum();
    if known.is_empty() { f64::NAN } else { sum.rem_euclid(1.0) }
}
