//! G70, G71, G72: finishing and roughing along a contour that a subroutine holds.
//!
//! In: a block with Q (the subroutine), X Z (where to start), D I R, or D E P; then, block by block, the
//! subroutine, which is read but not executed. Out: the moves of the passes. Lengths in program units.
//!
//! ```text
//! begin ──► subroutine Q is called ──► record, each block ──► it returns ──► end: contour ──► passes
//! ```
//!
//! | file | what it does |
//! |---|---|
//! | `record.rs` | blocks of the subroutine become a contour |
//! | `contour.rs`, `corner.rs` | lines and arcs in the ZX plane; fillets and chamfers |
//! | `frame.rs` | turning, facing, boring: the same thing in other directions |
//! | `offset.rs` | allowance |
//! | `walk.rs`, `passes.rs` | the order of cutting, and its moves |
//!
//! All but `record.rs` and this file is geometry that knows no state and no calls. Who has a contour from
//! elsewhere (FANUC's P and Q) goes
//! ```text
//! Frame::of, enter_segment ─► left_on (D), walled, or shifted (U W) ─► rough, turn, repeat, finish ─► leave
//! ```
//!
//! Where LinuxCNC's stand-alone interpreter does otherwise: its G70 can put the distance on the far side of a
//! face, its roughing leaves D on what is beyond an open end of the contour (only what is compared with it
//! does so here), skips levels after an arc that falls and rises, and does not cut a contour that ends lower
//! than it began.
//!
//! What the words mean, and the default values: manual of LinuxCNC, G70 and G71 G72.

mod record;

use super::check::compensation_off;
use super::{Done, Kind, Output, compensation, feed, straight, thin};
use crate::block::Block;
use crate::canon::{Arc, Call, FeedMode, Place, Plane, X, Y, Z};
use crate::codes::G;
use crate::geometry::contour::{NEAR, Point, Segment};
use crate::geometry::frame::{Frame, sight};
use crate::geometry::offset::{left_on, raised};
use crate::geometry::passes::{Move, Pockets, Roughing, finish, rough, walled};
use crate::problem::{Blame, Problem, short};
use crate::state::{Cycle, State};

pub(crate) use record::record;

/// The block of a cycle: goes to the start, and has the subroutine called.
pub(super) fn begin(code: G, block: &Block, state: &mut State, out: &mut Output) -> Done {
    if state.modes.plane != Plane::Xz {
        let message = format!("{code} works in the ZX plane only");
        return Err(Problem::error("bad-value", Blame::G(code), message, "select G18 first"));
    }
    if code != G(700) {
        compensation_off(Blame::G(code), "rough", state)?;
    }
    if state.modes.feed_mode == FeedMode::InverseTime {
        let message = format!("{code} makes many moves: F cannot be the inverse of the time of each (G93)");
        return Err(Problem::error("bad-value", Blame::G(code), message, "select G94 or G95 first"));
    }
    feed::ready(block, state)?;
    let whole = |letter: char, least: i64, help: &str| match block.integer(letter) {
        Some(value) if value >= least => u32::try_from(value).map_err(|_| bad(block, letter, help)),
        _ => Err(bad(block, letter, help)),
    };
    let subroutine = whole('Q', 0, "Q is the number of the subroutine that holds the contour")?;
    let passes = if block.has('P') { whole('P', 1, "P is the number of passes, from 1")? } else { 1 };
    let infeed = block.get('I').unwrap_or(1.0);
    if infeed <= 0.0 {
        return Err(bad(block, 'I', "I is the infeed from pass to pass, greater than 0"));
    }
    if code != G(700) {
        thin::doubt(("the infeed", Blame::Word('I')), infeed, 0.0, state.units.program(), None, out);
    }
    let escape = block.get('R').unwrap_or(0.5);
    if escape < 0.0 {
        return Err(bad(block, 'R', "R is how far the tool escapes after a pass, 0 or greater"));
    }
    if code.0 >= 710 && block.get('D').is_some_and(|distance| distance < 0.0) {
        return Err(bad(
            block,
            'D',
            "D is what roughing leaves on the contour, 0 or greater: less would cut into it",
        ));
    }
    let position = straight::target(block, state)?;
    straight::move_to(Kind::Traverse, position, block, state, out)?;
    state.modes.motion = Some(G(0));
    state.recorder.begin(Cycle {
        code,
        subroutine,
        place: out.place,
        level: state.progress.call_level,
        called: false,
        broken: false,
        start: Point::new(position[Z], position[X]),
        position,
        distance: block.get('D').unwrap_or(0.0),
        ending_distance: block.get('E').unwrap_or(0.0),
        passes,
        infeed,
        escape,
        pieces: Vec::new(),
    });
    Ok(())
}

