//! What came of a run that has come to an end, and how that is told. In: its summary, what could not be
//! written. Out: text or a document, the exit status.

use std::{
    path::{Path, PathBuf},
    process::ExitCode,
};

use rig::observe::{Outcome, Summary};

use super::summed::{summed_up, told};
use crate::{error::CliError, screen, words};

/// A run that has come to an end.
pub(super) struct Ended {
    /// What became of it.
    pub(super) summary: Summary,
    /// Its folder.
    pub(super) folder: PathBuf,
    /// Its page, if it could be written.
    pub(super) report: Option<PathBuf>,
    /// The first that could not be written.
    pub(super) unwritten: Option<CliError>,
    /// How it is told.
    pub(super) form: Form,
}

impl Ended {
    /// Tells what came of it; what could not be written is an error behind that.
    pub(super) fn tells(self, quiet: bool) -> Result<ExitCode, CliError> {
        tell_end(&self.summary, self.report.as_deref(), self.form, quiet)?;
        self.unwritten.map_or_else(|| Ok(status(&self.summary)), Err)
    }
}

/// How it is told what came of a run.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Form {
    /// Printed as one document.
    Json,
    /// Printed in words.
    Printed,
    /// Said: what goes on behind the run waits for no reader.
    Said,
}

/// Tells what came of a run.
pub(super) fn tell_end(
    summary: &Summary,
    report: Option<&Path>,
    form: Form,
    quiet: bool,
) -> Result<(), CliError> {
    if quiet && let Some(fault) = summary.faults.first() {
        words::say(&format!("error: {}\n", told(fault)));
    }
    match form {
        Form::Json => {
            let text = serde_json::to_string_pretty(summary);
            let text = text.map_err(|error| CliError::Machine(error.to_string()))?;
            screen::print(&format!("{text}\n"));
        }
        _ if quiet => {}
        Form::Printed => screen::print(&summed_up(summary, report)),
        Form::Said => words::say(&summed_up(summary, report)),
    }
    Ok(())
}

/// 0 done, and the part is good as far as it is judged; 1 not done; 3 done, but the part is not good, and why
/// is said.
pub(super) fn status(summary: &Summary) -> ExitCode {
    if summary.outcome != Outcome::Completed {
        return ExitCode::from(1);
    }
    summary.part.told().for_each(|told| words::say(&format!("{told}\n")));
    if summary.part.reasons.is_empty() { ExitCode::SUCCESS } else { ExitCode::from(3) }
}
