//! A run that starts from the result of another one.

mod carried;
mod changes;
mod drives;
mod error;
mod loaded;
mod mesh_difference;
mod other_mesh;
mod start_warnings;
mod supports;

pub use error::RestartError;

use super::averages;
use super::statistics::RunStatistics;
use super::{bodies, checkpoint, motion_jump, surfaces};
use crate::crew::OfCells;
use crate::error::Failure;
use case::{AllowedChange, Case, Differences, Flow, Time, bodies_of, differences, motion_of, reference_of};
use changes::Changes;
use coupled::block::BodyState;
use coupled::{MeshMotion, MeshMover, State, rounded_time};
use fem::{Layout, Orders};
use loaded::Loaded;
use mesh::NodeNumbering;
use navier_stokes::Conserved;
use other_mesh::{forget_averages, forget_cells};
use output::{Arrays, Checkpoint, RESULT_FILE, ResultReader, Series};
use std::path::PathBuf;
use std::sync::Arc;

/// The tables of a case on which its steady flow depends.
const STEADY_PROBLEM: [&str; 8] =
    ["constants", "tables", "controls", "flow", "motion", "bodies", "structure", "solver.steady"];

/// The start of a run that continues another one.
#[derive(Debug)]
pub struct Start {
    /// The state, in the orders of the new run.
    pub checkpoint: Checkpoint,
    /// Warnings about it.
    pub warnings: Vec<String>,
    /// The distributions along walls of the earlier run.
    pub surfaces: Vec<Series>,
    /// The walls with distributions of which the earlier run kept none.
    pub added_walls: Vec<String>,
    /// Whether the distributions along walls begin anew: at other points, on another mesh or with other orders in space or another quadrature, or
    /// of another gas.
    pub begins_surfaces: bool,
    /// Whether the earlier run has only searched a steady flow, and this one searches another.
    pub searches_anew: bool,
    /// Whether the energies of flow and bodies are measured in another way than when the balances of the earlier run began.
    pub is_measured_anew: bool,
}

/// Checks whether `case` can start from the result that it names, if it names one. Returns warnings.
///
/// # Errors
/// As `read`.
pub fn check<const D: usize, const M: usize>(case: &Case<D>, flow: &Flow<D>) -> Result<Vec<String>, Failure> {
    if case.restart.is_none() {
        return Ok(Vec::new());
    }
    // Prescribed motions follow from the case, so nothing needs to be factored.
    let numbering = NodeNumbering::new(&case.mesh, case.mesh.order());
    let mover = MeshMover::new(MeshMotion::Still, case.mesh.clone(), numbering, case.time.order);
    let start = read::<D, M>(case, flow, &mover)?;
    Ok(start.map_or_else(Vec::new, |start| start.warnings))
}

/// The state from which `case` starts on the mesh of `mover`, if it names a result: in the orders of the case, with the sums and the
/// history of the earlier run.
///
/// # Errors
/// [`RestartError`], or a result file that cannot be read.
pub fn read<const D: usize, const M: usize>(
    case: &Case<D>,
    flow: &Flow<D>,
    mover: &MeshMover<D>,
) -> Result<Option<Start>, Failure> {
    let Some(from) = &case.restart else { return Ok(None) };
    let path = if from.is_dir() { from.join(RESULT_FILE) } else { from.clone() };
    if !path.exists() {
        return Err(Failure::bad_input(RestartError::Missing { path }));
    }
    let result = ResultReader::open(&path)?;
    let stored = result.checkpoint(&OfCells::names())?;
    let origin = Origin { path, result, stored };
    let start = origin.continued::<D, M>(case, flow, mover).map_err(Failure::bad_input)?;
    // A run that searches the steady flow anew has none of its distributions.
    let names = if start.searches_anew || start.begins_surfaces { Vec::new() } else { origin.result.series_names()? };
    let surfaces: Result<Vec<_>, _> = names.iter().map(|name| origin.result.series(name)).collect();
    Ok(Some(Start { surfaces: surfaces?.into_iter().flatten().collect(), ..start }))
}

/// The run that is continued.
struct Origin {
    path: PathBuf,
    result: ResultReader,
    /// Its checkpoint; numbers of cells stay in the file.
    stored: Checkpoint,
}

