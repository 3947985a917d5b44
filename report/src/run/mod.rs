//! The report of a run: one page, `report.html`, that opens without a network, reads well on a phone and on
//! paper. In: a run folder (`summary.json`, the trace, the program). Out: `report.html` in the same folder.

mod by_pass;
mod curves;
mod curves_moves;
mod cutting;
mod dial;
mod error_map;
mod figures;
mod figures_cutting;
mod figures_moves;
mod figures_pass;
mod figures_traces;
mod gauge;
mod mill;
mod page;
mod part;
mod passes;
mod path;
mod real_time;
mod references;
mod signals;
mod taps;
#[cfg(test)]
mod tests;
mod tools;
mod traces;
mod verdict;

use std::path::{Path, PathBuf};

use maud::Markup;
use protocol::code_file::CodeFile;
use rig::observe::{Summary, SummaryError};
use rig::trace;

use crate::paint::Figure;
use crate::table::Table;
use curves::Curves;

/// Why a report could not be drawn.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// The summary cannot be read: is this a run folder?
    #[error("{0}; a run folder is what `pitchlock run` writes")]
    Summary(#[from] SummaryError),
    /// What has the name of the trace is no file.
    #[error("{path}: {reason}")]
    Trace {
        /// Its name.
        path: String,
        /// What it is instead.
        reason: std::io::Error,
    },
    /// The report cannot be written.
    #[error("{path}: {reason}")]
    Write {
        /// The file.
        path: String,
        /// What the system says.
        reason: std::io::Error,
    },
}

/// Everything that a page shows.
struct Run {
    summary: Summary,
    drawn: Drawn,
    program: Option<String>,
}

/// What comes of the trace.
#[derive(Default)]
struct Drawn {
    figures: Vec<Figure>,
    /// The part that a lathe leaves, or a mill.
    part: Option<Figure>,
    solid: Option<Markup>,
    /// What each pass took out of a groove, and what each tool took.
    tables: Vec<Table>,
    /// What is to be said of the trace, if it is missing or damaged.
    note: Option<String>,
}

/// Draws `report.html` into a run folder and gives its path. A run without a trace, or with a damaged one, is
/// drawn as far as it goes, and the page says so.
///
/// # Errors
/// [`ReportError`] names the file.
pub fn render(run_dir: &Path) -> Result<PathBuf, ReportError> {
    let summary = Summary::read(&run_dir.join("summary.json"))?;
    if let Some(path) = trace::find(run_dir) {
        let refused = |reason| ReportError::Trace { path: path.display().to_string(), reason };
        intake::open(&path).map_err(refused)?;
    }
    let program = Path::new(&summary.program).file_name().map(|name| run_dir.join(name));
    // Machine code is nothing to read.
    let program = program
        .filter(|path| !CodeFile::is_named(path))
        .and_then(|path| intake::bytes(&path, intake::SHOWN).ok())
        .map(|bytes| gcode::readable(&bytes));
    let drawn = draw(run_dir, &summary, program.as_deref());
    let page = page::html(&Run { summary, drawn, program });
    let path = run_dir.join("report.html");
    match intake::replace(&path, page.as_bytes()) {
        Ok(()) => Ok(path),
        Err(reason) => Err(ReportError::Write { path: path.display().to_string(), reason }),
    }
}

/// What is wrong with the trace of a run, if anything: it was swapped in, is not whole any more, or has gone.
#[must_use]
pub fn damage(run_dir: &Path, summary: &Summary) -> Option<&'static str> {
    let own = summary.trace_file_hash.as_ref()?;
    match trace::find(run_dir) {
        None => {
            Some("The trace that this run has written is not in its folder any more, so it is not drawn.")
        }
        // One that cannot be read at all is told where it is read.
        Some(path) => trace::hash_of(&path).is_ok_and(|hash| *own != hash).then_some(
            "The trace in this folder is not the one that this run has written, so it is not drawn.",
        ),
    }
}

fn draw(run_dir: &Path, summary: &Summary, program: Option<&str>) -> Drawn {
    if let Some(note) = damage(run_dir, summary) {
        return Drawn { note: Some(note.into()), ..Drawn::default() };
    }
    let Some(path) = trace::find(run_dir) else {
        let note = "The run was made without a trace, so there is nothing to draw.";
        return Drawn { note: Some(note.into()), ..Drawn::default() };
    };
    let mut curves = Curves::new(summary);
    let mut way = mill::Way::new(summary);
    let read = trace::read(&path, |row| {
        curves.add(summary, &row);
        if let Some(way) = &mut way {
            way.add(&row);
        }
    });
    Drawn {
        figures: figures::all(summary, &curves),
        part: part::whole(summary, &curves),
        tables: [part::table(summary, &curves), curves.tools.table()].into_iter().flatten().collect(),
        solid: way.and_then(|way| mill::part(summary, &way, program)),
        note: read.err().map(|error| format!("The trace ends early, and so do the pictures: {error}.")),
    }
}
