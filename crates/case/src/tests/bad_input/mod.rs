//! Errors of a case name their cause and their place.

use super::super::error::Place;
use super::*;

mod lines_of_boundaries;
mod lines_of_flow;
mod lines_of_mesh_and_motion;
mod lines_of_run;
mod together;
mod values;

/// A line of BASE, its replacement, and parts of the message besides file and line.
type BadLine = (&'static str, &'static str, &'static [&'static str]);

/// Those of all sections.
const BAD: [&[BadLine]; 4] =
    [lines_of_mesh_and_motion::BAD, lines_of_flow::BAD, lines_of_boundaries::BAD, lines_of_run::BAD];

#[test]
fn bad_input_is_named_with_file_line_key_value_and_what_is_accepted() {
    for (line, replacement, expected) in BAD.into_iter().flatten() {
        let message = message_with(line, replacement);
        let (file, rest) = message.split_once(':').unwrap();
        let number: usize = rest.split(':').next().unwrap().parse().unwrap_or_else(|_| panic!("no line: {message}"));
        assert_eq!(file, "dir/base.toml");
        assert!(message.contains(&format!("\n {number} | ")), "{message}");
        for part in *expected {
            assert!(message.contains(part), "no {part} in:\n{message}");
        }
    }
}

/// The excerpt of a long line contains the error, and the message stays short.
#[test]
fn a_long_line_is_shown_where_it_is_wrong() {
    let sum = |terms: usize| (0..terms).map(|k| format!("a*sin({k}*t)+")).collect::<String>();
    let formula = format!("{}sni(t)+{}0", sum(300), sum(300));
    let message = message_with("left = { displacement", &format!("left = {{ displacement = [\"{formula}\", 0] }}"));
    assert!(message.contains("sni(t)+a*sin(0*t)") && message.len() < 2000, "{message}");
    let list = format!("cells = [{}4, \"two\"]", "4,".repeat(1000));
    let message = message_with("generate.box", &format!("generate.box = {{ lower = [0, 0], upper = [2, 1], {list} }}"));
    assert!(message.contains("4, \"two\"] }") && message.contains("^^^^^") && message.len() < 2000, "{message}");
}

/// Without a limit, `check` would evaluate such a formula for hours.
#[test]
fn a_formula_of_200000_terms_is_refused_at_once() {
    let formula = (0..200_000).map(|k| format!("a*sin({k}*t)+")).collect::<String>() + "0";
    let message = message_with("left = { displacement", &format!("left = {{ displacement = [\"{formula}\", 0] }}"));
    assert!(message.contains("too long: at most 50000 operations") && message.contains("`[tables]`"), "{message}");
    assert!(message.len() < 2000, "{} characters", message.len());
}

#[test]
fn an_error_points_at_its_line_and_column() {
    let error = check_text(&BASE.replace("order = 4", "order = 99"), &[]).unwrap_err();
    let Place::File { line, column, text, length, .. } = error.place else { panic!("in the file") };
    assert_eq!((line, column, text.as_str(), length), (14, 9, "order = 99", 2));
}

#[test]
fn errors_of_options_name_the_option() {
    for (option, expected) in [
        ("flow.order=99", "--set flow.order=99: the order of the flow"),
        ("flow.riemann=rou", "--set flow.riemann = \"rou\": unknown choice `rou`"),
        ("flow.ordr=4", "--set flow.ordr=4: unknown key `ordr`"),
        ("flow.order.x=4", "--set flow.order.x=4: `order` is not a table"),
        ("flow.order", "--set flow.order: "),
        ("=4", "--set =4: "),
        ("a=1\nb=2", "--set a=1\nb=2: an option sets one key"),
    ] {
        let message = check_text(BASE, &[option]).unwrap_err().to_string();
        assert!(message.starts_with(expected), "{option}: {message}");
    }
}

/// Lines that are missing, doubled, cut or misspelt give an error with a place, or still a case; never a panic. Each line has one of the damages, in
/// turn; `stsolve/tests/mutations` has more of them.
#[test]
fn damaged_cases_are_refused_with_a_place_or_are_cases() {
    let (mut tried, mut refused) = (0, 0);
    for (turn, file) in case_files().into_iter().enumerate() {
        // The lowest order makes meshes quickly.
        let text =
            std::fs::read_to_string(&file).unwrap().replace("order = 4", "order = 2").replace("order = 8", "order = 2");
        let lines: Vec<&str> = text.lines().collect();
        for (number, line) in lines.iter().enumerate().filter(|(_, line)| !line.is_empty() && !line.starts_with('#')) {
            let middle = line.char_indices().nth(line.chars().count() / 2).unwrap().0;
            let swapped = format!("{}q{}", &line[..middle], &line[middle..]);
            let damages = [
                "",
                &line[..middle],
                &swapped,
                &line.replace('=', ":"),
                &format!("{line}\n{line}"),
                &line.replace(|c: char| c.is_ascii_digit(), "-7"),
            ];
            let replacement = damages[(number + turn) % damages.len()];
            if replacement == *line {
                continue;
            }
            let damaged: Vec<&str> =
                (0..lines.len()).map(|i| if i == number { replacement } else { lines[i] }).collect();
            let document = Document::parse(&file, damaged.join("\n"), &[]);
            tried += 1;
            if let Err(error) = document.and_then(|document| AnyCase::check(&document)) {
                assert!(matches!(&error.place, Place::File { line, .. } if *line <= lines.len() + 1), "{error}");
                refused += 1;
            }
        }
    }
    assert!(tried > 1000 && refused * 2 > tried, "{refused} of {tried} refused");
}

/// The header of a table names the full path; the error concerns the part that offers a choice.
#[test]
fn two_choices_are_named() {
    let text = BASE
        .replace("generate.box = {", "[mesh.generate.box]\n#")
        .replace("[motion]\n", "lower = [0, 0]\nupper = [1, 1]\ncells = [1, 1]\n[motion]\n");
    for (text, option, place) in [
        (text.as_str(), "mesh.generate.disk={}", "`mesh.generate`"),
        (BASE, "mesh.generate={box={},disk={}}", "--set mesh.generate="),
    ] {
        let message = check_text(text, &[option]).unwrap_err().to_string();
        let parts = [place, "one choice is needed here", "there are `box`, `disk`"];
        parts.iter().for_each(|part| assert!(message.contains(part), "no {part} in:\n{message}"));
    }
}

/// The error lists the choices.
#[test]
fn choices_are_listed_where_none_is_made() {
    let none = check_text(&BASE.replace("generate.box = {", "generate = {}\n#"), &[]).unwrap_err().to_string();
    let no_motion = check_text(&BASE.replace("others = \"fixed\"", ""), &[]).unwrap_err().to_string();
    for (message, parts) in
        [(none, ["there is none", "`box`", "`airfoil`"]), (no_motion, ["`others`", "`fixed`", "`rigid`"])]
    {
        parts.iter().for_each(|part| assert!(message.contains(part), "no {part} in:\n{message}"));
    }
}
