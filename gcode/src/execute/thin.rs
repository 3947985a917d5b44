//! Cuts thinner than any chip: a D, I, J or Q that lost its decimal point or a factor of a thousand makes
//! thousands of passes or pecks. In: the depth of one cut, program units. Out: a warning.

use super::Output;
use crate::canon::Units;
use crate::problem::{Blame, Problem};

/// Less than any tool cuts on purpose, by the unit of the program: mm, inch.
const THIN: [f64; 2] = [0.01, 0.001];

/// Warns of a depth of cut that is hardly meant; `cuts` is how many it takes, 0 if that is not known yet.
/// `other` is how else the number can be read, and what to write then.
pub(crate) fn doubt(
    (what, blame): (&str, Blame),
    depth: f64,
    cuts: f64,
    units: Units,
    other: Option<(String, String)>,
    out: &mut Output,
) {
    let thin = THIN[usize::from(units == Units::Inch)];
    if depth <= 0.0 || depth > thin - 1e-9 || cuts == 1.0 {
        return;
    }
    let count = if cuts > 0.0 { format!(", {cuts} times") } else { String::new() };
    let mut message = format!("{what} is {}{count}: thinner than any chip", units.length(depth * units.mm()));
    let mut help = format!("give at least {}", units.length(thin * units.mm()));
    if let Some((reading, remedy)) = other {
        message += &format!(" ({reading})");
        help = format!("{remedy}, or {help}");
    }
    out.warn(Problem::warning("unlikely-cut", blame, message, help));
}
