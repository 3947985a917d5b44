//! What is seen of a machine. In: what the launcher knows of one control cycle. Out: fields of JSON, as
//! `GET /api/state` shows them; `docs/panel.md` is their table. Positions in mm of the machine (X of a lathe
//! as a radius), speeds in 1/min, overrides in per cent, errors in µm.

use std::collections::BTreeMap;

use serde::Serialize;
use serde_json::{Map, Value};

/// Fields that are shown beside those of [`Seen`].
const BESIDE: [&str; 12] = [
    "signals",
    "machine",
    "program",
    "mode",
    "recording",
    "by_hand",
    "offsets",
    "way",
    "outcome",
    "part",
    "from",
    "blocks",
];

/// Every field that is shown of a machine, null: nothing is known yet.
pub(crate) fn nothing() -> Map<String, Value> {
    let (passes, messages, faults) = (Some(Vec::new()), Some(Vec::new()), Some(Vec::new()));
    let seen = serde_json::to_value(Seen { passes, messages, faults, ..Seen::default() });
    let seen = seen.ok().and_then(|seen| seen.as_object().cloned()).unwrap_or_default();
    let names = seen.into_iter().map(|(name, _)| name).chain(BESIDE.map(str::to_owned));
    names.map(|name| (name, Value::Null)).collect()
}

/// What stays the same during a run.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ProgramSeen {
    /// Its file.
    pub name: String,
    /// Its text, as long as that is not too long.
    pub text: Option<String>,
    /// How many passes of threads it has.
    pub passes: u32,
    /// How long it takes at 100 %, s.
    pub time_s: f64,
    /// The run folder.
    pub folder: String,
}

/// The machine.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct MachineSeen {
    /// Its name.
    pub name: String,
    /// `lathe`, `mill`, `positioner`.
    pub kinematics: String,
    /// The names of its axes, in the order of `axes` and of the trail.
    pub axes: Vec<String>,
    /// Travel of each, mm or degrees.
    pub travel: Vec<[f64; 2]>,
    /// Control cycle, s.
    pub cycle_s: f64,
    /// Highest speed of the spindle, 1/min.
    pub max_rpm: f64,
    /// Time on the machine for each second on the wall, or `max`.
    pub pace: String,
    /// The stock, if it is known, as `summary.json` has it: in coordinates of the program.
    pub stock: Option<serde_json::Value>,
    /// X and Z of the machine at which those of the program are 0, where that is known, mm.
    pub origin_mm: Option<[f64; 2]>,
    /// Angle between the flanks of threading tools, degrees, by number; of others the one of the machine
    /// file, at 0.
    pub flanks_deg: BTreeMap<u32, f64>,
    /// Of each axis the fastest jog that goes on while a key is pressed, mm/min.
    pub fastest_jog: Vec<f64>,
}

/// One axis.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct AxisSeen {
    /// Its name.
    pub name: String,
    /// Whether its position is known: false until its reference run is made, if the machine has one, and as
    /// soon as the machine is off.
    pub referenced: bool,
    /// Where the control leads it, mm.
    pub commanded_mm: f64,
    /// Where its encoder sees it, mm.
    pub measured_mm: f64,
    /// What is left to where the block in hand leads; nothing where that is not known.
    pub to_go_mm: Option<f64>,
    /// Commanded minus measured, µm.
    pub error_um: f64,
    /// Commanded speed, mm/s.
    pub speed_mm_s: f64,
    /// Torque of its motor, N·m.
    pub torque_nm: f64,
    /// That as a share of what its drive is limited to, per cent.
    pub load_pct: f64,
    /// Its state, as in traces.
    pub state: String,
}

/// The spindle.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct SpindleSeen {
    /// Speed, 1/min, signed.
    pub rpm: f64,
    /// Speed that its drive is commanded, 1/min, signed.
    pub commanded_rpm: f64,
    /// Angle since the index, degrees, 0 to 360.
    pub angle_deg: f64,
    /// Torque of its motor, N·m.
    pub torque_nm: f64,
    /// That as a share of what the motor can at this speed, per cent.
    pub load_pct: f64,
}

/// The knobs, per cent: where they stand, and what is in force.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Knobs {
    /// Spindle.
    pub spindle_pct: f64,
    /// Of it in force.
    pub spindle_in_force_pct: f64,
    /// Feed.
    pub feed_pct: f64,
    /// Of it in force.
    pub feed_in_force_pct: f64,
    /// Rapid.
    pub rapid_pct: f64,
}

/// A pass of a thread, over or in hand.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct PassSeen {
    /// Number in the program, from 1.
    pub pass: u32,
    /// Line of the program.
    pub line: u32,
    /// Its depth below the crest, mm.
    pub depth_mm: f64,
    /// `complete`, `left`, `cut-off`; `now` of the one in hand.
    pub end: String,
    /// Lowest and highest speed of the spindle, 1/min.
    pub rpm: [f64; 2],
    /// Largest error of the tool from the helix, less its mean, µm.
    pub helix_um: f64,
    /// Where the tool lies on the helix, µm along Z.
    pub phase_um: f64,
    /// Whether the tool was in the material at all.
    pub cut: bool,
}

/// Something the program says.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Message {
    /// Line of the program.
    pub line: u32,
    /// In this control cycle.
    pub cycle: u64,
    /// What.
    pub text: String,
}

/// A fault.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Fault {
    /// In this control cycle.
    pub cycle: u64,
    /// Who found it.
    pub source: String,
    /// Its stable name.
    pub code: String,
    /// What happened.
    pub text: String,
    /// What to look at.
    pub remedy: String,
}

/// What changes from one look to the next.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Seen {
    /// The newest control cycle that is known.
    pub cycle: u64,
    /// Its time on the machine, s.
    pub time_s: f64,
    /// The state, by its stable name.
    pub state: String,
    /// The state in words.
    pub words: String,
    /// Line of the program in hand.
    pub line: u32,
    /// The pass in hand or cut last, from 1; 0 before the first.
    pub pass: u32,
    /// Its depth, mm.
    pub depth_mm: f64,
    /// How much of the program is done, in steps of machine code, and all of it; nothing of work by hand.
    pub done: Option<[u64; 2]>,
    /// The axes.
    pub axes: Vec<AxisSeen>,
    /// The spindle.
    pub spindle: SpindleSeen,
    /// The knobs.
    pub knobs: Knobs,
    /// Feed hold is pressed.
    pub held: bool,
    /// Single block is on.
    pub single_block: bool,
    /// The program waits at M1.
    pub optional_stop: bool,
    /// How long the rest of the program takes at 100 %, s, where that is known.
    pub left_s: Option<f64>,
    /// Number of the tool, and its name in the machine file.
    pub tool: u32,
    /// Its name.
    pub tool_name: String,
    /// X and Z of the machine at which those of the program are 0 in the block or the pass in hand, where
    /// that is known, mm.
    pub origin_mm: Option<[f64; 2]>,
    /// How far the tool is drawn beside where it is, X and Z, mm.
    pub moved_mm: [f64; 2],
    /// What the program said before the pause that it waits at.
    pub prompt: Option<String>,
    /// The pass in hand, as far as it has come.
    pub cutting: Option<PassSeen>,
    /// What cools: nothing, `mist`, `flood`, `mist and flood`.
    pub coolant: String,
    /// The passes that are over, if there are others than were sent last.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub passes: Option<Vec<PassSeen>>,
    /// What the program has said, likewise.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub messages: Option<Vec<Message>>,
    /// The faults, likewise.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub faults: Option<Vec<Fault>>,
}
