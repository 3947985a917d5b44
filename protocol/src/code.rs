//! Machine code: what the interpreter makes of a part program and the interpolator executes.
//!
//! [`Item`] is the value inside a module and in a `.mc` file; [`CodePacket`](crate::CodePacket) is the same
//! in shared memory. Targets are absolute machine positions (X of a lathe a radius; degrees for rotary axes);
//! feeds in mm/min or mm/rev (degrees where only rotary axes move), dwell in s.
//!
//! What an item needs of the machine (travel, radii, feasibility) is checked where it begins: only there its
//! start is known.

use serde::{Deserialize, Serialize};
use shape::Formula;

use crate::{
    arc::Arc,
    curve::Curve,
    pass::ThreadPass,
    refused::{Refused, not_negative, positive},
    units::{Axis, PerAxis, Position},
    variation::Variation,
    work::{FORMULAS, Work},
};

/// One instruction and the line of the part program it comes from.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Item {
    /// Line of the part program, from 1.
    pub line: u32,
    /// What to do.
    pub code: Code,
}

/// Feed of a move.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub enum Feed {
    /// As fast as the axes may go.
    #[default]
    Rapid,
    /// mm/min along the path.
    PerMinute(f64),
    /// mm per revolution of the spindle along the path.
    PerRevolution(f64),
}

impl Feed {
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

/// Speed of the spindle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum SpindleSpeed {
    /// 1/min, ≥ 0 (G97).
    Rpm(f64),
    /// Constant surface speed (G96): 60 v / 2πr, with r the distance of the commanded X from the axis of the
    /// spindle.
    Surface {
        /// Speed of the surface v, mm/s, ≥ 0.
        mm_s: f64,
        /// Highest speed of the spindle, 1/min, > 0: what it turns at near the axis.
        max_rpm: f64,
        /// Machine X at which the tool stands on the axis of the spindle: programmed X0 under the offsets in
        /// force.
        axis_mm: Position,
    },
}

impl SpindleSpeed {
    /// Programmed speed with the axis X commanded to `x`, 1/min, ≥ 0.
    pub fn rpm(self, x: Position) -> f64 {
        match self {
            SpindleSpeed::Rpm(rpm) => rpm,
            SpindleSpeed::Surface { mm_s: 0.0, .. } => 0.0,
            SpindleSpeed::Surface { mm_s, max_rpm, axis_mm } => {
                let radius = x.mm_from(axis_mm).abs();
                (60.0 * mm_s / (std::f64::consts::TAU * radius)).min(max_rpm)
            }
        }
    }

    fn check(self) -> Result<(), Refused> {
        match self {
            SpindleSpeed::Rpm(rpm) => not_negative(rpm, "spindle speed"),
            SpindleSpeed::Surface { mm_s, max_rpm, .. } => {
                not_negative(mm_s, "surface speed")?;
                positive(max_rpm, "highest spindle speed")
            }
        }
    }
}

/// What the path may do between two moves.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum PathMode {
    /// Every move ends at rest (G61.1).
    ExactStop,
    /// The path is followed exactly, without a stop where it has no corner (G61).
    ExactPath,
    /// Corners are rounded (G64).
    Blend {
        /// Farthest that a corner may be rounded, mm, 0 to [`PathMode::MOST_MM`].
        tolerance_mm: f64,
        /// Where lines nearly go on in one line, the path may leave them by so much more, mm, 0 to
        /// [`PathMode::MOST_MM`]: half of it for lines that have been made one, half for blends.
        merge_mm: f64,
    },
}

impl PathMode {
    /// Largest tolerance, mm.
    pub const MOST_MM: f64 = 10.0;
    /// Share of a tolerance that is for nearly straight lines alone where nothing is said of it; the rest is
    /// for every corner.
    const MERGE_SHARE: f64 = 0.2;

    /// Blends of G64 with a tolerance and without Q: merging and blends stay within it together.
    pub fn within(tolerance_mm: f64) -> PathMode {
        let merge_mm = PathMode::MERGE_SHARE * tolerance_mm;
        PathMode::Blend { tolerance_mm: tolerance_mm - merge_mm, merge_mm }
    }

