//! The moves of a compensated contour.
//!
//! ```text
//! entry    a straight move, or an arc, to the place beside its programmed end
//! corner   tangent: go on
//!          outside: an arc around it (a rapid goes straight)
//!          inside: the ways of both moves are cut where they meet
//! ```
//! Every move waits in [`Waiting`](super::Waiting) until the next one is known. The axis across the plane and
//! the rotary axes move with the move they are programmed in; around an outside corner the rotary axes turn
//! already.

use crate::block::Block;
use crate::canon::{Arc, Call, Pose};
use crate::execute::{Done, Kind, Output};
use crate::geometry::track::{Corner, Element, Point, Side, Track, distance, meet};
use crate::problem::{Blame, Problem, short};
use crate::state::{Compensation, Cutter, State};

/// What a move of the contour ends at, beside the plane.
#[derive(Clone, Copy)]
struct Move {
    kind: Kind,
    target: Pose,
}

/// A straight move while compensation is on.
///
/// # Errors
/// The entry is too short, or the tool does not fit into the corner.
pub(crate) fn straight(kind: Kind, target: Pose, block: &Block, state: &mut State, out: &mut Output) -> Done {
    let Compensation { tool: Some(cutter), normal, .. } = state.compensation else { return Ok(()) };
    if cutter.radius == 0.0 {
        out.call(kind.call(target))?;
        state.axes.position = target;
        return Ok(());
    }
    let (from, to) = (in_plane(&state.axes.position, state), in_plane(&target, state));
    computable(&[from, to], &cutter)?;
    let (track, joined) = match normal {
        None if distance(from, to) <= cutter.radius => return Err(short_entry(from, to, &cutter)),
        None => (Track::entry_line(from, to, cutter.side, cutter.radius), Ok(())),
        Some(n) if from == to => {
            let point = cutter.tip_at(from, n);
            out.waiting.push(out.place, kind.call(with_plane(target, point, state)));
            state.axes.position = target;
            return Ok(());
        }
        Some(n) => {
            let element = Element { from, to, arc: None };
            let mut track =
                element.offset(cutter.side, cutter.radius).ok_or_else(|| no_fit(block, &cutter))?;
            let joined = join(n, &mut track, from, Move { kind, target }, state, out);
            (track, joined)
        }
    };
    let end = cutter.tip_at(to, track.normals[1]);
    out.waiting.push_move(out.place, kind.call(with_plane(target, end, state)), track);
    arrive(target, &track, state);
    joined
}

/// An arc while compensation is on.
///
/// # Errors
/// As those of a straight move, or the tool does not fit into the arc.
pub(crate) fn arc(arc: Arc, block: &Block, state: &mut State, out: &mut Output) -> Done {
    let Compensation { tool: Some(cutter), normal, .. } = state.compensation else { return Ok(()) };
    let target = target_of(&arc, state);
    if cutter.radius == 0.0 {
        out.call(Call::ArcFeed(arc))?;
        state.axes.position = target;
        return Ok(());
    }
    let from = in_plane(&state.axes.position, state);
    computable(&[from, arc.end, arc.center], &cutter)?;
    let element = Element { from, to: arc.end, arc: Some((arc.center, arc.turns)) };
    let (track, center, joined) = match normal {
        None => {
            let (track, center) = enter_by_arc(&element, block, &cutter)?;
            lead_to_tip(from, &target, &cutter, state, out)?;
            (track, center, Ok(()))
        }
        Some(n) => {
            let mut track =
                element.offset(cutter.side, cutter.radius).ok_or_else(|| no_fit(block, &cutter))?;
            let joined = join(n, &mut track, from, Move { kind: Kind::Feed, target }, state, out);
            (track, arc.center, joined)
        }
    };
    let end = cutter.tip_at(arc.end, track.normals[1]);
    let center = cutter.tip_of(center);
    out.waiting.push_move(out.place, Call::ArcFeed(Arc { end, center, ..arc }), track);
    arrive(target, &track, state);
    joined
}

/// Ends what waits at the corner `p` and begins `track` there. After an error the move counts as made, so
/// that what follows can be judged.
fn join(n: Point, track: &mut Track, p: Point, to: Move, state: &State, out: &mut Output) -> Done {
    let Some(cutter) = state.compensation.tool else { return Ok(()) };
    let before = out.waiting.track().copied();
    match Corner::between(n, before.map_or(0.0, |before| before.curvature), track, cutter.side) {
        Corner::Tangent => out.release(),
        Corner::Outside => {
            out.release()?;
            out.call(around(p, track.normals[0], to, &cutter, state))
        }
        Corner::Inside => {
            let cut = cut(before.as_ref(), track, p, &cutter, state, out);
            match cut {
                Ok(()) => out.release(),
                Err(problem) => {
                    out.waiting.take();
                    track.left = f64::INFINITY;
                    Err(problem)
                }
            }
        }
    }
}

/// An inside corner: both moves end where they meet.
fn cut(
    before: Option<&Track>,
    track: &mut Track,
    p: Point,
    cutter: &Cutter,
    state: &State,
    out: &mut Output,
) -> Done {
    let Some(before) = before else { return Err(stopped_in_corner()) };
    let corner = meet(before, track, p, cutter.side, cutter.radius);
    let Some(corner) = corner else { return Err(no_corner(cutter)) };
    if !out.waiting.end_at(corner, cutter.tip_of(corner), state.modes.plane) {
        return Err(too_short_before(cutter, out));
    }
    if track.begin_at(corner) { Ok(()) } else { Err(too_short(Blame::Block, "the previous move", cutter)) }
}

