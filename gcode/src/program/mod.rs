//! A program that runs: lines become blocks, blocks become calls.
//!
//! In: a text and [`Options`]. Out: calls to a [`Sink`], and [`Diagnostic`]s with the place of what is wrong.
//! One [`Program::step`] is one line:
//!
//! ```text
//! text ─ line ─► reader of the dialect ─ block ─► execute ─ calls ─► sink
//! ```

mod by_hand;
mod findings;
mod forward;
mod outlasting;
mod reader;
mod startup;
mod watch;

use std::io::{self, Read};
use std::path::Path;
use std::sync::Arc;

use crate::canon::{Place, Sink};
use crate::execute::compensation::Waiting;
use crate::execute::{self, Done, Output};
use crate::files::ToolTable;
use crate::options::{Dialect, Options};
use crate::problem::{Blame, Diagnostic, Problem};
use crate::state::State;
use crate::text::{Files, Source, job};
use findings::{Findings, diagnostic};
pub use forward::Waits;
pub use outlasting::Outlasting;
use outlasting::Start;
use reader::Reader;
use startup::Startup;
use watch::{Stay, Watch};

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
    reader: Reader,
    state: State,
    start: Start,
    startup: Option<Startup>,
    stage: Stage,
    /// How long it has led nowhere, and how many lines may do so.
    stay: Stay,
    longest_stay: u64,
    /// Moves of a compensated contour that wait for the next one.
    waiting: Waiting,
    /// Warnings of the line that is being executed.
    problems: Vec<Problem>,
    findings: Findings,
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
        let files = open(path, options)?;
        Ok(Program::new(Reader::new(files, options), options))
    }

    /// Takes a text, UTF-8 or not. `name` is shown in diagnostics.
    pub fn from_text(name: &str, text: impl Into<Vec<u8>>, options: &Options) -> Program {
        let source = Source::from_text(name, text.into(), options.limits.line_length);
        Program::new(Reader::new(files(source, None, options), options), options)
    }

    /// Takes what a reader gives until its end, such as standard input.
    ///
    /// # Errors
    /// It cannot be read, or not be spooled to a temporary file.
    pub fn from_reader(name: &str, reader: impl Read, options: &Options) -> io::Result<Program> {
        let source = Source::from_reader(name, reader, options.limits.line_length)?;
        Ok(Program::new(Reader::new(files(source, None, options), options), options))
    }

    /// Opens a file that is a [`Job`](crate::Job).
    ///
    /// # Errors
    /// It cannot be opened or read.
    pub fn open_job(path: &Path, options: &Options) -> io::Result<Program> {
        let options = of_job(options);
        let files = open(path, &options)?;
        Ok(Program::new(Reader::of_job(files), &options))
    }

    /// Takes a text that is a [`Job`](crate::Job).
    pub fn from_job(name: &str, text: impl Into<Vec<u8>>, options: &Options) -> Program {
        let options = of_job(options);
        let source = Source::from_text(name, text.into(), options.limits.line_length);
        Program::new(Reader::of_job(files(source, None, &options)), &options)
    }

    fn new(reader: Reader, options: &Options) -> Program {
        let mut state = State::new(options);
        Program {
            start: Start::new(options, &reader, &state),
            startup: Startup::read(options, &mut state),
            reader,
            state,
            stage: Stage::Fresh,
            stay: Stay::default(),
            longest_stay: options.limits.blocks_without_motion,
            waiting: Waiting::default(),
            problems: Vec::new(),
            findings: Findings::default(),
        }
    }

    /// Executes the next line. After an error it can be called again and goes on after the faulty line, so
    /// that other errors are found; from then on nothing is repeated, and no line is reported twice.
    ///
    /// # Errors
    /// What is wrong with the line, or what the sink refuses.
    pub fn step(&mut self, sink: &mut dyn Sink) -> Result<Step, Box<Diagnostic>> {
        let mut watch = Watch::new(sink, std::mem::take(&mut self.stay));
        let done = self.line(&mut watch);
        let Watch { mut stay, refused, .. } = watch;
        stay.line(self.reader.block().place());
        self.stay = stay;
        if !self.problems.is_empty() {
            self.findings.keep_warnings(&mut self.problems, &mut self.reader);
        }
        if let Err(problem) = done {
            self.reader.only_look(&mut self.state);
            for call in self.state.assume(problem.code) {
                sink.assumes(self.reader.block().place(), call);
            }
            if let Some(diagnostic) = self.findings.error(*problem, refused, &mut self.reader) {
                return Err(Box::new(diagnostic));
            }
        }
        Ok(if self.stage == Stage::Ended { Step::Ended } else { Step::More })
    }

    fn line(&mut self, sink: &mut Watch) -> Done {
        if self.stage == Stage::Ended {
            return Ok(());
        }
        if sink.stay.lines >= self.longest_stay {
            self.stage = Stage::Ended;
            return Err(endless(&sink.stay));
        }
        let place = self.reader.block().place();
        let mut out = Output::new(sink, place, &mut self.problems, &mut self.waiting);
        if self.stage == Stage::Fresh {
            self.stage = Stage::Running;
            if let Some(last) = self.reader.files().get(0).and_then(Source::leader) {
                out.warn(left_out(last));
            }
            execute::start(&self.state, &mut out)?;
            if let Some(startup) = self.startup.take() {
                startup.run(&mut self.state, &mut out)?;
            }
        }
        let done = self.reader.next(&mut self.state, &mut out);
        if self.state.progress.ended {
            self.stage = Stage::Ended;
        }
        done
    }

    /// Puts what the receiver of the calls finds wrong, later than at the call, at the place the call came
    /// from.
    pub fn diagnose(&mut self, place: Place, problem: Problem) -> Diagnostic {
        diagnostic(problem, Some(place), &mut self.reader).1
    }

    /// The warnings since the last call; each line warns once.
    pub fn take_warnings(&mut self) -> Vec<Diagnostic> {
        self.findings.take_warnings()
    }

    /// Name of a file, see [`Place::file`].
    pub fn file_name(&self, file: u16) -> Option<&Arc<str>> {
        self.reader.files().get(usize::from(file)).map(Source::name)
    }

    /// The value of a parameter, offsets in machine units. `None`: a common variable of FANUC, #100 to #199
    /// or #500 to
    /// #999, that is vacant.
    pub fn parameter(&self, number: u32) -> Option<f64> {
        self.reader.shared(number).unwrap_or_else(|| Some(self.state.parameter(number)))
    }

    /// The first of the parameters of [`Program::systems`].
    pub const FIRST_OF_SYSTEMS: u32 = crate::state::SYSTEM + 1;

    /// The parameters that hold offsets and rotations of G54 to G59.3, twenty of each, in machine units.
    pub fn systems(&self) -> &[f64] {
        self.state.memory.from(Self::FIRST_OF_SYSTEMS, 9 * 20)
    }

    /// What outlives the program, as far as it has come.
    pub fn outlasting(&self) -> Outlasting {
        self.start.outlasting(&self.reader, &self.state)
    }

    /// The tools as the program has left them, in machine units.
    pub fn tools(&self) -> &ToolTable {
        &self.state.tools.table
    }

    /// Whether X words are diameters: G7, and the lathes of FANUC.
    pub fn x_is_diameter(&self) -> bool {
        self.state.modes.diameter
    }

    /// Whether the `%` that ends the program was met, if only on the search for a subroutine.
    pub fn is_read_to_end(&self) -> bool {
        self.reader.files().get(0).is_some_and(Source::is_closed)
    }

    /// Whether the program is over.
    pub fn is_ended(&self) -> bool {
        self.stage == Stage::Ended
    }
}

