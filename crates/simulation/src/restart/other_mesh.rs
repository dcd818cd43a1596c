//! The flow of a run on another mesh, at the nodes of this one.
//!
//! ```text
//! u_i = u'(x_i),   u' the polynomials there, x_i the nodes of the flow here                                             (interpolated)
//! ```
//!
//! Where the other mesh does not reach, u' is taken at its nearest place; where u' is no gas, the mean of its cell. Mass,
//! momentum and energy change by the error of interpolation.

use super::{Loaded, Origin, RestartError};
use crate::averages::is_of_averages;
use crate::cell_finder::{CellFinder, Place};
use crate::stored_field::StoredField;
use case::{AllowedChange, Case};
use coupled::{MeshMover, State};
use fem::{Orders, Sampler};
use mesh::Mesh;
use navier_stokes::Primitive;
use newton_krylov::inner_product::largest;
use output::{Arrays, RestMesh};
use std::array::from_fn;

/// What differs if the mesh does.
const MESH: &str = "the mesh";
const NODES: &str = "nodes of the mesh at rest";

/// The remedy then.
const ALLOW_MESH: &str = "; `restart.allow = [\"mesh\"]` interpolates the flow";

/// Nodes outside the other mesh are on its boundary if they are nearer to it than this part of its cell there.
const TOUCHING: f64 = 0.01;

/// A mesh that is smaller than this part of the other one along all axes is perhaps in another unit.
const SMALL_PART: f64 = 0.05;

impl Origin {
    /// The mesh at rest must be the same, up to round-off, unless the case allows another one. Returns whether it is another one.
    pub(super) fn check_mesh<const D: usize>(&self, case: &Case<D>) -> Result<bool, RestartError> {
        match self.require_mesh(case) {
            Err(RestartError::Differs { quantity: MESH | NODES, .. })
                if case.allows(AllowedChange::Mesh) && self.result.layout.grid.dimension == D =>
            {
                Ok(true)
            }
            other => other.map(|()| false),
        }
    }

    fn require_mesh<const D: usize>(&self, case: &Case<D>) -> Result<(), RestartError> {
        let (there, grid, here) = (&self.result.metadata.mesh, &self.result.layout.grid, &case.mesh);
        let size = |dimension: usize, cells: usize, numbers: usize| {
            format!("{cells} cells in {dimension} dimensions, {} nodes each", numbers / (dimension * cells).max(1))
        };
        let of_there = size(grid.dimension, self.cells_of_flow(), there.position.len());
        let of_here = size(D, here.n_cells(), here.coordinates().len());
        if grid.dimension != D {
            return Err(self.differs(MESH, of_there, of_here));
        }
        let (names, names_here) = (there.boundary_names.join(", "), here.boundary_names().join(", "));
        if names != names_here {
            return Err(self.differs("the boundaries", names, names_here));
        }
        let can_be_allowed = !self.has_structure(case) && !case.allows(AllowedChange::Mesh);
        let remedy = if can_be_allowed { ALLOW_MESH } else { "" };
        if of_there != of_here {
            return Err(self.differs(MESH, of_there, of_here + remedy));
        }
        let apart = largest_distance(there, here);
        if apart > 1e-12 * here.diameter() {
            return Err(self.differs(NODES, "elsewhere", format!("up to {apart:e} apart{remedy}")));
        }
        Ok(())
    }

    /// The cells of the flow in the file.
    pub(super) fn cells_of_flow(&self) -> usize {
        self.result.layout.grid.cells.saturating_sub(self.cells_of_structure())
    }

    /// The cells of a structure beside the flow in the file.
    fn cells_of_structure(&self) -> usize {
        let array = self.result.layout.exact.iter().find(|array| array.name == "structure_position");
        array.and_then(|array| array.axes.first()).map_or(0, |axis| axis.length)
    }

