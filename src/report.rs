//! `pitchlock report`: the page of a run is drawn again from its folder.

use std::{path::PathBuf, process::ExitCode};

use clap::Args;
use rig::observe::Summary;

use crate::{
    error::CliError,
    run::{
        JOURNAL,
        claim::{SUMMARY, is_claimed},
        folder::without_summary,
    },
    screen,
    words::{self, Phase},
    written::{self, Made},
};

/// What a page costs time for, as it is shown.
pub(crate) const DRAWING: &str = "drawing the report";

#[derive(Clone, Debug, Args)]
pub(crate) struct ReportArgs {
    /// A run folder.
    pub(crate) run_dir: PathBuf,
}

/// Draws `report.html` of a run folder, and prints its path.
pub(crate) fn report(args: &ReportArgs) -> Result<ExitCode, CliError> {
    let is_of_a_run = is_claimed(&args.run_dir) || args.run_dir.join(JOURNAL).exists();
    if !args.run_dir.join(SUMMARY).exists() && is_of_a_run {
        return Err(without_summary(&args.run_dir, String::new()));
    }
    written::free(&args.run_dir.join("report.html"), Made::Page)?;
    let drawing = Phase::begin(DRAWING);
    let path = report::render(&args.run_dir)?;
    drop(drawing);
    let summary = Summary::read(&args.run_dir.join(SUMMARY)).ok();
    if let Some(damage) = summary.and_then(|summary| report::damage(&args.run_dir, &summary)) {
        words::say(&format!("warning: {damage} The figures of the page are those of the run.\n"));
    }
    screen::print(&format!("{}\n", path.display()));
    Ok(ExitCode::SUCCESS)
}
