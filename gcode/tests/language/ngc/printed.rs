//! Programs as their moves are printed: short to write, exact to compare.

use gcode::canon::LinuxcncPrinter;
use gcode::{Diagnostic, Options, Program, Step};

use super::recorded::outcome;

/// The calls of a program without fault as LinuxCNC prints them, without numbers, prologue and `M2`; rotary
/// axes that stand at 0, trailing zeros and the sign of zero are left out.
pub(crate) fn printed(text: &str) -> Vec<String> {
    let mut program = Program::from_text("test.ngc", format!("{text}\nM0\nM2\n"), &Options::default());
    let mut bytes = Vec::new();
    let mut printer = LinuxcncPrinter::new(&mut bytes);
    while program.step(&mut printer).unwrap_or_else(|error| panic!("{}", error.render(false))) == Step::More {
    }
    printer.flush().expect("a buffer takes everything");
    drop(printer);
    let text = String::from_utf8(bytes).expect("a buffer takes everything");
    let calls = text.lines().filter_map(|line| line.split_once(" N..... "));
    let calls = calls.map(|(_, call)| call).skip_while(|call| *call != "ON_RESET()").skip(1);
    calls.take_while(|call| *call != "PROGRAM_STOP()").map(tidy).collect()
}

/// `STRAIGHT_FEED(1.5000, 0.0000, ...)` as `STRAIGHT_FEED 1.5 0 0`.
fn tidy(call: &str) -> String {
    let call = call.strip_suffix(", 0.0000, 0.0000, 0.0000)").unwrap_or(call).trim_end_matches(')');
    let (name, arguments) = call.split_once('(').unwrap_or((call, ""));
    let numbers = arguments.split([',', ' ']).filter(|number| !number.is_empty()).map(|number| match number
        .contains('.')
    {
        true => match number.trim_end_matches('0').trim_end_matches('.') {
            "-0" => "0",
            number => number,
        },
        false => number,
    });
    std::iter::once(name).chain(numbers).collect::<Vec<_>>().join(" ")
}

/// The moves among them, with G0, G1 and ARC for their names.
pub(crate) fn moves(text: &str) -> Vec<String> {
    let names = [("STRAIGHT_TRAVERSE", "G0"), ("STRAIGHT_FEED", "G1"), ("ARC_FEED", "ARC")];
    let short = |call: &String| {
        let (name, numbers) = call.split_once(' ')?;
        let (_, short) = names.iter().find(|(long, _)| *long == name)?;
        Some(format!("{short} {numbers}"))
    };
    printed(text).iter().filter_map(short).collect()
}

/// The last of the moves.
pub(crate) fn last_move(text: &str) -> String {
    moves(text).pop().unwrap_or_default()
}

/// The one error of a program: its code, and that its message holds all of `parts`.
pub(crate) fn refused(text: &str, code: &str, parts: &[&str]) {
    let outcome = outcome(&format!("{text}\nM2\n"));
    let [error] = outcome.errors.as_slice() else {
        panic!("{text}: {:?}", outcome.errors.iter().map(Diagnostic::headline).collect::<Vec<_>>())
    };
    assert_eq!(error.code, code, "{text}: {}", error.headline());
    for part in parts {
        assert!(error.message.contains(part), "{text}: {}", error.headline());
    }
    assert!(!error.help.is_empty(), "{text}");
}

/// The codes of the warnings of a program without fault.
pub(crate) fn warned(text: &str) -> Vec<&'static str> {
    let outcome = outcome(&format!("{text}\nM2\n"));
    assert!(outcome.errors.is_empty(), "{text}: {:?}", outcome.errors);
    outcome.warnings.iter().map(|warning| warning.code).collect()
}
