//! Single cycles: G90 (along Z), G94 (along X), G92 (a thread). Each goes in, along, out and back to where it began.
//!
//! In: X Z (or U W) of the far corner, R of a taper: start less end, a radius in X (G90, G92), a length in Z (G94). Words
//! stay in force while the code does (Q, the start angle of G92, does not); a block that changes any of them is another cycle.

use super::line::Line;
use super::{Done, block, threads};
use crate::block::Block;
use crate::canon::{X, Z};
use crate::codes::G;
use crate::execute::Output;
use crate::problem::{Blame, Problem};
use crate::state::State;

/// Words in force.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Words {
    /// X of the far corner, a radius.
    x: Option<f64>,
    z: Option<f64>,
    taper: f64,
}

impl Words {
    /// The units change: lengths times a factor.
    pub(super) fn convert(&mut self, factor: f64) {
        self.x = self.x.map(|x| x * factor);
        self.z = self.z.map(|z| z * factor);
        self.taper *= factor;
    }
}

/// G90, G92, G94.
///
/// # Errors
/// X or Z was never given; what the moves or the thread refuse.
pub(super) fn cycle(
    code: G,
    line: &Line,
    modal: &mut block::Modal,
    equivalent: &mut Block,
    state: &mut State,
    out: &mut Output,
) -> Done {
    let from = state.position;
    let mut end = block::target(line, from)?;
    let words = &mut modal.single;
    if line.has_any("XU") {
        words.x = Some(end[X]);
    }
    if line.has_any("ZW") {
        words.z = Some(end[Z]);
    }
    words.taper = line.length('R').unwrap_or(words.taper);
    let (Some(x), Some(z)) = (words.x, words.z) else {
        let message = format!("{code} needs the corner to cut to");
        return Err(Problem::error("missing-word", Blame::G(code), message, "add X and Z (or U and W)"));
    };
    (end[X], end[Z]) = (x, z);
    let words = *words;
    if code == G(920) {
        return threads::box_cycle((end, words.taper), modal, threads::start_angle(line)?, state, out);
    }
    let place = line.block.place();
    let [fx, fz] = [from[X], from[Z]];
    let corners = match code.0 {
        900 => [[fz, x + words.taper], [z, x], [z, fx], [fz, fx]],
        _ => [[z + words.taper, fx], [z, x], [fz, x], [fz, fx]],
    };
    for (corner, kind) in corners.into_iter().zip([G(0), G(10), G(10), G(0)]) {
        block::go(kind, corner, None, place, equivalent, state, out)?;
    }
    Ok(())
}
