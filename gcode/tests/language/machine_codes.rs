//! M codes that are the machine's own, in both dialects.

use std::sync::Arc;

use gcode::{Call, Dialect, MachineCode, Options, Place, Problem, Program, Sink};

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

#[test]
fn a_code_of_the_machine_switches_an_output_as_m64_does() {
    let of = |dialect, text: &str| {
        let codes = [
            (31, MachineCode::Output { number: 3, on: true }),
            (32, MachineCode::Output { number: 3, on: false }),
        ];
        let options = Options { dialect, machine_codes: Arc::new(codes.into()), ..Options::default() };
        let outcome = driven(Program::from_text("O0001.nc", text, &options), Switches::default());
        let told: Vec<_> = outcome.errors.iter().map(|one| one.code).collect();
        (outcome.sink.0, told)
    };
    for dialect in BOTH {
        let (calls, told) = of(dialect, "M31 G0 X1. Z2.\nM032\nG0 X3. Z2.\nM31\nM30\n");
        let expected = ["out 3 true", "move", "out 3 false", "move", "out 3 true"];
        assert_eq!((calls, told), (expected.map(String::from).to_vec(), Vec::new()), "{dialect:?}");
        let (_, told) = of(dialect, "M31 M32\nM30\n");
        assert_eq!(told.len(), 1, "{dialect:?}: two of them in one block: {told:?}");
    }
    let (calls, _) = of(Dialect::Linuxcnc, "o1 repeat [2]\nM31\nM32\no1 endrepeat\nM2\n");
    assert_eq!(calls.len(), 4, "a loop does them again: {calls:?}");
    let codes = [(64, MachineCode::Output { number: 5, on: true })];
    let options =
        Options { dialect: Dialect::Fanuc, machine_codes: Arc::new(codes.into()), ..Options::default() };
    let outcome = driven(Program::from_text("O0001.nc", "M64\nM30\n", &options), Switches::default());
    assert_eq!(outcome.sink.0, ["out 5 true"], "a number that means another code elsewhere");
    let (linuxcnc, _) = of(Dialect::Linuxcnc, "M64 P3\nM65 P3\nM2\n");
    assert_eq!(linuxcnc, ["out 3 true", "out 3 false"]);
}

/// LinuxCNC rounds it: another output than the one that was meant.
#[test]
fn half_an_output_is_refused() {
    for (text, word) in [
        ("M64 P3.5", "P3.5"),
        ("M62 P2.5", "P2.5"),
        ("M63 P0.2", "P0.2"),
        ("M66 E0.5 L0", "E0.5"),
        ("M68 E1.5 Q2", "E1.5"),
        ("M66 P1.5 L3 Q1", "P1.5"),
        ("M66 P1 L3.2 Q1", "L3.2"),
    ] {
        let text = format!("{text}\nM65 P4\nM2\n");
        let outcome = driven(Program::from_text("A", &*text, &Options::default()), Switches::default());
        let told: Vec<_> = outcome.errors.iter().map(|one| (one.code, one.message.as_str())).collect();
        assert_eq!(told, [("bad-value", &*format!("{word} is not a whole number"))], "{text}");
        assert_eq!(outcome.sink.0, ["out 4 false"], "the rest is read");
    }
}

/// A tolerance below 0 is none: LinuxCNC takes the block as if the word were not there.
#[test]
fn a_negative_tolerance_is_refused() {
    for (text, word) in [("G64 P-1", "P-1"), ("G64 P0.1 Q-0.2", "Q-0.2")] {
        let text = format!("{text}\nM2\n");
        let outcome = driven(Program::from_text("A", &*text, &Options::default()), Switches::default());
        let told: Vec<_> = outcome.errors.iter().map(|one| (one.code, one.message.as_str())).collect();
        assert_eq!(told, [("bad-value", &*format!("{word} is not a tolerance"))], "{text}");
    }
}

/// Switches and moves in their order.
#[derive(Default)]
struct Switches(Vec<String>);

impl Sink for Switches {
    fn call(&mut self, _: Place, call: Call<'_>) -> Result<(), Box<Problem>> {
        match call {
            Call::SetAuxOutputBit(number, on) => self.0.push(format!("out {number} {on}")),
            Call::StraightTraverse(_) => self.0.push("move".into()),
            _ => {}
        }
        Ok(())
    }
}
