//! How a machine reads programs: dialect, tools, the point at which its axes rest.

use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use gcode::files::{FileError, MachineFile, ParameterFile, ToolTable};
use gcode::{DecimalPoint, Dialect, Guess, MachineCode, Options, Program, Skips};
use machine::{self, BareNumbers, Machine, Part, PartError, ProgramDialect};
use protocol::code_file::{CodeFile, MAGIC};
use serde::{Deserialize, Deserializer, Serialize};

use crate::auxiliary::as_l;
use crate::reach::{home, plane_of};

/// How far a program is looked at for its dialect, bytes.
const LOOKED_AT: usize = 64 << 10;
/// Parameters of G28 and G30: the first coordinate of each point.
const REFERENCE_POINTS: [u32; 2] = [5161, 5181];

/// How a program is to be read.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Language {
    /// Dialect of the part program; without it that of the machine file.
    #[serde(default)]
    pub dialect: Option<ProgramDialect>,
    /// Switches of optional blocks that are on: 1 leaves out lines that begin with `/`, 2 those with `/2`.
    #[serde(default, deserialize_with = "switches")]
    pub block_delete: Vec<u8>,
    /// A warning is as bad as an error.
    #[serde(default)]
    pub strict: bool,
    /// Tool table (LinuxCNC's format).
    pub tools: Option<PathBuf>,
    /// Parameter file (LinuxCNC's format): offsets, and what else is set at the start.
    pub parameters: Option<PathBuf>,
    /// Machine description of LinuxCNC (.ini): units, startup code, clearances, values. Files and folders
    /// that it names are not looked for.
    pub ini: Option<PathBuf>,
    /// Folder with subroutine files, besides that of the program; may be given several times.
    #[serde(default)]
    pub subroutines: Vec<PathBuf>,
    /// The line at which the program is begun, from 1; nothing: at its beginning.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub from: Option<u32>,
}

/// Reads switches of optional blocks; folders of runs of old have a yes or no.
fn switches<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<u8>, D::Error> {
    #[derive(Deserialize)]
    #[serde(untagged)]
    enum Written {
        On(bool),
        Numbers(Vec<u8>),
    }
    Ok(match Written::deserialize(deserializer)? {
        Written::On(on) => on.then_some(1).into_iter().collect(),
        Written::Numbers(switches) => switches,
    })
}

/// Why a program cannot be opened.
#[derive(Debug, thiserror::Error)]
pub enum OpenError {
    /// The program itself.
    #[error("{}: {error}", path.display())]
    Program {
        /// Its path.
        path: PathBuf,
        /// Why.
        error: std::io::Error,
    },
    /// It is something else, by what it begins with; the text says what to do.
    #[error("{}: {reason}", path.display())]
    Other {
        /// Its path.
        path: PathBuf,
        /// What it is.
        reason: String,
    },
    /// A folder of subroutines does not exist.
    #[error("{}: there is no such folder for subroutines", .0.display())]
    Folder(PathBuf),
    /// Programs of lathes and mills on another machine.
    #[error(
        "dialect fanuc is that of lathes and mills: read programs with --dialect linuxcnc, and write machine.dialect = \"linuxcnc\""
    )]
    Dialect,
    /// The file beside the program that describes its part.
    #[error("{}: {error}\nhelp: {}", path.display(), error.help())]
    Part {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        error: PartError,
    },
    /// The tool table, the parameter file or LinuxCNC's machine description; the text names file and line.
    #[error("{0}")]
    Beside(String),
}

/// Opens a program for a machine.
///
/// # Errors
/// The program or the tool table cannot be read, or the machine does not read the dialect.
pub fn open(path: &Path, language: &Language, machine: &Machine) -> Result<Program, OpenError> {
    check_folders(&language.subroutines)?;
    no_other(path)?;
    let options = asked(dialect(path, language, machine).0, language, machine)?;
    let opened = if is_job(path) { Program::open_job(path, &options) } else { Program::open(path, &options) };
    opened.map_err(|error| OpenError::Program { path: path.to_owned(), error })
}

/// Opens a text that is at hand, such as that of standard input. `name` is shown in diagnostics.
///
/// # Errors
/// As [`open`].
pub fn open_text(
    name: &str,
    text: Vec<u8>,
    language: &Language,
    machine: &Machine,
) -> Result<Program, OpenError> {
    check_folders(&language.subroutines)?;
    no_foreign(Path::new(name), &text[..text.len().min(LOOKED_AT)])?;
    let options = asked(dialect_of_text(&text, language, machine).0, language, machine)?;
    Ok(Program::from_text(name, text, &options))
}

