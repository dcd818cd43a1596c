//! The flow of a run on another mesh, at the nodes of this one.
//!
//! ```text
//! u_i = u'(x_i),   u' the polynomials there, x_i the nodes of the flow here                                             (interpolated)
//! ```
//!
//! Where the other mesh does not reach, u' is taken at its nearest place; where u' is no gas, the mean of its cell. Mass,
//! momentum and energy change by the error of interpolation.

use super::loaded::Loaded;
use super::{Origin, RestartError};
use crate::averages::is_of_averages;
use crate::cell_finder::{CellFinder, Place};
use crate::nodal::by_component;
use crate::stored_field::StoredField;
use case::Case;
use coupled::{MeshMover, State};
use fem::Orders;
use mesh::bounding_box;
use navier_stokes::Primitive;
use newton_krylov::inner_product::largest;
use output::Arrays;
use tensor::AXES;

/// Nodes outside the other mesh are on its boundary if they are nearer to it than this part of its cell there.
const TOUCHING: f64 = 0.01;

/// A mesh that is smaller than this part of the other one along all axes is perhaps in another unit.
const SMALL_PART: f64 = 0.05;

impl Origin {
    /// The `loaded` state on the mesh of `case`: in its own orders, or interpolated in the orders `to`. With a warning about the latter.
    pub(super) fn on_mesh_here<const D: usize, const M: usize>(
        &self,
        case: &Case<D>,
        mover: &MeshMover<D>,
        loaded: Loaded,
        to: Orders,
        is_other_mesh: bool,
    ) -> Result<(Loaded, Option<String>), RestartError> {
        if is_other_mesh {
            let (state, warning) = self.interpolated::<D, M>(case, mover, &loaded, to)?;
            return Ok((Loaded { state, frozen: None, stale: false, orders: to }, warning));
        }
        match loaded.state.d.len() == mover.field_len() {
            true => Ok((loaded, None)),
            false => Err(self.incomplete()),
        }
    }

    /// (interpolated), in the orders `to`; and a warning if the other mesh does not reach all nodes.
    fn interpolated<const D: usize, const M: usize>(
        &self,
        case: &Case<D>,
        mover: &MeshMover<D>,
        loaded: &Loaded,
        to: Orders,
    ) -> Result<(State, Option<String>), RestartError> {
        let state = &loaded.state;
        self.require_rest(case, state)?;
        let (cells, position) = (self.cells_of_flow(), self.result.metadata.mesh.position.clone());
        let fields = (StoredField::new(D, position, cells), StoredField::new(M, state.u.clone(), cells));
        let (Some(positions), Some(flow)) = fields else { return Err(self.incomplete()) };
        let (mesh, nodes) = (case.mesh.with_order(to.flow), to.flow.pow(D as u32));
        let (points, _) = mesh.coordinates().as_chunks::<D>();
        let finder = CellFinder::<D>::new(&positions);
        let places = finder.places(points, nodes);
        let mut values = flow.at_places(&places);
        let means = keep_admissible::<D, M>(case, &flow, &places, &mut values);
        let warning = self.judge(case, &Outside::of(&finder, &places), [points.len(), means])?;
        let u = values.chunks_exact(M * nodes).flat_map(by_component::<M>).collect();
        let (slab, nominal, bodies, step) = (state.slab, state.nominal, state.bodies.clone(), state.step);
        let there = State::new(state.time, u, vec![0.0; mover.field_len()]);
        Ok((State { slab, nominal, bodies, step, ..there }, warning))
    }

