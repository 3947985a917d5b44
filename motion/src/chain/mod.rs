//! Timed motion over a chain of blocks: corners are rounded, the feed is planned ahead, s(t) goes on cycle by
//! cycle. In: lines and arcs with their feeds; once a cycle, what the operator asks for. Out: once a cycle,
//! the motion of every axis, mm/sⁿ.
//!
//! | part | holds |
//! |---|---|
//! | `chain/asked.rs` | feeds and overrides |
//! | `chain/pieces.rs` | the blocks, and the blends that reach each of them |
//! | `chain/junction.rs` | what becomes of the place where two blocks meet |
//! | `chain/halt.rs` | where a stop is faster than a rounded corner (M183) |
//! | `chain/width.rs` | how wide the blends of corners are (M172) |
//! | `chain/sweep.rs` | bounds of a line with its blends (M173) |
//! | `chain/zone.rs` | limits of the feed over a stretch, from the bends of the path (M66) |
//! | `chain/allowance.rs` | these limits by speed (M179) |
//! | `chain/section.rs` | stretches with one set of limits |
//! | `chain/ahead.rs` | the look-ahead over them (M24, M26, M196) |
//! | `chain/span.rs` | how many of them the next law passes (M197) |
//! | `chain/steer.rs` | the decision which law s(t) follows next (M23, M64) |
//! | `chain/law.rs` | the law, and the check before it is released |
//! | `chain/overlap.rs` | the law behind a stop, which begins before the one before has ended (M194, M195) |
//!
//! ```text
//! blocks → path p(s) with blends → sections with limits → exits (look-ahead) → law s(t) → axes p(s(t))
//! ```
//! Every law starts and ends without jerk, so a new one can follow at any such moment: an override or a hold
//! replaces the law in hand as soon as its pulse of jerk is over. Whatever state a law leaves behind is one
//! from which the machine can stop on what is known of the path: that is what the hard pass of the look-ahead
//! guarantees.

mod ahead;
mod allowance;
mod asked;
mod halt;
mod junction;
mod law;
mod overlap;
mod pieces;
mod section;
mod span;
mod steer;
mod sweep;
mod width;
mod zone;

use crate::limits::Limits;
use crate::path::Path;
use crate::sample::Sample;

use ahead::{SECTIONS, Sections};
use allowance::SAME;
pub use asked::{Feed, LEAST_FEED, MOST_RATIO, Ratios};
pub use junction::Corner;
use law::Law;
use overlap::Tail;
use pieces::Pieces;
use section::Section;
pub(crate) use zone::Bend;

/// How many blocks a chain looks ahead.
pub const BLOCKS: usize = 1024;
/// A block takes at least this share of a cycle: so one cycle passes a bounded number of blocks.
const LEAST_CYCLES: f64 = 0.0625;
/// Most stretches of a block with limits of their own.
const ZONES: usize = 3;

/// What a chain is laid out for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings<const N: usize> {
    /// Limits of the axes; [`Limits::NONE`] for one that does not exist.
    pub axes: [Limits; N],
    /// Time between two calls of [`Chain::tick`], s.
    pub cycle_s: f64,
}

/// One block.
#[derive(Clone, Copy, Debug)]
pub struct Block<const N: usize, T> {
    /// Its path.
    pub path: Path<N>,
    /// Its feed.
    pub feed: Feed,
    /// What may become of the corner at its end.
    pub corner: Corner,
    /// How far the path may bulge out of its own box, mm: the travel that is left.
    pub room: f64,
    /// Largest chord error of the setpoints, mm.
    pub chord_mm: f64,
    /// The caller's own.
    pub tag: T,
}

/// What is asked for in a cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ask {
    /// Overrides.
    pub ratios: Ratios,
    /// Stand on the path.
    pub hold: bool,
    /// Stand at the end of every block.
    pub single: bool,
    /// More blocks are at hand or about to be: the chain need not stop at the end of what it knows yet.
    pub more: bool,
}

