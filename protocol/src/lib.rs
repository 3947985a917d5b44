//! Everything that crosses a process boundary of pitchlock: units, machine code, axis commands, measurements,
//! drive commands, status, the machine file and the `.mc` file. The channels that carry them are in `process`.
//!
//! Wire types are plain data: `#[repr(C)]`, no padding, no pointers, integers where Rust would have an enum. What
//! arrives is therefore always *some* value; a `check` turns it into something to rely on, or says why not.

pub mod arc;
pub mod code;
pub mod code_file;
pub mod code_packet;
pub mod drive;
pub mod frame;
pub mod groove;
pub mod kinematics;
pub mod machine;
pub mod measurement;
pub mod message;
pub mod operator;
pub mod pass;
pub mod route;
pub mod status;
pub mod trace;
pub mod tracer;
pub mod track;
pub mod truth;
pub mod units;

pub use arc::{Arc, Plane};
pub use code::{Code, Feed, Item, PathMode, SpindleMode, SpindleSpeed};
pub use code_packet::{CodePacket, Credit};
pub use drive::{ControlWord, DriveCommand, DriveState, StatusWord};
pub use frame::{AxisCommand, AxisFrame, Setpoint};
pub use groove::Groove;
pub use machine::Machine;
pub use measurement::{AxisMeasurement, Measurement, Panel};
pub use message::Message;
pub use operator::{OperatorRequest, Request};
pub use pass::{AxisLaw, ThreadPass};
pub use route::{Cut, Leg, Route, Routed, Stretch};
pub use status::{AxisState, AxisStatus, Fault, MachineState, MachineStatus, SpindleCommand};
pub use trace::{FORMULAS, Trace, Work};
pub use tracer::{Traced, Tracer, Untraceable};
pub use track::Spot;
pub use truth::{AxisTruth, CutTruth, Truth};
pub use units::{Axis, Cycle, PerAxis, Position};

/// Why a packet was refused. The receiver counts it, says so, and changes nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Refused {
    /// A number is NaN or infinite.
    #[error("{0} is not a finite number")]
    NotFinite(&'static str),
    /// A number is outside what the field allows.
    #[error("{0} is out of range")]
    OutOfRange(&'static str),
    /// A code stands for nothing this version knows.
    #[error("{0} holds an unknown code {1}")]
    UnknownCode(&'static str, u32),
    /// A message is missing, doubled, or out of order.
    #[error("{0}: expected number {1}, got {2}")]
    OutOfOrder(&'static str, u64, u64),
    /// The packet came after the cycle in which it should have acted.
    #[error("the packet came too late")]
    TooLate,
}

/// Refuses a value that is not finite.
pub(crate) fn finite(value: f64, name: &'static str) -> Result<f64, Refused> {
    if value.is_finite() { Ok(value) } else { Err(Refused::NotFinite(name)) }
}
