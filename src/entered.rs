//! `pitchlock run PROGRAM --from LINE`: what is in force at a line of a program, and how the tool gets
//! there. In: a program and a line. Out: the program from there on; what was found, in words and as JSON.

use std::{fmt::Write as _, path::Path};

use interpreter::{Begun, Entry, Interpreter, Language, NoEntry, is_job};
use machine::Machine;
use protocol::{Code, Feed, Item, SpindleSpeed, code_file::CodeFile};
use rig::{observe::Watch, resume::Place};
use route::in_force::Modal;
use serde_json::{Value, json};

use crate::{
    error::CliError,
    program::{Program, open},
    references,
    words::{Phase, counted},
};

/// So many variables are shown.
const SHOWN: usize = 12;

/// A program from the line on that its language names.
///
/// # Errors
/// It is not begun there, and why.
pub(crate) fn begin(path: &Path, language: &Language, machine: &Machine) -> Result<Begun, CliError> {
    let refused = |refused: NoEntry| CliError::file(path, refused);
    let line = language.from.unwrap_or(1);
    let no_lines = |what| refused(NoEntry::NoLines { what });
    if CodeFile::is_named(path) {
        return Err(no_lines("machine code"));
    }
    if is_job(path) {
        return Err(no_lines("a job"));
    }
    Interpreter::new(open(path, language, machine)?, machine).from_line(line, machine).map_err(refused)
}

/// The same program from the line on that its language names, if it names one: what it counts and
/// how long it takes is that of what is executed.
///
/// # Errors
/// It is not begun there, and why.
pub(crate) fn begun(
    mut program: Program,
    path: &Path,
    language: &Language,
    machine: &Machine,
) -> Result<Program, CliError> {
    if language.from.is_none() {
        return Ok(program);
    }
    let _shown = Phase::begin("reading the program up to the line");
    let mut begun = begin(path, language, machine)?;
    let (mut watch, mut watched, mut wrong) = (Watch::default(), Vec::new(), None);
    (program.count, program.steps, program.moves) = (0, 0, 0);
    let items = begun.by_ref().map_while(|item| match item {
        Ok(item) => {
            Phase::at(item.line);
            (program.count, program.steps) = (program.count + 1, program.steps + item.steps());
            program.moves += u64::from(item.is_move());
            watched.extend(Some(item).filter(|item| watch.wants(item)));
            Some(item)
        }
        Err(error) => {
            wrong = Some(error.render(false));
            None
        }
    });
    let time_s = interpreter::time_s(items, machine);
    if let Some(text) = wrong {
        return Err(CliError::Input(text));
    }
    program.time_s = time_s.map_err(|(_, reason)| CliError::file(path, reason))?;
    program.watched = watched;
    if let Some(check) = &mut program.check {
        check.messages = begun.messages();
        check.zeros = begun.zeros();
    }
    program.entry = Some(begun.entry);
    Ok(program)
}

/// All of it, for people.
pub(crate) fn told(entry: &Entry, machine: &Machine) -> String {
    let mut text = String::new();
    let _ = writeln!(text, "read      {} before line {}, none of them executed", passed(entry), entry.line);
    let _ = writeln!(text, "words     {}", entry.words);
    let _ = writeln!(text, "zero      of coordinate system {}: {}", entry.system, place(entry, machine));
    let shown: Vec<String> =
        entry.variables.iter().take(SHOWN).map(|(name, value)| format!("{name} = {value}")).collect();
    let more = entry.variables.len().saturating_sub(SHOWN);
    if !shown.is_empty() {
        let more = if more > 0 { format!(" and {more} more") } else { String::new() };
        let _ = writeln!(text, "variables {}{more}", shown.join(", "));
    }
    if entry.in_loop {
        let _ = writeln!(text, "loop      the line is in a loop: it begins in its first turn");
    }
    let way = "its run is made first, and ends at home, where the way begins";
    text += &references::told(&references::of(machine), way);
    for unknown in UNKNOWN {
        let _ = writeln!(text, "not known {unknown}");
    }
    for item in &entry.way {
        let _ = writeln!(text, "way       {}", moved(item, machine));
    }
    let pass = entry.pass.map_or_else(String::new, |pass| format!(", with pass {pass}, whole"));
    let first = if entry.moves == entry.line {
        pass
    } else {
        format!(", the first move is that of line {}{pass}", entry.moves)
    };
    let _ = writeln!(text, "begins    at line {}{first}", entry.line);
    let _ = writeln!(text, "in force  {}", in_force(&entry.modal));
    text
}

