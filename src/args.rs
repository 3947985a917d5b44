//! Arguments that several commands share: the machine, the program, the log.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use interpreter::Language;
use machine::Machine;
use process::shell::LanguageArgs;

use crate::error::CliError;

/// What is said on standard error.
#[derive(Debug, Args)]
pub(crate) struct LogArgs {
    /// Say more; twice for everything.
    #[arg(short, long, global = true, action = clap::ArgAction::Count)]
    pub(crate) verbose: u8,
    /// No progress, no summary; only errors.
    #[arg(short, long, global = true, conflicts_with = "verbose")]
    pub(crate) quiet: bool,
    /// Form of log messages.
    #[arg(long, global = true, value_enum, default_value_t)]
    pub(crate) log_format: LogFormat,
}

/// Form of log messages.
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
pub(crate) enum LogFormat {
    /// For people.
    #[default]
    Text,
    /// For programs, one JSON object a line.
    Json,
}

/// Which machine.
#[derive(Clone, Debug, Args)]
pub(crate) struct MachineArgs {
    /// Machine file (TOML); without it the built-in small lathe (`pitchlock machine`).
    #[arg(long, value_name = "FILE")]
    pub(crate) machine: Option<PathBuf>,
}

impl MachineArgs {
    /// What messages call the machine file.
    pub(crate) fn name(&self) -> String {
        self.machine.as_ref().map_or("built-in machine file".into(), |path| path.display().to_string())
    }

    /// The machine and the text of its file.
    pub(crate) fn read(&self) -> Result<(Machine, String), CliError> {
        let text = match &self.machine {
            None => machine::SMALL_LATHE.to_owned(),
            Some(path) => std::fs::read_to_string(path).map_err(|error| CliError::file(path, error))?,
        };
        let machine = Machine::from_toml(&text)
            .map_err(|error| CliError::Input(format!("{}: {error}", self.name())))?;
        // The truth about the plant is in the same file: whatever is wrong with it is said here.
        sim_plant::Plant::new(&machine, sim_plant::Scenario::none(), 1)
            .map_err(|error| CliError::Input(format!("{}: {error}", self.name())))?;
        Ok((machine, text))
    }

    /// How programs are read: as is asked for, else as the machine file says.
    pub(crate) fn language(&self, asked: &LanguageArgs, machine: &Machine) -> Language {
        let asked = asked.language();
        Language { tools: asked.tools.or_else(|| self.tool_table(machine)), ..asked }
    }

    /// The tool table that the machine file names, where it is seen from here.
    pub(crate) fn tool_table(&self, machine: &Machine) -> Option<PathBuf> {
        let table = machine.general.tool_table.as_ref()?;
        let folder = self.machine.as_ref().and_then(|path| path.parent());
        Some(folder.map_or_else(|| table.clone(), |folder| folder.join(table)))
    }
}

/// A program and the machine it is for.
#[derive(Clone, Debug, Args)]
pub(crate) struct ProgramArgs {
    /// Part program (G-code), job (`.toml`) or machine code (`.mc`).
    #[arg(value_name = "FILE")]
    pub(crate) program: PathBuf,
    #[command(flatten)]
    pub(crate) language: LanguageArgs,
    #[command(flatten)]
    pub(crate) machine: MachineArgs,
}
