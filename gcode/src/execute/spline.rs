//! Splines: G5, G5.1, and the block of G5.2 to G5.3.
//!
//! In: a block and the state. Out: a [`Nurbs`] in the plane.
//!
//! | code | curve | points |
//! |---|---|---|
//! | G5 | cubic | start, start + (I, J), end + (P, Q), end |
//! | G5.1 | quadratic | start, start + (I, J), end |
//! | G5.2 | of order L with weights P | start, and one from each block up to G5.3 |
//!
//! Source: manual of LinuxCNC, G5, G5.1, G5.2 G5.3. A P that is left out is 1, as there.

use super::check::compensation_off;
use super::{Done, Output, feed, straight};
use crate::block::Block;
use crate::canon::{Call, FeedMode, Nurbs, Plane};
use crate::codes::G;
use crate::problem::{Blame, Problem, short};
use crate::state::{OpenCurve, State};

/// Highest order of a curve.
const HIGHEST_ORDER: i64 = 20;
/// Most points of a curve.
const MOST_POINTS: usize = 100_000;

/// Letters of the axes.
const AXES: [char; 6] = ['X', 'Y', 'Z', 'A', 'B', 'C'];

/// G5, G5.1, G5.2, G5.3.
pub(super) fn spline(code: G, block: &Block, state: &mut State, out: &mut Output) -> Done {
    compensation_off(Blame::G(code), "make a spline", state)?;
    if state.modes.feed_mode == FeedMode::InverseTime {
        let message = format!("{code} cannot take its time from F (G93)");
        return Err(Problem::error("bad-value", Blame::G(code), message, "select G94 or G95 first"));
    }
    feed::ready(block, state)?;
    match code.0 {
        52 => {
            let done = control_point(block, state);
            if let Some(curve) = state.spline.open.as_mut().filter(|_| done.is_err()) {
                curve.broken = true;
            }
            done
        }
        53 => close(state, out),
        62 => super::knots::block(block, state, out),
        _ => one_block(code, block, state, out),
    }
}

/// G5 and G5.1.
fn one_block(code: G, block: &Block, state: &mut State, out: &mut Output) -> Done {
    if state.modes.plane != Plane::Xy {
        let message = format!("{code} works in the XY plane only");
        return Err(Problem::error("bad-value", Blame::G(code), message, "select G17, or use G5.2 and G5.3"));
    }
    let target = straight::target(block, state)?;
    only_in_plane(code, block, state)?;
    let start = [state.axes.position[0], state.axes.position[1]];
    let end = [target[0], target[1]];
    let word = |letter: char| block.get(letter);
    let given = match (word('I'), word('J')) {
        (Some(i), Some(j)) => Some([i, j]),
        (None, None) => None,
        (i, j) if code == G(51) => Some([i.unwrap_or(0.0), j.unwrap_or(0.0)]),
        _ => return Err(missing(code, "I and J, or neither of them")),
    };
    let Some(first) = given.or(state.spline.onwards.filter(|_| code == G(50))) else {
        return Err(missing(code, "I and J, where the curve goes to from its start"));
    };
    let shifted = |at: [f64; 2], by: [f64; 2]| [at[0] + by[0], at[1] + by[1], 1.0];
    let mut points = vec![shifted(start, [0.0; 2]), shifted(start, first)];
    if code == G(50) {
        let (Some(p), Some(q)) = (word('P'), word('Q')) else {
            return Err(missing(code, "P and Q, where the curve comes from to its end"));
        };
        points.push(shifted(end, [p, q]));
        state.spline.onwards = Some([-p, -q]);
    }
    points.push(shifted(end, [0.0; 2]));
    out.call(Call::NurbsFeed(&Nurbs::uniform(points.len(), points)))?;
    state.axes.position = target;
    Ok(())
}

fn missing(code: G, what: &str) -> Box<Problem> {
    Problem::error("missing-word", Blame::G(code), format!("{code} needs {what}"), "add the words")
}

/// Whether a block has a point of the curve: both of its coordinates, or none of them.
pub(super) fn has_point(block: &Block, axes: [usize; 2]) -> Result<bool, Box<Problem>> {
    match axes.map(|axis| block.has(AXES[axis])) {
        [true, true] => Ok(true),
        [false, false] => Ok(false),
        _ => {
            let [first, second] = axes.map(|axis| AXES[axis]);
            let message = format!("a point of the curve needs {first} and {second}");
            Err(Problem::error("missing-word", Blame::Block, message, "add the other one"))
        }
    }
}

