//! Errors of meshes.

use thiserror::Error;

/// Why a mesh is refused. Cells are counted from 0; faces are 2 axis + side in the reference cell.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum MeshError {
    /// The order is outside 2..=16.
    #[error("order {order} of the mesh is not supported: choose 2 to 16 nodes per direction")]
    Order {
        /// The requested order.
        order: usize,
    },
    /// An array does not have the length that the other arrays imply.
    #[error("{array} has {found} entries, expected {expected}")]
    Length {
        /// Which array.
        array: &'static str,
        /// Its length.
        found: usize,
        /// The length that the order and the number of cells imply.
        expected: usize,
    },
    /// A node is infinite or not a number.
    #[error("cell {cell} has a coordinate that is not a finite number: {value}")]
    NotFinite {
        /// The cell.
        cell: usize,
        /// The coordinate.
        value: f64,
    },
    /// A number that the box generator does not accept.
    #[error("box mesh: {quantity} along axis {axis} is {value}, expected {accepted}")]
    Box {
        /// The name of the quantity.
        quantity: &'static str,
        /// The axis.
        axis: usize,
        /// Its value.
        value: f64,
        /// The accepted values.
        accepted: &'static str,
    },
    /// A number that another generator does not accept.
    #[error("{mesh} mesh: {quantity} is {value}, expected {accepted}")]
    Parameter {
        /// The generator.
        mesh: &'static str,
        /// The name of the quantity.
        quantity: &'static str,
        /// Its value.
        value: f64,
        /// The accepted values.
        accepted: &'static str,
    },
    /// Points of a curve are closer than rounding can tell.
    #[error(
        "closed curve mesh: the points {first:?} and {second:?} follow each other at a distance of {distance:e}, far less than those \
         beside it: leave one of them out"
    )]
    ClosePoints {
        /// A point.
        first: [f64; 2],
        /// The next one.
        second: [f64; 2],
        /// Their distance.
        distance: f64,
    },
    /// The reference map of a cell is not orientation-preserving everywhere.
    #[error(
        "cell {cell} is inverted: det J = {determinant:e} at reference point {reference:?}, position {position:?} \
         (its sides cross, it is flat, or it is too strongly curved)"
    )]
    Inverted {
        /// The cell.
        cell: usize,
        /// The reference point, in [-1, 1]^D.
        reference: Vec<f64>,
        /// The physical point.
        position: Vec<f64>,
        /// The Jacobian determinant there.
        determinant: f64,
    },
    /// The determinant is so close to zero that its sign cannot be proved.
    #[error("cell {cell} is degenerate: det J >= {lower:e} is all that can be proved, smallest value seen {sampled:e}")]
    Degenerate {
        /// The cell.
        cell: usize,
        /// The proved lower bound of det J.
        lower: f64,
        /// The smallest sampled det J.
        sampled: f64,
    },
    /// More than two cells share a face, or two cells share its vertices in an impossible order.
    #[error("face {face} of cell {cell} is not manifold: it has the vertices of {count} cells' faces, at {position:?}")]
    NonManifold {
        /// One of the cells.
        cell: usize,
        /// Its face.
        face: usize,
        /// The number of faces with these vertices.
        count: usize,
        /// Centre of the face.
        position: Vec<f64>,
    },
    /// A face belongs to one cell only and to no boundary.
    #[error(
        "face {face} of cell {cell} at {position:?} has no neighbour and belongs to no boundary: \
         a boundary without a name, nodes that are there twice, or a cell whose corners are not in order"
    )]
    Unnamed {
        /// The cell.
        cell: usize,
        /// Its face.
        face: usize,
        /// Centre of the face.
        position: Vec<f64>,
    },
    /// A face with a neighbour is listed in a boundary.
    #[error("face {face} of cell {cell} at {position:?} is listed in boundary \"{name}\" but has a neighbour")]
    Inside {
        /// The cell.
        cell: usize,
        /// Its face.
        face: usize,
        /// The boundary.
        name: String,
        /// Centre of the face.
        position: Vec<f64>,
    },
    /// Two curved faces have the same corners.
    #[error(
        "a face of cell {} at {position:?} and one of cell {} have the same corners, but are not the same face: between any two corners there may be \
         one face, so put more cells there, for instance three around a hole",
        cells[0], cells[1]
    )]
    SameCorners {
        /// The cells.
        cells: [usize; 2],
        /// Centre of the face of the first.
        position: Vec<f64>,
    },
    /// A boundary lists a face that does not exist.
    #[error("boundary \"{name}\" lists face {face} of cell {cell}: there are {cells} cells with {faces} faces each")]
    NoSuchFace {
        /// The boundary.
        name: String,
        /// The cell listed.
        cell: usize,
        /// The face listed.
        face: usize,
        /// Cells in the mesh.
        cells: usize,
        /// Faces per cell.
        faces: usize,
    },
    /// A face belongs to two boundaries, or twice to one.
    #[error("face {face} of cell {cell} is listed in boundary \"{first}\" and in boundary \"{second}\"")]
    TwoBoundaries {
        /// The cell.
        cell: usize,
        /// Its face.
        face: usize,
        /// The boundary that lists it first.
        first: String,
        /// The boundary that lists it again.
        second: String,
    },
    /// Two boundaries have the same name.
    #[error("boundary name \"{name}\" is given twice")]
    NameTwice {
        /// The name.
        name: String,
    },
    /// A boundary of the cross-section has the name of an end of the extruded mesh.
    #[error(
        "boundary \"{name}\" of the cross-section has the name of an end of the extruded mesh: rename it, or extrude with `periodic = true`"
    )]
    NameOfEnd {
        /// The name.
        name: String,
    },
    /// Segments do not fill an axis of a box.
    #[error("box mesh: segment {segment} along axis {axis} {problem}")]
    Segments {
        /// Along which axis.
        axis: usize,
        /// The segment, counted from 0.
        segment: usize,
        /// What is wrong with it, and what is accepted.
        problem: String,
    },
    /// A face of a region goes through cells.
    #[error(
        "region \"{name}\" ends at {value} along axis {axis}, which is not between cells; the nearest line between cells is at {nearest}"
    )]
    Unaligned {
        /// The region.
        name: String,
        /// Along which axis.
        axis: usize,
        /// Where its face is.
        value: f64,
        /// The nearest end of a cell.
        nearest: f64,
    },
    /// A region lists a cell that does not exist.
    #[error("region \"{name}\" lists cell {cell}: there are {cells} cells")]
    NoSuchCell {
        /// The region.
        name: String,
        /// The cell listed.
        cell: usize,
        /// Cells in the mesh.
        cells: usize,
    },
    /// Two regions have the same name.
    #[error("region name \"{name}\" is given twice")]
    RegionTwice {
        /// The name.
        name: String,
    },
    /// A region has no cells.
    #[error("region \"{name}\" has no cells")]
    EmptyRegion {
        /// The region.
        name: String,
    },
    /// A cell is in two regions, and a part of the mesh is to be made of one of them.
    #[error(
        "cell {cell} is in region \"{first}\" and in region \"{second}\": a mesh in parts needs every cell in one region"
    )]
    TwoRegions {
        /// The cell.
        cell: usize,
        /// A region that contains it.
        first: String,
        /// Another one.
        second: String,
    },
    /// The mesh cannot be cut into this many blocks.
    #[error("a mesh of {cells} cells cannot be cut into {count} blocks: choose 1 to {cells}")]
    Blocks {
        /// The requested number of blocks.
        count: usize,
        /// Cells in the mesh.
        cells: usize,
    },
    /// There is no region of that name.
    #[error("the mesh has no region \"{name}\"; its regions are {known:?}")]
    NoRegion {
        /// The name.
        name: String,
        /// The names that exist.
        known: Vec<String>,
    },
    /// Regions leave nothing of the mesh.
    #[error("the regions {names:?} fill the whole mesh: no cell is left outside of them")]
    NothingLeft {
        /// The regions.
        names: Vec<String>,
    },
    /// Two parts of a mesh have no node in common.
    #[error("the regions {first:?} and {second:?} do not touch: they have no node in common")]
    Apart {
        /// The regions of one part.
        first: Vec<String>,
        /// The regions of the other part.
        second: Vec<String>,
    },
    /// A boundary of a part would be both outside and towards another region.
    #[error(
        "boundary \"{name}\" lies on the outside of the mesh, and between two regions: give the facets between regions, or their \
         region, another name"
    )]
    InterfaceName {
        /// The name.
        name: String,
    },
    /// A periodic pair refers to a boundary that does not exist, to one twice, or to one of another pair.
    #[error(
        "periodic pair {pair} refers to boundary {boundary}: expected two different boundaries of 0..{count}, \
         each in one pair"
    )]
    PairBoundary {
        /// Number of the pair.
        pair: usize,
        /// The boundary index.
        boundary: usize,
        /// Number of boundaries.
        count: usize,
    },
    /// Two periodic boundaries do not have the same number of faces.
    #[error("periodic boundaries \"{minus}\" and \"{plus}\" have {minus_faces} and {plus_faces} faces")]
    PairCount {
        /// The first boundary.
        minus: String,
        /// The second boundary.
        plus: String,
        /// Faces of the first.
        minus_faces: usize,
        /// Faces of the second.
        plus_faces: usize,
    },
    /// Two periodic boundaries do not coincide after translation.
    #[error(
        "periodic boundaries \"{minus}\" and \"{plus}\" do not match: the point {position:?} of \"{plus}\" is \
         {distance:e} away from the translated \"{minus}\" (tolerance {tolerance:e})"
    )]
    PeriodicMismatch {
        /// The boundary that is translated.
        minus: String,
        /// The boundary with which it should coincide.
        plus: String,
        /// A point of `plus` that has no counterpart.
        position: Vec<f64>,
        /// Its distance from the nearest candidate.
        distance: f64,
        /// The accepted distance.
        tolerance: f64,
    },
    /// The cells of two periodic boundaries are on the same side of them.
    #[error(
        "periodic boundaries \"{minus}\" and \"{plus}\" face the same way at {position:?}: their cells would overlap; periodic boundaries \
         are opposite ends of a mesh"
    )]
    SameSide {
        /// The boundary that is translated.
        minus: String,
        /// The boundary with which it coincides.
        plus: String,
        /// The centre of a face of `plus`.
        position: Vec<f64>,
    },
    /// The normals of the facets that meet in a node of a boundary cancel.
    #[error("boundary \"{name}\" has no normal at {position:?}: its facets are back to back there, as at a cusp")]
    NoNormal {
        /// The boundary.
        name: String,
        /// The node.
        position: Vec<f64>,
    },
    /// A facet of a boundary is not in a plane normal to an axis.
    #[error("boundary \"{name}\" is not in a plane normal to an axis at {position:?}")]
    NoAxis {
        /// The boundary.
        name: String,
        /// The centre of the facet.
        position: Vec<f64>,
    },
    /// Two neighbours do not have the same nodes on the face between them.
    #[error(
        "cells {minus} and {plus} share the corners of a face but not its curve: nodes at {position:?} are \
         {distance:e} apart (tolerance {tolerance:e})"
    )]
    Gap {
        /// One cell.
        minus: usize,
        /// The other cell.
        plus: usize,
        /// The location, on the face of `plus`.
        position: Vec<f64>,
        /// The distance of the two nodes.
        distance: f64,
        /// The accepted distance.
        tolerance: f64,
    },
}
