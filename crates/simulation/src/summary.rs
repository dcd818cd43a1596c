//! summary.json

use super::bodies;
use super::body_record::{BodyRecord, Oscillation};
use super::context::{self, RunContext, Stop};
use super::errors;
use super::history::openings;
use super::openings::Misuse;
use super::statistics::{self, RunStatistics};
use super::walls::from_numbers;
use case::{Case, DisplacementOf, Flow, Motion, Stiffness};
use coupled::block::BodyState;
use coupled::blocks::rigid_body::{Freedom as Direction, Vec3};
use coupled::{FlowMarch, MeshMover, StructureMarch};
use elasticity::NaturalMode;
use navier_stokes::Coefficients;
use newton_krylov::inner_product::largest;
use output::{
    Body, Conservation, ErrorNorms, Krylov, MeshQuality, MeshSize, Misused, Newton, Opening, Steady, SteadyStability,
    SteadyWall, StructureSummary, Summary, Unknowns, Wall,
};

/// The summary of a run of mesh and flow. `errors_of_cells` are those of [`errors::of_cells`], if they are known.
pub fn of_flow<const D: usize, const M: usize>(
    case: &Case<D>,
    flow: &Flow<D>,
    (march, errors_of_cells): (&FlowMarch<D, M>, &[f64]),
    context: &RunContext,
    stop: Option<&Stop>,
) -> Summary {
    let statistics = &context.statistics;
    let mut summary = of_mesh(case, &march.solver.system.mesh.mover, &march.state, context, stop);
    summary.unknowns.flow = Some(case.flow_unknowns());
    add_solver(&mut summary, statistics, march.state.slab as u64);
    if flow.exact.is_some() {
        errors::norms::<D, M>(errors_of_cells, summary.error.get_or_insert_default());
    }
    let conservation = conservation::<D, M>(case, flow, errors_of_cells, statistics);
    summary.conservation = (conservation != Conservation::default()).then_some(conservation);
    add_boundaries(&mut summary, case, flow, statistics);
    add_bodies(&mut summary, case, &march.bodies(), statistics);
    summary.steady = statistics.steady.as_ref().map(|steady| of_steady(flow, steady));
    summary
}

/// Counts of Newton steps and Krylov iterations over `slabs`.
fn add_solver(summary: &mut Summary, statistics: &RunStatistics, slabs: u64) {
    summary.newton = Some(Newton {
        total: statistics.newton,
        max: statistics.newton_max,
        per_slab: ratio(statistics.newton, slabs),
    });
    summary.krylov = Some(Krylov {
        total: statistics.krylov,
        max_per_newton: statistics.krylov_max,
        mean_per_newton: ratio(statistics.krylov, statistics.newton),
        elasticity_total: summary.unknowns.mesh.map(|_| statistics.elasticity),
    });
}

/// The errors of mass and energy, and of a uniform flow.
fn conservation<const D: usize, const M: usize>(
    case: &Case<D>,
    flow: &Flow<D>,
    errors_of_cells: &[f64],
    statistics: &RunStatistics,
) -> Conservation {
    // A body force keeps mass and does work.
    let is_closed = flow.source.is_none();
    Conservation {
        mass_error: flow.conserves_mass().then_some(statistics.mass_error),
        energy_error: is_closed.then_some(statistics.energy_error),
        coupled_energy_error: (is_closed && bodies::has_bodies(case)).then_some(statistics.coupled_energy_error),
        free_stream_error: flow.free_stream().map(|stream| errors::largest_deviation::<D, M>(errors_of_cells, stream)),
    }
}

/// Walls, inflows and outflows.
fn add_boundaries<const D: usize>(summary: &mut Summary, case: &Case<D>, flow: &Flow<D>, statistics: &RunStatistics) {
    let impulse = |wall: usize| statistics.impulses.get(wall).map_or(&[][..], Vec::as_slice);
    let force = |wall: usize| statistics.forces.get(wall).map_or(&[][..], Vec::as_slice);
    for (number, wall) in flow.walls.iter().enumerate() {
        summary.walls.insert(wall.name.clone(), of_wall(wall, impulse(number), force(number)));
    }
    for boundary in openings(flow) {
        summary.openings.insert(case.mesh.boundary_names()[boundary].clone(), of_opening(statistics, boundary));
    }
}

/// Rigid bodies, and a structure after them, with their `states`.
fn add_bodies<const D: usize>(summary: &mut Summary, case: &Case<D>, states: &[BodyState], statistics: &RunStatistics) {
    for ((body, state), record) in case.bodies.iter().zip(states).zip(&statistics.bodies) {
        let size = bodies::extent(&case.mesh, &body.walls);
        summary.bodies.insert(body.name.clone(), of_body(body, size, state, record));
    }
    if let (Some((structure, _)), Some(state), Some(record)) =
        (bodies::beside_flow(case), states.last(), statistics.bodies.last())
    {
        summary.bodies.insert(bodies::STRUCTURE.to_owned(), of_elastic_body(structure, state, record));
    }
}

