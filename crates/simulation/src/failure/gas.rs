//! Measurements of the gas at one time: low density, steep gradients, disagreement with the boundaries.

use super::data::{Extreme, Mismatch, Moment};
use super::grid::{Grid, difference};
use case::Flow;
use fem::BoundaryPoint;
use mesh::{BoundaryFacet, face_nodes, outward_area};
use navier_stokes::{Gas, Primitive};
use tensor::{dot, norm};

/// States `[point][component]` of a cell with its points at given positions.
type StateAt<'a, const D: usize, const M: usize> = dyn Fn(usize, &[[f64; D]]) -> Vec<[f64; M]> + 'a;

/// The gas at one time, on the mesh at that time.
pub struct Then<'a, const D: usize, const M: usize> {
    /// The time.
    pub time: f64,
    /// The displacement of the mesh, `[C0 node][component]`.
    pub displacement: &'a [f64],
    /// Its velocity.
    pub velocity: &'a [f64],
    /// The state at points of a cell.
    pub state: &'a StateAt<'a, D, M>,
}

impl<const D: usize, const M: usize> Then<'_, D, M> {
    /// The gas at the points of a cell.
    pub fn gas(&self, gas: &Gas, grid: &Grid<D>, cell: usize) -> Vec<Primitive<f64, D>> {
        let states = (self.state)(cell, &grid.positions(cell, self.displacement));
        states.iter().map(|u| Primitive::unpack(gas, u)).collect()
    }
}

/// The measurements.
pub struct Measured {
    /// For the diagnosis.
    pub moment: Moment,
    /// The gas in each cell.
    pub cells: Vec<CellGas>,
    /// The largest velocity at a wall that is caused by its motion, relative to the speed of sound.
    pub kick: f64,
}

/// The gas in a cell.
pub struct CellGas {
    /// The smallest density and pressure.
    lowest: [f64; 2],
    /// Means over the points.
    means: [f64; 2],
    /// The change of density, pressure and velocity within the cell.
    steepness: [Extreme; 3],
    /// The largest |w| + c.
    pub fastest: f64,
    /// The largest |w| / c.
    pub mach: f64,
    /// The largest rho |w| / mu: a Reynolds number per length.
    pub reynolds: f64,
}

/// Measures the gas of `flow` on a mesh with these boundaries.
pub fn measure<const D: usize, const M: usize>(
    flow: &Flow<D>,
    mesh: &mesh::Mesh<D>,
    grid: &Grid<D>,
    then: &Then<D, M>,
) -> Measured {
    let gas = &flow.law.gas;
    let cells: Vec<CellGas> = (0..grid.cells()).map(|cell| of_cell(gas, cell, &then.gas(gas, grid, cell))).collect();
    let beside = Beside { flow, names: mesh.boundary_names(), grid, then };
    let (mut mismatch, mut kick) = (None, 0.0_f64);
    for (found, part) in mesh.boundary_facets().iter().flat_map(|facet| beside.facet(facet)) {
        kick = kick.max(part);
        if mismatch.as_ref().is_none_or(|most: &Mismatch| found.size > most.size) {
            mismatch = Some(found);
        }
    }
    let steepest = cells.iter().flat_map(|cell| cell.steepness);
    let steepest = steepest.reduce(|a, b| if b.value > a.value { b } else { a }).expect("a mesh has cells");
    Measured { moment: Moment { lowest: lowest(&cells), steepest, mismatch }, cells, kick }
}

/// The largest disagreement of the gas with the condition on `boundary`; None if that has no facets.
pub fn mismatch_at<const D: usize, const M: usize>(
    flow: &Flow<D>,
    mesh: &mesh::Mesh<D>,
    (grid, then): (&Grid<D>, &Then<D, M>),
    boundary: usize,
) -> Option<Mismatch> {
    let beside = Beside { flow, names: mesh.boundary_names(), grid, then };
    let facets = mesh.boundary_facets().iter().filter(|facet| facet.boundary == boundary);
    let all = facets.flat_map(|facet| beside.facet(facet)).map(|(found, _)| found);
    all.reduce(|most, found| if found.size > most.size { found } else { most })
}

