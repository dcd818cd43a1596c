//! The structure of a case.

use super::mesh_motion::moved_by;
use case::expression::Program;
use case::{Analysis, Case, Plane, Structure, StructureLaw, Support, Vector};
use coupled::{Equations, Reactions, StructureMarch, Supports};
use elasticity::{
    Dynamics, ElasticityError, Loads, MaterialProperty, Pressure, Solid, Statics, Structure as Body, Traction,
};
use fem::VectorField;
use mesh::{Mesh, NodeNumbering};
use std::sync::Arc;

/// The march of a structure, at its start.
///
/// # Errors
/// As [`Body::new`], [`Dynamics::new`], [`Statics::new`] and [`StructureMarch::new`].
pub fn structure_march<const D: usize>(
    case: &Case<D>,
    structure: &Structure<D>,
) -> Result<StructureMarch<D>, ElasticityError> {
    let StructureAtStart { body, loads, supports, displacement, velocity } = structure_at_start(case, structure)?;
    let order = case.time.order;
    let equations = match structure.analysis {
        Analysis::Dynamic => Equations::Dynamic(Box::new(Dynamics::new(body, loads, order, case.time.step)?)),
        Analysis::Static => Equations::Static(Box::new(Statics::new(body, loads, order)?)),
    };
    let halvings = case.solver.slab_halvings as u32;
    StructureMarch::new(equations, supports, displacement, velocity, case.time.schedule(), halvings)
}

/// A structure, what acts on it, and its motion at the start, `[C0 node][component]`.
pub struct StructureAtStart<const D: usize> {
    /// Mesh, material, fixed entries.
    pub body: Body<D>,
    /// The loads of the case.
    pub loads: Loads<D>,
    /// The motion of fixed entries.
    pub supports: Supports<D>,
    /// d at the start.
    pub displacement: Vec<f64>,
    /// Its rate.
    pub velocity: Vec<f64>,
}

/// The structure of a case at its start.
///
/// # Errors
/// As [`Body::new`].
pub fn structure_at_start<const D: usize>(
    case: &Case<D>,
    structure: &Structure<D>,
) -> Result<StructureAtStart<D>, ElasticityError> {
    let mesh = structure.mesh(&case.mesh);
    let numbering = NodeNumbering::new(mesh, mesh.order());
    let (fixed, supports) = supports(mesh, &numbering, &structure.boundary);
    // Equilibria do not depend on a density.
    let density = structure.density.unwrap_or(1.0);
    let case::Damping { mass, stiffness } = structure.damping;
    let body = Body::new(mesh.clone(), numbering, solid(structure), density, fixed)?;
    let body = body.with_damping(elasticity::Damping { mass, stiffness });
    let start = |field: &Option<Vector<D>>| -> Vec<f64> {
        let value = |x: &[f64; D]| field.as_ref().map_or([0.0; D], |field| field.evaluate(x, case.time.start));
        body.coordinates().iter().flat_map(value).collect()
    };
    let (displacement, velocity) = (start(&structure.displacement), start(&structure.velocity));
    Ok(StructureAtStart { body, loads: loads(structure), supports, displacement, velocity })
}

/// The material of a structure.
pub fn solid<const D: usize>(structure: &Structure<D>) -> Solid<D> {
    let quantity = |formula: &Program| match formula.as_constant() {
        Some(value) => MaterialProperty::Constant(value),
        None => {
            let formula = formula.clone();
            MaterialProperty::Field(Arc::new(move |x: &[f64; D]| formula.evaluate(x, 0.0)))
        }
    };
    let plane = match structure.plane {
        Plane::Strain => elasticity::Plane::Strain,
        Plane::Stress => elasticity::Plane::Stress,
    };
    Solid {
        young: quantity(&structure.young_modulus),
        poisson: quantity(&structure.poisson_ratio),
        plane,
        law: match structure.law {
            StructureLaw::Linear => elasticity::Law::Linear,
            StructureLaw::StVenantKirchhoff => elasticity::Law::StVenantKirchhoff,
            StructureLaw::NeoHookean => elasticity::Law::NeoHookean,
        },
    }
}

/// The prescribed components of nodes, their motion, and the reactions that they count for.
fn supports<const D: usize>(
    mesh: &Mesh<D>,
    numbering: &NodeNumbering,
    boundary: &[Support<D>],
) -> (Vec<[bool; D]>, Supports<D>) {
    let mut of_entry = vec![None; numbering.count * D];
    for (number, (boundary, component)) in supported(boundary).enumerate() {
        for node in numbering.on_boundary(mesh, boundary) {
            // What several supports prescribe counts for the first one.
            of_entry[node * D + component].get_or_insert(number);
        }
    }
    let prescribed = |node: &[Option<usize>; D]| node.map(|number| number.is_some());
    let fixed = of_entry.as_chunks().0.iter().map(prescribed).collect();
    let reactions = Reactions { count: supported(boundary).count(), of_entry };
    let moved = |support: &Support<D>| if let Support::Moved(g) = support { Some(g.clone()) } else { None };
    let moved: Vec<Option<Vector<D>>> = boundary.iter().map(moved).collect();
    let fields = moved.iter().flatten().map(|g| Arc::new(g.clone()) as Arc<dyn VectorField<D>>).collect();
    (fixed, Supports { fields, field_of_node: moved_by(mesh, numbering, &moved), reactions })
}

/// The components with a reaction, each with its boundary: those that a support of the `boundary` prescribes.
pub fn supported<const D: usize>(boundary: &[Support<D>]) -> impl Iterator<Item = (usize, usize)> {
    let of_boundary = |(index, support): (usize, &Support<D>)| {
        let fixes = support.fixes();
        (0..D).filter(move |i| fixes[*i]).map(move |i| (index, i))
    };
    boundary.iter().enumerate().flat_map(of_boundary)
}

fn loads<const D: usize>(structure: &Structure<D>) -> Loads<D> {
    let body_force = structure.body_force.clone().map(|b| Box::new(move |x: &[f64; D], t: f64| b.evaluate(x, t)) as _);
    let traction = |(index, support): (usize, &Support<D>)| -> Option<(usize, Traction<D>)> {
        match support.clone() {
            Support::Traction(q) => Some((index, Box::new(move |point, t| q.evaluate(&point.position, t)))),
            Support::Pressure(p) => {
                // A pressure acts against the outward normal.
                Some((index, Box::new(move |point, t| point.normal.map(|n| -p.evaluate(&point.position, t) * n))))
            }
            _ => None,
        }
    };
    let tractions = structure.boundary.iter().enumerate().filter_map(traction).collect();
    let pressure = |(index, support): (usize, &Support<D>)| -> Option<(usize, Pressure<D>)> {
        let Support::FollowerPressure(p) = support.clone() else { return None };
        Some((index, Box::new(move |x, t| p.evaluate(x, t))))
    };
    let pressures = structure.boundary.iter().enumerate().filter_map(pressure).collect();
    Loads { body_force, tractions, pressures }
}
