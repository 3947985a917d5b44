//! Single cycles: G90 (along Z), G94 (along X), G92 (a thread). Each goes in, along, out and back to where it
//! began.
//!
//! In: X Z (or U W) of the far corner, R of a taper: start less end, a radius in X (G90, G92), a length in Z
//! (G94). Words stay in force while the code does (Q, the start angle of G92, does not); a block that changes
//! any of them is another cycle.

use super::execution::{Execution, target};
use super::threads;
use crate::canon::{X, Z};
use crate::codes::G;
use crate::execute::Done;
use crate::problem::{Blame, Problem};

/// G90, G92, G94.
///
/// # Errors
/// X or Z was never given; what the moves or the thread refuse.
pub(super) fn cycle(code: G, run: &mut Execution) -> Done {
    let from = run.state.axes.position;
    let mut end = target(run.line, from)?;
    let words = &mut run.modal.single;
    if run.line.has_any("XU") {
        words.x = Some(end[X]);
    }
    if run.line.has_any("ZW") {
        words.z = Some(end[Z]);
    }
    words.taper = run.line.length('R').unwrap_or(words.taper);
    let (Some(x), Some(z)) = (words.x, words.z) else {
        let message = format!("{code} needs the corner to cut to");
        return Err(Problem::error("missing-word", Blame::G(code), message, "add X and Z (or U and W)"));
    };
    (end[X], end[Z]) = (x, z);
    let words = *words;
    if code == G(920) {
        return threads::box_cycle(end, words.taper, run);
    }
    let place = run.line.block.place();
    let [fx, fz] = [from[X], from[Z]];
    let corners = match code.0 {
        900 => [[fz, x + words.taper], [z, x], [z, fx], [fz, fx]],
        _ => [[z + words.taper, fx], [z, x], [fz, x], [fz, fx]],
    };
    for (corner, kind) in corners.into_iter().zip([G(0), G(10), G(10), G(0)]) {
        run.go(kind, corner, None, place)?;
    }
    Ok(())
}
