//! Rigid bodies beside mesh and flow: derivatives of the whole system, and its energy.

use crate::slab_operator::uniform_coefficients;
use basis::Matrix;
use coupled::block::Body;
use coupled::blocks::rigid_body::{AddedMass, Coordinate, Freedom, RigidBodyData, Surface, SurfaceNode};
use coupled::blocks::{RigidBody, SlabTimes};
use coupled::{
    BoundaryDisplacement, FlowMarch, Jacobian, MeshMotion, MeshMover, Predictor, Schedule, Settings, State, System,
};
use elasticity::{Accuracy, ElasticMesh, Material, Stiffness};
use fem::{Orders, StateField};
use mesh::{BoxMesh, Curving, Mesh, NodeNumbering};
use navier_stokes::exact::FreeStream;
use navier_stokes::{AdiabaticWall, Boundary, Compiled, Exact, NavierStokes, Riemann, Viscosity};
use newton_krylov::newton;
use newton_krylov::problem::NonlinearProblem;
use verification::Noise;

/// A free coordinate on springs of all kinds.
fn coordinate(freedom: Freedom) -> Coordinate {
    Coordinate {
        freedom,
        stiffness: 2.0,
        cubic_stiffness: 5.0,
        damping: 0.0,
        stops: None,
        rest: 0.1,
        rate_at_start: if freedom.rotates() { 0.2 } else { 0.05 },
        drive: None,
    }
}

/// A box of gas at rest whose right wall is a body with all degrees of freedom: three in the plane, six in space.
fn system<const D: usize, const M: usize>(elastic: bool) -> (System<D, M>, Vec<f64>)
where
    Exact<FreeStream<D>>: StateField<D, M>,
    NavierStokes<D>: Compiled<D, M, Boundary = Boundary<D>>,
{
    let curving = Curving::Smooth { amplitude: 0.02 };
    let mesh: Mesh<D> =
        BoxMesh { lower: [0.0; D], upper: [1.0; D], cells: [2; D], order: 3, curving, periodic: [false; D] }
            .build()
            .unwrap();
    let (orders, numbering) = (Orders { flow: 3, mesh: 3, time: 2 }, NodeNumbering::new(&mesh, 3));
    let law = verification::law::<D>(Viscosity::Constant(0.05), Riemann::Roe);
    let wall = Boundary::AdiabaticWall(AdiabaticWall::new([0.0; D]).unwrap());
    let mut flow = verification::operator(&mesh, law, orders, wall, verification::free_stream::<D, M>(&law));
    let right = mesh.boundary_names().iter().position(|name| name == "right").unwrap();
    flow.load_boundaries(&(0..2 * D).map(|boundary| boundary == right).collect::<Vec<_>>());
    let motion = if elastic { elastic_mesh(&mesh, &numbering) } else { MeshMotion::Followed };
    let on_wall = numbering.on_boundary(&mesh, right);
    let mover = MeshMover::new(motion, mesh, numbering, orders.time);
    let node = |node: usize, weight: f64| SurfaceNode { node, position: mover.positions()[node], weight };
    let inside = (0..mover.positions().len()).filter(|i| !elastic && !on_wall.contains(i));
    let nodes = on_wall.iter().map(|i| node(*i, 1.0)).chain(inside.map(|i| node(i, mover.positions()[i][0])));
    let surface = Surface { nodes: nodes.collect(), loaded: (0..on_wall.len()).collect(), size: 1.0 };
    let along = |axis: usize| std::array::from_fn(|i| f64::from(u8::from(i == axis)));
    let translations = (0..D).map(|axis| Freedom::Translation(along(axis)));
    let rotations = (if D == 2 { 2..3 } else { 0..3 }).map(|axis| Freedom::Rotation(along(axis)));
    let coordinates: Vec<Coordinate> = translations.chain(rotations).map(coordinate).collect();
    let count = coordinates.len();
    let data = RigidBodyData {
        name: "wall".into(),
        mass: 0.6,
        inertia: [[0.2, 0.02, 0.01], [0.02, 0.25, 0.03], [0.01, 0.03, 0.3]],
        centre_of_mass: [0.2, 0.1, 0.0],
        pivot: [1.0, 0.4, 0.0],
        coordinates,
        force: None,
        added_mass: AddedMass { density: 1.0, speed_of_sound: 1.5, depth: 0.3, area: Matrix::identity(count) },
    };
    let points = flow.tables.time_points.iter().map(|point| point.s).collect();
    let times = SlabTimes { time: flow.tables.time.clone(), points, step: 0.05 };
    let body = RigidBody::new(data, surface, 0, times);
    let mut state = [0.0; M];
    (state[0], state[M - 1]) = (1.0, 1.7 / 0.4);
    let u = uniform_coefficients(&flow, &state, 1);
    let u = u[..flow.layout.at_one_time().len()].to_vec();
    (System::with_bodies(flow, mover, vec![Box::new(body) as Box<dyn Body>]), u)
}

fn elastic_mesh<const D: usize>(mesh: &Mesh<D>, numbering: &NodeNumbering) -> MeshMotion<D> {
    let mut constrained = vec![[false; D]; numbering.count];
    for boundary in 0..2 * D {
        numbering.on_boundary(mesh, boundary).into_iter().for_each(|node| constrained[node] = [true; D]);
    }
    let material = Material::new(1.0, 0.3).unwrap();
    let elastic = ElasticMesh::new(mesh, numbering, material, Stiffness::Constant, &constrained).unwrap();
    let boundary = BoundaryDisplacement { fields: Vec::new(), field_of_node: vec![None; numbering.count] };
    MeshMotion::Elastic { mesh: Box::new(elastic), boundary, accuracy: Accuracy { solve: 1e-13, position: 1e-11 } }
}

