//! The sections of a file and their contents.

use super::element::Kind;
use super::source::{Encoding, Source};
use super::{GmshError, foreign, version2, version4};
use std::collections::BTreeMap;

/// The contents of a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct File {
    /// Names of physical groups, by dimension and number.
    pub(super) names: BTreeMap<(usize, i64), String>,
    /// Positions by node number.
    pub(super) nodes: BTreeMap<u64, [f64; 3]>,
    pub(super) elements: Vec<Element>,
    /// Whether the geometry has volumes, even without elements. Only files of version 4 tell.
    pub(super) volumes: bool,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) struct Element {
    pub(super) number: u64,
    pub(super) kind: Kind,
    /// The physical groups that the element belongs to.
    pub(super) groups: Vec<i64>,
    /// Node numbers, as many as the kind has nodes.
    pub(super) nodes: Vec<u64>,
}

impl File {
    /// The positions of the nodes of `element`, in the order of the file.
    pub(super) fn positions<const D: usize>(&self, element: &Element) -> Result<Vec<[f64; D]>, GmshError> {
        let position = |&node: &u64| match self.nodes.get(&node) {
            Some(position) => Ok(std::array::from_fn(|i| position[i])),
            None => Err(GmshError::NoNode { element: element.number, node }),
        };
        element.nodes.iter().map(position).collect()
    }

    /// The name of a physical group, or else its number.
    pub(super) fn name(&self, dimension: usize, group: i64) -> String {
        self.names.get(&(dimension, group)).cloned().unwrap_or_else(|| group.to_string())
    }
}

/// The two layouts of nodes and elements.
#[derive(Clone, Copy)]
enum Version {
    Two,
    Four,
}

pub(super) fn read(bytes: &[u8]) -> Result<File, GmshError> {
    if let Some(format) = foreign::format(bytes) {
        return Err(GmshError::Format { format });
    }
    let mut source = Source::new(bytes);
    let version = format(&mut source)?;
    let mut file = File::default();
    let mut entities = version4::Entities::default();
    let mut seen = Vec::new();
    loop {
        let mark = source.mark();
        let Some(header) = section(&mut source)? else { break };
        if seen.contains(&header) {
            return Err(GmshError::SecondSection { place: source.place_at(mark), section: header.to_owned() });
        }
        match (header, version) {
            ("PhysicalNames", _) => file.names = physical_names(&mut source)?,
            ("Entities", Version::Four) => entities.extend(version4::entities(&mut source)?),
            ("PartitionedEntities", Version::Four) => entities.extend(version4::partitioned_entities(&mut source)?),
            ("Nodes", Version::Two) => file.nodes = version2::nodes(&mut source)?,
            ("Nodes", Version::Four) => file.nodes = version4::nodes(&mut source)?,
            ("Elements", Version::Two) => file.elements = version2::elements(&mut source)?,
            ("Elements", Version::Four) => file.elements = version4::elements(&mut source, &entities)?,
            _ => {
                source.skip_past(&format!("$End{header}"))?;
                continue;
            }
        }
        source.expect_line(&format!("$End{header}"))?;
        seen.push(header);
    }
    match ["Nodes", "Elements"].into_iter().find(|section| !seen.contains(section)) {
        Some(section) => Err(GmshError::NoSection { section }),
        None => Ok(File { volumes: entities.keys().any(|&(dimension, _)| dimension == 3), ..file }),
    }
}

/// The name of the section that begins next, `None` at the end of the file.
fn section<'a>(source: &mut Source<'a>) -> Result<Option<&'a str>, GmshError> {
    let before = source.unexpected("the beginning of a section, such as $Nodes");
    match source.line()?.map(|line| line.strip_prefix('$')) {
        None => Ok(None),
        Some(Some(name)) => Ok(Some(name)),
        Some(None) => Err(before),
    }
}

/// `$MeshFormat`: version, 0 for text or 1 for binary, size of a real. A binary file then has the number 1, which gives
/// the byte order.
fn format(source: &mut Source) -> Result<Version, GmshError> {
    // Comments may stand before it.
    while source.is_next("$Comments") {
        source.skip_past("$EndComments")?;
    }
    source.expect_line("$MeshFormat")?;
    let place = source.place();
    let expected = source.unexpected("a version, 0 (text) or 1 (binary), and 8 (bytes of a real)");
    let line = source.line()?.unwrap_or_default();
    let [version, binary, size] = line.split_whitespace().collect::<Vec<_>>()[..] else { return Err(expected) };
    if size != "8" || !["0", "1"].contains(&binary) {
        return Err(expected);
    }
    let version = match version {
        "2" | "2.0" | "2.1" | "2.2" => Version::Two,
        "4.1" => Version::Four,
        _ => return Err(GmshError::Version { place, version: version.to_owned() }),
    };
    if binary == "1" {
        source.encoding = byte_order(source)?;
    }
    source.expect_line("$EndMeshFormat")?;
    Ok(version)
}

fn byte_order(source: &mut Source) -> Result<Encoding, GmshError> {
    source.encoding = Encoding::LittleEndian;
    let wrong = source.unexpected("the number 1 in four bytes, to tell the order of bytes");
    match source.int("the number 1 in four bytes, to tell the order of bytes")? {
        1 => Ok(Encoding::LittleEndian),
        0x0100_0000 => Ok(Encoding::BigEndian),
        _ => Err(wrong),
    }
}

/// `$PhysicalNames`, text in every file: the number of names, then lines with dimension, number, "name".
fn physical_names(source: &mut Source) -> Result<BTreeMap<(usize, i64), String>, GmshError> {
    let mut names = BTreeMap::new();
    let count = text_count(source, "the number of physical names")?;
    for _ in 0..count {
        let mark = source.mark();
        let expected = source.unexpected("dimension, number and \"name\" of a physical group");
        let line = source.line()?.unwrap_or_default();
        let (key, name) = physical_name(line).ok_or(expected)?;
        source.once("physical group", key.1.unsigned_abs(), mark, names.insert(key, name).is_none())?;
    }
    Ok(names)
}

fn physical_name(line: &str) -> Option<((usize, i64), String)> {
    let (numbers, name) = line.split_once('"')?;
    let mut numbers = numbers.split_whitespace();
    let (dimension, number) = (numbers.next()?.parse().ok()?, numbers.next()?.parse().ok()?);
    Some(((dimension, number), name.strip_suffix('"')?.to_owned()))
}

/// A number on a line of its own, text in every file.
pub(super) fn text_count(source: &mut Source, what: &str) -> Result<u64, GmshError> {
    let expected = source.unexpected(what);
    source.line()?.and_then(|line| line.parse().ok()).ok_or(expected)
}

/// The next kind of elements in the file.
pub(super) fn kind(source: &mut Source) -> Result<Kind, GmshError> {
    let mark = source.mark();
    let code = source.int("the type of an element")?;
    Kind::from_code(code).map_err(|kind| GmshError::Element { place: source.place_at(mark), code, kind })
}
