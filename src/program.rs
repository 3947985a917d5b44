//! A program, read and judged as a whole before anything moves: G-code or a `.mc` file.

use std::path::Path;

use interpreter::{Check, Diagnostic, Severity};
use protocol::{Code, Item, Machine, code_file::CodeFile};

use crate::{cli, error::CliError};

/// A program that was read.
pub(crate) struct Program {
    /// The machine code.
    pub(crate) items: Vec<Item>,
    /// What the interpreter found, of G-code.
    pub(crate) check: Option<Check>,
    /// Every diagnostic as the user sees it.
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
            return Ok(Program { items: file.items, check: None, messages: String::new() });
        }
        let source = std::fs::read_to_string(path).map_err(|error| CliError::file(path, error))?;
        let name = path.display().to_string();
        let check = interpreter::check(&name, &source, machine);
        let colour = cli::colour(&std::io::stderr());
        let render = |diagnostic: &Diagnostic| diagnostic.render(&name, &source, colour) + "\n";
        let messages = check.diagnostics.iter().map(render).collect();
        Ok(Program { items: check.items.clone(), check: Some(check), messages })
    }

    /// How many errors and warnings there are.
    pub(crate) fn count(&self, severity: Severity) -> usize {
        let of = |check: &Check| check.diagnostics.iter().filter(|one| one.severity == severity).count();
        self.check.as_ref().map_or(0, of)
    }
}

/// Why machine code does not suit the limits of a machine of the same name that has changed since.
fn not_for(machine: &Machine, items: &[Item]) -> Option<String> {
    items.iter().find_map(|item| {
        let (line, what) = match item.code {
            Code::Pass(pass) if !machine.can_follow(&pass) => (item.line, "a pass its axes cannot follow"),
            Code::Line { target, .. } if !machine.can_reach(&target) => {
                (item.line, "a move beyond its travel")
            }
            _ => return None,
        };
        Some(format!(
            "{what} (line {line} of the program): the machine has changed, compile the program again"
        ))
    })
}
