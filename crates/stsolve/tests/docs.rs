//! The documentation agrees with the program: keys, links, examples, equations.

#![allow(clippy::unwrap_used)]

mod common;
mod equations;

use common::stsolve;
use equations::{Code, Equation};
use std::fs::read_to_string;
use std::path::{Path, PathBuf};
use toml::{Table, Value};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().unwrap()
}

/// The chapters of the book.
fn chapters() -> Vec<PathBuf> {
    let book = root().join("docs/src");
    let in_folder = |folder: PathBuf| std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut files: Vec<PathBuf> = in_folder(book.clone()).chain(in_folder(book.join("cases"))).collect();
    files.retain(|file| file.extension().is_some_and(|extension| extension == "md"));
    files.sort();
    files
}

/// Every page that a reader may open.
fn pages() -> Vec<PathBuf> {
    let others = [
        "README.md",
        "CONTRIBUTING.md",
        "CHANGELOG.md",
        "crates/README.md",
        "crates/output/FORMAT.md",
        "scripts/README.md",
    ];
    others.iter().map(|file| root().join(file)).chain(chapters()).collect()
}

/// The text outside and the blocks inside of fences: (info, first line, lines).
fn split(text: &str) -> (Vec<String>, Vec<(String, usize, String)>) {
    let (mut outside, mut blocks) = (Vec::new(), Vec::new());
    let mut block: Option<(String, usize, String)> = None;
    for (number, line) in text.lines().enumerate() {
        match (line.trim_start().strip_prefix("```"), &mut block) {
            (Some(info), None) => block = Some((info.trim().to_owned(), number + 2, String::new())),
            (Some(_), Some(_)) => blocks.extend(block.take()),
            (None, Some((.., inner))) => *inner += &format!("{line}\n"),
            (None, None) => outside.push(line.to_owned()),
        }
    }
    assert!(block.is_none(), "a fence is open");
    (outside, blocks)
}

/// The targets of the links of a text.
fn links(outside: &[String]) -> Vec<String> {
    let text = outside.join("\n");
    text.split("](").skip(1).filter_map(|rest| rest.split_once(')')).map(|(link, _)| link.to_owned()).collect()
}

/// The anchors of the headings of a page.
fn anchors(text: &str) -> Vec<String> {
    let headings = split(text).0.into_iter().filter(|line| line.starts_with('#'));
    let letters = |heading: String| -> String {
        let text = heading.trim_start_matches('#').trim().to_lowercase().replace(' ', "-");
        text.chars().filter(|c| c.is_alphanumeric() || "-_".contains(*c)).collect()
    };
    headings.map(letters).collect()
}

#[test]
fn the_page_of_keys_is_that_of_the_schema() {
    let outcome = stsolve(&root(), &["schema", "--markdown"]);
    let page = read_to_string(root().join("docs/src/keys.md")).unwrap();
    assert!(page == outcome.stdout, "write it anew: scripts/stsolve schema --markdown > docs/src/keys.md");
}

#[test]
fn cases_name_the_schema_that_the_program_prints() {
    let outcome = stsolve(&root(), &["schema"]);
    let schema = read_to_string(root().join("cases/case.schema.json")).unwrap();
    assert!(schema == outcome.stdout, "write it anew: scripts/stsolve schema > cases/case.schema.json");
    assert!(schema.contains("\"$id\": \"https://"), "a schema has an identifier");
    let mut seen = 0;
    for case in std::fs::read_dir(root().join("cases")).unwrap().map(|entry| entry.unwrap().path()) {
        if case.extension().is_some_and(|extension| extension == "toml") {
            let text = read_to_string(&case).unwrap();
            assert_eq!(text.lines().next(), Some("#:schema ./case.schema.json"), "{}", case.display());
            seen += 1;
        }
    }
    assert!(seen > 40, "{seen} cases");
}

#[test]
fn links_lead_somewhere() {
    let mut seen = 0;
    for page in pages() {
        let text = read_to_string(&page).unwrap();
        for link in links(&split(&text).0) {
            if link.contains("://") {
                continue;
            }
            let (file, anchor) = link.split_once('#').unwrap_or((&link, ""));
            let target = if file.is_empty() { page.clone() } else { page.parent().unwrap().join(file) };
            assert!(target.exists(), "{}: {link}", page.display());
            if !anchor.is_empty() {
                let known = anchors(&read_to_string(&target).unwrap());
                assert!(known.iter().any(|other| other == anchor), "{}: no heading for {link}", page.display());
            }
            seen += 1;
        }
    }
    assert!(seen > 100, "{seen} links");
}

