//! Cycles along a contour: G70 finishes it, G71 and G72 rough it, G73 repeats it from farther away.
//!
//! ```text
//! G71 U(Δd) R(e)            G72 W(Δd) R(e)            G73 U(Δi) W(Δk) R(d)
//! G71 P Q U(Δu) W(Δw) F     G72 P Q U(Δu) W(Δw) F     G73 P Q U(Δu) W(Δw) F         G70 P Q
//! ```
//! G71 P Q U W D F and G72 P Q U W D F in one block (D: depth of cut; the retract is 0.5 mm, 0.02 inch).
//! P and Q are N of the first and last block of the contour; the first one leads to it. Δd, Δi and Δk are
//! radii and lengths, Δu a diameter. The blocks are executed with a receiver that keeps their moves, corners
//! made and tools left out: what remains is lines and arcs. The passes come from
//! [`crate::execute::roughing`]. A program goes on after the contour if that stands after the cycle.

use super::codes::{self, Deed};
use super::execution::Execution;
use super::line::{Line, Statement};
use super::shape::Shape;
use super::{Control, block, corner, first_line, one_block};
use crate::bounds::{MOST_BLOCKS, MOST_PASSES};
use crate::canon::{Place, X, Z};
use crate::codes::{G, group, m_group};
use crate::execute::compensation::Waiting;
use crate::execute::{Done, Output};
use crate::geometry::contour::{Point, Segment};
use crate::geometry::frame::Frame;
use crate::geometry::passes::{Move, repeat, turn, walled};
use crate::geometry::walk::descent;
use crate::problem::{Blame, Problem, Span, short};
use crate::state::{Compensation, State};
use crate::text::Mark;

/// Where the contour of a cycle stands.
struct Range {
    first: u32,
    last: u32,
    begin: Mark,
}

impl Control {
    /// G70 to G73. The modes of the block are in force.
    ///
    /// # Errors
    /// A word is missing, there is no such contour, or it cannot be cut like that.
    pub(super) fn contour_cycle(&mut self, code: G, state: &mut State, out: &mut Output) -> Done {
        if code != G(700) && !self.line.has_any("PQ") {
            let done = first_line::take(code, &self.line, &mut self.modal, out);
            self.modal.first.refused = done.is_err().then_some(code);
            return done;
        }
        let cycle = self.line.clone();
        let range = self.range(code)?;
        if self.modal.first.refused == Some(code) && !cycle.has('D') {
            self.pass_contour(range.first, range.last);
            return Ok(());
        }
        let behind = self.flow.files.mark();
        let done = match code {
            G(700) => self.finish(&range, state, out),
            _ => self.uncompensated(code, &cycle, &range, state, out),
        };
        // Roughing goes on after the contour, or where the cycle stands if that is farther on; G70 after
        // itself.
        let finished = code == G(700);
        if finished || self.flow.files.mark().lines < behind.lines || range.begin.lines < behind.lines {
            self.flow.files.go(self.flow.files.current(), behind)?;
        }
        if done.is_err() && !finished {
            self.flow.files.go(self.flow.files.current(), behind)?;
            self.pass_contour(range.first, range.last);
        }
        done?;
        self.line = cycle;
        Ok(())
    }

    /// Goes on behind a contour that stands behind this place, for nothing of it is cut.
    pub(super) fn pass_contour(&mut self, first: u32, last: u32) {
        let here = self.flow.files.mark();
        let behind = |mark: &Mark| mark.lines >= here.lines;
        let found = self.flow.label(first).ok().filter(behind).and(self.flow.label(last).ok().filter(behind));
        if let Some(end) = found
            && self.flow.files.go(self.flow.files.current(), end).is_ok()
        {
            // The line that was found is there: what is wrong with it was said, or will be by G70.
            let _ = self.flow.files.take();
        }
    }

    fn range(&mut self, code: G) -> Result<Range, Box<Problem>> {
        let number = |letter: char| match self.line.whole(letter)? {
            Some(number) if number > 0 => Ok(number as u32),
            _ => {
                let message = format!("{code} needs {letter}, the N of a block of the contour");
                let help = "add P, N of its first block, and Q, N of its last one";
                Err(Problem::error("missing-word", Blame::G(code), message, help))
            }
        };
        let (first, last) = (number('P')?, number('Q')?);
        let missing = |letter, message| {
            let help = format!(
                "{letter} of {code} is the N of the {} block",
                if letter == 'P' { "first" } else { "last" }
            );
            Problem::error("bad-contour", Blame::Word(letter), message, help)
        };
        let nowhere = |_| missing('P', format!("no block of this program has N{first}"));
        let begin = self.flow.label(first).map_err(nowhere)?;
        if !self.flow.is_behind(begin, last)? {
            let message = format!("no block has N{last} behind N{first}: P and Q do not name one contour");
            return Err(missing('Q', message));
        }
        Ok(Range { first, last, begin })
    }

