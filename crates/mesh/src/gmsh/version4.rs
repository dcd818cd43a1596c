//! Entities, nodes and elements of version 4.1.

use super::GmshError;
use super::file::{Element, kind};
use super::source::Source;
use std::collections::BTreeMap;

/// The physical groups of each geometric entity, by dimension and number.
pub(super) type Entities = BTreeMap<(i64, i64), Vec<i64>>;

/// `$Entities`: the numbers of points, curves, surfaces and volumes, then each of them. An entity has a number, a
/// position or bounding box, physical groups, and, except for points, the entities of its boundary.
pub(super) fn entities(source: &mut Source) -> Result<Entities, GmshError> {
    all_entities(source, false)
}

/// `$PartitionedEntities`: the numbers of partitions and of ghost entities, and each ghost entity with its partition. Then follows the same as in
/// `$Entities`, but after its number an entity has the dimension and number of the divided entity, and partitions.
pub(super) fn partitioned_entities(source: &mut Source) -> Result<Entities, GmshError> {
    source.size("the number of partitions")?;
    for _ in 0..source.size("the number of ghost entities")? {
        source.int("the number of a ghost entity")?;
        source.int("the partition of a ghost entity")?;
    }
    all_entities(source, true)
}

fn all_entities(source: &mut Source, are_parts: bool) -> Result<Entities, GmshError> {
    let mut counts = [0; 4];
    for count in &mut counts {
        *count = source.size("the number of points, curves, surfaces or volumes")?;
    }
    let mut entities = Entities::new();
    for (dimension, count) in (0..).zip(counts) {
        for _ in 0..count {
            let number = source.int("the number of an entity")?;
            if are_parts {
                source.int("the dimension of a divided entity")?;
                source.int("the number of a divided entity")?;
                integers(source, "the partitions of an entity")?;
            }
            for _ in 0..if dimension == 0 { 1 } else { 2 } {
                source.point("the position or bounding box of an entity")?;
            }
            let groups = integers(source, "the physical groups of an entity")?;
            if dimension > 0 {
                integers(source, "the boundary of an entity")?;
            }
            entities.insert((dimension, number), groups.into_iter().map(i64::abs).collect());
        }
    }
    Ok(entities)
}

/// A list of integers after its length.
fn integers(source: &mut Source, what: &str) -> Result<Vec<i64>, GmshError> {
    let count = source.size(what)?;
    (0..count).map(|_| source.int(what)).collect()
}

/// `$Nodes`: the numbers of blocks and of nodes, smallest and largest node number; then the blocks. A block has the
/// dimension and number of the entity, a flag for parameters after the positions, the number of nodes, their numbers
/// and positions.
pub(super) fn nodes(source: &mut Source) -> Result<BTreeMap<u64, [f64; 3]>, GmshError> {
    let blocks = header(source, "the numbers of blocks and nodes")?;
    let mut nodes = BTreeMap::new();
    for _ in 0..blocks {
        let dimension = source.int("the dimension of an entity")?;
        source.int("the number of an entity")?;
        let parametric = source.int("0 or 1, for nodes with parameters")?;
        let count = source.size("the number of nodes in a block")?;
        let number = |_| -> Result<_, GmshError> { Ok((source.mark(), source.size("the number of a node")?)) };
        let numbers = (0..count).map(number).collect::<Result<Vec<_>, GmshError>>()?;
        for (mark, number) in numbers {
            let position = source.position_of_node()?;
            source.once("node", number, mark, nodes.insert(number, position).is_none())?;
            for _ in 0..if parametric == 0 { 0 } else { dimension } {
                source.real("a parameter of a node")?;
            }
        }
    }
    Ok(nodes)
}

/// `$Elements`: the numbers of blocks and of elements, smallest and largest element number; then the blocks. A block
/// has the dimension and number of the entity, the type, the number of elements, and the number and nodes of each.
pub(super) fn elements(source: &mut Source, entities: &Entities) -> Result<Vec<Element>, GmshError> {
    let blocks = header(source, "the numbers of blocks and elements")?;
    let mut elements = Vec::new();
    for _ in 0..blocks {
        let entity = (source.int("the dimension of an entity")?, source.int("the number of an entity")?);
        let groups = entities.get(&entity).cloned().unwrap_or_default();
        let kind = kind(source)?;
        for _ in 0..source.size("the number of elements in a block")? {
            let number = source.size("the number of an element")?;
            let nodes =
                (0..kind.n_nodes()).map(|_| source.size("a node of an element")).collect::<Result<_, GmshError>>()?;
            elements.push(Element { number, kind, groups: groups.clone(), nodes });
        }
    }
    Ok(elements)
}

/// Four numbers. Only the first is needed, the number of blocks.
fn header(source: &mut Source, what: &str) -> Result<u64, GmshError> {
    let blocks = source.size(what)?;
    for _ in 0..3 {
        source.size(what)?;
    }
    Ok(blocks)
}
