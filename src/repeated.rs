//! What follows from one cause is told once, at its first line, with how often it comes. In: diagnostics in
//! the order of their lines. Out: fewer of them. Editors get them all: each marks its line.

use std::{collections::BTreeMap, sync::Arc};

use interpreter::{Diagnostic, Severity};

/// They come again in every block until the spindle, or how feeds count, is told something else: what they
/// say of the first one is enough.
const UNTIL_TOLD: [&str; 3] = ["spindle-not-turning", "constant-surface-thread", "unlikely-feed"];

/// Errors by words and codes that a program writes again and again, and by what it asks for that is not
/// there.
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

/// What the same findings have in common: file, code, severity, and the part of their texts that counts.
type Cause = (Arc<str>, &'static str, bool, String);

/// `None`: it is told by itself.
fn cause(one: &Diagnostic) -> Option<Cause> {
    let Diagnostic { code, message, help, .. } = one;
    let is_warning = one.severity == Severity::Warning;
    let text = match *code {
        code if UNTIL_TOLD.contains(&code) => help.clone(),
        "no-such-axis" => message.split(" (").next().unwrap_or_default().to_owned(),
        "arc-radius" if help.contains("the arc fits") => help.clone(),
        // One setting of the machine file settles all of them.
        "no-decimal-point" if !is_warning => help.split_once(';').map(|(_, settled)| settled.to_owned())?,
        code if is_warning || BY_MESSAGE.contains(&code) => without_figures(message),
        _ => return None,
    };
    Some((one.file.clone(), one.code, is_warning, text))
}

/// Units of the figures that a finding gives.
const UNITS: [&str; 8] = ["mm", "inch", "s", "mm/min", "inch/min", "1/min", "degrees", "%"];

/// A text without what it measures, which differs from place to place. What names something stays: `H1`,
/// `offset 2`, `line 4`.
fn without_figures(text: &str) -> String {
    let words: Vec<&str> = text.split(' ').collect();
    let is_unit = |word: &&str| UNITS.contains(&word.trim_end_matches([',', ':', ';', '.']));
    let measures = |(at, word): (usize, &&str)| {
        let figure = word.trim_end_matches([',', ':', ';']);
        figure.parse::<f64>().is_ok() && (figure.contains('.') || words.get(at + 1).is_some_and(is_unit))
    };
    let kept = words.iter().enumerate().filter(|at| !measures(*at)).map(|(_, word)| *word);
    kept.collect::<Vec<_>>().join(" ")
}

/// Leaves the first of each.
pub(crate) fn once_each(diagnostics: &mut Vec<Diagnostic>) {
    let mut told: Vec<(Diagnostic, u32, u32)> = Vec::new();
    let mut causes = BTreeMap::<Cause, usize>::new();
    for next in diagnostics.drain(..) {
        let known = cause(&next).and_then(|cause| match causes.get(&cause) {
            Some(at) => Some(*at),
            None => {
                causes.insert(cause, told.len());
                None
            }
        });
        match known.and_then(|at| told.get_mut(at)).filter(|(first, ..)| first.line < next.line) {
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
