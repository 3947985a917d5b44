//! A program, read and judged as a whole before anything moves: G-code, a job (`.toml`) or a `.mc` file.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use gauge::Nominal;
use interpreter::{Check, Diagnostic, Dialect, Entry, GaugedThread, Guess, Interpreter, Language, Severity};
use machine::{Machine, ProgramDialect};
use protocol::{
    Code, Item,
    code_file::{CodeFile, CodeReader},
};
use rig::observe::{Message, Observer, ProgramWarning, Watch};

use crate::{
    chip::chips_mm,
    entered,
    error::CliError,
    fit::{Fit, changed},
    gauged,
    references::{self, Reference},
    repeated, screen,
    words::Phase,
};

/// A program that was read.
pub(crate) struct Program {
    /// The dialect that it was read in.
    pub(crate) dialect: &'static str,
    /// Items of machine code, what they count in the progress of a run, and moves among them.
    pub(crate) count: u64,
    pub(crate) steps: u64,
    pub(crate) moves: u64,
    /// Those of them that the observer watches for.
    pub(crate) watched: Vec<Item>,
    /// What the interpreter found, of G-code and jobs.
    pub(crate) check: Option<Check>,
    /// The same as the user sees them.
    pub(crate) messages: String,
    /// How long it takes at 100 % override, s.
    pub(crate) time_s: f64,
    /// The file beside it that describes the part.
    pub(crate) part_file: Option<PathBuf>,
    /// What judges its threads.
    pub(crate) gauges: Vec<GaugedThread>,
    /// What the edge takes in each pass of which that is known.
    pub(crate) chips_mm: BTreeMap<u32, f64>,
    /// Where it is begun, if not at its beginning.
    pub(crate) entry: Option<Entry>,
    /// The reference runs that come before it.
    pub(crate) references: Vec<Reference>,
    /// It is what somebody has given by hand, block by block.
    pub(crate) by_hand: bool,
}

impl Program {
    /// Reads a program for a machine, and for a gauge that goes before what the program says of its thread.
    ///
    /// # Errors
    /// The file cannot be read, is damaged, or has errors: all of them are in the text.
    pub(crate) fn read(
        path: &Path,
        language: &Language,
        machine: &Machine,
        gauge: Option<Nominal>,
    ) -> Result<Program, CliError> {
        let program = Program::judge(path, None, language, machine, gauge)?;
        match &program.check {
            Some(check) if !check.is_good() => Err(CliError::Input(program.errors_first())),
            _ => entered::begun(program, path, language, machine),
        }
    }

    /// The same, but a program with errors is a result as well; and its text may be at hand.
    ///
    /// # Errors
    /// The file cannot be read, or is damaged.
    pub(crate) fn judge(
        path: &Path,
        text: Option<Vec<u8>>,
        language: &Language,
        machine: &Machine,
        gauge: Option<Nominal>,
    ) -> Result<Program, CliError> {
        let _shown = Phase::begin("reading the program");
        if CodeFile::is_named(path) {
            return Program::from_code_file(path, machine, gauge);
        }
        let (mut watch, mut watched) = (Watch::default(), Vec::new());
        let read = Read::of(path, text.as_deref(), language, machine);
        let program = match text {
            Some(text) => interpreter::open_text(&path.display().to_string(), text, language, machine)
                .map_err(|error| CliError::Input(error.to_string()))?,
            None => open(path, language, machine)?,
        };
        let beside =
            interpreter::part_beside(path, machine).map_err(|error| CliError::Input(error.to_string()))?;
        let (part_file, part) = beside.unzip();
        let interpreter = Interpreter::new(program, machine).with_part(part).with_gauge(gauge);
        let mut check = interpreter::check_interpreter(interpreter, machine, |item| {
            Phase::at(item.line);
            if watch.wants(&item) {
                watched.push(item);
            }
        });
        repeated::once_each(&mut check.diagnostics);
        if language.strict {
            check.diagnostics.iter_mut().for_each(|diagnostic| diagnostic.severity = Severity::Error);
        }
        let colour = screen::colour(&std::io::stderr());
        let render = |diagnostic: &Diagnostic| diagnostic.render(colour) + "\n";
        let mut messages: String = check.diagnostics.iter().map(render).collect();
        messages.insert_str(0, &read.told(path));
        if !check.is_good() {
            messages += &read.hint();
        }
        let gauges = check.gauges.clone();
        let chips_mm = chips_mm(&check.passes, machine, &gauges);
        let (count, steps, moves, time_s) = (check.count, check.steps, check.moves, check.time_s);
        Ok(Program {
            dialect: read.name(),
            count,
            steps,
            moves,
            watched,
            check: Some(check),
            messages,
            time_s,
            part_file,
            gauges,
            chips_mm,
            entry: None,
            references: references::of(machine),
            by_hand: false,
        })
    }

