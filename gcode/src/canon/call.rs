//! The canonical machining functions.

use super::nurbs::Nurbs;
use super::pose::{Plane, Pose, Units};
use super::thread::ThreadCycle;
use crate::files::Tool;

/// How F is meant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FeedMode {
    /// G93: F is the inverse of the minutes a block takes.
    InverseTime,
    /// G94.
    PerMinute,
    /// G95.
    PerRevolution,
}

/// What may happen to the path between two moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PathMode {
    /// G61.
    ExactPath,
    /// G61.1.
    ExactStop,
    /// G64, with the distance that the path may leave its corners (0: no bound).
    Continuous(f64),
}

/// Sense of rotation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Turn {
    /// M3.
    Clockwise,
    /// M4.
    Counterclockwise,
}

/// An arc in the plane in force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arc {
    /// End point: first axis, second axis of the plane.
    pub end: [f64; 2],
    /// Centre: first axis, second axis.
    pub center: [f64; 2],
    /// Turns, never 0: positive counterclockwise seen from the positive end of the axis across the plane; ±1
    /// is up to one full turn.
    pub turns: i32,
    /// End of the axis across the plane.
    pub along: f64,
    /// End of A, B, C.
    pub rotary: [f64; 3],
}

/// One canonical machining function.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Call<'a> {
    /// Units of everything that follows.
    UseLengthUnits(Units),
    /// Offset of a coordinate system: 1 is G54, 9 is G59.3.
    SetG5xOffset(u8, Pose),
    /// G52 and G92.
    SetG92Offset(Pose),
    /// Rotation of the coordinate system about Z, degrees.
    SetXyRotation(f64),
    /// F counts along X, Y and Z.
    SetFeedReference,
    /// Plane of arcs.
    SelectPlane(Plane),
    /// How F is meant.
    SetFeedMode(FeedMode),
    /// F: units per minute, units per revolution, or 1/min.
    SetFeedRate(f64),
    /// Constant surface speed with the highest speed of the spindle, 1/min; 0 for constant speed (G97).
    SetSpindleMode(f64),
    /// S: 1/min, or m/min (ft/min) at constant surface speed.
    SetSpindleSpeed(f64),
    /// M3, M4.
    StartSpindle(Turn),
    /// M5.
    StopSpindle,
    /// M19: angle in degrees, direction 0 shortest, 1 clockwise, 2 counterclockwise. G87 sends
    /// LinuxCNC's numbers of the direction in which the spindle turned: 2 clockwise, 3 counterclockwise.
    OrientSpindle(f64, u8),
    /// M19: wait until it is there, s.
    WaitSpindleOrient(f64),
    /// G0.
    StraightTraverse(Pose),
    /// G1.
    StraightFeed(Pose),
    /// G2, G3.
    ArcFeed(Arc),
    /// G5, G5.1, G5.2: a curve in the plane in force. [`Nurbs::follow`] gives arcs that stand for it.
    NurbsFeed(&'a Nurbs),
    /// G38.n: kind is 2 to 5.
    StraightProbe(u8, Pose),
    /// G4, s.
    Dwell(f64),
    /// Motion follows the spindle from here: units per revolution along the path. With `velocity`, only its
    /// speed (G95) and not its angle.
    StartSpeedFeedSynch {
        /// Units per revolution.
        lead: f64,
        /// G95.
        velocity: bool,
        /// Angle of the spindle at which the thread starts, degrees (FANUC Q); 0 is the index.
        start_deg: f64,
        /// By how much the lead grows in a turn, units (FANUC G34); 0 of one that is the same all along.
        growth: f64,
    },
    /// Motion is free of the spindle again.
    StopSpeedFeedSynch,
    /// G33.1, and G84 of FANUC: bottom, the factor of the speed of the way out, and the dwell at the bottom,
    /// s.
    RigidTap(Pose, f64, f64),
    /// A multi-pass threading cycle. [`ThreadCycle::expand`] gives the moves it stands for.
    ThreadCycle(&'a ThreadCycle),
    /// T.
    SelectTool(i32),
    /// M6; the tool that is in the spindle afterwards.
    ChangeTool(i32),
    /// M61.
    ChangeToolNumber(i32),
    /// Offset of the tool in every axis.
    UseToolLengthOffset(Pose),
    /// G10 L1, L10, L11: the tool as the table holds it now.
    SetToolTableEntry(&'a Tool),
    /// M7.
    MistOn,
    /// M9.
    MistOff,
    /// M8.
    FloodOn,
    /// M9.
    FloodOff,
    /// M48 to M50.
    EnableFeedOverride(bool),
    /// M48, M49, M51.
    EnableSpeedOverride(bool),
    /// M52.
    EnableAdaptiveFeed(bool),
    /// M53.
    EnableFeedHold(bool),
    /// G61, G61.1, G64.
    SetMotionControlMode(PathMode),
    /// G64: lines whose ends lie this near to one line may become one.
    SetNaivecamTolerance {
        /// Q, or P where it was left out.
        tolerance: f64,
        /// Q was given.
        programmed: bool,
    },
    /// G64 R: how hard the planner of the control is asked to work, before the path mode. `Some` is smooth,
    /// with limited jerk, from the gentlest 0.1 to 1; `None` without a limit of jerk.
    SetPlannerMode(Option<f64>),
    /// M62, M63: output, with the next motion.
    SetMotionOutputBit(u32, bool),
    /// M64, M65: output, at once.
    SetAuxOutputBit(u32, bool),
    /// M67.
    SetMotionOutputValue(u32, f64),
    /// M68.
    SetAuxOutputValue(u32, f64),
    /// M66: digital (or analog) input, how to wait (0 not, 1 rise, 2 fall, 3 high, 4 low), at most s.
    WaitInput {
        /// Number of the input.
        index: u32,
        /// Analog inputs have values, digital ones levels.
        analog: bool,
        /// L.
        wait: u8,
        /// Q, s.
        timeout: f64,
    },
    /// A comment, without its parentheses.
    Comment(&'a str),
    /// What the control says about itself where LinuxCNC's `rs274` prints a comment of its own; `interpreter:
    /// ` is left out.
    Note(&'a str),
    /// `(MSG,...)` and `(DEBUG,...)`.
    Message(&'a str),
    /// `(PRINT,...)`.
    Print(&'a str),
    /// `(LOGOPEN,...)`, `(LOGAPPEND,...)`, `(LOG,...)`, `(LOGCLOSE)`: verb in upper case and text.
    Log(&'a str, &'a str),
    /// M0.
    ProgramStop,
    /// G88: the operator moves the tool out of the hole; the program goes on from its retract plane.
    MoveByHand,
    /// M1.
    OptionalProgramStop,
    /// M60, M30.
    PalletShuttle,
    /// M2, M30.
    ProgramEnd,
    /// The state of the interpreter was put back to its beginning.
    OnReset,
    /// The program ran off its end (`%`).
    Finish,
}
