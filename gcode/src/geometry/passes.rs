//! Roughing and finishing passes along a contour.
//!
//! In: a start point and a monotone contour in the frame of the cuts ([`super::frame`]: passes run towards
//! −Z, infeed is −X), with its allowance on it ([`super::offset`]). Out: moves in that frame. Lengths in the
//! unit of the contour.
//!
//! The order is that of `walk.rs`; here its steps become moves.
//!
//! ```text
//! escape    up and back by min(r, l/2) each,  r as programmed, l length of the pass      (7)
//! ```
//!
//! | function | for |
//! |---|---|
//! | [`rough`] | G71, G72 of LinuxCNC with .1 (pockets are bridged) and .2 (pockets only) |
//! | [`finish`] | G70 of LinuxCNC; after the last allowance of any dialect |
//! | [`turn`] | G71, G72 of FANUC, types I and II |
//! | [`repeat`] | G73 of FANUC: the contour itself, from farther away to its place |

use super::contour::{NEAR, Point, Segment};
use super::walk::{Step, walk};

/// One move in the frame of the cuts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Move {
    /// At rapid speed to a point.
    Rapid(Point),
    /// In a straight line to a point, cutting.
    Feed(Point),
    /// Along an arc from where the tool is, cutting.
    Arc {
        /// End.
        end: Point,
        /// Centre.
        center: Point,
        /// Counterclockwise with Z to the right and X up.
        ccw: bool,
    },
}

/// What happens to pockets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Pockets {
    /// They are cut.
    Cut,
    /// They are passed over at the height of their rim.
    Bridge,
    /// They alone are cut: up to the first one the tool follows the contour.
    Only,
}

/// How roughing goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Roughing {
    /// i, infeed from pass to pass, greater than 0.
    pub(crate) infeed: f64,
    /// r, escape after each pass, 0 or greater.
    pub(crate) escape: f64,
    /// Pockets.
    pub(crate) pockets: Pockets,
}

/// The contour with a wall at its end up to the height of `start`, if it ends lower: what is after it stays.
/// For roughing, with the allowance on it.
pub(crate) fn walled(start: Point, contour: &[Segment]) -> Vec<Segment> {
    let mut walled = contour.to_vec();
    if let Some(end) = contour.last().map(|last| last.end).filter(|end| end.x < start.x) {
        walled.push(Segment::line(end, Point::new(end.z, start.x)));
    }
    walled
}

/// Roughs a contour. The first pass is at the height of `start`, after each pass the tool escapes (7) and
/// goes back to its beginning, and it is left at the end of the contour.
///
/// # Errors
/// Those of `send`.
pub(crate) fn rough<E>(
    start: Point,
    contour: &[Segment],
    how: &Roughing,
    send: &mut dyn FnMut(Move) -> Result<(), E>,
) -> Result<(), E> {
    cut(start, contour, (0, how), send, |from, by, lead| {
        let back = from + Point::new(-by, by);
        [Some(Move::Rapid(back)), Some(if lead { Move::Rapid(from) } else { Move::Feed(from) })]
    })
}

/// Roughs a contour as FANUC's G71 and G72 do: the first pass is one infeed below `start`; after each pass
/// the tool escapes (7), goes back to the Z of `start` and feeds in; at last it follows the contour and goes
/// back to `start`. Pockets (type II) are cut.
///
/// # Errors
/// Those of `send`.
pub(crate) fn turn<E>(
    start: Point,
    contour: &[Segment],
    infeed: f64,
    escape: f64,
    send: &mut dyn FnMut(Move) -> Result<(), E>,
) -> Result<(), E> {
    let how = Roughing { infeed, escape, pockets: Pockets::Cut };
    cut(start, contour, (1, &how), send, |from, by, lead| {
        if lead {
            return [Some(Move::Rapid(Point::new(from.z, from.x + by))), None];
        }
        [Some(Move::Rapid(from + Point::new(-by, by))), Some(Move::Feed(from))]
    })?;
    let end = contour.last().map_or(start, |last| last.end);
    send(Move::Rapid(Point::new(end.z, start.x.max(end.x))))?;
    send(Move::Rapid(start))
}

