//! What leaves the interpreter: items in the order of the program, and problems that are found later than at
//! their call.
//!
//! In: codes, with where the axes rest before them and what the path may do. Out: items. A path mode goes
//! before the first move that it is for. Before they leave, short lines may become one, and runs of lines
//! curves.

use std::collections::VecDeque;

use gcode::problem::Blame;
use gcode::{Place, Problem};
use machine::Machine;
use protocol::{Code, Item, PathMode, PerAxis, Position};

use crate::in_step::InStep;
use crate::merge::Merger;
use crate::path_mode::PathAsked;
use crate::smooth::{Mark, Smoother};
use crate::zeros::{ZeroNote, Zeros};

/// Holds items until they are asked for.
pub(crate) struct Output {
    /// Where the last call came from.
    place: Place,
    /// What was sent of it last.
    path_mode: PathMode,
    merger: Merger,
    smoother: Smoother,
    in_step: InStep,
    items: VecDeque<Item>,
    problems: Vec<(Place, Problem)>,
    /// Steps of progress that have left.
    steps: u64,
    messages: Vec<MessageNote>,
    zeros: Zeros,
}

/// What a program tells its operator.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MessageNote {
    /// Line of the program.
    pub line: u32,
    /// Steps of progress ([`Item::steps`]) before it.
    pub after: u64,
    /// What it says.
    pub text: String,
}

/// So many messages of a program are told: a loop may hold more of them than anybody reads.
const MOST_MESSAGES: usize = 1000;

impl Output {
    /// Nothing has been said yet; the machine begins in a path mode.
    pub(crate) fn new(machine: &Machine, path_mode: PathMode) -> Output {
        Output {
            place: Place { line: 1, ..Place::default() },
            path_mode,
            merger: Merger::default(),
            smoother: Smoother::new(machine),
            in_step: InStep::default(),
            items: VecDeque::new(),
            problems: Vec::new(),
            steps: 0,
            messages: Vec::new(),
            zeros: Zeros::default(),
        }
    }

    /// What follows comes from here.
    pub(crate) fn comes_from(&mut self, place: Place) {
        self.place = place;
    }

    /// Where the last call came from.
    pub(crate) fn place(&self) -> Place {
        self.place
    }

    /// An item, behind the path mode that it needs; `rest` is where the axes are before it.
    pub(crate) fn push(&mut self, item: Item, rest: PerAxis<Position>, path: &PathAsked) {
        self.zeros.makes();
        self.problems.extend(self.in_step.item(self.place, &item.code));
        let leads = matches!(item.code, Code::Line { .. } | Code::Arc { .. });
        if leads && path.mode != self.path_mode {
            let mode = Item { line: item.line, code: Code::PathMode(path.mode) };
            self.smooth(mode, rest, path.mode);
            self.path_mode = path.mode;
        }
        self.smooth(item, rest, self.path_mode);
    }

    /// An item on its way: short lines become one, and runs of lines curves.
    fn smooth(&mut self, item: Item, rest: PerAxis<Position>, mode: PathMode) {
        let Output { merger, smoother, items, .. } = self;
        merger.add(item, rest, mode, &mut |item, rest| smoother.add(item, rest, mode, items));
        self.place_marks();
    }

    /// Messages and zeros before which it is known now how much there is.
    fn place_marks(&mut self) {
        let Output { smoother, items, messages, zeros, steps, .. } = self;
        for met in smoother.met() {
            let after = *steps + items.range(..met.items).map(Item::steps).sum::<u64>();
            match met.mark {
                Mark::Message(number) => messages[number].after = after,
                Mark::Zero(number) => zeros.lies_behind(number, after),
            }
        }
    }

    /// What waits for more leaves as it is.
    pub(crate) fn settle(&mut self) {
        self.end_line();
        self.smoother.finish(&mut self.items);
        self.place_marks();
    }

    /// No short line becomes one with that before it any more.
    fn end_line(&mut self) {
        let Output { merger, smoother, items, path_mode, .. } = self;
        merger.finish(&mut |item, rest| smoother.add(item, rest, *path_mode, items));
    }

    /// The next item, once it cannot change any more.
    pub(crate) fn next_item(&mut self) -> Option<Item> {
        let item = self.items.pop_front();
        self.steps += item.as_ref().map_or(0, Item::steps);
        item
    }

    /// Tells the operator something, behind all that was said so far.
    pub(crate) fn tell(&mut self, place: Place, text: &str) {
        if self.messages.len() == MOST_MESSAGES {
            let message =
                format!("more than {MOST_MESSAGES} messages: this one and those after it are not shown");
            let help = "let a loop tell only what is new";
            self.report(
                place,
                *Problem::warning("message-not-shown", Blame::Line(place.line), message, help),
            );
            return;
        }
        self.end_line();
        self.smoother.mark(Mark::Message(self.messages.len()));
        let message = MessageNote { line: place.line, after: self.so_far(), text: text.trim().into() };
        self.messages.push(message);
        self.place_marks();
    }

    /// Steps of progress of all that has been made, but what waits to become a curve.
    fn so_far(&self) -> u64 {
        self.steps + self.items.iter().map(Item::steps).sum::<u64>()
    }

    /// From here on zero of the program lies there, with this coordinate system and this tool.
    pub(crate) fn zero_is(&mut self, origin_mm: Option<[f64; 2]>, system: u8, tool: u32) {
        if !self.zeros.holds(origin_mm, system, tool) {
            self.zero_changes(|note| (note.origin_mm, note.system, note.tool) = (origin_mm, system, tool));
        }
    }

    /// From here on parameters of coordinate systems are these.
    pub(crate) fn systems_are(&mut self, set: Vec<(u32, f64)>) {
        self.zero_changes(|note| {
            note.set.retain(|(number, _)| set.iter().all(|(other, _)| other != number));
            note.set.extend(set);
        });
    }

    fn zero_changes(&mut self, change: impl FnOnce(&mut ZeroNote)) {
        if let Some(number) = self.zeros.change(change) {
            self.end_line();
            let after = self.so_far();
            self.smoother.mark(Mark::Zero(number));
            self.zeros.lies_behind(number, after);
            self.place_marks();
        }
    }

    /// A feed or a pass is made where zero of the program lies here.
    pub(crate) fn cuts(&mut self, origin_mm: [f64; 2]) {
        self.zeros.cuts(origin_mm);
    }

    /// Where zero of the program lies, from its beginning on.
    pub(crate) fn zeros(&self) -> &[ZeroNote] {
        self.zeros.notes()
    }

    /// Steps of progress of all that has left.
    pub(crate) fn steps(&self) -> u64 {
        self.steps
    }

    /// What the operator is told.
    pub(crate) fn messages(&self) -> &[MessageNote] {
        &self.messages
    }

    /// Reports a problem of an earlier call, or a warning.
    pub(crate) fn report(&mut self, place: Place, problem: Problem) {
        self.problems.push((place, problem));
    }

    /// How much was reported since [`Output::take_problems`].
    pub(crate) fn told(&self) -> usize {
        self.problems.len()
    }

    /// Forgets what was reported beyond so much.
    pub(crate) fn tell_no_more_than(&mut self, told: usize) {
        self.problems.truncate(told);
    }

    /// What was reported since it was asked last.
    pub(crate) fn take_problems(&mut self) -> Vec<(Place, Problem)> {
        std::mem::take(&mut self.problems)
    }
}
