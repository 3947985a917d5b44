//! Machine code on the wire: an [`Item`] as the interpreter sends it, and the credit that it sends by. In: items. Out:
//! packets, and back; what no interpreter sends is refused.

use shape::Formula;
use zerocopy::{FromBytes, Immutable, IntoBytes};

use crate::{
    arc::{Arc, Plane},
    code::{Code, Feed, Item, PathMode, SpindleMode, SpindleSpeed},
    message::Message,
    pass::ThreadPass,
    refused::Refused,
    status::MachineStatus,
    units::{PerAxis, Position},
};

/// An [`Item`] in shared memory. Fields that its kind does not use are zero.
#[derive(Clone, Copy, Debug, Default, PartialEq, IntoBytes, FromBytes, Immutable)]
#[repr(C)]
pub struct CodePacket {
    /// Running number of the item in the program, from 0: the receiver refuses a gap.
    pub sequence: u64,
    /// Line of the part program.
    pub line: u32,
    /// Kind of item, see [`CodePacket::unpack`].
    pub kind: u32,
    /// Tool number, number of a formula, spindle mode, path mode, kind of feed, or sum of [`MachineStatus::MIST`] and
    /// [`MachineStatus::FLOOD`].
    pub number: u32,
    /// Turns of an arc.
    pub turns: i32,
    /// Plane of an arc, an index into [`Plane::ALL`].
    pub plane: u32,
    /// 0.
    pub reserved: u32,
    /// Feed, dwell, speed of spindle or surface, or tolerance of the path.
    pub value: f64,
    /// Highest spindle speed at constant surface speed, or tolerance of merging.
    pub bound: f64,
    /// End point of a line or an arc.
    pub target: PerAxis<Position>,
    /// Centre of an arc: first, second axis of its plane. At constant surface speed the first is X of the spindle.
    pub center: [Position; 2],
    /// The pass.
    pub pass: ThreadPass,
    /// A formula, its operations ([`Formula::encode`]),
    pub operations: [[u8; 32]; 3],
    /// and its constants.
    pub constants: [f64; Formula::CONSTANTS],
    /// A trace, as it stands in a file: through serde and bincode, zeros behind it.
    pub trace: [[u8; 32]; 16],
}

impl Message for CodePacket {
    const NAME: &str = "pitchlock/code-packet/4";
}

/// What the interpolator has taken out of the queue: room for as many more.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, IntoBytes, FromBytes, Immutable)]
#[repr(C)]
pub struct Credit {
    /// Items taken since the start of the program.
    pub taken: u64,
}

impl Message for Credit {
    const NAME: &str = "pitchlock/credit/1";
}

impl Credit {
    /// Nothing more is wanted: the program was stopped, or the machine has a fault.
    pub const ENOUGH: Credit = Credit { taken: u64::MAX };
}

const LINE: u32 = 1;
const DWELL: u32 = 2;
const SPINDLE: u32 = 3;
const TOOL: u32 = 4;
const PASS: u32 = 5;
const END: u32 = 6;
const ARC: u32 = 7;
const COOLANT: u32 = 8;
const PAUSE: u32 = 9;
const SURFACE: u32 = 10;
const PATH_MODE: u32 = 11;
const FORMULA: u32 = 12;
const TRACE: u32 = 13;

impl CodePacket {
    /// Puts an item on the wire.
    pub fn pack(sequence: u64, item: &Item) -> CodePacket {
        let mut packet = CodePacket { sequence, line: item.line, ..CodePacket::default() };
        match item.code {
            Code::Line { target, feed } => {
                (packet.kind, packet.target) = (LINE, target);
                (packet.number, packet.value) = packed_feed(feed);
            }
            Code::Arc { arc: Arc { plane, target, center, turns }, feed } => {
                (packet.kind, packet.plane, packet.turns) = (ARC, plane as u32, turns);
                (packet.target, packet.center) = (target, center);
                (packet.number, packet.value) = packed_feed(feed);
            }
            Code::PathMode(mode) => {
                let (number, [tolerance, merge]) = packed_mode(mode);
                (packet.kind, packet.number) = (PATH_MODE, number);
                (packet.value, packet.bound) = (tolerance, merge);
            }
            Code::Dwell { seconds } => (packet.kind, packet.value) = (DWELL, seconds),
            Code::Spindle { mode, speed: SpindleSpeed::Rpm(rpm) } => {
                (packet.kind, packet.number, packet.value) = (SPINDLE, mode as u32, rpm);
            }
            Code::Spindle { mode, speed: SpindleSpeed::Surface { mm_s, max_rpm, axis_mm } } => {
                (packet.kind, packet.number) = (SURFACE, mode as u32);
                (packet.value, packet.bound) = (mm_s, max_rpm);
                packet.center = [axis_mm, Position::default()];
            }
            Code::Tool { number } => (packet.kind, packet.number) = (TOOL, number),
            Code::Coolant { mist, flood } => {
                let bits = MachineStatus::coolant(mist, flood);
                (packet.kind, packet.number) = (COOLANT, u32::from(bits));
            }
            Code::Pause => packet.kind = PAUSE,
            Code::Pass(pass) => (packet.kind, packet.pass) = (PASS, pass),
            Code::Formula { slot, formula } => {
                (packet.kind, packet.number) = (FORMULA, u32::from(slot));
                let (operations, constants) = formula.encode();
                packet.operations.as_flattened_mut().copy_from_slice(&operations);
                packet.constants = constants;
            }
            Code::Work(trace) => {
                // There is room for the longest; without its kind no packet is taken for a trace.
                let room = packet.trace.as_flattened_mut();
                let packed = bincode::serde::encode_into_slice(trace, room, bincode::config::standard());
                packet.kind = packed.map_or(0, |_| TRACE);
            }
            Code::End => packet.kind = END,
        }
        packet
    }

