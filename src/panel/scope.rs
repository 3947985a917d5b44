//! What goes to the scope, and into a file again. In: control cycles. Out: rows for the ring of the panel,
//! every one of them as long as the panel takes them; files.

use ::panel::{Link, ToPanel};
use machine::Machine;
use protocol::Axis;
use rig::{
    observe::{Observer, Record},
    trace::{self, Format, Row},
};

/// What the ring holds of a machine, in seconds of its own time.
const KEPT: f64 = 60.0;
/// Rows go in lots of so many.
pub(super) const LOT: usize = 16;

/// Rows on their way.
#[derive(Debug, Default)]
pub(super) struct Rows {
    pub(super) axes: Vec<Axis>,
    pub(super) cycle_s: f64,
    pub(super) most: usize,
    pub(super) lot: Vec<f64>,
    pub(super) taken: usize,
}

impl Rows {
    /// Those of a machine.
    pub(super) fn of(machine: &Machine) -> Rows {
        let cycle_s = machine.general.cycle_s;
        let most = (KEPT / cycle_s).ceil() as usize;
        Rows { axes: machine.axes().map(|(axis, _)| axis).collect(), cycle_s, most, ..Rows::default() }
    }

    /// What the panel has to know of them before.
    pub(super) fn head(&self) -> ToPanel {
        ToPanel::Scope { columns: trace::columns(&self.axes), cycle_s: self.cycle_s, most: self.most }
    }

    /// What is seen of them: names and units.
    pub(super) fn signals(&self) -> Vec<(String, &'static str)> {
        trace::columns(&self.axes).into_iter().zip(trace::units(&self.axes)).collect()
    }

    /// A control cycle. Whether a lot is together.
    pub(super) fn cycle(&mut self, record: &Record, observer: &Observer) -> bool {
        self.take(&Row::of(record, observer, self.cycle_s));
        self.taken == LOT || record.truth.measurement.last != 0
    }

    /// Sends what has come together. Nobody has it where there is no link, or where a panel that does not
    /// read leaves no room.
    pub(super) fn send(&mut self, link: Option<&mut Link>) {
        if let Some(link) = link {
            link.rows(&self.lot);
        }
        self.lot.clear();
        self.taken = 0;
    }

    pub(super) fn take(&mut self, row: &Row) {
        row.numbers(|number| self.lot.push(number));
        self.taken += 1;
    }
}

/// Makes a file of rows of the scope.
pub(super) fn saved(kind: &str, columns: &[String], numbers: &[f64]) -> Result<Vec<u8>, String> {
    let names: Vec<_> = columns.iter().map(String::as_str).collect();
    let axes = trace::axes_of(&names)?;
    let format = if kind == "csv" { Format::Csv } else { Format::Mcap };
    let rows = numbers.chunks_exact(columns.len().max(1)).map(|row| Row::from_numbers(&axes, row));
    let rows = rows.collect::<Result<Vec<_>, _>>()?;
    trace::bytes(format, &axes, rows.into_iter()).map_err(|error| error.to_string())
}
