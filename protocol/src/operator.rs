//! What the operator asks for from outside, as the launcher passes it on. The plant puts it onto the panel of
//! its next measurement; from there it has a cycle, and the same run can be repeated.

use zerocopy::{FromBytes, Immutable, IntoBytes};

use crate::{
    message::Message,
    refused::{Refused, finite},
};

/// Something the operator does at the panel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Request {
    /// Turn the spindle override to this many per cent, 0 to 200.
    SpindleOverride(f64),
    /// Turn the feed override to this many per cent, 0 to 200.
    FeedOverride(f64),
    /// Turn the rapid override to this many per cent, 0 to 100.
    RapidOverride(f64),
    /// Feed hold.
    FeedHold,
    /// Cycle start: leave feed hold, or go on after a pause of the program.
    CycleStart,
    /// Stop on the path and end the program; a thread is left, or cut to its end first.
    Stop,
    /// Wait for cycle start after each block, or no longer.
    SingleBlock(bool),
    /// End the program at once: stop on the path, spindle and coolant off.
    Abort,
    /// Emergency stop, stop category 1. It stays pressed.
    EmergencyStop,
    /// The jog key: pressed, or confirmed where it is pressed already; or let go.
    Jog(bool),
    /// Wait at M1, or no longer. A machine begins with waiting.
    OptionalStop(bool),
    /// Another block by hand is there, and begins when the machine waits for one.
    Block,
}

/// A [`Request`] on the wire.
#[derive(Clone, Copy, Debug, Default, PartialEq, IntoBytes, FromBytes, Immutable)]
#[repr(C)]
pub struct OperatorRequest {
    /// Running number, from 0.
    pub sequence: u64,
    /// Code of the [`Request`].
    pub kind: u32,
    /// Zero.
    pub reserved: u32,
    /// Per cent; 1 or 0 of a switch; else 0.
    pub value: f64,
}

impl Message for OperatorRequest {
    const NAME: &str = "pitchlock/operator-request/2";
}

impl OperatorRequest {
    /// Puts a request on the wire.
    pub fn pack(sequence: u64, request: Request) -> OperatorRequest {
        let (kind, value) = match request {
            Request::SpindleOverride(pct) => (1, pct),
            Request::FeedOverride(pct) => (2, pct),
            Request::RapidOverride(pct) => (3, pct),
            Request::FeedHold => (4, 0.0),
            Request::CycleStart => (5, 0.0),
            Request::Stop => (6, 0.0),
            Request::SingleBlock(on) => (7, f64::from(u8::from(on))),
            Request::Abort => (8, 0.0),
            Request::EmergencyStop => (9, 0.0),
            Request::Jog(on) => (10, f64::from(u8::from(on))),
            Request::Block => (11, 0.0),
            Request::OptionalStop(on) => (12, f64::from(u8::from(on))),
        };
        OperatorRequest { sequence, kind, reserved: 0, value }
    }

    /// Takes a request off the wire.
    ///
    /// # Errors
    /// An unknown code, or an override that no panel has.
    pub fn unpack(&self) -> Result<Request, Refused> {
        let percent = |highest: f64| match finite(self.value, "override")? {
            pct if (0.0..=highest).contains(&pct) => Ok(pct),
            _ => Err(Refused::OutOfRange("override")),
        };
        Ok(match self.kind {
            1 => Request::SpindleOverride(percent(200.0)?),
            2 => Request::FeedOverride(percent(200.0)?),
            3 => Request::RapidOverride(percent(100.0)?),
            4 => Request::FeedHold,
            5 => Request::CycleStart,
            6 => Request::Stop,
            7 => Request::SingleBlock(self.value != 0.0),
            8 => Request::Abort,
            9 => Request::EmergencyStop,
            10 => Request::Jog(self.value != 0.0),
            11 => Request::Block,
            12 => Request::OptionalStop(self.value != 0.0),
            other => return Err(Refused::UnknownCode { field: "operator request", code: other }),
        })
    }
}
