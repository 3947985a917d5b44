//! `pitchlock offsets`: coordinate systems and tools, seen and set without a program. In: the parameter file
//! and the tool table of a machine. Out: the same files with a value changed, and nothing else of them.
//!
//! ```text
//! G54  X0 Z-112.4 R0       a coordinate system: its zero in the machine, R turns it about Z
//! T3   X-12.4 Z3.1 D0.8    a tool: offsets, diameter, I J angles, Q orientation
//! ```
//! `list` prints such lines, `set` takes one, `load` a file of them. With `--json`, `list` prints
//!
//! ```json
//! { "version": 1, "units": "mm", "parameters": "lathe.var", "tools": "tool.tbl", "in_force": "G54",
//!   "systems": [
//!   { "name": "G54", "X": 0.0, "Y": 0.0, "Z": -112.4, "A": 0.0, "B": 0.0, "C": 0.0, "R": 0.0 } ],
//!   "tool_offsets": [
//!   { "number": 3, "pocket": 3, "X": -12.4, "Z": 3.1, "D": 0.8, "comment": "boring bar" } ] }
//! ```

mod said;
mod shown;

use std::{collections::BTreeMap, fmt::Write as _, path::PathBuf, process::ExitCode};

use clap::{Args, Subcommand};
use gcode::canon::Units;
use gcode::files::{Changes, MachineFile, ParameterFile, Tool, ToolTable};
use interpreter::{Language, ZeroNote};
use machine::Machine;
use process::shell::LanguageArgs;
use said::{OF_SYSTEM, SYSTEMS};
pub(crate) use said::{Set, Target, can_be, line};
pub(crate) use shown::Limits;

use crate::{
    args::{MachineArgs, Shop},
    changes::{claim, wrong},
    error::CliError,
    screen, words,
};

pub(crate) const HELP: &str = "Examples:
  pitchlock offsets list --machine my-lathe.toml
  pitchlock offsets set G54 X0 Z-112.4 --parameters lathe.var
  pitchlock offsets set T3 --add X-0.02 --tools tool.tbl     wear: 0.02 is added to what is there
  pitchlock offsets load setup.txt --machine my-lathe.toml   lines as list prints them

Files are those of --parameters and --tools, else those that the machine file names (parameters and tool_table
under [machine]). Lengths are in units of the machine, X is a radius. Files are replaced as a whole, when all of them
are ready, and keep their order and their comments.

Exit status: 0 done, 2 a file or an argument is wrong: nothing is written then.";

#[derive(Clone, Debug, Args)]
pub(crate) struct OffsetsArgs {
    #[command(subcommand)]
    command: What,
}

#[derive(Clone, Debug, Subcommand)]
enum What {
    /// Print coordinate systems and tools.
    List {
        /// Print one JSON document, and nothing else.
        #[arg(long)]
        json: bool,
        #[command(flatten)]
        files: Files,
    },
    /// Set words of a coordinate system or of a tool.
    Set {
        /// G54 to G59.3, or T and the number of a tool.
        #[arg(value_name = "G54|T1")]
        target: String,
        /// Words, as Z-112.4: X Y Z A B C, R of a system; D I J Q of a tool.
        #[arg(value_name = "WORD", required = true, allow_negative_numbers = true)]
        words: Vec<String>,
        /// Add them to what is there: wear.
        #[arg(long)]
        add: bool,
        #[command(flatten)]
        files: Files,
    },
    /// Set what the lines of files say, all of it or nothing.
    Load {
        /// The files; what stands behind a semicolon is passed over. A word may stand in one of them.
        #[arg(value_name = "FILE", required = true)]
        from: Vec<PathBuf>,
        #[command(flatten)]
        files: Files,
    },
}

/// Which files.
#[derive(Clone, Debug, Args)]
struct Files {
    #[command(flatten)]
    machine: MachineArgs,
    /// Parameter file (LinuxCNC's .var).
    #[arg(long, value_name = "FILE")]
    parameters: Option<PathBuf>,
    /// Tool table (LinuxCNC's .tbl).
    #[arg(long, value_name = "FILE")]
    tools: Option<PathBuf>,
    /// Machine description of LinuxCNC (.ini) that names both.
    #[arg(long, value_name = "FILE")]
    ini: Option<PathBuf>,
}

/// The coordinate system in force; the first parameter of the first system follows it.
const IN_FORCE: u32 = 5220;

/// What is set, with the files that hold it, if any does.
pub(crate) struct Table {
    /// Parameters, in units of the machine; none where nothing says any.
    pub(crate) parameters: Option<ParameterFile>,
    /// Tools, likewise.
    pub(crate) tools: Option<ToolTable>,
    /// The files of both.
    pub(crate) files: [Option<PathBuf>; 2],
    pub(crate) units: Units,
    reference_points: Vec<(u32, f64)>,
}

