//! A line of text with carets below a part of it; for a long line the text around that part.

use std::fmt;

/// The largest number of characters of a line that are shown.
const WIDTH: usize = 160;

/// Characters shown before the marked part of a long line.
const BEFORE: usize = 60;

/// The mark of omitted characters.
const LEFT_OUT: &str = "... ";

/// A line of text with some marked characters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Excerpt<'a> {
    /// The line.
    pub line: &'a str,
    /// The first marked character, from 0.
    pub position: usize,
    /// The number of marked characters, at least one.
    pub length: usize,
}

impl Excerpt<'_> {
    /// Writes the line after `margin`, and the carets on the next line after `below`.
    ///
    /// # Errors
    /// Errors of the formatter.
    pub fn write(&self, f: &mut fmt::Formatter<'_>, margin: &str, below: &str) -> fmt::Result {
        let length = self.line.chars().count();
        let first = if length <= WIDTH { 0 } else { self.position.saturating_sub(BEFORE).min(length - WIDTH) };
        let last = length.min(first + WIDTH);
        let (head, tail) = (if first > 0 { LEFT_OUT } else { "" }, if last < length { " ..." } else { "" });
        let shown: String = self.line.chars().skip(first).take(last - first).collect();
        // Tabs are kept, so that the carets stay below the marked characters.
        let blank = |c: char| if c == '\t' { '\t' } else { ' ' };
        let indent: String = shown.chars().take(self.position - first.min(self.position)).map(blank).collect();
        let carets = "^".repeat(self.length.min(last.saturating_sub(self.position)).max(1));
        write!(f, "{margin}{head}{shown}{tail}\n{below}{}{indent}{carets}", " ".repeat(head.len()))
    }
}

/// `text` on one line, cut after `most` characters.
pub fn shortened(text: &str, most: usize) -> String {
    let line = text.split_whitespace().collect::<Vec<_>>().join(" ");
    match line.char_indices().nth(most) {
        Some((end, _)) => format!("{} ...", &line[..end]),
        None => line,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Shown<'a>(Excerpt<'a>);

    impl fmt::Display for Shown<'_> {
        fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            self.0.write(f, "> ", "  ")
        }
    }

    #[test]
    fn carets_stand_below_what_they_mark_in_lines_of_any_length() {
        for before in [0, 3, 59, 60, 61, 158, 200, 5000] {
            for after in [0, 2, 100, 5000] {
                let line = "ü".repeat(before) + "WRONG" + &"b".repeat(after);
                let text = Shown(Excerpt { line: &line, position: before, length: 5 }).to_string();
                let (shown, marks) = text.split_once('\n').unwrap_or_default();
                let at = marks.chars().position(|c| c == '^').unwrap_or_default();
                let marked: String = shown.chars().skip(at).take(marks.trim().len()).collect();
                assert_eq!((marked.as_str(), marks.trim()), ("WRONG", "^^^^^"), "{before} {after}: {text}");
                assert!(shown.chars().count() <= WIDTH + 12, "{text}");
            }
        }
    }

    #[test]
    fn a_mark_longer_than_the_line_ends_with_it() {
        let line = "a".repeat(1000);
        let text = Shown(Excerpt { line: &line, position: 2, length: 10_000 }).to_string();
        assert!(text.matches('^').count() <= WIDTH, "{text}");
        assert_eq!(Shown(Excerpt { line: "ab", position: 2, length: 1 }).to_string(), "> ab\n    ^");
    }
}
