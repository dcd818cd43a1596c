//! Files of other programs, recognised by their beginning.

use super::source::without_mark;

/// A file is searched for the keys of SU2 up to this length, in bytes.
const HEADER: usize = 1 << 16;

/// The first bytes of formats, and their names with an article.
const BEGINNINGS: [(&[u8], &str); 10] = [
    (b"\x89HDF\r\n\x1a\n", "an HDF5 file, such as a CGNS mesh or a result of stsolve, and no text"),
    (
        b"@(#)ADF Database Version",
        "a CGNS file in the old format ADF, which `adf2hdf` or `cgnsconvert -h` converts to HDF5",
    ),
    (b"<?xml", "an XML file, such as a mesh of VTK"),
    (b"<VTKFile", "a mesh of VTK"),
    (b"# vtk DataFile", "a mesh of VTK"),
    (b"MeshVersionFormatted", "a mesh of Medit"),
    (b"*HEADING", "a mesh of Abaqus"),
    (b"(0 ", FLUENT),
    (b"(1 ", FLUENT),
    (b"(2 ", FLUENT),
];

/// Its files have the ending of those of Gmsh.
const FLUENT: &str = "a mesh of Fluent";

/// The format of a file that is not Gmsh's, if it is known.
pub(super) fn format(bytes: &[u8]) -> Option<&'static str> {
    let text = bytes.trim_ascii_start();
    let begins = |beginning: &[u8]| {
        let first = text.get(..beginning.len());
        bytes.starts_with(beginning) || first.is_some_and(|first| first.eq_ignore_ascii_case(beginning))
    };
    let known = BEGINNINGS.iter().find(|(beginning, _)| begins(beginning)).map(|(_, name)| *name);
    known.or_else(|| is_su2(bytes).then_some("an SU2 mesh"))
}

/// Whether a file is an SU2 mesh: a text with a line `NDIME= 2`, after comments and perhaps other keys, in capitals or not.
pub fn is_su2(bytes: &[u8]) -> bool {
    let bytes = without_mark(bytes);
    if bytes.trim_ascii_start().starts_with(b"$") {
        return false;
    }
    let mut lines = bytes[..bytes.len().min(HEADER)].split(|&byte| byte == b'\n');
    lines.any(|line| {
        let key = line.split(|&byte| byte == b'=').next().filter(|key| key.len() < line.len());
        key.is_some_and(|key| key.trim_ascii().eq_ignore_ascii_case(b"NDIME"))
    })
}