/// Rounding in the digits of a case file changes a temperature by less than this part.
const SAME_TEMPERATURE: f64 = 1e-6;

impl Origin {
    /// Its state, as a state of `case`.
    fn continued<const D: usize, const M: usize>(
        &self,
        case: &Case<D>,
        flow: &Flow<D>,
        mover: &MeshMover<D>,
    ) -> Result<Start, RestartError> {
        let changes = self.changes(case)?;
        self.check_bodies(case)?;
        let mut sums = self.kept_sums(case, flow, &changes)?;
        let to = Orders { flow: flow.order, mesh: case.mesh.order(), time: case.time.order };
        let keeps_cells = !changes.mesh && !changes.pressure && self.orders(case) == to;
        let loaded = self.loaded::<D, M>(case, keeps_cells)?;
        let (loaded, unreached) = self.on_mesh_here::<D, M>(case, mover, loaded, to, changes.mesh)?;
        let Loaded { mut state, frozen, stale, orders: from } = loaded;
        let mut warnings = self.join(case, mover, &mut state)?;
        warnings.extend(unreached);
        let searches_anew = self.searches_anew(case, &state, &changes)?;
        warnings.extend(self.start_warnings(case, &state, &sums, searches_anew)?);
        let changed = changes.of_distributions(from, to);
        let (added_walls, late) = self.added_walls(case, state.time, changes.mesh, changed);
        warnings.extend(late);
        warnings.extend(averages::are_late(case, &sums, &state));
        if changes.pressure {
            warnings.extend(self.shift_pressure::<D, M>(flow, from.flow, &mut state)?);
        }
        if searches_anew {
            sums = RunStatistics::default().to_arrays();
        }
        let mut continued = match from == to {
            true => checkpoint::store(&state, frozen.as_ref(), stale || changes.gas && frozen.is_some()),
            false => checkpoint::store(&state.transfer(mover, M, from, to), None, false),
        };
        continued.arrays.extend(sums);
        let keeps_averages = !changes.mesh && !changes.gas && !searches_anew;
        let checkpoint = self.with_numbers_of_cells(continued, keeps_cells, keeps_averages);
        let (surfaces, begins_surfaces) = (Vec::new(), changes.mesh || changed.is_some());
        let is_measured_anew = changes.of_energies();
        Ok(Start { checkpoint, warnings, surfaces, added_walls, begins_surfaces, searches_anew, is_measured_anew })
    }

    /// The sums and the history of the run, without averages over cells that are others or of another gas.
    fn kept_sums<const D: usize>(
        &self,
        case: &Case<D>,
        flow: &Flow<D>,
        changes: &Changes,
    ) -> Result<Arrays, RestartError> {
        let mut sums = self.sums(case, flow)?;
        if changes.mesh {
            forget_cells(&mut sums);
        }
        if changes.gas {
            forget_averages(&mut sums);
        }
        Ok(sums)
    }

    /// Joins the `state` to the slabs and to the motion of `case`. Returns warnings about jumps of velocities.
    fn join<const D: usize>(
        &self,
        case: &Case<D>,
        mover: &MeshMover<D>,
        state: &mut State,
    ) -> Result<Vec<String>, RestartError> {
        self.join_schedule(state, &case.time)?;
        let warnings = self.check_motion(case, mover, state)?;
        state.boundary_jumps = self.jumps(case, mover, state);
        Ok(warnings)
    }

    /// Whether only the steady flow has been searched so far, and that of `case` is another.
    fn searches_anew<const D: usize>(
        &self,
        case: &Case<D>,
        state: &State,
        changes: &Changes,
    ) -> Result<bool, RestartError> {
        let is_other_problem = changes.mesh || changes.gas || self.is_other(case, &STEADY_PROBLEM)?;
        Ok(state.slab == 0 && case.solver.steady.is_some() && is_other_problem)
    }

    /// The walls whose distributions begin at the start of this run, at `time`, and a warning of that. `changed` is what the flow has of another
    /// kind.
    fn added_walls<const D: usize>(
        &self,
        case: &Case<D>,
        time: f64,
        is_other_mesh: bool,
        changed: Option<&str>,
    ) -> (Vec<String>, Option<String>) {
        if is_other_mesh {
            return (surfaces::listed(case), None);
        }
        if let Some(changed) = changed {
            return (surfaces::listed(case), surfaces::begun_anew(case, time, changed));
        }
        let added = surfaces::added(case, &self.result.metadata.case_text);
        let late = surfaces::late_means(case, &added, time);
        (added, late)
    }

