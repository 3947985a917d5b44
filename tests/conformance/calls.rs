//! Outputs as lists of calls that can be compared: the rules of `README.md`, under the same numbers.

/// Two numbers this close are equal (rule 6).
const TOLERANCE: f64 = 1e-4;

/// Calls of the beginning, each at most once (rule 3).
const PROLOGUE: [&str; 6] = [
    "USE_LENGTH_UNITS",
    "SET_G5X_OFFSET",
    "SET_G92_OFFSET",
    "SET_XY_ROTATION",
    "SET_FEED_REFERENCE",
    "ON_RESET",
];

/// An argument.
#[derive(Clone, Debug)]
enum Argument {
    Number(f64),
    Text(String),
}

impl Argument {
    fn equals(&self, other: &Argument) -> bool {
        match (self, other) {
            (Argument::Number(a), Argument::Number(b)) => {
                let huge = a.abs() > 1e20 && b.abs() > 1e20;
                huge || (a - b).abs() <= TOLERANCE + 1e-9 * (1.0 + a.abs().max(b.abs()))
            }
            (Argument::Text(a), Argument::Text(b)) => a == b,
            _ => false,
        }
    }
}

/// A call.
#[derive(Clone, Debug)]
pub(crate) struct Call {
    pub(crate) name: String,
    arguments: Vec<Argument>,
    text: String,
}

impl Call {
    /// Rule 6: numbers that are missing at the end are 0.
    fn same_arguments(&self, other: &Call) -> bool {
        let zero = Argument::Number(0.0);
        let count = self.arguments.len().max(other.arguments.len());
        let at = |call: &Call, n: usize| call.arguments.get(n).unwrap_or(&zero).clone();
        (0..count).all(|n| at(self, n).equals(&at(other, n)))
    }
}

/// Rule 1: a line `NAME(...)`, after an optional number and an optional N field.
fn call_of(line: &str) -> Option<(String, String)> {
    let line = line.trim();
    let behind_number = line.trim_start_matches(|c: char| c.is_ascii_digit());
    let line = if behind_number.starts_with(' ') { behind_number.trim_start() } else { line };
    let line = match line.strip_prefix('N') {
        Some(rest) if rest.starts_with('.') => rest.trim_start_matches('.').trim_start(),
        Some(rest) if rest.starts_with(|c: char| c.is_ascii_digit()) => {
            rest.trim_start_matches(|c: char| c.is_ascii_digit()).trim_start()
        }
        _ => line,
    };
    let (name, arguments) = line.split_once('(')?;
    let legal = |c: char| c.is_ascii_uppercase() || c.is_ascii_digit() || "_.".contains(c);
    let is_name = name.starts_with(|c: char| c.is_ascii_uppercase()) && name.chars().all(legal);
    let arguments = arguments.strip_suffix(')')?.trim();
    is_name.then(|| (name.to_owned(), arguments.to_owned()))
}

/// The calls of an output, ready to be compared.
pub(crate) fn normalised(output: &str) -> Vec<Call> {
    let calls: Vec<_> = output.lines().filter_map(call_of).collect();
    let mut result: Vec<Call> = Vec::new();
    for (name, text) in calls.iter().skip(prologue(&calls)) {
        let note = name == "COMMENT" && text.starts_with("\"interpreter:");
        if note || name == "ON_RESET" || name == "START_CHANGE" {
            continue; // rule 2
        }
        let spelling = name.strip_suffix('H').filter(|name| name.ends_with("_SPEED_FEED_SYNC"));
        let name = spelling.unwrap_or(name).to_owned(); // rule 4
        let arguments = if name == "CHANGE_TOOL" { Vec::new() } else { arguments(text) };
        let call = Call { text: format!("{name}({text})"), name, arguments };
        if call.name == "SET_TOOL_TABLE_ENTRY"
            && matches!(call.arguments.first(), Some(Argument::Number(0.0)))
        {
            continue; // rule 4
        }
        let stays = |last: &Call| {
            ["STRAIGHT_TRAVERSE", "STRAIGHT_FEED"].contains(&last.name.as_str()) && last.same_arguments(&call)
        };
        if call.name == "STRAIGHT_TRAVERSE" && result.last().is_some_and(stays) {
            continue; // rule 5
        }
        result.push(call);
    }
    result
}

/// Rule 3: how many calls of the beginning do not count.
fn prologue(calls: &[(String, String)]) -> usize {
    let mut seen = Vec::new();
    for (name, _) in calls {
        if !PROLOGUE.contains(&name.as_str()) || seen.contains(name) {
            break;
        }
        seen.push(name.clone());
    }
    let whole = seen.iter().any(|name| name == "SET_FEED_REFERENCE" || name == "ON_RESET");
    if whole { seen.len() } else { 0 }
}

fn arguments(text: &str) -> Vec<Argument> {
    if text.contains('"') {
        return quoted(text);
    }
    let parts = text.split([',', ' ', '\t']).filter(|part| !part.is_empty());
    let argument = |part: &str| match number(part) {
        Some((value, length)) if length == part.len() => Argument::Number(value),
        _ => Argument::Text(part.to_owned()),
    };
    parts.map(argument).collect()
}

