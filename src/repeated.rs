//! What follows from one cause is told once, at its first line, with how often it comes. In: diagnostics in
//! the order of their lines. Out: fewer of them. Editors get them all: each marks its line.

use interpreter::Diagnostic;

/// They come again in every block until the spindle, or how feeds count, is told something else.
const UNTIL_TOLD: [&str; 3] = ["spindle-not-turning", "constant-surface-thread", "unlikely-feed"];

/// Words and codes that a program writes again and again, and what it asks for that is not there.
const BY_MESSAGE: [&str; 9] = [
    "bad-contour",
    "modal-group",
    "no-subroutine",
    "not-available",
    "unknown-g-code",
    "unknown-label",
    "unknown-m-code",
    "unknown-tool",
    "unused-word",
];

/// Whether the second says the same as the first.
fn is_same(first: &Diagnostic, second: &Diagnostic) -> bool {
    let of_axis = |message: &str| message.split(" (").next().map(str::to_owned);
    let alike = UNTIL_TOLD.contains(&first.code) && first.help == second.help
        || BY_MESSAGE.contains(&first.code) && first.message == second.message
        || first.code == "no-such-axis" && of_axis(&first.message) == of_axis(&second.message)
        || first.code == "arc-radius" && first.help == second.help && first.help.contains("the arc fits");
    alike
        && (&first.file, first.code, first.severity) == (&second.file, second.code, second.severity)
        && first.line < second.line
}

/// Leaves the first of each.
pub(crate) fn once_each(diagnostics: &mut Vec<Diagnostic>) {
    let mut told: Vec<(Diagnostic, u32, u32)> = Vec::new();
    for next in diagnostics.drain(..) {
        match told.iter_mut().find(|(first, ..)| is_same(first, &next)) {
            Some((_, more, last)) => (*more, *last) = (*more + 1, next.line),
            None => told.push((next, 0, 0)),
        }
    }
    diagnostics.extend(told.into_iter().map(|(mut first, more, last)| {
        match more {
            0 => {}
            1 => first.message += &format!(" (and again in line {last})"),
            _ => first.message += &format!(" (and {more} times more, up to line {last})"),
        }
        first
    }));
}
