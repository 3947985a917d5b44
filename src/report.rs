//! `pitchlock report`: the page of a run is drawn again from its folder.

use std::{path::PathBuf, process::ExitCode};

use clap::Args;

use crate::{error::CliError, screen};

#[derive(Clone, Debug, Args)]
pub(crate) struct ReportArgs {
    /// A run folder.
    pub(crate) run_dir: PathBuf,
}

/// Draws `report.html` of a run folder, and prints its path.
pub(crate) fn report(args: &ReportArgs) -> Result<ExitCode, CliError> {
    let path = report::render(&args.run_dir)?;
    screen::print(&format!("{}\n", path.display()));
    Ok(ExitCode::SUCCESS)
}
