//! One step of a file, whole or in parts, and whether it fits the layout.

use std::collections::BTreeMap;
use std::path::Path;

use hdf5::{File, Group};

use crate::error::OutputError;
use crate::layout::{ArraySpec, FieldSpec, FileLayout};
use crate::result_file::ResultFile;
use crate::{format, hdf, vtkhdf};

/// One step: the grid and the solution at one time, on all cells or on some.
#[derive(Debug, Clone, Copy)]
pub struct Step<'a> {
    /// Time.
    pub time: f64,
    /// Points, `[cell][lattice point, lexicographic][3]`.
    pub points: &'a [f64],
    /// Every field of the layout, in any order: its name and
    /// `[cell][lattice point, lexicographic][component]`.
    pub fields: &'a [(&'a str, &'a [f64])],
    /// Every array of coefficients of the layout, in any order: its name and its values, last axis fastest.
    pub exact: &'a [(&'a str, &'a [f64])],
}

impl<'a> Step<'a> {
    /// Whether every array is there and has the length that the `layout` tells.
    pub(crate) fn check(&self, layout: &FileLayout) -> Result<(), OutputError> {
        let points = layout.grid.points();
        checked(POINTS, self.points, 3 * points)?;
        let field = |field: &FieldSpec| find(self.fields, &field.name, field.components * points).map(drop);
        let array = |array: &ArraySpec| find(self.exact, &array.name, array.len()).map(drop);
        layout.fields.iter().try_for_each(field)?;
        layout.exact.iter().try_for_each(array)
    }

    /// The fields in the order of the `layout`, for the points of this step.
    pub(crate) fn fields_in_order(&self, layout: &FileLayout) -> Result<Vec<&'a [f64]>, OutputError> {
        let points = self.points.len() / 3;
        layout.fields.iter().map(|field| find(self.fields, &field.name, field.components * points)).collect()
    }
}

/// A step that is written one part of its cells after the other, in their order. It counts once it is finished: if that does not happen, the
/// result is published no more.
#[must_use]
pub struct StepInParts<'a> {
    result: &'a mut ResultFile,
    file: File,
    time: f64,
    /// How many values of each array are written.
    written: BTreeMap<String, usize>,
}

impl<'a> StepInParts<'a> {
    pub(crate) fn new(result: &'a mut ResultFile, file: File, time: f64) -> Self {
        StepInParts { result, file, time, written: BTreeMap::new() }
    }

    /// Writes the next `part`: points and all fields of some cells, and coefficients, each array of whole entries of its first axis.
    ///
    /// # Errors
    /// [`OutputError::Absent`] or [`OutputError::Length`] if a field is missing or does not fit the points, [`OutputError::Hdf5`] if the part
    /// cannot be written.
    pub fn add(&mut self, part: &Step) -> Result<(), OutputError> {
        let fields = part.fields_in_order(&self.result.layout)?;
        self.write(part, &fields).map_err(|source| self.result.write_error(source))
    }

    fn write(&mut self, part: &Step, fields: &[&[f64]]) -> hdf5::Result<()> {
        let kinds = (&self.result.layout, &self.result.order[..]);
        let first_entry = |array: &ArraySpec| self.written(&array.name) / array.entry_len();
        write_part(&self.file, kinds, (part, fields), self.written(POINTS) / 3, first_entry)?;
        let numbers = part.exact.iter().map(|(name, values)| (*name, values.len()));
        numbers
            .chain([(POINTS, part.points.len())])
            .for_each(|(name, numbers)| count(&mut self.written, name, numbers));
        Ok(())
    }

    fn written(&self, name: &str) -> usize {
        self.written.get(name).copied().unwrap_or_default()
    }

    /// Has all ranks `write` the next `cells` by a [`crate::SharedFile`] at the path that they receive, with the arrays of coefficients that have numbers
    /// of cells.
    ///
    /// # Errors
    /// Those of `write`, and [`OutputError::Hdf5`] if the room for the cells cannot be made.
    pub fn share<E: From<OutputError>>(
        mut self,
        cells: usize,
        write: impl FnOnce(&Path) -> Result<(), E>,
    ) -> Result<Self, E> {
        self.make_room(cells).map_err(|source| self.result.write_error(source))?;
        let StepInParts { result, file, time, written } = self;
        file.close().map_err(|source| result.write_error(source))?;
        write(result.working())?;
        let file = result.open_working()?;
        Ok(StepInParts { result, file, time, written })
    }

