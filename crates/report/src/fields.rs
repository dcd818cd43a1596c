//! Fields for display, at equidistant points of every cell.

use case::Field;
use elasticity::{Stress, principal, von_mises};
use fem::Sampler;
use navier_stokes::{Gas, Primitive};
use output::FieldSpec;

/// The data at the points of a cell: arrays `[component][point]`.
pub struct CellSample<'a> {
    /// The sampler.
    pub points: usize,
    /// The state.
    pub state: &'a [f64],
    /// The velocity of the mesh.
    pub mesh_velocity: &'a [f64],
    /// det J / det J_0.
    pub jacobian: &'a [f64],
    /// grad u, by direction.
    pub gradients: &'a [Vec<f64>],
    /// The displacement; empty if it is not known.
    pub displacement: &'a [f64],
    /// The stress at each point of a structure; empty in a flow.
    pub stress: &'a [Stress],
}

impl CellSample<'_> {
    /// So many points, of which nothing is known.
    pub fn of_points(points: usize) -> Self {
        CellSample {
            points,
            state: &[],
            mesh_velocity: &[],
            jacobian: &[],
            gradients: &[],
            displacement: &[],
            stress: &[],
        }
    }
}

/// The storage of a field.
pub fn spec(field: Field, dimension: usize) -> FieldSpec {
    match field {
        Field::Density => FieldSpec::scalar("density"),
        Field::Velocity => FieldSpec::vector("velocity"),
        Field::Pressure => FieldSpec::scalar("pressure"),
        Field::Temperature => FieldSpec::scalar("temperature"),
        Field::Mach => FieldSpec::scalar("mach"),
        Field::Vorticity if dimension == 2 => FieldSpec::scalar("vorticity"),
        Field::Vorticity => FieldSpec::vector("vorticity"),
        Field::MeshVelocity => FieldSpec::vector("mesh_velocity"),
        Field::Jacobian => FieldSpec::scalar("jacobian"),
        Field::Displacement => FieldSpec::vector("displacement"),
        Field::VonMises => FieldSpec::scalar("von_mises"),
        Field::PrincipalStress => FieldSpec::vector("principal_stress"),
    }
}

/// Whether a field is defined without a flow.
pub fn of_mesh(field: Field) -> bool {
    matches!(field, Field::MeshVelocity | Field::Jacobian | Field::Displacement) || of_structure(field)
}

/// Whether a field is defined in a structure alone.
pub fn of_structure(field: Field) -> bool {
    matches!(field, Field::VonMises | Field::PrincipalStress)
}

/// The values of `field` at the points of a cell, `[point][component]`; NaN where it is not defined. `gas` is that of a cell of the flow.
pub fn values<const D: usize, const M: usize>(
    field: Field,
    gas: Option<&Gas>,
    sample: &CellSample,
    out: &mut Vec<f64>,
) {
    let n = sample.points;
    let vector =
        |field: &[f64], p: usize| std::array::from_fn::<f64, 3, _>(|d| if d < D { field[d * n + p] } else { 0.0 });
    for p in 0..n {
        match (field, gas) {
            (Field::MeshVelocity, _) => out.extend(vector(sample.mesh_velocity, p)),
            (Field::Displacement, _) if !sample.displacement.is_empty() => out.extend(vector(sample.displacement, p)),
            (Field::Jacobian, _) => out.push(sample.jacobian[p]),
            (Field::VonMises, _) if !sample.stress.is_empty() => out.push(von_mises(&sample.stress[p])),
            (Field::PrincipalStress, _) if !sample.stress.is_empty() => out.extend(principal(&sample.stress[p])),
            // A structure has a velocity, too.
            (Field::Velocity, None) if !sample.stress.is_empty() => out.extend(vector(sample.mesh_velocity, p)),
            (field, _) if of_mesh(field) => out.extend(vec![f64::NAN; spec(field, D).components]),
            (Field::Vorticity, Some(_)) => vorticity::<D>(sample, p, out),
            (_, Some(gas)) => of_state::<D, M>(field, gas, &std::array::from_fn(|m| sample.state[m * n + p]), out),
            (field, None) => out.extend(vec![f64::NAN; spec(field, D).components]),
        }
    }
}

fn of_state<const D: usize, const M: usize>(field: Field, gas: &Gas, u: &[f64; M], out: &mut Vec<f64>) {
    let state = Primitive::<f64, D>::unpack(gas, u);
    let speed = state.velocity.iter().map(|w| w * w).sum::<f64>().sqrt();
    match field {
        Field::Density => out.push(state.density),
        Field::Velocity => out.extend((0..3).map(|d| state.velocity.get(d).copied().unwrap_or(0.0))),
        Field::Pressure => out.push(state.pressure),
        Field::Temperature => out.push(gas.temperature(state.density, state.pressure)),
        Field::Mach => out.push(speed / gas.sound_speed(state.density, state.pressure)),
        // Not of the state at a point.
        _ => {}
    }
}

/// curl v from the gradients of density and momentum: d_i v_j = (d_i m_j - v_j d_i rho) / rho.
fn vorticity<const D: usize>(sample: &CellSample, p: usize, out: &mut Vec<f64>) {
    let n = sample.points;
    let rho = sample.state[p];
    let slope = |i: usize, j: usize| {
        let v_j = sample.state[(1 + j) * n + p] / rho;
        (sample.gradients[i][(1 + j) * n + p] - v_j * sample.gradients[i][p]) / rho
    };
    match D {
        2 => out.push(slope(0, 1) - slope(1, 0)),
        _ => out.extend((0..3).map(|k| slope((k + 1) % 3, (k + 2) % 3) - slope((k + 2) % 3, (k + 1) % 3))),
    }
}

/// A sampler of equidistant points, as many per direction as the higher order has nodes.
pub fn equidistant<const D: usize>(flow_order: usize, mesh_order: usize) -> (Sampler<D>, usize) {
    let n = flow_order.max(mesh_order);
    (Sampler::new(flow_order, mesh_order, &basis::equidistant_points(n)), n)
}
