//! Roughing cycles in one block, `G71 P Q U W D F`, and the words of such a block that G70 has no use for.
//!
//! In: the words of the block. Out: depth of cut and retract, or a warning.

use super::line::Line;
use super::points::doubt_cut;
use crate::execute::Output;
use crate::problem::{Blame, Problem, short};

/// How far a pass goes back where the block that gives the depth has no word for it, mm and inch.
const RETRACT: [f64; 2] = [0.5, 0.02];

/// Warns of words that G70 has no use for.
pub(super) fn unused(line: &Line, out: &mut Output) {
    let Some(letter) = ['U', 'W', 'D'].into_iter().find(|letter| line.has(*letter)) else { return };
    let message = format!("{letter} does nothing here: G70 cuts the contour itself, in one pass");
    let help = "allowances and depths belong to G71, G72 and G73: leave it out";
    out.warn(Problem::warning("no-effect", Blame::Word(letter), message, help));
}

/// Depth of cut and retract of a cycle in one block, if it is.
///
/// # Errors
/// The depth is not greater than 0.
pub(super) fn depth(cycle: &Line, out: &mut Output) -> Result<Option<(f64, f64)>, Box<Problem>> {
    let Some(depth) = cycle.length('D') else { return Ok(None) };
    if depth <= 0.0 {
        let message = format!("the depth of cut is {}", short(depth));
        let help = "give a radius greater than 0, such as D2.";
        return Err(Problem::error("bad-value", Blame::Word('D'), message, help));
    }
    doubt_cut(("the depth of cut", 'D', false), depth, 0.0, cycle, out);
    Ok(Some((depth, RETRACT[usize::from(cycle.unit() == "inch")])))
}
