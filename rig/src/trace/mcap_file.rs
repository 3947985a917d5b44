//! A trace as MCAP: one channel, messages in little-endian CDR. Every field has eight bytes, so nothing needs
//! padding: a message is the four bytes that announce little-endian CDR, and then the cells one after the
//! other.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::io::{Read, Seek, Write};
use std::path::Path;

use mcap::{
    records::op,
    records::{MessageHeader, Record},
    sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions},
};
use protocol::{Axis, AxisState, Motion};

use super::Told;
use super::{
    columns::{axes_of, described},
    row::{Cell, Cells, Row},
};

/// Announces little-endian CDR without options.
const CDR: [u8; 4] = [0, 1, 0, 0];
const TOPIC: &str = "/cycle";
const SCHEMA: &str = "pitchlock/msg/Cycle";
/// Bytes of a chunk before compression: what a viewer unpacks to show one instant.
const CHUNK: u64 = 1 << 20;

pub(super) struct Writer<W: Write + Seek> {
    out: mcap::Writer<W>,
    channel_id: u16,
    message: Vec<u8>,
}

impl<W: Write + Seek> Writer<W> {
    pub(super) fn new(out: W, axes: &[Axis]) -> Told<Writer<W>> {
        let options = mcap::WriteOptions::new()
            .profile("ros2")
            .library("pitchlock")
            .chunk_size(Some(CHUNK))
            .compression_threads(0);
        let mut out = options.create(out)?;
        let schema_id = out.add_schema(SCHEMA, "ros2msg", schema(axes).as_bytes())?;
        let channel_id = out.add_channel(schema_id, TOPIC, "cdr", &BTreeMap::new())?;
        Ok(Writer { out, channel_id, message: Vec::new() })
    }

    pub(super) fn row(&mut self, row: &Row) -> Told<()> {
        self.message.clear();
        self.message.extend(CDR);
        row.cells(|cell| {
            self.message.extend(match cell {
                Cell::Count(count) => count.to_le_bytes(),
                Cell::Real(value) => value.to_le_bytes(),
                Cell::State(state) => i64::from(state as u32).to_le_bytes(),
                Cell::Motion(motion) => i64::from(motion as u32).to_le_bytes(),
            });
        });
        let time = (row.t_s * 1e9).round() as u64;
        let header = MessageHeader {
            channel_id: self.channel_id,
            sequence: row.cycle as u32,
            log_time: time,
            publish_time: time,
        };
        Ok(self.out.write_to_known_channel(&header, &self.message)?)
    }

    pub(super) fn finish(mut self) -> Told<W> {
        self.out.finish()?;
        Ok(self.out.into_inner())
    }
}

/// The fields with their units, and the codes of states and motion.
fn schema(axes: &[Axis]) -> String {
    let mut text = String::from("# One control cycle of pitchlock.\n");
    for state in AxisState::ALL {
        let name = state.name().to_ascii_uppercase().replace('-', "_");
        let _ = writeln!(text, "int64 STATE_{name}={}", state as u32);
    }
    for motion in Motion::ALL {
        let _ = writeln!(text, "int64 MOTION_{}={}", motion.name().to_ascii_uppercase(), motion as u32);
    }
    for (name, unit, real) in described(axes) {
        let kind = if real { "float64" } else { "int64" };
        let _ = writeln!(text, "{kind} {name}  # {unit}");
    }
    text
}

/// The names of the fields of a schema.
fn fields(schema: &str) -> Vec<&str> {
    let field = |line| str::split_whitespace(line).nth(1).filter(|name| !name.contains('='));
    schema.lines().filter(|line| !line.starts_with('#')).filter_map(field).collect()
}

/// Most bytes of a record: a schema of all axes has some ten thousand. A file may say that a record is as
/// long as it likes, and a compressed one can be.
const LONGEST: usize = 1 << 20;
/// What is read at once, bytes.
const BLOCK: usize = 1 << 16;

