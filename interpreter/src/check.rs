//! A whole program at once: every diagnostic, every pass, and the time it takes. In: a program and a machine.
//! Out: a [`Check`]; nothing moves.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

use gauge::Drawn;
use gcode::{Diagnostic, Outlasting, Program, Severity};
use machine::{Machine, Part};
use protocol::{Code, Item};
use route::Unworkable;

use crate::pass_note::PassNote;
use crate::time::{Clock, LONGEST_S};
use crate::{GaugedThread, Interpreter, JobNote, MessageNote, ZeroNote, options};

/// After so many errors a program is not read further.
const MOST_ERRORS: usize = 100;

/// What reading a whole program brought to light.
#[derive(Clone, Debug, Default)]
pub struct Check {
    /// Errors and warnings, in the order of the program.
    pub diagnostics: Vec<Diagnostic>,
    /// The machine code, where [`check`] was asked for it; fit to run only if there is no error.
    pub items: Vec<Item>,
    /// How many items there are.
    pub count: u64,
    /// What they count in the progress of a run.
    pub steps: u64,
    /// How many of them are moves.
    pub moves: u64,
    /// The passes of threads.
    pub passes: Vec<PassNote>,
    /// The jobs.
    pub jobs: Vec<JobNote>,
    /// The part, if anybody said what it is.
    pub part: Option<Part>,
    /// X and Z of the machine at which zero of the program lies where a tool first cuts, by tool, mm.
    pub origins_mm: BTreeMap<u32, [f64; 2]>,
    /// Where zero of the program lies, from its beginning on.
    pub zeros: Vec<ZeroNote>,
    /// Diameters of tools, by number, as far as the tool table knows them, mm.
    pub diameters_mm: BTreeMap<u32, f64>,
    /// The threads that somebody named, so that gauges judge them.
    pub gauges: Vec<GaugedThread>,
    /// The groove that it draws, if it draws one.
    pub groove: Option<Drawn>,
    /// What it tells its operator.
    pub messages: Vec<MessageNote>,
    /// Files that were read besides the program.
    pub subroutine_files: Vec<PathBuf>,
    /// What outlives it, if it runs to its end.
    pub outlasting: Outlasting,
    /// Estimated duration at 100 % override, s.
    pub time_s: f64,
}

impl Check {
    /// Whether the program can be run.
    pub fn is_good(&self) -> bool {
        self.diagnostics.iter().all(|diagnostic| diagnostic.severity < Severity::Error)
    }
}

/// Reads a program that is at hand as text, in the dialect of the machine file, and keeps its machine code.
/// See [`check_program`].
pub fn check(name: &str, source: &str, machine: &Machine) -> Check {
    let mut items = Vec::new();
    let program = Program::from_text(name, source, &options::options(machine));
    let check = check_program(program, machine, |item| items.push(item));
    Check { items, ..check }
}

/// The same of a text that is a job.
pub fn check_job(name: &str, source: &str, machine: &Machine) -> Check {
    let mut items = Vec::new();
    let program = Program::from_job(name, source, &options::options(machine));
    let check = check_program(program, machine, |item| items.push(item));
    Check { items, ..check }
}

/// Reads a whole program: all of its diagnostics (the first hundred errors), the feasibility of every pass,
/// and an estimate of its duration. `machine` has been checked; `each` gets the machine code, item by item,
/// so that a program of any length takes no more memory than its diagnostics and passes.
pub fn check_program(program: Program, machine: &Machine, each: impl FnMut(Item)) -> Check {
    check_interpreter(Interpreter::new(program, machine), machine, each)
}

/// The same of an interpreter at the beginning of its program.
pub fn check_interpreter(interpreter: Interpreter, machine: &Machine, mut each: impl FnMut(Item)) -> Check {
    check_while(interpreter, machine, |item| {
        each(item);
        true
    })
}

