//! Cuts thinner than any chip: a D, I, J or Q that lost its decimal point or a factor of a thousand makes
//! thousands of passes or pecks. In: the depth of one cut, program units. Out: a warning.

use super::Output;
use crate::canon::Units;
use crate::problem::{Blame, Problem, short};

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
    let (unit, thin) = if units == Units::Inch { ("inch", THIN[1]) } else { ("mm", THIN[0]) };
    if depth <= 0.0 || depth > thin - 1e-9 || cuts == 1.0 {
        return;
    }
    let count = if cuts > 0.0 { format!(", {cuts} times") } else { String::new() };
    let mut message = format!("{what} is {} {unit}{count}: thinner than any chip", short(depth));
    let mut help = format!("give at least {} {unit}", short(thin));
    if let Some((reading, remedy)) = other {
        message += &format!(" ({reading})");
        help = format!("{remedy}, or {help}");
    }
    out.warn(Problem::warning("unlikely-cut", blame, message, help));
}
