//! SU2 meshes: texts with lines `KEY= value`, each followed by its list. Keys may be in capitals or not. `%` begins a comment.
//!
//! Elements of a file have the number of their line, nodes count from 0. A marker becomes a group of dimension D - 1.

use super::element::Kind;
use super::file::{Element, File};
use super::places::Words;
use super::shape::Shape;
use super::source::without_mark;
use super::{FilePosition, GmshError};
use std::borrow::Cow;
use std::str::{FromStr, SplitWhitespace};

/// Keys that do not belong to the mesh: angles of the flow, and periodic transformations of old versions.
const IGNORED: [&str; 7] =
    ["AOA", "AOS", "NPERIODIC", "PERIODIC_INDEX", "PERIODIC_CENTER", "PERIODIC_ROTATION", "PERIODIC_TRANSLATION"];

/// The lines of a file that are not empty without their comments, with their numbers.
struct KeywordLines<'a> {
    rest: std::iter::Peekable<Box<dyn Iterator<Item = (usize, &'a str)> + 'a>>,
    /// The number of the last line of the file.
    end: usize,
}

/// The lists of an SU2 file, as they are read.
#[derive(Default)]
struct Reader {
    dimension: Option<usize>,
    markers: Option<usize>,
    /// The keys that occur once.
    seen: Vec<&'static str>,
    file: File,
}

/// The lists of an SU2 file.
pub(super) fn read(bytes: &[u8]) -> Result<File, GmshError> {
    let text = text(bytes);
    let (mut lines, mut reader) = (KeywordLines::new(&text), Reader::default());
    while let Some((line, text)) = lines.rest.next() {
        let (key, value) = keyword(text).ok_or_else(|| {
            unexpected(line, "a key, such as NELEM= 4 (or the list before is longer than its count)", text)
        })?;
        // Boxes of free-form deformation end a file.
        if key.starts_with("FFD_") {
            break;
        }
        reader.list(line, &key, value, &mut lines)?;
    }
    reader.finish(lines.end)
}

/// The file as text. Letters of another encoding than UTF-8, in a comment perhaps, become replacement characters.
fn text(bytes: &[u8]) -> Cow<'_, str> {
    String::from_utf8_lossy(without_mark(bytes))
}

/// The key of a line `KEY= value` in capitals, because SU2 takes keys in any case, and the value.
fn keyword(text: &str) -> Option<(String, &str)> {
    let (key, value) = text.split_once('=')?;
    Some((key.trim().to_ascii_uppercase(), value.trim()))
}

impl<'a> KeywordLines<'a> {
    fn new(text: &'a str) -> Self {
        let bare = |(index, line): (usize, &'a str)| (index + 1, line.split('%').next().unwrap_or_default().trim());
        let rest: Box<dyn Iterator<Item = _>> =
            Box::new(text.lines().enumerate().map(bare).filter(|(_, line)| !line.is_empty()));
        KeywordLines { rest: rest.peekable(), end: text.lines().count().max(1) }
    }

    /// The words of the next line, which is one of a list.
    fn words(&mut self, what: &str) -> Result<(usize, SplitWhitespace<'a>), GmshError> {
        match self.rest.peek() {
            None => Err(unexpected(self.end, what, "the end of the file")),
            Some(&(line, text)) if text.contains('=') => Err(unexpected(line, what, text)),
            Some(&(line, text)) => {
                self.rest.next();
                Ok((line, text.split_whitespace()))
            }
        }
    }
}

impl Reader {
    /// Reads the value of `key` and the list that follows it.
    fn list(&mut self, line: usize, key: &str, value: &str, lines: &mut KeywordLines) -> Result<(), GmshError> {
        match key {
            "NDIME" => self.dimension(line, value),
            "NELEM" => self.cells(line, value, lines),
            "NPOIN" => self.points(line, value, lines),
            "NMARK" => self.marker_count(line, value),
            "MARKER_TAG" => self.marker(line, value, lines),
            "NZONE" if value == "1" => Ok(()),
            "NZONE" => Err(unexpected(line, "NZONE= 1: save every zone as a file of its own", value)),
            "IZONE" => Ok(()),
            key if IGNORED.contains(&key) => Ok(()),
            key => Err(unexpected(line, "one of the keys NDIME, NELEM, NPOIN, NMARK and MARKER_TAG", key)),
        }
    }

