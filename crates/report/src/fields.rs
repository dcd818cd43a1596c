//! Fields for display, at equidistant points of every cell.

use case::{Field, FieldFormula, Flow};
use elasticity::{Stress, principal, von_mises};
use fem::Sampler;
use navier_stokes::{Gas, Primitive};
use output::FieldSpec;

/// A gas, and the state to which pressure coefficients refer.
#[derive(Clone, Copy, Debug)]
pub struct Medium {
    /// The gas.
    pub gas: Gas,
    /// Pressure and dynamic pressure of the reference state, if it is known.
    pub reference: Option<[f64; 2]>,
}

impl Medium {
    /// The gas of a flow.
    pub fn of<const D: usize>(flow: &Flow<D>) -> Self {
        let reference = Some([flow.reference_pressure(), flow.law.reference.dynamic_pressure()]);
        Medium { gas: flow.law.gas, reference }
    }

    /// A gas without a reference state.
    pub fn gas(gas: Gas) -> Self {
        Medium { gas, reference: None }
    }
}

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
    /// The stress at each point of a structure; empty for a flow.
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
        Field::PressureCoefficient => FieldSpec::scalar("pressure_coefficient"),
        Field::TotalPressure => FieldSpec::scalar("total_pressure"),
        Field::TotalTemperature => FieldSpec::scalar("total_temperature"),
        Field::Entropy => FieldSpec::scalar("entropy"),
        Field::QCriterion => FieldSpec::scalar("q_criterion"),
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

/// Whether only structures have the field.
pub fn of_structure(field: Field) -> bool {
    matches!(field, Field::VonMises | Field::PrincipalStress)
}

/// The values of `field` at the points of a cell, `[point][component]`; NaN where it is not defined. Cells of a flow have a `medium`.
pub fn values<const D: usize, const M: usize>(
    field: Field,
    medium: Option<&Medium>,
    sample: &CellSample,
    out: &mut Vec<f64>,
) {
    let n = sample.points;
    let vector =
        |field: &[f64], p: usize| std::array::from_fn::<f64, 3, _>(|d| if d < D { field[d * n + p] } else { 0.0 });
    for p in 0..n {
        match (field, medium) {
            (Field::MeshVelocity, _) => out.extend(vector(sample.mesh_velocity, p)),
            (Field::Displacement, _) if !sample.displacement.is_empty() => out.extend(vector(sample.displacement, p)),
            (Field::Jacobian, _) => out.push(sample.jacobian[p]),
            (Field::VonMises, _) if !sample.stress.is_empty() => out.push(von_mises(&sample.stress[p])),
            (Field::PrincipalStress, _) if !sample.stress.is_empty() => out.extend(principal(&sample.stress[p])),
            // A structure has a velocity, too.
            (Field::Velocity, None) if !sample.stress.is_empty() => out.extend(vector(sample.mesh_velocity, p)),
            (field, _) if of_mesh(field) => out.extend(vec![f64::NAN; spec(field, D).components]),
            (Field::Vorticity, Some(_)) => vorticity(&velocity_gradient::<D>(sample, p), out),
            (Field::QCriterion, Some(_)) => out.push(q_criterion(&velocity_gradient::<D>(sample, p))),
            (_, Some(medium)) => {
                of_state::<D, M>(field, medium, &std::array::from_fn(|m| sample.state[m * n + p]), out);
            }
            (field, None) => out.extend(vec![f64::NAN; spec(field, D).components]),
        }
    }
}

fn of_state<const D: usize, const M: usize>(field: Field, medium: &Medium, u: &[f64; M], out: &mut Vec<f64>) {
    let gas = &medium.gas;
    let state = Primitive::<f64, D>::unpack(gas, u);
    match field {
        Field::Density => out.push(state.density),
        Field::Velocity => out.extend((0..3).map(|d| state.velocity.get(d).copied().unwrap_or(0.0))),
        Field::Pressure => out.push(state.pressure),
        Field::Temperature => out.push(gas.temperature(state.density, state.pressure)),
        Field::Mach => out.push(gas.mach(&state)),
        Field::PressureCoefficient => {
            out.push(medium.reference.map_or(f64::NAN, |[pressure, dynamic]| (state.pressure - pressure) / dynamic));
        }
        Field::TotalPressure => out.push(total_state(gas, &state)[0]),
        Field::TotalTemperature => out.push(total_state(gas, &state)[1]),
        Field::Entropy => out.push(gas.entropy(state.density, state.pressure)),
        // Not of the state at a point.
        _ => {}
    }
}

/// Total pressure and total temperature for an observer at rest.
///
/// ```text
/// p_0 = p (1 + (gamma - 1)/2 M^2)^(gamma/(gamma - 1)),     T_0 = T (1 + (gamma - 1)/2 M^2)                                  (total)
/// ```
pub fn total_state<const D: usize>(gas: &Gas, at: &Primitive<f64, D>) -> [f64; 2] {
    let (gamma, c) = (gas.gamma(), gas.sound_speed(at.density, at.pressure));
    let ratio = 1.0 + 0.5 * (gamma - 1.0) * tensor::dot(&at.velocity, &at.velocity) / (c * c);
    let temperature = gas.temperature(at.density, at.pressure);
    [at.pressure * ratio.powf(gamma / (gamma - 1.0)), temperature * ratio]
}

