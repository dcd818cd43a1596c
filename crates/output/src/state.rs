//! The solver state: everything a restart needs beyond the case, in names and numbers.

use std::collections::BTreeMap;

use hdf5::{Error, File, Group, Result};

use crate::checksum::Checksum;
use crate::hdf::{constant, read_integer, read_numbers, read_text, write_integer, write_text};

/// What a restart needs. What the names mean is the solver's affair; here they are stored bit by bit.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SolverState {
    /// Arrays, for instance the flow coefficients of the last slab. Names without `/`.
    pub arrays: BTreeMap<String, Vec<f64>>,
    /// Counters, for instance the number of slabs done.
    pub integers: BTreeMap<String, i64>,
    /// Anything else. Texts without zero bytes.
    pub texts: BTreeMap<String, String>,
}

impl SolverState {
    /// Checksum of all names and values.
    pub fn checksum(&self) -> Checksum {
        let sum = Checksum::default();
        let sum = self.arrays.iter().fold(sum, |sum, (name, values)| sum.text(name).numbers(values));
        let sum = self.integers.iter().fold(sum, |sum, (name, &value)| sum.text(name).word(value as u64));
        self.texts.iter().fold(sum, |sum, (name, text)| sum.text(name).text(text))
    }
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
    state.texts.iter().try_for_each(|(name, text)| write_text(&texts, name, text))?;
    write_text(&group, "checksum", &state.checksum().to_string())
}

/// Reads the state in the group `parent` and compares its checksum.
pub(crate) fn read(file: &File, parent: &Group) -> Result<SolverState> {
    let group = parent.group("state")?;
    let (arrays, integers, texts) = (group.group("arrays")?, group.group("integers")?, group.group("texts")?);
    let state = SolverState {
        arrays: named(arrays.member_names()?, |name| read_numbers(file, &arrays.dataset(name)?))?,
        integers: named(integers.attr_names()?, |name| read_integer(&integers, name))?,
        texts: named(texts.attr_names()?, |name| read_text(&texts, name))?,
    };
    let (expected, found) = (read_text(&group, "checksum")?, state.checksum().to_string());
    if found == expected {
        Ok(state)
    } else {
        Err(Error::from(format!("the solver state has checksum {found}, {expected} was written")))
    }
}

fn named<T>(names: Vec<String>, read: impl Fn(&str) -> Result<T>) -> Result<BTreeMap<String, T>> {
    names.into_iter().map(|name| read(&name).map(|value| (name, value))).collect()
}