fn of_cell<const D: usize>(gas: &Gas, cell: usize, states: &[Primitive<f64, D>]) -> CellGas {
    let both = |state: &Primitive<f64, D>| [state.density, state.pressure];
    let low = |i: usize| states.iter().map(|state| both(state)[i]).fold(f64::INFINITY, f64::min);
    let mean = |i: usize| states.iter().map(|state| both(state)[i]).sum::<f64>() / states.len() as f64;
    let most = |value: &dyn Fn(&Primitive<f64, D>) -> f64| states.iter().map(value).fold(0.0, f64::max);
    let viscosity = |state: &Primitive<f64, D>| gas.dynamic_viscosity(gas.temperature(state.density, state.pressure));
    CellGas {
        lowest: [low(0), low(1)],
        means: [mean(0), mean(1)],
        steepness: steepness(gas, cell, states),
        fastest: most(&|state| norm(&state.velocity) + sound_speed(gas, state)),
        mach: most(&|state| {
            let mach = gas.mach(state);
            if mach.is_finite() { mach } else { 0.0 }
        }),
        reynolds: most(&|state| state.density * norm(&state.velocity) / viscosity(state)),
    }
}

/// The smallest density or pressure over its mean.
fn lowest(cells: &[CellGas]) -> Extreme {
    let of = |(i, quantity)| {
        let mean = cells.iter().map(|cell| cell.means[i]).sum::<f64>() / cells.len() as f64;
        cells.iter().enumerate().map(move |(cell, gas)| Extreme { quantity, value: gas.lowest[i] / mean, cell })
    };
    let both = [(0, "density"), (1, "pressure")].into_iter().flat_map(of);
    both.reduce(|a, b| if b.value < a.value { b } else { a }).expect("a mesh has cells")
}

/// The change of density, pressure and velocity within a cell.
fn steepness<const D: usize>(gas: &Gas, cell: usize, states: &[Primitive<f64, D>]) -> [Extreme; 3] {
    /// Values below this fraction of the largest value count as this fraction.
    const LEAST: f64 = 1e-3;
    let logarithm = |value: fn(&Primitive<f64, D>) -> f64| {
        let (low, high) = states.iter().map(value).fold((f64::INFINITY, 0.0_f64), |(a, b), v| (a.min(v), b.max(v)));
        if high > 0.0 { (high / low.max(LEAST * high)).ln() } else { 0.0 }
    };
    let sound = |state: &Primitive<f64, D>| sound_speed(gas, state);
    let fastest = states.iter().map(sound).fold(f64::MIN_POSITIVE, f64::max);
    let changes = |state: &Primitive<f64, D>| norm(&difference(&state.velocity, &states[0].velocity)) / fastest;
    let velocity = states.iter().map(changes).fold(0.0, f64::max);
    [
        Extreme { quantity: "density", value: logarithm(|state| state.density), cell },
        Extreme { quantity: "pressure", value: logarithm(|state| state.pressure), cell },
        Extreme { quantity: "velocity", value: velocity, cell },
    ]
}

/// c, or 0 for an inadmissible state.
fn sound_speed<const D: usize>(gas: &Gas, state: &Primitive<f64, D>) -> f64 {
    let c = gas.sound_speed(state.density, state.pressure);
    if c.is_finite() { c } else { 0.0 }
}

/// The gas beside boundaries.
struct Beside<'a, const D: usize, const M: usize> {
    flow: &'a Flow<D>,
    names: &'a [String],
    grid: &'a Grid<'a, D>,
    then: &'a Then<'a, D, M>,
}

