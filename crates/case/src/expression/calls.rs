//! Which arguments a formula gives to a table.

use super::lexer::{self, Kind, Token};

/// Whether `text` takes the function `name` at the present time alone: every call is `name(t)`. A text that is no formula calls nothing.
pub fn is_taken_at_time_alone(text: &str, name: &str) -> bool {
    let Ok(tokens) = lexer::tokens(text) else { return true };
    let is_name = |token: &Token, name: &str| matches!(&token.kind, Kind::Name(found) if found == name);
    let is_symbol = |token: Option<&Token>, symbol| token.is_some_and(|token| token.kind == Kind::Symbol(symbol));
    // A name without a parenthesis is that of something else, say of a boundary.
    let is_at_time =
        |rest: &[Token]| !is_symbol(rest.get(1), "(") || (is_name(&rest[2], "t") && is_symbol(rest.get(3), ")"));
    (0..tokens.len()).filter(|&k| is_name(&tokens[k], name)).all(|k| is_at_time(&tokens[k..]))
}

#[cfg(test)]
mod tests {
    use super::is_taken_at_time_alone;

    #[test]
    fn arguments_are_told_from_the_time() {
        for (text, expected) in [
            ("way(t)*y + 2*way( t )", true),
            ("other(2*t)", true),
            ("A title: of no formula", true),
            ("way(2*t)", false),
            ("way(t) - way(x)", false),
            ("way", true),
            ("way(t", false),
        ] {
            assert_eq!(is_taken_at_time_alone(text, "way"), expected, "{text}");
        }
    }
}
