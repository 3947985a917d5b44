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

use std::collections::BTreeSet;
use std::io::{self, Read};
use std::path::Path;
use std::sync::Arc;

use crate::block::Block;
use crate::canon::{Place, Sink};
use crate::codes::{M, m_group};
use crate::execute::compensation::Waiting;
use crate::execute::{self, Done, Output, roughing};
use crate::fanuc;
use crate::flow::{Files, Flow, Order};
use crate::job::{self, Job};
use crate::options::{Dialect, Options};
use crate::problem::{Blame, Diagnostic, Problem, Span};
use crate::source::Source;
use crate::state::State;
use crate::watch::Watch;
use crate::words::{Cursor, Reader, head};

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
    flow: Flow,
    /// The other dialect has a flow and blocks of its own.
    fanuc: Option<Box<fanuc::Control>>,
    reader: Reader,
    block: Block,
    state: State,
    options: RunOptions,
    stage: Stage,
    /// Lines since the last move.
    idle: u64,
    problems: Vec<Problem>,
    waiting: Waiting,
    warnings: Vec<Diagnostic>,
    /// File and line of every error so far: each line is reported once.
    reported: BTreeSet<(u16, u32)>,
    /// The same of warnings.
    warned: BTreeSet<(u16, u32, &'static str)>,
}

/// What of the [`Options`] is needed again and again.
#[derive(Clone, Copy)]
struct RunOptions {
    block_delete: bool,
    longest_idle: u64,
    /// The file is a job.
    is_job: bool,
}

/// What a line holds; words are in the block.
enum Content {
    Words,
    /// An O word, or what is wrong with it.
    Control(Result<Order, Box<Problem>>),
    Job(Job),
    /// It is left out.
    Nothing,
    End,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Stage {
    Fresh,
    Running,
    Ended,
}

impl Program {
    /// Opens a file.
    ///
    /// # Errors
    /// It cannot be opened or read.
    pub fn open(path: &Path, options: &Options) -> io::Result<Program> {
        if path.is_dir() {
            return Err(io::Error::from(io::ErrorKind::IsADirectory));
        }
        let source = Source::open(path, options.limits.line_length)?;
        Ok(Program::new(source, path.parent(), options))
    }

    /// What was opened is a job file.
    pub(crate) fn into_job(mut self) -> Program {
        self.options.is_job = true;
        self
    }

    /// Takes a text, UTF-8 or not. `name` is shown in diagnostics.
    pub fn from_text(name: &str, text: impl Into<Vec<u8>>, options: &Options) -> Program {
        Program::new(Source::from_text(name, text.into(), options.limits.line_length), None, options)
    }

    /// Takes what a reader gives until its end, such as standard input.
    ///
    /// # Errors
    /// It cannot be read, or not be spooled to a temporary file.
    pub fn from_reader(name: &str, reader: impl Read, options: &Options) -> io::Result<Program> {
        Ok(Program::new(Source::from_reader(name, reader, options.limits.line_length)?, None, options))
    }

    fn new(source: Source, folder: Option<&Path>, options: &Options) -> Program {
        let limits = options.limits;
        let folders =
            folder.map(Path::to_owned).into_iter().chain(options.subroutine_folders.iter().cloned());
        let files = Files::new(source, folders.collect(), limits.subroutine_bytes, limits.line_length);
        let mut state = State::new(options);
        state.memory.set_named("_value", 0.0);
        state.memory.set_named("_value_returned", 0.0);
        Program {
            flow: Flow::new(files, options.block_delete, limits.call_depth),
            fanuc: (options.dialect == Dialect::Fanuc).then(|| Box::new(fanuc::Control::new(options))),
            reader: Reader::new(limits.expression_depth),
            block: Block::default(),
            state,
            options: RunOptions {
                block_delete: options.block_delete,
                longest_idle: limits.blocks_without_motion,
                is_job: false,
            },
            stage: Stage::Fresh,
            idle: 0,
            problems: Vec::new(),
            waiting: Waiting::default(),
            warnings: Vec::new(),
            reported: BTreeSet::new(),
            warned: BTreeSet::new(),
        }
    }

    /// Executes the next line. After an error it can be called again and goes on behind the faulty line, so that
    /// other errors are found; from then on nothing is repeated, and no line is reported twice.
    ///
    /// # Errors
    /// What is wrong with the line, or what the sink refuses.
    pub fn step(&mut self, sink: &mut dyn Sink) -> Result<Step, Box<Diagnostic>> {
        let mut watch = Watch::new(sink);
        let done = self.line(&mut watch);
        self.idle = if watch.moved { 0 } else { self.idle + 1 };
        if !self.problems.is_empty() || !self.reader.warnings.is_empty() {
            self.keep_warnings();
        }
        match done {
            Ok(()) if self.stage == Stage::Ended => Ok(Step::Ended),
            Ok(()) => Ok(Step::More),
            Err(problem) => self.report(*problem, watch.refused),
        }
    }