/// The figures of a wall, from its impulses over the run and its forces at the end.
fn of_wall<const D: usize>(wall: &case::Wall<D>, impulses: &[f64], forces: &[f64]) -> Wall {
    let impulses = from_numbers::<D>(impulses);
    let coefficients = wall.scales.coefficients(&from_numbers(forces));
    Wall {
        impulse: impulses.force().to_vec(),
        pressure_impulse: impulses.pressure.to_vec(),
        friction_impulse: impulses.friction.to_vec(),
        moment_impulse: wall.moments(&impulses),
        work: impulses.power,
        heat: impulses.heat,
        drag_coefficient: Some(coefficients.drag),
        lift_coefficient: Some(coefficients.lift),
        moment_coefficient: Some(coefficients.moment),
    }
}

/// Of a rigid body of a `size`.
fn of_body<const D: usize>(body: &case::RigidBody<D>, size: f64, state: &BodyState, record: &BodyRecord) -> Body {
    let named = |freedom: &case::Freedom| {
        let arm = if freedom.direction.rotates() { size } else { 1.0 };
        (freedom.name.to_owned(), arm)
    };
    let (displacement, theta) = moved(body, &state.position);
    let (velocity, rate) = moved(body, &state.rate);
    let turns = body.freedoms.iter().any(|freedom| freedom.name.starts_with("rotation_"));
    let about_axis = |numbers: &[f64]| {
        body.freedoms.iter().zip(numbers).find(|(freedom, _)| freedom.name == "rotation").map(|(_, number)| *number)
    };
    Body {
        displacement: displacement[..D].to_vec(),
        rotation: about_axis(&state.position),
        rotation_vector: turns.then(|| theta.to_vec()),
        velocity: velocity[..D].to_vec(),
        angular_velocity: about_axis(&state.rate),
        angular_velocity_vector: turns.then(|| tensor::angular_velocity(&theta, &rate).to_vec()),
        spring_energy: Some(state.potential_energy),
        ..of_any_body(body.freedoms.iter().map(named).collect(), state, record)
    }
}

/// The translation and the rotation vector of a body with the coordinates `q`; if `q` are rates, their rates.
fn moved<const D: usize>(body: &case::RigidBody<D>, q: &[f64]) -> (Vec3, Vec3) {
    let (mut translation, mut rotation) = ([0.0; 3], [0.0; 3]);
    for (freedom, q) in body.freedoms.iter().zip(q) {
        let (sum, direction) = match freedom.direction {
            Direction::Translation(direction) => (&mut translation, direction),
            Direction::Rotation(axis) => (&mut rotation, axis),
        };
        (0..3).for_each(|i| sum[i] += q * direction[i]);
    }
    (translation, rotation)
}

/// The figures of an elastic body; its displacement is that of its first observed point.
pub fn of_elastic_body<const D: usize>(structure: &case::Structure<D>, state: &BodyState, record: &BodyRecord) -> Body {
    let first = |field: &[f64]| field.iter().take(D).copied().collect();
    Body {
        displacement: first(&state.position),
        velocity: first(&state.rate),
        strain_energy: Some(state.potential_energy),
        ..of_any_body(bodies::point_names(structure).into_iter().map(|name| (name, 1.0)).collect(), state, record)
    }
}

/// Ways below this part of that of the body are rounding.
const ROUNDING: f64 = 1e-10;

/// Oscillations and energies of a body. Each of its `coordinates` has a name and an arm, the way that its unit moves the body. The one that
/// moves the body most stands for it.
fn of_any_body(coordinates: Vec<(String, f64)>, state: &BodyState, record: &BodyRecord) -> Body {
    let way = |(coordinate, (_, arm)): (&Oscillation, &(String, f64))| arm * coordinate.range();
    let ways: Vec<f64> = record.coordinates.iter().zip(&coordinates).map(way).collect();
    let rounding = ROUNDING * largest(ways.iter().copied());
    let figures = |(coordinate, (_, arm)): (&Oscillation, &(String, f64))| coordinate.figures(rounding / arm);
    let figures: Vec<_> = record.coordinates.iter().zip(&coordinates).map(figures).collect();
    let most = (0..ways.len()).max_by(|a, b| ways[*a].total_cmp(&ways[*b])).map(|number| &figures[number]);
    Body {
        amplitude: most.and_then(|figures| figures.amplitude),
        frequency: most.and_then(|figures| figures.frequency),
        coordinates: coordinates.into_iter().map(|(name, _)| name).zip(figures).collect(),
        work: state.ledger.flow,
        kinetic_energy: state.kinetic_energy,
        drive_work: state.ledger.drive,
        force_work: state.ledger.force,
        damped: state.ledger.damped,
        numerical_dissipation: state.ledger.numerical,
        ..Body::default()
    }
}

