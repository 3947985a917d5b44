//! A scenario file: what happens to the machine while it runs. In: TOML, a list of `[[event]]`, each with one
//! trigger `at` and one action. Out: checked events, or an error that names the event, the key and the
//! remedy.
//!
//! | trigger | fires once, when |
//! |---|---|
//! | `{ pass, z_mm }` | the true Z passes a value while that pass is in hand |
//! | `{ pass, angle_deg }` | the spindle has turned so far since the index the pass starts from |
//! | `{ after_pass }` | that pass is over: the tool is on its way back |
//! | `{ time_s }`, `{ cycle }` | the time since the start of the machine is reached |
//! | `{ line }` | that line of the part program is in hand |
//!
//! With `panel = "live"` above the events a person stands at the panel: pauses and holds wait for him. With
//! `"recorded"` the events are what one has pressed.
//!
//! | action | value |
//! |---|---|
//! | `spindle_override_pct`, `feed_override_pct` | 0 to 200; with `ramp_s` the knob is turned evenly over that time |
//! | `rapid_override_pct` | 0 to 100; the same |
//! | `feed_hold`, `cycle_start`, `stop`, `abort` | `true`; a button is pressed, `cycle_start` releases the hold and ends a pause |
//! | `single_block` | `true`, `false`; the switch is turned on or off |
//! | `optional_stop` | `true`, `false`; whether the program waits at M1: at the beginning it does |
//! | `jog` | `true`: the jog key is pressed, and let go when it is not pressed again within 0.08 s; `false`: let go |
//! | `block` | `true`: the next block by hand is there |
//! | `spindle_load` | `{ torque_nm, for_s }`: holds the spindle back; or `{ nm_per_rpm, for_s }`: so much for each 1/min at that moment |
//! | `axial_force_n`, `radial_force_n` | N on the slide of Z, X, positive along the axis; or `{ force_n, for_s }` |
//! | `force_spike` | `{ axis, force_n, for_s }`: N on a slide, at once and for so long |
//! | `encoder_glitch_counts` | the counter of the spindle encoder jumps by so many counts; or `{ counts, for_s }`: and back |
//! | `index_lost` | `true`: the next index of the spindle is not seen; or `{ for_s }`: none in that time |
//! | `encoder_stands` | `true`: the counter of the spindle encoder stands; or `{ for_s }`: for so long, and goes on from there |
//! | `encoder_noise_counts` | the counter of the spindle encoder shows up to so many counts too many or too few |
//! | `encoder_eccentricity_counts` | and a sine of this amplitude, once a turn |
//! | `axis_jump` | `{ axis, mm }`: the counter of an axis jumps by so much |
//! | `emergency_stop`, `power_lost` | `true`; both stay |
//! | `drive_fault` | an axis: its drive brakes on its ramp and has no torque then; `{ axis, torque_lost = true }`: none at once |
//! | `spindle_fault` | `"runaway"`, `"reversal"`, `"stall"`, `"jam"`; or `{ fault, for_s }` |
//! | `kill` | the name of a process: `interpreter`, `interpolator`, `regulator-x` … |
//! | `freeze` | the same; or `{ process, for_s }`: it goes on then |
//! | `packet` | `{ channel, count }` with one of `drop = true`, `duplicate = true`, `reorder = true`, `delay_cycles`, `corrupt` (a bit) |
//!
//! A load or force without `for_s` stays. It comes on and goes within `plant.cutting.rise_s` of the machine
//! file; a spike does not.

mod event;
mod faults;
mod loads;
mod standing;
mod trigger;

use protocol::operator::Request;
use protocol::{Axis, Doom, Module};
use serde::Deserialize;

use crate::orders::Packet;
use event::RawEvent;

/// What a scenario that cannot be played has wrong.
#[derive(Debug, thiserror::Error)]
pub enum ScenarioError {
    /// Not TOML, or not a list of `[[event]]`; the message shows the place.
    #[error("{0}")]
    Syntax(#[from] Box<toml::de::Error>),
    /// An event that makes no sense.
    #[error("event {number}: {reason}")]
    Event {
        /// Which `[[event]]` of the file, from 1.
        number: usize,
        /// The key, what is wrong with it, and the remedy.
        reason: String,
    },
}

/// What happens to the machine while it runs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scenario {
    pub(crate) events: Vec<Event>,
    /// Somebody stands at the panel: nobody else ends a pause.
    pub(crate) attended: bool,
}

