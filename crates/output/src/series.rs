//! The group `/stsolve/series`: arrays that are written at times of their own, more or less often than the fields.

use hdf5::{Dataset, Group, Result};

use crate::hdf::{append, drop_last, group_in, growing, read_labels, write_labels};
use crate::layout::{ArraySpec, Axis};

/// Name of the group.
const GROUP: &str = "series";

/// The values of a series, one time after the other, last axis fastest.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Name and axes at each time.
    pub array: ArraySpec,
    /// The times.
    pub times: Vec<f64>,
    /// The values at all times.
    pub values: Vec<f64>,
}

/// Appends the values at a time to the series of `array` in the group `parent`.
pub(crate) fn extend(parent: &Group, array: &ArraySpec, time: f64, values: &[f64]) -> Result<()> {
    let all = group_in(parent, GROUP)?;
    let group = if all.link_exists(&array.name) { all.group(&array.name)? } else { create(&all, array)? };
    append_row(&group, time, values)
}

/// Appends an entry, unless there is one at that time: a wall that begins with a resumed run has one when that run stops at once.
fn append_row(group: &Group, time: f64, values: &[f64]) -> Result<()> {
    let times = group.dataset("times")?;
    if ends_at(&times, time)? {
        return Ok(());
    }
    append(&group.dataset("values")?, 1, values)?;
    append(&times, 1, &[time])
}

/// Whether the last of these times is `time`. The others are not read: a long run appends often.
fn ends_at(times: &Dataset, time: f64) -> Result<bool> {
    let count = times.size();
    Ok(count > 0 && times.read_slice_1d::<f64, _>(count - 1..count)?[0] == time)
}

fn create(all: &Group, array: &ArraySpec) -> Result<Group> {
    let group = all.create_group(&array.name)?;
    let row: Vec<usize> = array.axes.iter().map(|axis| axis.length).collect();
    let labels: Vec<&str> = std::iter::once("time").chain(array.axes.iter().map(|axis| axis.label.as_str())).collect();
    growing::<f64>(&group, "times", 1, &[])?;
    write_labels(&growing::<f64>(&group, "values", 1, &row)?, &labels)?;
    Ok(group)
}

/// Drops the last entry of every series in the group `parent` whose last time is `time`.
pub(crate) fn drop_at(parent: &Group, time: f64) -> Result<()> {
    for name in names(parent)? {
        let group = parent.group(GROUP)?.group(&name)?;
        let times = group.dataset("times")?;
        if ends_at(&times, time)? {
            drop_last(&group.dataset("values")?, 1)?;
            drop_last(&times, 1)?;
        }
    }
    Ok(())
}

/// The names of all series in the group `parent`.
pub(crate) fn names(parent: &Group) -> Result<Vec<String>> {
    if parent.link_exists(GROUP) { parent.group(GROUP)?.member_names() } else { Ok(Vec::new()) }
}

/// Reads the series `name` in the group `parent`, which exists.
pub(crate) fn read(parent: &Group, name: &str) -> Result<Series> {
    let group = parent.group(GROUP)?.group(name)?;
    let values = group.dataset("values")?;
    let axes = read_labels(&values)?.into_iter().zip(values.shape()).skip(1);
    let axes = axes.map(|(label, length)| Axis { label, length }).collect();
    let array = ArraySpec { name: name.to_owned(), axes };
    Ok(Series { array, times: group.dataset("times")?.read_raw()?, values: values.read_raw()? })
}