/// d_i v_j from the gradients of density and momentum m: d_i v_j = (d_i m_j - v_j d_i rho) / rho.
fn velocity_gradient<const D: usize>(sample: &CellSample, p: usize) -> [[f64; D]; D] {
    let n = sample.points;
    let rho = sample.state[p];
    let slope = |i: usize, j: usize| {
        let v_j = sample.state[(1 + j) * n + p] / rho;
        (sample.gradients[i][(1 + j) * n + p] - v_j * sample.gradients[i][p]) / rho
    };
    std::array::from_fn(|i| std::array::from_fn(|j| slope(i, j)))
}

/// curl v from `g` = d_i v_j.
fn vorticity<const D: usize>(g: &[[f64; D]; D], out: &mut Vec<f64>) {
    match D {
        2 => out.push(g[0][1] - g[1][0]),
        _ => out.extend((0..3).map(|k| g[(k + 1) % 3][(k + 2) % 3] - g[(k + 2) % 3][(k + 1) % 3])),
    }
}

/// Q = (|W|^2 - |S|^2) / 2 = -d_i v_j d_j v_i / 2, with S and W the symmetric and the antisymmetric part of grad v.
fn q_criterion<const D: usize>(g: &[[f64; D]; D]) -> f64 {
    -0.5 * (0..D * D).map(|k| g[k / D][k % D] * g[k % D][k / D]).sum::<f64>()
}

/// The values of `formulas` at the points of a cell at the positions `x`, `[component][point]`, and time `t`: `[formula][point]`. NaN without
/// a `medium`.
pub fn of_formulas<const D: usize, const M: usize>(
    formulas: &[FieldFormula],
    medium: Option<&Medium>,
    sample: &CellSample,
    x: &[f64],
    t: f64,
) -> Vec<Vec<f64>> {
    let n = sample.points;
    let Some(medium) = medium.filter(|_| !formulas.is_empty()) else { return vec![vec![f64::NAN; n]; formulas.len()] };
    let fields: Vec<Vec<f64>> =
        Field::OF_FLOW.iter().flat_map(|field| components::<D, M>(*field, medium, sample)).collect();
    let variables =
        |p: usize| -> Vec<f64> { (0..D).map(|i| x[i * n + p]).chain(fields.iter().map(|values| values[p])).collect() };
    let variables: Vec<Vec<f64>> = (0..n).map(variables).collect();
    formulas.iter().map(|formula| variables.iter().map(|at| formula.program.evaluate(at, t)).collect()).collect()
}

/// The values of `field` in a flow, `[component][point]`, with the components of [`Field::components`].
pub fn components<const D: usize, const M: usize>(field: Field, medium: &Medium, sample: &CellSample) -> Vec<Vec<f64>> {
    let mut values = Vec::new();
    self::values::<D, M>(field, Some(medium), sample, &mut values);
    let stride = values.len() / sample.points;
    let component = |c: usize| values.iter().skip(c).step_by(stride).copied().collect();
    (0..field.components(D).len()).map(component).collect()
}

/// A sampler of equidistant points, as many per direction as the higher order has nodes.
pub fn equidistant<const D: usize>(flow_order: usize, mesh_order: usize) -> (Sampler<D>, usize) {
    let n = flow_order.max(mesh_order);
    (Sampler::new(flow_order, mesh_order, &basis::equidistant_points(n)), n)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Q of a flow of density 1 with velocity gradient `g` = d_i v_j, at one point.
    fn q_of<const D: usize, const M: usize>(g: [[f64; D]; D]) -> f64 {
        let state: Vec<f64> = (0..M).map(|m| if m == 0 { 1.0 } else { 0.5 * m as f64 }).collect();
        let component = |i: usize, m: usize| if (1..=D).contains(&m) { g[i][m - 1] } else { 0.0 };
        let gradients: Vec<Vec<f64>> = (0..D).map(|i| (0..M).map(|m| component(i, m)).collect()).collect();
        let sample = CellSample { state: &state, gradients: &gradients, ..CellSample::of_points(1) };
        let gas = Gas::new(1.4, 1.0, 1.0, navier_stokes::Viscosity::Inviscid).ok();
        let mut q = Vec::new();
        values::<D, M>(Field::QCriterion, gas.map(Medium::gas).as_ref(), &sample, &mut q);
        q[0]
    }

    /// Solid-body rotation has Q = omega^2, shear 0, pure strain with rate a along two axes -a^2.
    #[test]
    fn q_is_the_square_of_a_rotation_and_zero_in_shear() {
        let omega = 3.0;
        assert_eq!(q_of::<2, 4>([[0.0, omega], [-omega, 0.0]]), omega * omega);
        assert_eq!(q_of::<3, 5>([[0.0, 0.0, 0.0], [0.0, 0.0, omega], [0.0, -omega, 0.0]]), omega * omega);
        assert_eq!(q_of::<2, 4>([[0.0, 0.0], [7.0, 0.0]]), 0.0);
        assert_eq!(q_of::<3, 5>([[0.0, 0.0, 2.0], [0.0, 0.0, 5.0], [0.0, 0.0, 0.0]]), 0.0);
        assert_eq!(q_of::<2, 4>([[2.0, 0.0], [0.0, -2.0]]), -4.0);
    }
}