    /// G70: the blocks of the contour, and back.
    fn finish(&mut self, range: &Range, state: &mut State, out: &mut Output) -> Done {
        let start = state.axes.position;
        let place = self.line.block.place();
        one_block::unused(&self.line, out);
        self.replay(range, state, out)?;
        out.place = place;
        let mut run = self.execution(state, out);
        let back = [start[Z], start[X]];
        if !run.state.compensation.is_on() {
            return run.go(G(0), back, None, place);
        }
        // The way back is not part of the contour: compensated, it would lead through the part.
        let nowhere = Span::default();
        run.equivalent.clear(place.file, place.line);
        run.equivalent.add_g(group::COMPENSATION, G(400), nowhere)?;
        run.equivalent.add_g(group::MOTION, G(0), nowhere)?;
        run.equivalent.add('X', 2.0 * back[1], nowhere)?;
        run.equivalent.add('Z', back[0], nowhere)?;
        run.execute()
    }

    /// Executes the blocks of a contour.
    fn replay(&mut self, range: &Range, state: &mut State, out: &mut Output) -> Done {
        self.flow.files.go(self.flow.files.current(), range.begin)?;
        for _ in 0..MOST_BLOCKS {
            let Some(statement) = self.read(state, out)? else { break };
            match statement {
                Statement::Nothing => {}
                Statement::Block => self.contour_block(state, out)?,
                _ => {
                    let message = "a contour is made of moves: nothing can be called or repeated in it";
                    let help = "write its blocks one after the other";
                    return Err(Problem::error("bad-contour", Blame::Block, message, help));
                }
            }
            if self.line.block.n == Some(range.last) {
                return match self.modal.pending.take() {
                    Some(pending) => Err(corner::alone(&pending, "the end of the contour")),
                    None => Ok(()),
                };
            }
        }
        let message = format!("the contour that begins at N{} has no N{} after it", range.first, range.last);
        let help = format!("give its last block N{}", range.last);
        Err(Problem::error("bad-contour", Blame::Block, message, help))
    }

    fn contour_block(&mut self, state: &mut State, out: &mut Output) -> Done {
        let deed = codes::deed(&self.line, self.modal.acting(&self.line))?;
        if let Some(code) = self.line.block.m(m_group::STOP) {
            let message = format!("{code} stands in a contour");
            return Err(Problem::error(
                "bad-contour",
                Blame::M(code),
                message,
                "Q of the cycle names the last block",
            ));
        }
        if !matches!(deed, Deed::None | Deed::G(G(0 | 10 | 20 | 30 | 40))) {
            let what = match deed {
                Deed::G(code) => code.to_string(),
                Deed::M(code) => code.to_string(),
                Deed::None => String::new(),
            };
            let message = format!("{what} cannot stand in a contour");
            return Err(Problem::error("bad-contour", Blame::Block, message, "use G00, G01, G02 and G03"));
        }
        let mut run = self.execution(state, out);
        block::run(deed, &mut run)?;
        block::last(&mut run)
    }

    /// The contour as it is, with the move that leads to it, and which of its moves are rapids. Variables
    /// that it sets stay set.
    fn shape(&mut self, range: &Range, state: &State) -> Result<Vec<(Segment, bool)>, Box<Problem>> {
        let mut state = state.clone();
        state.compensation = Compensation::default();
        let mut shape = Shape { at: point(&state), segments: Vec::new() };
        let modal = self.modal.clone();
        self.modal.shape_only = true;
        let (mut warnings, mut waiting) = (Vec::new(), Waiting::default());
        let mut out = Output::new(&mut shape, self.line.block.place(), &mut warnings, &mut waiting);
        let done = self.replay(range, &mut state, &mut out);
        self.modal = modal;
        done?;
        Ok(shape.segments)
    }

    /// G71, G72, G73, under G41 or G42 too: passes are not compensated, and what comes after them is again.
    fn uncompensated(
        &mut self,
        code: G,
        cycle: &Line,
        range: &Range,
        state: &mut State,
        out: &mut Output,
    ) -> Done {
        let on = state.compensation.code();
        if on == G(400) {
            return self.rough(code, cycle, range, state, out);
        }
        let message = format!("{on} has no effect on the passes of {code}: they leave the allowance alone");
        let help = "end it with G40 before the cycle; G41 or G42 in the contour is for G70";
        out.warn(Problem::warning("no-effect", Blame::G(code), message, help));
        self.compensate(G(400), state, out)?;
        self.rough(code, cycle, range, state, out)?;
        self.compensate(on, state, out)
    }

    /// G40, G41 or G42 by itself.
    fn compensate(&mut self, code: G, state: &mut State, out: &mut Output) -> Done {
        let mut run = self.execution(state, out);
        run.begin();
        run.equivalent.add_g(group::COMPENSATION, code, Span::default())?;
        run.execute()
    }

