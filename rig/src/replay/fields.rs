//! The fields of a message by their names. In: anything that derives `Debug`, in the pretty form of which
//! every field has a line of its own. Out: paths, as in `axes.2.motor_mm`, with what stands there.

use std::fmt::Debug;

/// Every field with its value, in the order of its type.
pub fn fields(message: &dyn Debug) -> Vec<(String, String)> {
    let text = format!("{message:#?}");
    // The name of each thing that is open, and how many without a name have been in it.
    let mut open: Vec<(String, usize)> = Vec::new();
    let mut fields = Vec::new();
    for line in text.lines() {
        let line = line.trim().trim_end_matches(',');
        if matches!(line, "}" | ")" | "]") {
            open.pop();
            continue;
        }
        let named =
            line.split_once(": ").filter(|(name, _)| name.chars().all(|c| c == '_' || c.is_alphanumeric()));
        let (name, value) = match (named, open.last_mut()) {
            (Some((name, value)), _) => (name.to_owned(), value),
            (None, Some((_, number))) => {
                *number += 1;
                ((*number - 1).to_string(), line)
            }
            (None, None) => (String::new(), line),
        };
        if value.ends_with(['{', '(', '[']) {
            open.push((name, 0));
        } else {
            let outer = open.iter().map(|(name, _)| name.as_str()).filter(|name| !name.is_empty());
            let path: Vec<&str> = outer.chain([name.as_str()]).collect();
            // A number in a wrapper of its own is that number.
            fields.push((path.join(".").trim_end_matches(".0").to_owned(), value.to_owned()));
        }
    }
    fields
}

/// The first field in which two messages differ, with both values. Checksums differ wherever anything does:
/// one is
/// named only if nothing else is.
pub fn first_difference(one: &dyn Debug, other: &dyn Debug) -> Option<(String, [String; 2])> {
    let (one, other) = (fields(one), fields(other));
    let mut pairs: Vec<_> = one.into_iter().zip(other).filter(|(one, other)| one != other).collect();
    let first = pairs.iter().position(|((path, _), _)| path.rsplit('.').next() != Some("check")).unwrap_or(0);
    let pair = (first < pairs.len()).then(|| pairs.swap_remove(first))?;
    Some((pair.0.0, [pair.0.1, pair.1.1]))
}

#[cfg(test)]
mod tests {
    use protocol::{Cycle, DriveCommand, Truth};

    use super::*;

    #[test]
    fn a_field_is_named_by_its_path() {
        let one = Truth { cycle: Cycle(7), ..Truth::default() };
        let mut other = one;
        assert_eq!(first_difference(&one, &other), None);
        other.measurement.panel.buttons = 16;
        let differs = |other: &Truth| first_difference(&one, other).expect("it differs");
        assert_eq!(differs(&other), ("measurement.panel.buttons".into(), ["0".into(), "16".into()]));
        other.axes[2].slide_mm = -0.0;
        assert_eq!(differs(&other), ("axes.2.slide_mm".into(), ["0.0".into(), "-0.0".into()]));
        other.cycle = Cycle(8);
        assert_eq!(differs(&other).0, "cycle");
    }

    #[test]
    fn a_checksum_is_named_only_if_nothing_else_differs() {
        let one = DriveCommand { torque_offset_nm: 1.0, ..DriveCommand::default() }.sealed();
        let other = DriveCommand { torque_offset_nm: 2.0, ..one }.sealed();
        assert_ne!(one.check, other.check);
        assert_eq!(first_difference(&one, &other).expect("it differs").0, "torque_offset_nm");
        let damaged = DriveCommand { check: one.check ^ 1, ..one };
        assert_eq!(first_difference(&one, &damaged).expect("it differs").0, "check");
    }
}