fn bad(block: &Block, letter: char, help: &str) -> Box<Problem> {
    let message = format!("{letter}{} makes no sense here", short(block.get(letter).unwrap_or(0.0)));
    Problem::error("bad-value", Blame::Word(letter), message, help)
}

/// Makes the passes if the subroutine of the contour has returned. `done` is what the O word that was
/// executed says.
pub(crate) fn end(done: Done, state: &mut State, out: &mut Output) -> Done {
    if let Some(cycle) = state.recorder.cycle_mut().filter(|_| done.is_err()) {
        cycle.broken = true;
    }
    let level = state.progress.call_level;
    let Some(cycle) = state.recorder.take_ended(level) else { return done };
    state.axes.position = cycle.position;
    if cycle.broken {
        return done;
    }
    let Place { n, n_digits, .. } = out.place;
    out.place = Place { n, n_digits, ..cycle.place };
    Passes { cycle: &cycle }.cut(state, out).map_err(|mut problem| {
        problem.blame = Blame::At(cycle.place);
        problem
    })
}

/// A cycle that is being cut.
struct Passes<'a> {
    cycle: &'a Cycle,
}

impl Passes<'_> {
    fn cut(&self, state: &mut State, out: &mut Output) -> Done {
        let contour = record::contour(&self.cycle.pieces).map_err(|(what, at)| self.refuse(&what, at))?;
        if contour.is_empty() {
            let message =
                format!("there is no line or arc after the first move of o{}", self.cycle.subroutine);
            let help = "the first move of a contour leads to its beginning: add the contour after it";
            return Err(Problem::error("bad-contour", Blame::Block, message, help));
        }
        let (frame, contour, start) = self.framed(&contour)?;
        let as_reference = state.settings.stand_alone;
        let (most, mut count) = (state.settings.moves_of_block, 0);
        self.passes(start, &contour, as_reference, &mut |_| {
            count += 1;
            if count > most { Err(self.endless(most)) } else { Ok(()) }
        })?;
        self.passes(start, &contour, as_reference, &mut |next| self.send(next, &frame, state, out))
    }

    /// All the moves, along a contour in the frame of its cuts.
    fn passes(
        &self,
        start: Point,
        contour: &[Segment],
        as_reference: bool,
        send: &mut dyn FnMut(Move) -> Done,
    ) -> Done {
        if self.cycle.code == G(700) {
            let step = (self.cycle.distance - self.cycle.ending_distance) / f64::from(self.cycle.passes);
            for pass in (0..self.cycle.passes).rev() {
                let distance = self.cycle.ending_distance + f64::from(pass) * step;
                let contour = self.at(distance, raised(contour, distance))?;
                finish(start, &contour, send)?;
            }
            return Ok(());
        }
        let pockets = match self.cycle.code.0 % 10 {
            0 => Pockets::Cut,
            1 => Pockets::Bridge,
            _ => Pockets::Only,
        };
        let how = Roughing { infeed: self.cycle.infeed, escape: self.cycle.escape, pockets };
        let distance = self.cycle.distance;
        let left = match as_reference {
            true => self.at(distance, raised(&walled(start, contour), distance))?,
            false => walled(start, &self.at(distance, left_on(contour, distance))?),
        };
        rough(start, &left, &how, send)
    }

    /// The contour in the frame of its cuts, and where the tool goes down to it from. G70 takes the frame
    /// that the contour is monotone in, and in which that point is on the side of the tool.
    fn framed(&self, contour: &[Segment]) -> Result<(Frame, Vec<Segment>, Point), Box<Problem>> {
        let (directions, finishes): (&[bool], bool) = match self.cycle.code.0 {
            700 => (&[false, true], true),
            710..=712 => (&[false], false),
            _ => (&[true], false),
        };
        let (mut turns_back, mut crossing) = (None, None);
        for facing in directions {
            let of = if finishes { Frame::beside } else { Frame::of };
            let frame = of(contour, self.cycle.start, *facing);
            let framed: Vec<Segment> = contour.iter().map(|segment| frame.enter_segment(segment)).collect();
            let start = frame.above(&framed, self.cycle.start);
            match framed.iter().find(|segment| !segment.is_monotone()) {
                None if finishes && sight(&framed, start).is_some_and(|turned_left| turned_left > 0.0) => {
                    crossing = crossing.or(Some((frame, framed, frame.enter(self.cycle.start))));
                }
                None => return Ok((frame, framed, start)),
                Some(segment) => turns_back = turns_back.or(Some(frame.leave(segment.start))),
            }
        }
        if let Some(crossing) = crossing {
            return Ok(crossing);
        }
        let axis = match directions {
            [false, true] => "neither Z nor X goes",
            [false] => "Z does not go",
            _ => "X does not go",
        };
        let what = format!("{axis} in one direction all along the contour");
        Err(self.refuse(&what, turns_back.unwrap_or(self.cycle.start)))
    }

    /// What is left of the contour at a distance.
    fn at(&self, distance: f64, left: Option<Vec<Segment>>) -> Result<Vec<Segment>, Box<Problem>> {
        left.ok_or_else(|| {
            let what = format!("nothing is left of the contour at a distance of {}", short(distance));
            self.refuse(&what, self.cycle.start)
        })
    }

    fn endless(&self, most: u64) -> Box<Problem> {
        let message =
            format!("{} would make more than {most} moves: the limit moves_of_block", self.cycle.code);
        let help =
            if self.cycle.code == G(700) { "give fewer passes (P)" } else { "give a greater infeed (I)" };
        Problem::error("bad-value", Blame::Block, message, help)
    }

    fn refuse(&self, what: &str, at: Point) -> Box<Problem> {
        let message = format!("{what}: o{}, at X{} Z{}", self.cycle.subroutine, short(at.x), short(at.z));
        let help = "correct the contour, or take the distance, fillets and chamfers smaller";
        Problem::error("bad-contour", Blame::Block, message, help)
    }

    fn send(&self, next: Move, frame: &Frame, state: &mut State, out: &mut Output) -> Done {
        let mut block = Block::default();
        block.clear(self.cycle.place.file, self.cycle.place.line);
        let position = |at: Point, state: &State| {
            let (at, mut position) = (frame.leave(at), state.axes.position);
            (position[Z], position[X]) = (at.z, at.x);
            position
        };
        match next {
            Move::Rapid(to) => {
                state.modes.motion = Some(G(0));
                straight::move_to(Kind::Traverse, position(to, state), &block, state, out)
            }
            Move::Feed(to) => {
                state.modes.motion = Some(G(10));
                straight::move_to(Kind::Feed, position(to, state), &block, state, out)
            }
            Move::Arc { end, center, ccw } => {
                let (end, center, ccw) = (position(end, state), frame.leave(center), ccw != frame.mirrors());
                let from = Point::new(state.axes.position[Z], state.axes.position[X]);
                if from.distance(Point::new(end[Z], end[X])) < NEAR {
                    return Ok(());
                }
                state.modes.motion = Some(if ccw { G(30) } else { G(20) });
                let [.., a, b, c] = state.axes.position;
                let arc = Arc {
                    end: [end[Z], end[X]],
                    center: [center.z, center.x],
                    turns: if ccw { 1 } else { -1 },
                    along: state.axes.position[Y],
                    rotary: [a, b, c],
                };
                if state.compensation.is_on() {
                    compensation::arc_allowed(&block, state)?;
                    return compensation::arc(arc, &block, state, out);
                }
                out.call(Call::ArcFeed(arc))?;
                state.axes.position = end;
                Ok(())
            }
        }
    }
}
