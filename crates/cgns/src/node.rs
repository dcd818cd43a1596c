//! The tree of a file: groups with a name, a label and perhaps an array.

use crate::CgnsError;
use hdf5::types::{FixedAscii, TypeDescriptor};
use hdf5::{Dataset, File, Group, H5Type, LocationType};
use std::path::Path;

/// The data set of a node.
const DATA: &str = " data";

/// Deflate shrinks data at most by about this factor.
const COMPRESSION: u64 = 1100;

/// A node of the tree.
pub(crate) struct Node {
    group: Group,
    /// The name, unique among the children of a node.
    pub(crate) name: String,
    /// The names from the root.
    pub(crate) path: String,
    pub(crate) label: String,
    /// The length of the file in bytes.
    length: u64,
}

/// The root of the file at `path`.
pub(crate) fn root(path: &Path) -> Result<Node, CgnsError> {
    let length = std::fs::metadata(path).map_err(|error| CgnsError::Read(error.to_string()))?.len();
    let group = File::open(path).and_then(|file| file.group("/"));
    let group = group.map_err(|error| CgnsError::damaged("/", &error))?;
    Ok(Node { group, name: String::new(), path: String::new(), label: String::new(), length })
}

impl Node {
    /// The children in the order of their names.
    pub(crate) fn children(&self) -> Result<Vec<Node>, CgnsError> {
        let mut names = self.group.member_names().map_err(|error| CgnsError::damaged(&self.path, &error))?;
        // Names that begin with a blank belong to the node itself.
        names.retain(|name| !name.starts_with(' '));
        names.sort_unstable();
        names.into_iter().filter_map(|name| self.open(name).transpose()).collect()
    }

    /// The child `name`; `None` if it is not a node of CGNS: other programs may add groups.
    fn open(&self, name: String) -> Result<Option<Node>, CgnsError> {
        let path = format!("{}/{name}", self.path);
        let read = || {
            if self.group.loc_type_by_name(&name)? != LocationType::Group {
                return Ok(None);
            }
            let group = self.group.group(&name)?;
            // A list of the attributes would panic at some damaged bytes.
            let texts = ["name", "type", "label"].map(|attribute| text_attribute(&group, attribute));
            match texts {
                [Err(_), Err(_), Err(_)] => Ok(None),
                [_, kind, label] => Ok(Some((group, kind?, label?))),
            }
        };
        match read().map_err(|error| CgnsError::damaged(&path, &error))? {
            None => Ok(None),
            Some((_, kind, _)) if kind == "LK" => {
                let problem = "this is a link to another node or file: expand all links by `cgnsconvert -h -l`";
                Err(CgnsError::at(path, problem))
            }
            Some((group, _, label)) => Ok(Some(Node { group, name, path, label, length: self.length })),
        }
    }

    /// The children with the label `label`.
    pub(crate) fn of_label(&self, label: &str) -> Result<Vec<Node>, CgnsError> {
        Ok(self.children()?.into_iter().filter(|child| child.label == label).collect())
    }

    /// The first child with the label `label`.
    pub(crate) fn first(&self, label: &str) -> Result<Option<Node>, CgnsError> {
        Ok(self.of_label(label)?.into_iter().next())
    }

    /// The child `name`.
    pub(crate) fn child(&self, name: &str) -> Result<Option<Node>, CgnsError> {
        if self.group.link_exists(name) { self.open(name.to_owned()) } else { Ok(None) }
    }

    /// The child `name`, which must exist.
    pub(crate) fn required(&self, name: &str) -> Result<Node, CgnsError> {
        self.child(name)?.ok_or_else(|| self.error(format!("it has no child {name}")))
    }

    /// The text of the child with the label `label`.
    pub(crate) fn text_of(&self, label: &str) -> Result<Option<String>, CgnsError> {
        self.first(label)?.map(|child| child.text()).transpose()
    }

    /// The array of characters as a text.
    pub(crate) fn text(&self) -> Result<String, CgnsError> {
        let bytes: Vec<i8> = self.array("a text of characters", |kind| {
            matches!(kind, TypeDescriptor::Integer(size) | TypeDescriptor::Unsigned(size) if *size as usize == 1)
        })?;
        let bytes: Vec<u8> = bytes.into_iter().map(|byte| byte as u8).take_while(|&byte| byte != 0).collect();
        Ok(String::from_utf8_lossy(&bytes).trim().to_owned())
    }

    /// The array of integers, in the order of the file: the first index of CGNS fastest.
    pub(crate) fn integers(&self) -> Result<Vec<i64>, CgnsError> {
        self.array("an array of integers", |kind| {
            matches!(kind, TypeDescriptor::Integer(_) | TypeDescriptor::Unsigned(_))
        })
    }

    /// The array of integers, which must have `N` entries.
    pub(crate) fn numbers<const N: usize>(&self) -> Result<[i64; N], CgnsError> {
        let found = self.integers()?;
        let length = found.len();
        found.try_into().map_err(|_| self.error(format!("it has {length} numbers, expected {N}")))
    }

    /// The array of reals.
    pub(crate) fn reals(&self) -> Result<Vec<f64>, CgnsError> {
        self.array("an array of reals", |kind| matches!(kind, TypeDescriptor::Float(_)))
    }

    /// An error at this node.
    pub(crate) fn error(&self, problem: impl Into<String>) -> CgnsError {
        CgnsError::at(&self.path, problem)
    }

    /// The array, whose type must be accepted.
    fn array<T: H5Type>(&self, what: &str, accepts: impl Fn(&TypeDescriptor) -> bool) -> Result<Vec<T>, CgnsError> {
        let damaged = |error| CgnsError::damaged(&self.path, &error);
        if !self.group.link_exists(DATA) {
            return Err(self.error(format!("it has no data, expected {what}")));
        }
        let data = self.group.dataset(DATA).map_err(damaged)?;
        let kind = data.dtype().and_then(|kind| kind.to_descriptor()).map_err(damaged)?;
        if !accepts(&kind) {
            return Err(self.error(format!("expected {what}, found data of type {kind:?}")));
        }
        if !self.fits::<T>(&data, kind.size()) {
            return Err(self.error(format!("its shape, {:?}, is too large for the file", data.shape())));
        }
        data.read_raw().map_err(damaged)
    }

    /// Whether an array may be in the file, and fits into memory. Lengths in damaged files may be anything.
    fn fits<T>(&self, data: &Dataset, size: usize) -> bool {
        let longest = if data.is_chunked() { self.length.saturating_mul(COMPRESSION) } else { self.length };
        let count = data.shape().into_iter().try_fold(1_usize, usize::checked_mul);
        count.is_some_and(|count| {
            let in_file = (count as u64).checked_mul(size as u64).is_some_and(|bytes| bytes <= longest);
            in_file && Vec::<T>::new().try_reserve_exact(count).is_ok()
        })
    }
}

/// A text in an attribute of fixed length.
fn text_attribute(group: &Group, name: &str) -> hdf5::Result<String> {
    let value: FixedAscii<64> = group.attr(name)?.read_scalar()?;
    Ok(String::from_utf8_lossy(value.as_bytes()).trim_end_matches('\0').to_owned())
}
