//! Equations of the pages, in LaTeX, beside the formulas in comments of the code.
//!
//! Both become a list of symbols: names, numbers, and signs. Layout, fonts, brackets and the dots of products are left out; a fraction is
//! `numerator / denominator`.

/// A formula of the code: its symbols by line, and the labels of these lines.
pub struct Code {
    symbols: Vec<(usize, String)>,
    labels: Vec<(usize, String)>,
}

impl Code {
    /// The comments of a source.
    pub fn new(source: &str) -> Self {
        let (mut symbols, mut labels) = (Vec::new(), Vec::new());
        for (number, line) in source.lines().enumerate() {
            let line = line.trim_start();
            let Some(text) = line.strip_prefix("//!").or_else(|| line.strip_prefix("///")) else { continue };
            let (formula, label) = without_label(text.trim());
            labels.extend(label.map(|label| (number, label.to_owned())));
            symbols.extend(split(formula).into_iter().map(|symbol| (number, symbol)));
        }
        Self { symbols, labels }
    }

    /// Whether the equation stands in the comments, with its label.
    pub fn has(&self, equation: &Equation) -> bool {
        let n = equation.symbols.len();
        n > 0
            && self.symbols.windows(n).any(|window| {
                let lines = window[0].0..=window[n - 1].0;
                let same = window.iter().map(|(_, symbol)| symbol).eq(&equation.symbols);
                let labelled =
                    |label: &String| self.labels.iter().any(|(line, own)| own == label && lines.contains(line));
                same && equation.label.as_ref().is_none_or(labelled)
            })
    }
}

/// A line without its label, `(label)` at its end behind blanks or at its beginning before blanks, and the label.
fn without_label(line: &str) -> (&str, Option<&str>) {
    if let Some((formula, rest)) = line.rsplit_once("  (")
        && let Some(label) = rest.strip_suffix(')').filter(|label| !label.contains([')', '(']))
    {
        return (formula, Some(label));
    }
    match line.strip_prefix('(').and_then(|rest| rest.split_once(")  ")) {
        Some((label, formula)) => (formula, Some(label)),
        None => (line, None),
    }
}

/// An equation of a page.
#[derive(Debug)]
pub struct Equation {
    symbols: Vec<String>,
    label: Option<String>,
}

impl Equation {
    /// The equation of a block of LaTeX.
    pub fn new(latex: &str) -> Self {
        let mut text = latex.to_owned();
        let label = take_group(&mut text, "\\tag").map(|label| label.replace('$', ""));
        Self { symbols: split(&plain(text)), label }
    }
}

/// Marks what is joined with the next name: `\mathrm{d}t` is dt.
const JOINED: char = '§';

/// LaTeX as the plain letters of the code.
fn plain(mut text: String) -> String {
    text = text.replace("\\mathrm{d}", " d§");
    for environment in ["\\begin", "\\end"] {
        while take_group(&mut text, environment).is_some() {}
    }
    for font in ["\\mathbf", "\\mathsf", "\\mathcal", "\\mathrm", "\\boldsymbol"] {
        while rewrite(&mut text, font, |inner| inner.to_owned()) {}
    }
    while rewrite(&mut text, "\\text", |inner| format!(" {inner} ")) {}
    while rewrite(&mut text, "\\hat", |inner| format!(" {inner}hat")) {}
    while rewrite(&mut text, "\\tilde", |inner| format!(" {} ~", word(inner))) {}
    while let Some(at) = text.find("\\frac") {
        let (Some(above), Some(below)) = (group(&text, at + 5), group_after(&text, at + 5)) else { break };
        let fraction = format!(" {} / {} ", &text[above.clone()], &text[below.clone()]);
        text.replace_range(at..below.end + 1, &fraction);
    }
    for (sign, own) in [("^*", "*"), ("^\\#", "#"), ("^-", "-"), ("^+", "+")] {
        text = text.replace(sign, own);
    }
    joined(&commands(&text))
}

/// Every command as the word or sign that the code has for it.
fn commands(text: &str) -> String {
    let mut out = String::new();
    let mut rest = text;
    while let Some((before, after)) = rest.split_once('\\') {
        let letters = after.len() - after.trim_start_matches(|c: char| c.is_ascii_alphabetic()).len();
        let length = if letters == 0 { after.chars().next().map_or(0, char::len_utf8) } else { letters };
        let name = &after[..length];
        rest = &after[length..];
        out += before;
        let variation = ["Delta", "partial"].contains(&name);
        out += &match (variation, rest.trim_start().starts_with('_')) {
            (true, false) => format!(" d{JOINED}"),
            (true, true) if name == "partial" => " d ".to_owned(),
            _ => format!(" {} ", word(name)),
        };
    }
    out + rest
}

