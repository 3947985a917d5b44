//! A program, read and judged as a whole before anything moves: G-code or a `.mc` file.

use std::path::Path;

use interpreter::{Check, Diagnostic, Severity};
use protocol::{Arc, Code, Item, Machine, PerAxis, Position, code_file::CodeFile};

use crate::{cli, error::CliError};

/// A program that was read.
pub(crate) struct Program {
    /// The machine code.
    pub(crate) items: Vec<Item>,
    /// What the interpreter found, of G-code.
    pub(crate) check: Option<Check>,
    /// Every diagnostic.
    pub(crate) diagnostics: Vec<gcode::Diagnostic>,
    /// The same as the user sees them.
    pub(crate) messages: String,
}

impl Program {
    /// Reads a program for a machine.
    ///
    /// # Errors
    /// The file cannot be read, is damaged, or has errors: all of them are in the text.
    pub(crate) fn read(path: &Path, machine: &Machine) -> Result<Program, CliError> {
        let program = Program::judge(path, machine)?;
        match &program.check {
            Some(check) if !check.is_good() => Err(CliError::Input(program.messages)),
            _ => Ok(program),
        }
    }

    /// The same, but a program with errors is a result, too.
    ///
    /// # Errors
    /// The file cannot be read, or is damaged.
    pub(crate) fn judge(path: &Path, machine: &Machine) -> Result<Program, CliError> {
        if CodeFile::is_named(path) {
            let file = CodeFile::open(path, machine).map_err(|error| CliError::file(path, error))?;
            if let Some(text) = not_for(machine, &file.items) {
                return Err(CliError::file(path, text));
            }
            let (diagnostics, messages) = (Vec::new(), String::new());
            return Ok(Program { items: file.items, check: None, diagnostics, messages });
        }
        let source = std::fs::read_to_string(path).map_err(|error| CliError::file(path, error))?;
        let name = path.display().to_string();
        let check = interpreter::check(&name, &source, machine);
        let colour = cli::colour(&std::io::stderr());
        let render = |diagnostic: &Diagnostic| diagnostic.render(&name, &source, colour) + "\n";
        let messages = check.diagnostics.iter().map(render).collect();
        let diagnostics = check.diagnostics.iter().map(|one| placed(one, &name, &source)).collect();
        Ok(Program { items: check.items.clone(), check: Some(check), diagnostics, messages })
    }

    /// How many errors and warnings there are.
    pub(crate) fn count(&self, severity: Severity) -> usize {
        let of = |check: &Check| check.diagnostics.iter().filter(|one| one.severity == severity).count();
        self.check.as_ref().map_or(0, of)
    }
}

/// A diagnostic with the name of the program and the line in question.
fn placed(diagnostic: &Diagnostic, name: &str, source: &str) -> gcode::Diagnostic {
    let Diagnostic { code, severity, line, column, span, message, help } = diagnostic.clone();
    let text = source.lines().nth(line.saturating_sub(1) as usize).unwrap_or_default().to_owned();
    let severity = match severity {
        Severity::Error => gcode::Severity::Error,
        Severity::Warning => gcode::Severity::Warning,
    };
    gcode::Diagnostic { file: name.into(), line, column, text, span, code, severity, message, help }
}

/// Why machine code does not suit the limits of a machine of the same name that has changed since.
fn not_for(machine: &Machine, items: &[Item]) -> Option<String> {
    let mut at = PerAxis::<Position>::default();
    for (axis, config) in machine.axes() {
        at[axis.index()] = Position::from_mm(config.home_mm);
    }
    items.iter().find_map(|item| {
        let what = match item.code {
            Code::Pass(pass) if !machine.can_follow(&pass) => "a pass its axes cannot follow",
            Code::Line { target, .. } if !machine.can_reach(&target) => "a move beyond its travel",
            Code::Arc { arc, .. } if !machine.can_turn(&at, &arc) => {
                "an arc that leaves its travel, or is none"
            }
            Code::Line { target, .. } | Code::Arc { arc: Arc { target, .. }, .. } => {
                at = target;
                return None;
            }
            Code::Pass(pass) => {
                machine.axes().for_each(|(axis, _)| at[axis.index()] = pass.axis(axis).end);
                return None;
            }
            _ => return None,
        };
        Some(format!(
            "{what} (line {} of the program): the machine has changed, compile the program again",
            item.line
        ))
    })
}