/// One `[[event]]`.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Event {
    pub(crate) trigger: Trigger,
    pub(crate) action: Action,
}

/// When an event happens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Trigger {
    PassZ { pass: u32, z_mm: f64 },
    PassAngle { pass: u32, angle_deg: f64 },
    AfterPass { pass: u32 },
    Time { time_s: f64 },
    Cycle { cycle: u64 },
    Line { line: u32 },
}

/// What happens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Action {
    Turn {
        knob: Knob,
        pct: f64,
        ramp_s: f64,
    },
    /// A button or a switch.
    Press(Request),
    Burden {
        burden: Burden,
        amount: f64,
        for_s: Option<f64>,
    },
    /// Torque that holds the spindle back, N·m for each 1/min of its speed when it comes on.
    LoadBySpeed {
        nm_per_rpm: f64,
        for_s: Option<f64>,
    },
    /// The counter of the spindle encoder jumps.
    Glitch {
        counts: i64,
        for_s: Option<f64>,
    },
    /// The index of the spindle encoder is not seen.
    IndexLost {
        for_s: Option<f64>,
    },
    /// The counter of the spindle encoder stands.
    EncoderStands {
        for_s: Option<f64>,
    },
    /// The counter of the spindle encoder is off by up to so many counts, another number in each cycle.
    EncoderNoise {
        counts: u32,
    },
    /// Amplitude of an error once a turn, counts.
    EncoderEccentricity {
        counts: f64,
    },
    /// The counter of an axis jumps.
    AxisJump {
        axis: Axis,
        mm: f64,
    },
    /// A force on the slide of an axis that has no ramp.
    Spike {
        axis: Axis,
        force_n: f64,
        for_s: f64,
    },
    PowerLost,
    DriveFault {
        axis: Axis,
        torque_lost: bool,
    },
    SpindleFault {
        fault: SpindleFault,
        for_s: Option<f64>,
    },
    /// A module is killed, or freezes and perhaps thaws.
    Doom {
        doom: Doom,
        module: Module,
        for_s: Option<f64>,
    },
    Packet(Packet),
    /// An input goes on or off, so much later.
    Input {
        number: u8,
        on: bool,
        after_s: f64,
    },
}

impl Action {
    /// Whether it ends the program, whatever the machine does.
    pub(crate) fn ends(self) -> bool {
        use Request::{Abort, EmergencyStop, Stop};
        matches!(self, Action::Press(Stop | Abort | EmergencyStop) | Action::PowerLost)
    }
}

/// What can be wrong with the drive of the spindle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SpindleFault {
    /// It gives all its torque, whatever is commanded.
    Runaway,
    /// It turns the other way.
    Reversal,
    /// It gives no torque.
    Stall,
    /// Something holds what turns.
    Jam,
}

/// The three override knobs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Knob {
    Spindle,
    Feed,
    Rapid,
}

/// What the cut does to the machine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Burden {
    /// Torque that holds the spindle back, N·m.
    Spindle,
    /// Force on the slide of Z, N.
    Axial,
    /// Force on the slide of X, N.
    Radial,
}

impl Scenario {
    /// Nothing happens.
    pub fn none() -> Scenario {
        Scenario::default()
    }

    /// The knob of the spindle override stands at `pct` per cent, 0 to 200, from the start.
    pub fn spindle_override(pct: f64) -> Scenario {
        let turn = Action::Turn { knob: Knob::Spindle, pct: pct.clamp(0.0, 200.0), ramp_s: 0.0 };
        let events = vec![Event { trigger: Trigger::Cycle { cycle: 0 }, action: turn }];
        Scenario { events, attended: false }
    }

    /// Whether nothing happens.
    pub fn is_empty(&self) -> bool {
        self.events.is_empty()
    }