/// What the code writes for a command of LaTeX; nothing for spaces and sizes of brackets.
fn word(name: &str) -> &str {
    match name.trim_start_matches('\\') {
        "le" => "<=",
        "ge" => ">=",
        "ne" => "/=",
        "to" => "->",
        "infty" => "infinity",
        "nabla" => "grad",
        "sim" => "~",
        "otimes" | "times" => "x",
        "varepsilon" => "eps",
        "lvert" | "rvert" => "|",
        "quad" | "qquad" | "left" | "right" | "big" | "cdot" | "cdots" => "",
        other if other.chars().all(char::is_alphabetic) => other,
        _ => "",
    }
}

fn joined(text: &str) -> String {
    let mut parts = text.split(JOINED);
    let first = parts.next().unwrap_or_default().to_owned();
    parts.fold(first, |all, part| all + part.trim_start())
}

/// Replaces the first `command{inner}` by a text. False if the text has no such command.
fn rewrite(text: &mut String, command: &str, with: impl Fn(&str) -> String) -> bool {
    let Some(at) = text.find(&format!("{command}{{")) else { return false };
    let Some(inner) = group(text, at + command.len()) else { return false };
    let new = with(&text[inner.clone()]);
    text.replace_range(at..inner.end + 1, &new);
    true
}

/// Takes the first `command{inner}` out of the text; the inner text.
fn take_group(text: &mut String, command: &str) -> Option<String> {
    let at = text.find(&format!("{command}{{"))?;
    let inner = group(text, at + command.len())?;
    let taken = text[inner.clone()].to_owned();
    text.replace_range(at..inner.end + 1, " ");
    Some(taken)
}

/// What is inside of the braces that open at `start`.
fn group(text: &str, start: usize) -> Option<std::ops::Range<usize>> {
    let mut depth = 0;
    for (place, sign) in text[start..].char_indices() {
        match sign {
            '{' => depth += 1,
            '}' => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            return (place > 0).then(|| start + 1..start + place);
        }
    }
    None
}

/// The same of the braces behind those that open at `start`.
fn group_after(text: &str, start: usize) -> Option<std::ops::Range<usize>> {
    group(text, group(text, start)?.end + 1)
}

/// The symbols of a plain formula: runs of letters, runs of digits, signs.
fn split(text: &str) -> Vec<String> {
    let kind = |c: char| match c {
        _ if c.is_alphabetic() => 1,
        _ if c.is_ascii_digit() => 2,
        _ if "+-=/^_|'~<>:*#".contains(c) => 3,
        _ => 0,
    };
    let mut symbols: Vec<String> = Vec::new();
    let mut last = 0;
    for c in text.chars() {
        let own = kind(c);
        match symbols.last_mut() {
            Some(symbol) if own == last && own < 3 && own > 0 => symbol.push(c),
            _ if own > 0 => symbols.push(c.to_string()),
            _ => {}
        }
        last = own;
    }
    symbols
}

#[test]
fn a_wrong_sign_letter_or_label_is_noticed() {
    let code = Code::new("//! V_b = (1/dt) sum_a (Phi^{-1})_ba (d(s_a) - d_n)     (velocity)\n");
    let right =
        "V_b = \\frac{1}{\\Delta t} \\sum_a (\\Phi^{-1})_{ba} \\left( \\mathbf{d}(s_a) - d_n \\right) \\tag{velocity}";
    assert!(code.has(&Equation::new(right)));
    for (old, new) in
        [("- d_n", "+ d_n"), ("s_a", "s_b"), ("\\Delta t", "\\Delta s"), ("^{-1}", ""), ("{velocity}", "{motion}")]
    {
        assert!(!code.has(&Equation::new(&right.replace(old, new))), "{new}");
    }
}

#[test]
fn commands_become_the_letters_of_the_code() {
    let cases = [
        ("\\frac{\\partial \\mathsf{R}}{\\partial z}", "dR/dz"),
        ("\\int_{\\partial \\mathcal{K}} \\hat{\\mathcal{F}}_c \\, \\mathrm{d}S", "int_dK Fhat_c dS"),
        ("\\mathcal{F}^*(u^-, u^+) \\le \\tilde{\\rho}", "F*(u-, u+) <= rho~"),
        ("\\Delta_k \\partial_j x^{-1}", "Delta_k d_j x^-1"),
    ];
    for (latex, ascii) in cases {
        assert_eq!(Equation::new(latex).symbols, split(ascii), "{latex}");
    }
}