/// What a machine reads programs with, in a dialect.
pub(crate) fn asked(dialect: Dialect, language: &Language, machine: &Machine) -> Result<Options, OpenError> {
    let mut options = options(machine);
    options.dialect = dialect;
    let kinematics = machine.general.kinematics;
    if options.dialect != Dialect::Linuxcnc && kinematics == machine::Kinematics::Positioner {
        return Err(OpenError::Dialect);
    }
    options.skips = Skips::of(language.block_delete.iter().copied());
    options.subroutine_folders.clone_from(&language.subroutines);
    let beside = |error: FileError| OpenError::Beside(error.to_string());
    let ini = language.ini.as_deref().map_or_else(|| Ok(MachineFile::default()), MachineFile::read);
    let ini = ini.map_err(beside)?;
    if let Some(table) = &language.tools {
        options.tools = ToolTable::read(table).map_err(beside)?;
    }
    if let Some(file) = &language.parameters {
        options.parameters.extend(ini.counted(ParameterFile::read(file).map_err(beside)?));
    }
    described(ini, &mut options);
    Ok(options)
}

/// What LinuxCNC's description of a machine says about programs.
fn described(ini: MachineFile, options: &mut Options) {
    options.machine_units = ini.units.unwrap_or(options.machine_units);
    for (clearance, given) in options.peck_clearances.iter_mut().zip([ini.g73_clearance, ini.g83_clearance]) {
        *clearance = given.unwrap_or(*clearance);
    }
    (options.startup, options.named, options.orient_offset) = (ini.startup, ini.named, ini.orient_offset);
    options.forgets_g92 = ini.forgets_g92;
    options.no_fanuc_subs = ini.no_fanuc_subs;
}

/// The dialect that a program is read in, and what it looks like by itself ([`gcode::guess`]).
pub fn dialect(path: &Path, language: &Language, machine: &Machine) -> (Dialect, Option<Guess>) {
    let beginning = beginning(path);
    dialect_of_text(if is_job(path) { &[] } else { &beginning }, language, machine)
}

/// The same of a text that is at hand.
pub fn dialect_of_text(text: &[u8], language: &Language, machine: &Machine) -> (Dialect, Option<Guess>) {
    let text = &text[..text.len().min(LOOKED_AT)];
    let guess = match machine.general.kinematics {
        machine::Kinematics::Lathe => gcode::guess(text),
        machine::Kinematics::Mill => gcode::guess_of_mill(text),
        machine::Kinematics::Positioner => None,
    };
    let asked = named(language.dialect.unwrap_or(machine.general.dialect), machine);
    (asked.unwrap_or_else(|| guess.map_or_else(Dialect::default, |guess| guess.dialect)), guess)
}

/// `None`: that of the program.
pub(crate) fn named(dialect: ProgramDialect, machine: &Machine) -> Option<Dialect> {
    let mill = machine.general.kinematics == machine::Kinematics::Mill;
    match dialect {
        ProgramDialect::Auto => None,
        ProgramDialect::Linuxcnc => Some(Dialect::Linuxcnc),
        ProgramDialect::Fanuc => Some(if mill { Dialect::FanucMill } else { Dialect::Fanuc }),
    }
}

/// The first bytes of a file; none of what comes through a pipe, which can be read only once.
fn beginning(path: &Path) -> Vec<u8> {
    let mut beginning = Vec::new();
    if path.is_file()
        && let Ok(file) = intake::open(path)
    {
        // What is there, even if reading ends early.
        let _ = file.take(LOOKED_AT as u64).read_to_end(&mut beginning);
    }
    beginning
}

/// The part that a program cuts, if a file beside it describes it: `part.toml` beside `part.ngc`;
/// and that file.
///
/// # Errors
/// It cannot be read, or what it says cannot be.
pub fn part_beside(path: &Path, machine: &Machine) -> Result<Option<(PathBuf, Part)>, OpenError> {
    let path = path.with_extension("toml");
    if machine.general.kinematics == machine::Kinematics::Positioner || !path.is_file() {
        return Ok(None);
    }
    let text = intake::text(&path, intake::SETTINGS);
    let text = text.map_err(|error| OpenError::Program { path: path.clone(), error })?;
    let fits = |part: Part| part.fits(machine.general.kinematics);
    let part = Part::from_toml(&text).and_then(|part| part.map(fits).transpose());
    let part = part.map_err(|error| OpenError::Part { path: path.clone(), error })?;
    Ok(part.map(|part| (path, part)))
}

/// Whether a file is a job by its name: `.toml`.
pub fn is_job(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("toml"))
}

