//! Bodies that the flow moves, rigid or elastic: the construction of rigid ones, and the columns of all.

use super::build::supported;
use super::elastic_body::elastic_body;
use case::expression::Program;
use case::{Case, Flow, Freedom, SolidPart, Structure};
use coupled::block::{Body, BodyState};
use coupled::blocks::rigid_body::Freedom as Direction;
use coupled::blocks::rigid_body::{AddedMass, Coordinate, Drive, RigidBodyData, Surface, SurfaceNode, Vec3};
use coupled::blocks::{RigidBody, SlabTimes};
use elasticity::ElasticityError;
use fem::SlabOperator;
use mesh::{Mesh, NodeNumbering};
use std::f64::consts::{FRAC_PI_4, FRAC_PI_8};
use std::sync::Arc;
use tensor::{AXES, Dual};

/// The name of a structure among bodies.
pub const STRUCTURE: &str = "structure";

/// The depth of the fluid that moves with a body, as a fraction of the size of the body, for the preconditioner: that of a plate.
const DEPTH: f64 = FRAC_PI_8;

/// The bodies of `case` on the mesh of `operator`, whose walls it has leave their loads: rigid ones, then the structure.
///
/// # Errors
/// As [`elastic_body`].
pub fn bodies<const D: usize, const M: usize>(
    case: &Case<D>,
    flow: &Flow<D>,
    numbering: &NodeNumbering,
    operator: &mut SlabOperator<D, M>,
) -> Result<Vec<Box<dyn Body>>, ElasticityError> {
    if !has_bodies(case) {
        return Ok(Vec::new());
    }
    operator.load_boundaries(&(0..flow.boundary.len()).map(|wall| is_of_body(case, wall)).collect::<Vec<_>>());
    let points = operator.tables.time_points.iter().map(|point| point.s).collect();
    let times = SlabTimes { time: operator.tables.time.clone(), points, step: case.time.step };
    let body = |(number, body): (usize, &case::RigidBody<D>)| {
        let surface = surface(case, body, numbering, operator.loaded_nodes());
        let data = data(case, flow, body, &surface);
        Box::new(RigidBody::new(data, surface, number, times.clone())) as Box<dyn Body>
    };
    let mut bodies: Vec<Box<dyn Body>> = case.bodies.iter().enumerate().map(body).collect();
    if let Some((structure, part)) = beside_flow(case) {
        let number = bodies.len();
        bodies.push(Box::new(elastic_body(case, flow, (structure, part), operator, number, times)?));
    }
    Ok(bodies)
}

/// The structure beside the flow of a case, and its part of the mesh.
pub fn beside_flow<const D: usize>(case: &Case<D>) -> Option<(&Structure<D>, &SolidPart<D>)> {
    let structure = case.structure.as_ref()?;
    Some((structure, structure.part.as_ref()?))
}

/// Whether the flow of a case moves anything.
pub fn has_bodies<const D: usize>(case: &Case<D>) -> bool {
    !case.bodies.is_empty() || beside_flow(case).is_some()
}

/// Whether a boundary of the flow is a wall of a body.
pub fn is_of_body<const D: usize>(case: &Case<D>, boundary: usize) -> bool {
    let of_structure = beside_flow(case).is_some_and(|(_, part)| part.walls.contains(&boundary));
    of_structure || case.bodies.iter().any(|body| body.walls.contains(&boundary))
}

/// For every body the number of its coordinates.
pub fn coordinates<const D: usize>(case: &Case<D>) -> Vec<usize> {
    let rigid = case.bodies.iter().map(|body| body.freedoms.len());
    let entries = |part: &SolidPart<D>| D * NodeNumbering::new(&part.mesh, part.mesh.order()).count;
    rigid.chain(beside_flow(case).map(|(_, part)| entries(part))).collect()
}

/// The nodes that a body moves: those of its walls, and then those that follow by weights.
fn surface<const D: usize>(
    case: &Case<D>,
    body: &case::RigidBody<D>,
    numbering: &NodeNumbering,
    loaded: &[usize],
) -> Surface<D> {
    let mut on_wall = vec![false; numbering.count];
    for wall in &body.walls {
        numbering.on_boundary(&case.mesh, *wall).into_iter().for_each(|node| on_wall[node] = true);
    }
    let positions = numbering.positions(&case.mesh);
    let node = |node: usize, weight: f64| SurfaceNode { node, position: positions[node], weight };
    let walls: Vec<SurfaceNode<D>> = (0..numbering.count).filter(|i| on_wall[*i]).map(|i| node(i, 1.0)).collect();
    let following = (0..numbering.count).filter(|i| !on_wall[*i]);
    let following = following.map(|i| node(i, body.weight(&positions[i]).unwrap_or(0.0)));
    let place = |wall: &SurfaceNode<D>| loaded.partition_point(|other| *other < wall.node);
    Surface {
        loaded: walls.iter().map(place).collect(),
        size: extent(&case.mesh, &body.walls),
        nodes: walls.into_iter().chain(following.filter(|node| node.weight != 0.0)).collect(),
    }
}

