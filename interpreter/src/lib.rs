//! Canonical machining functions to machine code: the interpreter of pitchlock.
//!
//! In: a part program, read by [`gcode`], and a machine file. Out: [`protocol::Item`]s, pulled one at a time,
//! in mm with X of a lathe a radius; and [`Diagnostic`]s, several for one program, each with its place and a
//! remedy. What the machine cannot do is refused by name; nothing is ignored in silence.
//!
//! ```
//! use interpreter::Interpreter;
//! use machine::Machine;
//! use protocol::Code;
//!
//! let program = "G21 G90 G94\nG0 X12 Z2\nG1 Z-20 F120\nM2\n";
//! let items: Result<Vec<_>, _> = Interpreter::of_text("part.ngc", program, &Machine::default()).collect();
//! let items = items.expect("the program is right");
//! assert!(matches!(items[1].code, Code::Line { .. }) && items[1].line == 3);
//! assert_eq!(items[2].code, Code::End);
//! ```
//!
//! | module | from | to |
//! |---|---|---|
//! | [`gcode`] | the text of a program | calls of canonical functions |
//! | `translate` | calls | items: it takes each call to whoever knows, and sends what comes of it |
//! | `modal`, `frame`, `path_mode` | calls that stay in force | positions of the machine, feeds, path modes |
//! | `points` | targets | where the program is, and where the axes rest |
//! | `arc`, `spindle`, `auxiliary`, `threading` | a call, what is in force | codes |
//! | `job` | the text of a job | moves, formulas, a trace |
//! | `reach` | a machine | what it does not have, by name |
//! | `stock`, `block` | moves, the part of a lathe, of a mill | what is left of it, and warnings |
//! | `by_hand` | blocks given one by one, with where the axes rest | the items of each |
//! | `entry` | a program, a line of it | what is in force there, the way there, the rest of its items |
//! | `output`, `merge` | codes | items in order, lines fewer where they lie near one line |
//! | `tapping` | a tap | the pass that it is, proved feasible |
//! | [`thread`] | G33, G76 | passes: laws by spindle angle, proved feasible |
//! | [`formula`] | the text of a formula | a formula of machine code |
//! | `check` | a program | every diagnostic, every pass, the time it takes |
#![forbid(unsafe_code)]

mod arc;
mod auxiliary;
mod block;
mod by_hand;
mod check;
mod entry;
pub mod formula;
mod frame;
mod in_step;
mod job;
mod merge;
mod modal;
mod options;
mod output;
mod pass_note;
mod path_mode;
mod points;
mod reach;
mod retract;
mod smooth;
mod spindle;
mod stock;
mod tapping;
pub mod thread;
mod threading;
mod time;
mod translate;
mod zeros;

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use gauge::{Drawn, Nominal};
use gcode::problem::Blame;
use gcode::{Place, Problem, Program, Step};
use machine::{Machine, Part};
use protocol::Item;
use route::Unworkable;

pub use by_hand::{ByHand, Needs};
use check::diameters_mm;
pub use check::{Check, check, check_interpreter, check_job, check_program, check_while, time_s, with_times};
pub use entry::{Begun, Entry, NoEntry};
pub use gcode::{Diagnostic, Dialect, Guess, Outlasting, Severity};
pub use job::JobNote;
pub use options::{
    Language, OpenError, check_folders, dialect, dialect_of_text, is_job, no_other, open, open_text,
    part_beside, reference_points,
};
pub use output::MessageNote;
pub use pass_note::PassNote;
pub use tapping::TapNote;
pub use thread::{BluntNote, CornerNote};
pub use translate::GaugedThread;
use translate::Translator;
pub use zeros::ZeroNote;

/// Reads a part program and yields machine code, one item at a time.
///
/// After an error it goes on with the next line, so that a reader can collect several; from the first error
/// on the items only serve to find more of them, and must not be run. The last item is
/// [`protocol::Code::End`].
pub struct Interpreter {
    program: Program,
    translator: Translator,
    /// Found behind the items that wait in the translator.
    errors: VecDeque<Diagnostic>,
    warnings: Vec<Diagnostic>,
    /// What the translator has found, and where.
    reported: BTreeSet<(u16, u32, &'static str)>,
    /// The translator has found an error.
    failed: bool,
    ended: bool,
    /// What is wrong with the block in hand, behind what the translator found.
    late: Option<Diagnostic>,
    /// Its texts come one by one, and none of them is the last.
    by_hand: bool,
    /// Parameters of coordinate systems behind the last block.
    systems: Vec<f64>,
}

impl Interpreter {
    /// An interpreter at the beginning of a program. `machine` has been checked.
    pub fn new(program: Program, machine: &Machine) -> Interpreter {
        Interpreter {
            translator: Translator::new(machine, diameters_mm(&program)),
            systems: program.systems().to_vec(),
            program,
            errors: VecDeque::new(),
            warnings: Vec::new(),
            reported: BTreeSet::new(),
            failed: false,
            ended: false,
            late: None,
            by_hand: false,
        }
    }

    /// The same of a program whose part is known.
    #[must_use]
    pub fn with_part(mut self, part: Option<Part>) -> Interpreter {
        part.into_iter().for_each(|part| self.translator.has_part(part));
        self
    }

    /// The same of a program that a gauge shall judge, whatever the program says of its thread.
    #[must_use]
    pub fn with_gauge(mut self, asked: Option<Nominal>) -> Interpreter {
        asked.into_iter().for_each(|nominal| self.translator.has_gauge(nominal));
        self
    }

