//! What goes through the socket between launcher and panel: one line of JSON for each message. Both are the
//! same program, started by the same user.

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

/// A place on the way of the tool: its axes in the order of the machine, mm; and how it was moved there: 0
/// rapid or not at all, 1 at a feed, 2 in a pass, 3 in a pass when the index went by: where the groove is cut
/// through that angle.
pub type Point = (Vec<f32>, u8);

/// Launcher → panel.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ToPanel {
    /// First: the secret that whoever watches or presses has to know.
    Token(String),
    /// These fields of what is seen are this now; a list counts as one.
    Set(Map<String, Value>),
    /// The tool went on along these places.
    Trail(Vec<Point>),
    /// A run begins: the tool has not gone anywhere yet.
    NoTrail,
    /// The scope begins anew.
    Scope {
        /// Names of the columns of its rows: those of a trace.
        columns: Vec<String>,
        /// Control cycle, s.
        cycle_s: f64,
        /// So many rows are kept.
        most: usize,
    },
    /// Rows of the scope: so many numbers, eight bytes each, follow behind this line.
    Rows(usize),
    /// A press has its cycle.
    Taken {
        /// Which press.
        ticket: u64,
        /// In this control cycle it reached the panel of the machine.
        cycle: u64,
    },
    /// A press came to nothing.
    Refused {
        /// Which press.
        ticket: u64,
        /// A stable name of the reason.
        code: String,
        /// The reason, and what to do about it.
        why: String,
    },
}

/// What somebody asks of work by hand. Lengths in mm, feeds in mm/min (degrees of rotary axes).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum HandAsked {
    /// The machine is to be switched on for it.
    On,
    /// A block of G-code.
    Block(String),
    /// One axis goes so far.
    Step {
        /// Its name.
        axis: String,
        /// How far, signed.
        mm: f64,
        /// How fast.
        mm_min: f64,
    },
    /// One axis goes as long as that is confirmed.
    Jog {
        /// Its name.
        axis: String,
        /// Towards higher values.
        positive: bool,
        /// How fast.
        mm_min: f64,
    },
    /// One axis goes to its home, in rapid motion.
    Home(String),
    /// A jog is confirmed.
    JogOn,
    /// Where an axis stands is this value of the coordinate system in force, in units of the program.
    TouchOff {
        /// Its name.
        axis: String,
        /// The value.
        value: f64,
        /// The offset of this tool becomes so, and not the zero of the coordinate system.
        #[serde(default)]
        tool: Option<u32>,
    },
    /// Words of a coordinate system or a tool are set, in units of the machine, X as a radius.
    Offset {
        /// `G54` to `G59.3`, or `T` and a number.
        of: String,
        /// Letters and values.
        words: Vec<(char, f64)>,
        /// They are added to what is there.
        add: bool,
    },
    /// The tool of this number is in; 0: none is.
    ToolIn(u32),
    /// The next start begins at this line of the program; nothing: at its beginning.
    From(Option<u32>),
    /// A recording is played.
    Play(Play),
    /// The spindle turns at this speed, 1/min; negative counterclockwise, 0 not at all.
    Spindle(f64),
}

/// How a recording is played.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Play {
    /// So many seconds of the machine in each on the wall; 0 stands.
    Speed(f64),
    /// So many control cycles, then it stands.
    Step(u64),
    /// It stands at this time on the machine, s.
    Seek(f64),
}

/// Panel → launcher: a press, as [`OperatorRequest`](protocol::OperatorRequest) numbers it, or what is
/// asked of work by hand.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FromPanel {
    /// Running number, for the answer.
    pub ticket: u64,
    /// Code of the request.
    pub kind: u32,
    /// Per cent; 1 or 0 of a switch; else 0.
    pub value: f64,
    /// Of work by hand; then the others mean nothing.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hand: Option<HandAsked>,
}
