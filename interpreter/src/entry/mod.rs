//! A program that is begun at a line of its own. In: an interpreter at its beginning, the number of a line.
//! Out: what is in force there and how the tool gets there, then the rest of the machine code; or why the
//! program is not begun there.
//!
//! | rule | why |
//! |---|---|
//! | everything before is read and not executed, by the same interpreter | what is in force follows from the program, not from a guess: parameters, loops and calls included |
//! | what follows is the machine code that the whole program has there | the pass of a thread has the same start, the same index and the same law, so it follows the same helix |
//! | what belongs together is not divided | a chain of threads, a compensated contour and a rounded corner are planned as one |
//! | a lathe is led over nothing but what the program itself has led that tool over (`ways`) | there it is free |
//! | a mill goes up, over the place and down | where a tool has stood all above it is free |
//!
//! Lines that smoothing would have made one curve across the border are two: the second begins at the line.

mod refusal;
mod ways;

use std::collections::VecDeque;

use gcode::{Diagnostic, Waits};
use machine::{Kinematics, Machine};
use protocol::{Code, Item, PerAxis, Position};
use route::{
    approach::{before, over},
    in_force::Modal,
};

use crate::{Interpreter, MessageNote, ZeroNote};
pub use refusal::NoEntry;
use ways::Ways;

/// What is in force where a program begins, and the way there.
#[derive(Clone, Debug)]
pub struct Entry {
    /// The line that was asked for.
    pub line: u32,
    /// The line of the first move from there on, and the number of that move if it is a pass.
    pub moves: u32,
    /// See there.
    pub pass: Option<u32>,
    /// What machine code has left in force.
    pub modal: Modal,
    /// What the program has left in force, as words of a block.
    pub words: String,
    /// Its coordinate system, 1 (G54) to 9, and where its zero lies on the machine.
    pub system: u8,
    /// See there.
    pub zero: PerAxis<Position>,
    /// Parameters and variables that hold something.
    pub variables: Vec<(String, f64)>,
    /// The line is in a loop: this is the first time that the program comes to it.
    pub in_loop: bool,
    /// The moves there, from home.
    pub way: Vec<Item>,
    /// What is executed before the rest of the program: `way` is part of it.
    pub before: Vec<Item>,
}

/// A program from a line on: items as an [`Interpreter`] yields them.
pub struct Begun {
    /// Where it begins, and how.
    pub entry: Entry,
    first: VecDeque<Item>,
    rest: Interpreter,
    /// So many messages stand before the line.
    told: usize,
}

impl Begun {
    /// What the program has told its operator from the line on, counted as its items are.
    pub fn messages(&self) -> Vec<MessageNote> {
        let (read, before) = (self.entry.modal.steps, self.entry.before.iter().map(Item::steps).sum::<u64>());
        let after = |note: &MessageNote| note.after.saturating_sub(read) + before;
        let told = self.rest.messages().iter().skip(self.told);
        told.map(|note| MessageNote { after: after(note), ..note.clone() }).collect()
    }

    /// Where zero of the program lies, counted likewise: what was read before is in force from the beginning.
    pub fn zeros(&self) -> Vec<ZeroNote> {
        let (read, before) = (self.entry.modal.steps, self.entry.before.iter().map(Item::steps).sum::<u64>());
        let after = |after: u64| if after > read { after - read + before } else { 0 };
        let notes = self.rest.zeros().iter();
        notes.map(|note| ZeroNote { after: after(note.after), ..note.clone() }).collect()
    }
}

impl Iterator for Begun {
    type Item = Result<Item, Diagnostic>;

    fn next(&mut self) -> Option<Result<Item, Diagnostic>> {
        self.first.pop_front().map(Ok).or_else(|| self.rest.next())
    }
}

impl Interpreter {
    /// Begins the program at a line.
    ///
    /// # Errors
    /// [`NoEntry`] says why it is not begun there.
    pub fn from_line(mut self, line: u32, machine: &Machine) -> Result<Begun, NoEntry> {
        let mut passed = Passed::new(machine);
        self.read_to(line, &mut passed)?;
        match self.program.waits() {
            Some(Waits::Contour) => return Err(NoEntry::Contour { line }),
            Some(Waits::Corner) => return Err(NoEntry::Corner { line }),
            None => {}
        }
        let (words, system) = (self.words(), self.program.system());
        let (zero, variables) = (self.translator.zero(), self.program.variables());
        let (in_loop, told) = (self.program.is_in_loop(), self.messages().len());
        self.translator.settle();
        self.pass_over(&mut passed)?;
        let first = self.first_move(line, &mut passed)?;
        let moves = first.back().map_or(line, |item| item.line);
        let pass = first
            .back()
            .and_then(|item| if let Code::Pass(pass) = item.code { Some(pass.pass) } else { None });
        for item in &first {
            if let Code::Tool { number } = item.code {
                // It is put in before the way, and not the one before it.
                passed.puts_in(number);
            }
        }
        let way = passed.way(line, machine)?;
        let lifts = machine.general.kinematics == Kinematics::Mill;
        let before = before(&passed.modal, &way, &[], lifts, line);
        let modal = passed.modal;
        let entry = Entry { line, moves, pass, modal, words, system, zero, variables, in_loop, way, before };
        let first = entry.before.iter().copied().chain(first).collect();
        Ok(Begun { entry, first, rest: self, told })
    }