    /// The first event, from 1, that only the machine in one process can play: wires between processes cannot
    /// be disturbed.
    pub fn needs_one_process(&self) -> Option<usize> {
        let disturbs = |event: &Event| matches!(event.action, Action::Packet(_));
        self.events.iter().position(disturbs).map(|index| index + 1)
    }

    /// The first event, from 1, that needs a time which goes on while a process is frozen. Between processes
    /// in lock step there is none: everybody waits for the frozen one, and its thaw never comes.
    pub fn needs_time_to_go_on(&self) -> Option<usize> {
        let thaws = |event: &Event| matches!(event.action, Action::Doom { for_s: Some(_), .. });
        self.events.iter().position(thaws).map(|index| index + 1)
    }

    /// The control cycle of the last event that has a time or a cycle; 0 without one.
    pub fn last_by_clock(&self, cycle_s: f64) -> u64 {
        let cycle = |event: &Event| match event.trigger {
            Trigger::Time { time_s } => (time_s / cycle_s).ceil() as u64,
            Trigger::Cycle { cycle } => cycle,
            _ => 0,
        };
        self.events.iter().map(cycle).max().unwrap_or(0)
    }

    /// The inputs that events act on, with the number of the event, from 1.
    pub(crate) fn inputs(&self) -> impl Iterator<Item = (usize, u32)> {
        self.events.iter().zip(1..).filter_map(|(event, index)| match event.action {
            Action::Input { number, .. } => Some((index, u32::from(number))),
            _ => None,
        })
    }

    /// The axes that events act on, with the number of the event, from 1.
    pub(crate) fn axes(&self) -> impl Iterator<Item = (usize, Axis)> {
        let axis = |(index, event): (usize, &Event)| match event.action {
            Action::AxisJump { axis, .. } | Action::Spike { axis, .. } | Action::DriveFault { axis, .. } => {
                Some((index + 1, axis))
            }
            Action::Doom { module: Module::Regulator(axis), .. } => Some((index + 1, axis)),
            Action::Packet(packet) => packet.channel.axis().map(|axis| (index + 1, axis)),
            _ => None,
        };
        self.events.iter().enumerate().filter_map(axis)
    }

    /// Reads and checks a scenario file.
    ///
    /// # Errors
    /// [`ScenarioError`] names the event and the key, and says what to write instead.
    pub fn from_toml(text: &str) -> Result<Scenario, ScenarioError> {
        let file: File = toml::from_str(text).map_err(Box::new)?;
        let events = file.event.into_iter().enumerate().map(|(index, table)| {
            RawEvent::deserialize(table)
                .map_err(|error| error.to_string().trim_end().replace('\n', " "))
                .and_then(RawEvent::check)
                .map_err(|reason| ScenarioError::Event { number: index + 1, reason })
        });
        let events: Vec<Event> = events.collect::<Result<_, _>>()?;
        match standing::forever(&events) {
            Some((index, reason)) if file.panel.is_none() => {
                Err(ScenarioError::Event { number: index + 1, reason })
            }
            _ => Ok(Scenario { events, attended: file.panel == Some(AtThePanel::Live) }),
        }
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    #[serde(default)]
    panel: Option<AtThePanel>,
    #[serde(default)]
    event: Vec<toml::Table>,
}

/// Who stands at the panel besides the events.
#[derive(Clone, Copy, Deserialize, PartialEq)]
#[serde(rename_all = "lowercase")]
enum AtThePanel {
    /// A person, who may leave a machine standing and comes back.
    Live,
    /// Nobody any more: the events hold what a person pressed.
    Recorded,
}

fn check_duration(key: &str, for_s: Option<f64>) -> Result<(), String> {
    for_s.map_or(Ok(()), |for_s| range(&format!("{key}.for_s"), for_s, 1e-4, 1e6))
}

fn range(key: &str, value: f64, low: f64, high: f64) -> Result<(), String> {
    if (low..=high).contains(&value) {
        return Ok(());
    }
    Err(format!("{key} = {value}: must lie between {low} and {high}"))
}
