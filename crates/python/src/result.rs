//! A result file.

use crate::{CaseError, SolveError, message};
use numpy::{PyArrayDyn, PyArrayMethods, PyReadonlyArray2, ToPyArray};
use output::{ArraySpec, HistoryTable, OutputError, RESULT_FILE, ResultReader, Series};
use pyo3::exceptions::{PyIndexError, PyKeyError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use simulation::{SurfaceColumn, by_node, locate, surface_columns, surface_name, values_at};
use std::path::PathBuf;

/// The result of a run: `Result("runs/vortex")`, or the file result.vtkhdf in it.
///
/// It shows what was last published by a run that may still go on.
#[pyclass(frozen)]
pub struct Result {
    directory: PathBuf,
    reader: ResultReader,
}

fn unreadable(error: OutputError) -> PyErr {
    CaseError::new_err(message(&error))
}

/// The number of one of `count` steps, which may be counted from the end.
fn chosen(step: isize, count: usize) -> PyResult<usize> {
    let number = if step < 0 { step + count as isize } else { step };
    usize::try_from(number)
        .ok()
        .filter(|number| *number < count)
        .ok_or_else(|| PyIndexError::new_err(format!("there is no step {step}: the result has {count}")))
}

#[pymethods]
impl Result {
    #[new]
    fn new(path: PathBuf) -> PyResult<Self> {
        let file = if path.is_dir() { path.join(RESULT_FILE) } else { path };
        let reader = ResultReader::open(&file).map_err(unreadable)?;
        Ok(Result { directory: file.parent().map(PathBuf::from).unwrap_or_default(), reader })
    }

    /// The time of every step.
    #[getter]
    fn times<'py>(&self, py: Python<'py>) -> Bound<'py, PyAny> {
        self.reader.times.to_pyarray(py).into_any()
    }

    /// The resolved case, as TOML.
    #[getter]
    fn case_text(&self) -> &str {
        &self.reader.metadata.case_text
    }

    /// The arrays of exact coefficients: for each its axes, as pairs of a label and a length.
    #[getter]
    fn arrays<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let arrays = PyDict::new(py);
        for array in &self.reader.layout.exact {
            let axes: Vec<(&str, usize)> = array.axes.iter().map(|axis| (&axis.label[..], axis.length)).collect();
            arrays.set_item(&array.name, axes)?;
        }
        Ok(arrays)
    }

    /// The exact coefficients `name` of a step as a NumPy array; step -1 is the last.
    #[pyo3(signature = (name, step=-1))]
    fn array<'py>(&self, py: Python<'py>, name: &str, step: isize) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let shape: Vec<usize> = self.spec(name)?.axes.iter().map(|axis| axis.length).collect();
        self.values(name, step)?.to_pyarray(py).reshape(shape)
    }

    /// The columns of history.csv as NumPy arrays.
    #[getter]
    fn history<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let table = HistoryTable::read(&self.directory).map_err(unreadable)?;
        let columns = PyDict::new(py);
        for name in &table.columns {
            columns.set_item(name, table.column(name).unwrap_or_default().to_pyarray(py))?;
        }
        Ok(columns)
    }

    /// The distribution on a wall of `output.surfaces` as a dictionary of columns, those of surface_NAME.csv; step -1 is its last time.
    #[pyo3(signature = (wall, step=-1))]
    fn surface<'py>(&self, py: Python<'py>, wall: &str, step: isize) -> PyResult<Bound<'py, PyDict>> {
        let series = self.series_of(wall)?;
        let number = chosen(step, series.times.len())?;
        let values = &series.values[number * series.array.len()..][..series.array.len()];
        let names = surface_columns(self.reader.layout.grid.dimension)
            .iter()
            .flat_map(SurfaceColumn::names)
            .collect::<Vec<_>>();
        let columns = PyDict::new(py);
        columns.set_item("t", series.times[number])?;
        for (position, name) in names.iter().enumerate() {
            let column: Vec<f64> = values.iter().skip(position).step_by(names.len()).copied().collect();
            columns.set_item(name, column.to_pyarray(py))?;
        }
        Ok(columns)
    }

    /// The conserved state at points, an array [point][axis], as an array [point][component]: density, momentum per axis, total energy per
    /// volume. NaN outside of the mesh. It is the exact polynomial at the time of the step.
    #[pyo3(signature = (points, step=-1))]
    fn evaluate<'py>(
        &self,
        py: Python<'py>,
        points: PyReadonlyArray2<'py, f64>,
        step: isize,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let points = points.as_array();
        let (count, dimension) = points.dim();
        if dimension != self.reader.layout.grid.dimension {
            let problem =
                format!("points have {dimension} coordinates, the mesh has {}", self.reader.layout.grid.dimension);
            return Err(PyValueError::new_err(problem));
        }
        let rows: Vec<Vec<f64>> = points.rows().into_iter().map(|row| row.to_vec()).collect();
        let values = match dimension {
            2 => self.states::<2>(&rows, step)?,
            _ => self.states::<3>(&rows, step)?,
        };
        values.to_pyarray(py).reshape(vec![count, dimension + 2])
    }

    fn __repr__(&self) -> String {
        format!("stsolve.Result({:?}), {} steps", self.reader.metadata.case_name, self.reader.times.len())
    }
}

