//! A checkpoint whose long arrays stay in the file until they are wanted.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::PathBuf;
use std::sync::Arc;

use hdf5::Dataset;

use crate::error::OutputError;
use crate::result_file::damaged;
use crate::state::SolverState;

/// A checkpoint that was read, except for arrays that stay in the file.
#[derive(Clone, Debug, Default)]
pub struct Checkpoint {
    /// What is in memory.
    pub state: SolverState,
    in_file: BTreeMap<String, Dataset>,
    path: PathBuf,
}

impl From<SolverState> for Checkpoint {
    fn from(state: SolverState) -> Self {
        Checkpoint { state, ..Default::default() }
    }
}

impl Checkpoint {
    pub(crate) fn new(state: SolverState, in_file: BTreeMap<String, Dataset>, path: PathBuf) -> Self {
        Checkpoint { state, in_file, path }
    }

    /// The number of values of an array; `None` if the checkpoint has no such array.
    pub fn len_of(&self, name: &str) -> Option<usize> {
        let in_memory = self.state.arrays.get(name).map(|values| values.len());
        in_memory.or_else(|| self.in_file.get(name).map(|array| array.size()))
    }

    /// A range of the values of an array.
    ///
    /// # Errors
    /// [`OutputError::Damaged`] if it cannot be read.
    ///
    /// # Panics
    /// If the range is not in the array.
    pub fn part(&self, name: &str, range: Range<usize>) -> Result<Vec<f64>, OutputError> {
        match self.in_file.get(name) {
            _ if range.is_empty() => Ok(Vec::new()),
            Some(array) => {
                let part = array.read_slice_1d(range).map_err(|error| damaged(&self.path, &error))?;
                Ok(part.to_vec())
            }
            None => Ok(self.state.arrays[name][range].to_vec()),
        }
    }

    /// The whole state in memory.
    ///
    /// # Errors
    /// As [`Self::part`].
    pub fn whole(&self) -> Result<SolverState, OutputError> {
        let mut whole = self.state.clone();
        for (name, array) in &self.in_file {
            whole.arrays.insert(name.clone(), Arc::new(self.part(name, 0..array.size())?));
        }
        Ok(whole)
    }

    /// Takes another `state` in memory. Of the arrays in the file those stay whose names are `kept`, in place of arrays of `state`.
    pub fn replace_state(&mut self, mut state: SolverState, kept: impl Fn(&str) -> bool) {
        self.in_file.retain(|name, _| kept(name));
        state.arrays.retain(|name, _| !self.in_file.contains_key(name));
        self.state = state;
    }

    /// Drops the arrays whose names are not `kept`.
    pub fn retain_arrays(&mut self, kept: impl Fn(&str) -> bool) {
        self.state.arrays.retain(|name, _| kept(name));
        self.in_file.retain(|name, _| kept(name));
    }
}
