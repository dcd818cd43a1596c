//! The solver state: all data besides the case that a restart needs, by names.

use std::collections::BTreeMap;
use std::sync::Arc;

use hdf5::{Group, Result};

use crate::hdf::{constant, read_integer, read_text, write_integer, write_text};

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

/// Replaces the state in the group `parent`. The space of the old one is used again.
pub(crate) fn write(parent: &Group, state: &SolverState) -> Result<()> {
    if parent.link_exists("state") {
        parent.unlink("state")?;
    }
    let group = parent.create_group("state")?;
    let (arrays, integers, texts) =
        (group.create_group("arrays")?, group.create_group("integers")?, group.create_group("texts")?);
    state.arrays.iter().try_for_each(|(name, values)| constant(&arrays, name, values))?;
    state.integers.iter().try_for_each(|(name, &value)| write_integer(&integers, name, value))?;
    state.texts.iter().try_for_each(|(name, text)| write_text(&texts, name, text))
}

/// Reads the state in the group `parent`.
pub(crate) fn read(parent: &Group) -> Result<SolverState> {
    let group = parent.group("state")?;
    let (arrays, integers, texts) = (group.group("arrays")?, group.group("integers")?, group.group("texts")?);
    Ok(SolverState {
        arrays: named(arrays.member_names()?, |name| Ok(Arc::new(arrays.dataset(name)?.read_raw()?)))?,
        integers: named(integers.attr_names()?, |name| read_integer(&integers, name))?,
        texts: named(texts.attr_names()?, |name| read_text(&texts, name))?,
    })
}

fn named<T>(names: Vec<String>, read: impl Fn(&str) -> Result<T>) -> Result<BTreeMap<String, T>> {
    names.into_iter().map(|name| read(&name).map(|value| (name, value))).collect()
}