    /// Machine code of a file, for the machine that it was made for.
    fn from_code_file(path: &Path, machine: &Machine, gauge: Option<Nominal>) -> Result<Program, CliError> {
        let open = CodeReader::open(path, &machine.identity());
        let mut file = open.map_err(|error| CliError::file(path, error))?;
        let (mut watch, mut watched, mut fit) = (Watch::default(), Vec::new(), Fit::new(machine));
        let (mut count, mut steps, mut moves, mut wrong, mut by_hand) = (0, 0, 0, None, false);
        let items = file.by_ref().map_while(|item| {
            let judged = item.map_err(|error| error.to_string()).and_then(|item| {
                fit.item(&item).map_or(Ok(item), Err)?;
                // Who works by hand asks for each reference run.
                by_hand |= count == 0 && matches!(item.code, Code::ByHand(_));
                (count, steps, moves) = (count + 1, steps + item.steps(), moves + u64::from(item.is_move()));
                if watch.wants(&item) {
                    watched.push(item);
                }
                if watched.len() > MOST_WATCHED { Err(too_many()) } else { Ok(item) }
            });
            judged.map_err(|text| wrong = Some(text)).ok()
        });
        let time_s = interpreter::time_s(items.inspect(|item| Phase::at(item.line)), machine);
        if let Some(text) = wrong {
            return Err(CliError::file(path, text));
        }
        let time_s =
            time_s.map_err(|(line, reason)| CliError::file(path, changed(&reason.to_string(), line)))?;
        Ok(Program {
            dialect: Dialect::default().name(),
            count,
            steps,
            moves,
            watched,
            check: None,
            messages: String::new(),
            time_s,
            part_file: None,
            gauges: gauge
                .map(|nominal| GaugedThread { nominal, from_mm: BTreeMap::new() })
                .into_iter()
                .collect(),
            chips_mm: BTreeMap::new(),
            entry: None,
            references: if by_hand { Vec::new() } else { references::of(machine) },
            by_hand,
        })
    }

    /// The machine code of a program that was judged and is good, item by item; the first error is the last
    /// item. There is none unless the file has changed since.
    ///
    /// # Errors
    /// The file cannot be read any more.
    pub(crate) fn items(
        &self,
        path: &Path,
        language: &Language,
        machine: &Machine,
    ) -> Result<Box<dyn Iterator<Item = Result<Item, String>>>, CliError> {
        if CodeFile::is_named(path) {
            let open = CodeReader::open(path, &machine.identity());
            let file = open.map_err(|error| CliError::file(path, error))?;
            return Ok(Box::new(file.map(|item| item.map_err(|error| error.to_string()))));
        }
        let told = |error: Diagnostic| error.render(false);
        if language.from.is_some() {
            let begun = entered::begin(path, language, machine)?;
            return Ok(Box::new(begun.map(move |item| item.map_err(told))));
        }
        let interpreter = Interpreter::new(open(path, language, machine)?, machine);
        Ok(Box::new(interpreter.map(move |item| item.map_err(told))))
    }

    /// How many passes of threads there are.
    pub(crate) fn passes(&self) -> u32 {
        self.watched.iter().filter(|item| matches!(item.code, Code::Pass(_))).count() as u32
    }

    /// Who observes a run of it.
    pub(crate) fn observer(&self, machine: &Machine) -> Observer {
        let observer = Observer::new(machine, &self.watched);
        let Some(check) = &self.check else { return gauged::holds(self, observer) };
        let origins = check.passes.iter().map(|note| (note.pass, note.origin_mm)).collect();
        let observer = match &check.part {
            Some(part) => observer.of_part(part, &origins),
            None => observer.lying_at(&origins),
        };
        let observer = observer.with_messages(check.messages.iter().map(|note| Message {
            line: note.line,
            after: note.after,
            text: note.text.clone(),
        }));
        let observer = observer.with_tools(|number, tool| {
            tool.origin_mm = check.origins_mm.get(&number).copied();
            tool.diameter_mm = check.diameters_mm.get(&number).copied();
        });
        let guessed = check.passes.iter().filter(|note| note.depth_mm.is_none());
        let observer = observer.guessing_depths(guessed.map(|note| note.pass));
        match &self.entry {
            Some(entry) => observer.from_line(entry.line),
            None => gauged::holds(self, observer),
        }
    }