    /// G71, G72, G73 by themselves.
    fn rough(&mut self, code: G, cycle: &Line, range: &Range, state: &mut State, out: &mut Output) -> Done {
        let facing = code == G(720);
        let first = &self.modal.first;
        let depth = one_block::depth(cycle, out)?.or(first.rough[usize::from(facing)]);
        let pattern = first.pattern;
        let missing = if code == G(730) { pattern.is_none() } else { depth.is_none() };
        first_line::can_rough(code, cycle, missing)?;
        let mut contour = self.shape(range, state)?;
        without_way_back(&mut contour, facing);
        let contour: Vec<Segment> = contour.into_iter().map(|(segment, _)| segment).collect();
        self.line.clone_from(cycle);
        if contour.len() < 2 || contour.first().is_some_and(|lead| lead.bend.is_some()) {
            let message = format!("N{} to N{} is not a contour that {code} can cut", range.first, range.last);
            let help = "its first block leads to its beginning, G00 or G01; lines and arcs follow";
            return Err(Problem::error("bad-contour", Blame::G(code), message, help));
        }
        let contour = contour.get(1..).unwrap_or(&[]);
        let place = cycle.block.place();
        let allowance = Point::new(cycle.length('W').unwrap_or(0.0), cycle.length('U').unwrap_or(0.0) / 2.0);
        let start = point(state);
        let frame = match code {
            G(730) => Frame { facing: false, z: 1.0, x: 1.0 },
            _ => Frame::of(contour, start, facing),
        };
        out.place = place;
        if code != G(730) && frame.enter(allowance).x < 0.0 {
            let letter = if facing { 'W' } else { 'U' };
            let message =
                format!("the allowance {letter} lies inside of the contour: nothing is left to finish");
            let help = "its sign says on which side the tool stays: U+ outside, U- in a bore";
            out.warn(Problem::warning("allowance-sign", Blame::Word(letter), message, help));
        }
        let mut run = self.execution(state, out);
        let mut send = |next| send(next, &frame, place, &mut run);
        if let (G(730), Some((x, z, passes))) = (code, pattern) {
            return repeat(start, contour, (Point::new(z, x), allowance), passes, &mut send);
        }
        let (infeed, escape) = depth.unwrap_or((1.0, 0.0));
        let from = frame.enter(start + allowance);
        let framed = framed(contour, allowance, &frame)?;
        if descent(from, &framed) / infeed > MOST_PASSES {
            let message = format!("a depth of cut of {infeed} would take more than {MOST_PASSES} passes");
            let help = "give a greater one in the first line";
            return Err(Problem::error("bad-value", Blame::G(code), message, help));
        }
        turn(from, &walled(from, &framed), infeed, escape, &mut send)?;
        send(Move::Rapid(frame.enter(start)))
    }
}

/// The contour with its allowance, in the frame of its cuts.
fn framed(contour: &[Segment], allowance: Point, frame: &Frame) -> Result<Vec<Segment>, Box<Problem>> {
    let framed: Vec<Segment> =
        contour.iter().map(|segment| frame.enter_segment(&segment.shifted(allowance))).collect();
    let Some(segment) = framed.iter().find(|segment| !segment.is_monotone()) else { return Ok(framed) };
    let at = frame.leave(segment.start) - allowance;
    let axis = if frame.facing { 'X' } else { 'Z' };
    let message = format!("{axis} turns back along the contour, at X{} Z{}", short(2.0 * at.x), short(at.z));
    let help = format!("let {axis} go in one direction, or use G73");
    Err(Problem::error("bad-contour", Blame::Block, message, help))
}

/// Leaves out rapids at the end of a contour that lead back along it, to where the tool came from: nothing
/// is to be cut there.
fn without_way_back(contour: &mut Vec<(Segment, bool)>, facing: bool) {
    let along = |segment: &Segment| {
        let way = segment.end - segment.start;
        if facing { way.x } else { way.z }
    };
    while let [_, cuts @ .., (last, true)] = contour.as_slice() {
        let cut: f64 = cuts.iter().map(|(segment, _)| along(segment)).sum();
        if cuts.is_empty() || along(last) * cut >= 0.0 {
            return;
        }
        contour.pop();
    }
}

fn point(state: &State) -> Point {
    Point::new(state.axes.position[Z], state.axes.position[X])
}

/// A move of the passes.
fn send(next: Move, frame: &Frame, place: Place, run: &mut Execution) -> Done {
    let at = |point| {
        let Point { z, x } = frame.leave(point);
        [z, x]
    };
    let (code, end, center) = match next {
        Move::Rapid(end) => (G(0), at(end), None),
        Move::Feed(end) => (G(10), at(end), None),
        Move::Arc { end, center, ccw } => {
            let code = if ccw != frame.mirrors() { G(30) } else { G(20) };
            let ([z, x], here) = (at(center), point(run.state));
            (code, at(end), Some([z - here.z, x - here.x]))
        }
    };
    run.go(code, end, center, place)
}
