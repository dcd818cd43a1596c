//! What a viewer shows of a step: points and fields in every cell.

use super::layout::{drawn_fields, drawn_specs, flow_layout};
use super::mesh_view::MeshView;
use super::{Recorder, Snapshot, top};
use elasticity::{Solid, Stress};
use report::fields::{self, CellSample, Medium};

/// A mesh that moves.
#[derive(Clone, Copy)]
struct Moving<'a, const D: usize> {
    mesh: &'a MeshView<D>,
    /// det J at rest, cell by cell.
    determinants: &'a [Vec<f64>],
    displacement: &'a [f64],
    velocity: &'a [f64],
    /// What fills it, if that is no gas.
    solid: Option<&'a Solid<D>>,
    time: f64,
}

/// What a viewer shows.
struct Drawn {
    /// `[cell][point][3]`
    points: Vec<f64>,
    /// For every field `[cell][point][component]`.
    fields: Vec<Vec<f64>>,
}

impl<'a, const D: usize, const M: usize> Recorder<'a, D, M> {
    fn fields(&self) -> impl Iterator<Item = case::Field> + use<'a, D, M> {
        drawn_fields(self.case)
    }

    /// Points `[cell][point][3]`, and for every field `[cell][point][component]`: cells of the flow, then those of a structure beside it.
    pub(super) fn draw(&self, snapshot: &Snapshot) -> (Vec<f64>, Vec<Vec<f64>>) {
        let mut drawn = Drawn { points: Vec::new(), fields: vec![Vec::new(); drawn_specs(self.case).count()] };
        let Snapshot { displacement, velocities, flow, .. } = *snapshot;
        let solid = self.solid.as_ref().filter(|_| self.case.flow.is_none());
        let (determinants, of_structure) = self.reference_determinants.split_at(self.mesh.cells.len());
        let velocity = top(velocities, displacement);
        let time = snapshot.time;
        let moving = Moving { mesh: &self.mesh, determinants, displacement, velocity, solid, time };
        (0..self.mesh.cells.len())
            .for_each(|cell| self.draw_cell(&moving, cell, self.top_state(cell, flow), &mut drawn));
        if let Some((mesh, structure)) = self.beside.as_ref().zip(snapshot.structure.as_ref()) {
            let (displacement, solid) = (&structure.displacement[..], self.solid.as_ref());
            let velocity = top(&structure.velocities, displacement);
            let moving = Moving { mesh, determinants: of_structure, displacement, velocity, solid, time };
            (0..mesh.cells.len()).for_each(|cell| self.draw_cell(&moving, cell, &[], &mut drawn));
        }
        (drawn.points, drawn.fields)
    }

    /// Adds a cell. A cell without a flow has no `coefficients`.
    fn draw_cell(&self, moving: &Moving<'_, D>, cell: usize, coefficients: &[f64], drawn: &mut Drawn) {
        let Moving { mesh, determinants, displacement, velocity, solid, time } = *moving;
        let (rest, nodal, n) = (&mesh.positions[cell], mesh.displaced(cell, displacement), self.sampler.points());
        let x = self.sampler.positions(&nodal);
        drawn
            .points
            .extend((0..n).flat_map(|p| std::array::from_fn::<f64, 3, _>(|d| if d < D { x[d * n + p] } else { 0.0 })));
        let jacobian = self.sampler.determinants(&nodal).into_iter().zip(&determinants[cell]);
        let jacobian: Vec<f64> = jacobian.map(|(j, j0)| j / j0).collect();
        let gradients = match coefficients.is_empty() {
            true => Vec::new(),
            false => self.sampler.gradients(coefficients, &nodal).to_vec(),
        };
        let moved = mesh.on_cell(cell, displacement);
        let sample = CellSample {
            points: n,
            state: &self.sampler.state(coefficients),
            mesh_velocity: &self.sampler.positions(&mesh.on_cell(cell, velocity)),
            jacobian: &jacobian,
            gradients: &gradients,
            displacement: &self.sampler.positions(&moved),
            stress: &solid.map_or(Vec::new(), |solid| self.stress(solid, rest, &moved)),
        };
        let medium = self.case.flow.as_ref().filter(|_| solid.is_none()).map(Medium::of);
        let mut columns = drawn.fields.iter_mut();
        for (field, out) in self.fields().zip(&mut columns) {
            fields::values::<D, M>(field, medium.as_ref(), &sample, out);
        }
        let formulas = &self.case.observed.formulas;
        let of_formulas = fields::of_formulas::<D, M>(formulas, medium.as_ref(), &sample, &x, time);
        of_formulas.into_iter().zip(columns).for_each(|(values, out)| out.extend(values));
    }

    /// The stress at the points of a cell at `rest` that is displaced by `moved`, both `[component][node]`.
    fn stress(&self, solid: &Solid<D>, rest: &[f64], moved: &[f64]) -> Vec<Stress> {
        let (x, n) = (self.mesh_sampler.positions(rest), self.mesh_sampler.points());
        let gradients = self.mesh_sampler.gradients(moved, rest);
        let at = |p: usize| {
            let gradient = std::array::from_fn(|i| std::array::from_fn(|j| gradients[j][i * n + p]));
            // The case has been checked at the nodes; a point between them may have no material.
            solid.stress(&std::array::from_fn(|d| x[d * n + p]), &gradient).unwrap_or([[f64::NAN; 3]; 3])
        };
        (0..n).map(at).collect()
    }

    /// The flow of a cell at the last time node.
    fn top_state<'b>(&self, cell: usize, flow: &'b [f64]) -> &'b [f64] {
        if flow.is_empty() {
            return flow;
        }
        let layout = flow_layout::<D, M>(self.case);
        &flow[layout.cell_at(cell, layout.time_order - 1)]
    }
}