/// Refuses a file that would be read as G-code, but is machine code, or a job that is not named `.toml`.
///
/// # Errors
/// Says what it is and what to do. A file that cannot be read is left to whoever opens it.
pub fn no_other(path: &Path) -> Result<(), OpenError> {
    /// A job says its kind at its beginning.
    const HEAD: usize = 4096;
    let mut beginning = beginning(path);
    beginning.truncate(HEAD);
    let other = |reason: String| Err(OpenError::Other { path: path.to_owned(), reason });
    if beginning.starts_with(&MAGIC) {
        let name = path.with_extension("mc");
        let rename = if CodeFile::is_named(path) { "" } else { "rename it, then " };
        return other(format!(
            "is machine code, not a part program: {rename}`pitchlock check {0}` judges it, `pitchlock run {0}` runs it",
            name.display()
        ));
    }
    if is_job(path) {
        return Ok(());
    }
    let kind =
        |line: &str| line.trim_start().strip_prefix("kind")?.trim_start().strip_prefix('=').map(|_| ());
    let text = String::from_utf8_lossy(&beginning);
    if text.lines().any(|line| kind(line).is_some()) {
        let name = path.with_extension("toml");
        return other(format!(
            "looks like a job, and jobs are named *.toml: rename it to {}",
            name.display()
        ));
    }
    if text.lines().any(is_section) {
        return other("is a file of settings (TOML), not a part program".to_owned());
    }
    no_foreign(path, &beginning)
}

/// Whether a line begins a section of TOML: `[axis.x]`.
fn is_section(line: &str) -> bool {
    let name = line.trim().strip_prefix('[').and_then(|rest| rest.strip_suffix(']'));
    let name = name.map(|name| name.trim_start_matches('[').trim_end_matches(']'));
    name.is_some_and(|name| {
        name.starts_with(|c: char| c.is_ascii_lowercase())
            && name.bytes().all(|b| b.is_ascii_lowercase() || b.is_ascii_digit() || b"._-".contains(&b))
    })
}

/// Whether a file is no text: of what is no padding of its lines more than one byte in twenty is a control
/// character. UTF-16 says by its first two bytes that it is text.
fn is_no_text(beginning: &[u8]) -> bool {
    if beginning.starts_with(&[0xff, 0xfe]) || beginning.starts_with(&[0xfe, 0xff]) {
        return false;
    }
    let padding = |byte: &u8| matches!(byte, 0 | 0x7f | 0x1a);
    let (mut bytes, mut controls) = (0, 0);
    for line in beginning.split(|byte| matches!(byte, b'\n' | b'\r')) {
        let Some(first) = line.iter().position(|byte| !padding(byte)) else { continue };
        let last = line.iter().rposition(|byte| !padding(byte)).unwrap_or(first);
        let text = &line[first..=last];
        bytes += text.len();
        controls += text.iter().filter(|byte| byte.is_ascii_control() && **byte != b'\t').count();
    }
    20 * controls > bytes
}

/// Refuses the language of another control, and what is no text.
fn no_foreign(path: &Path, beginning: &[u8]) -> Result<(), OpenError> {
    if is_no_text(beginning) {
        let reason = "is not text: save it as UTF-8, Latin-1, or UTF-16 with its byte order mark".to_owned();
        return Err(OpenError::Other { path: path.to_owned(), reason });
    }
    let Some(control) = gcode::foreign(beginning) else { return Ok(()) };
    let reason = format!(
        "is a program of {control}, a language that is not read here: have it posted for FANUC or LinuxCNC"
    );
    Err(OpenError::Other { path: path.to_owned(), reason })
}

/// Refuses folders of subroutines that are not there.
///
/// # Errors
/// Names the first.
pub fn check_folders(folders: &[PathBuf]) -> Result<(), OpenError> {
    match folders.iter().find(|folder| !folder.is_dir()) {
        Some(folder) => Err(OpenError::Folder(folder.clone())),
        None => Ok(()),
    }
}

/// What the machine file says about programs: mm, its plane, its axes at home.
pub(crate) fn options(machine: &Machine) -> Options {
    let position = home(machine);
    let is_mill = machine.general.kinematics == machine::Kinematics::Mill;
    let mut options =
        Options { plane: plane_of(machine), position, rigid_taps: true, is_mill, ..Options::default() };
    options.dialect = named(machine.general.dialect, machine).unwrap_or_default();
    options.decimal_point = machine.general.decimal_point.map(|bare| match bare {
        BareNumbers::Conventional => DecimalPoint::Conventional,
        BareNumbers::PocketCalculator => DecimalPoint::PocketCalculator,
        BareNumbers::Refuse => DecimalPoint::Refuse,
    });
    let code = |code: machine::MachineCode| match code {
        machine::MachineCode::Ignore => MachineCode::Ignore,
        machine::MachineCode::Wait => MachineCode::Wait,
        machine::MachineCode::Output { number, value } => MachineCode::Output { number, on: value },
        machine::MachineCode::Input { number, until, within_s } => {
            MachineCode::Input { number, wait: as_l(until), timeout: within_s }
        }
    };
    let codes = machine.machine_codes().map(|(number, of_machine)| (number, code(of_machine)));
    options.machine_codes = Arc::new(codes.collect());
    options.parameters = reference_points(machine);
    options
}

/// Parameters of a machine that no file says anything about: the points of G28 and G30 are its home, mm.
pub fn reference_points(machine: &Machine) -> Vec<(u32, f64)> {
    let home = home(machine);
    REFERENCE_POINTS.into_iter().flat_map(|first| (first..).zip(home)).collect()
}
