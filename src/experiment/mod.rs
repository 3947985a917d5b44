//! `pitchlock experiment NAME`: a published experiment, made again with the code that moves the machine. In: its name.
//! Out: its findings on the screen or its rows as one JSON document, and a folder with `report.html` and `rows.json`.
//!
//! An experiment is a function that gives [`Findings`]: rows of its own type, and what is to be said, tabled and drawn
//! of them. What is done with findings is the same for all, and stands in this file. Experiments that move a machine
//! do so on a [`Stand`].

mod approach;
mod feed;
mod observer;
mod page;
mod positioner;
mod profiles;
mod resolution;
mod stand;
mod surface;
mod sweep;
pub(crate) mod table;

use std::{
    path::{Path, PathBuf},
    process::ExitCode,
};

use clap::{Args, ValueEnum};
use machine::{Kinematics, Machine};
use serde::Serialize;

use crate::{
    cli::{self, MachineArgs},
    error::CliError,
    report::figures::Figure,
};
use stand::Stand;
use table::{Place, Table};

pub(crate) const HELP: &str = "Examples:
  pitchlock experiment feed                  tables, and pictures in experiments/feed/report.html
  pitchlock experiment feed --json           the rows as one JSON document
  pitchlock experiment feed --out smooth     the folder for report.html and rows.json

Exit status: 0 done, 1 the machine did not do what the experiment needs, 2 an argument is wrong or the folder cannot be
written.";

/// Version of the JSON document.
const VERSION: u32 = 1;

/// The experiments.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum Name {
    /// X moves to depth in step with the spindle: servo errors of six structures of feedforward.
    Approach,
    /// Feed with a smooth jerk: the examples of the published method with their figures put right, and whole blocks.
    Feed,
    /// How well the spindle's angle is known from its encoder, and what that makes of a helix.
    Observer,
    /// What errors of its drives do to the beam of a positioner, which drives an accuracy needs, and a seam.
    Positioner,
    /// What an approach leaves in a lightly damped mode, for six laws of motion.
    Profiles,
    /// What rounded positions do to speed, acceleration and servo error, and how fine they have to be.
    Resolution,
    /// How far feed ratios miss curves and surfaces, as published and put right.
    Surface,
    /// Servo error of X over passes, overrides and wrong beliefs.
    Sweep,
}

impl Name {
    fn text(self) -> &'static str {
        match self {
            Name::Approach => "approach",
            Name::Feed => "feed",
            Name::Observer => "observer",
            Name::Surface => "surface",
            Name::Sweep => "sweep",
            Name::Positioner => "positioner",
            Name::Profiles => "profiles",
            Name::Resolution => "resolution",
        }
    }

    /// What kind of machine it moves, so that `--machine` says which one; none if it takes none: that of `surface` is the
    /// small mill.
    fn moves(self) -> Option<Kinematics> {
        match self {
            Name::Approach | Name::Observer | Name::Resolution | Name::Sweep => Some(Kinematics::Lathe),
            Name::Positioner => Some(Kinematics::Positioner),
            Name::Feed | Name::Profiles | Name::Surface => None,
        }
    }
}

#[derive(Clone, Debug, Args)]
pub(crate) struct ExperimentArgs {
    /// Which experiment.
    #[arg(value_enum)]
    name: Name,
    /// Print the rows as one JSON document, and nothing else.
    #[arg(long)]
    json: bool,
    /// Folder for `report.html` and `rows.json` [default: `experiments/NAME`].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Seed of everything random; nothing is in `feed` and `profiles`.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    #[command(flatten)]
    machine: MachineArgs,
}

/// What an experiment found: rows of type `R`, one a case.
struct Findings<R> {
    /// Heading of the page.
    title: &'static str,
    /// The result in a few sentences.
    short: Vec<String>,
    /// What was done, in paragraphs.
    done: Vec<String>,
    /// The content of the JSON document.
    rows: Vec<R>,
    /// What is shown of them on the screen and on the page.
    tables: Vec<Table>,
    /// Remarks on single rows, below the tables.
    notes: Vec<String>,
    figures: Vec<Figure>,
    /// What it means, after the pictures: headings with their paragraphs.
    text: Vec<(&'static str, Vec<String>)>,
}

/// The JSON document.
#[derive(Serialize)]
struct Document<'a, R> {
    experiment: &'a str,
    version: u32,
    seed: u64,
    rows: &'a [R],
}

/// Makes the experiment, writes its folder and prints what it found.
pub(crate) fn experiment(args: &ExperimentArgs, quiet: bool) -> Result<ExitCode, CliError> {
    let machine = machine(args)?;
    let stand = Stand { machine, seed: args.seed, progress: !quiet && !args.json };
    match args.name {
        Name::Approach => publish(args, &approach::findings(&stand)?),
        Name::Feed => publish(args, &feed::findings()?),
        Name::Observer => publish(args, &observer::findings(&stand)?),
        Name::Surface => publish(args, &surface::findings(&stand)?),
        Name::Sweep => publish(args, &sweep::findings(&stand)?),
        Name::Positioner => publish(args, &positioner::findings(&stand)?),
        Name::Profiles => publish(args, &profiles::findings()),
        Name::Resolution => publish(args, &resolution::findings(&stand)?),
    }
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

fn publish<R: Serialize>(args: &ExperimentArgs, found: &Findings<R>) -> Result<ExitCode, CliError> {
    let name = args.name.text();
    let document = Document { experiment: name, version: VERSION, seed: args.seed, rows: &found.rows };
    let json =
        serde_json::to_string_pretty(&document).map_err(|error| CliError::Machine(error.to_string()))?;
    let folder = args.out.clone().unwrap_or_else(|| Path::new("experiments").join(name));
    let page = folder.join("report.html");
    std::fs::create_dir_all(&folder).map_err(|error| CliError::file(&folder, error))?;
    for (path, content) in
        [(&page, page::html(name, &again(args), found)), (&folder.join("rows.json"), format!("{json}\n"))]
    {
        std::fs::write(path, content).map_err(|error| CliError::file(path, error))?;
    }
    if args.json {
        cli::print(&format!("{json}\n"));
    } else {
        cli::print(&screen(found));
        cli::print(&format!("report  {}\n", page.display()));
    }
    Ok(ExitCode::SUCCESS)
}

/// What a terminal shows: the tables that are for it, the notes, the result.
fn screen<R>(found: &Findings<R>) -> String {
    let shown = found.tables.iter().filter(|table| table.place == Place::Everywhere);
    let tables = shown.map(|table| format!("{}\n\n{}\n", table.title, table.text()));
    let paragraph = |lines: &[String]| {
        let lines: String = lines.iter().map(|line| format!("{line}\n")).collect();
        if lines.is_empty() { lines } else { lines + "\n" }
    };
    tables.collect::<String>() + &paragraph(&found.notes) + &paragraph(&found.short)
}