/// The largest difference between a product and a central difference in every block, relative to the product there.
fn product_error<const D: usize, const M: usize>(elastic: bool) -> f64
where
    Exact<FreeStream<D>>: StateField<D, M>,
    NavierStokes<D>: Compiled<D, M, Boundary = Boundary<D>>,
{
    let (system, u) = system::<D, M>(elastic);
    let mut march = FlowMarch::new(system, u, settings(1e-8));
    let state: State = march.state.clone();
    let interval = coupled::Interval { start: 0.0, end: 0.05, halvings: 0 };
    let (z, _) = march.solver.guess(&state, interval).unwrap();
    let system = &mut march.solver.system;
    let mut noise = Noise::new(3);
    let size = |i: usize| if system.mesh_range().contains(&i) { 0.05 } else { 0.02 };
    let z: Vec<f64> = z.iter().enumerate().map(|(i, z)| z + size(i) * noise.number()).collect();
    let x = noise.vector(z.len(), 1.0);
    let mut product = vec![0.0; z.len()];
    // Newton's method linearises where it has evaluated the residual.
    system.residual(&z, &mut product).unwrap();
    system.linearise(&z, &vec![0.0; system.fields().len()]).unwrap();
    system.jacobian_product(&x, &mut product);
    let step = 1e-6;
    let mut at = |a: f64| {
        let trial: Vec<f64> = z.iter().zip(&x).map(|(z, x)| z + a * x).collect();
        let mut r = vec![0.0; z.len()];
        system.residual(&trial, &mut r).unwrap();
        r
    };
    let (plus, minus) = (at(step), at(-step));
    let difference: Vec<f64> = plus.iter().zip(&minus).map(|(p, m)| (p - m) / (2.0 * step)).collect();
    let ranges = system.fields().iter().map(|field| field.range.clone());
    ranges
        .map(|range| verification::relative_difference(&difference[range.clone()], &product[range]))
        .fold(0.0, f64::max)
}

fn settings(tolerance: f64) -> Settings {
    let newton =
        newton::Settings { relative_tolerance: tolerance, absolute_tolerance: 1e-13, ..newton::Settings::default() };
    let (predictor, jacobian) = (Predictor::Elastic, Jacobian::Exact);
    Settings { schedule: Schedule::uniform(0.5, 10), newton, predictor, jacobian, max_halvings: 0 }
}

#[test]
fn products_of_the_coupled_system_match_differences() {
    for elastic in [false, true] {
        let error = product_error::<2, 4>(elastic);
        println!("2-D, elastic mesh: {elastic}: {error:e}");
        assert!(error < 1e-7, "2-D, elastic mesh: {elastic}: {error:e}");
        let error = product_error::<3, 5>(elastic);
        println!("3-D, elastic mesh: {elastic}: {error:e}");
        assert!(error < 1e-7, "3-D, elastic mesh: {elastic}: {error:e}");
    }
}

/// Gas and body together lose what the ledger of the body says, and nothing else, in every slab: the largest error over `slabs`.
fn energy_error<const D: usize, const M: usize>(elastic: bool, slabs: usize) -> f64
where
    Exact<FreeStream<D>>: StateField<D, M>,
    NavierStokes<D>: Compiled<D, M, Boundary = Boundary<D>>,
{
    let (system, u) = system::<D, M>(elastic);
    let names = system.mover().reference.boundary_names();
    let right = names.iter().position(|name| name == "right").unwrap();
    let mut march = FlowMarch::new(system, u, settings(1e-12));
    let energy = |march: &FlowMarch<D, M>| {
        let body = &march.bodies()[0];
        march.totals()[M - 1] + body.energy() + body.ledger.numerical
    };
    let (start, mut largest, mut left) = (energy(&march), 0.0_f64, 0.0);
    for _ in 0..slabs {
        let report = march.advance().unwrap();
        assert!(report.newton.steps.len() <= 6, "{} Newton steps", report.newton.steps.len());
        // The walls beside the body move where they meet it: what leaves there is not the body's.
        for at in &report.fluxes {
            let beside = at.boundaries.iter().enumerate().filter(|(boundary, _)| *boundary != right);
            left += beside.map(|(_, flux)| at.weight * flux.total()[M - 1]).sum::<f64>();
        }
        largest = largest.max((energy(&march) + left - start).abs() / start);
    }
    let body = &march.bodies()[0];
    println!("{D}-D, elastic mesh: {elastic}: energy {largest:e}, dissipation {:e}", body.ledger.numerical);
    assert!(body.position.iter().all(|q| q.abs() > 1e-3), "{:?}", body.position);
    largest
}

#[test]
fn the_energy_of_gas_and_body_is_conserved() {
    for elastic in [false, true] {
        let error = energy_error::<2, 4>(elastic, 10);
        assert!(error < 1e-12, "elastic mesh: {elastic}: {error:e}");
    }
}

#[test]
fn the_energy_of_gas_and_a_body_with_six_degrees_of_freedom_is_conserved() {
    for elastic in [false, true] {
        let error = energy_error::<3, 5>(elastic, 3);
        assert!(error < 1e-11, "elastic mesh: {elastic}: {error:e}");
    }
}