pub(super) fn read(path: &Path, take: &mut impl FnMut(Row)) -> Told<()> {
    let mut file = intake::open(path)?;
    let options =
        LinearReaderOptions::default().with_record_length_limit(LONGEST).with_validate_chunk_crcs(true);
    let mut reader = LinearReader::new_with_options(options);
    let mut columns = Columns::default();
    while let Some(event) = reader.next_event() {
        match event? {
            LinearReadEvent::ReadRequest(_) => {
                let read = file.read(reader.insert(BLOCK))?;
                reader.notify_read(read);
            }
            LinearReadEvent::Record { data, opcode } => {
                if !is_ours(opcode, data)? {
                    continue;
                }
                if let Some(row) = columns.record(mcap::parse_record(opcode, data)?)? {
                    take(row);
                }
            }
        }
    }
    Ok(())
}

/// Whether a record is one of those that a trace is read from; their texts have to lie within them, because
/// memory is taken for what they say they have.
fn is_ours(opcode: u8, data: &[u8]) -> Result<bool, &'static str> {
    let (fixed, texts) = match opcode {
        op::SCHEMA => (2, 3),
        op::CHANNEL => (4, 3),
        op::MESSAGE => (22, 0),
        _ => return Ok(false),
    };
    let mut rest = data.get(fixed..).ok_or(SHORT)?;
    let mut last: &[u8] = &[];
    for _ in 0..texts {
        (last, rest) = text(rest)?;
    }
    // The last of a channel is a list of texts.
    while opcode == op::CHANNEL && !last.is_empty() {
        (_, last) = text(last)?;
    }
    Ok(true)
}

const SHORT: &str = "a record of the trace is shorter than it says";

/// A text behind its length, and what follows it.
fn text(bytes: &[u8]) -> Result<(&[u8], &[u8]), &'static str> {
    let (length, rest) = bytes.split_first_chunk().ok_or(SHORT)?;
    rest.split_at_checked(u32::from_le_bytes(*length) as usize).ok_or(SHORT)
}

/// What a trace says of its columns, before its rows.
#[derive(Default)]
struct Columns {
    /// Schemas by their number, at most one.
    schema: Option<(u16, Vec<Axis>)>,
    channel: Option<u16>,
}

impl Columns {
    /// Takes a record; gives the row, if it is one.
    fn record(&mut self, record: Record) -> Told<Option<Row>> {
        match record {
            Record::Schema { header, data } if header.name == SCHEMA && self.schema.is_none() => {
                self.schema = Some((header.id, axes_of(&fields(std::str::from_utf8(&data)?))?));
            }
            Record::Channel(channel) if channel.topic == TOPIC => {
                if self.schema.as_ref().is_none_or(|(id, _)| *id != channel.schema_id) {
                    return Err("the trace has no schema".into());
                }
                self.channel = Some(channel.id);
            }
            Record::Message { header, data } if self.channel == Some(header.channel_id) => {
                let (_, axes) = self.schema.as_ref().ok_or("the trace has no schema")?;
                let cells = data.strip_prefix(&CDR).ok_or("the trace is not little-endian CDR")?;
                return Ok(Some(Row::from_cells(axes, &mut Bytes(cells))?));
            }
            _ => {}
        }
        Ok(None)
    }
}

/// The cells of one message.
struct Bytes<'a>(&'a [u8]);

impl Bytes<'_> {
    fn cell(&mut self) -> Result<[u8; 8], &'static str> {
        let (cell, rest) = self.0.split_first_chunk().ok_or("a message of the trace is too short")?;
        self.0 = rest;
        Ok(*cell)
    }
}

impl Cells for Bytes<'_> {
    type Error = &'static str;

    fn count(&mut self) -> Result<i64, &'static str> {
        self.cell().map(i64::from_le_bytes)
    }

    fn real(&mut self) -> Result<f64, &'static str> {
        self.cell().map(f64::from_le_bytes)
    }

    fn state(&mut self) -> Result<AxisState, &'static str> {
        let code = u32::try_from(self.count()?).map_err(|_| "a message holds an unknown state")?;
        AxisState::from_code(code).map_err(|_| "a message holds an unknown state")
    }

    fn motion(&mut self) -> Result<Motion, &'static str> {
        let code = u32::try_from(self.count()?).map_err(|_| "a message holds an unknown motion")?;
        Motion::from_code(code).map_err(|_| "a message holds an unknown motion")
    }
}
