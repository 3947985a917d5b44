//! Pages of `docs/` taken apart. In: a name. Out: its fences, the cells of its tables, its examples.

use std::path::{Path, PathBuf};

use machine::Kinematics;

/// The pages that describe the language.
pub(crate) const PAGES: [&str; 8] = [
    "gcode.md",
    "gcode-parameters.md",
    "gcode-cycles.md",
    "gcode-compensation.md",
    "gcode-fanuc.md",
    "gcode-fanuc-mill.md",
    "diagnostics.md",
    "speed-variation.md",
];

/// A program and what it must lead to.
#[derive(Clone, Debug, Default)]
pub(crate) struct Example {
    /// Page and line.
    pub(crate) place: String,
    /// FANUC, not RS274/NGC.
    pub(crate) fanuc: bool,
    /// Run for the built-in machine of this kind.
    pub(crate) machine: Option<Kinematics>,
    /// Codes of its diagnostics, sorted.
    pub(crate) codes: Vec<String>,
    /// The name of the file that it is, for other examples.
    pub(crate) file: Option<String>,
    pub(crate) program: String,
}

impl Example {
    fn of(words: &str, place: String) -> Option<Example> {
        let mut example = Example { place, ..Example::default() };
        let mut words = words.split_whitespace();
        example.fanuc = match words.next()? {
            "ngc" => false,
            "nc-fanuc" => true,
            _ => return None,
        };
        for word in words {
            match word.split_once('=') {
                None if word == "machine" => example.machine = Some(Kinematics::Lathe),
                None if word == "mill" => example.machine = Some(Kinematics::Mill),
                Some(("error", codes)) => example.codes = codes.split(',').map(str::to_owned).collect(),
                Some(("file", name)) => example.file = Some(name.to_owned()),
                _ => panic!("{}: what does {word} mean?", example.place),
            }
        }
        Some(example)
    }
}

pub(crate) fn project() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The text of a page.
pub(crate) fn page(name: &str) -> String {
    let path = project().join("docs").join(name);
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{path:?}: {error}"))
}

/// Fences of other languages are passed over, unless their language is none of these.
const OTHERS: [&str; 3] = ["text", "sh", "json"];

/// Every example of a page, in order.
pub(crate) fn examples(name: &str) -> Vec<Example> {
    let text = page(name);
    let mut examples = Vec::new();
    let mut run = None;
    let mut lines = text.lines().enumerate();
    while let Some((index, line)) = lines.next() {
        let place = format!("docs/{name}:{}", index + 1);
        if let Some(words) = line.strip_prefix("```") {
            let program: String =
                lines.by_ref().map(|(_, line)| line).take_while(|line| *line != "```").map(end).collect();
            match Example::of(words, place.clone()) {
                Some(example) => examples.push(Example { program, ..example }),
                None => assert!(OTHERS.contains(&words), "{place}: no language of an example: {words}"),
            }
        } else if let Some(words) = line.strip_prefix("<!-- run: ") {
            run = Some(words.trim_end_matches(" -->").to_owned());
        } else if line.starts_with('#') {
            run = None;
        } else if let (Some(words), Some(cells)) = (&run, cells(line)) {
            examples.extend(of_row(words, place, &cells));
        }
    }
    examples
}

fn end(line: &str) -> String {
    format!("{line}\n")
}

fn of_row(words: &str, place: String, cells: &[String]) -> Option<Example> {
    let [code, _, program, ..] = cells else { return None };
    let (code, program) = (quoted(code)?, quoted(program)?);
    let example = Example::of(words, place)?;
    let mut program: String = program.split('⏎').map(|line| end(line.trim())).collect();
    if code != "no-program-end" {
        program.push_str("M30\n");
    }
    Some(Example { codes: vec![code.to_owned()], program, ..example })
}

/// What stands between back quotes, if that is all.
pub(crate) fn quoted(cell: &str) -> Option<&str> {
    cell.strip_prefix('`')?.strip_suffix('`').filter(|inside| !inside.contains('`'))
}

/// The cells of a row of a table.
pub(crate) fn cells(line: &str) -> Option<Vec<String>> {
    let inside = line.strip_prefix('|')?.strip_suffix('|')?;
    Some(inside.split('|').map(|cell| cell.trim().to_owned()).collect())
}

/// The rows of all tables below a heading.
pub(crate) fn rows_below(name: &str, heading: &str) -> Vec<Vec<String>> {
    let text = page(name);
    let below = text.lines().skip_while(|line| *line != heading).skip(1);
    let rows: Vec<_> = below.take_while(|line| !line.starts_with("## ")).filter_map(cells).collect();
    assert!(rows.len() > 2, "docs/{name}: no table below {heading}");
    rows
}