    /// Makes the room for the next `cells`, and counts them as written.
    fn make_room(&mut self, cells: usize) -> hdf5::Result<()> {
        let StepInParts { result, file, written, .. } = self;
        let layout = &result.layout;
        let (root, exact) = groups(file)?;
        let step = vtkhdf::times(&root)?.len();
        let points = cells * layout.grid.points_per_cell();
        count(written, POINTS, 3 * points);
        vtkhdf::make_room_for(&root, layout, step * layout.grid.points() + written[POINTS] / 3)?;
        layout.exact.iter().filter(|array| array.is_of_cells()).try_for_each(|array| {
            count(written, &array.name, array.len());
            hdf::make_room(&exact.dataset(&array.name)?, step + 1)
        })
    }

    /// Makes the parts a step.
    ///
    /// # Errors
    /// [`OutputError::Length`] if a part is missing, [`OutputError::Hdf5`] if the step cannot be written.
    pub fn finish(self) -> Result<(), OutputError> {
        let layout = &self.result.layout;
        self.is_complete(POINTS, 3 * layout.grid.points())?;
        layout.exact.iter().try_for_each(|array| self.is_complete(&array.name, array.len()))?;
        let closed = || vtkhdf::close_step(&self.file.group("VTKHDF")?, self.time, layout);
        closed().map_err(|source| self.result.write_error(source))?;
        self.result.keep(self.file);
        Ok(())
    }

    fn is_complete(&self, name: &str, expected: usize) -> Result<(), OutputError> {
        match self.written(name) {
            found if found == expected => Ok(()),
            found => Err(OutputError::Length { name: name.to_owned(), expected, found }),
        }
    }
}

fn count(written: &mut BTreeMap<String, usize>, name: &str, numbers: usize) {
    *written.entry(name.to_owned()).or_default() += numbers;
}

/// The group of the viewer, and that of the coefficients.
fn groups(file: &File) -> hdf5::Result<(Group, Group)> {
    Ok((file.group("VTKHDF")?, file.group(format::GROUP)?.group("exact")?))
}

/// Writes a `part` to the step that is not closed yet, with its `fields` in the order of the layout. Its points begin at the number `first_point` of the
/// step, each array of coefficients at the number `first_entry` of its first axis. `order` comes from [`crate::vtk_order`].
pub(crate) fn write_part(
    file: &File,
    (layout, order): (&FileLayout, &[usize]),
    (part, fields): (&Step, &[&[f64]]),
    first_point: usize,
    first_entry: impl Fn(&ArraySpec) -> usize,
) -> hdf5::Result<()> {
    let (root, exact) = groups(file)?;
    let step = vtkhdf::times(&root)?.len();
    vtkhdf::write_cells(&root, layout, order, step * layout.grid.points() + first_point, (part.points, fields))?;
    for (name, values) in part.exact {
        let Some(array) = layout.exact.iter().find(|array| array.name == *name) else { continue };
        let entries = values.len() / array.entry_len();
        hdf::write_rows(&exact.dataset(name)?, step, first_entry(array), entries, values)?;
    }
    Ok(())
}

/// What the points are called in messages.
const POINTS: &str = "points";

fn find<'a>(arrays: &[(&str, &'a [f64])], name: &str, length: usize) -> Result<&'a [f64], OutputError> {
    match arrays.iter().find(|array| array.0 == name) {
        Some(&(_, values)) => checked(name, values, length),
        None => Err(OutputError::Absent { name: name.to_owned() }),
    }
}

/// The `values` of the array `name`, if there are as many as expected.
pub(crate) fn checked<'a>(name: &str, values: &'a [f64], expected: usize) -> Result<&'a [f64], OutputError> {
    match values.len() {
        found if found == expected => Ok(values),
        found => Err(OutputError::Length { name: name.to_owned(), expected, found }),
    }
}
