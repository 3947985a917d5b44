//! What the formats share: the buffer that their lines go through, and the calls that look the same in all of
//! them.

use std::io::{self, Write};

use super::{Call, Plane, Turn, Units, decimal};
use crate::problem::{Blame, Problem};

/// Bytes that are written at once.
const CHUNK: usize = 64 * 1024;

/// A buffered writer of lines. The first error of the file below is kept; nothing is written after it.
pub(super) struct Lines<W: Write> {
    file: W,
    buffer: Vec<u8>,
    failure: Option<io::Error>,
}

impl<W: Write> Lines<W> {
    pub(super) fn new(file: W) -> Lines<W> {
        // Room for a whole line beyond the chunk, so that the buffer hardly ever grows.
        Lines { file, buffer: Vec::with_capacity(CHUNK + 4096), failure: None }
    }

    pub(super) fn text(&mut self, text: &str) {
        self.buffer.extend_from_slice(text.as_bytes());
    }

    pub(super) fn bytes(&mut self, bytes: &[u8]) {
        self.buffer.extend_from_slice(bytes);
    }

    pub(super) fn integer(&mut self, value: impl Into<i64>) {
        decimal::integer(&mut self.buffer, value.into());
    }

    pub(super) fn four(&mut self, value: f64) {
        decimal::four(&mut self.buffer, value);
    }

    pub(super) fn six(&mut self, value: f64) {
        decimal::six(&mut self.buffer, value);
    }

    /// Numbers with four decimals and `between` between them.
    pub(super) fn fours(&mut self, values: &[f64], between: &str) {
        for (n, value) in values.iter().enumerate() {
            if n > 0 {
                self.text(between);
            }
            self.four(*value);
        }
    }

    /// `NAME("text")`.
    pub(super) fn quoted(&mut self, name: &str, text: &str) {
        for part in [name, "(\"", text, "\")"] {
            self.text(part);
        }
    }

    /// A call that [`bare`] or [`one_word`] knows; `false` if it is another one.
    pub(super) fn simple(&mut self, call: &Call<'_>) -> bool {
        if let Some(name) = bare(call) {
            self.text(name);
            self.text("()");
            return true;
        }
        let Some((name, word)) = one_word(call) else { return false };
        self.text(name);
        self.text("(");
        match word {
            Word::Text(text) => self.text(text),
            Word::Number(number) => self.integer(number),
        }
        self.text(")");
        true
    }

    /// Ends the line, and writes the buffer if it is full.
    pub(super) fn end(&mut self) -> Result<(), Box<Problem>> {
        self.buffer.push(b'\n');
        if self.buffer.len() < CHUNK {
            return Ok(());
        }
        self.write_out();
        match &self.failure {
            None => Ok(()),
            Some(error) => Err(Problem::error(
                "output",
                Blame::Block,
                format!("the output cannot be written: {error}"),
                "make room, or write to another place",
            )),
        }
    }

    /// Writes what is left.
    pub(super) fn flush(&mut self) -> io::Result<()> {
        self.write_out();
        match self.failure.take() {
            Some(error) => Err(error),
            None => self.file.flush(),
        }
    }

    fn write_out(&mut self) {
        if self.failure.is_none() {
            self.failure = self.file.write_all(&self.buffer).err();
        }
        self.buffer.clear();
    }
}

/// The name of a call that has no arguments and is the same in every format.
fn bare(call: &Call<'_>) -> Option<&'static str> {
    Some(match call {
        Call::StopSpeedFeedSynch => "STOP_SPEED_FEED_SYNCH",
        Call::MistOn => "MIST_ON",
        Call::MistOff => "MIST_OFF",
        Call::FloodOn => "FLOOD_ON",
        Call::FloodOff => "FLOOD_OFF",
        Call::EnableFeedOverride(true) => "ENABLE_FEED_OVERRIDE",
        Call::EnableFeedOverride(false) => "DISABLE_FEED_OVERRIDE",
        Call::EnableAdaptiveFeed(true) => "ENABLE_ADAPTIVE_FEED",
        Call::EnableAdaptiveFeed(false) => "DISABLE_ADAPTIVE_FEED",
        Call::EnableFeedHold(true) => "ENABLE_FEED_HOLD",
        Call::EnableFeedHold(false) => "DISABLE_FEED_HOLD",
        Call::ProgramStop => "PROGRAM_STOP",
        Call::OptionalProgramStop => "OPTIONAL_PROGRAM_STOP",
        Call::PalletShuttle => "PALLET_SHUTTLE",
        Call::ProgramEnd => "PROGRAM_END",
        Call::OnReset => "ON_RESET",
        Call::Finish => "FINISH",
        _ => return None,
    })
}

/// A call whose one argument is a word or a whole number: its name and the argument.
fn one_word(call: &Call<'_>) -> Option<(&'static str, Word)> {
    Some(match call {
        Call::UseLengthUnits(Units::Millimetre) => ("USE_LENGTH_UNITS", Word::Text("CANON_UNITS_MM")),
        Call::UseLengthUnits(Units::Inch) => ("USE_LENGTH_UNITS", Word::Text("CANON_UNITS_INCHES")),
        Call::SetFeedReference => ("SET_FEED_REFERENCE", Word::Text("CANON_XYZ")),
        Call::SelectPlane(Plane::Xy) => ("SELECT_PLANE", Word::Text("CANON_PLANE_XY")),
        Call::SelectPlane(Plane::Xz) => ("SELECT_PLANE", Word::Text("CANON_PLANE_XZ")),
        Call::SelectPlane(Plane::Yz) => ("SELECT_PLANE", Word::Text("CANON_PLANE_YZ")),
        Call::StartSpindle(Turn::Clockwise) => ("START_SPINDLE_CLOCKWISE", Word::Number(0)),
        Call::StartSpindle(Turn::Counterclockwise) => ("START_SPINDLE_COUNTERCLOCKWISE", Word::Number(0)),
        Call::StopSpindle => ("STOP_SPINDLE_TURNING", Word::Number(0)),
        Call::SelectTool(tool) => ("SELECT_TOOL", Word::Number((*tool).into())),
        Call::ChangeToolNumber(tool) => ("CHANGE_TOOL_NUMBER", Word::Number((*tool).into())),
        Call::EnableSpeedOverride(true) => ("ENABLE_SPEED_OVERRIDE", Word::Number(0)),
        Call::EnableSpeedOverride(false) => ("DISABLE_SPEED_OVERRIDE", Word::Number(0)),
        Call::SetMotionOutputBit(index, true) => ("SET_MOTION_OUTPUT_BIT", Word::Number((*index).into())),
        Call::SetMotionOutputBit(index, false) => ("CLEAR_MOTION_OUTPUT_BIT", Word::Number((*index).into())),
        Call::SetAuxOutputBit(index, true) => ("SET_AUX_OUTPUT_BIT", Word::Number((*index).into())),
        Call::SetAuxOutputBit(index, false) => ("CLEAR_AUX_OUTPUT_BIT", Word::Number((*index).into())),
        _ => return None,
    })
}

/// An argument.
enum Word {
    Text(&'static str),
    Number(i64),
}
