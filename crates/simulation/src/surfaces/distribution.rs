//! Pressure, friction and heat at the points of a wall.
//!
//! ```text
//! f = Fhat_m . n = p n + tau,   c_p = (p - p_ref) / q,   c_f = tau_t / q,   q = rho_ref U_ref^2 / 2
//! y+ = rho u_tau y / mu,        u_tau = (|tau_t| / rho)^1/2                                                        (distribution)
//! ```
//!
//! Fhat is the numerical flux of the scheme, at the quadrature points of the scheme, with the penalty that the equations of the top of the slab see,
//! (penalty at top). Sums of f times `area` over the rows are the force on the wall in history.csv, to round-off. tau_t is the part of the
//! friction tau along the wall. The distance y is the distance of the first nodes from the wall.

use super::columns::columns;
use super::curve;
use crate::cells::{Combination, StateInCells};
use crate::nodal::{by_node, dot_of};
use crate::opening_states::FacePoints;
use basis::Rule;
use case::surface_name;
use case::{BoundaryData, Flow, Wall};
use coupled::MeshMover;
use fem::{BoundaryPoint, ConservationLaw, Inside, PointFlux, Quadrature, Sampler, node_grid, penalty};
use mesh::{BoundaryFacet, axis_and_side, outward_area, outward_sign};
use navier_stokes::{Boundary, NavierStokes, Primitive};
use output::ArraySpec;
use tensor::{cofactor, det, dot, norm};

/// The flow at the end of a slab.
pub struct SurfaceFlow<'a, const D: usize> {
    /// The flow of the case.
    pub flow: &'a Flow<D>,
    /// The mesh.
    pub mover: &'a MeshMover<D>,
    /// The quadrature of the scheme in one direction.
    pub rule: &'a Rule,
    /// The end.
    pub top: FlowAt<'a>,
    /// The times of the slab with a share in (penalty at top), and these shares.
    pub within: Vec<(f64, FlowAt<'a>)>,
}

/// Flow and mesh at one time.
pub struct FlowAt<'a> {
    /// The time.
    pub time: f64,
    /// The displacement of the mesh, `[C0 node][component]`.
    pub displacement: Combination<'a>,
    /// Its velocity, `[C0 node][component]`.
    pub velocity: Combination<'a>,
    /// The state in the cells at walls.
    pub state: StateInCells<'a>,
}

/// From the nodes of a cell of the mesh to those that the scheme sees, `[component][node]`.
type Seen<'a> = dyn Fn(Vec<f64>) -> Vec<f64> + 'a;

/// The parts of the flux out of the domain at a point, per area.
struct WallFlux<const D: usize> {
    pressure: f64,
    /// The force on the wall by friction.
    friction: [f64; D],
    /// The heat that the wall takes up.
    heat: f64,
}

impl<const D: usize> WallFlux<D> {
    /// Adds friction and heat of `other`, times `factor`.
    fn add_rubbing(&mut self, factor: f64, other: &Self) {
        self.friction.iter_mut().zip(&other.friction).for_each(|(sum, f)| *sum += factor * f);
        self.heat += factor * other.heat;
    }
}

/// A point of a wall at a time.
struct Here<'a, const D: usize, const M: usize> {
    wall: &'a Wall<D>,
    face: usize,
    time: f64,
    position: [f64; D],
    u: [f64; M],
    /// grad u, `[direction][component]`.
    gradient: [[f64; M]; D],
    /// dx/dxi
    jacobian: [[f64; D]; D],
    /// The velocity of the mesh.
    velocity: [f64; D],
}

