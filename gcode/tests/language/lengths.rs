//! Whose length a tool works with: what is warned of, with its line and remedy, and what is not.

use gcode::files::ToolTable;
use gcode::{Call, Dialect, Options, Place, Problem, Program, Sink};

use crate::driven::driven;

struct Nobody;

impl Sink for Nobody {
    fn call(&mut self, _: Place, _: Call<'_>) -> Result<(), Box<Problem>> {
        Ok(())
    }
}

/// Codes and lines of the warnings of a program.
fn warned(dialect: Dialect, is_mill: bool, tools: &str, text: &str) -> Vec<(&'static str, u32)> {
    let tools = ToolTable::parse("tools", tools).expect("a table");
    let options = Options { dialect, is_mill, tools, ..Options::default() };
    let outcome = driven(Program::from_text("lengths.nc", text, &options), Nobody);
    assert!(outcome.errors.is_empty(), "{text}{:?}", outcome.errors);
    outcome.warnings.iter().map(|one| (one.code, one.line)).collect()
}

const TABLE: &str = "T1 Z50 D6\nT2 Z60 D8\nT4 Z70\nT5 Z80\n";

fn fanuc(text: &str) -> Vec<(&'static str, u32)> {
    warned(Dialect::FanucMill, false, TABLE, &format!("G21 G17 G90 G94\n{text}M30\n"))
}

fn linuxcnc(text: &str) -> Vec<(&'static str, u32)> {
    warned(Dialect::Linuxcnc, true, TABLE, &format!("G21 G17 G90 G94\n{text}M2\n"))
}

#[test]
fn the_length_of_another_tool_is_warned_of_once() {
    assert_eq!(fanuc("T5 M06\nG43 H4 Z20.\nG00 Z30.\nG43 H4 Z20.\n"), [("other-length", 3)]);
    assert_eq!(linuxcnc("T5 M6\nG43 H4\nG0 Z20\nG43 H4\n"), [("other-length", 3)]);
    assert_eq!(
        fanuc("T4 M06\nG43 H4 Z20.\nT5 M06\nG43 Z20.\n"),
        [("other-length", 5)],
        "H of the last block is in force"
    );
    assert_eq!(fanuc("T5 M06\nG43 H5 Z20.\nG49\nT1\nG43 H5 Z30.\n"), [], "the next one is not in yet");
    assert_eq!(fanuc("G43 H4 Z20.\n"), [], "whatever is in the spindle");
    assert_eq!(linuxcnc("T5 M6\nG43\nG0 Z20\nG43 H0\nG43.2 H4\n"), []);
    assert_eq!(warned(Dialect::Linuxcnc, false, TABLE, "T5 M6\nG43 H4\nG0 Z2\nM2\n"), [], "wear of a lathe");
}

#[test]
fn a_tool_that_moves_along_z_without_a_length_is_warned_of_once() {
    for run in [fanuc, linuxcnc] {
        let two = "T1 M06\nG43 H1\nG00 Z20.\nT2 M06\n";
        assert_eq!(run(&format!("{two}G00 X5.\nZ20.\nZ10.\nT5 M06\nG00 Z5.\n")), [("no-length", 7)]);
        assert_eq!(run(&format!("{two}G00 X5.\nG43 H2 Z20.\nZ10.\n")), []);
        assert_eq!(run(&format!("{two}G53 G00 Z0\nG28 Z0\nG49\nG00 Z20.\n")), [], "none is meant");
        assert_eq!(run(&format!("{two}G81 X5. Z-3. R2. F100.\nG80\n")), [("no-length", 6)]);
        assert_eq!(run("T1 M06\nG00 Z20.\n"), [("no-length", 3)], "the table has one");
    }
    for table in ["", "T3 D6\n"] {
        let run = |text: &str| warned(Dialect::Linuxcnc, true, table, text);
        assert_eq!(run("T3 M6\nG0 Z20\nM2\n"), [], "one tool, and nobody speaks of lengths");
        assert_eq!(run("G49\nT3 M6\nG0 Z20\nM2\n"), [], "nor does a line that sets the machine to rights");
        assert_eq!(run("G0 Z20\nM2\n"), []);
        assert_eq!(run("T3 M6\nG0 Z20\nT3 M6\nG0 Z5\nM2\n"), [], "it is in already");
    }
    assert_eq!(warned(Dialect::Linuxcnc, true, "", "T3 M6\nG0 Z20\nT4 M6\nG0 Z5\nM2\n"), [("no-length", 4)]);
    assert_eq!(
        warned(Dialect::Linuxcnc, false, TABLE, "T1 M6\nG0 Z20\nT2 M6\nG0 Z5\nM2\n"),
        [],
        "of a lathe"
    );
}

#[test]
fn offsets_of_a_lathe_without_a_table_are_warned_of_once() {
    let run = |table: &str, text: &str| warned(Dialect::Fanuc, false, table, text);
    let program = "O1\nT0909\nG00 X40. Z2.\nT0303\nX30.\nM30\n";
    assert_eq!(run("", program), [("unknown-tool", 2)]);
    assert_eq!(run("", "O1\nT0900\nG00 X40. Z2.\nT0000\nM30\n"), []);
    assert_eq!(run("T3 Z5\nT9 Z6\n", program), []);
    assert_eq!(run("T3 Z5\n", program), [("unknown-tool", 2)]);
}
