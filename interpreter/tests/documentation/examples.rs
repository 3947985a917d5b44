//! Every example of the pages is run.

use std::fs;
use std::path::{Path, PathBuf};

use gcode::canon::{Place, Sink};
use gcode::files::ToolTable;
use gcode::{Call, Dialect, Options, Problem, Program, Step};
use interpreter::{Interpreter, Language, open};
use machine::{self, Kinematics, Machine, ProgramDialect};

use super::pages::{Example, PAGES, examples, project};

/// Takes calls and forgets them.
struct Nowhere;

impl Sink for Nowhere {
    fn call(&mut self, _: Place, _: Call<'_>) -> Result<(), Box<Problem>> {
        Ok(())
    }
}

/// The tools that examples may use.
fn tools() -> PathBuf {
    project().join("tests/conformance/tool.tbl")
}

/// A folder for the files of a page.
fn folder(page: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(page);
    fs::create_dir_all(&folder).expect("a folder can be made");
    folder
}

/// Codes, each once, and what the user sees.
type Said = (Vec<String>, String);

fn said(diagnostics: &[gcode::Diagnostic]) -> Said {
    let mut codes: Vec<String> = diagnostics.iter().map(|one| one.code.to_owned()).collect();
    codes.sort();
    codes.dedup();
    (codes, diagnostics.iter().map(|one| one.render(false)).collect())
}

/// What a program is run with by `pitchlock canon -t tool.tbl`.
pub(crate) fn options(fanuc: bool) -> Options {
    let dialect = if fanuc { Dialect::Fanuc } else { Dialect::Linuxcnc };
    Options { dialect, tools: ToolTable::read(&tools()).expect("a table"), ..Options::default() }
}

/// Runs a program to its end.
pub(crate) fn calls(mut program: Program) -> Said {
    let mut found = Vec::new();
    loop {
        match program.step(&mut Nowhere) {
            Ok(Step::Ended) => break,
            Ok(Step::More) => {}
            Err(error) => found.push(*error),
        }
    }
    found.extend(program.take_warnings());
    said(&found)
}

/// As `pitchlock check --tools tool.tbl` runs it.
fn checked(path: &Path, fanuc: bool, kinematics: Kinematics) -> Said {
    let dialect = if fanuc { ProgramDialect::Fanuc } else { ProgramDialect::Linuxcnc };
    let language = Language { dialect: Some(dialect), tools: Some(tools()), ..Language::default() };
    let machine = Machine::from_toml(kinematics.example()).expect("a built-in machine");
    let program = open(path, &language, &machine).expect("the example was written");
    let mut interpreter = Interpreter::new(program, &machine);
    let mut found: Vec<_> = interpreter.by_ref().filter_map(Result::err).collect();
    found.extend_from_slice(interpreter.warnings());
    said(&found)
}

/// What is wrong with an example, if anything is.
fn finding(example: &Example, path: &Path) -> Option<String> {
    fs::write(path, &example.program).expect("an example can be written");
    if example.file.is_some() {
        return None;
    }
    let (codes, text) = match example.machine {
        Some(kinematics) => checked(path, example.fanuc, kinematics),
        None => calls(Program::open(path, &options(example.fanuc)).expect("the example was written")),
    };
    let Example { place, program, .. } = example;
    (codes != example.codes).then(|| format!("{place}: {codes:?}, not {:?}\n{program}{text}", example.codes))
}

#[test]
fn every_example_does_what_its_page_says() {
    let mut findings = Vec::new();
    for page in PAGES {
        let folder = folder(page);
        let mut examples = examples(page);
        examples.sort_by_key(|example| example.file.is_none());
        assert!(examples.len() > 2, "docs/{page}: only {} examples", examples.len());
        for (number, example) in examples.iter().enumerate() {
            let name = example.file.clone().unwrap_or_else(|| format!("example-{number}.ngc"));
            findings.extend(finding(example, &folder.join(name)));
        }
    }
    assert!(findings.is_empty(), "{}", findings.join("\n"));
}