    /// The state of the run on the mesh of `case`: in its own orders, or interpolated in the orders `to`. With a warning about the latter.
    pub(super) fn on_mesh_here<const D: usize, const M: usize>(
        &self,
        case: &Case<D>,
        mover: &MeshMover<D>,
        to: Orders,
        is_other_mesh: bool,
    ) -> Result<(Loaded, Option<String>), RestartError> {
        let loaded = self.loaded::<D, M>(case)?;
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
        let (points, nodes) = (nodes_of_flow(&case.mesh, to), to.flow.pow(D as u32));
        let finder = CellFinder::<D>::new(&positions);
        let places = finder.places(&points, nodes);
        let mut values = flow.at_places(&places);
        let means = keep_admissible::<D, M>(case, &flow, &places, &mut values);
        let warning = self.judge(case, &Outside::of(&finder, &places), [points.len(), means])?;
        let of_cell = |cell: &[f64]| (0..M * nodes).map(|i| cell[i % nodes * M + i / nodes]).collect::<Vec<_>>();
        let u = values.chunks_exact(M * nodes).flat_map(of_cell).collect();
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
        let (there, here) = (self.extents::<D>(), extents(&by_axis::<D>(case.mesh.coordinates())));
        if 2 * points > nodes {
            let problem = format!("{}: {points} of {nodes} nodes lie outside; compare places and units", told(&here));
            return Err(self.differs("the extent of the mesh", told(&there), problem));
        }
        let path = self.path.display();
        let is_part = (0..D).all(|i| here[i][1] - here[i][0] < SMALL_PART * (there[i][1] - there[i][0]));
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

    /// The range of the positions along each axis.
    fn extents<const D: usize>(&self) -> [[f64; 2]; D] {
        let mesh = &self.result.metadata.mesh;
        let nodes = mesh.position.len() / (D * self.cells_of_flow()).max(1);
        extents(&from_fn(|i| mesh.position.chunks_exact(nodes).skip(i).step_by(D).flatten().copied().collect()))
    }

    /// Neither mesh may have moved, and there may be no structure.
    fn require_rest<const D: usize>(&self, case: &Case<D>, state: &State) -> Result<(), RestartError> {
        if self.has_structure(case) {
            return Err(self.differs(MESH, "another one", "one beside a structure, which cannot be interpolated"));
        }
        let way = largest(state.d.iter().map(|d| d.abs()));
        if way > 1e-12 * case.mesh.diameter() {
            let there = format!("moved by up to {way:.1e} at t = {}", coupled::rounded_time(state.time));
            return Err(self.differs(MESH, there, "another one, which takes over a flow on a mesh at rest only"));
        }
        Ok(())
    }

    fn has_structure<const D: usize>(&self, case: &Case<D>) -> bool {
        case.structure.is_some() || self.cells_of_structure() > 0
    }
}

/// Drops averages and the quality of the mesh, which refer to cells of the other mesh, from the `sums` of a checkpoint.
pub(super) fn forget_cells(sums: &mut Arrays) {
    sums.retain(|name, _| !is_of_averages(name));
    for name in ["quality", "first_invalid", "first_invalid_sampled"] {
        sums.insert(format!("statistics.{name}"), Vec::new().into());
    }
}

/// A warning if averages that had begun before the `time` begin anew.
pub(super) fn late_averages<const D: usize>(case: &Case<D>, time: f64) -> Option<String> {
    let averages = case.averages.as_ref().filter(|averages| averages.from < time)?;
    let (from, time) = (averages.from, coupled::rounded_time(time));
    Some(format!("the averages begin anew on another mesh, at t = {time} and not at {from} (`output.averages.from`)"))
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

/// Positions, `[node][component]`, as those along each axis.
fn by_axis<const D: usize>(positions: &[f64]) -> [Vec<f64>; D] {
    from_fn(|i| positions.iter().skip(i).step_by(D).copied().collect())
}

/// The range along each axis.
fn extents<const D: usize>(positions: &[Vec<f64>; D]) -> [[f64; 2]; D] {
    from_fn(|i| {
        positions[i].iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], &x| [low.min(x), high.max(x)])
    })
}

/// Ranges in words.
fn told<const D: usize>(extents: &[[f64; 2]; D]) -> String {
    let short = |x: f64| format!("{x:.4e}").parse().unwrap_or(x);
    let along = |(axis, [low, high]): (&str, &[f64; 2])| format!("{axis} from {} to {}", short(*low), short(*high));
    ["x", "y", "z"].into_iter().zip(extents).map(along).collect::<Vec<_>>().join(", ")
}

/// The positions at rest of the nodes of the flow, `[cell][node]`.
fn nodes_of_flow<const D: usize>(mesh: &Mesh<D>, orders: Orders) -> Vec<[f64; D]> {
    let sampler = Sampler::<D>::new(orders.flow, mesh.order(), &basis::gauss_lobatto(orders.flow).points);
    let in_cell = |cell: usize| {
        let nodes = mesh.cell_coordinates(cell);
        let nodal: Vec<f64> = (0..D).flat_map(|i| nodes.iter().skip(i).step_by(D).copied()).collect();
        let x = sampler.positions(&nodal);
        let count = x.len() / D;
        (0..count).map(|p| from_fn(|i| x[i * count + p])).collect::<Vec<[f64; D]>>()
    };
    (0..mesh.n_cells()).flat_map(in_cell).collect()
}

/// The largest distance of a coordinate in two meshes of the same size.
fn largest_distance<const D: usize>(there: &RestMesh, here: &Mesh<D>) -> f64 {
    let nodes = here.nodes_per_cell();
    let cells = there.position.chunks_exact(D * nodes).zip(here.coordinates().chunks_exact(D * nodes));
    // `[component][node]` in the file, `[node][component]` in the case.
    let in_cell = |(there, here): (&[f64], &[f64])| -> f64 {
        (0..D * nodes).map(|i| (there[i % D * nodes + i / D] - here[i]).abs()).fold(0.0, f64::max)
    };
    cells.map(in_cell).fold(0.0, f64::max)
}
