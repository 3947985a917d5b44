//! Arguments that several commands share: the machine, the program, the log.

use std::{
    fmt::Write as _,
    path::{Path, PathBuf},
};

use clap::{Args, ValueEnum};
use machine::{General, Machine};
use process::shell::LanguageArgs;

use crate::{error::CliError, ini};

/// A seed.
pub(crate) fn seed(text: &str) -> Result<u64, String> {
    text.parse().map_err(|_| format!("a seed is a whole number from 0 to {}", u64::MAX))
}

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
            Some(path) => {
                intake::text(path, intake::SETTINGS).map_err(|error| CliError::file(path, error))?
            }
        };
        Ok((machine_of(&self.name(), &text)?, text))
    }

    /// The machine, and how it reads programs: as is asked for, else as LinuxCNC's description of a machine
    /// says, else as the machine file does.
    pub(crate) fn with_language(&self, asked: &LanguageArgs) -> Result<Shop, CliError> {
        let mut language = asked.clone();
        let mut notes = String::new();
        let (machine, text) = match &asked.ini {
            None => self.read()?,
            Some(path) => ini::read(path, self, &mut language, &mut notes)?,
        };
        let General { tool_table, parameters, .. } = &machine.general;
        language.tools = language.tools.or_else(|| self.beside(tool_table.as_deref()));
        language.parameters = language.parameters.or_else(|| self.beside(parameters.as_deref()));
        if let Some(missing) = language.parameters.as_ref().filter(|path| !path.exists()) {
            let _ = writeln!(notes, "{}: is not there yet, so all offsets are 0", missing.display());
        }
        Ok(Shop { machine, text, language, notes })
    }

    /// A file that the machine file names, where it is seen from here.
    pub(crate) fn beside(&self, file: Option<&Path>) -> Option<PathBuf> {
        let folder = self.machine.as_ref().and_then(|path| path.parent());
        let file = file?;
        Some(folder.map_or_else(|| file.to_owned(), |folder| folder.join(file)))
    }
}

/// The machine that a text describes; `name` is what messages call it.
pub(crate) fn machine_of(name: &str, text: &str) -> Result<Machine, CliError> {
    let wrong = |error: &dyn std::fmt::Display| CliError::Input(format!("{name}: {error}"));
    let machine = Machine::from_toml(text).map_err(|error| wrong(&error))?;
    // The truth about the plant is in the same file: whatever is wrong with it is said here.
    sim_plant::Plant::new(&machine, sim_plant::Scenario::none(), 1).map_err(|error| wrong(&error))?;
    Ok(machine)
}

/// A machine and how it reads programs, after everything that was asked for.
pub(crate) struct Shop {
    /// The machine.
    pub(crate) machine: Machine,
    /// The text of its file.
    pub(crate) text: String,
    /// How it reads programs.
    pub(crate) language: LanguageArgs,
    /// What people are told of where that comes from.
    pub(crate) notes: String,
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