pub(crate) fn offsets(args: &OffsetsArgs, quiet: bool) -> Result<ExitCode, CliError> {
    match &args.command {
        What::List { json, files } => {
            let table = Table::read(files, quiet || *json, None)?;
            screen::print(&if *json { table.document()? } else { table.lines() });
        }
        What::Set { target, words, add, files } => {
            let sets = line(target, words.iter().map(String::as_str)).map_err(CliError::Input)?;
            change(files, quiet, sets, *add)?;
        }
        What::Load { from, files } => {
            let loaded: Vec<Vec<Set>> =
                from.iter().map(|path| said::loaded(path)).collect::<Result<_, _>>()?;
            change(files, quiet, loaded.into_iter().flatten().collect(), false)?;
        }
    }
    Ok(ExitCode::SUCCESS)
}

/// Sets words. What is there is read when nobody else changes it.
fn change(files: &Files, quiet: bool, sets: Vec<Set>, add: bool) -> Result<(), CliError> {
    let mut changes = Changes::default();
    can_be(&sets, add).map_err(CliError::Input)?;
    let table = Table::read(files, quiet, Some(&mut changes))?;
    table.set(sets, add, &mut changes)?;
    changes.put().map_err(wrong)
}

/// Where a word of a coordinate system stands.
fn parameter(system: usize, letter: char) -> u32 {
    let place = OF_SYSTEM.iter().position(|known| *known == letter).unwrap_or(0) as u32;
    // Nine axes come before the rotation.
    IN_FORCE + 1 + 20 * system as u32 + if letter == 'R' { 9 } else { place }
}

impl Table {
    /// Reads them; for `changes`, keeps others from changing them meanwhile.
    fn read(files: &Files, quiet: bool, changes: Option<&mut Changes>) -> Result<Table, CliError> {
        let Files { machine, parameters, tools, ini } = files.clone();
        let units =
            ini.as_deref().map(MachineFile::read).transpose().map_err(wrong)?.and_then(|ini| ini.units);
        // What else a description says does not matter here.
        let quiet = quiet || ini.is_some();
        let asked = LanguageArgs { parameters, tools, ini, ..LanguageArgs::default() };
        let Shop { machine, language, notes, .. } = machine.with_language(&asked)?;
        words::say(if quiet { "" } else { &notes });
        if let Some(changes) = changes {
            let paths = language.parameters.iter().chain(&language.tools);
            paths.into_iter().try_for_each(|path| claim(changes, path))?;
        }
        Table::of(&language.language(), &machine, units)
    }

    /// Reads those that a language names.
    pub(crate) fn of(
        language: &Language,
        machine: &Machine,
        units: Option<Units>,
    ) -> Result<Table, CliError> {
        let Language { parameters, tools, .. } = language;
        let read = |path: &PathBuf| ParameterFile::read(path);
        let table =
            |path: &PathBuf| if path.exists() { ToolTable::read(path) } else { Ok(ToolTable::default()) };
        Ok(Table {
            parameters: parameters.as_ref().map(read).transpose().map_err(wrong)?,
            tools: tools.as_ref().map(table).transpose().map_err(wrong)?,
            files: [parameters.clone(), tools.clone()],
            units: units.unwrap_or(Units::Millimetre),
            reference_points: interpreter::reference_points(machine),
        })
    }

    /// What is set at a machine that is on.
    pub(crate) fn in_force_now(
        parameters: ParameterFile,
        tools: ToolTable,
        files: [Option<PathBuf>; 2],
        units: Units,
    ) -> Table {
        Table { parameters: Some(parameters), tools: Some(tools), files, units, reference_points: Vec::new() }
    }

    /// A parameter; 0 where none is set.
    pub(crate) fn value(&self, number: u32) -> f64 {
        let values = self.parameters.iter().flat_map(|file| &file.values);
        values.clone().find(|(other, _)| *other == number).map_or(0.0, |(_, value)| *value)
    }

    /// Words as they will stand there: what is added to is looked up.
    ///
    /// # Errors
    /// A tool to be added to is not there, or a diameter would be negative.
    pub(crate) fn resolved(&self, sets: Vec<Set>, add: bool) -> Result<Vec<Set>, String> {
        let one = |Set { target, letter, value }: Set| {
            let before = match target {
                Target::System(system) => self.value(parameter(system, letter)),
                Target::Tool(number) => {
                    let tool = self.tools.as_ref().and_then(|table| table.find(number));
                    if add && tool.is_none() && self.tools.is_some() {
                        return Err(format!(
                            "T{number} is not in the tool table: there is nothing to add to; leave out --add to enter it"
                        ));
                    }
                    tool.map_or(0.0, |tool| word(tool, letter))
                }
            };
            let value = if add { before + value } else { value };
            if letter == 'D' && value < 0.0 {
                return Err(format!("D of {} would be {value}: a diameter is 0 or more", target.name()));
            }
            Ok(Set { target, letter, value })
        };
        sets.into_iter().map(one).collect()
    }

