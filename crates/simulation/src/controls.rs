//! Numbers in formulas that the run changes after every slab, see [`case::Control`].
//!
//! A control keeps its value during a slab, and the Jacobian contains no derivative of it. The value goes into checkpoints, and so does the
//! one for which the preconditioner was made: a resumed run makes the same preconditioner again.

use super::history;
use super::statistics::RunStatistics;
use crate::error::Failure;
use case::{Case, Control, NotPositive};
use mesh::NodeNumbering;
use output::{Arrays, SolverState};
use std::cell::OnceCell;

/// How the columns of controls in history.csv begin.
const COLUMN: &str = "control_";

/// The names of the arrays of a checkpoint.
const NOW: &str = "controls";
const OF_PRECONDITIONER: &str = "controls_of_preconditioner";

/// Whether the measured quantity is a column of history.csv.
///
/// # Errors
/// A control that measures an unknown column, with the known columns.
pub fn check<const D: usize>(case: &Case<D>) -> Result<(), Failure> {
    let columns = history::columns(case);
    let Some(unknown) = case.controls.iter().find(|control| !columns.contains(&control.measure)) else { return Ok(()) };
    let Control { name, measure, .. } = unknown;
    let accepted = columns.iter().filter(|column| !column.starts_with(COLUMN)).cloned().collect::<Vec<_>>().join(", ");
    Err(Failure::bad_input(anyhow::anyhow!(
        "`controls.{name}.measure`: history.csv has no column \"{measure}\"; accepted: one of {accepted}"
    )))
}

/// The values, a part of the row of history.csv. A mesh that moves alone has no controls.
pub fn values<const D: usize>(case: &Case<D>) -> Vec<f64> {
    let controls = if case.flow.is_some() { &case.controls[..] } else { &[] };
    controls.iter().map(|control| control.value.get()).collect()
}

/// Gives every control its value, or without values the initial one.
fn set<const D: usize>(case: &Case<D>, values: Option<&[f64]>) {
    let values = values.filter(|values| values.len() == case.controls.len());
    for (number, control) in case.controls.iter().enumerate() {
        control.value.set(values.map_or(control.initial, |values| values[number]));
    }
}

/// Gives every control of `case` its values in `arrays`, the sums of an earlier run with the columns `there`; the initial one if that did not have
/// it. The columns of controls are the last ones.
pub fn carry<const D: usize>(case: &Case<D>, there: &[String], arrays: &mut Arrays) {
    for name in [NOW, OF_PRECONDITIONER] {
        let Some(values) = arrays.get_mut(&format!("statistics.{name}")).filter(|values| !values.is_empty()) else {
            continue;
        };
        let names = &there[there.len().saturating_sub(values.len())..];
        let value = |control: &Control| {
            let place = names.iter().position(|name| *name == column(control));
            place.map_or(control.initial, |place| values[place])
        };
        *values = case.controls.iter().map(value).collect::<Vec<f64>>().into();
    }
}

/// The column of history.csv with the values of `control`.
pub fn column(control: &Control) -> String {
    format!("{COLUMN}{}", control.name)
}

/// What updates of controls need again after every slab: the numbers of their columns of history.csv, None where there is no such column.
pub struct Columns {
    time: Option<usize>,
    length: Option<usize>,
    builds: Option<usize>,
    /// What each control measures.
    measured: Vec<Option<usize>>,
    /// The nodes of the mesh, from the first update on that needs their displacement.
    numbering: OnceCell<NodeNumbering>,
}

impl Columns {
    /// Those of `case`.
    pub fn new<const D: usize>(case: &Case<D>) -> Self {
        let columns = history::columns(case);
        let number = |name: &str| columns.iter().position(|column| column == name);
        Columns {
            time: number("t"),
            length: number("dt"),
            builds: number("preconditioner_builds"),
            measured: case.controls.iter().map(|control| number(&control.measure)).collect(),
            numbering: OnceCell::new(),
        }
    }
}

/// Notes the present values as those with which the preconditioner was made, if it was made anew.
pub fn note_preconditioner<const D: usize>(case: &Case<D>, made_anew: bool, statistics: &mut RunStatistics) {
    if !case.controls.is_empty() && made_anew {
        statistics.controls_of_preconditioner = values(case);
    }
}

