//! The solver state: all data besides the case that a restart needs, by names.

use std::collections::BTreeMap;
use std::sync::Arc;

use hdf5::{Dataset, Error, Group, Result};

use crate::hdf::{allocated_early, group_in, growing, read_integer, read_text, write_integer, write_text};

/// Arrays by their names. They may be shared with the solver: a checkpoint needs no copy of large ones.
pub type Arrays = BTreeMap<String, Arc<Vec<f64>>>;

/// The data for a restart. The solver defines the names; here they are stored bit by bit.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SolverState {
    /// Arrays, for instance the flow coefficients of the last slab. Names without `/`.
    pub arrays: Arrays,
    /// Counters, for instance the number of slabs done.
    pub integers: BTreeMap<String, i64>,
    /// Anything else. Texts without zero bytes.
    pub texts: BTreeMap<String, String>,
}

/// A long array of the state that is made while it is written, one part after the other.
pub struct ArrayInParts<'a> {
    /// Its name, without `/`.
    pub name: String,
    /// The number of its values.
    pub len: usize,
    /// Its values.
    pub parts: Parts<'a>,
}

/// The values of a long array.
pub enum Parts<'a> {
    /// One part after the other.
    InOrder(Box<dyn Iterator<Item = Vec<f64>> + 'a>),
    /// Each rank writes some of them, see [`crate::SharedFile`].
    OfAllRanks,
}

/// Numbers in a chunk of an array that changes its length.
const CHUNK: usize = 2048;

/// Name of the group of the state.
const STATE: &str = "state";
/// Name of the group of its arrays.
const ARRAYS: &str = "arrays";

/// Replaces the state in the group `parent` by `state` with the `long` arrays. The space of the old one is used again: what a file frees is lost
/// when it is closed.
pub(crate) fn write(parent: &Group, state: &SolverState, long: Vec<ArrayInParts<'_>>) -> Result<()> {
    let group = group_in(parent, STATE)?;
    let arrays = group_in(&group, ARRAYS)?;
    let stays = |name: &String| state.arrays.contains_key(name) || long.iter().any(|array| array.name == *name);
    arrays.member_names()?.iter().filter(|name| !stays(name)).try_for_each(|name| arrays.unlink(name))?;
    state.arrays.iter().try_for_each(|(name, values)| replace(&arrays, name, values))?;
    long.into_iter().try_for_each(|array| replace_in_parts(&arrays, array))?;
    if group.link_exists("integers") {
        group.unlink("integers")?;
    }
    let integers = group.create_group("integers")?;
    state.integers.iter().try_for_each(|(name, &value)| write_integer(&integers, name, value))?;
    write_texts(&group, &state.texts)
}

/// Replaces the texts. One that stays is not written again: a file never frees the space of a text.
fn write_texts(group: &Group, now: &BTreeMap<String, String>) -> Result<()> {
    let texts = group_in(group, "texts")?;
    let before = named(texts.attr_names()?, |name| read_text(&texts, name))?;
    let differ = |one: &BTreeMap<String, String>, other: &BTreeMap<String, String>| {
        one.clone().into_iter().filter(|(name, text)| other.get(name) != Some(text)).collect::<Vec<_>>()
    };
    differ(&before, now).iter().try_for_each(|(name, _)| texts.delete_attr(name))?;
    differ(now, &before).iter().try_for_each(|(name, text)| write_text(&texts, name, text))
}

/// Writes an array in the place of an earlier one.
fn replace(arrays: &Group, name: &str, values: &[f64]) -> Result<()> {
    let array = room(arrays, name, values.len())?;
    if values.is_empty() { Ok(()) } else { array.write_raw(values) }
}

/// [`replace`] for an array in parts.
fn replace_in_parts(arrays: &Group, ArrayInParts { name, len, parts }: ArrayInParts<'_>) -> Result<()> {
    let array = room(arrays, &name, len)?;
    let Parts::InOrder(parts) = parts else { return Ok(()) };
    let mut end = 0;
    for part in parts.filter(|part| !part.is_empty()) {
        end += part.len();
        array.write_slice(&part, end - part.len()..end)?;
    }
    if end == len { Ok(()) } else { Err(Error::from(format!("`{name}` has {end} values, {len} were expected"))) }
}

/// Writes `values` to the array `name` of the state in the group `parent`, from the number `first` on.
pub(crate) fn write_part(parent: &Group, name: &str, first: usize, values: &[f64]) -> Result<()> {
    parent.group(STATE)?.group(ARRAYS)?.dataset(name)?.write_slice(values, first..first + values.len())
}

/// An array of `len` values, the earlier one if there is one. One that changes its length consists of chunks from then on.
fn room(arrays: &Group, name: &str, len: usize) -> Result<Dataset> {
    if !arrays.link_exists(name) {
        return allocated_early(arrays).empty::<f64>().shape(len).create(name);
    }
    let mut array = arrays.dataset(name)?;
    if array.size() != len {
        if !array.is_resizable() {
            arrays.unlink(name)?;
            array = growing::<f64>(arrays, name, CHUNK, &[])?;
        }
        array.resize(len)?;
    }
    Ok(array)
}

/// Reads the state in the group `parent`, except for the arrays that stay `in_file`.
pub(crate) fn read(parent: &Group, in_file: &[&str]) -> Result<(SolverState, BTreeMap<String, Dataset>)> {
    let group = parent.group(STATE)?;
    let (arrays, integers, texts) = (group.group(ARRAYS)?, group.group("integers")?, group.group("texts")?);
    let (stay, now) = arrays.member_names()?.into_iter().partition(|name| in_file.contains(&name.as_str()));
    let state = SolverState {
        arrays: named(now, |name| Ok(Arc::new(arrays.dataset(name)?.read_raw()?)))?,
        integers: named(integers.attr_names()?, |name| read_integer(&integers, name))?,
        texts: named(texts.attr_names()?, |name| read_text(&texts, name))?,
    };
    Ok((state, named(stay, |name| arrays.dataset(name))?))
}

fn named<T>(names: Vec<String>, read: impl Fn(&str) -> Result<T>) -> Result<BTreeMap<String, T>> {
    names.into_iter().map(|name| read(&name).map(|value| (name, value))).collect()
}