impl<const D: usize> SurfaceFlow<'_, D> {
    /// The distribution on `wall`, with its description: `[facet][point][column]`, in the plane along its curves.
    pub fn of_wall<const M: usize>(&self, wall: &Wall<D>) -> (ArraySpec, Vec<f64>)
    where
        NavierStokes<D>: ConservationLaw<D, M, Boundary = Boundary<D>>,
    {
        let mesh = &self.mover.reference;
        let fractions = mesh.arc_fractions_of_faces(&self.mover.numbering, wall.boundary);
        let orders = [self.flow.order, self.mesh_order()];
        let faces: Vec<FacePoints<D>> = (0..2 * D).map(|face| FacePoints::with_rule(face, orders, self.rule)).collect();
        let on_arc: Vec<FacePoints<D>> =
            (0..2 * D).map(|face| FacePoints::with_rule(face, [2, mesh.order()], self.rule)).collect();
        let nodes = basis::gauss_lobatto(self.mesh_order()).points;
        let interpolation = Sampler::<D>::new(self.flow.order, mesh.order(), &nodes);
        let interpolated = |nodal: Vec<f64>| interpolation.positions(&nodal);
        let seen: &Seen = if nodes.len() == mesh.order() { &|nodal| nodal } else { &interpolated };
        let facets = curve::facets_of(mesh, wall.boundary);
        let up_to_points = curve::integrals(self.rule);
        let (mut values, mut length) = (Vec::new(), 0.0);
        for facet in curve::in_order(mesh, &self.mover.numbering, &facets) {
            let face = facets[facet].side.face;
            let mut rows = self.of_facet::<M>(wall, &facets[facet], &faces[face], seen);
            let of_facet = fractions.as_ref().map(|fractions| &fractions[facet][..]);
            self.add_fractions(face, &on_arc[face], of_facet, &mut rows);
            if D == 2 {
                if curve::is_reversed(facets[facet].side.face) {
                    rows.reverse();
                }
                length = self.add_arc_length(&mut rows, &up_to_points, length);
            }
            values.extend(rows.concat());
        }
        let numbers = columns(D).iter().map(|column| column.components).sum();
        let points = self.rule.points.len().pow(D as u32 - 1);
        let axes = [("facet", facets.len()), ("point", points), ("column", numbers)];
        (ArraySpec::new(&surface_name(&wall.name), &axes), values)
    }

    /// The order of the mesh that the scheme sees: collocated rules interpolate it at the nodes of the flow.
    fn mesh_order(&self) -> usize {
        let order = self.mover.reference.order();
        match self.flow.quadrature {
            Quadrature::Collocated(_) => order.min(self.flow.order),
            _ => order,
        }
    }

    /// Puts the fraction of the arc into the rows of a facet, from that at its nodes; NaN where the wall is no closed curve.
    fn add_fractions(&self, face: usize, points: &FacePoints<D>, of_nodes: Option<&[f64]>, rows: &mut [Vec<f64>]) {
        let nodes = mesh::face_nodes(D, self.mover.numbering.order(), face);
        for (row, [_, of_mesh]) in rows.iter_mut().zip(&points.functions) {
            let at_point =
                |of_nodes: &[f64]| of_nodes.iter().zip(&nodes).map(|(s, node)| s * of_mesh[*node]).sum::<f64>();
            row[0] = fraction(of_nodes.map_or(f64::NAN, at_point));
        }
    }

    /// Puts the arc length into the rows of a facet that begins at `start`; returns that at its end.
    fn add_arc_length(&self, rows: &mut [Vec<f64>], up_to_points: &[Vec<f64>], start: f64) -> f64 {
        // s, arc length, position, normal, area.
        let (arc, area) = (1, 2 + 2 * D);
        let speeds: Vec<f64> = rows.iter().zip(&self.rule.weights).map(|(row, weight)| row[area] / weight).collect();
        let lengths = curve::lengths_up_to(&speeds, up_to_points, start);
        rows.iter_mut().zip(lengths).for_each(|(row, length)| row[arc] = length);
        start + rows.iter().map(|row| row[area]).sum::<f64>()
    }

    fn of_facet<const M: usize>(
        &self,
        wall: &Wall<D>,
        facet: &BoundaryFacet,
        points: &FacePoints<D>,
        seen: &Seen,
    ) -> Vec<Vec<f64>>
    where
        NavierStokes<D>: ConservationLaw<D, M, Boundary = Boundary<D>>,
    {
        let points_at = |time| self.points_at::<M>(time, wall, facet, points, seen);
        let within: Vec<(f64, Vec<Here<'_, D, M>>)> =
            self.within.iter().map(|(share, time)| (*share, points_at(time))).collect();
        let row = |(p, here): (usize, &Here<'_, D, M>)| {
            let before: Vec<(f64, &Here<'_, D, M>)> = within.iter().map(|(share, at)| (*share, &at[p])).collect();
            let along: &[f64] = if D == 2 { &[0.0; 2] } else { &[0.0] };
            [along, &here.position, &self.values(here, &before, points.weights[p])].concat()
        };
        points_at(&self.top).iter().enumerate().map(row).collect()
    }

    /// The points of a facet at a time.
    fn points_at<'w, const M: usize>(
        &self,
        time: &FlowAt<'_>,
        wall: &'w Wall<D>,
        facet: &BoundaryFacet,
        points: &FacePoints<D>,
        seen: &Seen,
    ) -> Vec<Here<'w, D, M>> {
        let (cell, face) = (facet.side.cell, facet.side.face);
        let nodes = self.mover.numbering.cell(cell);
        let nodal = by_node::<D>(&seen(self.mover.cell_positions_with(cell, &|entry| time.displacement.at(entry))));
        let of_nodes = (0..D).flat_map(|i| nodes.iter().map(move |node| time.velocity.at(node * D + i)));
        let velocity = seen(of_nodes.collect());
        let (x, jacobians) = (points.map.positions(&nodal), points.map.jacobians(&nodal));
        let coefficients = time.state.of(cell);
        let at = |p: usize| {
            let [of_flow, of_mesh] = &points.functions[p];
            let value = |m: usize, functions: &[f64]| dot_of(&coefficients[m * functions.len()..], functions);
            let slopes: [[f64; M]; D] =
                std::array::from_fn(|j| std::array::from_fn(|m| value(m, &points.slopes[p][j])));
            let moved = |i: usize| dot_of(&velocity[i * of_mesh.len()..], of_mesh);
            Here {
                wall,
                face,
                time: time.time,
                position: x[p],
                u: std::array::from_fn(|m| value(m, of_flow)),
                gradient: physical(&slopes, &jacobians[p]),
                jacobian: jacobians[p],
                velocity: std::array::from_fn(moved),
            }
        };
        (0..points.weights.len()).map(at).collect()
    }

    /// The columns from the normal on, with the same point `before` the end and the shares of those times.
    fn values<const M: usize>(&self, here: &Here<'_, D, M>, before: &[(f64, &Here<'_, D, M>)], weight: f64) -> Vec<f64>
    where
        NavierStokes<D>: ConservationLaw<D, M, Boundary = Boundary<D>>,
    {
        let q = here.wall.scales.dynamic_pressure;
        let (normal, size) = unit_normal(here);
        let WallFlux { pressure, friction, heat } = self.flux(here, before);
        let across = dot(&friction, &normal);
        let tangential: [f64; D] = std::array::from_fn(|i| friction[i] - across * normal[i]);
        let pressure_coefficient = (pressure - self.flow.reference_pressure()) / q;
        let plus = self.y_plus(here, norm(&tangential), &normal);
        let scalars = [norm(&tangential) / q, heat, plus];
        let areas = [weight * size, pressure, pressure_coefficient];
        [&normal[..], &areas, &friction, &tangential.map(|tau| tau / q), &scalars].concat()
    }

    /// The data of the wall.
    fn data<const M: usize>(&self, here: &Here<'_, D, M>) -> [f64; M] {
        let BoundaryData { data, .. } = &self.flow.boundary[here.wall.boundary];
        data.as_ref().map_or([0.0; M], |data| data.at::<M>(&here.position, here.time))
    }

    /// The numerical flux of the wall, with (penalty at top).
    fn flux<const M: usize>(&self, here: &Here<'_, D, M>, before: &[(f64, &Here<'_, D, M>)]) -> WallFlux<D>
    where
        NavierStokes<D>: ConservationLaw<D, M, Boundary = Boundary<D>>,
    {
        let [mut flux, penalty] = self.parts_of_flux(here);
        if before.is_empty() {
            return flux;
        }
        flux.add_rubbing(-1.0, &penalty);
        before.iter().for_each(|(share, here)| flux.add_rubbing(*share, &self.parts_of_flux(here)[1]));
        flux
    }

    /// The numerical flux of the wall, and its penalty.
    fn parts_of_flux<const M: usize>(&self, here: &Here<'_, D, M>) -> [WallFlux<D>; 2]
    where
        NavierStokes<D>: ConservationLaw<D, M, Boundary = Boundary<D>>,
    {
        let (law, condition) = (&self.flow.law, self.flow.boundary[here.wall.boundary].condition);
        let (normal, size) = unit_normal(here);
        let data = self.data(here);
        let at = BoundaryPoint { normal: &normal, velocity: &here.velocity, data: &data };
        let inside = law.is_viscous().then(|| Inside {
            gradient: here.gradient,
            sigma: penalty(size, det(&here.jacobian).abs().recip(), self.flow.order),
            grid: node_grid(&cofactor(&here.jacobian), det(&here.jacobian), self.flow.order),
        });
        let PointFlux { inviscid, viscous, penalty, .. } = PointFlux::new(law, condition, &here.u, at, inside.as_ref());
        let moving = law.boundary_velocity(condition, at);
        let pressure = dot(&law.momentum(&inviscid), &normal);
        [viscous, penalty].map(|flux| {
            let friction = law.momentum(&flux);
            WallFlux { pressure, friction, heat: law.energy(&flux) - dot(&friction, &moving) }
        })
    }

    /// y+ of the first nodes.
    fn y_plus<const M: usize>(&self, here: &Here<'_, D, M>, friction: f64, n: &[f64; D]) -> f64 {
        let gas = Primitive::<f64, D>::unpack(&self.flow.law.gas, &here.u);
        let (axis, _) = axis_and_side(here.face);
        let nodes = basis::gauss_lobatto(self.flow.order).points;
        let step = outward_sign(here.face) * (nodes[1] - nodes[0]);
        let inwards: [f64; D] = std::array::from_fn(|i| here.jacobian[i][axis] * step);
        let viscosity = self.flow.law.gas.dynamic_viscosity(self.flow.law.gas.temperature(gas.density, gas.pressure));
        gas.density * (friction / gas.density).sqrt() * dot(&inwards, n).abs() / viscosity
    }
}