/// What a chain did in a cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step<const N: usize, T> {
    /// The motion of the axes at the end of the cycle, from the start of the block of `tag`.
    pub axes: [Sample; N],
    /// The motion along the path, from the start of the block.
    pub along: Sample,
    /// The block in which the chain is.
    pub tag: T,
    /// The block before, as long as its law has not come to its end (M194): it is not completed.
    pub last: Option<T>,
    /// Blocks completed in this cycle.
    pub completed: u32,
    /// It ran out of blocks and stops at the end of what it knows, although more were to come.
    pub starved: bool,
    /// No law could be released at the end of the one before. The chain stands, or brakes on its path.
    pub rejected: bool,
}

/// A chain of blocks, and where the machine is on it. It allocates once, in `new`; one that grows, as it
/// goes.
#[derive(Clone, Debug)]
pub struct Chain<const N: usize, T> {
    settings: Settings<N>,
    ratios: Ratios,
    pieces: Pieces<N, T>,
    sections: Sections,
    /// Way on the first piece at the start of the law, mm.
    along: f64,
    law: Law,
    /// Time in the law, s.
    t: f64,
    /// The law before, as long as it has not come to its end.
    tail: Option<Tail>,
    /// Nothing can be appended any more.
    closed: bool,
    /// The plan in hand may not be the best any more.
    stale: bool,
    /// Single block was asked for last.
    single: bool,
    /// Cycles at rest since blocks were last at hand.
    quiet: u32,
    completed: u32,
    starved: bool,
    rejected: bool,
}

impl<const N: usize, T: Copy + Default> Chain<N, T> {
    /// An empty chain with all the memory that it will need. It is written to once, so that no cycle has to
    /// wait for a page of it.
    #[must_use]
    pub fn new(settings: Settings<N>) -> Chain<N, T> {
        let mut chain = Chain::growing(settings);
        if let Some(path) = Path::line([1.0; N], &[true; N]) {
            let (feed, corner, tag) = (Feed::Rapid, Corner::Stop, T::default());
            let block = Block { path, feed, corner, room: 0.0, chord_mm: 0.0, tag };
            chain.pieces.take_memory(block);
        }
        chain.sections.take_memory();
        chain
    }

    /// The same for who has time to wait: it takes memory when it needs it.
    #[must_use]
    pub fn growing(settings: Settings<N>) -> Chain<N, T> {
        Chain {
            settings,
            ratios: Ratios::full(0.0),
            pieces: Pieces::new(),
            sections: Sections::new(),
            along: 0.0,
            law: Law::Rest,
            t: 0.0,
            tail: None,
            closed: false,
            stale: false,
            single: false,
            quiet: 0,
            completed: 0,
            starved: false,
            rejected: false,
        }
    }
}

