//! Damage to a case file: typing errors in one line.

use crate::random::Random;
use std::ops::Range;

/// A kind of damage.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// A letter of a key is wrong.
    Key,
    /// A character of a text in quotes is wrong: a name, a formula.
    Text,
    /// A number is wrong or invalid.
    Number,
    /// A value is of another type.
    Type,
    /// A line is missing.
    Missing,
    /// A line is there twice.
    Twice,
    /// The rest of a line is missing.
    Cut,
    /// Any character of a line is wrong.
    Character,
}

const KINDS: [Kind; 8] =
    [Kind::Key, Kind::Text, Kind::Number, Kind::Type, Kind::Missing, Kind::Twice, Kind::Cut, Kind::Character];

/// A damaged file.
pub struct Damaged {
    /// The kind of damage.
    pub kind: Kind,
    /// The whole text.
    pub text: String,
    /// The damaged line, from 1.
    pub line: usize,
}

/// `text` with one line damaged.
pub fn damage(text: &str, random: &mut Random) -> Damaged {
    let lines: Vec<&str> = text.lines().collect();
    loop {
        let (line, kind) = (random.below(lines.len()), KINDS[random.below(KINDS.len())]);
        let content = lines[line].split(" #").next().unwrap_or_default();
        if content.trim().is_empty() || content.starts_with('#') {
            continue;
        }
        if let Some(replacement) = damaged_line(content, kind, random).filter(|new| new != content) {
            let before = lines[..line].iter().copied();
            let text = before.chain([&replacement[..]]).chain(lines[line + 1..].iter().copied());
            return Damaged { kind, text: text.collect::<Vec<_>>().join("\n") + "\n", line: line + 1 };
        }
    }
}

/// None if this kind of damage does not apply to the line.
fn damaged_line(line: &str, kind: Kind, random: &mut Random) -> Option<String> {
    let tokens = Tokens::of(line);
    let replace = |range: Range<usize>, new: &str| [&line[..range.start], new, &line[range.end..]].concat();
    match kind {
        Kind::Key => random.choose(&tokens.keys).map(|key| replace(key.clone(), &typo(&line[key], random))),
        Kind::Text => random.choose(&tokens.texts).map(|text| replace(text.clone(), &typo(&line[text], random))),
        Kind::Number => {
            random.choose(&tokens.numbers).map(|number| replace(number.clone(), &wrong_number(&line[number], random)))
        }
        Kind::Type => {
            let quoted = tokens.texts.iter().map(|text| text.start - 1..text.end + 1);
            let values: Vec<_> = quoted.chain(tokens.numbers.iter().cloned()).collect();
            let other = random.choose(&["true", "[]", "{}", "\"other\"", "17", "0.5", "1979-05-27", "[[1]]"]);
            random.choose(&values).zip(other).map(|(value, other)| replace(value, other))
        }
        Kind::Missing => Some(String::new()),
        Kind::Twice => Some(format!("{line}\n{line}")),
        Kind::Cut => Some(line[..random.below(line.len())].to_owned()),
        Kind::Character => Some(typo(line, random)),
    }
}

/// A character is left out, doubled, exchanged with the next one, replaced or inserted.
fn typo(word: &str, random: &mut Random) -> String {
    let mut letters: Vec<char> = word.chars().collect();
    if letters.is_empty() {
        return "q".to_owned();
    }
    let place = random.below(letters.len());
    let letter = random.choose(&['q', 'e', '7', '_', '.', '-', '(', ']', '"', '=', ' ']).unwrap_or('q');
    match random.below(5) {
        0 => drop(letters.remove(place)),
        1 => letters.insert(place, letters[place]),
        2 => letters.swap(place, (place + 1) % word.chars().count()),
        3 => letters[place] = letter,
        _ => letters.insert(place, letter),
    }
    letters.into_iter().collect()
}

fn wrong_number(number: &str, random: &mut Random) -> String {
    match random.below(9) {
        0 => "nan".to_owned(),
        1 => "-inf".to_owned(),
        2 => "0".to_owned(),
        3 => format!("-{number}"),
        4 => format!("{number}q"),
        5 => format!("1{number}"),
        6 => format!("{number}e400"),
        7 => format!("{number}.5"),
        _ => format!("\"{number}\""),
    }
}

/// The positions of the parts of a line.
#[derive(Default)]
struct Tokens {
    keys: Vec<Range<usize>>,
    /// Without their quotes.
    texts: Vec<Range<usize>>,
    numbers: Vec<Range<usize>>,
}

impl Tokens {
    fn of(line: &str) -> Self {
        let mut tokens = Tokens::default();
        let header = line.starts_with('[');
        let mut at = 0;
        while let Some(start) = line[at..].find(|c: char| c.is_alphanumeric() || "\"+-_".contains(c)) {
            let start = at + start;
            if line[start..].starts_with('"') {
                let end = line[start + 1..].find('"').map_or(line.len(), |length| start + 1 + length);
                tokens.texts.push(start + 1..end);
                at = (end + 1).min(line.len());
                continue;
            }
            let rest = &line[start..];
            let length = rest.find(|c: char| !(c.is_alphanumeric() || "+-_.".contains(c))).unwrap_or(rest.len());
            let word = start..start + length.max(1);
            at = word.end;
            if header || line[at..].trim_start().starts_with('=') {
                tokens.keys.push(word);
            } else if line[word.clone()].parse::<f64>().is_ok() {
                tokens.numbers.push(word);
            }
        }
        tokens
    }
}