/// Rule 7: text, with numbers in it as numbers.
fn quoted(text: &str) -> Vec<Argument> {
    let text = text.trim().trim_matches('"').split_whitespace().collect::<Vec<_>>().join(" ");
    let mut found = Vec::new();
    let mut words = String::new();
    let flush = |words: &mut String, found: &mut Vec<Argument>| {
        let text = std::mem::take(words);
        if !text.trim().is_empty() {
            found.push(Argument::Text(text.trim().to_owned()));
        }
    };
    let mut rest = text.as_str();
    while let Some(first) = rest.chars().next() {
        if let Some((value, length)) = number(rest) {
            flush(&mut words, &mut found);
            found.push(Argument::Number(value));
            rest = &rest[length..];
        } else {
            words.push(first);
            rest = &rest[first.len_utf8()..];
        }
    }
    flush(&mut words, &mut found);
    found
}

/// A decimal number at the beginning of a text, and how many bytes it takes.
fn number(text: &str) -> Option<(f64, usize)> {
    let digits = |from: usize| text[from..].bytes().take_while(u8::is_ascii_digit).count();
    let sign = usize::from(text.starts_with(['+', '-']));
    let whole = digits(sign);
    let point = sign + whole;
    let fraction = if text[point..].starts_with('.') { 1 + digits(point + 1) } else { 0 };
    if whole == 0 && fraction < 2 {
        return None;
    }
    let mut end = point + fraction;
    if text[end..].starts_with(['e', 'E']) {
        let sign = usize::from(text[end + 1..].starts_with(['+', '-']));
        let exponent = digits(end + 1 + sign);
        end += if exponent > 0 { 1 + sign + exponent } else { 0 };
    }
    Some((text[..end].parse().ok()?, end))
}

/// Where two lists of calls part.
pub(crate) fn first_difference(expected: &[Call], output: &[Call]) -> Option<String> {
    let same = |a: &Call, b: &Call| a.name == b.name && a.same_arguments(b);
    let differs = |n: &usize| match (expected.get(*n), output.get(*n)) {
        (Some(a), Some(b)) => !same(a, b),
        _ => true,
    };
    let n = (0..expected.len().max(output.len())).find(differs)?;
    let text = |calls: &[Call]| calls.get(n).map_or("nothing".to_owned(), |call| call.text.clone());
    Some(format!("call {}: {} instead of {}", n + 1, text(output), text(expected)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn difference(a: &str, b: &str) -> Option<String> {
        first_difference(&normalised(a), &normalised(b))
    }

    #[test]
    fn what_does_not_matter_is_no_difference() {
        for (a, b) in [
            ("   12 N0010  DWELL(1.5000)", "DWELL(1.50005)"),
            ("    1 N..... DWELL(1)\nto the log 12", "DWELL(1)\n\n"),
            ("STRAIGHT_FEED(1, 2, 3, 0, 0, 0)", "STRAIGHT_FEED(1, 2, 3)"),
            ("START_SPEED_FEED_SYNC(2.0,0)", "START_SPEED_FEED_SYNCH(2.0, 0)"),
            ("SET_SPINDLE_MODE(0 1e30)", "SET_SPINDLE_MODE(0 1e25)"),
            ("MESSAGE(\" x  1.50 \")", "MESSAGE(\"x 1.5\")"),
            ("USE_LENGTH_UNITS(CANON_UNITS_MM)\nON_RESET()\nDWELL(1)", "DWELL(1)"),
            ("STRAIGHT_FEED(1)\nSTRAIGHT_TRAVERSE(1, 0)", "STRAIGHT_FEED(1)"),
            ("CHANGE_TOOL(3)\nSET_TOOL_TABLE_ENTRY(0, 1)", "START_CHANGE()\nCHANGE_TOOL()"),
        ] {
            assert_eq!(difference(a, b), None, "{a} {b}");
        }
    }

    #[test]
    fn what_matters_is_a_difference() {
        for (a, b) in [
            ("DWELL(1.5)", "DWELL(1.5003)"),
            ("DWELL(1.5)", "SET_FEED_RATE(1.5)"),
            ("DWELL(1.5)", ""),
            ("STRAIGHT_FEED(1, 2, 3)", "STRAIGHT_FEED(1, 2, 3, 1)"),
            ("SELECT_PLANE(CANON_PLANE_XY)", "SELECT_PLANE(CANON_PLANE_XZ)"),
            ("MESSAGE(\"x 1.5 y\")", "MESSAGE(\"x 1.6 y\")"),
            ("USE_LENGTH_UNITS(CANON_UNITS_MM)", "USE_LENGTH_UNITS(CANON_UNITS_INCHES)"),
            ("STRAIGHT_TRAVERSE(1)\nSTRAIGHT_FEED(1)", "STRAIGHT_TRAVERSE(1)"),
        ] {
            assert!(difference(a, b).is_some(), "{a} {b}");
        }
    }
}