/// Axis words of other axes than those of the plane.
pub(super) fn only_in_plane(code: G, block: &Block, state: &State) -> Done {
    let (first, second, _) = state.modes.plane.axes();
    let other = (0..6).filter(|axis| ![first, second].contains(axis)).find(|axis| block.has(AXES[*axis]));
    match other {
        None => Ok(()),
        Some(axis) => {
            let letter = AXES[axis];
            let message = format!("{code} does not move {letter}: the curve lies in the plane");
            Err(Problem::error("unused-word", Blame::Word(letter), message, "move it in another block"))
        }
    }
}

/// G5.2 and the blocks behind it.
fn control_point(block: &Block, state: &mut State) -> Done {
    let code = G(52);
    only_in_plane(code, block, state)?;
    let (first, second, _) = state.modes.plane.axes();
    let weight = block.get('P').unwrap_or(1.0);
    if weight <= 0.0 {
        let message = format!("the weight P{} is not greater than 0", short(weight));
        return Err(Problem::error("bad-value", Blame::Word('P'), message, "give a weight greater than 0"));
    }
    let order = match block.get('L') {
        None => None,
        Some(value) => match block.integer('L').filter(|order| (3..=HIGHEST_ORDER).contains(order)) {
            Some(order) => Some(order as usize),
            None => {
                let message = format!("L{} cannot be the order of a curve", short(value));
                let help = format!("give a whole number from 3 to {HIGHEST_ORDER}");
                return Err(Problem::error("bad-value", Blame::Word('L'), message, help));
            }
        },
    };
    let has_point = has_point(block, [first, second])?;
    let target = straight::target(block, state)?;
    let start = [state.axes.position[first], state.axes.position[second]];
    let begins = state.spline.open.is_none();
    if !begins && !has_point && order.is_none() {
        let message = format!("this block of the curve has no point: {} and {}", AXES[first], AXES[second]);
        return Err(Problem::error(
            "missing-word",
            Blame::Block,
            message,
            "add them, or end the curve by G5.3",
        ));
    }
    let curve = state.spline.open.get_or_insert_with(|| {
        let weight = if has_point { 1.0 } else { weight };
        Box::new(OpenCurve { order: 3, points: vec![[start[0], start[1], weight]], broken: false })
    });
    curve.order = order.unwrap_or(curve.order);
    if has_point {
        curve.points.push([target[first], target[second], weight]);
    }
    if curve.points.len() > MOST_POINTS {
        state.spline.open = None;
        let message = format!("the curve has more than {MOST_POINTS} points");
        return Err(Problem::error("bad-value", Blame::Block, message, "divide it by G5.3 and G5.2"));
    }
    Ok(())
}

/// G5.3.
fn close(state: &mut State, out: &mut Output) -> Done {
    let code = G(53);
    let Some(curve) = state.spline.open.take() else {
        let message = "G5.3 ends a curve that no G5.2 began";
        return Err(Problem::error("no-motion-mode", Blame::G(code), message, "begin it by G5.2"));
    };
    state.modes.motion = None;
    // Also of a curve that is not made: what follows begins where it ends.
    let (first, second, _) = state.modes.plane.axes();
    if let Some(end) = curve.points.last() {
        [state.axes.position[first], state.axes.position[second]] = [end[0], end[1]];
    }
    if curve.broken {
        return Ok(());
    }
    if curve.points.len() < curve.order {
        let (has, needs) = (curve.points.len(), curve.order);
        let message = format!("a curve of order L{needs} needs {needs} points, and this one has {has}");
        return Err(Problem::error("missing-word", Blame::G(code), message, "add points, or take a lower L"));
    }
    out.call(Call::NurbsFeed(&Nurbs::uniform(curve.order, curve.points)))
}

/// Between G5.2 and G5.3 stand points and nothing else.
pub(super) fn only_points(block: &Block, state: &mut State) -> Done {
    let code = block
        .g_codes()
        .find(|code| !matches!(code.0, 52 | 53))
        .map(|code| (Blame::G(code), code.to_string()));
    let code = code.or_else(|| block.m_codes().next().map(|code| (Blame::M(code), code.to_string())));
    let Some((blame, name)) = code else { return Ok(()) };
    if state.spline.open.take().is_some_and(|curve| curve.broken) {
        return Ok(());
    }
    let message = format!("{name} stands in the points of a curve");
    Err(Problem::error("modal-group", blame, message, "end the curve by G5.3 before it"))
}
