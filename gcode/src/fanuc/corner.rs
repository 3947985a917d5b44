//! Corners that are cut off or rounded: `,C` and `,R` after any straight move, C R I K of G01 along one axis.
//!
//! In: a straight move and the one after it. Out: the first one shortened, and what goes between them.
//!
//! | symbol | meaning |
//! |---|---|
//! | P | the corner as programmed |
//! | u, v | directions of the two moves, length 1, as (Z, X) |
//! | θ | angle between them |
//!
//! ```text
//! chamfer   from P − c u to P + c v                                          (1)
//! rounding  t = r tan(θ/2); from P − t u to P + t v                           (2)
//!           centre P − t u + r n, n normal to u on the side of v              (3)
//! ```

use super::codes::Deed;
use super::execution::Execution;
use super::line::Line;
use super::modal::{Cut, Pending};
use crate::canon::{Pose, X, Z};
use crate::codes::{G, M, group};
use crate::execute::Done;
use crate::problem::{Blame, Problem, short};

/// Lengths below this count as 0.
const NEAR: f64 = 1e-9;

/// What a G01 block says about the corner at its end.
///
/// # Errors
/// Two words say different things, or a word does not fit the move.
pub(super) fn of(line: &Line, from: &Pose, end: &Pose) -> Result<Option<Cut>, Box<Problem>> {
    let words: Vec<char> =
        ['c', 'r', 'C', 'R', 'I', 'K'].into_iter().filter(|letter| line.has(*letter)).collect();
    let (letter, value) = match words.as_slice() {
        [] => return Ok(None),
        [letter] => (*letter, line.length(*letter).unwrap_or(0.0)),
        [_, second, ..] => {
            let message = "two words for one corner";
            return Err(Problem::error(
                "repeated-word",
                Blame::Word(*second),
                message,
                "leave one of them out",
            ));
        }
    };
    let round = matches!(letter, 'r' | 'R');
    if value == 0.0 {
        return Ok(None);
    }
    if matches!(letter, 'c' | 'r') {
        if value > 0.0 {
            return Ok(Some(Cut { size: value, round, next: None }));
        }
        let message = format!(",{} is {}", letter.to_ascii_uppercase(), short(value));
        return Err(Problem::error("bad-value", Blame::Word(letter), message, "give a value greater than 0"));
    }
    let along = [X, Z].map(|axis| (end[axis] - from[axis]).abs() > NEAR);
    let (other, fits) = match along {
        [false, true] => (X, letter != 'K'),
        [true, false] => (Z, letter != 'I'),
        _ => (X, false),
    };
    if !fits {
        let message = format!("{letter} cannot cut a corner of this move");
        let help =
            "I is for a move along Z, K for one along X, C and R for either; ,C and ,R fit any straight move";
        return Err(Problem::error("bad-value", Blame::Word(letter), message, help));
    }
    Ok(Some(Cut { size: value.abs(), round, next: Some((other, value.signum())) }))
}

/// A corner that no move comes after.
pub(super) fn alone(pending: &Pending, what: &str) -> Box<Problem> {
    let message =
        format!("the previous move ({} its end) needs a straight move after it, not {what}", cuts(pending));
    Problem::error(
        "bad-corner",
        Blame::Line(pending.place.line),
        message,
        "write the next G01, or leave the corner sharp",
    )
}

/// What ends a corner must see it as the move before did.
///
/// # Errors
/// The line changes the tool, the units or the coordinate system.
pub(super) fn undisturbed(line: &Line) -> Done {
    let codes = [group::UNITS, group::COORDINATES].into_iter().find_map(|group| line.block.g(group));
    let blame = match codes {
        Some(code) => Blame::G(code),
        None if line.has('T') => Blame::Word('T'),
        None => return Ok(()),
    };
    let message = "the corner of the previous move ends in this block: tool, units and coordinates must stay as they are";
    Err(Problem::error("bad-corner", blame, message, "change them before the two moves, or after them"))
}

/// M05, M09 or a stop at the end of a move that is cut off or rounded.
pub(super) fn not_at_its_end(code: M) -> Box<Problem> {
    let message = format!("{code} acts at the end of the move, which becomes a corner");
    Problem::error(
        "bad-corner",
        Blame::M(code),
        message,
        "write it in the block of the next move, or after it",
    )
}

fn cuts(pending: &Pending) -> &'static str {
    if pending.cut.round { "which rounds" } else { "which cuts off" }
}

/// Sends the move that waits and its corner; `next` is where the next one leads.
///
/// # Errors
/// The next block is not a straight move, or the corner does not fit between the two.
pub(super) fn close(pending: &Pending, deed: Deed, next: Pose, run: &mut Execution) -> Done {
    let moves = (next[Z] - pending.end[Z]).abs() > NEAR || (next[X] - pending.end[X]).abs() > NEAR;
    if deed != Deed::G(G(10)) || !moves {
        return Err(alone(pending, "this block"));
    }
    let place = std::mem::replace(&mut run.out.place, pending.place);
    let done = send(pending, next, run);
    run.out.place = place;
    done
}

fn send(pending: &Pending, next: Pose, run: &mut Execution) -> Done {
    let [from, corner, to] = [run.state.axes.position, pending.end, next].map(|point| [point[Z], point[X]]);
    let Cut { size, round, next } = pending.cut;
    let ((u, before), (v, behind)) = (way(from, corner), way(corner, to));
    if let Some((axis, sign)) = next {
        let (along, across) = if axis == X { (v[1], v[0]) } else { (v[0], v[1]) };
        if along * sign <= 0.0 || across.abs() > 1e-6 {
            let letter = if axis == X { 'X' } else { 'Z' };
            let sign = if sign > 0.0 { "+" } else { "-" };
            let message = format!(
                "the next move must run along {letter} towards {sign}, as the sign of the corner says"
            );
            return Err(at_place(pending, message, "change the sign, or write ,C or ,R"));
        }
    }
    let turn = u[0] * v[1] - u[1] * v[0];
    let angle = libm::atan2(turn.abs(), u[0] * v[0] + u[1] * v[1]);
    let t = if round { size * libm::tan(angle / 2.0) } else { size };
    if turn.abs() < 1e-9 || t > before + 1e-6 || t > behind + 1e-6 {
        let message = format!(
            "a corner of {} does not fit between moves of {} and {}",
            short(size),
            short(before),
            short(behind)
        );
        return Err(at_place(pending, message, "make it smaller, or the moves longer"));
    }
    let start = [corner[0] - t * u[0], corner[1] - t * u[1]];
    let end = [corner[0] + t * v[0], corner[1] + t * v[1]];
    run.go(G(10), start, None, pending.place)?;
    if !round {
        return run.go(G(10), end, None, pending.place);
    }
    // left of u is counterclockwise with Z to the right and X up
    let side = if turn > 0.0 { size } else { -size };
    let center = [-side * u[1], side * u[0]];
    let code = if turn > 0.0 { G(30) } else { G(20) };
    run.go(code, end, Some(center), pending.place)
}

/// Direction and length from one point to another.
fn way(from: [f64; 2], to: [f64; 2]) -> ([f64; 2], f64) {
    let (z, x) = (to[0] - from[0], to[1] - from[1]);
    let length = libm::hypot(z, x);
    let unit = if length > 0.0 { [z / length, x / length] } else { [0.0; 2] };
    (unit, length)
}

fn at_place(pending: &Pending, message: String, help: &str) -> Box<Problem> {
    Problem::error("bad-corner", Blame::Line(pending.place.line), message, help)
}