    /// Whether one of these `tables` of the lasting part of `case` is another than in the run.
    fn is_other<const D: usize>(&self, case: &Case<D>, tables: &[&str]) -> Result<bool, RestartError> {
        let found = self.differences(case)?.lasting;
        Ok(found.iter().any(|difference| tables.iter().any(|table| is_in(&difference.key, table))))
    }

    /// What `of` tells of the case of the run and of this one, as texts.
    fn both<T, const D: usize>(
        &self,
        case: &Case<D>,
        of: impl Fn(&str) -> Result<T, String>,
    ) -> Result<[T; 2], RestartError> {
        let of = |text: &str| of(text).map_err(|reason| self.unreadable(reason));
        Ok([of(&self.result.metadata.case_text)?, of(&case.about.resolved)?])
    }

    /// What the cases of the run and of this one do not share.
    fn differences<const D: usize>(&self, case: &Case<D>) -> Result<Differences, RestartError> {
        differences(&self.result.metadata.case_text, &case.about.resolved).map_err(|reason| self.unreadable(reason))
    }

    fn incomplete(&self) -> RestartError {
        self.differs("the checkpoint", "incomplete", "that of a flow")
    }

    /// The bodies must be the same, with the same coordinates; structures must be as large.
    fn check_bodies<const D: usize>(&self, case: &Case<D>) -> Result<(), RestartError> {
        let [there, here] = self.both(case, bodies_of)?;
        if there != here {
            return Err(self.differs("the rigid bodies", there, here));
        }
        let stored = checkpoint::bodies(&self.stored.state.arrays, "body");
        let there: Vec<usize> = stored.iter().map(|body| BodyState::coordinates(body)).collect();
        let here = bodies::coordinates(case);
        if there == here {
            return Ok(());
        }
        // A structure comes after the rigid bodies.
        if let ([.., last], [.., own]) = (&there[..], &here[..])
            && self.has_structure(case)
            && there.len() == here.len()
        {
            let told = |coordinates: &usize| format!("{coordinates} displacements of its nodes");
            return Err(self.differs("the mesh of the structure", told(last), told(own)));
        }
        let told = |coordinates: &[usize]| match coordinates {
            [] => "no bodies".to_owned(),
            _ => format!("{coordinates:?}"),
        };
        Err(self.differs("coordinates of the bodies", told(&there), told(&here)))
    }

    /// Raises the pressure everywhere by the difference of the reference pressures: rho E = p / (gamma - 1) + ... Returns a warning if the
    /// reference states have different temperatures: the gas then changes its own at once.
    fn shift_pressure<const D: usize, const M: usize>(
        &self,
        flow: &Flow<D>,
        order: usize,
        state: &mut State,
    ) -> Result<Option<String>, RestartError> {
        let there = reference_of::<D>(&self.result.metadata.case_text);
        let [pressure, temperature] = there.map_err(|reason| self.unreadable(reason.to_string()))?;
        let shift = (flow.reference_pressure() - pressure) / (flow.law.gas.gamma() - 1.0);
        let shifts: [f64; M] = Conserved { density: 0.0, momentum: [0.0; D], energy: shift }.pack();
        let nodes = order.pow(D as u32);
        let layout = Layout { cells: state.u.len() / (M * nodes), time_order: 1, components: M, nodes };
        let past = state.past.iter_mut().flat_map(|past| Arc::make_mut(&mut past.u).iter_mut().enumerate());
        for (i, u) in state.u.iter_mut().enumerate().chain(past) {
            *u += shifts[layout.component_of(i)];
        }
        Ok(self.change_of_temperature(flow, temperature))
    }

    /// A warning if the reference temperature is not the one `there`.
    fn change_of_temperature<const D: usize>(&self, flow: &Flow<D>, there: f64) -> Option<String> {
        let (reference, gas) = (&flow.law.reference, &flow.law.gas);
        let here = reference.temperature(gas);
        let kept = reference.density() * gas.gas_constant() * there;
        ((here - there).abs() > SAME_TEMPERATURE * there).then(|| {
            format!(
                "the reference state has the temperature {here:.6}, and that of `{}` {there:.6}: with the gas constant of this case the temperature \
                 of all gas changes at once; `flow.reference.pressure` = {kept:.6} keeps it",
                self.path.display()
            )
        })
    }

