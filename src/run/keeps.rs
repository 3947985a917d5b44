//! What outlives a program: the parameter file and the tool table, written when it has come to its end.
//!
//! A file is written if `--parameters` names it, or the machine file does. One that LinuxCNC's description
//! of a machine names belongs to that machine and is only read, and the copy in a run folder stays what the
//! run began with.

use std::path::PathBuf;

use gcode::{Outlasting, files::Changes};
use machine::Machine;
use process::shell::LanguageArgs;
use rig::observe::Outcome;

use super::RunArgs;
use crate::{
    changes::{claim, wrong},
    error::CliError,
    program::Program,
};

/// Where it is kept.
pub(super) struct Keeps {
    parameters: PathBuf,
    tools: Option<PathBuf>,
}

impl Keeps {
    /// Where what a run leaves is kept, if anywhere. `asked` is the command line, `language` what came of it.
    pub(super) fn of(asked: &RunArgs, machine: &Machine, language: &LanguageArgs) -> Option<Keeps> {
        let own = || asked.language.ini.is_none() && !asked.program.is_dir();
        let named = asked.machine.beside(machine.general.parameters.as_deref());
        let parameters = asked.language.parameters.clone().or_else(|| named.filter(|_| own()))?;
        let tools = language.tools.clone().filter(|_| asked.language.tools.is_some() || own());
        Some(Keeps { parameters, tools })
    }

    /// Writes what a program has changed, if it was executed whole.
    pub(super) fn what_is_left(&self, program: &Program, outcome: Outcome) -> Result<(), CliError> {
        let Some(left) = program.check.as_ref().map(|check| &check.outlasting) else { return Ok(()) };
        if outcome != Outcome::Completed {
            return Ok(());
        }
        self.what_was_set(left)
    }

    /// Writes what was set by hand, however that ended.
    pub(super) fn what_was_set(&self, left: &Outlasting) -> Result<(), CliError> {
        let mut changes = Changes::default();
        claim(&mut changes, &self.parameters)?;
        changes.parameters(&self.parameters, &left.changed, &left.parameters).map_err(wrong)?;
        if let Some(tools) = self.tools.as_ref().filter(|_| !left.tools.is_empty()) {
            claim(&mut changes, tools)?;
            changes.tools(tools, &left.tools).map_err(wrong)?;
        }
        changes.put().map_err(wrong)
    }
}
