//! What a viewer shows of a step: points and fields in every cell.

use super::layout::{drawn_fields, flow_layout};
use super::mesh_view::MeshView;
use super::step_parts::{Named, StepParts};
use super::{Snapshot, StructureSnapshot, top};
use elasticity::{Solid, Stress};
use report::fields::{self, CellSample, Medium};
use std::ops::Range;

/// A mesh that moves.
#[derive(Clone, Copy)]
struct Moving<'a, const D: usize> {
    mesh: &'a MeshView<D>,
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
    fields: Named,
}

impl<'a, const D: usize, const M: usize> StepParts<'a, D, M> {
    fn fields(&self) -> impl Iterator<Item = case::Field> + use<'a, D, M> {
        drawn_fields(self.case)
    }

    /// Nothing yet.
    fn blank(&self) -> Drawn {
        Drawn { points: Vec::new(), fields: self.names().map(|name| (name, Vec::new())).collect() }
    }

    /// Points `[cell][point][3]`, and for every field `[cell][point][component]`: some `cells` of the mesh with their `flow`.
    pub(super) fn draw(&self, snapshot: &Snapshot, cells: Range<usize>, flow: &[f64]) -> (Vec<f64>, Named) {
        let Snapshot { time, displacement, velocities, .. } = *snapshot;
        let solid = self.solid.as_ref().filter(|_| self.case.flow.is_none());
        let velocity = top(velocities, displacement);
        let moving = Moving { mesh: &self.mesh, displacement, velocity, solid, time };
        let mut drawn = self.blank();
        for (place, cell) in cells.enumerate() {
            self.draw_cell(&moving, cell, self.top_state(place, flow), &mut drawn);
        }
        (drawn.points, drawn.fields)
    }

    /// The same of the structure beside the flow, on its `mesh`.
    pub(super) fn draw_structure(
        &self,
        mesh: &MeshView<D>,
        time: f64,
        structure: &StructureSnapshot,
    ) -> (Vec<f64>, Named) {
        let (displacement, solid) = (&structure.displacement[..], self.solid.as_ref());
        let velocity = top(&structure.velocities, displacement);
        let moving = Moving { mesh, displacement, velocity, solid, time };
        let mut drawn = self.blank();
        (0..mesh.cells.len()).for_each(|cell| self.draw_cell(&moving, cell, &[], &mut drawn));
        (drawn.points, drawn.fields)
    }

    /// Adds a cell. A cell without a flow has no `coefficients`.
    fn draw_cell(&self, moving: &Moving<'_, D>, cell: usize, coefficients: &[f64], drawn: &mut Drawn) {
        let Moving { mesh, displacement, velocity, solid, time } = *moving;
        let (rest, nodal, n) = (&mesh.positions[cell], mesh.displaced(cell, displacement), self.sampler.points());
        let x = self.sampler.positions(&nodal);
        drawn
            .points
            .extend((0..n).flat_map(|p| std::array::from_fn::<f64, 3, _>(|d| if d < D { x[d * n + p] } else { 0.0 })));
        let jacobian = self.sampler.determinants(&nodal).into_iter().zip(self.sampler.determinants(rest));
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
        let mut columns = drawn.fields.iter_mut().map(|(_, values)| values);
        for (field, out) in self.fields().zip(&mut columns) {
            fields::values::<D, M>(field, medium.as_ref(), &sample, out);
        }
        let formulas = &self.case.observed.formulas;
        let of_formulas = fields::of_formulas::<D, M>(formulas, medium.as_ref(), &sample, &x, time);
        of_formulas.into_iter().zip(columns).for_each(|(values, out)| out.extend(values));
    }

    /// The stress at the points of a cell at `rest` that is displaced by `moved`, both `[component][node]`. On faces where two materials meet it
    /// is that of the cell's own material.
    fn stress(&self, solid: &Solid<D>, rest: &[f64], moved: &[f64]) -> Vec<Stress> {
        let (x, n) = (self.material_sampler.positions(rest), self.mesh_sampler.points());
        let gradients = self.mesh_sampler.gradients(moved, rest);
        let at = |p: usize| {
            let gradient = std::array::from_fn(|i| std::array::from_fn(|j| gradients[j][i * n + p]));
            // The case has been checked at the nodes; a point between them may have no material.
            solid.stress(&std::array::from_fn(|d| x[d * n + p]), &gradient).unwrap_or([[f64::NAN; 3]; 3])
        };
        (0..n).map(at).collect()
    }

    /// The flow at the last time node in the cell with this `place` in `flow`.
    fn top_state<'b>(&self, place: usize, flow: &'b [f64]) -> &'b [f64] {
        if flow.is_empty() {
            return flow;
        }
        let layout = flow_layout::<D, M>(self.case);
        &flow[layout.cell_at(place, layout.time_order - 1)]
    }
}
