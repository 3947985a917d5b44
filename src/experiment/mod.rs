//! `pitchlock experiment NAME`: a published experiment, made again with the code that moves the machine. In: its name.
//! Out: its rows as a table or as one JSON document, and a folder with `report.html` and `rows.json`.
//!
//! An experiment is a function that gives [`Findings`]: rows of its own type, and what is to be said and drawn of them.
//! What is done with findings is the same for all, and stands in this file.

mod feed;
mod page;
mod table;

use std::{
    path::{Path, PathBuf},
    process::ExitCode,
};

use clap::{Args, ValueEnum};
use serde::Serialize;

use crate::{cli, error::CliError, report::figures::Figure};
use table::Column;

pub(crate) const HELP: &str = "Examples:
  pitchlock experiment feed                  table, and pictures in experiments/feed/report.html
  pitchlock experiment feed --json           the rows as one JSON document
  pitchlock experiment feed --out smooth     the folder for report.html and rows.json

Exit status: 0 done, 2 an argument is wrong or the folder cannot be written.";

/// Version of the JSON document.
const VERSION: u32 = 1;

/// The experiments.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum Name {
    /// Feed with a smooth jerk: the examples of the published method with their figures put right, and whole blocks.
    Feed,
}

impl Name {
    fn text(self) -> &'static str {
        match self {
            Name::Feed => "feed",
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
    /// Seed of everything random; nothing is in `feed`.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
}

/// What an experiment found: rows of type `R`, one a case.
struct Findings<R: 'static> {
    /// Heading of the page.
    title: &'static str,
    rows: Vec<R>,
    columns: &'static [Column<R>],
    /// Remarks on single rows, printed below the table.
    notes: Vec<String>,
    /// What was done, and what the figures mean: headings with their paragraphs.
    text: Vec<(&'static str, Vec<String>)>,
    figures: Vec<Figure>,
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
pub(crate) fn experiment(args: &ExperimentArgs) -> Result<ExitCode, CliError> {
    match args.name {
        Name::Feed => publish(args, &feed::findings()?),
    }
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
        [(&page, page::html(name, found)), (&folder.join("rows.json"), format!("{json}\n"))]
    {
        std::fs::write(path, content).map_err(|error| CliError::file(path, error))?;
    }
    if args.json {
        cli::print(&format!("{json}\n"));
    } else {
        cli::print(&table::text(found.columns, &found.rows));
        let notes: String = found.notes.iter().map(|note| format!("{note}\n")).collect();
        cli::print(&format!("\n{notes}\nreport  {}\n", page.display()));
    }
    Ok(ExitCode::SUCCESS)
}
