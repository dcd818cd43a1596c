//! Numbers and lines of a file, in text or binary.

use super::{FilePosition, GmshError};

/// The encoding of numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Text,
    LittleEndian,
    BigEndian,
}

/// A text without the byte order mark that some editors write at its beginning.
pub(super) fn without_mark(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix("\u{feff}".as_bytes()).unwrap_or(bytes)
}

/// A file and the reading position.
pub(super) struct Source<'a> {
    bytes: &'a [u8],
    position: usize,
    pub(super) encoding: Encoding,
}

impl<'a> Source<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Source { bytes: without_mark(bytes), position: 0, encoding: Encoding::Text }
    }

    /// The place of the reading position. It counts lines anew, so it is used for errors only.
    pub(super) fn place(&self) -> FilePosition {
        self.place_at(self.position)
    }

    /// The byte that is read next; in a text, the first byte of the next word.
    pub(super) fn mark(&mut self) -> usize {
        if self.encoding == Encoding::Text {
            self.skip_spaces();
        }
        self.position
    }

    /// The place of the byte `position`.
    pub(super) fn place_at(&self, position: usize) -> FilePosition {
        match self.encoding {
            Encoding::Text => {
                let before = &self.bytes[..position];
                FilePosition::Line(1 + before.iter().filter(|&&byte| byte == b'\n').count())
            }
            _ => FilePosition::Byte(position),
        }
    }

    /// An error at the byte `mark` if a number is used a second time, that is, unless it is `first`.
    pub(super) fn once(&self, what: &'static str, number: u64, mark: usize, first: bool) -> Result<(), GmshError> {
        if first { Ok(()) } else { Err(GmshError::Twice { place: self.place_at(mark), what, number }) }
    }

    /// The error that the input is not `expected`.
    pub(super) fn unexpected(&self, expected: &str) -> GmshError {
        let rest = &self.bytes[self.position..];
        let found = match (rest, self.encoding) {
            ([], _) => "the end of the file".to_owned(),
            (_, Encoding::Text) => format!("\"{}\"", first_word(rest)),
            (_, _) => format!("the bytes {:02x?}", &rest[..rest.len().min(8)]),
        };
        GmshError::Syntax { place: self.place(), expected: expected.to_owned(), found }
    }

    /// The next non-empty line, trimmed; `None` at the end of the file.
    pub(super) fn line(&mut self) -> Result<Option<&'a str>, GmshError> {
        self.skip_spaces();
        let rest = &self.bytes[self.position..];
        if rest.is_empty() {
            return Ok(None);
        }
        let length = rest.iter().position(|&byte| byte == b'\n').unwrap_or(rest.len());
        let line = std::str::from_utf8(&rest[..length]).map_err(|_| self.unexpected("a line of text in UTF-8"))?;
        self.position += (length + 1).min(rest.len());
        Ok(Some(line.trim()))
    }

    /// Reads the next line, which must be `expected`.
    pub(super) fn expect_line(&mut self, expected: &str) -> Result<(), GmshError> {
        self.skip_spaces();
        let start = self.position;
        match self.line() {
            Ok(Some(line)) if line == expected => Ok(()),
            _ => {
                self.position = start;
                Err(self.unexpected(expected))
            }
        }
    }

    /// Whether the next line begins with `text`.
    pub(super) fn is_next(&mut self, text: &str) -> bool {
        self.skip_spaces();
        self.bytes[self.position..].starts_with(text.as_bytes())
    }

    /// Skips everything up to and including the line in which `end` stands.
    pub(super) fn skip_past(&mut self, end: &str) -> Result<(), GmshError> {
        let rest = &self.bytes[self.position..];
        match rest.windows(end.len()).position(|window| window == end.as_bytes()) {
            Some(offset) => self.position += offset,
            None => {
                self.position = self.bytes.len();
                return Err(self.unexpected(end));
            }
        }
        self.line().map(|_| ())
    }

    /// An `int` of the format: 4 bytes in binary.
    pub(super) fn int(&mut self, what: &str) -> Result<i64, GmshError> {
        match self.encoding {
            Encoding::Text => self.parsed(what),
            Encoding::LittleEndian => Ok(i32::from_le_bytes(self.raw(what)?).into()),
            Encoding::BigEndian => Ok(i32::from_be_bytes(self.raw(what)?).into()),
        }
    }

    /// A `size_t` of the format: 8 bytes in binary.
    pub(super) fn size(&mut self, what: &str) -> Result<u64, GmshError> {
        match self.encoding {
            Encoding::Text => self.parsed(what),
            Encoding::LittleEndian => Ok(u64::from_le_bytes(self.raw(what)?)),
            Encoding::BigEndian => Ok(u64::from_be_bytes(self.raw(what)?)),
        }
    }

    /// A `double` of the format.
    pub(super) fn real(&mut self, what: &str) -> Result<f64, GmshError> {
        match self.encoding {
            Encoding::Text => self.parsed(what),
            Encoding::LittleEndian => Ok(f64::from_le_bytes(self.raw(what)?)),
            Encoding::BigEndian => Ok(f64::from_be_bytes(self.raw(what)?)),
        }
    }

    /// Three of them: a position.
    pub(super) fn point(&mut self, what: &str) -> Result<[f64; 3], GmshError> {
        Ok([self.real(what)?, self.real(what)?, self.real(what)?])
    }

    /// The position of a node, which must be finite.
    pub(super) fn position_of_node(&mut self) -> Result<[f64; 3], GmshError> {
        let start = self.position;
        let x = self.point("the position of a node")?;
        if x.iter().all(|x| x.is_finite()) {
            return Ok(x);
        }
        self.position = start;
        Err(self.unexpected("the position of a node, in finite numbers"))
    }

    /// The next word of a text, as a number.
    fn parsed<T: std::str::FromStr>(&mut self, what: &str) -> Result<T, GmshError> {
        self.skip_spaces();
        let rest = &self.bytes[self.position..];
        let length = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        let word = std::str::from_utf8(&rest[..length]).ok();
        let number = word.and_then(|word| word.parse().ok()).ok_or_else(|| self.unexpected(what))?;
        self.position += length;
        Ok(number)
    }

    fn raw<const N: usize>(&mut self, what: &str) -> Result<[u8; N], GmshError> {
        let bytes = self.bytes[self.position..].first_chunk().ok_or_else(|| self.unexpected(what))?;
        self.position += N;
        Ok(*bytes)
    }

    fn skip_spaces(&mut self) {
        let rest = &self.bytes[self.position..];
        self.position += rest.iter().position(|byte| !byte.is_ascii_whitespace()).unwrap_or(rest.len());
    }
}

/// The first word, as far as it can be shown.
fn first_word(bytes: &[u8]) -> String {
    let word: String = String::from_utf8_lossy(&bytes[..bytes.len().min(40)]).trim_start().to_owned();
    word.split_whitespace().next().unwrap_or_default().to_owned()
}
