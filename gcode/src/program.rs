//! A program that runs: lines become blocks, blocks become calls.
//!
//! In: a text and [`Options`]. Out: calls to a [`Sink`], and [`Diagnostic`]s with the place of what is wrong. One
//! [`Program::step`] is one line:
//!
//! ```text
//! source ─ line ─► words ─ block ─► execute ─ calls ─► sink
//!    ▲                │ O words, M98, M99
//!    └───── flow ◄────┘
//! ```

use std::io::{self, Read};
use std::path::{Path, PathBuf};

use crate::block::Block;
use crate::canon::{Plane, Position, Sink, Units};
use crate::execute::compensation::Waiting;
use crate::execute::{self, Output};
use crate::files::ToolTable;
use crate::problem::{Blame, Diagnostic, Problem, Span};
use crate::source::Source;
use crate::state::State;
use crate::words::{Cursor, Reader, head};

/// Which language a program is written in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dialect {
    /// RS274/NGC as LinuxCNC speaks it.
    Linuxcnc,
    /// FANUC lathe programs.
    Fanuc,
}

/// Where a program ends that would not end by itself. Messages name the limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Lines in a row without a move: a loop that does nothing else is taken for endless.
    pub blocks_without_motion: u64,
    /// Subroutine calls inside each other.
    pub call_depth: u32,
    /// Brackets, signs and `#` inside each other.
    pub expression_depth: u32,
    /// Bytes of a line.
    pub line_length: usize,
    /// Bytes of all subroutine files.
    pub subroutine_bytes: u64,
}

impl Default for Limits {
    fn default() -> Limits {
        Limits {
            blocks_without_motion: 100_000_000,
            call_depth: 100,
            expression_depth: 64,
            line_length: 4096,
            subroutine_bytes: 16 << 20,
        }
    }
}

/// What a program is run with.
#[derive(Clone, Debug)]
pub struct Options {
    /// Language.
    pub dialect: Dialect,
    /// Units of the machine: tool table, parameters.
    pub machine_units: Units,
    /// Units in force at the start.
    pub units: Units,
    /// Plane at the start.
    pub plane: Plane,
    /// G7 at the start.
    pub diameter: bool,
    /// Programmed point at the start, in the units in force.
    pub position: Position,
    /// Lines that begin with `/` are left out.
    pub block_delete: bool,
    /// Tools.
    pub tools: ToolTable,
    /// Numbered parameters that are set at the start.
    pub parameters: Vec<(u32, f64)>,
    /// G73 and G83 go back by this much between pecks, machine units.
    pub peck_clearance: f64,
    /// G20 and G21 leave F and the offset of the tool as numbers: LinuxCNC's stand-alone interpreter does so, its
    /// controller converts them.
    pub keep_numbers: bool,
    /// Where subroutine files are looked for, behind the folder of the program.
    pub subroutine_folders: Vec<PathBuf>,
    /// Limits.
    pub limits: Limits,
}

impl Default for Options {
    /// The start of LinuxCNC's `rs274` with a millimetre machine.
    fn default() -> Options {
        Options {
            dialect: Dialect::Linuxcnc,
            machine_units: Units::Millimetre,
            units: Units::Millimetre,
            plane: Plane::Xy,
            diameter: false,
            position: [0.0; 6],
            block_delete: false,
            tools: ToolTable::default(),
            parameters: Vec::new(),
            peck_clearance: 0.254,
            keep_numbers: false,
            subroutine_folders: Vec::new(),
            limits: Limits::default(),
        }
    }
}

/// Whether there is more to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// Another line may follow.
    More,
    /// The program is over.
    Ended,
}

/// A program that is being run.
pub struct Program {
    source: Source,
    reader: Reader,
    block: Block,
    state: State,
    block_delete: bool,
    started: bool,
    ended: bool,
    problems: Vec<Problem>,
    waiting: Waiting,
    warnings: Vec<Diagnostic>,
}

impl Program {
    /// Opens a file.
    ///
    /// # Errors
    /// It cannot be opened or read.
    pub fn open(path: &Path, options: &Options) -> io::Result<Program> {
        Ok(Program::new(Source::open(path, options.limits.line_length)?, options))
    }

    /// Takes a text. `name` is shown in diagnostics.
    pub fn from_text(name: &str, text: impl Into<String>, options: &Options) -> Program {
        Program::new(Source::from_text(name, text.into().into_bytes(), options.limits.line_length), options)
    }

    /// Takes what a reader gives until its end, such as standard input.
    ///
    /// # Errors
    /// It cannot be read, or not be spooled to a temporary file.
    pub fn from_reader(name: &str, reader: impl Read, options: &Options) -> io::Result<Program> {
        Ok(Program::new(Source::from_reader(name, reader, options.limits.line_length)?, options))
    }

    fn new(source: Source, options: &Options) -> Program {
        Program {
            source,
            reader: Reader::new(options.limits.expression_depth),
            block: Block::default(),
            state: State::new(options),
            block_delete: options.block_delete,
            started: false,
            ended: false,
            problems: Vec::new(),
            waiting: Waiting::default(),
            warnings: Vec::new(),
        }
    }

    /// Executes the next line. After an error it can be called again and goes on behind the faulty line.
    ///
    /// # Errors
    /// What is wrong with the line, or what the sink refuses.
    pub fn step(&mut self, sink: &mut dyn Sink) -> Result<Step, Box<Diagnostic>> {
        if self.ended {
            return Ok(Step::Ended);
        }
        let done = self.line(sink);
        for problem in std::mem::take(&mut self.problems) {
            let diagnostic = self.diagnostic(problem);
            self.warnings.push(diagnostic);
        }
        done.map_err(|problem| Box::new(self.diagnostic(*problem)))
    }

    fn line(&mut self, sink: &mut dyn Sink) -> Result<Step, Box<Problem>> {
        if !self.started {
            self.started = true;
            let mut out = Output::new(sink, self.block.place(), &mut self.problems, &mut self.waiting);
            execute::start(&self.state, &mut out)?;
        }
        let Some(line) = self.source.take()? else {
            self.ended = true;
            let mut out = Output::new(sink, self.block.place(), &mut self.problems, &mut self.waiting);
            execute::finish(&mut self.state, &mut out)?;
            return Ok(Step::Ended);
        };
        self.block.clear(0, line.number());
        let mut cursor = Cursor::new(self.source.bytes(&line));
        if !head(&mut cursor, self.block_delete, &mut self.block)? {
            return Ok(Step::More);
        }
        self.reader.words(&mut cursor, &mut self.state, &mut self.block)?;
        let mut out = Output::new(sink, self.block.place(), &mut self.problems, &mut self.waiting);
        execute::execute(&self.block, &mut self.state, &mut out)?;
        self.ended = self.state.ended;
        Ok(if self.ended { Step::Ended } else { Step::More })
    }

    fn diagnostic(&mut self, problem: Problem) -> Diagnostic {
        let line = match problem.blame {
            Blame::Line(line) => line,
            _ => self.block.line,
        };
        let text = self.source.text(line);
        let whole = Span { start: 0, end: text.len() as u32 };
        let span = self.block.span(problem.blame).unwrap_or(whole);
        Diagnostic::new(problem, self.source.name(), line, &text, span)
    }

    /// The warnings since the last call.
    pub fn take_warnings(&mut self) -> Vec<Diagnostic> {
        std::mem::take(&mut self.warnings)
    }

    /// The state after the last step.
    pub fn state(&self) -> &State {
        &self.state
    }
}