impl<const D: usize, const M: usize> Beside<'_, D, M> {
    /// At every point of a facet: the largest difference, and the part of it that is caused by the motion of a wall.
    fn facet(&self, facet: &BoundaryFacet) -> Vec<(Mismatch, f64)> {
        let (cell, face, then) = (facet.side.cell, facet.side.face, self.then);
        let states = then.gas(&self.flow.law.gas, self.grid, cell);
        let x = self.grid.positions(cell, then.displacement);
        let v = self.grid.vectors(cell, then.velocity);
        let jacobians = self.grid.jacobians(cell, then.displacement);
        let boundary = &self.flow.boundary[facet.boundary];
        let point = |p: usize| {
            let area = outward_area(&jacobians[p], face);
            let n = area.map(|a| a / norm(&area));
            let inside: [f64; M] = states[p].pack(&self.flow.law.gas);
            let data = boundary.data.as_ref().map_or(inside, |data| data.at(&x[p], then.time));
            let target_state = |velocity: &[f64; D]| {
                let at = BoundaryPoint { normal: &n, velocity, data: &data };
                let target_state = boundary.condition.target_state(&self.flow.law, &inside, at);
                Primitive::unpack(&self.flow.law.gas, &target_state)
            };
            let (moving, still) = (target_state(&v[p]), target_state(&[0.0; D]));
            let mismatch = self.mismatch(facet.boundary, &n, &states[p], &moving);
            let c = sound_speed(&self.flow.law.gas, &states[p]).max(f64::MIN_POSITIVE);
            let away =
                |target_state: &Primitive<f64, D>| norm(&difference(&target_state.velocity, &states[p].velocity)) / c;
            (mismatch, away(&moving) - away(&still))
        };
        face_nodes(D, self.grid.points, face).into_iter().map(point).collect()
    }

    fn mismatch(
        &self,
        boundary: usize,
        n: &[f64; D],
        inside: &Primitive<f64, D>,
        target_state: &Primitive<f64, D>,
    ) -> Mismatch {
        let gas = &self.flow.law.gas;
        let temperature = |state: &Primitive<f64, D>| gas.temperature(state.density, state.pressure);
        let c = sound_speed(gas, inside).max(f64::MIN_POSITIVE);
        let ratio = |a: f64, b: f64| Some((a / b).ln().abs()).filter(|size| size.is_finite()).unwrap_or(0.0);
        let [t, t_asked] = [temperature(inside), temperature(target_state)];
        let prescribes_normal_velocity = self.flow.boundary[boundary].condition.is_slip();
        let velocity = match prescribes_normal_velocity {
            true => normal_velocity(n, inside, target_state, c),
            false => velocity_along(inside, target_state, c),
        };
        let (quantity, inside, target_state, size) = [
            velocity,
            ("pressure", inside.pressure, target_state.pressure, ratio(inside.pressure, target_state.pressure)),
            ("temperature", t, t_asked, ratio(t, t_asked)),
        ]
        .into_iter()
        .reduce(|a, b| if b.3 > a.3 { b } else { a })
        .expect("there are three");
        Mismatch { boundary: self.names[boundary].clone(), quantity, inside, target_state, size }
    }
}

/// A quantity, its value in the gas and by the condition, and the size of the difference.
type Compared = (&'static str, f64, f64, f64);

/// The velocity out of the domain, which is all that a slip wall or a plane of symmetry prescribes.
fn normal_velocity<const D: usize>(
    n: &[f64; D],
    inside: &Primitive<f64, D>,
    target_state: &Primitive<f64, D>,
    sound_speed: f64,
) -> Compared {
    let [inside, target_state] = [inside, target_state].map(|state| dot(&state.velocity, n));
    // The cancellation in w - (w_n - v_n) n leaves round-off of w.
    let target_state = if target_state.abs() < 1e-12 * sound_speed { 0.0 } else { target_state };
    ("normal velocity", inside, target_state, (inside - target_state).abs() / sound_speed)
}

/// The component of the velocity that differs most, and the size of the difference of all of them.
fn velocity_along<const D: usize>(
    inside: &Primitive<f64, D>,
    target_state: &Primitive<f64, D>,
    sound_speed: f64,
) -> Compared {
    let size = norm(&difference(&inside.velocity, &target_state.velocity)) / sound_speed;
    let gap = |axis: usize| (inside.velocity[axis] - target_state.velocity[axis]).abs();
    let axis = (0..D).fold(0, |most, axis| if gap(axis) > gap(most) { axis } else { most });
    let name = ["velocity along x", "velocity along y", "velocity along z"][axis];
    (name, inside.velocity[axis], target_state.velocity[axis], size)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A stream along x of speed 1 meets a slip wall whose normal is `n`. The report once said that the wall asks for a velocity along x.
    #[test]
    fn a_slip_wall_asks_for_a_normal_velocity_alone() {
        let stream = Primitive { density: 1.0, velocity: [1.0, 0.0], pressure: 1.0 };
        let at = |n: [f64; 2]| {
            let along = dot(&stream.velocity, &n);
            let target_state = Primitive { velocity: [0, 1].map(|i| stream.velocity[i] - along * n[i]), ..stream };
            normal_velocity(&n, &stream, &target_state, 2.0)
        };
        assert_eq!(at([-1.0, 0.0]), ("normal velocity", -1.0, 0.0, 0.5));
        assert_eq!(at([-0.6, 0.8]), ("normal velocity", -0.6, 0.0, 0.3));
        assert_eq!(at([0.0, 1.0]), ("normal velocity", 0.0, 0.0, 0.0));
    }
}
