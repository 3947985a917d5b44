//! Straight moves: G0, G1, G53 and polar points.
//!
//! In: a block and the state, words in program units or degrees (X a diameter under G7). Out: the end point,
//! which is sent as it is, or handed over to the compensation of the tool radius.
//!
//! ```text
//! G90   word                         polar   x = @ cos ^,  y = @ sin ^; what is missing is as it was
//! G91   point + word                         point + (@, ^) in polar coordinates
//! G53   word - G5x - tool - G92, with X and Y turned back by the rotation of the coordinate system
//! ```

use std::f64::consts::{FRAC_PI_2, PI};

use super::{Done, Kind, Output, compensation, feed};
use crate::block::{AXES, Block};
use crate::canon::{A, Plane, Pose, X, Y, Z};
use crate::codes::{G, group};
use crate::problem::{Blame, Problem};
use crate::state::State;

/// G0 and G1.
pub(super) fn straight(code: G, block: &Block, state: &mut State, out: &mut Output) -> Done {
    to(|state| target(block, state), code, block, state, out)
}

/// The same, to a point that is asked for when the move may be made.
pub(super) fn to(
    target: impl FnOnce(&State) -> Result<Pose, Box<Problem>>,
    code: G,
    block: &Block,
    state: &mut State,
    out: &mut Output,
) -> Done {
    let kind = if code == G(0) { Kind::Traverse } else { Kind::Feed };
    if kind == Kind::Feed {
        feed::ready(block, state)?;
    }
    let target = target(state)?;
    if kind == Kind::Feed {
        feed::inverse_time(|from| length(from, &target), block, state, out)?;
    }
    move_to(kind, target, block, state, out)
}

/// Moves to a programmed point, with compensation if it is on.
pub(crate) fn move_to(kind: Kind, target: Pose, block: &Block, state: &mut State, out: &mut Output) -> Done {
    state.compensation.straight_made();
    if state.compensation.is_on() {
        return compensation::straight(kind, target, block, state, out);
    }
    out.call(kind.call(target))?;
    state.axes.position = target;
    Ok(())
}

/// The programmed end point of a move.
///
/// # Errors
/// Polar words that name no point.
pub(crate) fn target(block: &Block, state: &State) -> Result<Pose, Box<Problem>> {
    if block.g(group::ONCE) == Some(G(530)) {
        return machine_target(block, state);
    }
    let mut target = state.axes.position;
    for (axis, letter) in AXES.into_iter().enumerate() {
        let Some(value) = word(letter, block, state) else { continue };
        target[axis] = if state.modes.incremental { target[axis] + value } else { value };
    }
    if block.has('@') || block.has('^') {
        polar(block, state, &mut target)?;
    }
    Ok(target)
}

/// The word of an axis; X as a radius.
pub(super) fn word(letter: char, block: &Block, state: &State) -> Option<f64> {
    let value = block.get(letter)?;
    Some(if letter == 'X' && state.modes.diameter { value / 2.0 } else { value })
}

/// G53: the words are those of the machine.
fn machine_target(block: &Block, state: &State) -> Result<Pose, Box<Problem>> {
    if let Some(letter) = ['@', '^'].into_iter().find(|letter| block.has(*letter)) {
        let message = format!("{letter} is a polar word, and G53 asks for coordinates of the machine");
        return Err(Problem::error("bad-value", Blame::Word(letter), message, "give X and Y"));
    }
    let mut target = state.axes.position;
    let mut point = turned([X, Y].map(|axis| target[axis] + state.axes.g92()[axis]), state.axes.rotation());
    for axis in [X, Y] {
        if let Some(value) = word(AXES[axis], block, state) {
            point[axis] = value - state.axes.g5x()[axis] - state.axes.tool_offset()[axis];
        }
    }
    let point = turned(point, -state.axes.rotation());
    for axis in [X, Y] {
        target[axis] = point[axis] - state.axes.g92()[axis];
    }
    for axis in Z..AXES.len() {
        if let Some(value) = word(AXES[axis], block, state) {
            target[axis] =
                value - state.axes.g5x()[axis] - state.axes.g92()[axis] - state.axes.tool_offset()[axis];
        }
    }
    Ok(target)
}

/// A point turned about Z. Turning by 0 also counts: it settles the sign of a zero as other controls print
/// it.
fn turned([x, y]: [f64; 2], degrees: f64) -> [f64; 2] {
    let (sin, cos) = libm::sincos(radians(degrees));
    [x * cos - y * sin, x * sin + y * cos]
}