/// The way around an outside corner.
fn around(p: Point, n: Point, to: Move, cutter: &Cutter, state: &State) -> Call<'static> {
    let (_, _, across) = state.modes.plane.axes();
    let [_, _, _, a, b, c] = to.target;
    let end = cutter.tip_at(p, n);
    if to.kind == Kind::Traverse {
        let mut target = with_plane(to.target, end, state);
        target[across] = state.axes.position[across];
        return Call::StraightTraverse(target);
    }
    let turns = if cutter.side == Side::Left { -1 } else { 1 };
    let along = state.axes.position[across];
    Call::ArcFeed(Arc { end, center: cutter.tip_of(p), turns, along, rotary: [a, b, c] })
}

/// The entry by an arc: its way, and the centre of that.
fn enter_by_arc(element: &Element, block: &Block, cutter: &Cutter) -> Result<(Track, Point), Box<Problem>> {
    let (from, to) = (element.from, element.to);
    if distance(from, to) <= cutter.radius {
        return Err(short_entry(from, to, cutter));
    }
    if element.offset(cutter.side, cutter.radius).is_none() {
        return Err(no_fit(block, cutter));
    }
    Track::entry_arc(element, cutter.side, cutter.radius).ok_or_else(|| {
        let radius = short(cutter.radius);
        let message = format!("this arc is too short for a tool of radius {radius} to enter along it");
        Problem::error(
            "compensation-entry",
            Blame::Block,
            message,
            "make it longer, or enter with a straight move",
        )
    })
}

/// The measured point of a turning tool goes where the entry arc has it begin: else it would be no arc.
fn lead_to_tip(from: Point, target: &Pose, cutter: &Cutter, state: &State, out: &mut Output) -> Done {
    if matches!(cutter.orientation, 0 | 9) {
        return Ok(());
    }
    let (_, _, across) = state.modes.plane.axes();
    let mut start = with_plane(*target, cutter.tip_of(from), state);
    start[across] = state.axes.position[across];
    out.call(Call::StraightFeed(start))
}

fn arrive(target: Pose, track: &Track, state: &mut State) {
    state.axes.position = target;
    state.compensation.normal = Some(track.normals[1]);
}

fn in_plane(point: &Pose, state: &State) -> Point {
    let (first, second, _) = state.modes.plane.axes();
    [point[first], point[second]]
}

fn with_plane(mut position: Pose, point: Point, state: &State) -> Pose {
    let (first, second, _) = state.modes.plane.axes();
    (position[first], position[second]) = (point[0], point[1]);
    position
}

fn target_of(arc: &Arc, state: &State) -> Pose {
    let (_, _, across) = state.modes.plane.axes();
    let mut target = with_plane(state.axes.position, arc.end, state);
    target[across] = arc.along;
    target[3..].copy_from_slice(&arc.rotary);
    target
}

/// Refuses numbers whose squares would not be numbers.
fn computable(points: &[Point], cutter: &Cutter) -> Done {
    const GREATEST: f64 = 1e100;
    if cutter.radius <= GREATEST && points.iter().flatten().all(|length| length.abs() <= GREATEST) {
        return Ok(());
    }
    let message = "these lengths are too great to compute the path of the tool";
    Err(Problem::error(
        "bad-value",
        Blame::Block,
        message,
        "check the coordinates, and the diameter of the tool",
    ))
}

fn short_entry(from: Point, to: Point, cutter: &Cutter) -> Box<Problem> {
    let (length, radius) = (short(distance(from, to)), short(cutter.radius));
    let message = format!("the entry is {length} long, and the radius of the tool is {radius}");
    let help =
        "the first move after G41 or G42 must be longer than the radius, in the plane: start further away";
    Problem::error("compensation-entry", Blame::Block, message, help)
}

fn no_fit(block: &Block, cutter: &Cutter) -> Box<Problem> {
    let blame = Blame::Word(if block.has('R') { 'R' } else { 'I' });
    let radius = short(cutter.radius);
    let message = format!("a tool of radius {radius} does not fit into this arc");
    Problem::error(
        "compensation-gouge",
        blame,
        message,
        format!("the inside of an arc needs a radius above {radius}"),
    )
}

fn no_corner(cutter: &Cutter) -> Box<Problem> {
    let radius = short(cutter.radius);
    let message = format!("a tool of radius {radius} does not fit into the corner where this move begins");
    Problem::error("compensation-gouge", Blame::Block, message, "take a smaller tool, or open the corner")
}

fn too_short(blame: Blame, neighbour: &str, cutter: &Cutter) -> Box<Problem> {
    let radius = short(cutter.radius);
    let message = format!(
        "too short for a tool of radius {radius}: the corner with {neighbour} leaves nothing of this move"
    );
    Problem::error("compensation-gouge", blame, message, "take a smaller tool, or open the corner")
}

fn too_short_before(cutter: &Cutter, out: &Output) -> Box<Problem> {
    let here = out.place;
    match out.waiting.place() {
        Some(place) if place.file == here.file => {
            let neighbour = format!("that of line {}", here.line);
            too_short(Blame::Line(place.line), &neighbour, cutter)
        }
        _ => no_corner(cutter),
    }
}

fn stopped_in_corner() -> Box<Problem> {
    let message =
        "the tool has stopped at the end of the previous move, beyond the inside corner with this one";
    let help = "stop (M0, M1, M60) within a straight part of the contour or at an outside corner";
    Problem::error("compensation-gouge", Blame::Block, message, help)
}