/// The nodes of the facets of a mesh on `walls`, facet by facet.
pub fn wall_facets<const D: usize>(mesh: &Mesh<D>, walls: &[usize]) -> impl Iterator<Item = Vec<[f64; D]>> {
    mesh.boundary_facets().iter().filter(|facet| walls.contains(&facet.boundary)).map(|facet| {
        let x = mesh.cell_coordinates(facet.side.cell);
        let nodes = mesh::face_nodes(D, mesh.order(), facet.side.face).into_iter();
        nodes.map(|node| std::array::from_fn(|d| x[node * D + d])).collect()
    })
}

/// The smallest and the largest coordinates of `walls`.
pub fn bounds<const D: usize>(mesh: &Mesh<D>, walls: &[usize]) -> [[f64; D]; 2] {
    let (mut low, mut high) = ([f64::INFINITY; D], [f64::NEG_INFINITY; D]);
    for x in wall_facets(mesh, walls).flatten() {
        (0..D).for_each(|d| (low[d], high[d]) = (low[d].min(x[d]), high[d].max(x[d])));
    }
    [low, high]
}

/// The largest extent of `walls` along an axis.
pub fn extent<const D: usize>(mesh: &Mesh<D>, walls: &[usize]) -> f64 {
    let [low, high] = bounds(mesh, walls);
    (0..D).map(|d| high[d] - low[d]).fold(0.0, f64::max)
}

fn data<const D: usize>(
    case: &Case<D>,
    flow: &Flow<D>,
    body: &case::RigidBody<D>,
    surface: &Surface<D>,
) -> RigidBodyData {
    let reference = flow.law.reference;
    let (pivot, centre) = (in_space(&body.pivot), in_space(&body.centre_of_mass));
    let coordinates: Vec<Coordinate> = body.freedoms.iter().map(|freedom| coordinate(case, freedom)).collect();
    let area = wetted_area(case, body, &coordinates);
    let force = body.force.clone().map(|force| {
        let force = move |t: f64| in_space(&force.evaluate(&[0.0; D], t));
        Arc::new(force) as Arc<dyn Fn(f64) -> Vec3 + Send + Sync>
    });
    RigidBodyData {
        name: body.name.clone(),
        mass: body.mass,
        inertia: body.inertia,
        centre_of_mass: std::array::from_fn(|i| centre[i] - pivot[i]),
        pivot,
        force,
        added_mass: AddedMass {
            density: reference.density(),
            speed_of_sound: flow.law.gas.sound_speed(reference.density(), flow.reference_pressure()),
            depth: depth::<D>(surface.size, &coordinates, &area),
            area,
        },
        coordinates,
    }
}

/// The depth L of the fluid that moves with a body of the size l. G is its wetted `area`, see [`AddedMass`].
///
/// In two dimensions L = pi l^2 / (4 max G_kk) over translations: the added mass is that of an ellipse that moves across its longer axis.
fn depth<const D: usize>(size: f64, coordinates: &[Coordinate], area: &basis::Matrix) -> f64 {
    let of = |(k, coordinate): (usize, &Coordinate)| if coordinate.freedom.rotates() { 0.0 } else { area[(k, k)] };
    let widest = coordinates.iter().enumerate().map(of).fold(0.0, f64::max);
    if D == 2 && widest > 0.0 { FRAC_PI_4 * size * size / widest } else { DEPTH * size }
}

/// The rate of a `motion` at time `t`.
pub fn rate(motion: &Program, t: f64) -> f64 {
    motion.evaluate(&[], Dual::new(t, 1.0)).derivative
}

fn coordinate<const D: usize>(case: &Case<D>, freedom: &Freedom) -> Coordinate {
    let drive = freedom.motion.clone().map(|motion| {
        let differentiated = motion.clone();
        let position = move |t: f64| motion.evaluate::<f64>(&[], t);
        let rate = move |t: f64| rate(&differentiated, t);
        Drive { position: Arc::new(position), rate: Arc::new(rate), release: freedom.release }
    });
    let rate_at_start = freedom.motion.as_ref().map_or(freedom.rate, |motion| rate(motion, case.time.start));
    Coordinate {
        freedom: freedom.direction,
        stiffness: freedom.spring,
        cubic_stiffness: freedom.cubic_spring,
        damping: freedom.damping,
        stops: freedom.stops,
        rest: freedom.rest,
        rate_at_start,
        drive,
    }
}

