//! The sources: length of files and functions, words that name nothing, loose ends.

use std::path::Path;

use super::{files, none, read};

const FILE_LINES: usize = 400;
const FUNCTION_LINES: usize = 70;

/// Words that say nothing about what they name.
const EMPTY_WORDS: [&str; 6] = ["manager", "handler", "helper", "util", "common", "misc"];

#[test]
fn files_are_short() {
    let long = files(&[".rs"]).into_iter().filter_map(|path| {
        let lines = read(&path).lines().count();
        (lines > FILE_LINES).then(|| format!("{}: {lines} lines", path.display()))
    });
    none(&long.collect::<Vec<_>>());
}

/// A function begins with `fn` at the start of an item and ends at the brace of the same indentation: rustfmt
/// sees to that.
fn functions(text: &str) -> Vec<(String, usize)> {
    let lines: Vec<&str> = text.lines().collect();
    let indentation = |line: &str| line.len() - line.trim_start().len();
    let begins = |line: &str| {
        let mut words = line.trim_start().split(' ').skip_while(|word| {
            ["const", "unsafe", "async", "extern", "\"C\""].contains(word) || word.starts_with("pub")
        });
        let name = |word: &str| word.split(['(', '<']).next().unwrap_or_default().to_owned();
        (words.next() == Some("fn")).then(|| name(words.next().unwrap_or_default()))
    };
    let mut found = Vec::new();
    for (first, line) in lines.iter().enumerate() {
        let Some(name) = begins(line) else { continue };
        let ends = |other: &&str| indentation(other) == indentation(line) && other.trim() == "}";
        let on_one_line = line.ends_with('}') || line.ends_with(';');
        let last = if on_one_line { Some(0) } else { lines[first..].iter().position(ends) };
        found.push((name, last.map_or(0, |last| last + 1)));
    }
    found
}

#[test]
fn functions_are_short() {
    let mut count = 0;
    let mut findings = Vec::new();
    for path in files(&[".rs"]) {
        for (name, lines) in functions(&read(&path)) {
            count += 1;
            if lines > FUNCTION_LINES {
                findings.push(format!("{}: {name} has {lines} lines", path.display()));
            }
        }
    }
    assert!(count > 1000, "only {count} functions were recognised");
    none(&findings);
}

#[test]
fn the_length_of_a_function_is_counted_from_fn_to_brace() {
    let text = "impl A {\n    pub(crate) fn one(\n        a: B,\n    ) {\n        if a {\n        }\n    }\n}\nfn two() {}\n";
    let counted = functions(text);
    assert_eq!(counted, [("one".to_owned(), 6), ("two".to_owned(), 1)]);
}

/// The words of a name in snake_case, kebab-case or CamelCase, in lower case.
fn words(name: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    for letter in name.chars() {
        if !letter.is_ascii_alphanumeric() || letter.is_ascii_uppercase() {
            words.push(String::new());
        }
        if let (Some(word), true) = (words.last_mut(), letter.is_ascii_alphanumeric()) {
            word.push(letter.to_ascii_lowercase());
        }
    }
    words
}

fn is_empty(name: &str) -> bool {
    words(name).iter().any(|word| EMPTY_WORDS.iter().any(|empty| word.trim_end_matches('s') == *empty))
}

#[test]
fn names_say_something() {
    let mut findings = Vec::new();
    for path in files(&[".rs", ".toml", ".md", ".ngc"]) {
        if path
            .iter()
            .any(|part| is_empty(Path::new(part).file_stem().unwrap_or(part).to_str().unwrap_or("")))
        {
            findings.push(format!("{}", path.display()));
        }
        if path.extension().is_none_or(|ending| ending != "rs") {
            continue;
        }
        for line in read(&path).lines() {
            let mut tokens = line.split_whitespace();
            let kind = tokens.find(|word| ["fn", "struct", "enum", "trait", "mod", "type"].contains(word));
            let name =
                tokens.next().unwrap_or_default().split(['(', '<', '{', ';', ':']).next().unwrap_or("");
            if kind.is_some() && !line.trim_start().starts_with("//") && is_empty(name) {
                findings.push(format!("{}: {}", path.display(), line.trim()));
            }
        }
    }
    assert!(is_empty("HashUtils") && is_empty("error_handler") && !is_empty("utilisation"));
    none(&findings);
}

#[test]
fn there_are_no_loose_ends() {
    let loose = [concat!("TO", "DO"), concat!("FIX", "ME"), concat!("XX", "X")];
    let mut findings = Vec::new();
    for path in files(&[".rs", ".md", ".toml", ".ngc"]) {
        let text = read(&path);
        let lines = text.lines().enumerate();
        let bad = lines.filter(|(_, line)| loose.iter().any(|word| line.contains(word)));
        findings.extend(bad.map(|(at, line)| format!("{}:{}: {}", path.display(), at + 1, line.trim())));
    }
    none(&findings);
}

/// Every file says in its first line what it is, or shows the page that does.
#[test]
fn every_source_begins_by_saying_what_it_is() {
    let says = |text: &str| text.starts_with("//!") || text.starts_with("#![doc = include_str!(");
    let silent = files(&[".rs"]).into_iter().filter(|path| !says(&read(path)));
    none(&silent.map(|path| path.display().to_string()).collect::<Vec<_>>());
}
