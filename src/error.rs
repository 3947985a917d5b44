//! What ends a command early, and the exit status it leaves: 1 the machine, 2 the input. That of a run that
//! came to its end is in [`crate::run`].

use std::process::ExitCode;

use process::shell::ShellError;

use crate::words;

/// Why a command did not do what was asked.
#[derive(Debug, thiserror::Error)]
pub(crate) enum CliError {
    /// Program, machine file, scenario or arguments are wrong; the text says where and what would be right.
    #[error("{0}")]
    Input(String),
    /// The input was fine, the computer or the machine was not.
    #[error("{0}")]
    Machine(String),
}

impl CliError {
    /// Prints the error and gives the exit status.
    pub(crate) fn report(&self) -> ExitCode {
        let text = intake::in_words(&self.to_string());
        let already_named = text.contains(": error") || text.starts_with("error");
        words::say(&format!("{}{}\n", if already_named { "" } else { "error: " }, text.trim_end()));
        match self {
            CliError::Input(_) => ExitCode::from(2),
            CliError::Machine(_) => ExitCode::from(1),
        }
    }

    /// A file that cannot be read or written.
    pub(crate) fn file(path: &std::path::Path, error: impl std::fmt::Display) -> CliError {
        CliError::Input(format!("{}: {error}", path.display()))
    }
}

impl From<ShellError> for CliError {
    fn from(error: ShellError) -> Self {
        match error {
            ShellError::Ipc(error) => CliError::Machine(error.to_string()),
            ShellError::NotSetUp(_) => CliError::Machine(error.to_string()),
            ShellError::File { .. } | ShellError::Machine(_) | ShellError::Input(_) => {
                CliError::Input(error.to_string())
            }
        }
    }
}

impl From<process::ipc::IpcError> for CliError {
    fn from(error: process::ipc::IpcError) -> Self {
        CliError::Machine(error.to_string())
    }
}

impl From<rig::trace::TraceError> for CliError {
    fn from(error: rig::trace::TraceError) -> Self {
        CliError::Machine(error.to_string())
    }
}

impl From<rig::observe::SummaryError> for CliError {
    fn from(error: rig::observe::SummaryError) -> Self {
        CliError::Machine(error.to_string())
    }
}

impl From<report::ReportError> for CliError {
    fn from(error: report::ReportError) -> Self {
        match error {
            report::ReportError::Summary(_) | report::ReportError::Trace { .. } => {
                CliError::Input(error.to_string())
            }
            report::ReportError::Write { .. } => CliError::Machine(error.to_string()),
        }
    }
}

impl From<experiment::ExperimentError> for CliError {
    fn from(error: experiment::ExperimentError) -> Self {
        match error {
            experiment::ExperimentError::Input(text) => CliError::Input(text),
            experiment::ExperimentError::Machine(text) => CliError::Machine(text),
        }
    }
}

impl From<rig::bench::BenchError> for CliError {
    fn from(error: rig::bench::BenchError) -> Self {
        CliError::Machine(error.to_string())
    }
}