/// int (g_k . n)(g_l . n) dS over the walls of a body at rest, by the corners of each facet: it enters a preconditioner alone.
fn wetted_area<const D: usize>(case: &Case<D>, body: &case::RigidBody<D>, coordinates: &[Coordinate]) -> basis::Matrix {
    let mut sums = vec![0.0; coordinates.len() * coordinates.len()];
    for nodes in wall_facets(&case.mesh, &body.walls) {
        let (centre, normal) = middle_and_area(&nodes);
        let area = tensor::norm(&normal);
        let speeds: Vec<f64> = coordinates
            .iter()
            .map(|coordinate| {
                let mode = mode(&coordinate.freedom, &body.pivot, &centre);
                tensor::dot(&mode, &normal) / area.max(f64::MIN_POSITIVE)
            })
            .collect();
        for (k, a) in speeds.iter().enumerate() {
            speeds.iter().enumerate().for_each(|(l, b)| sums[k * coordinates.len() + l] += a * b * area);
        }
    }
    basis::Matrix::new(coordinates.len(), coordinates.len(), sums)
}

/// The velocity at `x` of a body about `pivot`, per rate of its coordinate along `direction`.
pub fn mode<const D: usize>(direction: &Direction, pivot: &[f64; D], x: &Vec3) -> Vec3 {
    match direction {
        Direction::Translation(direction) => *direction,
        Direction::Rotation(axis) => {
            let arm = std::array::from_fn(|i| x[i] - pivot.get(i).copied().unwrap_or(0.0));
            tensor::cross(axis, &arm)
        }
    }
}

/// A point of the plane or of space.
pub fn in_space<const D: usize>(x: &[f64; D]) -> Vec3 {
    std::array::from_fn(|i| x.get(i).copied().unwrap_or(0.0))
}

/// The mean position of the nodes of a facet, and its area vector, of either sign.
pub fn middle_and_area<const D: usize>(nodes: &[[f64; D]]) -> (Vec3, Vec3) {
    let in_space = |x: &[f64; D]| -> Vec3 { std::array::from_fn(|d| x.get(d).copied().unwrap_or(0.0)) };
    let centre = std::array::from_fn(|i| nodes.iter().map(|x| in_space(x)[i]).sum::<f64>() / nodes.len() as f64);
    let (first, last) = (in_space(&nodes[0]), in_space(&nodes[nodes.len() - 1]));
    let along: Vec3 = std::array::from_fn(|i| last[i] - first[i]);
    if D == 2 {
        return (centre, [along[1], -along[0], 0.0]);
    }
    let side = (nodes.len() as f64).sqrt().round() as usize;
    let (one, other) = (in_space(&nodes[side - 1]), in_space(&nodes[nodes.len() - side]));
    let across: Vec3 = std::array::from_fn(|i| other[i] - one[i]);
    (centre, tensor::cross(&along, &across).map(|a| 0.5 * a))
}

/// The names of the columns of history.csv that the bodies of a case have.
pub fn columns<const D: usize>(case: &Case<D>) -> Vec<String> {
    let names = |body: &case::RigidBody<D>| {
        body.freedoms.iter().map(|freedom| format!("{}_{}", body.name, freedom.name)).collect()
    };
    let rigid = case.bodies.iter().flat_map(|body| of_body(&body.name, names(body), "spring_energy"));
    let elastic = beside_flow(case).into_iter();
    let elastic = elastic.flat_map(|(structure, _)| {
        let reactions = reaction_names(structure, &case.mesh);
        of_body(STRUCTURE, point_names(structure), "strain_energy").chain(reactions)
    });
    rigid.chain(elastic).collect()
}

/// The reactions of the supports of a structure in a case whose flow or structure has the mesh `other`.
pub fn reaction_names<const D: usize>(structure: &Structure<D>, other: &Mesh<D>) -> Vec<String> {
    let names = structure.mesh(other).boundary_names();
    let name = |(boundary, component): (usize, usize)| format!("{}_reaction_{}", names[boundary], AXES[component]);
    supported(&structure.boundary).map(name).collect()
}

/// The columns of the body `name` with the given `coordinates`.
fn of_body(name: &str, coordinates: Vec<String>, potential_energy: &str) -> impl Iterator<Item = String> {
    let works = ["flow_work", "drive_work", "force_work", "damped", "numerical_dissipation"];
    let energies = ["kinetic_energy", potential_energy].into_iter().chain(works);
    let of_coordinate = |coordinate: String| [coordinate.clone(), format!("{coordinate}_rate")];
    let energies: Vec<String> = energies.map(|column| format!("{name}_{column}")).collect();
    coordinates.into_iter().flat_map(of_coordinate).chain(energies)
}

/// The displacements of the observed points of a structure.
pub fn point_names<const D: usize>(structure: &Structure<D>) -> Vec<String> {
    let of_point = |name: &String| AXES[..D].iter().map(|axis| format!("{name}_{axis}")).collect::<Vec<_>>();
    structure.points.iter().flat_map(|(name, _)| of_point(name)).collect()
}

/// Their values.
pub fn row(state: &BodyState) -> Vec<f64> {
    let coordinates = state.position.iter().zip(&state.rate).flat_map(|(position, rate)| [*position, *rate]);
    let ledger = &state.ledger;
    let works = [ledger.flow, ledger.drive, ledger.force, ledger.damped, ledger.numerical];
    let energies = [state.kinetic_energy, state.potential_energy];
    coordinates.chain(energies).chain(works).chain(state.reactions.iter().copied()).collect()
}