    fn line(&mut self, sink: &mut Watch) -> Done {
        match self.stage {
            Stage::Ended => return Ok(()),
            Stage::Fresh => {
                self.stage = Stage::Running;
                let mut out = Output::new(sink, self.block.place(), &mut self.problems, &mut self.waiting);
                execute::start(&self.state, &mut out)?;
            }
            Stage::Running => {}
        }
        if self.idle >= self.options.longest_idle {
            return Err(self.endless());
        }
        if self.fanuc.is_some() {
            return self.fanuc_line(sink);
        }
        if self.options.is_job {
            self.stage = Stage::Ended;
            let read = job::read_file(&mut self.flow.files);
            let job = read.inspect_err(|_| self.block.clear(0, self.flow.files.mark().lines))?;
            return self.job(&job, sink);
        }
        match self.read()? {
            Content::Words => self.execute(sink),
            Content::Control(order) => self.control(order, sink),
            Content::Job(job) => self.job(&job, sink),
            Content::Nothing => Ok(()),
            Content::End => self.end_of_file(sink),
        }
    }

    /// Reads the next line.
    fn read(&mut self) -> Result<Content, Box<Problem>> {
        let repeating = self.flow.is_repeating();
        if repeating
            && let Some(known) = self.flow.read_again(&mut self.reader, &mut self.state, &mut self.block)
        {
            return Ok(known?.map_or(Content::Words, |order| Content::Control(Ok(order))));
        }
        let file = self.flow.files.current() as u16;
        let line = match self.flow.files.take() {
            Ok(Some(line)) => line,
            Ok(None) => return Ok(Content::End),
            Err(problem) => {
                self.block.clear(file, self.flow.files.mark().lines);
                return Err(problem);
            }
        };
        self.block.clear(file, line.number());
        self.state.line = line.number();
        if job::begins(self.flow.files.bytes(&line)) {
            return job::read(&mut self.flow.files, &line).map(Content::Job);
        }
        let mut cursor = Cursor::new(self.flow.files.bytes(&line));
        let head = head(&mut cursor)?;
        if head.optional && self.options.block_delete {
            return Ok(Content::Nothing);
        }
        self.block.begin(file, line.number(), head.number);
        self.reader.notes.begin(repeating);
        if cursor.peek() == Some(b'o') {
            return Ok(Content::Control(self.flow.read(&line, &mut self.reader, &self.state)));
        }
        self.reader.words(&mut cursor, &mut self.state, &mut self.block)?;
        self.flow.remember_words(&line, head, &mut self.reader);
        Ok(Content::Words)
    }

    /// Executes an O word.
    fn control(&mut self, order: Result<Order, Box<Problem>>, sink: &mut Watch) -> Done {
        let mut out = Output::new(sink, self.block.place(), &mut self.problems, &mut self.waiting);
        let done =
            order.and_then(|order| self.flow.control(&order, &mut self.reader, &mut self.state, &mut out));
        match self.state.recorder.is_on() {
            true => roughing::end(done, &mut self.state, &mut out),
            false => done,
        }
    }

    /// Executes the block.
    fn execute(&mut self, sink: &mut Watch) -> Done {
        let mut out = Output::new(sink, self.block.place(), &mut self.problems, &mut self.waiting);
        execute::execute(&self.block, &mut self.state, &mut out)?;
        if self.state.ended {
            self.stage = Stage::Ended;
            return self.flow.check_ends_exist(&mut self.reader, &self.state);
        }
        if let Some(number) = self.state.recorder.take_call() {
            let called = self.flow.call_number(number, &mut self.reader, &mut self.state);
            return called.inspect_err(|_| self.state.recorder.cancel());
        }
        match self.block.m(m_group::CALL) {
            None => Ok(()),
            Some(M(98)) => self.flow.m98(&self.block, &mut self.reader, &mut self.state),
            Some(_) => self.flow.m99(&mut self.state, &mut out),
        }
    }

    fn fanuc_line(&mut self, sink: &mut Watch) -> Done {
        let Some(fanuc) = &mut self.fanuc else { return Ok(()) };
        let done = fanuc.next(&mut fanuc::Machine {
            files: &mut self.flow.files,
            state: &mut self.state,
            sink,
            problems: &mut self.problems,
            waiting: &mut self.waiting,
        });
        std::mem::swap(&mut self.block, fanuc.block_mut());
        if self.state.ended {
            self.stage = Stage::Ended;
        }
        done.inspect_err(|_| fanuc.only_look())
    }

