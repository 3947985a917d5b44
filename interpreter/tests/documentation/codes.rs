//! The tables of G and M codes name every code that the dialects know, and no other.

use std::collections::BTreeSet;

use gcode::codes::{G, M, g_group, m_group};
use gcode::{Dialect, Options, Program};

use super::examples::{calls, options};
use super::pages::{project, rows_below};

/// No dialect has codes from here on, in tenths and in ones.
const END_G: u16 = 2000;
const END_M: u16 = 1000;

/// `G33.1` in the first cells of the tables below a heading.
fn documented(page: &str, heading: &str, letter: char) -> BTreeSet<String> {
    let rows = rows_below(page, heading);
    let cells = rows.iter().filter_map(|cells| cells.first());
    let words = cells.flat_map(|cell| cell.split([' ', ',']));
    let number = |word: &str| word.strip_prefix(letter).is_some_and(|rest| rest.parse::<f64>().is_ok());
    words.filter(|word| number(word)).map(str::to_owned).collect()
}

#[test]
fn every_code_of_the_dialect_linuxcnc_is_in_a_table() {
    let known: BTreeSet<String> =
        (0..END_G).map(G).filter(|code| g_group(*code).is_some()).map(|code| code.to_string()).collect();
    assert_eq!(documented("gcode.md", "## G codes", 'G'), known);
    let known: BTreeSet<String> =
        (0..END_M).map(M).filter(|code| m_group(*code).is_some()).map(|code| code.to_string()).collect();
    assert_eq!(documented("gcode.md", "## M codes", 'M'), known);
}

/// Codes of a dialect of FANUC that do not lead to `unknown`, and those that are refused by name.
fn of_fanuc(dialect: Dialect, letter: char, end: u16, unknown: &str) -> [BTreeSet<String>; 2] {
    let options = Options { dialect, ..options(true) };
    let [mut known, mut refused] = [BTreeSet::new(), BTreeSet::new()];
    for number in 0..end {
        let code = if letter == 'G' { G(number).to_string() } else { M(number).to_string() };
        let (codes, text) = calls(Program::from_text("O1", format!("{code}\nM30\n"), &options));
        if text.contains(&format!("{code} is not available")) {
            refused.insert(code);
        } else if codes.iter().all(|code| code != unknown) {
            known.insert(code);
        }
    }
    [known, refused]
}

#[test]
fn every_code_of_the_dialect_fanuc_is_in_a_table() {
    let [known, refused] = of_fanuc(Dialect::Fanuc, 'G', END_G, "unknown-g-code");
    assert_eq!(documented("gcode-fanuc.md", "## G codes", 'G'), known);
    assert_eq!(documented("gcode-fanuc.md", "## Refused by name", 'G'), refused);
    let [known, refused] = of_fanuc(Dialect::Fanuc, 'M', END_M, "unknown-m-code");
    assert_eq!(documented("gcode-fanuc.md", "## M codes", 'M'), known);
    assert!(refused.is_empty(), "{refused:?}");
}

#[test]
fn every_code_of_mills_of_the_dialect_fanuc_is_in_a_table() {
    let [known, refused] = of_fanuc(Dialect::FanucMill, 'G', END_G, "unknown-g-code");
    assert_eq!(documented("gcode-fanuc-mill.md", "## G codes", 'G'), known);
    assert_eq!(documented("gcode-fanuc-mill.md", "## Refused by name", 'G'), refused);
    let [known, _] = of_fanuc(Dialect::FanucMill, 'M', END_M, "unknown-m-code");
    let lathe = documented("gcode-fanuc.md", "## M codes", 'M');
    assert_eq!(&lathe | &documented("gcode-fanuc-mill.md", "## M codes", 'M'), known);
}

#[test]
fn every_limit_is_in_the_table() {
    let source = std::fs::read_to_string(project().join("gcode/src/options.rs")).expect("a source");
    let fields = source.split_once("pub struct Limits {").and_then(|(_, rest)| rest.split_once("\n}"));
    let (fields, _) = fields.expect("the limits stand in one structure");
    let names = fields.lines().filter_map(|line| line.trim().strip_prefix("pub ")?.split(':').next());
    let rows = rows_below("gcode-parameters.md", "## O words").concat().concat();
    let missing: Vec<&str> = names.filter(|name| !rows.contains(&format!("(`{name}`)"))).collect();
    assert!(missing.is_empty(), "{missing:?}");
}