/// What nobody knows.
const UNKNOWN: [&str; 2] = [
    "whether the part is what the program makes of it up to there",
    "whether the tool in the holder is that of the program",
];

fn passed(entry: &Entry) -> String {
    let Modal { items, passes, .. } = entry.modal;
    let passes = counted(passes.into(), "pass of a thread", "passes of threads");
    format!("{} of machine code, with {passes},", counted(items, "item", "items"))
}

fn place(entry: &Entry, machine: &Machine) -> String {
    let place = Place::of(machine, &entry.zero);
    let radius = if place.y_mm.is_none() { " (X a radius)" } else { "" };
    format!("{place} mm of the machine{radius}")
}

/// The same for programs.
pub(crate) fn as_json(entry: &Entry, machine: &Machine) -> Value {
    let zero = Place::of(machine, &entry.zero);
    json!({
        "version": 1,
        "from": entry.line,
        "line": entry.moves,
        "pass": entry.pass,
        "passes_before": entry.modal.passes,
        "words": entry.words,
        "system": entry.system,
        "zero_mm": { "x": zero.x_mm, "y": zero.y_mm, "z": zero.z_mm },
        "variables": entry.variables.iter().cloned().collect::<std::collections::BTreeMap<_, _>>(),
        "in_loop": entry.in_loop,
        "references": references::of(machine),
        "not_known": UNKNOWN,
        "way": entry.way.iter().map(|item| moved(item, machine)).collect::<Vec<String>>(),
        "tool": entry.modal.tool,
        "in_force": in_force(&entry.modal),
    })
}

/// What is in force where it begins.
pub(crate) fn in_force(modal: &Modal) -> String {
    let tool = modal.tool.map_or_else(|| "no tool".into(), |tool| format!("tool {tool}"));
    let spindle = match modal.spindle {
        Some(Code::Spindle { mode, speed: SpindleSpeed::Rpm(rpm) }) => {
            format!("spindle {:.1} 1/min", mode.sign() * rpm)
        }
        Some(Code::Spindle { mode, speed: SpindleSpeed::Surface { mm_s, .. } }) => {
            format!("spindle at {:.1} m/min", mode.sign() * mm_s * 0.06)
        }
        _ => "the spindle stands".into(),
    };
    let coolant = match modal.coolant {
        Some(Code::Coolant { mist, flood }) if mist || flood => "coolant on",
        _ => "coolant off",
    };
    let outputs = match modal.outputs.len() {
        0 => String::new(),
        number => {
            format!(", {} as the program left them", counted(number as u64, "output", "outputs"))
        }
    };
    format!("{tool}, {spindle}, {coolant}{outputs}; offsets and feeds as the program has them there")
}

/// A move in words, in coordinates of the machine.
pub(crate) fn moved(item: &Item, machine: &Machine) -> String {
    let (target, feed, how) = match &item.code {
        Code::Line { target, feed } => (target, *feed, "to"),
        Code::Arc { arc, feed } => (&arc.target, *feed, "on the arc to"),
        Code::Curve { curve, feed } => (&curve.target, *feed, "along the curve to"),
        _ => return String::new(),
    };
    let place = Place::of(machine, target);
    let radius = if place.y_mm.is_none() { " (X a radius)" } else { "" };
    let feed = match feed {
        Feed::Rapid => "rapid".into(),
        Feed::PerMinute(feed) => format!("{feed} mm/min"),
        Feed::PerRevolution(feed) => format!("{feed} mm/rev"),
    };
    format!("{how} {place} mm of the machine{radius}, {feed}")
}
