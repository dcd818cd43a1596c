//! Texts and numbers in HTML and JSON.

use serde_json::Value;

/// A text as HTML.
pub fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// JSON for a script element, which must not contain `</`.
pub fn script_json(value: &Value) -> String {
    value.to_string().replace("</", "<\\/")
}

/// A number for a scale: six digits, with an exponent if that is shorter.
pub fn short(value: f64) -> String {
    if value == 0.0 {
        return "0".into();
    }
    if !(1e-4..1e6).contains(&value.abs()) {
        let text = format!("{value:.5e}");
        let (digits, exponent) = text.split_once('e').unwrap_or((&text, "0"));
        return format!("{}e{exponent}", without_zeros(digits)).replace('-', "\u{2212}");
    }
    let digits = (5 - value.abs().log10().floor() as i32).max(0) as usize;
    without_zeros(&format!("{value:.digits$}")).replace('-', "\u{2212}")
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
    fn texts_cannot_end_an_element() {
        assert_eq!(escaped("<b>\"&"), "&lt;b&gt;&quot;&amp;");
        assert_eq!(script_json(&"</script>".into()), "\"<\\/script>\"");
    }
}
