//! Fields of a result file at points, in two or three dimensions.
//!
//! Files are read and fields are evaluated without Python: threads of a run may be needed for it, and they may be waiting for Python.

use crate::{CaseError, SolveError, message};
use numpy::PyReadonlyArray2;
use output::{ArraySpec, OutputError, ResultReader};
use pyo3::exceptions::{PyIndexError, PyKeyError, PyValueError};
use pyo3::prelude::*;
use simulation::{CellFinder, StoredField};

/// The exception for a result file that cannot be opened.
pub fn unreadable(error: OutputError) -> PyErr {
    CaseError::new_err(message(&error))
}

/// The exception for a part of it that cannot be read.
pub fn broken(error: OutputError) -> PyErr {
    SolveError::new_err(message(&error))
}

/// The number of one of `count` steps or other things, called `what`, which may be counted from the end.
pub fn chosen(what: &str, step: isize, count: usize) -> PyResult<usize> {
    let number = if step < 0 { step + count as isize } else { step };
    usize::try_from(number)
        .ok()
        .filter(|number| *number < count)
        .ok_or_else(|| PyIndexError::new_err(format!("there is no {what} {step}: the result has {count}")))
}

/// The lengths of the axes of an array.
pub fn lengths(array: &ArraySpec) -> Vec<usize> {
    array.axes.iter().map(|axis| axis.length).collect()
}

/// The array `name`.
pub fn spec<'a>(reader: &'a ResultReader, name: &str) -> PyResult<&'a ArraySpec> {
    let found = reader.layout.exact.iter().find(|array| array.name == name);
    let names: Vec<&str> = reader.layout.exact.iter().map(|array| &array.name[..]).collect();
    found.ok_or_else(|| PyKeyError::new_err(format!("there is no array {name:?}, but {}", names.join(", "))))
}

/// All coefficients of the array `name` at a step.
pub fn coefficients(py: Python<'_>, reader: &ResultReader, name: &str, step: isize) -> PyResult<Vec<f64>> {
    py.detach(|| read(reader, name, step))
}

fn read(reader: &ResultReader, name: &str, step: isize) -> PyResult<Vec<f64>> {
    spec(reader, name)?;
    let number = chosen("step", step, reader.times.len())?;
    Ok(reader.exact(name, number).map_err(broken)?.unwrap_or_default())
}

/// The positions of the cells on which the array `name` is: those of the mesh, or of a structure beside the flow.
pub fn positions_of(reader: &ResultReader, name: &str) -> PyResult<&'static str> {
    let cells = spec(reader, name)?.axes.first();
    let of_structure = cells.is_some_and(|axis| axis.label == "structure cell");
    Ok(if of_structure { "structure_position" } else { "position" })
}

/// The field `name` at the end of the slab of a step.
pub fn field<const D: usize>(reader: &ResultReader, name: &str, step: isize) -> PyResult<StoredField<D>> {
    let (axes, all) = (lengths(spec(reader, name)?), read(reader, name, step)?);
    let field = match axes[..] {
        [cells, components, _] => StoredField::new(components, all, cells),
        [cells, times, components, nodes] => {
            let last = |cell: &[f64]| cell[(times - 1) * components * nodes..].to_vec();
            let slab_length = (times * components * nodes).max(1);
            StoredField::new(components, all.chunks_exact(slab_length).flat_map(last).collect(), cells)
        }
        _ => None,
    };
    field.ok_or_else(|| {
        let problem = format!("the array {name:?} has the axes {axes:?}, which are not those of a field");
        SolveError::new_err(problem)
    })
}

/// Values and the lengths of their axes.
pub type Values = (Vec<f64>, Vec<usize>);

/// The field `name` at `points`, `[point][component]`; NaN outside of the cells.
pub fn evaluated<const D: usize>(
    reader: &ResultReader,
    name: &str,
    step: isize,
    points: &Bound<'_, PyAny>,
) -> PyResult<Values> {
    let (py, points) = (points.py(), points_of::<D>(points)?);
    py.detach(|| {
        let field = field::<D>(reader, name, step)?;
        let finder = CellFinder::new(&self::field::<D>(reader, positions_of(reader, name)?, step)?);
        Ok((field.at_points(&finder, &points), vec![points.len(), field.components()]))
    })
}

/// The field `name` at reference points of every cell, `[cell][point][component]`.
pub fn at_reference<const D: usize>(
    reader: &ResultReader,
    name: &str,
    step: isize,
    points: &Bound<'_, PyAny>,
) -> PyResult<Values> {
    let (py, points) = (points.py(), points_of::<D>(points)?);
    py.detach(|| {
        let field = field::<D>(reader, name, step)?;
        Ok((field.at_reference(&points), vec![field.cells(), points.len(), field.components()]))
    })
}

/// det J of the positions `name` at reference points of every cell, `[cell][point]`.
pub fn determinants<const D: usize>(
    reader: &ResultReader,
    name: &str,
    step: isize,
    points: &Bound<'_, PyAny>,
) -> PyResult<Values> {
    let (py, points) = (points.py(), points_of::<D>(points)?);
    py.detach(|| {
        let field = field::<D>(reader, name, step)?;
        let found = field.determinants(&points).ok_or_else(|| {
            let components = field.components();
            PyValueError::new_err(format!("the array {name:?} has {components} components; a position has {D}"))
        })?;
        Ok((found, vec![field.cells(), points.len()]))
    })
}

/// The points of anything that NumPy takes for an array `[point][axis]`.
fn points_of<const D: usize>(points: &Bound<'_, PyAny>) -> PyResult<Vec<[f64; D]>> {
    let array = points.py().import("numpy")?.call_method1("asarray", (points, "float64"))?;
    let shape: Vec<usize> = array.getattr("shape")?.extract()?;
    if shape.len() != 2 || shape[1] != D {
        let problem = format!("points have the axes {shape:?}; wanted is an array [point][axis] with {D} coordinates");
        return Err(PyValueError::new_err(problem));
    }
    let array: PyReadonlyArray2<'_, f64> = array.extract()?;
    Ok(array.as_array().rows().into_iter().map(|row| std::array::from_fn(|d| row[d])).collect())
}