#[test]
fn every_chapter_is_in_the_table_of_contents() {
    let contents = read_to_string(root().join("docs/src/SUMMARY.md")).unwrap();
    let listed = links(&split(&contents).0);
    for chapter in chapters() {
        let name = chapter.strip_prefix(root().join("docs/src")).unwrap().to_str().unwrap().to_owned();
        assert!(name == "SUMMARY.md" || listed.contains(&name), "{name}");
    }
}

#[test]
fn cases_that_are_named_exist() {
    for page in pages() {
        let text = read_to_string(&page).unwrap();
        for name in text.split("cases/").skip(1).filter_map(|rest| rest.split_once(".toml")).map(|(name, _)| name) {
            let plain =
                !name.is_empty() && name.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_');
            let exists = root().join(format!("cases/{name}.toml")).exists();
            assert!(!plain || exists, "{}: cases/{name}.toml", page.display());
        }
    }
}

/// Replaces keys of a case by those of a section, `changes`.
fn overwrite(case: &mut Table, changes: Table) {
    for (section, value) in changes {
        match (case.get_mut(&section), value) {
            (Some(Value::Table(old)), Value::Table(new)) => old.extend(new),
            (_, value) => _ = case.insert(section, value),
        }
    }
}

/// The block as a case: alone, or merged into the case that its fence names.
fn as_case(info: &str, block: &str) -> Option<String> {
    let Some(base) = info.strip_prefix("toml").map(str::trim).filter(|base| base.ends_with(".toml")) else {
        return (info == "toml" && block.contains("[time]")).then(|| block.to_owned());
    };
    let mut case: Table = read_to_string(root().join(base)).unwrap().parse().unwrap();
    overwrite(&mut case, block.parse().unwrap());
    Some(toml::to_string(&case).unwrap())
}

#[test]
fn examples_are_accepted() {
    let directory = tempfile::tempdir().unwrap();
    let mut checked = 0;
    for page in pages() {
        for (info, line, block) in split(&read_to_string(&page).unwrap()).1 {
            let place = format!("{}:{line}", page.display());
            if info.starts_with("toml") {
                block.parse::<Table>().unwrap_or_else(|error| panic!("{place}: {error}"));
            }
            let Some(case) = as_case(&info, &block) else { continue };
            std::fs::write(directory.path().join("case.toml"), case).unwrap();
            let outcome = stsolve(directory.path(), &["check", "case.toml", "--probe", "never"]);
            assert_eq!(outcome.code, 0, "{place}: {}", outcome.stderr);
            checked += 1;
        }
    }
    assert!(checked >= 5, "{checked} examples");
}

/// The sources below a folder, with the strings of messages in one piece.
fn sources(folder: &Path) -> String {
    let mut text = String::new();
    for entry in std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
        if entry.is_dir() {
            text += &sources(&entry);
        } else {
            text += &read_to_string(entry).unwrap();
        }
    }
    text.replace("\\\"", "\"").split("\\\n").map(str::trim_start).collect()
}

#[test]
fn messages_on_the_page_of_meshes_are_those_of_the_program() {
    let code = sources(&root().join("crates/mesh/src")) + &sources(&root().join("crates/stsolve/src/commands/info"));
    let page = read_to_string(root().join("docs/src/meshes.md")).unwrap();
    let table = page.split("| message | cause | remedy |").nth(1).unwrap();
    let mut seen = 0;
    for row in table.lines().skip(2).take_while(|line| line.starts_with('|')) {
        let messages = row.split('|').nth(1).unwrap().split('`').skip(1).step_by(2);
        for part in messages.flat_map(|message| message.split("...")).filter(|part| part.len() > 2) {
            assert!(code.contains(part.trim()), "no message has `{part}`");
            seen += 1;
        }
    }
    assert!(seen > 20, "{seen} parts of messages");
}

#[test]
fn equations_stand_in_the_code_that_is_named() {
    let page = read_to_string(root().join("docs/src/theory.md")).unwrap();
    let (mut file, mut code, mut block, mut seen) = (String::new(), None, None, 0);
    for line in page.lines() {
        if let Some((_, path)) = line.strip_suffix(')').and_then(|line| line.strip_prefix("[`")?.split_once("](")) {
            file = path.to_owned();
            code = Some(Code::new(&read_to_string(root().join("docs/src").join(path)).unwrap()));
        } else if line == "```math" {
            block = Some(String::new());
        } else if line.starts_with("```") {
            let latex = block.take().expect("theory has no other blocks than equations");
            let stands = code.as_ref().is_some_and(|code| code.has(&Equation::new(&latex)));
            assert!(stands, "{file} has no such equation:\n{latex}\n{:?}", Equation::new(&latex));
            seen += 1;
        } else if let Some(latex) = &mut block {
            *latex += &format!("{line}\n");
        }
    }
    assert!(seen > 70, "{seen} equations");
}
