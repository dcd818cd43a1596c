//! Text to tokens.

use super::error::{ExpressionError, Problem};

/// The kind of a token.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Kind {
    Number(f64),
    Name(String),
    /// An operator, a comparison, a parenthesis or a comma.
    Symbol(&'static str),
    End,
}

/// A token and its place, in characters.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Token {
    pub(super) kind: Kind,
    pub(super) position: usize,
    pub(super) length: usize,
}

/// Two characters before one, so that `<=` is not read as `<`.
const SYMBOLS: [&str; 15] = ["<=", ">=", "==", "!=", "**", "<", ">", "+", "-", "*", "/", "^", "(", ")", ","];

/// All tokens of `text`, the last one [`Kind::End`].
pub(super) fn tokens(text: &str) -> Result<Vec<Token>, ExpressionError> {
    let characters: Vec<char> = text.chars().collect();
    let mut tokens = Vec::new();
    let mut position = 0;
    while let Some(&first) = characters.get(position) {
        if first.is_whitespace() {
            position += 1;
            continue;
        }
        let token = next(&characters, position).map_err(|(length, problem)| ExpressionError {
            text: text.to_owned(),
            position,
            length,
            problem,
        })?;
        position += token.length;
        tokens.push(token);
    }
    tokens.push(Token { kind: Kind::End, position, length: 1 });
    Ok(tokens)
}

/// The token that starts at `position`; an error with the number of characters it concerns.
fn next(characters: &[char], position: usize) -> Result<Token, (usize, Problem)> {
    let rest = &characters[position..];
    let (kind, length) = if rest[0].is_ascii_digit() || rest[0] == '.' {
        number(rest)?
    } else if is_name_start(rest[0]) {
        let length = rest.iter().take_while(|c| is_name_start(**c) || c.is_ascii_digit()).count();
        (Kind::Name(rest[..length].iter().collect()), length)
    } else {
        let symbol = SYMBOLS.iter().find(|symbol| symbol.chars().eq(rest.iter().take(symbol.len()).copied()));
        let symbol = symbol.ok_or((1, Problem::Character { character: rest[0] }))?;
        // The power operator of other languages.
        (Kind::Symbol(if *symbol == "**" { "^" } else { symbol }), symbol.len())
    };
    Ok(Token { kind, position, length })
}

/// Whether all of `text` is one name.
pub(super) fn is_name(text: &str) -> bool {
    matches!(tokens(text).as_deref(), Ok([Token { kind: Kind::Name(name), .. }, _]) if name == text)
}

fn is_name_start(c: char) -> bool {
    c.is_alphabetic() || c == '_'
}

/// Digits with at most one point, then perhaps an exponent.
fn number(rest: &[char]) -> Result<(Kind, usize), (usize, Problem)> {
    let digits =
        |from: usize| rest[from.min(rest.len())..].iter().take_while(|c| c.is_ascii_digit() || **c == '.').count();
    let mut length = digits(0);
    if matches!(rest.get(length), Some('e' | 'E')) {
        let sign = usize::from(matches!(rest.get(length + 1), Some('+' | '-')));
        let exponent = digits(length + 1 + sign);
        // Without digits it is no exponent: `2exp(x)` is reported as a missing operator, not as a bad number.
        length += if exponent > 0 { 1 + sign + exponent } else { 0 };
    }
    let text: String = rest[..length].iter().collect();
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok((Kind::Number(value), length)),
        _ => Err((length, Problem::Number(text))),
    }
}