    /// An error if most nodes are `outside`: a mesh in another unit or place. A warning if some are, or if some took `means`.
    fn judge<const D: usize>(
        &self,
        case: &Case<D>,
        outside: &Outside,
        [nodes, means]: [usize; 2],
    ) -> Result<Option<String>, RestartError> {
        let Outside { points, distance, relative } = *outside;
        let [there, here] = [&self.positions::<D>()[..], case.mesh.coordinates()].map(bounding_box::<D>);
        if 2 * points > nodes {
            let problem = format!("{}: {points} of {nodes} nodes lie outside; compare places and units", told(&here));
            return Err(self.differs("the extent of the mesh", told(&there), problem));
        }
        let path = self.path.display();
        let length = |(lower, upper): &([f64; D], [f64; D]), i: usize| upper[i] - lower[i];
        let is_part = (0..D).all(|i| length(&here, i) < SMALL_PART * length(&there, i));
        let told = [
            (relative > TOUCHING).then(|| {
                format!(
                    "{points} of {nodes} nodes lie outside of the mesh of `{path}`, up to {distance:.1e}: there the flow is that of its nearest place"
                )
            }),
            (means > 0).then(|| {
                format!(
                    "between the nodes of `{path}` density or pressure are negative: {means} of {nodes} nodes begin with the mean of a cell there"
                )
            }),
            is_part.then(|| format!("this mesh is a small part of that of `{path}`, {}: compare units", told(&there))),
        ];
        let told: Vec<String> = told.into_iter().flatten().collect();
        Ok((!told.is_empty()).then(|| told.join("; ")))
    }

    /// Neither mesh may have moved.
    fn require_rest<const D: usize>(&self, case: &Case<D>, state: &State) -> Result<(), RestartError> {
        let way = largest(state.d.iter().map(|d| d.abs()));
        if way > 1e-12 * case.mesh.diameter() {
            let there = format!("moved by up to {way:.1e} at t = {}", coupled::rounded_time(state.time));
            return Err(self.differs("the mesh", there, "another one, which takes over a flow on a mesh at rest only"));
        }
        Ok(())
    }
}

/// Drops averages and the quality of the mesh, which refer to cells of the other mesh, from the `sums` of a checkpoint.
pub(super) fn forget_cells(sums: &mut Arrays) {
    forget_averages(sums);
    for name in ["quality", "first_invalid", "first_invalid_sampled"] {
        sums.insert(format!("statistics.{name}"), Vec::new().into());
    }
}

/// Drops averages from the `sums` of a checkpoint.
pub(super) fn forget_averages(sums: &mut Arrays) {
    sums.retain(|name, _| !is_of_averages(name));
}

/// Replaces `values`, `[place][component]`, that are no gas by the means of the cells of their `places`. Returns their number.
fn keep_admissible<const D: usize, const M: usize>(
    case: &Case<D>,
    flow: &StoredField<D>,
    places: &[Place<D>],
    values: &mut [f64],
) -> usize {
    let Some(gas) = case.flow.as_ref().map(|flow| &flow.law.gas) else { return 0 };
    let is_gas = |u: &[f64; M]| {
        let Primitive { density, pressure, .. } = Primitive::<f64, D>::unpack(gas, u);
        density > 0.0 && pressure > 0.0
    };
    let (values, _) = values.as_chunks_mut::<M>();
    let bad = values.iter_mut().zip(places).filter(|(u, _)| !is_gas(u));
    bad.map(|(u, place)| u.copy_from_slice(&flow.means(place.cell))).count()
}

/// Nodes outside of all cells of another mesh.
struct Outside {
    points: usize,
    /// Their largest distance from the nearest cell.
    distance: f64,
    /// The same relative to the size of that cell.
    relative: f64,
}

impl Outside {
    fn of<const D: usize>(finder: &CellFinder<D>, places: &[Place<D>]) -> Self {
        let none = Outside { points: 0, distance: 0.0, relative: 0.0 };
        places.iter().filter(|place| place.distance > 0.0).fold(none, |all, place| Outside {
            points: all.points + 1,
            distance: all.distance.max(place.distance),
            relative: all.relative.max(place.distance / finder.size(place.cell)),
        })
    }
}

/// A box in words.
fn told<const D: usize>((lower, upper): &([f64; D], [f64; D])) -> String {
    let short = |x: f64| format!("{x:.4e}").parse().unwrap_or(x);
    let along = |i: usize| format!("{} from {} to {}", AXES[i], short(lower[i]), short(upper[i]));
    (0..D).map(along).collect::<Vec<_>>().join(", ")
}