/// The walk as moves. `back` leads from above a pass back to where the next one is fed in.
fn cut<E>(
    start: Point,
    contour: &[Segment],
    (first, how): (u32, &Roughing),
    send: &mut dyn FnMut(Move) -> Result<(), E>,
    back: fn(Point, f64, bool) -> [Option<Move>; 2],
) -> Result<(), E> {
    let mut pending = Pending { arc: None, send };
    pending.send(Move::Rapid(start))?;
    walk(start, contour, first, how, &mut |step| match step {
        Step::Down { part, lead: true } => pending.send(Move::Rapid(part.end)),
        Step::Down { part, lead: false } => pending.follow(&part, false),
        Step::Up { part, valley } => pending.follow(&part, valley),
        Step::Bridge(to) => pending.send(Move::Feed(to)),
        Step::Across { from, to, lead } => {
            let by = how.escape.min(from.distance(to) / 2.0);
            pending.send(Move::Feed(to))?;
            pending.send(Move::Rapid(to + Point::new(by, by)))?;
            back(from, by, lead).into_iter().flatten().try_for_each(|back| pending.send(back))
        }
    })?;
    pending.flush()
}

/// Goes to `start`, to the beginning of the contour and along it.
///
/// # Errors
/// Those of `send`.
pub(crate) fn finish<E>(
    start: Point,
    contour: &[Segment],
    send: &mut dyn FnMut(Move) -> Result<(), E>,
) -> Result<(), E> {
    send(Move::Rapid(start))?;
    let Some(first) = contour.first() else { return Ok(()) };
    send(Move::Rapid(first.start))?;
    contour.iter().try_for_each(|segment| send(cutting(segment)))
}

/// Follows a contour `passes` times, each time from `start`: the first time `relief` + `allowance` away from
/// its place, the last time `allowance`, in between in equal steps.
///
/// # Errors
/// Those of `send`.
pub(crate) fn repeat<E>(
    start: Point,
    contour: &[Segment],
    (relief, allowance): (Point, Point),
    passes: u32,
    send: &mut dyn FnMut(Move) -> Result<(), E>,
) -> Result<(), E> {
    for pass in 0..passes {
        let left = f64::from(passes - 1 - pass) / f64::from((passes - 1).max(1));
        let by = relief * left + allowance;
        let shifted: Vec<Segment> = contour.iter().map(|segment| segment.shifted(by)).collect();
        finish(start, &shifted, send)?;
    }
    send(Move::Rapid(start))
}

/// The move along a segment.
fn cutting(segment: &Segment) -> Move {
    match segment.bend {
        None => Move::Feed(segment.end),
        Some(bend) => Move::Arc { end: segment.end, center: bend.center, ccw: bend.ccw },
    }
}

/// Sends moves; the two halves of a valley go out as one arc.
struct Pending<'a, E> {
    arc: Option<Move>,
    send: &'a mut dyn FnMut(Move) -> Result<(), E>,
}

impl<E> Pending<'_, E> {
    fn send(&mut self, next: Move) -> Result<(), E> {
        self.flush()?;
        (self.send)(next)
    }

    fn flush(&mut self) -> Result<(), E> {
        self.arc.take().map_or(Ok(()), |arc| (self.send)(arc))
    }

    /// Along a part of the contour, `on` if it continues the arc before it.
    fn follow(&mut self, part: &Segment, on: bool) -> Result<(), E> {
        let next = cutting(part);
        if matches!(next, Move::Feed(_)) {
            return self.send(next);
        }
        let center = |of: &Move| match of {
            Move::Arc { center, .. } => Some(*center),
            _ => None,
        };
        if !(on && self.arc.as_ref().and_then(center) == center(&next)) {
            self.flush()?;
        }
        if part.chord() > NEAR {
            self.arc = Some(next);
        }
        Ok(())
    }
}
