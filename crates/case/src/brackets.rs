//! Unclosed brackets of a TOML text. A parser reports a missing bracket lines later.

/// The position of the innermost bracket that is open at `end`.
pub(super) fn open_at(text: &str, end: usize) -> Option<usize> {
    let (mut open, mut at) = (Vec::new(), 0);
    while let Some(rest) = text.get(at..end).filter(|rest| !rest.is_empty()) {
        at += match rest.as_bytes()[0] {
            b'#' => rest.find('\n').unwrap_or(rest.len()),
            b'"' | b'\'' => string_length(rest),
            byte => {
                match byte {
                    b'[' | b'{' => open.push(at),
                    b']' | b'}' => drop(open.pop()),
                    _ => {}
                }
                rest.chars().next().map_or(1, char::len_utf8)
            }
        };
    }
    open.pop()
}

/// The length of the string at the start of `text`: up to its closing quotes, or to the end of the line if they are missing.
fn string_length(text: &str) -> usize {
    let quote = &text[..1];
    let three = quote.repeat(3);
    let (quotes, lines) = if text.starts_with(&three) { (three.as_str(), true) } else { (quote, false) };
    let mut at = quotes.len();
    while let Some(next) = text[at..].chars().next() {
        match next {
            _ if text[at..].starts_with(quotes) => return at + quotes.len(),
            '\n' if !lines => return at,
            // In double quotes a backslash escapes the next character.
            '\\' if quote == "\"" => at += 1 + text[at + 1..].chars().next().map_or(0, char::len_utf8),
            _ => at += next.len_utf8(),
        }
    }
    text.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn brackets_in_strings_and_comments_do_not_count() {
        for (text, open) in [
            ("a = [1, 2]\n[b]\n", None),
            ("a = [1, 2", Some(4)),
            ("a = [1, { b = 2", Some(8)),
            ("a = [1, { b = 2 }", Some(4)),
            ("a = [ # ]\n", Some(4)),
            ("a = [\"]\", ']'", Some(4)),
            ("a = \"[\" # [\n", None),
            ("a = ['\\', \"\\\"]\"", Some(4)),
            ("a = \"\"\"\n[ \"\" ] [\"\"\"\n", None),
            ("a = \"ü\\ü[", None),
            ("]]", None),
        ] {
            assert_eq!(open_at(text, text.len()), open, "{text}");
            assert_eq!(open_at(text, 3), None, "{text}");
        }
    }
}