    /// Sets words.
    pub(crate) fn set(&self, sets: Vec<Set>, add: bool, changes: &mut Changes) -> Result<(), CliError> {
        let (mut values, mut words) = (BTreeMap::new(), Vec::new());
        for Set { target, letter, value } in self.resolved(sets, add).map_err(CliError::Input)? {
            match target {
                Target::System(system) => drop(values.insert(parameter(system, letter), value)),
                Target::Tool(number) => words.push((number, letter, value)),
            }
        }
        let missing = |what: &str, option: &str, key: &str| {
            let text = format!(
                "there is no {what}: name one with {option} FILE, or as {key} under [machine] of the machine file"
            );
            CliError::Input(text)
        };
        let [parameters, tools] = self.files.each_ref().map(Option::as_ref);
        if !values.is_empty() && parameters.is_none() {
            return Err(missing("parameter file", "--parameters", "parameters"));
        }
        if !words.is_empty() {
            let tools = tools.ok_or_else(|| missing("tool table", "--tools", "tool_table"))?;
            changes.tools(tools, &words).map_err(wrong)?;
        }
        match parameters {
            Some(path) if !values.is_empty() => {
                let values: Vec<_> = values.into_iter().collect();
                let fresh = ParameterFile::fresh(&self.reference_points);
                changes.parameters(path, &values, &fresh).map_err(wrong)
            }
            _ => Ok(()),
        }
    }

    /// The same, kept in other files.
    pub(crate) fn of_files(self, files: [Option<PathBuf>; 2]) -> Table {
        Table { files, ..self }
    }

    /// The same where a program has come so far.
    pub(crate) fn so_far(&self, notes: &[ZeroNote]) -> Table {
        let values = self.parameters.iter().flat_map(|file| file.values.iter().copied());
        let set = notes.iter().flat_map(|note| note.set.iter().copied());
        let in_force = notes.last().map(|note| (IN_FORCE, f64::from(note.system)));
        let values: BTreeMap<u32, f64> = values.chain(set).chain(in_force).collect();
        Table {
            parameters: Some(ParameterFile { values: values.into_iter().collect() }),
            tools: self.tools.clone(),
            files: self.files.clone(),
            units: self.units,
            reference_points: self.reference_points.clone(),
        }
    }

    fn unit(&self) -> &'static str {
        if self.units == Units::Inch { "inch" } else { "mm" }
    }

    /// The system in force.
    fn in_force(&self) -> String {
        let number = self.value(IN_FORCE) as usize;
        let named = SYSTEMS.get(number.saturating_sub(1)).map(|name| (*name).to_owned());
        named.unwrap_or_else(|| format!("G54.1 P{}", number - SYSTEMS.len()))
    }

    /// Lines that `load` takes.
    fn lines(&self) -> String {
        let mut text = String::new();
        // A string takes everything.
        if let [Some(path), _] = &self.files {
            let _ = writeln!(
                text,
                "; {}: {}, X a radius, {} in force",
                path.display(),
                self.unit(),
                self.in_force()
            );
            for (system, name) in SYSTEMS.iter().enumerate() {
                let words = OF_SYSTEM.map(|letter| (letter, self.value(parameter(system, letter))));
                let shown = words.iter().filter(|(letter, value)| *value != 0.0 || "XZ".contains(*letter));
                let words: Vec<_> = shown.map(|(letter, value)| format!("{letter}{value}")).collect();
                let _ = writeln!(text, "{name:<5} {}", words.join(" "));
            }
        }
        if let ([_, Some(path)], Some(table)) = (&self.files, &self.tools) {
            let _ = writeln!(text, "; {}: {}, X a radius", path.display(), self.unit());
            for tool in table.iter() {
                let words = tool.words();
                let shown = words.iter().filter(|(letter, value)| *value != 0.0 || "XZ".contains(*letter));
                let words: Vec<_> = shown.map(|(letter, value)| format!("{letter}{value}")).collect();
                let comment =
                    if tool.comment.is_empty() { String::new() } else { format!("  ;{}", tool.comment) };
                let _ = writeln!(text, "{:<5} {}{comment}", format!("T{}", tool.number), words.join(" "));
            }
        }
        if text.is_empty() {
            text = "; no parameter file and no tool table: name them with --parameters and --tools\n".into();
        }
        text
    }

    fn document(&self) -> Result<String, CliError> {
        let text = serde_json::to_string_pretty(&self.shown(usize::MAX));
        Ok(text.map_err(|error| CliError::Machine(error.to_string()))? + "\n")
    }
}

fn word(tool: &Tool, letter: char) -> f64 {
    tool.words().iter().find(|(known, _)| *known == letter).map_or(0.0, |(_, value)| *value)
}
