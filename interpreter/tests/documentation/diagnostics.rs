//! `docs/diagnostics.md` explains every code that the sources name, and no other.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use gcode::Dialect;

use super::pages::{cells, examples, page, project, quoted};

/// Functions that take the code of a diagnostic first.
const MAKERS: [&str; 4] = ["Problem::error(", "Problem::warning(", "error_here(", "error_from("];
/// Codes that no short program leads to; what does so is told in words.
const WITHOUT_EXAMPLE: [&str; 13] = [
    "bad-file",
    "bad-startup",
    "cut-after-thread",
    "endless-loop",
    "endless-program",
    "file-too-large",
    "line-too-long",
    "needs-standstill",
    "no-spindle",
    "output",
    "stock-unknown",
    "too-long",
    "unreadable",
];

fn sources(folder: &Path, found: &mut Vec<String>) {
    for entry in fs::read_dir(folder).expect("a folder of sources") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            found.push(fs::read_to_string(&path).expect("a source"));
        }
    }
}

fn is_code(text: &str) -> bool {
    text.starts_with(|letter: char| letter.is_ascii_lowercase())
        && text.chars().all(|letter| letter.is_ascii_lowercase() || letter == '-')
        && !text.ends_with('-')
}

/// Texts in quotation marks that are codes: those with a hyphen, and those that a maker takes first (but a
/// name that comes before).
fn codes_of(source: &str) -> BTreeSet<String> {
    let without_comments = source.lines().filter(|line| !line.trim_start().starts_with("//"));
    let text = without_comments.collect::<Vec<_>>().join("\n");
    let hyphened = text.split('"').filter(|text| is_code(text) && text.contains('-'));
    let made = MAKERS.iter().flat_map(|maker| text.split(maker).skip(1)).filter_map(|behind| {
        let (before, rest) = behind.split_once('"')?;
        let first = before.chars().all(|letter| letter.is_alphanumeric() || " ,_\n".contains(letter));
        rest.split_once('"').map(|(code, _)| code).filter(|code| first && is_code(code))
    });
    hyphened.chain(made).map(str::to_owned).collect()
}

#[test]
fn every_code_of_the_sources_is_explained() {
    let mut texts = Vec::new();
    sources(&project().join("gcode/src"), &mut texts);
    sources(&project().join("interpreter/src"), &mut texts);
    // Names of dialects look like codes.
    let is_dialect = |name: &String| Dialect::ALL.iter().any(|dialect| dialect.name() == name);
    let codes = texts.iter().flat_map(|text| codes_of(text));
    let named: BTreeSet<String> = codes.filter(|code| !is_dialect(code)).collect();
    let text = page("diagnostics.md");
    let rows = text.lines().filter_map(cells);
    let explained: BTreeSet<String> = rows
        .filter_map(|cells| quoted(cells.first()?).filter(|code| is_code(code)).map(str::to_owned))
        .collect();
    assert!(named.len() > 50, "{named:?}");
    assert_eq!(explained, named);
    let shown: BTreeSet<String> =
        examples("diagnostics.md").into_iter().flat_map(|example| example.codes).collect();
    let hidden: Vec<&String> = explained.difference(&shown).collect();
    assert_eq!(hidden, WITHOUT_EXAMPLE);
}
