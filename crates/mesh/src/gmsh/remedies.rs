//! The second halves of messages: the settings of Gmsh, and of a case, that help.

use crate::MeshError;

/// Triangles, tetrahedra or prisms.
pub(super) fn simplices(dimension: usize) -> &'static str {
    match dimension {
        2 => {
            "make quadrilaterals in Gmsh, by `Mesh.RecombineAll = 1` with `Mesh.SubdivisionAlgorithm = 1`; or set `mesh.split_simplices = true` in the case, which splits each \
             triangle into 3 quadrilaterals"
        }
        _ => {
            "make hexahedra in Gmsh, by `Mesh.SubdivisionAlgorithm = 2`, or by `Mesh.RecombineAll = 1` with \
             `Mesh.SubdivisionAlgorithm = 1` and extrusion with `Recombine`; or set `mesh.split_simplices = true` in \
             the case, which splits each tetrahedron into 4 and each prism into 3 hexahedra"
        }
    }
}

/// A file with the given numbers of elements of surfaces and volumes is no mesh.
pub(super) fn dimension(surface: usize, volume: usize) -> &'static str {
    match surface + volume {
        0 => {
            "; if there are physical groups, Gmsh saves no other elements: give the cells one too, as by \
             `Physical Surface(\"fluid\") = {1};` or `Physical Volume(\"fluid\") = {1};`"
        }
        _ => "",
    }
}

/// An inverted cell.
pub(super) fn cell(degree: usize) -> &'static str {
    match degree {
        0 | 1 => "",
        _ => {
            "; optimise the curved cells in Gmsh, by `Mesh.HighOrderOptimize = 2` or `gmsh.model.mesh.optimize(\"HighOrder\")`, \
             refine the mesh near the curve, or save straight cells, `Mesh.ElementOrder = 1`"
        }
    }
}

/// Surfaces that do not lie at constant z, in one plane or not.
pub(super) fn not_plane(tilted: bool) -> &'static str {
    match tilted {
        true => {
            ": all nodes lie in another plane; rotate it into the x-y plane, as by `Rotate` in Gmsh, or, for a mesh in three \
             dimensions, name its cells, by `Physical Volume(\"fluid\") = Volume{:};`"
        }
        false => {
            ": the file has surfaces that do not lie in one plane, and no volumes, as of a mesh in three dimensions without a \
             physical volume; name its cells in Gmsh, by `Physical Volume(\"fluid\") = Volume{:};`, and mesh it by `gmsh -3`, \
             because Gmsh saves only elements of physical groups, if there are any"
        }
    }
}

/// A face that is listed in two boundaries, or that lies inside of the mesh.
pub(super) fn listed(dimension: usize, error: &MeshError) -> String {
    let (group, cells) = groups(dimension);
    let what = group.to_lowercase();
    match error {
        MeshError::TwoBoundaries { .. } => format!("leave it in one `Physical {group}`, so that it has one name"),
        _ => format!(
            "take the {what} inside of the mesh out of `Physical {group}`, or put the cells on its two sides into different \
             groups `Physical {cells}`"
        ),
    }
}

/// The physical groups that name boundaries and cells.
fn groups(dimension: usize) -> (&'static str, &'static str) {
    if dimension == 2 { ("Curve", "Surface") } else { ("Surface", "Volume") }
}

/// A side without a neighbour and without a name. The file may name boundaries, and its geometry may have volumes.
pub(super) fn unnamed(dimension: usize, named: bool, volumes: bool) -> String {
    let remedy = name_it(dimension, named);
    match volumes && dimension == 2 {
        true => format!(
            "{remedy}; or, because the geometry has volumes: a mesh in three dimensions needs a name for its cells, as by \
             `Physical Volume(\"fluid\") = Volume{{:}};`"
        ),
        false => remedy,
    }
}

/// The group that a side without a name needs, in a file with or without names of boundaries.
fn name_it(dimension: usize, named: bool) -> String {
    let (group, cells) = groups(dimension);
    let what = group.to_lowercase();
    match named {
        false => format!(
            "the file has no physical {what}: give every boundary a name in Gmsh, as by `Physical {group}(\"wall\") = \
             {{1, 2}};`, and the cells one, `Physical {cells}(\"fluid\") = {{1}};`"
        ),
        true => format!(
            "put it into a physical {what} in Gmsh, as by `Physical {group}(\"wall\") = {{1, 2}};`, or, if it lies inside of the mesh, \
             join the two sides by `Coherence`"
        ),
    }
}
