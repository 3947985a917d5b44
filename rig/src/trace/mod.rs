//! What happened in control cycles: one [`Row`] a cycle, of all of them or of those that matter in a long
//! run, written as MCAP or CSV, and read back from either.
//!
//! An MCAP trace opens in Foxglove and PlotJuggler: one channel `/cycle`, messages in CDR with a `ros2msg`
//! schema (every field eight bytes, so a cycle costs a fraction of what JSON would), chunks compressed with
//! zstd. A CSV trace opens everywhere. Columns are the same in both, see [`columns`]; positions in mm.

mod columns;
mod csv_file;
mod mcap_file;
mod row;
#[cfg(test)]
mod tests;
mod thin;

use std::{
    fs::File,
    io::{BufWriter, Cursor, Seek, Write},
    path::{Path, PathBuf},
};

use protocol::Axis;

use crate::hash;
use thin::Thin;

pub use columns::{axes_of, columns, units};
pub use row::{AxisRow, CutRow, Row};
pub use thin::{FULL, STRIDE};

/// How a trace is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Compressed binary, for Foxglove and PlotJuggler.
    Mcap,
    /// Comma-separated text with a header.
    Csv,
}

impl Format {
    /// The name of the trace in a run folder.
    pub fn file_name(self) -> &'static str {
        match self {
            Format::Mcap => "trace.mcap",
            Format::Csv => "trace.csv",
        }
    }
}

/// A trace that could not be written or read.
#[derive(Debug, thiserror::Error)]
#[error("{path}: {reason}")]
pub struct TraceError {
    path: String,
    reason: String,
}

impl TraceError {
    fn new(path: &Path, reason: Box<dyn std::error::Error>) -> TraceError {
        // The innermost cause says what to do: the disk is full.
        let cause = std::iter::successors(reason.source(), |cause| cause.source()).last();
        let reason = cause.map_or_else(|| reason.to_string(), |cause| format!("{reason}: {cause}"));
        TraceError { path: path.display().to_string(), reason }
    }
}

enum Writer<W: Write + Seek> {
    Mcap(Box<mcap_file::Writer<W>>),
    Csv(Box<csv_file::Writer<W>>),
}

impl<W: Write + Seek> Writer<W> {
    fn new(out: W, format: Format, axes: &[Axis]) -> Told<Writer<W>> {
        Ok(match format {
            Format::Mcap => Writer::Mcap(Box::new(mcap_file::Writer::new(out, axes)?)),
            Format::Csv => Writer::Csv(Box::new(csv_file::Writer::new(out, axes)?)),
        })
    }

    fn finish(self) -> Told<W> {
        match self {
            Writer::Mcap(writer) => writer.finish(),
            Writer::Csv(writer) => writer.finish(),
        }
    }

    fn row(&mut self, row: &Row) -> Told<()> {
        match self {
            Writer::Mcap(writer) => writer.row(row),
            Writer::Csv(writer) => writer.row(row),
        }
    }
}

/// Writes a trace, row by row.
pub struct TraceWriter {
    path: PathBuf,
    writer: Writer<BufWriter<File>>,
    thin: Option<Thin>,
}

impl TraceWriter {
    /// Creates the trace of a machine with these axes in the order of the wire; a file of that name is
    /// replaced.
    ///
    /// # Errors
    /// Names the file and why it cannot be written.
    pub fn create(path: &Path, format: Format, axes: &[Axis]) -> Result<TraceWriter, TraceError> {
        let file = File::create(path).map_err(|error| TraceError::new(path, error.into()))?;
        let writer = Writer::new(BufWriter::new(file), format, axes);
        let writer = writer.map_err(|error| TraceError::new(path, error))?;
        Ok(TraceWriter { path: path.into(), writer, thin: None })
    }

    /// The same, but of a long run only some cycles are kept: see [`FULL`] and [`STRIDE`].
    pub fn thinned(self) -> TraceWriter {
        TraceWriter { thin: Some(Thin::default()), ..self }
    }

    /// Writes a row, with the axes that the trace was created for.
    ///
    /// # Errors
    /// Names the file and why it cannot be written.
    pub fn row(&mut self, row: &Row) -> Result<(), TraceError> {
        let writer = &mut self.writer;
        let written = match &mut self.thin {
            Some(thin) => thin.row(row, |row| writer.row(row)),
            None => writer.row(row),
        };
        written.map_err(|error| TraceError::new(&self.path, error))
    }

    /// Completes the file. A trace that is dropped instead may lack its end.
    ///
    /// # Errors
    /// Names the file and why it cannot be written.
    pub fn finish(self) -> Result<(), TraceError> {
        let TraceWriter { path, mut writer, thin } = self;
        let written = thin.map_or(Ok(()), |mut thin| thin.finish(|row| writer.row(row)));
        let written = written.and_then(|()| Ok(writer.finish()?.into_inner()?));
        written.map(drop).map_err(|error| TraceError::new(&path, error))
    }
}

/// The bytes of a trace of these rows.
///
/// # Errors
/// A row cannot be written.
pub fn bytes(format: Format, axes: &[Axis], rows: impl Iterator<Item = Row>) -> Result<Vec<u8>, TraceError> {
    let write = || -> Told<Vec<u8>> {
        let mut writer = Writer::new(Cursor::new(Vec::new()), format, axes)?;
        for row in rows {
            writer.row(&row)?;
        }
        Ok(writer.finish()?.into_inner())
    };
    write().map_err(|error| TraceError::new(Path::new(format.file_name()), error))
}

/// BLAKE3 of the file of a trace, in hex.
///
/// # Errors
/// Names the file and why it cannot be read.
pub fn hash_of(path: &Path) -> Result<String, TraceError> {
    hash::hex_of_file(path).map_err(|error| TraceError::new(path, error.into()))
}

/// What a module of this folder says of a file; the path is added here.
type Told<T> = Result<T, Box<dyn std::error::Error>>;

/// Finds the trace in a run folder; `None` if the run was made without one.
pub fn find(run_dir: &Path) -> Option<PathBuf> {
    [Format::Mcap, Format::Csv]
        .map(|format| run_dir.join(format.file_name()))
        .into_iter()
        .find(|path| path.exists())
}

/// Reads a trace, MCAP or CSV by the ending of its name, and hands every row to `take` in order.
///
/// # Errors
/// Names the file, and the row or column that is wrong.
pub fn read(path: &Path, mut take: impl FnMut(Row)) -> Result<(), TraceError> {
    let csv = path.extension().is_some_and(|ending| ending == "csv");
    let read = if csv { csv_file::read(path, &mut take) } else { mcap_file::read(path, &mut take) };
    read.map_err(|error| TraceError::new(path, error))
}