    /// Checks that the motion of `case` continues the motion of the run: a jump of the position is refused. Returns warnings about jumps of
    /// velocities.
    fn check_motion<const D: usize>(
        &self,
        case: &Case<D>,
        mover: &MeshMover<D>,
        state: &State,
    ) -> Result<Vec<String>, RestartError> {
        if case.allows(AllowedChange::Motion) {
            return Ok(Vec::new());
        }
        if let Some(jump) = motion_jump::of_position(case, mover, state) {
            let [position, there, here] = [jump.position, jump.there, jump.here].map(|vector| vector.to_vec());
            let (path, distance) = (self.path.clone(), jump.size());
            let time = rounded_time(state.time);
            return Err(RestartError::MotionJumps { path, time, position, there, here, distance });
        }
        self.check_drives(case, state)?;
        let of_supports = self.check_supports(case, state)?;
        let of_bodies = self.jump_of_drives(case, state)?;
        Ok([self.jump_of_velocity(case, mover, state), of_bodies, of_supports].into_iter().flatten().collect())
    }

    /// A warning if the motion of the mesh changes its velocity at once.
    fn jump_of_velocity<const D: usize>(&self, case: &Case<D>, mover: &MeshMover<D>, state: &State) -> Option<String> {
        let path = self.path.display();
        let before = match motion_of(&self.result.metadata.case_text, case) {
            Ok(motion) => Case { motion, ..case.clone() },
            Err(reason) => {
                return Some(format!("the velocities of the motion in `{path}` cannot be compared: {reason}"));
            }
        };
        if before.motion == case.motion {
            return None;
        }
        let jump = motion_jump::of_velocity(&before, case, mover, state.time);
        jump.map(|motion_jump::Jump { position, there, here }| {
            format!(
                "the boundary changes its velocity at once at t = {}, which sends a pressure wave into the flow: the point at {position:?} \
                 moves with {there:.6?} in `{path}`, and with {here:.6?} from here on",
                rounded_time(state.time)
            )
        })
    }

    /// Whether the motion of `case`, which is allowed to jump, does so.
    fn jumps<const D: usize>(&self, case: &Case<D>, mover: &MeshMover<D>, state: &State) -> bool {
        case.allows(AllowedChange::Motion)
            && (motion_jump::of_position(case, mover, state).is_some() || self.check_drives(case, state).is_err())
    }

    fn unreadable(&self, reason: String) -> RestartError {
        RestartError::Unreadable { path: self.path.clone(), reason }
    }

    /// The run continues in the slabs of `time`; the next slab may have begun before.
    fn join_schedule(&self, state: &mut State, time: &Time) -> Result<(), RestartError> {
        let round_off = time.round_off();
        // A case without slabs asks for the steady flow alone.
        let latest = if time.slabs == 0 { time.end } else { time.end - round_off };
        if state.time < time.start - round_off || state.time > latest {
            let Time { start, end, .. } = *time;
            let remedy = if state.time < start { "lower `time.start`, or leave it out" } else { "raise `time.end`" };
            return Err(RestartError::Time {
                path: self.path.clone(),
                time: rounded_time(state.time),
                start,
                end,
                remedy,
            });
        }
        state.nominal = ((state.time - time.start + round_off) / time.step) as usize;
        let end = time.start + time.step * (state.nominal + 1) as f64;
        // Parts of a halved slab are done first, if that slab is one of these.
        if state.pending.first().is_some_and(|last| (last.end - end).abs() > round_off) {
            state.pending.clear();
        }
        // Slabs that adapt begin with the one of the case, or with a shorter one if the flow has needed it.
        (state.failed, state.rejected, state.step) = (None, 0, state.step.min(time.step));
        Ok(())
    }

    fn differs(&self, quantity: &'static str, there: impl Into<String>, here: impl Into<String>) -> RestartError {
        RestartError::Differs { path: self.path.clone(), quantity, there: there.into(), here: here.into() }
    }
}

/// Whether a key is `table` or stands in it.
fn is_in(key: &str, table: &str) -> bool {
    key.strip_prefix(table).is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
}
