//! Texts and numbers in HTML and JSON.

use serde_json::Value;

/// A text as HTML.
pub fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// A text as HTML, in which words between backquotes are code.
pub fn with_code(text: &str) -> String {
    let part = |(k, part): (usize, &str)| match k % 2 {
        1 => format!("<code>{}</code>", escaped(part)),
        _ => escaped(part),
    };
    match text.matches('`').count() % 2 {
        0 => text.split('`').enumerate().map(part).collect(),
        _ => escaped(text),
    }
}

/// A text that begins with a capital.
pub fn capitalised(text: &str) -> String {
    let mut characters = text.chars();
    characters.next().map_or_else(String::new, |first| first.to_uppercase().chain(characters).collect())
}

/// JSON for a script element, which must not contain `</`.
pub fn script_json(value: &Value) -> String {
    value.to_string().replace("</", "<\\/")
}

/// A number for a scale: six digits, with an exponent if that is shorter.
pub fn short(value: f64) -> String {
    with_digits(value, 6)
}

/// A number with at most so many `digits`, but the whole of its integer part.
pub fn with_digits(value: f64, digits: usize) -> String {
    let after = digits.saturating_sub(1);
    if value == 0.0 {
        return "0".into();
    }
    if !(1e-4..1e6).contains(&value.abs()) {
        let text = format!("{value:.after$e}");
        let (digits, exponent) = text.split_once('e').unwrap_or((&text, "0"));
        return format!("{}e{exponent}", without_zeros(digits)).replace('-', "\u{2212}");
    }
    let digits = (after as i32 - value.abs().log10().floor() as i32).max(0) as usize;
    without_zeros(&format!("{value:.digits$}")).replace('-', "\u{2212}")
}

/// A text may differ from its value by this part of the distance to the next value.
const READING_ERROR: f64 = 0.01;

/// The texts of values along a scale: `least` digits, more where a text would stand for a place that is seen to be another one.
pub fn texts_on_scale(values: &[f64], least: usize) -> Vec<String> {
    let texts = |digits| values.iter().map(|value| with_digits(*value, digits)).collect::<Vec<_>>();
    let to_next = |k: usize| {
        let neighbours = [k.wrapping_sub(1), k + 1].into_iter().filter_map(|other| values.get(other));
        neighbours.map(|other| (other - values[k]).abs()).fold(f64::INFINITY, f64::min)
    };
    let is_exact = |(k, text): (usize, &String)| {
        let read: f64 = text.replace('\u{2212}', "-").parse().unwrap_or(f64::NAN);
        (read - values[k]).abs() <= READING_ERROR * to_next(k)
    };
    (least..=15).map(texts).find(|texts| texts.iter().enumerate().all(is_exact)).unwrap_or_else(|| texts(6))
}

fn without_zeros(number: &str) -> &str {
    if number.contains('.') { number.trim_end_matches('0').trim_end_matches('.') } else { number }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        for (value, text) in [
            (0.0, "0"),
            (0.1 + 0.2, "0.3"),
            (-1.0 / 3.0, "\u{2212}0.333333"),
            (123_456.7, "123457"),
            (9.276e-13, "9.276e\u{2212}13"),
            (4e7, "4e7"),
            (100.0, "100"),
        ] {
            assert_eq!(short(value), text);
        }
    }

    #[test]
    fn scales_have_as_many_digits_as_their_places_need() {
        let legend = |values: &[f64]| texts_on_scale(values, 3);
        assert_eq!(legend(&[0.123_456, 0.2, 1234.6]), ["0.123", "0.2", "1235"]);
        assert_eq!(legend(&[0.99998, 1.0, 1.00002]), ["0.99998", "1", "1.00002"]);
        assert_eq!(legend(&[0.5, 0.5]), ["0.5", "0.5"]);
        // These read 101324, 101325, 101326 and 2.98, 2.99, 3; ticks of a late time were all 1e6.
        assert_eq!(legend(&[101_324.5, 101_325.0, 101_325.5]), ["101324.5", "101325", "101325.5"]);
        assert_eq!(legend(&[2.985, 2.99, 2.995]), ["2.985", "2.99", "2.995"]);
        assert_eq!(texts_on_scale(&[-1e6, -999_999.5], 6), ["\u{2212}1e6", "\u{2212}999999.5"]);
        assert_eq!(texts_on_scale(&[1_000_000.2, 1_000_000.4], 6), ["1.0000002e6", "1.0000004e6"]);
    }

    #[test]
    fn backquotes_make_code() {
        assert_eq!(with_code("take `a < b`, or `c`"), "take <code>a &lt; b</code>, or <code>c</code>");
        assert_eq!(with_code("one ` alone"), "one ` alone");
        assert_eq!((capitalised("mesh"), capitalised("")), ("Mesh".to_owned(), String::new()));
    }

    #[test]
    fn texts_cannot_end_an_element() {
        assert_eq!(escaped("<b>\"&"), "&lt;b&gt;&quot;&amp;");
        assert_eq!(script_json(&"</script>".into()), "\"<\\/script>\"");
    }
}
