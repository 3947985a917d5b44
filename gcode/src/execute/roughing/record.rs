//! The contour of a subroutine: its blocks are read, not executed.
//!
//! In: blocks with G0 to G3, X Z (a point; with G91 when the cycle began, a distance), U W (distances in X
//! and Z with G90), I K or R, and A or C (fillet or chamfer where the segment ends). Out: a contour. The
//! first move leads to its beginning. Nothing else of a block has an effect, as LinuxCNC's manual says; what
//! it is gets a warning.

use super::super::straight;
use super::{Done, Output};
use crate::block::Block;
use crate::canon::{X, Z};
use crate::codes::{G, group};
use crate::geometry::contour::{NEAR, Point, ROUNDING, Segment};
use crate::geometry::corner::{Corner, blend};
use crate::problem::{Blame, Problem, short};
use crate::state::{Piece, State};

/// What a corner leaves of a segment counts as nothing if it is not longer. LinuxCNC leaves out ten
/// times that.
const LEFTOVER: f64 = 1e-4;

/// Takes a block of the contour.
pub(crate) fn record(block: &Block, state: &mut State, out: &mut Output) -> Done {
    let piece = piece(block, state, out);
    let Some(cycle) = state.recorder.cycle_mut() else { return Ok(()) };
    match piece {
        Ok(Some(piece)) => {
            // the first piece leads to the contour, even if it has no length
            if cycle.pieces.is_empty() || piece.segment.chord() > 0.0 {
                cycle.pieces.push(piece);
            }
            (state.axes.position[Z], state.axes.position[X]) = (piece.segment.end.z, piece.segment.end.x);
            Ok(())
        }
        Ok(None) => Ok(()),
        Err(problem) => {
            cycle.broken = true;
            Err(problem)
        }
    }
}

fn piece(block: &Block, state: &mut State, out: &mut Output) -> Result<Option<Piece>, Box<Problem>> {
    match block.g(group::MOTION) {
        None => {}
        Some(code @ G(0 | 10 | 20 | 30)) => state.modes.motion = Some(code),
        Some(code) => {
            let message = format!("{code} cannot be part of a contour");
            let help = "a contour consists of G0, G1, G2 and G3";
            return Err(Problem::error("not-available", Blame::G(code), message, help));
        }
    }
    warn_of_the_rest(block, out);
    let Some(code) =
        state.modes.motion.filter(|_| ['X', 'Z', 'U', 'W'].into_iter().any(|letter| block.has(letter)))
    else {
        return Ok(None);
    };
    let start = Point::new(state.axes.position[Z], state.axes.position[X]);
    let end = Point::new(
        coordinate(start.z, ('Z', block.get('Z')), ('W', block.get('W')), state)?,
        coordinate(start.x, ('X', straight::word('X', block, state)), ('U', half('U', block, state)), state)?,
    );
    let segment = match code {
        G(20 | 30) if start != end => arc(code, start, end, block, state)?,
        _ => Segment::line(start, end),
    };
    let corner = match (block.get('A'), block.get('C')) {
        (None, None) => Corner::Sharp,
        (Some(radius), None) => Corner::Fillet(radius),
        (None, Some(radius)) => Corner::Chamfer(radius),
        (Some(_), Some(_)) => {
            let message = "A makes a fillet and C a chamfer of the same corner";
            return Err(Problem::error("bad-value", Blame::Word('C'), message, "leave one of the two out"));
        }
    };
    match corner {
        Corner::Fillet(radius) | Corner::Chamfer(radius) if radius <= 0.0 => {
            let blame = Blame::Word(if block.has('A') { 'A' } else { 'C' });
            let message = format!("a corner of {} cannot be made", short(radius));
            Err(Problem::error("bad-value", blame, message, "A and C are lengths greater than 0"))
        }
        _ => Ok(Some(Piece { segment, corner })),
    }
}

/// A word as a radius.
fn half(letter: char, block: &Block, state: &State) -> Option<f64> {
    block.get(letter).map(|value| if state.modes.diameter { value / 2.0 } else { value })
}