/// The figures of an inflow or outflow.
fn of_opening(statistics: &RunStatistics, boundary: usize) -> Opening {
    let seen = |misuse: Misuse| {
        let record = statistics.openings.iter().find(|r| r.now.boundary == boundary && r.now.misuse == misuse)?;
        Some(Misused { since: record.since, share: record.now.share, largest_share: record.largest_share })
    };
    Opening {
        mass_flow: statistics.mass_flows.get(boundary).copied(),
        supersonic: seen(Misuse::Supersonic),
        leaving: seen(Misuse::Leaving),
        backflow: seen(Misuse::Backflow),
        subsonic: seen(Misuse::Subsonic),
        overtaking: seen(Misuse::Overtaking),
    }
}

/// The figures of the steady flow at the start.
fn of_steady<const D: usize>(flow: &Flow<D>, steady: &statistics::Steady) -> Steady {
    let drag = |(wall, forces): (&case::Wall<D>, &Vec<f64>)| {
        let Coefficients { drag, lift, moment } = wall.scales.coefficients(&from_numbers(forces));
        (wall.name.clone(), SteadyWall { drag_coefficient: drag, lift_coefficient: lift, moment_coefficient: moment })
    };
    Steady {
        newton: steady.newton,
        krylov: steady.krylov,
        residual: steady.residual,
        next_order_residual: steady.reliability.next_order_residual,
        stability: steady.reliability.stability.map(|stability| SteadyStability {
            growth: stability.growth,
            duration: stability.duration,
            completed: stability.completed,
            unstable: stability.is_unstable(),
        }),
        walls: flow.walls.iter().zip(&steady.forces).map(drag).collect(),
    }
}

/// The summary of a run of the mesh alone.
pub fn of_mesh<const D: usize>(
    case: &Case<D>,
    mover: &MeshMover<D>,
    state: &coupled::State,
    context: &RunContext,
    stop: Option<&Stop>,
) -> Summary {
    let statistics = &context.statistics;
    let displacement_max = displacement_error(case, mover, state);
    Summary {
        unknowns: Unknowns { mesh: case.mesh_unknowns(), ..Default::default() },
        mesh_quality: statistics.quality.map(|quality| MeshQuality {
            det_j_lower_bound: Some(quality.lower_bound),
            det_j_sampled_min: Some(quality.sampled_min),
            scaled_jacobian_min: Some(quality.scaled_jacobian),
            first_invalid_time: statistics.first_invalid.map(|first| first.time),
            first_invalid_time_sampled: statistics.first_invalid_sampled,
        }),
        error: displacement_max.map(|_| ErrorNorms { displacement_max, ..Default::default() }),
        ..common(case, state, context, stop)
    }
}

/// The summary of a run of a structure that has the given `energy` now.
pub fn of_structure<const D: usize>(
    case: &Case<D>,
    march: &StructureMarch<D>,
    energy: f64,
    modes: &[NaturalMode],
    context: &RunContext,
    stop: Option<&Stop>,
) -> Summary {
    let balance = context.statistics.structure;
    let free = march.structure().count_free();
    let mut summary = common(case, &march.state, context, stop);
    summary.unknowns.structure = Some(free * case.time.order);
    summary.structure = Some(StructureSummary {
        natural_frequencies: modes.iter().map(NaturalMode::frequency).collect(),
        loaded_frequencies: Vec::new(),
        least_stiffness: None,
        buckling_factor: None,
        energy_at_start: balance.energy_at_start,
        energy,
        load_work: balance.load_work,
        support_work: balance.support_work,
        dissipation: balance.dissipation,
        energy_error: balance.error(energy),
        iterations: context.statistics.elasticity,
    });
    summary
}

/// The common part of all summaries.
fn common<const D: usize>(
    case: &Case<D>,
    state: &coupled::State,
    context: &RunContext,
    stop: Option<&Stop>,
) -> Summary {
    Summary {
        case: case.about.name.clone(),
        version: env!("CARGO_PKG_VERSION").into(),
        completed: stop.is_none(),
        reason: stop.map(Stop::reason),
        mesh: MeshSize { dimension: D, cells: case.mesh.n_cells(), order: case.mesh.order() },
        slabs: state.slab as u64,
        // Of a slab that was never solved, too.
        rejected_slabs: context.statistics.rejected + state.rejected as u64,
        start_layer: context.statistics.start_layer,
        split_form_since: context.statistics.split_form_since,
        time: state.time,
        machine: Some(context::machine()),
        cost: context.cost(),
        ..Default::default()
    }
}