    /// An interpreter of a text, in the dialect and with the tools of the machine file.
    pub fn of_text(name: &str, text: impl Into<Vec<u8>>, machine: &Machine) -> Interpreter {
        Interpreter::new(Program::from_text(name, text, &options::options(machine)), machine)
    }

    /// Warnings so far, in the order they were found.
    pub fn warnings(&self) -> &[Diagnostic] {
        &self.warnings
    }

    /// The passes of threads so far.
    pub fn passes(&self) -> &[PassNote] {
        self.translator.passes()
    }

    /// The jobs so far.
    pub fn jobs(&self) -> &[JobNote] {
        self.translator.jobs()
    }

    /// The part, if a comment or a file beside the program said what it is. X and Y of a block are those of
    /// the machine once it is cut.
    pub fn part(&self) -> Option<&Part> {
        self.translator.part()
    }

    /// X and Z of the machine at which zero of the program lies where a tool first cuts, by tool, mm.
    pub(crate) fn origins_mm(&self) -> &BTreeMap<u32, [f64; 2]> {
        self.translator.origins_mm()
    }

    /// Where zero of the program lies, from its beginning on.
    pub fn zeros(&self) -> &[ZeroNote] {
        self.translator.zeros()
    }

    /// What the program tells its operator.
    pub fn messages(&self) -> &[MessageNote] {
        self.translator.messages()
    }

    /// The threads that somebody named, so that gauges judge them.
    pub fn gauges(&self) -> Vec<GaugedThread> {
        self.translator.gauged().threads()
    }

    /// The groove that the program draws, if it draws one.
    pub fn groove(&self) -> Option<&Drawn> {
        self.translator.gauged().drawn()
    }

    /// The program, for its parameters and tools at the end.
    pub fn program(&self) -> &Program {
        &self.program
    }

    /// What to say of a program that moves for ever, at the line it has come to.
    pub(crate) fn endless(&mut self) -> Diagnostic {
        let place = self.translator.place();
        let message = "up to here the program takes more than thirty days: does a loop not end?";
        let help = "let the loop count, or end it with a condition that comes true";
        self.program.diagnose(place, *Problem::error("endless-program", Blame::Block, message, help))
    }

    /// What to say of gauges that are asked for where no such thread was cut.
    pub(crate) fn ungauged(&mut self) -> Vec<Diagnostic> {
        let missing = self.translator.gauged().misses(self.translator.place());
        missing.into_iter().map(|(place, problem)| self.program.diagnose(place, *problem)).collect()
    }

    /// What to say of a trace that cannot be followed to its end.
    pub(crate) fn untraceable(&mut self, line: u32, reason: &Unworkable) -> Diagnostic {
        let place = Place { line, ..self.translator.place() };
        let help = "change the formula or the domain, or where the work lies on the machine";
        self.program.diagnose(place, *Problem::error("job", Blame::Block, reason.to_string(), help))
    }

    /// One block of the program.
    fn step(&mut self) {
        self.translator.writes_x(self.program.x_is_diameter());
        // What begins where a refused move did not end has no error of its own.
        let astray = self.failed && self.translator.is_astray();
        let result = self.program.step(&mut self.translator);
        if matches!(result, Ok(Step::Ended)) {
            if !self.by_hand {
                self.translator.finish();
            }
            self.ended = true;
        }
        self.systems_change();
        self.translator.end_of_block();
        if let Err(error) = result {
            self.late = Some(*error);
        }
        self.find(astray);
    }

    /// The block may have set parameters of coordinate systems.
    fn systems_change(&mut self) {
        let now = self.program.systems();
        if self.systems != now {
            let set =
                (Program::FIRST_OF_SYSTEMS..).zip(now.iter().copied().zip(self.systems.iter().copied()));
            let set = set.filter(|(_, (now, before))| now != before).map(|(number, (now, _))| (number, now));
            self.translator.systems_are(set.collect());
            self.systems.copy_from_slice(now);
        }
    }

    /// Takes up what was found; `astray`: the block begins where a refused move did not end.
    fn find(&mut self, astray: bool) {
        for (place, problem) in self.translator.take_problems() {
            // A line that is run again and again is blamed once.
            let new = self.reported.insert((place.file, place.line, problem.code));
            let follows = astray && problem.code == "travel-limit" && problem.blame == Blame::Block;
            if !new || follows {
                continue;
            }
            self.failed |= problem.severity == Severity::Error;
            let diagnostic = self.program.diagnose(place, problem);
            match diagnostic.severity {
                Severity::Warning => self.warnings.push(diagnostic),
                Severity::Error => self.errors.push_back(diagnostic),
            }
        }
        self.warnings.extend(self.program.take_warnings());
        if let Some(error) = self.late.take() {
            // A line has one error: what the machine lacks goes before what may stand there for want of it.
            let of_line = |other: &Diagnostic| (&other.file, other.line) == (&error.file, error.line);
            let lacks = matches!(error.code, "unused-word" | "no-spindle-speed");
            if !lacks {
                self.errors.retain(|other| !of_line(other));
            }
            if !(astray && error.code == "arc-radius" || self.errors.iter().any(of_line)) {
                self.errors.push_back(error);
            }
        }
    }
}

impl Iterator for Interpreter {
    type Item = Result<Item, Diagnostic>;

    fn next(&mut self) -> Option<Result<Item, Diagnostic>> {
        loop {
            if let Some(item) = self.translator.next_item() {
                return Some(Ok(item));
            }
            if let Some(error) = self.errors.pop_front() {
                return Some(Err(error));
            }
            if self.ended {
                return None;
            }
            self.step();
        }
    }
}