/// Where a block leads to along one axis.
fn coordinate(
    here: f64,
    (letter, point): (char, Option<f64>),
    (step_letter, step): (char, Option<f64>),
    state: &State,
) -> Result<f64, Box<Problem>> {
    match (point, step) {
        (None, None) => Ok(here),
        (Some(value), None) => Ok(if state.modes.incremental { here + value } else { value }),
        (None, Some(step)) if !state.modes.incremental => Ok(here + step),
        _ => {
            let message = format!("{step_letter} and {letter} both say where the move ends along {letter}");
            let message =
                if point.is_some() { message } else { format!("{step_letter} works with G90 only") };
            let help = format!("write {letter} alone");
            Err(Problem::error("bad-value", Blame::Word(step_letter), message, help))
        }
    }
}

fn arc(code: G, start: Point, end: Point, block: &Block, state: &State) -> Result<Segment, Box<Problem>> {
    let ccw = code == G(30);
    let (i, k) = (block.get('I'), block.get('K'));
    let refuse = |letter: char, message: String, help: &str| {
        Err(Problem::error("arc-radius", Blame::Word(letter), message, help))
    };
    if let Some(radius) = block.get('R') {
        if i.is_some() || k.is_some() {
            let message = format!("{code} has a centre and a radius");
            return Err(Problem::error("bad-value", Blame::Word('R'), message, "leave one of the two out"));
        }
        return match Segment::arc_of_radius(start, end, radius, ccw) {
            Some(arc) => Ok(arc),
            None => {
                let half = short(start.distance(end) / 2.0);
                let message =
                    format!("the radius {} does not reach the end: it is at least {half}", short(radius));
                refuse('R', message, "give a greater R, or correct X or Z")
            }
        };
    }
    if i.is_none() && k.is_none() {
        let message = format!("{code} has neither a centre (I, K) nor a radius (R)");
        let help = "add the one or the other; write G1 for a straight move";
        return Err(Problem::error("missing-word", Blame::G(code), message, help));
    }
    let words = Point::new(k.unwrap_or(0.0), i.unwrap_or(0.0));
    let center = if state.modes.absolute_centers { words } else { start + words };
    let (r1, r2) = (center.distance(start), center.distance(end));
    if (r1 - r2).abs() > (ROUNDING * r1).max(10.0 * ROUNDING) || r1.min(r2) < NEAR {
        let message =
            format!("the radius of the arc is {} at its start and {} at its end", short(r1), short(r2));
        let letter = if i.is_some() { 'I' } else { 'K' };
        return refuse(
            letter,
            message,
            "give end and centre with more digits, or correct the one that is wrong",
        );
    }
    Ok(Segment::arc(start, end, center, ccw))
}

/// What has no effect in a contour.
fn warn_of_the_rest(block: &Block, out: &mut Output) {
    let letters = block.letters().filter(|letter| !"XZUWIKRAC".contains(*letter)).map(Blame::Word);
    let g_codes = block.g_codes().filter(|code| code.0 > 30).map(Blame::G);
    let codes = g_codes.chain(block.m_codes().map(Blame::M));
    for blame in codes.chain(letters) {
        let what = match blame {
            Blame::G(code) => code.to_string(),
            Blame::M(code) => code.to_string(),
            Blame::Word(letter) => letter.to_string(),
            _ => continue,
        };
        let message = format!("{what} has no effect in the contour of a cycle");
        out.warn(Problem::warning(
            "unused-word",
            blame,
            message,
            "write it before the cycle, or leave it out",
        ));
    }
}

/// The contour after the move that leads to it, with its corners made.
///
/// # Errors
/// A corner that cannot be made, and where.
pub(super) fn contour(pieces: &[Piece]) -> Result<Vec<Segment>, (String, Point)> {
    let mut contour: Vec<Segment> = Vec::with_capacity(pieces.len());
    let mut corner = Corner::Sharp;
    for piece in pieces {
        let next = piece.segment;
        match (contour.last_mut(), corner) {
            (None, _) | (_, Corner::Sharp) => contour.push(next),
            (Some(last), _) => {
                let Some([before, between, after]) = blend(last, &next, corner) else {
                    return Err(("the fillet or chamfer finds no room".into(), last.end));
                };
                *last = before;
                contour.extend([between, after]);
            }
        }
        corner = piece.corner;
    }
    match (corner, contour.last()) {
        (Corner::Fillet(_) | Corner::Chamfer(_), Some(last)) => {
            Err(("a fillet or chamfer needs a segment after it".into(), last.end))
        }
        _ => {
            contour.drain(..contour.len().min(1));
            contour.retain(|segment| segment.chord() > LEFTOVER);
            Ok(contour)
        }
    }
}