/// The same as long as `each` wants to go on: what is found when it does not is no more than a part.
pub fn check_while(
    mut interpreter: Interpreter,
    machine: &Machine,
    mut each: impl FnMut(Item) -> bool,
) -> Check {
    let mut check = Check::default();
    let mut clock = Clock::new(machine);
    for item in &mut interpreter {
        match item {
            Ok(item) => {
                clock.add(item.line, &item.code);
                check.count += 1;
                check.steps += item.steps();
                check.moves += u64::from(item.is_move());
                if !each(item) {
                    break;
                }
            }
            Err(error) => check.diagnostics.push(error),
        }
        if check.diagnostics.len() == MOST_ERRORS {
            break;
        }
        if clock.seconds() > LONGEST_S {
            break;
        }
    }
    clock.finish();
    if let (Some((line, reason)), true) = (clock.trouble(), check.is_good()) {
        check.diagnostics.push(interpreter.untraceable(line, &reason));
    }
    if clock.seconds() > LONGEST_S {
        check.diagnostics.push(interpreter.endless());
    }
    if check.is_good() {
        check.diagnostics.extend(interpreter.ungauged());
    }
    // What is an error is not warned of as well.
    let place = |found: &Diagnostic| (found.file.clone(), found.line, found.column);
    let wrong: BTreeSet<_> = check.diagnostics.iter().map(place).collect();
    let warnings = interpreter.warnings().iter().filter(|warning| !wrong.contains(&place(warning)));
    check.diagnostics.extend(warnings.cloned());
    check.diagnostics.sort_by_key(|diagnostic| (diagnostic.line, diagnostic.column));
    check.passes = interpreter.passes().to_vec();
    check.messages = interpreter.messages().to_vec();
    check.jobs = interpreter.jobs().to_vec();
    check.part = interpreter.part().cloned();
    check.origins_mm = interpreter.origins_mm().clone();
    check.zeros = interpreter.zeros().to_vec();
    check.diameters_mm = diameters_mm(interpreter.program());
    check.gauges = interpreter.gauges();
    check.groove = interpreter.groove().cloned();
    let files = (1..).map_while(|file| interpreter.program().file_name(file));
    check.subroutine_files = files.map(|name| PathBuf::from(&**name)).collect();
    check.outlasting = interpreter.program().outlasting();
    check.time_s = clock.seconds();
    check
}

/// Diameters of the tool table, by tool, mm.
pub(crate) fn diameters_mm(program: &Program) -> BTreeMap<u32, f64> {
    let tools = program.tools().iter().filter(|tool| tool.diameter > 0.0);
    tools.filter_map(|tool| Some((u32::try_from(tool.number).ok()?, tool.diameter))).collect()
}

/// Calls `each` with every item of machine code, and when it begins and ends at 100 % override, s. Moves of
/// one chain are planned together, at the latest at its end: until then they begin and end with it.
pub fn with_times(
    items: impl IntoIterator<Item = Item>,
    machine: &Machine,
    mut each: impl FnMut(&Item, [f64; 2]),
) {
    let mut clock = Clock::new(machine);
    for item in items {
        if !item.is_move() && !matches!(item.code, Code::PathMode(_)) {
            clock.finish();
        }
        let before_s = clock.seconds();
        clock.add(item.line, &item.code);
        each(&item, [before_s, clock.seconds()]);
    }
}

/// How long machine code takes on a machine at 100 % override, s.
///
/// # Errors
/// The line of the first trace that cannot be followed to its end, and why.
pub fn time_s<I: std::borrow::Borrow<Item>>(
    items: impl IntoIterator<Item = I>,
    machine: &Machine,
) -> Result<f64, (u32, Unworkable)> {
    let mut clock = Clock::new(machine);
    items.into_iter().for_each(|item| clock.add(item.borrow().line, &item.borrow().code));
    clock.finish();
    clock.trouble().map_or(Ok(clock.seconds()), Err)
}
