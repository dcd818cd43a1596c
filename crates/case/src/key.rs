//! The path of a key in the document.

use std::fmt;

/// One step into the document.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Step {
    /// A key of a table.
    Name(String),
    /// An entry of an array, from 0.
    Entry(usize),
}

/// A path such as `motion.boundary.left.displacement[1]`. The empty path is the whole document.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Key(pub(super) Vec<Step>);

impl Key {
    /// The path `a.b.c` of plain names.
    pub(super) fn new(path: &str) -> Self {
        Key(path.split('.').map(|name| Step::Name(name.to_owned())).collect())
    }

    /// The key `name` of the table at this path.
    pub(super) fn child(&self, name: &str) -> Self {
        self.step(Step::Name(name.to_owned()))
    }

    /// Entry `index` of the array at this path.
    pub(super) fn entry(&self, index: usize) -> Self {
        self.step(Step::Entry(index))
    }

    /// The key of the table or list around this one.
    pub(super) fn parent(&self) -> Self {
        Key(self.0[..self.0.len().saturating_sub(1)].to_vec())
    }

    /// The key at `path` from this one, such as `cells.side`, or `cells.0` for an entry of an array.
    pub(super) fn descendant(&self, path: &str) -> Self {
        path.split('.').fold(self.clone(), |key, name| match name.parse() {
            Ok(index) => key.entry(index),
            Err(_) => key.child(name),
        })
    }

    fn step(&self, step: Step) -> Self {
        Key(self.0.iter().cloned().chain([step]).collect())
    }
}

impl fmt::Display for Key {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, step) in self.0.iter().enumerate() {
            match step {
                Step::Name(name) if name.contains(char::is_control) => write!(f, ".{name:?}")?,
                Step::Name(name) if i == 0 => write!(f, "{name}")?,
                Step::Name(name) => write!(f, ".{name}")?,
                Step::Entry(index) => write!(f, "[{index}]")?,
            }
        }
        Ok(())
    }
}