    fn job(&mut self, job: &Job, sink: &mut Watch) -> Done {
        let place = Place { line: job.line, ..self.block.place() };
        let mut out = Output::new(sink, place, &mut self.problems, &mut self.waiting);
        job::execute(job, &mut self.state, &mut out)
    }

    fn end_of_file(&mut self, sink: &mut Watch) -> Done {
        let mut out = Output::new(sink, self.block.place(), &mut self.problems, &mut self.waiting);
        let mut ended = self.flow.end(&mut self.state, &mut out);
        if self.state.recorder.is_on() {
            ended = roughing::end(ended, &mut self.state, &mut out);
        }
        if self.state.ended {
            self.stage = Stage::Ended;
        }
        ended?;
        execute::finish(&mut self.state, &mut out)
    }

    fn endless(&mut self) -> Box<Problem> {
        self.stage = Stage::Ended;
        let message = format!(
            "{} lines without a move: the limit blocks_without_motion, which ends endless loops",
            self.options.longest_idle
        );
        Problem::error(
            "endless-loop",
            Blame::Block,
            message,
            "check the condition of the loop that this line is in",
        )
    }

    /// Makes a diagnostic of an error, if there is none for its line yet.
    fn report(&mut self, problem: Problem, refused: Option<Place>) -> Result<Step, Box<Diagnostic>> {
        self.flow.repeats = false;
        let (file, diagnostic) = self.diagnostic(problem, refused);
        if self.state.stand_alone {
            self.flow.end_calls(&mut self.state);
        }
        if self.reported.insert((file, diagnostic.line)) {
            return Err(Box::new(diagnostic));
        }
        Ok(if self.stage == Stage::Ended { Step::Ended } else { Step::More })
    }

    fn keep_warnings(&mut self) {
        let mut problems = std::mem::take(&mut self.reader.warnings);
        problems.append(&mut self.problems);
        for problem in problems {
            let (file, diagnostic) = self.diagnostic(problem, None);
            if self.warned.insert((file, diagnostic.line, diagnostic.code)) {
                self.warnings.push(diagnostic);
            }
        }
    }

    /// Puts a problem at its place, and tells the number of the file. `refused`: the call that the sink refused, which
    /// may be of an earlier line.
    fn diagnostic(&mut self, problem: Problem, refused: Option<Place>) -> (u16, Diagnostic) {
        let block = self.block.place();
        let earlier = refused.filter(|place| (place.file, place.line) != (block.file, block.line));
        let (file, line) = match (problem.blame, earlier) {
            (Blame::Part(place, _), _) => (place.file, place.line),
            (Blame::Line(line), place) => (place.map_or(block.file, |place| place.file), line),
            (_, Some(place)) | (Blame::At(place), _) => (place.file, place.line),
            _ => (block.file, block.line),
        };
        let source = self.flow.files.get_mut(usize::from(file));
        let (name, text) = match source {
            Some(source) => (Arc::clone(source.name()), source.text(line)),
            None => ("".into(), String::new()),
        };
        let whole = Span { start: 0, end: text.len() as u32 };
        let span = match problem.blame {
            Blame::Part(_, span) => Some(span),
            _ if earlier.is_some() => None,
            blame => self.block.span(blame),
        };
        (file, Diagnostic::new(problem, &name, line, &text, span.unwrap_or(whole)))
    }

    /// Puts what the receiver of the calls finds wrong, later than at the call, at the place the call came from.
    pub fn diagnose(&mut self, place: Place, problem: Problem) -> Diagnostic {
        self.diagnostic(problem, Some(place)).1
    }

    /// The warnings since the last call; each line warns once.
    pub fn take_warnings(&mut self) -> Vec<Diagnostic> {
        std::mem::take(&mut self.warnings)
    }

    /// Name of a file, see [`Place::file`].
    pub fn file_name(&self, file: u16) -> Option<&Arc<str>> {
        self.flow.files.get(usize::from(file)).map(Source::name)
    }

    /// The value of a parameter, offsets in machine units. `None`: a common variable of FANUC, #100 to #199 or #500 to
    /// #999, that is vacant.
    pub fn parameter(&self, number: u32) -> Option<f64> {
        let common = self.fanuc.as_ref().and_then(|fanuc| fanuc.shared(number));
        common.unwrap_or_else(|| Some(self.state.parameter(number)))
    }

    /// Whether the `%` that ends the program was met, if only on the search for a subroutine.
    pub fn is_read_to_end(&self) -> bool {
        self.flow.files.get(0).is_some_and(Source::is_closed)
    }

    /// The state after the last step.
    pub fn state(&self) -> &State {
        &self.state
    }
}
