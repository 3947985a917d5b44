//! G6.2: a curve of control points with knots and weights of their own.
//!
//! In: its blocks. The first says P, the order, and Q. Blocks with both axes of the plane are points, with
//! the knot K and the weight R; behind the last stand as many blocks with K alone as the order says. Out:
//! with the last of them, a [`Nurbs`] in the plane.
//!
//! ```text
//! G6.2 X0 Y0 R1 K0 P3 Q1
//!      X5 Y9 R2 K0
//!      X9 Y0 R1 K0
//! G6.2 K1
//! G6.2 K1
//! G6.2 K1
//! ```
//! Source: LinuxCNC's interpreter, `convert_nurbs`. Q chooses there between ways of making lines and arcs;
//! here all three are arcs that keep within a distance of the curve.

use super::refused::goes_to;
use super::{Done, Output, straight};
use crate::block::Block;
use crate::canon::{Call, Nurbs, Units};
use crate::codes::G;
use crate::problem::{Blame, Problem, short};
use crate::state::{KnottedCurve, State};

const CODE: G = G(62);
/// Orders of curves.
const ORDERS: std::ops::RangeInclusive<i64> = 2..=20;
/// Most knots of a curve.
const MOST_KNOTS: usize = 100_000;
/// How far the first point may be from the tool, mm and inch.
const NEAR: [f64; 2] = [1e-3, 1e-4];

/// A block of the curve. One that is wrong is told; the others are looked at, and nothing is made.
pub(super) fn block(block: &Block, state: &mut State, out: &mut Output) -> Done {
    // What is left of a curve that went wrong ends where another one begins.
    let before = state.spline.knotted.take().filter(|curve| !curve.broken || !block.has('P'));
    let first = before.is_none();
    let mut curve = before.unwrap_or_default();
    // Of a curve without an order nothing else can be judged.
    let lost = !first && curve.order == 0;
    let done = if lost { Ok(()) } else { take(first, block, state, &mut curve) };
    curve.broken |= done.is_err();
    // What follows a curve that is not made begins where its points end.
    if curve.broken
        && block.has_axes()
        && let Ok(target) = straight::target(block, state)
    {
        goes_to(target, state, out);
    }
    let ended = curve.order > 0 && curve.knots.len() == curve.points.len() + curve.order;
    if !ended {
        state.spline.knotted = Some(curve);
        return done;
    }
    state.modes.motion = None;
    if curve.broken {
        return done;
    }
    make(*curve, state, out)
}

/// Takes what a block says.
fn take(first: bool, block: &Block, state: &State, curve: &mut KnottedCurve) -> Done {
    if first || block.has('P') {
        curve.order = order(block)?;
    }
    if (first || block.has('Q')) && block.integer('Q').is_none_or(|way| !(1..=3).contains(&way)) {
        let help = "write Q1, Q2 or Q3; here they are the same";
        return Err(missing("Q, how the curve is made: 1, 2 or 3", help));
    }
    let Some(knot) = block.get('K') else {
        return Err(missing("K, the knot", "give each block one, the first P of them the same"));
    };
    if curve.knots.last().is_some_and(|before| knot < *before) {
        let message = format!("the knot K{} is less than the one before", short(knot));
        return Err(Problem::error("bad-value", Blame::Word('K'), message, "knots do not fall"));
    }
    if curve.knots.len() == MOST_KNOTS {
        let message = format!("the curve has more than {MOST_KNOTS} knots");
        return Err(Problem::error("bad-value", Blame::Block, message, "divide it into several"));
    }
    let (one, other, _) = state.modes.plane.axes();
    super::spline::only_in_plane(CODE, block, state)?;
    let point = super::spline::has_point(block, [one, other])?;
    if point && curve.knots.len() > curve.points.len() {
        let help = format!("the last {} blocks of the curve have K alone", curve.order);
        let message = "a point stands behind a knot without one";
        return Err(Problem::error("bad-value", Blame::Block, message, help));
    }
    curve.knots.push(knot);
    if point {
        let target = straight::target(block, state)?;
        let weight = block.get('R').filter(|weight| *weight > 0.0);
        curve.points.push([target[one], target[other], weight.unwrap_or(1.0)]);
        if weight.is_none() {
            return Err(missing("R, the weight of the point", "give a weight greater than 0, such as R1"));
        }
    }
    Ok(())
}

fn order(block: &Block) -> Result<usize, Box<Problem>> {
    let help = format!("give a whole number from {} to {} in the first block", ORDERS.start(), ORDERS.end());
    match (block.integer('P'), block.get('P')) {
        (Some(order), _) if ORDERS.contains(&order) => Ok(order as usize),
        (_, Some(value)) => {
            let message = format!("P{} cannot be the order of a curve", short(value));
            Err(Problem::error("bad-value", Blame::Word('P'), message, help))
        }
        (_, None) => Err(missing("P, the order of the curve", &help)),
    }
}

fn missing(what: &str, help: &str) -> Box<Problem> {
    Problem::error("missing-word", Blame::G(CODE), format!("{CODE} needs {what}"), help.to_owned())
}

/// The curve, with its last block.
fn make(curve: KnottedCurve, state: &mut State, out: &mut Output) -> Done {
    let at = state.axes.position;
    let (one, other, _) = state.modes.plane.axes();
    if let Some(end) = curve.points.last() {
        [state.axes.position[one], state.axes.position[other]] = [end[0], end[1]];
    }
    let KnottedCurve { order, points, knots, .. } = curve;
    let bad = |message: String, help: &str| {
        Err(Problem::error("bad-value", Blame::Block, message, help.to_owned()))
    };
    if points.len() < order {
        let has = points.len();
        return bad(
            format!("a curve of order P{order} needs {order} points, and this one has {has}"),
            "add points, or take a lower P",
        );
    }
    let (from, to) = (knots[0], knots[knots.len() - 1]);
    if knots[order - 1] != from || knots[points.len()] != to || from == to {
        let message = format!("the first {order} knots are not the same, or the last {order}, or all are");
        return bad(message, "repeat the first and the last knot: the curve begins and ends at a point then");
    }
    if knots[1..knots.len() - 1]
        .windows(order)
        .any(|same| same[0] == same[same.len() - 1] && same[0] != from && same[0] != to)
    {
        let message = format!("a knot within the curve is there {order} times: the curve is torn");
        return bad(message, "end the curve there, and begin another");
    }
    let off = libm::hypot(points[0][0] - at[one], points[0][1] - at[other]);
    if off > NEAR[usize::from(state.units.program() == Units::Inch)] {
        let message = format!("the first point of the curve is {} from where the tool stands", short(off));
        return bad(message, "move there first, in a block before the curve");
    }
    out.call(Call::NurbsFeed(&Nurbs { order, points, knots, named: true }))
}

/// Within a curve stand its blocks and nothing else.
pub(super) fn only_blocks(block: &Block, state: &mut State) -> Done {
    let code = block.g_codes().find(|code| *code != CODE).map(|code| (Blame::G(code), code.to_string()));
    let code = code.or_else(|| block.m_codes().next().map(|code| (Blame::M(code), code.to_string())));
    let Some((blame, name)) = code else { return Ok(()) };
    let Some(curve) = state.spline.knotted.as_mut().filter(|curve| !curve.broken) else { return Ok(()) };
    curve.broken = true;
    let message = format!("{name} stands in the points of a curve");
    let help = format!("end the curve before it: its last {} blocks are G6.2 with K alone", curve.order);
    Err(Problem::error("modal-group", blame, message, help))
}
