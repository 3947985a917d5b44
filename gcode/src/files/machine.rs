//! The machine description of LinuxCNC (`.ini`), as far as it changes what a part program means.
//!
//! ```text
//! [TRAJ]     LINEAR_UNITS = mm
//! [RS274NGC] PARAMETER_FILE = lathe.var   SUBROUTINE_PATH = subs:../library   DISABLE_G92_PERSISTENCE = 0
//!            RS274NGC_STARTUP_CODE = G21 G40 G90
//!            G73_PECK_CLEARANCE = 0.254   G83_PECK_CLEARANCE = 0.254   ORIENT_OFFSET = 0   INI_VARS = 1
//! [EMCIO]    TOOL_TABLE = tool.tbl
//! [DISPLAY]  PROGRAM_PREFIX = programs
//! ```
//! Paths count from the folder of the file. Such a file describes much else (drives, screens, logic); that is
//! passed over, and can be asked for. Entries that would change the meaning of a program and are not
//! supported become warnings; FEATURES is one of them, which LinuxCNC has not read since 2.8.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::{FileError, ParameterFile};
use crate::canon::Units;
use crate::problem::{Blame, Diagnostic, Problem, Severity, Span};

/// Entries that change what programs mean and that nothing here takes into account, with the value that is
/// the same as no entry.
const UNSUPPORTED: [(&str, &str, &str); 11] = [
    ("RS274NGC", "REMAP", ""),
    ("RS274NGC", "USER_M_PATH", ""),
    ("RS274NGC", "RETAIN_G43", "0"),
    ("RS274NGC", "NO_DOWNCASE_OWORD", "0"),
    ("RS274NGC", "OWORD_WARNONLY", "0"),
    ("RS274NGC", "G64_DEFAULT_TOLERANCE", "0"),
    ("RS274NGC", "FEATURES", "0"),
    ("EMCIO", "TOOL_CHANGE_AT_G30", "0"),
    ("EMCIO", "TOOL_CHANGE_QUILL_UP", "0"),
    ("EMCIO", "TOOL_CHANGE_WITH_SPINDLE_ON", "0"),
    ("EMCIO", "RANDOM_TOOLCHANGER", "0"),
];

/// What a machine description says about part programs. Lengths in units of the machine.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MachineFile {
    /// Units of the machine.
    pub units: Option<Units>,
    /// How far G73 goes back between pecks.
    pub g73_clearance: Option<f64>,
    /// Where G83 goes down to at rapid, above the depth it had reached.
    pub g83_clearance: Option<f64>,
    /// The tool table.
    pub tool_table: Option<PathBuf>,
    /// The parameter file.
    pub parameter_file: Option<PathBuf>,
    /// Folders where subroutines are looked for, in order.
    pub subroutine_folders: Vec<PathBuf>,
    /// G92 does not outlive a run: its parameters (#5210 to #5219) in the parameter file do not count.
    pub forgets_g92: bool,
    /// M98 and M99 are refused.
    pub no_fanuc_subs: bool,
    /// M19 turns to this angle if R is 0, degrees.
    pub orient_offset: f64,
    /// All entries that are numbers, as the parameters that programs can read: `_ini[section]entry`, lower
    /// case.
    pub named: Vec<(String, f64)>,
    /// Programs cannot read entries.
    pub hides_entries: bool,
    /// Blocks that are executed before each program.
    pub startup: Option<String>,
    /// Entries that change what programs mean and are not supported.
    pub warnings: Vec<Diagnostic>,
    /// All entries: section, key, value.
    entries: Vec<(String, String, String)>,
}

/// An entry, with its place.
struct Entry<'a> {
    name: &'a Arc<str>,
    line: u32,
    text: &'a str,
    section: &'a str,
    key: &'a str,
    value: &'a str,
}

impl MachineFile {
    /// The parameters of a file that count at the start of a program.
    pub fn counted(&self, file: ParameterFile) -> impl Iterator<Item = (u32, f64)> + use<> {
        let forgets_g92 = self.forgets_g92;
        file.values.into_iter().filter(move |(number, _)| !(forgets_g92 && (5210..=5219).contains(number)))
    }

    /// The value of an entry as text; of one that stands twice, the first.
    pub fn entry(&self, section: &str, key: &str) -> Option<&str> {
        let is_it = |(a, b, _): &&(String, String, String)| (a.as_str(), b.as_str()) == (section, key);
        self.entries.iter().find(is_it).map(|(_, _, value)| value.as_str())
    }

    /// Reads a file.
    ///
    /// # Errors
    /// The file cannot be read, or a value that matters is wrong.
    pub fn read(path: &Path) -> Result<MachineFile, FileError> {
        let folder = path.parent().unwrap_or(Path::new(""));
        Ok(MachineFile::parse(&path.display().to_string(), &super::read(path)?, folder)?)
    }