    /// Takes an item off the wire.
    ///
    /// # Errors
    /// A gap in the sequence, an unknown code, or a value that no interpreter sends.
    pub fn unpack(&self, expected_sequence: u64) -> Result<Item, Refused> {
        if self.sequence != expected_sequence {
            return Err(Refused::OutOfOrder("machine code", expected_sequence, self.sequence));
        }
        let item = Item { line: self.line, code: self.code()? };
        item.check()?;
        Ok(item)
    }

    fn code(&self) -> Result<Code, Refused> {
        Ok(match self.kind {
            LINE => Code::Line { target: self.target, feed: self.feed()? },
            ARC => {
                let plane = Plane::ALL.get(self.plane as usize).copied();
                let plane = plane.ok_or(Refused::UnknownCode("plane", self.plane))?;
                let arc = Arc { plane, target: self.target, center: self.center, turns: self.turns };
                Code::Arc { arc, feed: self.feed()? }
            }
            PATH_MODE => Code::PathMode(match self.number {
                0 => PathMode::ExactStop,
                1 => PathMode::ExactPath,
                2 => PathMode::Blend { tolerance_mm: self.value, merge_mm: self.bound },
                other => return Err(Refused::UnknownCode("path mode", other)),
            }),
            DWELL => Code::Dwell { seconds: self.value },
            SPINDLE => Code::Spindle { mode: self.mode()?, speed: SpindleSpeed::Rpm(self.value) },
            SURFACE => {
                let [axis_mm, _] = self.center;
                let speed = SpindleSpeed::Surface { mm_s: self.value, max_rpm: self.bound, axis_mm };
                Code::Spindle { mode: self.mode()?, speed }
            }
            TOOL => Code::Tool { number: self.number },
            COOLANT => {
                let is_on = |bit: u16| self.number & u32::from(bit) != 0;
                let (mist, flood) = (is_on(MachineStatus::MIST), is_on(MachineStatus::FLOOD));
                if self.number != u32::from(MachineStatus::coolant(mist, flood)) {
                    return Err(Refused::UnknownCode("coolant", self.number));
                }
                Code::Coolant { mist, flood }
            }
            PAUSE => Code::Pause,
            PASS => Code::Pass(self.pass),
            FORMULA => {
                let slot =
                    self.number.try_into().map_err(|_| Refused::UnknownCode("formula", self.number))?;
                let formula = Formula::decode(self.operations.as_flattened(), &self.constants);
                Code::Formula { slot, formula: formula.map_err(|_| Refused::OutOfRange("formula"))? }
            }
            TRACE => {
                let bytes = self.trace.as_flattened();
                let trace = bincode::serde::decode_from_slice(bytes, bincode::config::standard());
                let (trace, used) = trace.map_err(|_| Refused::OutOfRange("trace"))?;
                if bytes.iter().skip(used).any(|byte| *byte != 0) {
                    return Err(Refused::OutOfRange("trace"));
                }
                Code::Work(trace)
            }
            END => Code::End,
            other => return Err(Refused::UnknownCode("machine code", other)),
        })
    }

    fn mode(&self) -> Result<SpindleMode, Refused> {
        Ok(match self.number {
            0 => SpindleMode::Stop,
            1 => SpindleMode::Clockwise,
            2 => SpindleMode::Counterclockwise,
            other => return Err(Refused::UnknownCode("spindle", other)),
        })
    }

    fn feed(&self) -> Result<Feed, Refused> {
        Ok(match self.number {
            0 => Feed::Rapid,
            1 => Feed::PerMinute(self.value),
            2 => Feed::PerRevolution(self.value),
            other => return Err(Refused::UnknownCode("feed", other)),
        })
    }
}

/// Kind and value on the wire.
fn packed_feed(feed: Feed) -> (u32, f64) {
    match feed {
        Feed::Rapid => (0, 0.0),
        Feed::PerMinute(feed) => (1, feed),
        Feed::PerRevolution(feed) => (2, feed),
    }
}

/// Number on the wire, and both tolerances.
fn packed_mode(mode: PathMode) -> (u32, [f64; 2]) {
    match mode {
        PathMode::ExactStop => (0, [0.0; 2]),
        PathMode::ExactPath => (1, [0.0; 2]),
        PathMode::Blend { tolerance_mm, merge_mm } => (2, [tolerance_mm, merge_mm]),
    }
}