impl<const N: usize, T: Copy> Chain<N, T> {
    /// Whether there is nothing to do.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.pieces.len() == 0
    }

    /// Blocks that are not completed.
    #[must_use]
    pub fn len(&self) -> usize {
        self.pieces.len() + usize::from(self.tail.is_some())
    }

    /// Whether a block can be appended now: there is room, and the chain has not been closed.
    #[must_use]
    pub fn has_room(&self) -> bool {
        let sections = self.sections.len() + ZONES * (self.pieces.pending() + 1);
        !self.closed && self.pieces.len() + 1 < BLOCKS && sections < SECTIONS
    }

    /// Appends a block where the one before ends. The caller has looked for room.
    pub fn push(&mut self, block: Block<N, T>) {
        self.pieces.push(block, &self.settings.axes);
        self.settle();
        self.quiet = 0;
    }

    /// No block follows: the machine stops at the end of the last one.
    pub fn close(&mut self) {
        self.pieces.close();
        self.settle();
        self.sections.stop_at_end();
        self.closed = true;
    }

    /// Turns blocks whose blends are known into sections of the look-ahead.
    fn settle(&mut self) {
        while let Some(k) = self.pieces.settle() {
            let borders = self.pieces.borders(k);
            let bends = self.pieces.bends(k, borders);
            let piece = &self.pieces.ring[k];
            let (block, stops) = (&piece.block, piece.stops());
            let length = piece.length();
            let chord_v2 = 8.0 * block.chord_mm / (self.settings.cycle_s * self.settings.cycle_s);
            let slowest = length / (LEAST_CYCLES * self.settings.cycle_s);
            let asked = block.feed.highest().min(slowest.max(LEAST_FEED));
            let ends = [borders[0], borders[1], length];
            let mut begin = 0.0;
            for (end, bend) in ends.into_iter().zip(&bends) {
                if end > begin {
                    let limits = bend.allowance(&self.settings.axes, asked, chord_v2);
                    let section = Section::new(end - begin, block.feed, limits, stops && end >= length);
                    self.sections.push(section, &self.ratios);
                    begin = end;
                }
            }
        }
    }

    /// Goes on by one cycle. `None` if there is nothing to do.
    pub fn tick(&mut self, ask: &Ask) -> Option<Step<N, T>> {
        if self.is_empty() {
            return None;
        }
        (self.completed, self.starved, self.rejected) = (0, false, false);
        let waits = self.rests() && !ask.more && !ask.hold;
        self.quiet = if waits { self.quiet.saturating_add(1) } else { 0 };
        self.steer(ask);
        self.drop_tail();
        let sample = self.law.at(self.t);
        let s = self.place(sample.s);
        let front = self.pieces.front()?;
        let along = Sample { s, ..sample };
        let mut axes = self.pieces.follow(&along);
        let last = self.led().map(|(tag, led)| {
            axes.iter_mut().zip(led).for_each(|(axis, led)| *axis = *axis + led);
            tag
        });
        let step = Step {
            axes,
            along,
            tag: front.block.tag,
            last,
            completed: self.completed,
            starved: self.starved,
            rejected: self.rejected,
        };
        Some(self.finished(step))
    }

    /// Goes on to the end of the law in hand, for the sake of the time that takes, s. `None` if there is
    /// nothing to do. The caller has closed the chain or filled it, so that it does not wait.
    pub fn skip(&mut self, ask: &Ask) -> Option<f64> {
        if self.is_empty() {
            return None;
        }
        let time = self.leap(ask);
        self.place(self.law.at(self.t).s);
        if self.is_over() {
            self.clear();
        }
        Some(time)
    }

    /// The block in which the machine is.
    #[must_use]
    pub fn here(&self) -> Option<&T> {
        self.pieces.front().map(|piece| &piece.block.tag)
    }

    /// Where on the front block the machine is when it has gone `way` mm in the law; leaves the blocks behind
    /// that are completed.
    fn place(&mut self, way: f64) -> f64 {
        // At rest the end of a block is passed where it is reached but for rounding; by rounding alone it is
        // not passed while the machine still brakes to stand there.
        let brakes = self.law.end_speed() == 0.0 && self.law.way() - way <= SAME;
        let slack = match (self.rests(), brakes) {
            (true, _) => SAME,
            (false, true) => -SAME,
            (false, false) => 0.0,
        };
        let mut s = self.along + way;
        while let Some(length) = self.pieces.settled_length() {
            if s < length - slack || self.pieces.len() == 1 {
                return s.min(length);
            }
            (s, self.along) = (s - length, self.along - length);
            self.completed += 1;
            self.pieces.leave();
        }
        s
    }

    fn is_over(&self) -> bool {
        self.closed && self.rests() && self.sections.front().is_none()
    }

    /// At the very end of a closed chain: counts its last block, and forgets it.
    fn finished(&mut self, mut step: Step<N, T>) -> Step<N, T> {
        if self.is_over() {
            step.completed += 1;
            self.clear();
        }
        step
    }

    /// Whether it stands, wherever it is on its path.
    #[must_use]
    pub fn rests(&self) -> bool {
        matches!(self.law, Law::Rest)
    }

    /// Forgets every block; the machine stands.
    pub fn clear(&mut self) {
        self.pieces.clear();
        self.sections.clear();
        (self.law, self.t, self.along, self.closed) = (Law::Rest, 0.0, 0.0, false);
        self.tail = None;
        self.quiet = 0;
    }
}
