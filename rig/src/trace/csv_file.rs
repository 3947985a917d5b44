//! A trace as comma-separated text. States are spelled by name; numbers in the shortest form that reads back
//! exactly.

use std::io::{Read, Write};
use std::path::Path;

use csv::StringRecord;
use protocol::{Axis, AxisState, Motion};

use super::Told;
use super::{
    columns::{axes_of, columns},
    row::{Cell, Cells, Row},
};

pub(super) struct Writer<W: Write> {
    out: csv::Writer<W>,
}

impl<W: Write> Writer<W> {
    pub(super) fn new(out: W, axes: &[Axis]) -> Told<Writer<W>> {
        let mut out = csv::WriterBuilder::new().buffer_capacity(1 << 20).from_writer(out);
        out.write_record(columns(axes))?;
        Ok(Writer { out })
    }

    pub(super) fn row(&mut self, row: &Row) -> Told<()> {
        let mut written = Ok(());
        row.cells(|cell| {
            let text = match cell {
                Cell::Count(count) => count.to_string(),
                Cell::Real(value) => format!("{value:?}"),
                Cell::State(state) => state.name().to_string(),
                Cell::Motion(motion) => motion.name().to_string(),
            };
            if written.is_ok() {
                written = self.out.write_field(text);
            }
        });
        written?;
        Ok(self.out.write_record(None::<&[u8]>)?)
    }

    pub(super) fn finish(self) -> Told<W> {
        Ok(self.out.into_inner().map_err(|error| error.into_error())?)
    }
}

/// Most bytes of a line: some thousand columns.
const LONGEST: usize = 1 << 16;

/// A file, up to a line that is too long to be one of a trace.
struct Lines<R> {
    file: R,
    /// Bytes since the last end of a line.
    since: usize,
}

impl<R: Read> Read for Lines<R> {
    fn read(&mut self, bytes: &mut [u8]) -> std::io::Result<usize> {
        let read = self.file.read(bytes)?;
        for line in bytes[..read].split_inclusive(|byte| *byte == b'\n') {
            self.since += line.len();
            if self.since > LONGEST {
                let text = format!("a line has more than {LONGEST} bytes: this is not a trace");
                return Err(std::io::Error::new(std::io::ErrorKind::InvalidData, text));
            }
            if line.ends_with(b"\n") {
                self.since = 0;
            }
        }
        Ok(read)
    }
}

pub(super) fn read(path: &Path, take: &mut impl FnMut(Row)) -> Told<()> {
    let mut file = csv::Reader::from_reader(Lines { file: intake::open(path)?, since: 0 });
    let names = file.headers()?.clone();
    let axes = axes_of(&names.iter().collect::<Vec<_>>())?;
    let mut record = StringRecord::new();
    while file.read_record(&mut record)? {
        let mut cells = Text { record: &record, names: &names, next: 0 };
        take(Row::from_cells(&axes, &mut cells)?);
    }
    Ok(())
}

/// The cells of one line.
struct Text<'a> {
    record: &'a StringRecord,
    names: &'a StringRecord,
    next: usize,
}

impl Text<'_> {
    fn cell<T>(&mut self, parse: impl FnOnce(&str) -> Option<T>) -> Result<T, String> {
        let index = self.next;
        self.next += 1;
        // The reader has refused lines that are longer or shorter than the header.
        let text = self.record.get(index).unwrap_or_default();
        parse(text).ok_or_else(|| {
            let line = self.record.position().map_or(0, |place| place.line());
            format!("line {line}, column {}: cannot read {text:?}", self.names.get(index).unwrap_or_default())
        })
    }
}

impl Cells for Text<'_> {
    type Error = String;

    fn count(&mut self) -> Result<i64, String> {
        self.cell(|text| text.parse().ok())
    }

    fn real(&mut self) -> Result<f64, String> {
        self.cell(|text| text.parse().ok())
    }

    fn state(&mut self) -> Result<AxisState, String> {
        self.cell(|text| AxisState::ALL.into_iter().find(|state| state.name() == text))
    }

    fn motion(&mut self) -> Result<Motion, String> {
        self.cell(|text| Motion::ALL.into_iter().find(|motion| motion.name() == text))
    }
}
