//! Machine code: what the interpreter makes of a part program and the interpolator executes.
//!
//! [`Item`] is the value inside a module and in a `.mc` file; [`CodePacket`] is the same in shared memory.
//! Targets are absolute machine positions (X a radius); feeds in mm/min or mm/rev, dwell in s.
//!
//! What an item needs of the machine (travel, radii, feasibility) is checked where it begins: only there its start is
//! known.

use iceoryx2::prelude::ZeroCopySend;
use serde::{Deserialize, Serialize};
use zerocopy::{FromBytes, Immutable, IntoBytes};

use crate::{Arc, MachineStatus, PerAxis, Position, Refused, ThreadPass, finite};

/// One instruction and the line of the part program it comes from.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Item {
    /// Line of the part program, from 1.
    pub line: u32,
    /// What to do.
    pub code: Code,
}

/// Feed of a move.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Feed {
    /// As fast as the axes may go.
    Rapid,
    /// mm/min along the path.
    PerMinute(f64),
    /// mm per revolution of the spindle along the path.
    PerRevolution(f64),
}

impl Feed {
    /// Kind and value on the wire.
    fn pack(self) -> (u32, f64) {
        match self {
            Feed::Rapid => (0, 0.0),
            Feed::PerMinute(feed) => (1, feed),
            Feed::PerRevolution(feed) => (2, feed),
        }
    }

    /// Refuses a feed that is not positive.
    fn check(self) -> Result<(), Refused> {
        match self {
            Feed::Rapid => Ok(()),
            Feed::PerMinute(feed) | Feed::PerRevolution(feed) => positive(feed, "feed"),
        }
    }
}

/// What the spindle shall do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum SpindleMode {
    /// M5.
    Stop,
    /// M3.
    Clockwise,
    /// M4.
    Counterclockwise,
}

impl SpindleMode {
    /// Sign of the speed: +1 clockwise, -1 counterclockwise, 0 stopped.
    pub fn sign(self) -> f64 {
        match self {
            SpindleMode::Stop => 0.0,
            SpindleMode::Clockwise => 1.0,
            SpindleMode::Counterclockwise => -1.0,
        }
    }
}

/// One instruction of the machine code.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[allow(clippy::large_enum_variant)] // fixed size is the point: the queue holds it by value
pub enum Code {
    /// Straight line to a point at which every axis stops.
    Line {
        /// Absolute end point of every axis.
        target: PerAxis<Position>,
        /// How fast.
        feed: Feed,
    },
    /// Arc in the plane of Z and X to a point at which every axis stops.
    Arc {
        /// Where.
        arc: Arc,
        /// How fast; not [`Feed::Rapid`].
        feed: Feed,
    },
    /// Wait, seconds.
    Dwell {
        /// Duration, s, ≥ 0.
        seconds: f64,
    },
    /// Direction and speed of the spindle.
    Spindle {
        /// Direction.
        mode: SpindleMode,
        /// Programmed speed, 1/min, ≥ 0.
        rpm: f64,
    },
    /// A tool was selected.
    Tool {
        /// Number of the tool.
        number: u32,
    },
    /// What cools from now on.
    Coolant {
        /// M7.
        mist: bool,
        /// M8.
        flood: bool,
    },
    /// Wait at rest for cycle start (M0, M60, M1 where it counts). Spindle and coolant go on.
    Pause,
    /// A pass of a thread. Every axis rests at the start of its law when it is reached.
    Pass(ThreadPass),
    /// The program is over.
    End,
}

/// An [`Item`] in shared memory. Fields that its kind does not use are zero.
#[rustfmt::skip]
#[derive(Clone, Copy, Debug, Default, PartialEq, ZeroCopySend, IntoBytes, FromBytes, Immutable)]
#[type_name("pitchlock/code-packet/2")]
#[repr(C)]
pub struct CodePacket {
    /// Running number of the item in the program, from 0: the receiver refuses a gap.
    pub sequence: u64,
    /// Line of the part program.
    pub line: u32,
    /// Kind of item, see [`CodePacket::unpack`].
    pub kind: u32,
    /// Tool number, spindle mode, kind of feed, or sum of [`MachineStatus::MIST`] and [`MachineStatus::FLOOD`].
    pub number: u32,
    /// Turns of an arc.
    pub turns: i32,
    /// Feed, dwell, or spindle speed.
    pub value: f64,
    /// End point of a line or an arc.
    pub target: PerAxis<Position>,
    /// Centre of an arc: X, Z.
    pub center: [Position; 2],
    /// The pass.
    pub pass: ThreadPass,
}