/// The values after the slab that has entered `row` into history.csv and has left the mesh at the displacement `d`: (control).
///
/// # Errors
/// A value that is no number, or one that makes a pressure or a temperature of a boundary negative or zero. The controls then keep theirs.
pub fn update<const D: usize>(
    case: &Case<D>,
    columns: &Columns,
    (row, d): (&[f64], &[f64]),
    statistics: &mut RunStatistics,
) -> anyhow::Result<()> {
    if case.controls.is_empty() || case.flow.is_none() {
        return Ok(());
    }
    let at = |column: Option<usize>| column.map_or(f64::NAN, |number| row[number]);
    note_preconditioner(case, at(columns.builds) > 0.0, statistics);
    let (t, dt) = (at(columns.time), at(columns.length));
    let measured: Vec<f64> = columns.measured.iter().map(|column| at(*column)).collect();
    let controls = case.controls.iter().zip(&measured);
    let values: Vec<f64> = controls.map(|(control, measured)| control.next(*measured, t, dt)).collect();
    if let Some(wrong) = values.iter().position(|value| !value.is_finite()) {
        let Control { name, measure, .. } = &case.controls[wrong];
        let (value, measured) = (values[wrong], measured[wrong]);
        let wrong = if measured.is_finite() { format!("`controls.{name}.rate`") } else { format!("`{measure}`") };
        anyhow::bail!("the control `{name}` is {value} after {measure} = {measured} at t = {t}: {wrong} is not finite")
    }
    let before = self::values(case);
    set(case, Some(&values));
    if let Some(problem) = not_positive(case, &columns.numbering, d, t) {
        set(case, Some(&before));
        anyhow::bail!("{problem}");
    }
    statistics.controls = values;
    Ok(())
}

/// What the controls make of a value of a boundary that must be positive, if they spoil one at `t`, where the mesh has the displacement `d`.
fn not_positive<const D: usize>(
    case: &Case<D>,
    numbering: &OnceCell<NodeNumbering>,
    d: &[f64],
    t: f64,
) -> Option<String> {
    let flow = case.flow.as_ref()?;
    let displacement = |cell: usize, k: usize, _: &[f64; D]| {
        let numbering = numbering.get_or_init(|| NodeNumbering::new(&case.mesh, case.mesh.order()));
        let node = numbering.cell(cell)[k];
        std::array::from_fn(|i| d[node * D + i])
    };
    case.controls.iter().find_map(|control| {
        let NotPositive { boundary, key, x, value, .. } =
            flow.not_positive_by(control, &case.mesh, displacement, t)?;
        let (name, number) = (&control.name, control.value.get());
        Some(format!(
            "the control `{name}` has become {number} at t = {t}: with it `{key}` of the boundary `{boundary}` is {value} at {x:?}, and must be \
             positive: in a new run, which may start from this one by `restart.from`, a smaller `controls.{name}.rate`, or bounds in it or in the \
             formula by `min` and `max`"
        ))
    })
}

/// Lets outflows with `relaxation` begin with the velocity of the steady flow that has the `row` of history.csv. It was searched with their
/// pressure alone.
pub fn follow_steady_flow<const D: usize>(
    case: &Case<D>,
    columns: &Columns,
    row: &[f64],
    statistics: &mut RunStatistics,
) {
    let boundaries = || case.flow.iter().flat_map(|flow| &flow.boundary);
    let measured = |(control, column): (&Control, &Option<usize>)| {
        let is_of_outflow = boundaries().any(|data| data.control.as_ref() == Some(control));
        column.filter(|_| is_of_outflow).map_or(control.value.get(), |number| row[number])
    };
    let values: Vec<f64> = case.controls.iter().zip(&columns.measured).map(measured).collect();
    set(case, Some(&values));
    statistics.controls = values;
}

/// Sets the controls for which the preconditioner of the state `stored` was made, or the initial ones.
pub fn set_for_preconditioner<const D: usize>(case: &Case<D>, stored: Option<&SolverState>) {
    set(
        case,
        stored
            .and_then(|stored| stored.arrays.get(&format!("statistics.{OF_PRECONDITIONER}")))
            .map(|values| &values[..]),
    );
}

/// Sets the controls to their present values, or to the initial ones.
pub fn set_present<const D: usize>(case: &Case<D>, statistics: &RunStatistics) {
    set(case, Some(&statistics.controls));
}

/// The values that the other ranks need before a slab; None without controls.
pub fn message<const D: usize>(case: &Case<D>) -> Option<SolverState> {
    let mut state = SolverState::default();
    state.arrays.insert(NOW.to_owned(), values(case).into());
    (!case.controls.is_empty()).then_some(state)
}

/// Sets the values of a [`message`].
pub fn receive<const D: usize>(case: &Case<D>, message: &SolverState) {
    if let Some(values) = message.arrays.get(NOW) {
        set(case, Some(values));
    }
}