    /// Lines may be made one whose ends lie so near to it, mm.
    pub fn merges_within_mm(self) -> f64 {
        match self {
            PathMode::Blend { merge_mm, .. } => 0.5 * merge_mm,
            PathMode::ExactStop | PathMode::ExactPath => 0.0,
        }
    }

    fn check(self) -> Result<(), Refused> {
        let PathMode::Blend { tolerance_mm, merge_mm } = self else { return Ok(()) };
        for (mm, name) in [(tolerance_mm, "tolerance of the path"), (merge_mm, "tolerance of merging")] {
            not_negative(mm, name)?;
            if mm > PathMode::MOST_MM {
                return Err(Refused::OutOfRange(name));
            }
        }
        Ok(())
    }
}

/// How many digital outputs there are: one for each bit of [`MachineStatus::outputs`](crate::MachineStatus).
pub const OUTPUTS: u8 = 64;

/// How many analog outputs there are: one for each value of
/// [`MachineStatus::analog`](crate::MachineStatus).
pub const ANALOG_OUTPUTS: u8 = 4;

/// What an output is set to.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Set {
    /// A digital one: whether it is on.
    Digital(bool),
    /// An analog one: its value, in the unit of the machine file.
    Analog(f64),
}

impl Set {
    /// Refuses numbers of outputs that there are not, and values that are none.
    fn check(self, number: u8) -> Result<(), Refused> {
        let most = if let Set::Digital(_) = self { OUTPUTS } else { ANALOG_OUTPUTS };
        match self {
            _ if number >= most => Err(Refused::OutOfRange("number of an output")),
            Set::Analog(value) if !value.is_finite() => Err(Refused::OutOfRange("value of an output")),
            _ => Ok(()),
        }
    }
}

/// How many digital inputs there are: one for each bit of
/// [`Measurement::inputs`](crate::Measurement).
pub const INPUTS: u8 = 64;

/// What is waited for at a digital input.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Until {
    /// It goes on (M66 L1).
    Rise,
    /// It goes off (L2).
    Fall,
    /// It is on (L3).
    High,
    /// It is off (L4).
    Low,
}

impl Until {
    /// Whether it has come, from one tick to the next.
    pub fn has_come(self, before: bool, now: bool) -> bool {
        match self {
            Until::Rise => now && !before,
            Until::Fall => before && !now,
            Until::High => now,
            Until::Low => !now,
        }
    }
}

/// What stands between blocks that somebody gives by hand, one by one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum ByHand {
    /// Wait at rest until another block is given ([`Panel::BLOCK`](crate::Panel::BLOCK)). What follows is
    /// asked for only then: it need not be known before.
    Waits,
    /// A block begins.
    Begins {
        /// Where the axes rest, as whoever gave the block knew; a machine that rests elsewhere refuses it.
        at: PerAxis<Position>,
        /// Its one move goes on while the jog key is pressed ([`Panel::JOG`](crate::Panel::JOG)).
        jogs: bool,
    },
    /// The reference run of an axis that the machine file gives one.
    References(Axis),
}