    /// What is in force, but the tool: that in place is told by machine code, however it was put in.
    fn words(&self) -> String {
        let words = self.program.in_force();
        words.split(' ').filter(|word| !word.starts_with('T')).collect::<Vec<_>>().join(" ")
    }

    /// Reads until the line is the next one.
    fn read_to(&mut self, line: u32, passed: &mut Passed) -> Result<(), NoEntry> {
        let (mut caller, mut called_by, mut next) = (0, None, None);
        loop {
            self.pass_over(passed)?;
            if self.ended {
                return Err(match (called_by, next) {
                    (Some(caller), _) => NoEntry::Subprogram { line, caller },
                    (None, Some(next)) => NoEntry::PassedOver { line, next },
                    (None, None) => NoEntry::BehindEnd { line },
                });
            }
            let own = self.program.next_line();
            if own == Some(line) {
                return Ok(());
            }
            next = next.or(own.filter(|own| *own > line));
            self.step();
            match (own, self.program.line_read()) {
                (Some(own), _) => caller = own,
                (None, Some(read)) if read == line => called_by = called_by.or(Some(caller)),
                _ => {}
            }
        }
    }

    /// Takes what has been made so far as done.
    fn pass_over(&mut self, passed: &mut Passed) -> Result<(), NoEntry> {
        while let Some(item) = self.translator.next_item() {
            passed.take(&item);
        }
        self.errors.pop_front().map_or(Ok(()), |error| Err(NoEntry::Wrong(Box::new(error))))
    }

    /// What comes first, up to a move. A G33 that waits for its retract is still one of those before.
    fn first_move(&mut self, line: u32, passed: &mut Passed) -> Result<VecDeque<Item>, NoEntry> {
        let mut waits = self.translator.waits();
        let mut first = VecDeque::new();
        loop {
            while let Some(item) = self.translator.next_item() {
                if waits.is_some() {
                    passed.take(&item);
                    waits = waits.filter(|_| !matches!(item.code, Code::Pass(_)));
                    continue;
                }
                let (moves, ends) = (is_motion(&item), matches!(item.code, Code::End));
                first.push_back(item);
                if moves {
                    return Ok(first);
                }
                if ends {
                    return Err(NoEntry::NothingMoves { line });
                }
            }
            if let Some(error) = self.errors.pop_front() {
                return Err(NoEntry::Wrong(Box::new(error)));
            }
            if self.ended {
                return Err(NoEntry::NothingMoves { line });
            }
            self.step();
            if let (Some((begins, legs)), Some((_, now))) = (waits, self.translator.waits())
                && now > legs
            {
                return Err(NoEntry::Chain { line, begins });
            }
        }
    }
}

fn is_motion(item: &Item) -> bool {
    item.is_move() || matches!(item.code, Code::Pass(_))
}

/// What was read and is not executed.
struct Passed {
    modal: Modal,
    ways: Ways,
    /// The line of a thread in whose groove the tool is left.
    in_groove: Option<u32>,
    /// The line of the last work from formulas: where it ends is not known.
    work: Option<u32>,
}

impl Passed {
    fn new(machine: &Machine) -> Passed {
        Passed { modal: Modal::new(machine), ways: Ways::new(machine), in_groove: None, work: None }
    }

    fn take(&mut self, item: &Item) {
        match item.code {
            Code::Tool { number } => self.puts_in(number),
            Code::Work(_) => self.work = Some(item.line),
            _ => {}
        }
        if is_motion(item) {
            self.in_groove = ends_in_groove(item).then_some(item.line);
            self.ways.take(item, self.modal.at);
        }
        self.modal.take(item);
    }

    fn puts_in(&mut self, number: u32) {
        if self.modal.tool.replace(number) != Some(number) {
            self.ways.puts_in(self.modal.at);
        }
    }

    /// The moves from home to where the line begins.
    fn way(&self, line: u32, machine: &Machine) -> Result<Vec<Item>, NoEntry> {
        if let Some(work) = self.work {
            return Err(NoEntry::Work { line, work });
        }
        if let Some(thread) = self.in_groove {
            return Err(NoEntry::InGroove { line, thread });
        }
        let home = machine.home();
        match machine.general.kinematics {
            Kinematics::Lathe => self.ways.to(self.modal.at, line),
            Kinematics::Mill => Ok(over(&home, self.modal.top, self.modal.at, line)),
            Kinematics::Positioner => Err(NoEntry::Positioner),
        }
    }
}

/// Whether an item is a thread that leaves its tool in the groove.
fn ends_in_groove(item: &Item) -> bool {
    let Code::Pass(pass) = item.code else { return false };
    let across = pass.out.axis as usize;
    let out = if pass.out.clear >= pass.out.free { 1.0 } else { -1.0 };
    !pass.returns() && out * pass.out.clear.mm_from(pass.axes[across].end) > 1e-6
}