/// Opens a file, and the folder that it is in for subroutine files.
fn open(path: &Path, options: &Options) -> io::Result<Files> {
    if path.is_dir() {
        return Err(io::Error::from(io::ErrorKind::IsADirectory));
    }
    let source = Source::open(path, options.limits.line_length)?;
    Ok(files(source, path.parent(), options))
}

fn files(mut source: Source, folder: Option<&Path>, options: &Options) -> Files {
    if options.dialect == Dialect::Linuxcnc {
        source.keep_leader(options.stand_alone);
    }
    let folders = folder.map(Path::to_owned).into_iter().chain(options.subroutine_folders.iter().cloned());
    Files::new(source, folders.collect(), options.limits.subroutine_bytes, options.limits.line_length)
}

/// The options of a file that is a job: a line may be as long as the job, for all of its points.
fn of_job(options: &Options) -> Options {
    let mut options = Options { dialect: Dialect::Linuxcnc, ..options.clone() };
    options.limits.line_length = job::LONGEST;
    options
}

/// Text above the first % was passed over.
fn left_out(last: u32) -> Box<Problem> {
    let message =
        format!("what stands above the first % is no part of the program: lines 1 to {last} are left out");
    let help = "controls read nothing before it; put it below, in parentheses, to have it shown";
    Problem::warning("no-effect", Blame::Line(1), message, help)
}

/// The program has led nowhere for too long.
fn endless(stay: &Stay) -> Box<Problem> {
    let (lines, (first, last)) = (stay.lines, stay.between());
    let which = if first < last { format!(" (lines {first} to {last})") } else { String::new() };
    let message = format!("{lines} lines that lead nowhere{which}: the limit blocks_without_motion");
    let help = "check the condition of the loop that this line is in, and that its moves add up to a way";
    Problem::error("endless-loop", Blame::Block, message, help)
}