/// One instruction of the machine code.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[allow(clippy::large_enum_variant)] // fixed size is the point: the queue holds it by value
pub enum Code {
    /// Straight line to a point.
    Line {
        /// Absolute end point of every axis.
        target: PerAxis<Position>,
        /// How fast.
        feed: Feed,
    },
    /// Arc or helix to a point.
    Arc {
        /// Where.
        arc: Arc,
        /// How fast; not [`Feed::Rapid`].
        feed: Feed,
    },
    /// What the path may do between the moves that follow. A program begins with [`PathMode::Blend`] within
    /// `path.tolerance_mm` of the machine file, `merge_mm` 0.
    PathMode(PathMode),
    /// Wait at rest, seconds.
    Dwell {
        /// Duration, s, ≥ 0.
        seconds: f64,
    },
    /// Direction and speed of the spindle.
    Spindle {
        /// Direction.
        mode: SpindleMode,
        /// Programmed speed.
        speed: SpindleSpeed,
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
    /// An output is set.
    Output {
        /// Its number: below [`OUTPUTS`], or below [`ANALOG_OUTPUTS`] of an analog one.
        number: u8,
        /// What it is from then on.
        set: Set,
        /// As the next motion begins; else at rest, now.
        in_step: bool,
    },
    /// Wait at rest for a digital input; a fault if it does not come in time.
    Await {
        /// Its number, below [`INPUTS`].
        input: u8,
        /// For what.
        until: Until,
        /// For so long at most, s, > 0.
        within_s: f64,
    },
    /// Wait at rest for cycle start (M0, M60). Spindle and coolant go on.
    Pause,
    /// A pass of a thread. Every axis rests at the start of its law when it is reached.
    Pass(ThreadPass),
    /// A formula that the traces which follow refer to.
    Formula {
        /// Its number, below [`FORMULAS`].
        slot: u8,
        /// The formula.
        formula: Formula,
    },
    /// Work that formulas tell, a move of its own: it begins and ends at rest.
    Work(Work),
    /// The program is over.
    End,
    /// How the speed of the spindle is varied in the passes that follow; nothing: it is not. A program begins
    /// without.
    Variation(Option<Variation>),
    /// Between blocks that are given by hand.
    ByHand(ByHand),
    /// A piece of a smooth curve to a point: what the compressor has made of a run of lines.
    Curve {
        /// Where.
        curve: Curve,
        /// How fast; not [`Feed::Rapid`].
        feed: Feed,
    },
    /// The same as [`Code::Pause`], unless [`Panel::PASSES_M1`](crate::Panel::PASSES_M1) is on (M1).
    OptionalPause,
}

impl Code {
    /// Where a line, an arc or a piece of a curve ends.
    pub fn target(&self) -> Option<&PerAxis<Position>> {
        match self {
            Code::Line { target, .. }
            | Code::Arc { arc: Arc { target, .. }, .. }
            | Code::Curve { curve: Curve { target, .. }, .. } => Some(target),
            _ => None,
        }
    }

    /// How fast it goes there.
    pub fn feed(&self) -> Option<Feed> {
        match self {
            Code::Line { feed, .. } | Code::Arc { feed, .. } | Code::Curve { feed, .. } => Some(*feed),
            _ => None,
        }
    }
}

impl Item {
    /// Whether it moves the axes by time: a line, an arc, a piece of a curve or a trace.
    pub fn is_move(&self) -> bool {
        self.code.target().is_some() || matches!(self.code, Code::Work(_))
    }

    /// What it counts in the progress of a program, [`MachineStatus::taken`](crate::MachineStatus::taken): 1,
    /// or what a trace stands for.
    pub fn steps(&self) -> u64 {
        if let Code::Work(_) = self.code { Work::STEPS } else { 1 }
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
            Code::Curve { feed: Feed::Rapid, .. } => Err(Refused::OutOfRange("feed of a curve")),
            Code::Curve { curve, feed } => curve.check().and_then(|()| feed.check()),
            Code::Dwell { seconds } => not_negative(*seconds, "dwell"),
            Code::PathMode(mode) => mode.check(),
            Code::Spindle { speed, .. } => speed.check(),
            Code::Pass(pass) => pass.check(),
            Code::Variation(variation) => variation.map_or(Ok(()), |variation| variation.check()),
            Code::Formula { slot, .. } if usize::from(*slot) < FORMULAS => Ok(()),
            Code::Formula { .. } => Err(Refused::OutOfRange("number of a formula")),
            Code::Work(trace) => trace.check(),
            Code::Output { number, set, .. } => set.check(*number),
            Code::Await { input, .. } if *input >= INPUTS => Err(Refused::OutOfRange("number of an input")),
            Code::Await { within_s, .. } => positive(*within_s, "wait for an input"),
            Code::Tool { .. } | Code::Coolant { .. } | Code::Pause | Code::OptionalPause => Ok(()),
            Code::End | Code::ByHand(_) => Ok(()),
        }
    }
}
