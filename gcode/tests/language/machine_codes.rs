//! M codes that are the machine's own, in both dialects.

use std::sync::Arc;

use gcode::{Dialect, MachineCode, Options, Program};

use crate::driven::driven;
use crate::fanuc::recorded::Record;

fn options(dialect: Dialect) -> Options {
    let codes = [(31, MachineCode::Ignore), (120, MachineCode::Wait), (3, MachineCode::Ignore)];
    Options { dialect, machine_codes: Arc::new(codes.into()), ..Options::default() }
}

/// Moves and stops of a program, and the codes and helps of what is wrong with it.
fn run(dialect: Dialect, text: &str) -> (Vec<String>, Vec<(u32, String)>) {
    let outcome = driven(Program::from_text("O0001.nc", text, &options(dialect)), Record::default());
    let told = outcome.errors.iter().map(|one| (one.line, format!("{}: {}", one.code, one.help)));
    (outcome.sink.moves, told.collect())
}

const BOTH: [Dialect; 2] = [Dialect::Linuxcnc, Dialect::Fanuc];

#[test]
fn what_the_machine_declares_is_left_out_or_waited_for() {
    for dialect in BOTH {
        let (plain, _) = run(dialect, "G0 X1. Z2.\nM0\nG0 X3. Z2.\nM30\n");
        let (moves, told) = run(dialect, "M31 G0 X1. Z2.\nM120\nM031\nG0 X3. Z2.\nM30\n");
        assert_eq!((moves, told), (plain, Vec::new()), "{dialect:?}");
    }
    // Of the dialect itself first.
    let (_, told) = run(Dialect::Fanuc, "G99 G1 X1. Z2. F0.1\nM30\n");
    assert!(told.iter().any(|(_, told)| told.starts_with("no-spindle-speed")), "{told:?}");
    let (_, told) = run(Dialect::Fanuc, "S500 M3\nG99 G1 X1. Z2. F0.1\nM30\n");
    assert_eq!(told, [], "M3 starts the spindle whatever is declared");
    // A line that is read again, by a loop.
    let (moves, told) = run(Dialect::Linuxcnc, "o1 repeat [3]\nM120\nM31\no1 endrepeat\nM2\n");
    assert_eq!((moves.len(), told), (3, Vec::new()));
}

#[test]
fn an_unknown_code_shows_the_line_that_declares_it() {
    for dialect in BOTH {
        let (_, told) = run(dialect, "M77\nM30\n");
        assert_eq!((told.len(), told[0].0), (1, 1), "{told:?}");
        assert!(
            told[0].1.starts_with("unknown-m-code: ") && told[0].1.contains("77 = \"ignore\""),
            "{told:?}"
        );
        let (_, told) = run(dialect, "M1000\nM30\n");
        assert!(told[0].1.contains("whole numbers up to 999"), "{told:?}");
    }
}
