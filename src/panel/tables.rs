//! Offsets and tools at the panel. In: what somebody types, the files of the machine. Out: what they are now,
//! shown to everybody; files with a value changed, while the machine is off. Of a machine that works by hand
//! the block that sets them is [`Hand`](super::hand::Hand)'s, and has its cycle.

use std::path::PathBuf;

use gcode::{canon::Units, files::Changes};
use interpreter::{Language, ZeroNote};
use machine::Machine;
use serde_json::{Value, json};

use crate::{
    args::Shop,
    changes::claim,
    error::CliError,
    offsets::{Limits, Set, Table, can_be, line},
    run::RunArgs,
};

/// Most tools that are shown.
const MOST_TOOLS: usize = 1000;

/// Words that somebody types, as they will stand in a table.
///
/// # Errors
/// Why they may not.
pub(super) fn typed(
    of: &str,
    words: &[(char, f64)],
    add: bool,
    table: &Table,
    machine: &Machine,
) -> Result<Vec<Set>, String> {
    let words: Vec<_> = words.iter().map(|(letter, value)| format!("{letter}{value}")).collect();
    let read = || line(of, words.iter().map(String::as_str));
    let asked = read()?;
    can_be(&asked, add)?;
    let sets = table.resolved(asked, add)?;
    Limits(machine).allow(&read()?, add, &sets, table)?;
    Ok(sets)
}

/// Where they are kept.
pub(crate) struct Tables {
    machine: Machine,
    language: Language,
    units: Option<Units>,
    /// Why nothing is written, where it is not.
    fixed: Option<&'static str>,
    /// What the run in hand began with.
    begun: Option<Table>,
}

impl Tables {
    /// Those of a command line.
    pub(crate) fn of(asked: &RunArgs) -> Result<Tables, CliError> {
        let Shop { machine, language, .. } = asked.machine.with_language(&asked.language)?;
        let of_ini = asked.language.ini.is_some();
        let fixed = (of_ini && (asked.language.tools.is_none() || asked.language.parameters.is_none()))
            .then_some("the files belong to LinuxCNC's description of the machine: pitchlock offsets set --ini changes them");
        let language = language.language();
        let units = language.ini.as_ref().and_then(|path| gcode::files::MachineFile::read(path).ok());
        Ok(Tables { machine, language, units: units.and_then(|ini| ini.units), fixed, begun: None })
    }

    fn table(&self, language: &Language) -> Result<Table, CliError> {
        Table::of(language, &self.machine, self.units)
    }

    /// The machine that they are of.
    pub(super) fn machine(&self) -> &Machine {
        &self.machine
    }

    /// The files that keep them.
    pub(super) fn files(&self) -> [Option<PathBuf>; 2] {
        [self.language.parameters.clone(), self.language.tools.clone()]
    }

    /// What the files hold, or why that is not known.
    pub(super) fn kept(&self) -> Value {
        shown(self.table(&self.language).as_ref())
    }

    /// What a run began with: the copies in its folder.
    pub(super) fn begun(&mut self, copies: &Language) -> Value {
        let files = self.files();
        let table = self.table(copies).map(|table| table.of_files(files));
        self.begins(table)
    }

    /// A run begins with these.
    pub(super) fn begins(&mut self, table: Result<Table, CliError>) -> Value {
        let shown = shown(table.as_ref());
        self.begun = table.ok();
        shown
    }

    /// What a program has made of them so far; of its tools that is not known before it is over.
    pub(super) fn so_far(&self, notes: &[ZeroNote]) -> Value {
        let now = self.begun.as_ref().map(|table| table.so_far(notes));
        now.map_or(Value::Null, |now| shown(Ok(&now)))
    }

    /// Sets words in the files.
    pub(super) fn set(&self, of: &str, words: &[(char, f64)], add: bool) -> Result<(), String> {
        if let Some(why) = self.fixed {
            return Err(why.into());
        }
        let mut changes = Changes::default();
        let put = |changes: &mut Changes| {
            self.files().iter().flatten().try_for_each(|path| claim(changes, path))?;
            let table = self.table(&self.language)?;
            let sets = typed(of, words, add, &table, &self.machine).map_err(CliError::Input)?;
            table.set(sets, false, changes)
        };
        put(&mut changes).map_err(|error| error.to_string())?;
        changes.put().map_err(|error| error.to_string())
    }
}

/// A table as everybody sees it.
pub(super) fn shown(table: Result<&Table, &CliError>) -> Value {
    match table {
        Ok(table) => json!(table.shown(MOST_TOOLS)),
        Err(error) => json!({ "unknown": error.to_string() }),
    }
}
