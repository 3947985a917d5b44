//! How a machine reads programs: dialect, tools, the point at which its axes rest.

use std::path::{Path, PathBuf};

use gcode::canon::{Plane, X, Z};
use gcode::files::ToolTable;
use gcode::{Dialect, Options, Program};
use protocol::{Axis, Machine, machine};
use serde::{Deserialize, Serialize};

/// How a program is to be read.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, clap::Args)]
pub struct Language {
    /// Dialect of the part program; without it that of the machine file.
    #[arg(long, value_enum, value_name = "DIALECT")]
    pub dialect: Option<machine::Dialect>,
    /// Leave out lines that begin with `/`.
    #[arg(long)]
    #[serde(default)]
    pub block_delete: bool,
    /// Tool table (LinuxCNC's format).
    #[arg(long, value_name = "FILE")]
    pub tools: Option<PathBuf>,
    /// Folder with subroutine files, besides that of the program; may be given several times.
    #[arg(long, value_name = "DIR")]
    #[serde(default)]
    pub subroutines: Vec<PathBuf>,
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
    /// A folder of subroutines is none.
    #[error("{}: there is no such folder for subroutines", .0.display())]
    Folder(PathBuf),
    /// The tool table; the text names file and line.
    #[error("{0}")]
    Tools(String),
}

/// Opens a program for a machine.
///
/// # Errors
/// The program or the tool table cannot be read.
pub fn open(path: &Path, language: &Language, machine: &Machine) -> Result<Program, OpenError> {
    check_folders(&language.subroutines)?;
    let mut options = options(machine);
    if let Some(dialect) = language.dialect {
        options.dialect = of_program(dialect);
    }
    options.block_delete = language.block_delete;
    options.subroutine_folders.clone_from(&language.subroutines);
    if let Some(table) = &language.tools {
        options.tools = ToolTable::read(table).map_err(|error| OpenError::Tools(error.to_string()))?;
    }
    Program::open(path, &options).map_err(|error| OpenError::Program { path: path.to_owned(), error })
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

/// What the machine file says about programs: a lathe in mm, its axes at home.
pub(crate) fn options(machine: &Machine) -> Options {
    let home = |axis| machine.axis.get(&axis).map_or(0.0, |config| config.home_mm);
    let mut options = Options { plane: Plane::Xz, ..Options::default() };
    options.dialect = of_program(machine.machine.dialect);
    options.position[X] = home(Axis::X);
    options.position[Z] = home(Axis::Z);
    // G28 and G30 go home.
    options.parameters = [5161, 5181]
        .into_iter()
        .flat_map(|first| [(first, home(Axis::X)), (first + 2, home(Axis::Z))])
        .collect();
    options
}

fn of_program(dialect: machine::Dialect) -> Dialect {
    match dialect {
        machine::Dialect::Linuxcnc => Dialect::Linuxcnc,
        machine::Dialect::Fanuc => Dialect::Fanuc,
    }
}