/// What the interpolator has taken out of the queue: room for as many more.
#[rustfmt::skip]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ZeroCopySend, IntoBytes, FromBytes, Immutable)]
#[type_name("pitchlock/credit/1")]
#[repr(C)]
pub struct Credit {
    /// Items taken since the start of the program.
    pub taken: u64,
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

impl CodePacket {
    /// Puts an item on the wire.
    pub fn pack(sequence: u64, item: &Item) -> CodePacket {
        let mut packet = CodePacket { sequence, line: item.line, ..CodePacket::default() };
        match item.code {
            Code::Line { target, feed } => {
                (packet.kind, packet.target) = (LINE, target);
                (packet.number, packet.value) = feed.pack();
            }
            Code::Arc { arc: Arc { target, center, turns }, feed } => {
                (packet.kind, packet.target, packet.center, packet.turns) = (ARC, target, center, turns);
                (packet.number, packet.value) = feed.pack();
            }
            Code::Dwell { seconds } => (packet.kind, packet.value) = (DWELL, seconds),
            Code::Spindle { mode, rpm } => {
                (packet.kind, packet.number, packet.value) = (SPINDLE, mode as u32, rpm);
            }
            Code::Tool { number } => (packet.kind, packet.number) = (TOOL, number),
            Code::Coolant { mist, flood } => {
                let bits = MachineStatus::coolant(mist, flood);
                (packet.kind, packet.number) = (COOLANT, u32::from(bits));
            }
            Code::Pause => packet.kind = PAUSE,
            Code::Pass(pass) => (packet.kind, packet.pass) = (PASS, pass),
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
                let arc = Arc { target: self.target, center: self.center, turns: self.turns };
                Code::Arc { arc, feed: self.feed()? }
            }
            DWELL => Code::Dwell { seconds: self.value },
            SPINDLE => {
                let mode = match self.number {
                    0 => SpindleMode::Stop,
                    1 => SpindleMode::Clockwise,
                    2 => SpindleMode::Counterclockwise,
                    other => return Err(Refused::UnknownCode("spindle", other)),
                };
                Code::Spindle { mode, rpm: self.value }
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
            END => Code::End,
            other => return Err(Refused::UnknownCode("machine code", other)),
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

impl Item {
    /// Whether it moves the axes by time: a line or an arc.
    pub fn is_move(&self) -> bool {
        matches!(self.code, Code::Line { .. } | Code::Arc { .. })
    }

    /// Refuses values that no interpreter sends, wherever the item came from.
    ///
    /// # Errors
    /// Names the field.
    pub fn check(&self) -> Result<(), Refused> {
        match &self.code {
            Code::Line { feed, .. } => feed.check(),
            Code::Arc { feed: Feed::Rapid, .. } => Err(Refused::OutOfRange("feed of an arc")),
            Code::Arc { arc, feed } => arc.check().and_then(|()| feed.check()),
            Code::Dwell { seconds } => not_negative(*seconds, "dwell"),
            Code::Spindle { rpm, .. } => not_negative(*rpm, "spindle speed"),
            Code::Pass(pass) => pass.check(),
            Code::Tool { .. } | Code::Coolant { .. } | Code::Pause | Code::End => Ok(()),
        }
    }
}

fn positive(value: f64, name: &'static str) -> Result<(), Refused> {
    if finite(value, name)? > 0.0 { Ok(()) } else { Err(Refused::OutOfRange(name)) }
}

fn not_negative(value: f64, name: &'static str) -> Result<(), Refused> {
    if finite(value, name)? >= 0.0 { Ok(()) } else { Err(Refused::OutOfRange(name)) }
}