/// The fraction of the arc at a point where its polynomial gives `s`. The end of the arc is 1: a curve of it would go back to the start otherwise.
fn fraction(s: f64) -> f64 {
    const ROUND_OFF: f64 = 1e-12;
    if (-ROUND_OFF..=1.0 + ROUND_OFF).contains(&s) { s.clamp(0.0, 1.0) } else { s.rem_euclid(1.0) }
}

/// The normal out of the domain, and the area of the facet per area of the reference face.
fn unit_normal<const D: usize, const M: usize>(here: &Here<'_, D, M>) -> ([f64; D], f64) {
    let area = outward_area(&here.jacobian, here.face);
    let size = norm(&area);
    (area.map(|a| a / size), size)
}

/// grad_x u = J^-T grad_xi u.
pub fn physical<const D: usize, const M: usize>(slopes: &[[f64; M]; D], jacobian: &[[f64; D]; D]) -> [[f64; M]; D] {
    let (cof, det) = (cofactor(jacobian), det(jacobian));
    std::array::from_fn(|k| std::array::from_fn(|m| (0..D).map(|j| cof[k][j] * slopes[j][m]).sum::<f64>() / det))
}

#[cfg(test)]
mod tests {
    use super::fraction;

    /// The last point of a closed wall had s = 0, if the points include the ends of facets.
    #[test]
    fn the_end_of_an_arc_is_at_one() {
        assert_eq!([0.0, -1e-16, 0.3, 1.0, 1.0 + 1e-15].map(fraction), [0.0, 0.0, 0.3, 1.0, 1.0]);
        assert!((fraction(-0.01) - 0.99).abs() < 1e-15 && (fraction(1.01) - 0.01).abs() < 1e-15);
        assert!(fraction(f64::NAN).is_nan(), "a wall that is no closed curve");
    }
}