    /// Reads a description from a text; `name` is what messages call it, paths count from `folder`.
    ///
    /// # Errors
    /// A value that matters is wrong.
    pub fn parse(name: &str, text: &str, folder: &Path) -> Result<MachineFile, Box<Diagnostic>> {
        let name: Arc<str> = name.into();
        let mut machine = MachineFile::default();
        let mut prefix = None;
        let mut section = "";
        for (n, text) in text.lines().enumerate() {
            let line = text.trim();
            if let Some(rest) = line.strip_prefix('[') {
                section = rest.split(']').next().unwrap_or("").trim();
                continue;
            }
            if line.starts_with("#INCLUDE") {
                let entry = Entry { name: &name, line: n as u32 + 1, text, section, key: "", value: line };
                let help = "put what it says into this file; entries that it has are missing here";
                let message = format!("`{line}` is not followed");
                machine.warnings.push(entry.diagnostic(Severity::Warning, message, help));
            }
            if line.starts_with(['#', ';']) {
                continue;
            }
            let Some((key, value)) = line.split_once('=') else { continue };
            let (key, value) = (key.trim(), value.trim());
            let entry = Entry { name: &name, line: n as u32 + 1, text, section, key, value };
            machine.name(&entry);
            machine.entries.push((section.to_owned(), key.to_owned(), value.to_owned()));
            match (section, key) {
                ("DISPLAY", "PROGRAM_PREFIX") => prefix = Some(folder.join(value)),
                _ => machine.take(&entry, folder)?,
            }
        }
        machine.subroutine_folders.splice(0..0, prefix);
        if machine.hides_entries {
            machine.named.clear();
        }
        Ok(machine)
    }

    /// `#<_ini[section]entry>`: of entries that stand twice the first one counts.
    fn name(&mut self, entry: &Entry<'_>) {
        let Some(value) = entry.value.parse::<f64>().ok().filter(|value| value.is_finite()) else { return };
        let name = format!("_ini[{}]{}", entry.section, entry.key).to_ascii_lowercase();
        if self.named.iter().all(|(other, _)| *other != name) {
            self.named.push((name, value));
        }
    }

    fn take(&mut self, entry: &Entry<'_>, folder: &Path) -> Result<(), Box<Diagnostic>> {
        match (entry.section, entry.key) {
            ("TRAJ", "LINEAR_UNITS") => self.units = Some(entry.units()?),
            ("RS274NGC", "G73_PECK_CLEARANCE") => self.g73_clearance = Some(entry.length()?),
            ("RS274NGC", "G83_PECK_CLEARANCE") => self.g83_clearance = Some(entry.length()?),
            ("RS274NGC", "ORIENT_OFFSET") => self.orient_offset = entry.number("an angle in degrees")?,
            ("RS274NGC", "INI_VARS") => self.hides_entries = entry.value == "0",
            ("RS274NGC", "PARAMETER_FILE") => self.parameter_file = Some(folder.join(entry.value)),
            ("RS274NGC", "DISABLE_G92_PERSISTENCE") => self.forgets_g92 = entry.value != "0",
            ("RS274NGC", "DISABLE_FANUC_STYLE_SUB") => {
                let value = entry.value.to_ascii_lowercase();
                self.no_fanuc_subs = matches!(value.as_str(), "1" | "true" | "yes" | "on");
            }
            ("RS274NGC", "RS274NGC_STARTUP_CODE") => self.startup = Some(entry.value.to_owned()),
            ("EMCIO", "TOOL_TABLE") => self.tool_table = Some(folder.join(entry.value)),
            ("RS274NGC", "SUBROUTINE_PATH") => {
                let folders = entry.value.split(':').filter(|path| !path.is_empty());
                self.subroutine_folders.extend(folders.map(|path| folder.join(path)));
            }
            (section, key) => {
                let unsupported = |(a, b, default): &(&str, &str, &str)| {
                    (*a, *b) == (section, key) && *default != entry.value
                };
                if UNSUPPORTED.iter().any(unsupported) {
                    let message = format!("[{section}]{key} is not supported");
                    let help = "what it changes about programs is not done here; check them on the machine";
                    self.warnings.push(entry.diagnostic(Severity::Warning, message, help));
                }
            }
        }
        Ok(())
    }
}

impl Entry<'_> {
    fn units(&self) -> Result<Units, Box<Diagnostic>> {
        match self.value.to_ascii_lowercase().as_str() {
            "mm" | "metric" => Ok(Units::Millimetre),
            "in" | "inch" | "imperial" => Ok(Units::Inch),
            _ => Err(self.wrong("is not a unit of length", "write mm or inch")),
        }
    }

    fn number(&self, what: &str) -> Result<f64, Box<Diagnostic>> {
        match self.value.parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(value),
            _ => Err(self.wrong("is not a number", &format!("write {what}"))),
        }
    }

    fn length(&self) -> Result<f64, Box<Diagnostic>> {
        match self.value.parse::<f64>() {
            Ok(value) if value.is_finite() && value >= 0.0 => Ok(value),
            _ => {
                Err(self.wrong("is not a clearance", "write a length of 0 or more, in units of the machine"))
            }
        }
    }

    fn wrong(&self, what: &str, help: &str) -> Box<Diagnostic> {
        let Entry { section, key, value, .. } = self;
        Box::new(self.diagnostic(Severity::Error, format!("[{section}]{key}: `{value}` {what}"), help))
    }

    fn diagnostic(&self, severity: Severity, message: String, help: &str) -> Diagnostic {
        // The value stands at the end of the line: nothing but blanks is after it.
        let end = self.text.trim_end().len();
        let span = Span { start: (end - self.value.len()) as u32, end: end as u32 };
        let mut problem = Problem::error("bad-file", Blame::Span(span), message, help);
        problem.severity = severity;
        Diagnostic::new(*problem, self.name, self.line, self.text, span)
    }
}
