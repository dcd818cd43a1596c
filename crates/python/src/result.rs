//! A result file.

use crate::not_pickled;
use crate::stored::{
    Values, at_reference, broken, chosen, coefficients, determinants, evaluated, lengths, spec, unreadable,
};
use numpy::{PyArray1, PyArray2, PyArrayDyn, PyArrayMethods, ToPyArray};
use output::{HistoryTable, RESULT_FILE, ResultReader, Series};
use pyo3::exceptions::{PyKeyError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use simulation::{SurfaceColumn, surface_columns, surface_name};
use std::path::PathBuf;

/// The result of a run: `Result("runs/vortex")`, or the file result.vtkhdf in it.
///
/// It shows the last published state of a run, which may still continue. Step -1 is the last one, and the default.
#[pyclass(frozen)]
pub struct Result {
    directory: PathBuf,
    reader: ResultReader,
}

/// Calls a function for the dimension of the mesh of `$result`, and makes an array of NumPy of the values.
macro_rules! in_dimension {
    ($py:expr, $result:expr, $function:ident($($argument:expr),*)) => {{
        let (values, shape): Values = match $result.dimension() {
            2 => $function::<2>(&$result.reader, $($argument),*)?,
            _ => $function::<3>(&$result.reader, $($argument),*)?,
        };
        PyArray1::from_vec($py, values).reshape(shape)
    }};
}

#[pymethods]
impl Result {
    #[new]
    fn new(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        // Another directory of work does not change what the result is read from.
        let path = std::path::absolute(&path)?;
        let file = if path.is_dir() { path.join(RESULT_FILE) } else { path };
        let reader = py.detach(|| ResultReader::open(&file)).map_err(unreadable)?;
        Ok(Result { directory: file.parent().map(PathBuf::from).unwrap_or_default(), reader })
    }

    /// The time of every step.
    #[getter]
    fn times<'py>(&self, py: Python<'py>) -> Bound<'py, PyAny> {
        self.reader.times.to_pyarray(py).into_any()
    }

    /// The step whose time is nearest to `time`.
    fn step_at(&self, time: f64) -> PyResult<usize> {
        if time.is_nan() {
            return Err(PyValueError::new_err("the time is not a number"));
        }
        let [first, .., last] = self.reader.times[..] else {
            let alone = (!self.reader.times.is_empty()).then_some(0);
            return alone.ok_or_else(|| PyValueError::new_err("the result has no steps"));
        };
        // Times that are infinitely far are equally far from all steps.
        let time = time.clamp(first, last);
        let steps = self.reader.times.iter().enumerate();
        let nearest = steps.min_by(|(_, a), (_, b)| (*a - time).abs().total_cmp(&(*b - time).abs()));
        Ok(nearest.map_or(0, |(step, _)| step))
    }

    /// The resolved case, as TOML.
    #[getter]
    fn case_text(&self) -> &str {
        &self.reader.metadata.case_text
    }

    /// 2 or 3.
    #[getter]
    fn dimension(&self) -> usize {
        self.reader.layout.grid.dimension
    }

    /// The names of the boundaries.
    #[getter]
    fn boundaries(&self) -> Vec<String> {
        self.reader.metadata.mesh.boundary_names.clone()
    }

    /// The facets of a boundary, an array [facet][2]: the cell, and the face 2 axis + side of its reference cell, side 0 or 1.
    fn facets<'py>(&self, py: Python<'py>, boundary: &str) -> PyResult<Bound<'py, PyArray2<i64>>> {
        let mesh = &self.reader.metadata.mesh;
        let number = mesh.boundary_names.iter().position(|name| name == boundary).ok_or_else(|| {
            let known = mesh.boundary_names.join(", ");
            PyKeyError::new_err(format!("there is no boundary {boundary:?}, but {known}"))
        })?;
        let facets = mesh.boundary_facets.iter().filter(|facet| facet[2] == number as i64);
        let numbers: Vec<i64> = facets.flat_map(|facet| [facet[0], facet[1]]).collect();
        let count = numbers.len() / 2;
        PyArray1::from_vec(py, numbers).reshape([count, 2])
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

    /// The exact coefficients `name` of a step as a NumPy array: values at the Gauss-Lobatto nodes of each cell, axis 0 fastest.
    #[pyo3(signature = (name, step=-1))]
    fn array<'py>(&self, py: Python<'py>, name: &str, step: isize) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let shape = lengths(spec(&self.reader, name)?);
        PyArray1::from_vec(py, coefficients(py, &self.reader, name, step)?).reshape(shape)
    }

    /// The columns of history.csv as NumPy arrays.
    #[getter]
    fn history<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let table = py.detach(|| HistoryTable::read(&self.directory)).map_err(unreadable)?;
        let columns = PyDict::new(py);
        for name in &table.columns {
            columns.set_item(name, table.column(name).unwrap_or_default().to_pyarray(py))?;
        }
        Ok(columns)
    }

    /// The distribution on a wall of `output.surfaces` as a dictionary of columns, those of surface_NAME.csv; step -1 is its last time.
    #[pyo3(signature = (wall, step=-1))]
    fn surface<'py>(&self, py: Python<'py>, wall: &str, step: isize) -> PyResult<Bound<'py, PyDict>> {
        let series = py.detach(|| self.series_of(wall))?;
        let number = chosen("distribution", step, series.times.len())?;
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

    /// The array `name` at points, an array [point][axis], as an array [point][component]. The flow has the components density, momentum per
    /// axis, total energy per volume. NaN outside of the mesh. It is the exact polynomial at the time of the step.
    #[pyo3(signature = (points, step=-1, name="flow"))]
    fn evaluate<'py>(
        &self,
        py: Python<'py>,
        points: &Bound<'py, PyAny>,
        step: isize,
        name: &str,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        in_dimension!(py, self, evaluated(name, step, points))
    }

    /// The array `name` at points of the reference cell [-1, 1]^D, an array [point][axis], in every cell: an array [cell][point][component].
    fn values<'py>(
        &self,
        py: Python<'py>,
        name: &str,
        step: isize,
        points: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        in_dimension!(py, self, at_reference(name, step, points))
    }

    /// det J at points of the reference cell, in every cell: an array [cell][point]. `name` are the positions, those of a structure beside the
    /// flow are "structure_position".
    #[pyo3(signature = (step, points, name="position"))]
    fn determinants<'py>(
        &self,
        py: Python<'py>,
        step: isize,
        points: &Bound<'py, PyAny>,
        name: &str,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        in_dimension!(py, self, determinants(name, step, points))
    }

    fn __reduce__(&self) -> PyResult<()> {
        Err(not_pickled("Result", "the path of the result"))
    }

    fn __repr__(&self) -> String {
        format!("stsolve.Result({:?}), {} steps", self.reader.metadata.case_name, self.reader.times.len())
    }
}

impl Result {
    /// The distributions on a wall.
    fn series_of(&self, wall: &str) -> PyResult<Series> {
        let found = self.reader.series(&surface_name(wall)).map_err(broken)?;
        let known = self.reader.series_names().map_err(broken)?.join(", ").replace("surface_", "");
        let there = if known.is_empty() {
            "on no wall; `output.surfaces` asks for them".to_owned()
        } else {
            format!("on {known}")
        };
        found.ok_or_else(|| PyKeyError::new_err(format!("there is no distribution on {wall:?}, but {there}")))
    }
}
