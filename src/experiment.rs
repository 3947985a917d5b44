//! `pitchlock experiment NAME`: a published experiment, made again. In: its name. Out: its findings on the
//! screen or its rows as one JSON document, and a folder with `report.html` and `rows.json`.

use std::{
    path::{Path, PathBuf},
    process::ExitCode,
};

use clap::Args;
use experiment::{Name, Stand};
use machine::{Kinematics, Machine};

use crate::{
    args::MachineArgs,
    error::CliError,
    screen,
    written::{self, Made},
};

pub(crate) const HELP: &str = "Examples:
  pitchlock experiment feed                  tables, and pictures in experiments/feed/report.html
  pitchlock experiment feed --json           the rows as one JSON document
  pitchlock experiment feed --out smooth     the folder for report.html and rows.json

Exit status: 0 done, 1 the machine did not do what the experiment needs, 2 an argument is wrong or the folder cannot be
written.";

#[derive(Clone, Debug, Args)]
pub(crate) struct ExperimentArgs {
    /// Which experiment.
    #[arg(value_enum)]
    name: Name,
    /// Print the rows as one JSON document, and nothing else.
    #[arg(long)]
    pub(crate) json: bool,
    /// Folder for `report.html` and `rows.json` [default: `experiments/NAME`].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Seed of everything random; nothing is in `feed` and `profiles`.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = crate::args::seed)]
    seed: u64,
    #[command(flatten)]
    machine: MachineArgs,
}

/// Makes the experiment, writes its folder and prints what it found.
pub(crate) fn experiment(args: &ExperimentArgs, quiet: bool) -> Result<ExitCode, CliError> {
    let machine = machine(args)?;
    let stand = Stand { machine, seed: args.seed, progress: !quiet && !args.json };
    let folder = args.out.clone().unwrap_or_else(|| Path::new("experiments").join(args.name.text()));
    let page = folder.join("report.html");
    let rows = folder.join("rows.json");
    written::free(&page, Made::Page)?;
    written::free(&rows, Made::Rows)?;
    let made = args.name.make(&stand, &again(args))?;
    std::fs::create_dir_all(&folder).map_err(|error| CliError::file(&folder, error))?;
    written::write(&page, Made::Page, &made.page)?;
    written::write(&rows, Made::Rows, &made.json)?;
    if args.json {
        screen::print(&made.json);
    } else {
        screen::print(&made.screen);
        screen::print(&format!("report  {}\n", page.display()));
    }
    Ok(ExitCode::SUCCESS)
}

/// The machine on the stand: the one of `--machine`, or the built-in one of the kind that is moved.
fn machine(args: &ExperimentArgs) -> Result<Machine, CliError> {
    let (name, file) = (args.name.text(), args.machine.name());
    let wrong = |text: String| Err(CliError::Input(text));
    match (args.name.moves(), &args.machine.machine) {
        (None, Some(_)) => wrong(format!("experiment {name} takes no machine: leave out --machine")),
        (Some(Kinematics::Positioner), None) => Machine::from_toml(Kinematics::Positioner.example())
            .map_err(|error| CliError::Machine(error.to_string())),
        (kind, _) => {
            let machine = args.machine.read()?.0;
            match kind.filter(|kind| *kind != machine.general.kinematics) {
                Some(Kinematics::Positioner) => wrong(format!(
                    "experiment {name} welds a seam, and {file} is not a positioner: give a positioner with --machine"
                )),
                Some(_) => wrong(format!(
                    "experiment {name} cuts threads, and {file} is not a lathe: give a lathe with --machine"
                )),
                None => Ok(machine),
            }
        }
    }
}

/// The command that makes the same findings again.
fn again(args: &ExperimentArgs) -> String {
    let machine = args.machine.machine.as_ref();
    let machine = machine.map_or(String::new(), |path| format!(" --machine {}", path.display()));
    format!("pitchlock experiment {} --seed {}{machine}", args.name.text(), args.seed)
}