    fn marker_count(&mut self, line: usize, value: &str) -> Result<(), GmshError> {
        self.once(line, "NMARK")?;
        self.markers = Some(number(line, value, "the number of markers")?);
        Ok(())
    }

    fn once(&mut self, line: usize, key: &'static str) -> Result<(), GmshError> {
        if self.seen.contains(&key) {
            return Err(unexpected(line, &format!("one line {key}="), "a second one"));
        }
        self.seen.push(key);
        Ok(())
    }

    fn dimension(&mut self, line: usize, value: &str) -> Result<(), GmshError> {
        self.once(line, "NDIME")?;
        let dimension = number(line, value, "the dimension, 2 or 3")?;
        if ![2, 3].contains(&dimension) {
            return Err(unexpected(line, "the dimension, 2 or 3", value));
        }
        self.dimension = Some(dimension);
        Ok(())
    }

    /// D, which precedes every list.
    fn required_dimension(&self, line: usize) -> Result<usize, GmshError> {
        self.dimension.ok_or_else(|| unexpected(line, "NDIME= before every other key", "a list of unknown dimension"))
    }

    fn cells(&mut self, line: usize, value: &str, lines: &mut KeywordLines) -> Result<(), GmshError> {
        self.once(line, "NELEM")?;
        let dimension = self.required_dimension(line)?;
        let count: u64 = number(line, value, "the number of elements")?;
        if count == 0 {
            return Err(unexpected(line, "the number of elements, 1 or more", value));
        }
        for k in 1..=count {
            let what = format!("element {k} of {count}");
            self.element(dimension, None, lines, &what)?;
        }
        Ok(())
    }

    fn marker(&mut self, line: usize, name: &str, lines: &mut KeywordLines) -> Result<(), GmshError> {
        let dimension = self.required_dimension(line)? - 1;
        let group = self.file.names.len() as i64 + 1;
        self.file.names.insert((dimension, group), name.to_owned());
        let count = marker_elements(name, lines)?;
        for k in 1..=count {
            self.element(dimension, Some(group), lines, &format!("element {k} of {count} of marker {name}"))?;
        }
        Ok(())
    }

    /// An element: its VTK type, its nodes, perhaps its index.
    fn element(
        &mut self,
        dimension: usize,
        group: Option<i64>,
        lines: &mut KeywordLines,
        what: &str,
    ) -> Result<(), GmshError> {
        let (line, mut words) = lines.words(what)?;
        let code = next(line, &mut words, &format!("the VTK type of {what}"))?;
        let shape = shape(code, dimension).map_err(|expected| unexpected(line, expected, &code.to_string()))?;
        let kind = Kind { shape, degree: 1 };
        let node = format!("a node of {what}");
        let nodes = (0..kind.n_nodes()).map(|_| next(line, &mut words, &node)).collect::<Result<_, _>>()?;
        end(line, words).map_err(|error| more_nodes(error, kind.n_nodes()))?;
        self.file.elements.push(Element { number: line as u64, kind, groups: group.into_iter().collect(), nodes });
        Ok(())
    }

    /// The value is the number of points, in old versions followed by that without halos.
    fn points(&mut self, line: usize, value: &str, lines: &mut KeywordLines) -> Result<(), GmshError> {
        self.once(line, "NPOIN")?;
        let dimension = self.required_dimension(line)?;
        let mut counts = value.split_whitespace();
        let count: u64 = next(line, &mut counts, "the number of points")?;
        end(line, counts)?;
        for k in 0..count {
            let position = position(dimension, lines, &format!("point {} of {count}", k + 1))?;
            self.file.nodes.insert(k, position);
        }
        Ok(())
    }