impl Result {
    fn spec(&self, name: &str) -> PyResult<&ArraySpec> {
        let found = self.reader.layout.exact.iter().find(|array| array.name == name);
        let names: Vec<&str> = self.reader.layout.exact.iter().map(|array| &array.name[..]).collect();
        found.ok_or_else(|| PyKeyError::new_err(format!("there is no array {name:?}, but {}", names.join(", "))))
    }

    /// The number of a step that may be counted from the end.
    fn number(&self, step: isize) -> PyResult<usize> {
        chosen(step, self.reader.times.len())
    }

    /// The distributions on a wall.
    fn series_of(&self, wall: &str) -> PyResult<Series> {
        let failed = |error: OutputError| SolveError::new_err(message(&error));
        let found = self.reader.series(&surface_name(wall)).map_err(failed)?;
        let known = self.reader.series_names().map_err(failed)?.join(", ").replace("surface_", "");
        let there = if known.is_empty() {
            "on no wall; `output.surfaces` asks for them".to_owned()
        } else {
            format!("on {known}")
        };
        found.ok_or_else(|| PyKeyError::new_err(format!("there is no distribution on {wall:?}, but {there}")))
    }

    fn values(&self, name: &str, step: isize) -> PyResult<Vec<f64>> {
        let values =
            self.reader.exact(name, self.number(step)?).map_err(|error| SolveError::new_err(message(&error)))?;
        Ok(values.unwrap_or_default())
    }

    /// The state at `points`, one after the other.
    fn states<const D: usize>(&self, points: &[Vec<f64>], step: isize) -> PyResult<Vec<f64>> {
        let (position, flow) = (self.spec("position")?, self.spec("flow")?);
        let lengths = |array: &ArraySpec| -> Vec<usize> { array.axes.iter().map(|axis| axis.length).collect() };
        let (of_mesh, of_flow) = (lengths(position), lengths(flow));
        let (&[cells, _, nodes], &[_, times, components, flow_nodes]) = (&of_mesh[..], &of_flow[..]) else {
            return Err(SolveError::new_err("the arrays of the result have other axes than this version knows"));
        };
        let (x, u) = (self.values("position", step)?, self.values("flow", step)?);
        let order = |nodes: usize| (nodes as f64).powf(1.0 / D as f64).round() as usize;
        let of_cell = |cell: usize| by_node::<D>(&x[cell * D * nodes..][..D * nodes]);
        let by_cell: Vec<Vec<f64>> = (0..cells).map(of_cell).collect();
        let at = |point: &Vec<f64>| -> Vec<f64> {
            let point: [f64; D] = std::array::from_fn(|d| point[d]);
            let place = locate(order(nodes), cells, |cell| &by_cell[cell], &point);
            let Some((cell, xi)) = place else { return vec![f64::NAN; components] };
            let last = &u[((cell + 1) * times - 1) * components * flow_nodes..][..components * flow_nodes];
            values_at(order(flow_nodes), last, &xi)
        };
        Ok(points.iter().flat_map(at).collect())
    }
}