    /// Files that were read besides the program.
    pub(crate) fn subroutine_files(&self) -> impl Iterator<Item = &Path> {
        self.check.iter().flat_map(|check| check.subroutine_files.iter().map(PathBuf::as_path))
    }

    /// What the check warned of.
    pub(crate) fn warnings(&self) -> Vec<ProgramWarning> {
        let told = |one: &Diagnostic| ProgramWarning {
            file: one.file.to_string(),
            line: one.line,
            code: one.code.into(),
            text: one.message.clone(),
            help: one.help.clone(),
        };
        self.diagnostics().iter().map(told).collect()
    }

    /// What is wrong, and then what it was warned of, as the user sees it.
    fn errors_first(&self) -> String {
        let (mut text, colour) = (self.messages.clone(), screen::colour(&std::io::stderr()));
        for warning in self.diagnostics().iter().filter(|one| one.severity == Severity::Warning) {
            let warning = warning.render(colour) + "\n";
            if let Some(at) = text.find(&warning) {
                text.replace_range(at..at + warning.len(), "");
                text += &warning;
            }
        }
        text
    }

    /// Every diagnostic.
    pub(crate) fn diagnostics(&self) -> &[Diagnostic] {
        self.check.as_ref().map_or(&[], |check| &check.diagnostics)
    }

    /// How many errors or warnings there are.
    pub(crate) fn found(&self, severity: Severity) -> usize {
        let of = |check: &Check| check.diagnostics.iter().filter(|one| one.severity == severity).count();
        self.check.as_ref().map_or(0, of)
    }
}

/// The dialect that a program is read in.
struct Read {
    dialect: Dialect,
    /// What it looks like by itself.
    guess: Option<Guess>,
    /// Whether that decided.
    by_itself: bool,
}

impl Read {
    fn of(path: &Path, text: Option<&[u8]>, language: &Language, machine: &Machine) -> Read {
        let (dialect, guess) = match text {
            Some(text) => interpreter::dialect_of_text(text, language, machine),
            None => interpreter::dialect(path, language, machine),
        };
        let asked = language.dialect.unwrap_or(machine.general.dialect);
        Read { dialect, guess, by_itself: asked == ProgramDialect::Auto }
    }

    /// Its name.
    fn name(&self) -> &'static str {
        said(self.dialect)
    }

    /// Said before anything else where it is not what it would be without a reason.
    fn told(&self, path: &Path) -> String {
        let unusual = self.guess.filter(|_| self.by_itself && self.dialect != Dialect::default());
        unusual.map_or_else(String::new, |Guess { line, why, .. }| {
            format!("{}: read as {} (line {line}: {why})\n", path.display(), self.name())
        })
    }

    /// Said behind errors of a program that looks like one of the other dialect.
    fn hint(&self) -> String {
        let other = self.guess.filter(|guess| guess.dialect != self.dialect);
        other.map_or_else(String::new, |Guess { dialect, line, why }| {
            let (name, about) = (said(dialect), dialect.about());
            format!("help: line {line} ({why}) looks like {about}: try --dialect {name}\n")
        })
    }
}

/// The name that a dialect has in `--dialect`, where the machine says whether it is that of mills.
fn said(dialect: Dialect) -> &'static str {
    if dialect == Dialect::FanucMill { Dialect::Fanuc.name() } else { dialect.name() }
}

/// Opens a program that is not machine code.
pub(crate) fn open(path: &Path, language: &Language, machine: &Machine) -> Result<gcode::Program, CliError> {
    interpreter::open(path, language, machine).map_err(|error| CliError::Input(error.to_string()))
}

/// Passes, tools, formulas and traces that the observer of a run keeps in memory, at most.
const MOST_WATCHED: usize = 1 << 16;

fn too_many() -> String {
    format!("more than {MOST_WATCHED} passes, tools, formulas and traces: cut it in several programs")
}
