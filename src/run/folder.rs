//! The run folder: everything that a run was made of, and everything it left.

use std::path::{Path, PathBuf};

use rig::{observe::Summary, trace};

use crate::{
    cli::{RunArgs, Trace},
    error::CliError,
};

/// A run folder and the copies in it.
pub(crate) struct RunFolder {
    /// The folder.
    pub(crate) path: PathBuf,
    /// The program as the user named it.
    pub(crate) named: String,
    /// Copy of the program.
    pub(crate) program: PathBuf,
    /// Copy of the machine file.
    pub(crate) machine: PathBuf,
    /// Copy of the scenario.
    pub(crate) scenario: Option<PathBuf>,
    /// Form of the trace.
    pub(crate) trace: Option<trace::Format>,
}

const MACHINE: &str = "machine.toml";
const SCENARIO: &str = "scenario.toml";

impl RunFolder {
    /// Makes the folder and copies the input into it.
    pub(crate) fn create(
        args: &RunArgs,
        machine: &str,
        scenario: Option<&str>,
    ) -> Result<RunFolder, CliError> {
        let path = match &args.out {
            Some(path) => {
                std::fs::create_dir_all(path).map_err(|error| CliError::file(path, error))?;
                path.clone()
            }
            None => numbered(&args.program)?,
        };
        let name = args.program.file_name().unwrap_or_else(|| "program.ngc".as_ref());
        let program = path.join(name);
        if !same_file(&args.program, &program) {
            std::fs::copy(&args.program, &program).map_err(|error| CliError::file(&program, error))?;
        }
        let write = |name: &str, text: &str| {
            let path = path.join(name);
            std::fs::write(&path, text).map(|()| path.clone()).map_err(|error| CliError::file(&path, error))
        };
        let machine = write(MACHINE, machine)?;
        let scenario = scenario.map(|text| write(SCENARIO, text)).transpose()?;
        let trace = match args.trace {
            Trace::Mcap => Some(trace::Format::Mcap),
            Trace::Csv => Some(trace::Format::Csv),
            Trace::None => None,
        };
        let named = args.program.display().to_string();
        Ok(RunFolder { path, named, program, machine, scenario, trace })
    }
}

fn same_file(a: &Path, b: &Path) -> bool {
    matches!((a.canonicalize(), b.canonicalize()), (Ok(a), Ok(b)) if a == b)
}

/// `runs/<program>-<n>` with the first number that is free.
fn numbered(program: &Path) -> Result<PathBuf, CliError> {
    let stem = program.file_stem().unwrap_or_else(|| "program".as_ref()).to_string_lossy();
    let runs = Path::new("runs");
    std::fs::create_dir_all(runs).map_err(|error| CliError::file(runs, error))?;
    for n in 1..1_000_000 {
        let path = runs.join(format!("{stem}-{n}"));
        match std::fs::create_dir(&path) {
            Ok(()) => return Ok(path),
            Err(error) if error.kind() == std::io::ErrorKind::AlreadyExists => {}
            Err(error) => return Err(CliError::file(&path, error)),
        }
    }
    Err(CliError::Input("runs/ is full: remove old run folders, or name one with --out".into()))
}

/// If a run folder was named instead of a program: the arguments of that run. What else was said on the command line
/// goes before.
pub(crate) fn repeated(args: &RunArgs) -> Result<RunArgs, CliError> {
    if !args.program.is_dir() {
        return Ok(args.clone());
    }
    let folder = &args.program;
    let summary = Summary::read(&folder.join("summary.json")).map_err(|error| {
        CliError::Input(format!("{error}\nhelp: {} is not the folder of a finished run", folder.display()))
    })?;
    let name = Path::new(&summary.program).file_name().unwrap_or_default();
    let mut repeated = args.clone();
    repeated.program = folder.join(name);
    let there = |name: &str| Some(folder.join(name)).filter(|path| path.exists());
    repeated.machine.machine = args.machine.machine.clone().or_else(|| there(MACHINE));
    repeated.scenario = args.scenario.clone().or_else(|| there(SCENARIO));
    repeated.seed = args.seed.or(Some(summary.seed));
    Ok(repeated)
}
