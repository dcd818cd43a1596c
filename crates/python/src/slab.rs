//! A slab of a run in progress: its numbers, and its fields without copies.

use crate::not_pickled;
use numpy::ndarray::ArrayViewD;
use numpy::{PyArrayDyn, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::exceptions::{PyKeyError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyIterator, PyList};
use simulation::{Positions, RunState};
use std::sync::{Arc, OnceLock};

/// The end of a slab, as `on_slab` receives it. `slab["airfoil_lift_coefficient"]` is a number of its row in history.csv, and `keys()` are the
/// columns. The fields are arrays that cannot be written. They stay valid after the call and after the run.
#[pyclass(frozen, mapping)]
pub struct Slab {
    number: usize,
    time: f64,
    dt: f64,
    columns: Vec<String>,
    row: Vec<f64>,
    /// `[cell][time node][component][node]`, if there is a flow.
    flow: Option<Field>,
    /// `[time node][C0 node][component]`
    velocity: Option<Field>,
    /// `[C0 node][component]`
    displacement: Field,
    positions: Arc<Positions>,
    /// `[cell][component][node]`, made on the first request.
    position: OnceLock<Arc<Vec<f64>>>,
    shape_of_position: Vec<usize>,
}

/// Numbers that the solver shares, and the lengths of their axes.
struct Field {
    numbers: Arc<Vec<f64>>,
    shape: Vec<usize>,
}

impl Field {
    fn to_numpy<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        borrowed(py, &self.numbers, &self.shape)
    }
}

impl Slab {
    /// The slab that has led to this state.
    pub fn new(now: &RunState<'_>) -> Self {
        let (state, shape_of_position) = (now.state, now.shape("position").unwrap_or_default());
        let components = shape_of_position.get(1).copied().unwrap_or(1);
        let nodes = state.d.len() / components;
        let of_nodes = |numbers: &Arc<Vec<f64>>| {
            let times = numbers.len() / state.d.len().max(1);
            Field { numbers: numbers.clone(), shape: vec![times, nodes, components] }
        };
        let past = state.past.as_ref();
        let flow = (now.flow)().zip(now.shape("flow")).map(|(numbers, shape)| Field { numbers, shape });
        Slab {
            number: state.slab,
            time: state.time,
            dt: past.map_or(0.0, |past| past.dt),
            columns: now.columns.to_vec(),
            row: now.row.to_vec(),
            flow,
            velocity: past.map(|past| of_nodes(&past.v)),
            displacement: Field { numbers: Arc::new(state.d.clone()), shape: vec![nodes, components] },
            positions: now.positions.clone(),
            position: OnceLock::new(),
            shape_of_position,
        }
    }

    fn value(&self, column: &str) -> Option<f64> {
        let number = self.columns.iter().position(|name| name == column)?;
        self.row.get(number).copied()
    }
}

#[pymethods]
impl Slab {
    /// The number of the slab in the run, from 1.
    #[getter]
    fn number(&self) -> usize {
        self.number
    }

    /// The time at the end of the slab.
    #[getter]
    fn time(&self) -> f64 {
        self.time
    }

    /// The length of the slab.
    #[getter]
    fn dt(&self) -> f64 {
        self.dt
    }

    /// The conserved state in the slab, [cell][time node][component][node], as Result.array("flow") has it: the memory of the solver, without a
    /// copy. The last time node is the end of the slab. None in a run without a flow.
    #[getter]
    fn flow<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArrayDyn<f64>>>> {
        self.flow.as_ref().map(|field| field.to_numpy(py)).transpose()
    }

    /// The velocity of the nodes of the mesh or the structure in the slab, [time node][C0 node][component]: the memory of the solver, without a
    /// copy.
    #[getter]
    fn velocity<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArrayDyn<f64>>>> {
        self.velocity.as_ref().map(|field| field.to_numpy(py)).transpose()
    }

    /// The displacement of these nodes at the end of the slab, [C0 node][component].
    #[getter]
    fn displacement<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        self.displacement.to_numpy(py)
    }

    /// The position of the nodes of every cell at the end of the slab, [cell][component][node], as Result.array("position") has it. It is
    /// computed when it is first asked for.
    #[getter]
    fn position<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        // Without Python: threads of the run that wait for it may be needed here.
        let numbers =
            py.detach(|| self.position.get_or_init(|| Arc::new((self.positions)(&self.displacement.numbers))));
        borrowed(py, numbers, &self.shape_of_position)
    }

    /// The columns of history.csv.
    fn keys(&self) -> Vec<String> {
        self.columns.clone()
    }

    fn __getitem__(&self, column: &str) -> PyResult<f64> {
        self.value(column).ok_or_else(|| {
            PyKeyError::new_err(format!("history.csv has no column {column:?}, but {}", self.columns.join(", ")))
        })
    }

    /// As in a dictionary, what is no text is no column.
    fn __contains__(&self, column: &Bound<'_, PyAny>) -> bool {
        column.extract::<String>().is_ok_and(|column| self.value(&column).is_some())
    }

    fn __iter__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyIterator>> {
        PyList::new(py, &self.columns)?.try_iter()
    }

    fn __len__(&self) -> usize {
        self.columns.len()
    }

    fn __reduce__(&self) -> PyResult<()> {
        Err(not_pickled("Slab", "dict(slab) and copies of its arrays"))
    }

    fn __repr__(&self) -> String {
        format!("stsolve.Slab({}, time = {}, dt = {})", self.number, self.time, self.dt)
    }
}

/// Keeps shared numbers for the arrays of NumPy that show them.
#[pyclass(frozen)]
struct Owner {
    numbers: Arc<Vec<f64>>,
}

/// An array that shows `numbers` without a copy, keeps them and cannot be written.
fn borrowed<'py>(py: Python<'py>, numbers: &Arc<Vec<f64>>, shape: &[usize]) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    let owner = Bound::new(py, Owner { numbers: numbers.clone() })?;
    let view = ArrayViewD::from_shape(shape, &owner.get().numbers).map_err(|error| {
        PyValueError::new_err(format!("{} numbers do not fit the axes {shape:?}: {error}", numbers.len()))
    })?;
    // SAFETY: `owner`, the base of the array, keeps the numbers. Nobody changes them while they are shared.
    let array = unsafe { PyArrayDyn::borrow_from_array(&view, owner.clone().into_any()) };
    debug_assert_eq!(array.shape(), shape);
    array.readwrite().make_nonwriteable();
    Ok(array)
}
