//! Cuts thinner than any chip: a D, I, J or Q that lost its decimal point or a factor of a thousand makes
//! thousands of passes or pecks. In: the depth of one cut, program units. Out: a warning.

use super::Output;
use crate::canon::Units;
use crate::problem::{Blame, Problem, short};

/// Less than any tool cuts on purpose, mm.
const THIN_MM: f64 = 0.01;

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
    if depth <= 0.0 || depth * units.mm() > THIN_MM - 1e-9 || cuts == 1.0 {
        return;
    }
    let unit = if units == Units::Inch { "inch" } else { "mm" };
    let count = if cuts > 0.0 { format!(", {cuts} times") } else { String::new() };
    let mut message = format!("{what} is {} {unit}{count}: thinner than any chip", short(depth));
    let mut help = format!("give at least {} {unit}", short(THIN_MM / units.mm()));
    if let Some((reading, remedy)) = other {
        message += &format!(" ({reading})");
        help = format!("{remedy}, or {help}");
    }
    out.warn(Problem::warning("unlikely-cut", blame, message, help));
}
