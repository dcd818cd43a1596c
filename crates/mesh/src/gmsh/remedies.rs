//! The second halves of messages: the settings of Gmsh, and of a case, that help.

/// Triangles, tetrahedra or prisms.
pub(super) fn simplices(dimension: usize) -> &'static str {
    match dimension {
        2 => {
            "make quadrilaterals in Gmsh, by `Mesh.RecombineAll = 1` with `Mesh.RecombinationAlgorithm = 3`, or by \
             `Mesh.SubdivisionAlgorithm = 1`; or set `mesh.split_simplices = true` in the case, which splits each \
             triangle into 3 quadrilaterals"
        }
        _ => {
            "make hexahedra in Gmsh, by `Mesh.SubdivisionAlgorithm = 2`, or by `Mesh.RecombineAll = 1` with \
             `Mesh.RecombinationAlgorithm = 3` and extrusion with `Recombine`; or set `mesh.split_simplices = true` in \
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

/// A side without a neighbour and without a name, in a file with or without names of boundaries.
pub(super) fn unnamed(dimension: usize, named: bool) -> String {
    let (group, cells) = if dimension == 2 { ("Curve", "Surface") } else { ("Surface", "Volume") };
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