/// Refuses a move without a word of an axis.
pub(super) fn some_axis(code: G, block: &Block) -> Done {
    if block.has_axes() || block.has('@') || block.has('^') {
        return Ok(());
    }
    let message = format!("{code} goes nowhere: the block has no word of an axis");
    Err(Problem::error("missing-word", Blame::G(code), message, "add the axes that move"))
}

/// `@` and `^`.
fn polar(block: &Block, state: &State, target: &mut Pose) -> Done {
    check_polar(block, state)?;
    let point = polar_point([target[X], target[Y]], block, state).ok_or_else(|| at_origin(block, state))?;
    [target[X], target[Y]] = point;
    Ok(())
}

/// Refuses polar words where they name no point.
pub(super) fn check_polar(block: &Block, state: &State) -> Done {
    if let Some(letter) = ['X', 'Y'].into_iter().find(|letter| block.has(*letter)) {
        let message = format!("a polar point gives X and Y, and {letter} gives the same once more");
        return Err(Problem::error(
            "repeated-word",
            Blame::Word(letter),
            message,
            "leave one of the two out",
        ));
    }
    if state.modes.plane != Plane::Xy {
        let message = "polar words name a point of the XY plane, and another plane is in force";
        let blame = Blame::Word(if block.has('@') { '@' } else { '^' });
        return Err(Problem::error("bad-value", blame, message, "select G17, or give the coordinates"));
    }
    Ok(())
}

/// The problem of polar words that lack an angle.
pub(super) fn at_origin(block: &Block, state: &State) -> Box<Problem> {
    let message = "at the origin no angle is defined that a polar word could start from";
    let help = if state.modes.incremental { "move away from X0 Y0 first" } else { "also give the angle: ^" };
    let blame = Blame::Word(if block.has('@') { '@' } else { '^' });
    Problem::error("bad-value", blame, message, help)
}

/// The point that polar words name; `None` if that takes the angle of the origin.
pub(super) fn polar_point([x, y]: [f64; 2], block: &Block, state: &State) -> Option<[f64; 2]> {
    let (distance, angle) = (block.get('@'), block.get('^'));
    let at_origin = x == 0.0 && y == 0.0;
    let (here, beyond) = (libm::hypot(y, x), libm::atan2(y, x));
    if !state.modes.incremental {
        if at_origin && angle.is_none() {
            return None;
        }
        let angle = angle.map_or(beyond, radians);
        return Some(at(distance.unwrap_or(here), angle));
    }
    polar_step([x, y], distance.unwrap_or(0.0), angle.unwrap_or(0.0))
}

/// The point that is further away by `distance` and turned by `degrees`; `None` at the origin.
pub(super) fn polar_step([x, y]: [f64; 2], distance: f64, degrees: f64) -> Option<[f64; 2]> {
    if x == 0.0 && y == 0.0 {
        return None;
    }
    Some(at(libm::hypot(y, x) + distance, libm::atan2(y, x) + radians(degrees)))
}

fn at(distance: f64, angle: f64) -> [f64; 2] {
    [distance * libm::cos(angle), distance * libm::sin(angle)]
}

/// Degrees in radians, rounded once: the sine of 180 then has the sign that other controls print.
pub(super) fn radians(degrees: f64) -> f64 {
    /// What π/180 has beyond its double.
    const REST: f64 = 2.948_652_270_870_168_7e-19;
    if degrees == 0.0 {
        return degrees;
    }
    let first = degrees * (PI / 180.0);
    let lost = libm::fma(degrees, PI / 180.0, -first);
    first + (lost + degrees * REST)
}

/// An angle minus a quarter turn, rounded once.
pub(super) fn minus_quarter(angle: f64) -> f64 {
    /// What π/2 has beyond its double.
    const REST: f64 = 6.123_233_995_736_766e-17;
    (angle - FRAC_PI_2) - REST
}

/// Length of a straight move: along X, Y, Z; in degrees if only rotary axes move.
fn length(from: &Pose, to: &Pose) -> f64 {
    /// A way that counts as none, units.
    const NONE: f64 = 1e-7;
    let way: Pose = std::array::from_fn(|axis| to[axis] - from[axis]);
    let (lengths, angles) = way.split_at(A);
    let moving = if lengths.iter().any(|way| way.abs() > NONE) { lengths } else { angles };
    moving.iter().map(|way| way * way).sum::<f64>().sqrt()
}