fn ratio(a: u64, b: u64) -> f64 {
    if b == 0 { 0.0 } else { a as f64 / b as f64 }
}

/// The largest distance of a C0 node from its exact position, if that is known.
fn displacement_error<const D: usize>(case: &Case<D>, mover: &MeshMover<D>, state: &coupled::State) -> Option<f64> {
    let exact = known_displacement(case, state.time)?;
    let distance = |(x, d): (&[f64; D], &[f64])| {
        let exact = exact(x);
        (0..D).map(|i| (d[i] - exact[i]).powi(2)).sum::<f64>().sqrt()
    };
    Some(largest(mover.positions().iter().zip(state.d.chunks_exact(D)).map(distance)))
}

/// The displacement of every point at time `t`: prescribed everywhere, or the affine map that the whole boundary follows. With
/// a constant stiffness an affine map has constant stress, so that it is in equilibrium inside too.
fn known_displacement<const D: usize>(case: &Case<D>, t: f64) -> Option<DisplacementOf<'_, D>> {
    match case.motion.as_ref()? {
        Motion::Prescribed(displacement) => Some(Box::new(move |x| displacement.evaluate(x, t))),
        Motion::Elastic { stiffness: Stiffness::Constant, boundary, .. } => {
            let first = boundary.first()?.as_ref()?;
            let displacement = first.of_position(t)?;
            let whole = boundary.iter().all(|other| other.as_ref() == Some(first));
            let periodic = case.mesh.interior_facets().iter().any(|facet| facet.periodic);
            (whole && !periodic && is_affine(case, &displacement)).then_some(displacement)
        }
        Motion::Elastic { .. } | Motion::Followed => None,
    }
}

/// Whether g(x) = g(0) + sum_i x_i (g(e_i) - g(0)) at all nodes, up to round-off.
fn is_affine<const D: usize>(case: &Case<D>, g: &DisplacementOf<'_, D>) -> bool {
    let origin = g(&[0.0; D]);
    let units: [_; D] = std::array::from_fn(|i| g(&std::array::from_fn(|j| f64::from(u8::from(i == j)))));
    let tolerance = 1e-12 * case.mesh.diameter();
    case.mesh.coordinates().chunks_exact(D).all(|x| {
        let value = g(&std::array::from_fn(|i| x[i]));
        (0..D).all(|d| {
            let affine = origin[d] + (0..D).map(|i| x[i] * (units[i][d] - origin[d])).sum::<f64>();
            (value[d] - affine).abs() <= tolerance
        })
    })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    /// A coordinate that has not turned moved the body; the noise of another one, which had turned, stood for it.
    #[test]
    fn the_coordinate_that_moves_most_stands_for_a_body_even_before_it_turns() {
        let at = |t: f64| BodyState {
            position: vec![(0.5 * t).sin(), 1e-20 * (9.0 * t).sin()],
            rate: vec![0.5 * (0.5 * t).cos(), 9e-20 * (9.0 * t).cos()],
            ..BodyState::default()
        };
        let mut record = BodyRecord::start(&at(0.0), 0.0);
        (1..60).map(|k| 0.05 * f64::from(k)).for_each(|t| record.add(&at(t), t));
        let body = of_any_body(vec![("x".to_owned(), 1.0), ("y".to_owned(), 1.0)], &at(3.0), &record);
        assert_eq!((body.amplitude, body.frequency), (None, None));
        assert_eq!(body.coordinates["y"], output::Oscillation::default());
    }

    /// A small body that pitches by 0.2 rad and heaves by half of its size: the larger number is not the larger motion.
    #[test]
    fn an_angle_is_weighed_against_a_length() {
        let at = |t: f64| BodyState {
            position: vec![5e-4 * (3.0 * t).sin(), 0.2 * (5.0 * t).sin()],
            rate: vec![1.5e-3 * (3.0 * t).cos(), (5.0 * t).cos()],
            ..BodyState::default()
        };
        let mut record = BodyRecord::start(&at(0.0), 0.0);
        (1..200).map(|k| 0.05 * f64::from(k)).for_each(|t| record.add(&at(t), t));
        let amplitude = |size: f64| {
            let coordinates = vec![("y".to_owned(), 1.0), ("rotation".to_owned(), size)];
            of_any_body(coordinates, &at(10.0), &record).amplitude.unwrap()
        };
        let (small, large) = (amplitude(1e-3), amplitude(1.0));
        assert!((small - 5e-4).abs() < 1e-6 && (large - 0.2).abs() < 1e-3, "{small} {large}");
    }
}
