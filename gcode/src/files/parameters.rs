//! The parameter file: numbered parameters that outlive a run, in the form that LinuxCNC keeps them in.
//!
//! ```text
//! 5161 0.000000        number, tab, value; numbers go up
//! ```
//! Blank lines and remarks are passed over; what is neither is refused, for a number that is not read is an
//! offset of 0. A run keeps the parameters that the file names, and those that every file must have: home
//! positions, offsets of G92 and of the coordinate systems.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::sync::Arc;

use super::{FileError, replace, with_suffix};
use crate::problem::{Blame, Diagnostic, Problem, Span};

/// One more than the highest number.
const END: u32 = 5602;

/// The numbers that every file has: home positions (G28, G30), G92 in force and its offsets, the coordinate
/// system in force, and offsets and rotation of each of the nine.
fn required() -> impl Iterator<Item = u32> {
    let systems = (0..9).flat_map(|n| 5221 + 20 * n..=5230 + 20 * n);
    (5161..=5169).chain(5181..=5189).chain(5210..=5219).chain([5220]).chain(systems)
}

/// The parameters of a file, by number.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ParameterFile {
    /// Number and value, numbers ascending, 1 to 5601.
    pub values: Vec<(u32, f64)>,
}

impl ParameterFile {
    /// Reads a file. One that does not exist yet has no parameters.
    ///
    /// # Errors
    /// The file cannot be read; a line is no parameter; a number is out of range or out of order.
    pub fn read(path: &Path) -> Result<ParameterFile, FileError> {
        if !path.exists() {
            return Ok(ParameterFile::default());
        }
        Ok(ParameterFile::parse(&path.display().to_string(), &super::read(path)?)?)
    }

    /// Reads parameters from a text; `name` is what messages call it.
    ///
    /// # Errors
    /// A number is out of range or out of order.
    pub fn parse(name: &str, text: &str) -> Result<ParameterFile, Box<Diagnostic>> {
        let name: Arc<str> = name.into();
        let mut values: Vec<(u32, f64)> = Vec::new();
        for (n, line) in text.lines().enumerate() {
            if is_remark(line) {
                continue;
            }
            let (number, value) = entry(line).ok_or_else(|| {
                let start = line.len() - line.trim_start().len();
                let span = Span { start: start as u32, end: line.trim_end().len() as u32 };
                let help = "write number and value, as in 5223 -112.4; a remark begins with ; or (";
                let message = "this is not a parameter and its value";
                let problem = Problem::error("bad-file", Blame::Span(span), message, help);
                Box::new(Diagnostic::new(*problem, &name, n as u32 + 1, line, span))
            })?;
            let last = values.last().map_or(0, |(number, _)| *number);
            let (message, help) = if !(1..i64::from(END)).contains(&number) {
                (format!("there is no parameter #{number}"), format!("numbers are 1 to {}", END - 1))
            } else if number <= i64::from(last) {
                (format!("#{number} stands after #{last}"), "put the parameters in ascending order".into())
            } else {
                values.push((number as u32, value));
                continue;
            };
            let start = line.len() - line.trim_start().len();
            let end = start + line.trim_start().find(char::is_whitespace).unwrap_or(0);
            let span = Span { start: start as u32, end: end as u32 };
            let problem = Problem::error("bad-file", Blame::Span(span), message, help);
            return Err(Box::new(Diagnostic::new(*problem, &name, n as u32 + 1, line, span)));
        }
        Ok(ParameterFile { values })
    }

    /// The parameters that the file keeps, with the values they have now. The required ones are among them.
    pub fn updated(&self, value_of: impl Fn(u32) -> f64) -> ParameterFile {
        let mut numbers: Vec<u32> = self.values.iter().map(|(number, _)| *number).chain(required()).collect();
        numbers.sort_unstable();
        numbers.dedup();
        ParameterFile { values: numbers.into_iter().map(|number| (number, value_of(number))).collect() }
    }

    /// The text of a file with some parameters changed.
    pub(super) fn changed(path: &Path, old: &str, values: &[(u32, f64)]) -> Result<String, FileError> {
        ParameterFile::parse(&path.display().to_string(), old)?;
        Ok(changed(old, values))
    }

    /// A file of a machine of which only these parameters are known: all others are 0, and its coordinate
    /// system is the first.
    pub fn fresh(known: &[(u32, f64)]) -> ParameterFile {
        let given = |number| known.iter().find(|(other, _)| *other == number).map(|(_, value)| *value);
        let value = |number| given(number).unwrap_or(f64::from(u8::from(number == 5220)));
        ParameterFile::default().updated(value)
    }

    /// The parameters as the text of a file.
    pub fn to_text(&self) -> String {
        let mut text = String::new();
        for (number, value) in &self.values {
            let _ = writeln!(text, "{number}\t{value:.6}"); // a string takes everything
        }
        text
    }

    /// Writes the file: first beside the old one, then in its place. The old one stays as `NAME.bak`.
    ///
    /// # Errors
    /// The file cannot be written; the old one is as it was.
    pub fn write(&self, path: &Path) -> Result<(), FileError> {
        if path.exists() {
            let backup = with_suffix(path, ".bak");
            fs::copy(path, &backup).map_err(|error| FileError::Write { path: backup, error })?;
        }
        replace(path, self.to_text().as_bytes())
    }
}

/// The text of a file with some values changed.
fn changed(text: &str, values: &[(u32, f64)]) -> String {
    let mut left: BTreeMap<i64, f64> =
        values.iter().map(|(number, value)| (i64::from(*number), *value)).collect();
    let fresh = |(number, value): (i64, f64)| format!("{number}\t{value:.6}\n");
    let mut out = String::new();
    for line in text.split_inclusive('\n') {
        let Some((number, old)) = entry(line) else {
            out += line;
            continue;
        };
        let above = left.split_off(&number);
        out.extend(
            std::mem::replace(&mut left, above).into_iter().filter(|(_, value)| *value != 0.0).map(fresh),
        );
        match left.remove(&number) {
            // Within what six decimals tell it is the same.
            Some(value) if (value - old).abs() > 0.5e-6 => out += &with_value(line, value),
            _ => out += line,
        }
    }
    left.retain(|_, value| *value != 0.0);
    if !left.is_empty() && !out.is_empty() && !out.ends_with('\n') {
        out.push('\n');
    }
    out.extend(left.into_iter().map(fresh));
    out
}

/// A line with another value.
fn with_value(line: &str, value: f64) -> String {
    let number = line.len() - line.trim_start().len();
    let after_number = number + line[number..].find(char::is_whitespace).unwrap_or(0);
    let start = line.len() - line[after_number..].trim_start().len();
    let end = line[start..].find(char::is_whitespace).map_or(line.len(), |length| start + length);
    format!("{}{value:.6}{}", &line[..start], &line[end..])
}

/// Whether a line says nothing: it is blank, or a remark.
fn is_remark(line: &str) -> bool {
    let mut text = line.trim_start().chars();
    match text.next() {
        None | Some(';' | '(') => true,
        Some('#') => !text.next().is_some_and(|next| next.is_ascii_digit()),
        Some(_) => false,
    }
}

/// Number and value of a line, if it has both.
fn entry(line: &str) -> Option<(i64, f64)> {
    let mut parts = line.split_whitespace();
    let number = parts.next()?.parse().ok()?;
    let value: f64 = parts.next()?.parse().ok()?;
    value.is_finite().then_some((number, value))
}
