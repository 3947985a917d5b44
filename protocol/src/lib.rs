//! Everything that crosses a process boundary of pitchlock: units, machine code, axis commands, measurements,
//! drive commands, status, the machine file and the `.mc` file. The channels that carry them are in
//! `process`.
//!
//! Wire types are plain data: `#[repr(C)]`, no padding, no pointers, integers where Rust would have an enum.
//! What arrives is therefore always *some* value; a `check` turns it into something to rely on, or says why
//! not.

pub mod arc;
pub mod arrival;
mod checksum;
pub mod code;
pub mod code_file;
pub mod code_packet;
pub mod curve;
pub mod drive;
pub mod fault;
pub mod frame;
pub mod groove;
pub mod measurement;
pub mod message;
pub mod module;
pub mod operator;
pub mod pass;
pub mod refused;
mod seal;
pub mod status;
pub mod truth;
pub mod units;
pub mod variation;
pub mod work;

pub use arc::{Arc, Plane};
pub use arrival::{Arrival, Differs, Input, Taken};
pub use code::{
    ANALOG_OUTPUTS, ByHand, Code, Feed, INPUTS, Item, OUTPUTS, PathMode, Set, SpindleMode, SpindleSpeed,
    Until,
};
pub use code_packet::{CodePacket, Credit};
pub use curve::Curve;
pub use drive::{ControlWord, DriveCommand, DriveState, StatusWord};
pub use fault::{FAULTS, Fault, FaultRow, Span, Within};
pub use frame::{AxisCommand, AxisFrame, Setpoint};
pub use groove::Groove;
pub use measurement::{AxisMeasurement, AxisReference, Measurement, Panel};
pub use message::{Message, Payload};
pub use module::{Doom, Module};
pub use operator::{OperatorRequest, Request};
pub use pass::{AxisLaw, Changes, Corner, Corners, LeadChange, Returning, ThreadPass, WayOut};
pub use refused::Refused;
pub use status::{AxisState, AxisStatus, MachineState, MachineStatus, Motion, SpindleCommand};
pub use truth::{AxisTruth, CutTruth, Truth};
pub use units::{Axis, Cycle, PerAxis, Position};
pub use variation::{Variation, VariationShape};
pub use work::{FORMULAS, Shape, Work};