    fn finish(self, end: usize) -> Result<File, GmshError> {
        if let Some(key) = ["NDIME", "NELEM", "NPOIN"].into_iter().find(|key| !self.seen.contains(key)) {
            return Err(unexpected(end, &format!("a line {key}="), "the end of the file"));
        }
        let found = self.file.names.len();
        match self.markers {
            Some(count) if count != found => {
                Err(unexpected(end, &format!("{count} markers, as NMARK says"), &found.to_string()))
            }
            _ => Ok(self.file),
        }
    }
}

/// The number of elements of the marker `name`, in the line below its tag.
fn marker_elements(name: &str, lines: &mut KeywordLines) -> Result<usize, GmshError> {
    let what = format!("MARKER_ELEMS= with the number of elements of marker {name}");
    let (line, text) = lines.rest.next().unwrap_or((lines.end, "the end of the file"));
    let value = keyword(text).filter(|(key, _)| key == "MARKER_ELEMS").map(|(_, value)| value);
    number(line, value.ok_or_else(|| unexpected(line, &what, text))?, &what)
}

/// The coordinates in the next line, perhaps followed by an index; `what` names the point.
fn position(dimension: usize, lines: &mut KeywordLines, what: &str) -> Result<[f64; 3], GmshError> {
    let (line, mut words) = lines.words(what)?;
    let mut position = [0.0; 3];
    for x in &mut position[..dimension] {
        let word = words.next().unwrap_or("the end of the line");
        let finite = word.parse().ok().filter(|x: &f64| x.is_finite());
        *x = finite.ok_or_else(|| unexpected(line, &format!("a coordinate of {what}, a finite number"), word))?;
    }
    end(line, words)?;
    Ok(position)
}

/// The shapes of SU2 and their VTK types.
const SHAPES: [(u64, Shape); 6] = [
    (3, Shape::Line),
    (5, Shape::Triangle),
    (9, Shape::Quadrilateral),
    (10, Shape::Tetrahedron),
    (12, Shape::Hexahedron),
    (13, Shape::Prism),
];

/// The shape with the VTK type `code`, or the types that are accepted.
fn shape(code: u64, dimension: usize) -> Result<Shape, &'static str> {
    let found = SHAPES.iter().find(|(known, shape)| *known == code && shape.dimension() == dimension);
    found.map(|(_, shape)| *shape).ok_or(match dimension {
        1 => "the VTK type 3 (a line)",
        2 => "the VTK type 9 (a quadrilateral) or, to be split, 5 (a triangle)",
        _ => "the VTK type 12 (a hexahedron) or, to be split, 10 (a tetrahedron) or 13 (a prism)",
    })
}

/// The next word as a number.
fn next<T: FromStr>(line: usize, words: &mut SplitWhitespace, what: &str) -> Result<T, GmshError> {
    number(line, words.next().unwrap_or("the end of the line"), what)
}

fn number<T: FromStr>(line: usize, word: &str, what: &str) -> Result<T, GmshError> {
    word.trim().parse().map_err(|_| unexpected(line, what, word))
}

/// Nothing but an index may end a line of a list.
fn end(line: usize, mut words: SplitWhitespace) -> Result<(), GmshError> {
    if let Some(index) = words.next() {
        number::<u64>(line, index, "an index or the end of the line")?;
    }
    words.next().map_or(Ok(()), |word| Err(unexpected(line, "the end of the line", word)))
}

/// The error of a line that goes on after `corners` nodes and an index, as that of a curved element.
fn more_nodes(error: GmshError, corners: usize) -> GmshError {
    let GmshError::Syntax { place, expected, found } = error else { return error };
    let remedy = format!(
        "elements of SU2 are straight, here with {corners} nodes and perhaps an index: save the mesh with \
         `Mesh.ElementOrder = 1` in Gmsh, or as `.msh`, which may be curved"
    );
    GmshError::Syntax { place, expected, found: format!("{found}: {remedy}") }
}

fn unexpected(line: usize, expected: &str, found: &str) -> GmshError {
    let found = if found.is_empty() { "nothing" } else { found };
    let found = format!("`{}`", found.chars().take(60).collect::<String>());
    GmshError::Syntax { place: FilePosition::Line(line), expected: expected.to_owned(), found }
}

/// The error of the lists of an SU2 file, with its line and a remedy that does not speak of Gmsh.
pub(super) fn in_file(error: GmshError) -> GmshError {
    let words = Words {
        element: &|line| format!("line {line}"),
        node: &|node| format!("point {node}"),
        nodes: "those of NPOIN, which count from 0",
        boundary: "marker",
        name_it: "list the face below a MARKER_TAG",
        list_once: "list the face below one MARKER_TAG, once",
        take_out: "take the face out of the marker, because a marker lists faces on the outside of the mesh",
    };
    words.tell(error)
}
