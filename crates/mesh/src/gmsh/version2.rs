//! Nodes and elements of version 2.2.

use super::GmshError;
use super::element::Kind;
use super::file::{Element, kind, text_count};
use super::source::{Encoding, Source};
use std::collections::BTreeMap;

/// `$Nodes`: their number as text, then number and position of each.
pub(super) fn nodes(source: &mut Source) -> Result<BTreeMap<u64, [f64; 3]>, GmshError> {
    let mut nodes = BTreeMap::new();
    for _ in 0..text_count(source, "the number of nodes")? {
        let mark = source.mark();
        let number = unsigned(source, "the number of a node")?;
        let position = source.position_of_node()?;
        source.once("node", number, mark, nodes.insert(number, position).is_none())?;
    }
    Ok(nodes)
}

/// `$Elements`: their number as text. A text file then has number, type, number of tags, tags and nodes of each
/// element. A binary file has blocks of one type: type, number of elements, number of tags, then number, tags and nodes
/// of each.
pub(super) fn elements(source: &mut Source) -> Result<Vec<Element>, GmshError> {
    let count = text_count(source, "the number of elements")?;
    let mut elements = Vec::new();
    while (elements.len() as u64) < count {
        if source.encoding == Encoding::Text {
            let number = unsigned(source, "the number of an element")?;
            let kind = kind(source)?;
            let tags = unsigned(source, "the number of tags of an element")?;
            elements.push(element(source, number, kind, tags)?);
        } else {
            let kind = kind(source)?;
            let block = unsigned(source, "the number of elements of a block")?;
            let tags = unsigned(source, "the number of tags of an element")?;
            for _ in 0..block {
                let number = unsigned(source, "the number of an element")?;
                elements.push(element(source, number, kind, tags)?);
            }
        }
    }
    Ok(elements)
}

/// Tags and nodes of an element. The first tag is the physical group: 0 if there is none, negative if the group has the
/// opposite orientation.
fn element(source: &mut Source, number: u64, kind: Kind, tags: u64) -> Result<Element, GmshError> {
    let mut groups = Vec::new();
    for tag in 0..tags {
        let value = source.int("a tag of an element")?;
        if tag == 0 && value != 0 {
            groups.push(value.abs());
        }
    }
    let nodes = (0..kind.n_nodes()).map(|_| unsigned(source, "a node of an element")).collect::<Result<_, _>>()?;
    Ok(Element { number, kind, groups, nodes })
}

/// An `int` that is not negative.
fn unsigned(source: &mut Source, what: &str) -> Result<u64, GmshError> {
    let mark = source.mark();
    let number = source.int(what)?;
    let wrong = |_| GmshError::Syntax {
        place: source.place_at(mark),
        expected: what.to_owned(),
        found: format!("the number {number}"),
    };
    u64::try_from(number).map_err(wrong)
}
