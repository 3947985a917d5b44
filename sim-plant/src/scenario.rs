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
//! | action | value |
//! |---|---|
//! | `spindle_override_pct`, `feed_override_pct` | 0 to 200; with `ramp_s` the knob is turned evenly over that time |
//! | `rapid_override_pct` | 0 to 100; the same |
//! | `feed_hold`, `cycle_start`, `stop`, `abort` | `true`; a button is pressed, `cycle_start` releases the hold and ends a pause |
//! | `single_block` | `true`, `false`; the switch is turned on or off |
//! | `spindle_load` | `{ torque_nm, for_s }`: holds the spindle back; or `{ nm_per_rpm, for_s }`: so much for each 1/min at that moment |
//! | `axial_force_n`, `radial_force_n` | N on the slide of Z, X, positive along the axis; or `{ force_n, for_s }` |
//! | `encoder_glitch_counts` | the counter of the spindle encoder jumps by so many counts; or `{ counts, for_s }`: and back |
//! | `index_lost` | `true`: the next index of the spindle is not seen; or `{ for_s }`: none in that time |
//!
//! A load or force without `for_s` stays. It comes on and goes within `plant.cutting.rise_s` of the machine
//! file.

use protocol::operator::Request;
use serde::Deserialize;

use crate::encoder::{RawGlitch, RawIndexLost};
use crate::standing;

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
        Scenario { events: vec![Event { trigger: Trigger::Cycle { cycle: 0 }, action: turn }] }
    }

    /// Whether nothing happens.
    pub fn is_empty(&self) -> bool {
        self.events.is_empty()
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
            Some((index, reason)) => Err(ScenarioError::Event { number: index + 1, reason }),
            None => Ok(Scenario { events }),
        }
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    #[serde(default)]
    event: Vec<toml::Table>,
}

/// Every key an event can have; [`RawEvent::check`] sees that there is one trigger and one action.
#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct RawEvent {
    at: Option<RawTrigger>,
    spindle_override_pct: Option<f64>,
    feed_override_pct: Option<f64>,
    rapid_override_pct: Option<f64>,
    ramp_s: Option<f64>,
    feed_hold: Option<bool>,
    cycle_start: Option<bool>,
    stop: Option<bool>,
    abort: Option<bool>,
    single_block: Option<bool>,
    spindle_load: Option<RawLoad>,
    axial_force_n: Option<RawForce>,
    radial_force_n: Option<RawForce>,
    encoder_glitch_counts: Option<RawGlitch>,
    index_lost: Option<RawIndexLost>,
    emergency_stop: Option<toml::Value>,
    kill: Option<toml::Value>,
    drive_fault: Option<toml::Value>,
    packet: Option<toml::Value>,
}

#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct RawTrigger {
    pass: Option<u32>,
    z_mm: Option<f64>,
    angle_deg: Option<f64>,
    after_pass: Option<u32>,
    time_s: Option<f64>,
    cycle: Option<u64>,
    line: Option<u32>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawLoad {
    torque_nm: Option<f64>,
    nm_per_rpm: Option<f64>,
    for_s: Option<f64>,
}

impl RawLoad {
    fn check(&self) -> Result<Action, String> {
        const KEY: &str = "spindle_load";
        match (self.torque_nm, self.nm_per_rpm) {
            (Some(torque_nm), None) => {
                range("spindle_load.torque_nm", torque_nm, 0.0, 1e5)?;
                burden(KEY, Burden::Spindle, torque_nm, self.for_s)
            }
            (None, Some(nm_per_rpm)) => {
                range("spindle_load.nm_per_rpm", nm_per_rpm, 0.0, 1e3)?;
                check_duration(KEY, self.for_s)?;
                Ok(Action::LoadBySpeed { nm_per_rpm, for_s: self.for_s })
            }
            _ => Err(format!("{KEY} takes either torque_nm or nm_per_rpm")),
        }
    }
}

#[derive(Deserialize)]
#[serde(untagged, expecting = "expected a force in N, or { force_n, for_s }")]
enum RawForce {
    Constant(f64),
    Passing(RawPassingForce),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawPassingForce {
    force_n: f64,
    for_s: Option<f64>,
}

const TRIGGERS: &str =
    "{ pass, z_mm }, { pass, angle_deg }, { after_pass }, { time_s }, { cycle } or { line }";

impl RawTrigger {
    fn check(&self) -> Result<Trigger, String> {
        let given =
            (self.pass, self.z_mm, self.angle_deg, self.after_pass, self.time_s, self.cycle, self.line);
        match given {
            (Some(pass), Some(z_mm), None, None, None, None, None) => {
                range("at.z_mm", z_mm, -1e5, 1e5)?;
                Ok(Trigger::PassZ { pass: at_least_one("at.pass", pass)?, z_mm })
            }
            (Some(pass), None, Some(angle_deg), None, None, None, None) => {
                range("at.angle_deg", angle_deg, 0.0, 1e7)?;
                Ok(Trigger::PassAngle { pass: at_least_one("at.pass", pass)?, angle_deg })
            }
            (None, None, None, Some(pass), None, None, None) => {
                Ok(Trigger::AfterPass { pass: at_least_one("at.after_pass", pass)? })
            }
            (None, None, None, None, Some(time_s), None, None) => {
                range("at.time_s", time_s, 0.0, 1e6)?;
                Ok(Trigger::Time { time_s })
            }
            (None, None, None, None, None, Some(cycle), None) => Ok(Trigger::Cycle { cycle }),
            (None, None, None, None, None, None, Some(line)) => {
                Ok(Trigger::Line { line: at_least_one("at.line", line)? })
            }
            (None, None, None, None, None, None, None) => {
                Err(format!("at: no trigger; give one of {TRIGGERS}"))
            }
            _ => Err(format!("at: these keys do not make one trigger; give one of {TRIGGERS}")),
        }
    }
}

impl RawEvent {
    fn check(self) -> Result<Event, String> {
        self.refuse_unavailable()?;
        let trigger = match &self.at {
            Some(at) => at.check()?,
            None => return Err(format!("at: missing; give one of {TRIGGERS}")),
        };
        let ramp_s = self.ramp_s;
        let mut actions = self.actions()?;
        let action = match (actions.pop(), actions.pop()) {
            (Some(action), None) => action,
            (None, _) => return Err("no action; give one, such as spindle_override_pct = 60".into()),
            (Some(_), Some(_)) => {
                return Err("more than one action; give each its own [[event]] with the same at".into());
            }
        };
        match (ramp_s, action) {
            (None, action) => Ok(Event { trigger, action }),
            (Some(ramp_s), Action::Turn { knob, pct, .. }) => {
                range("ramp_s", ramp_s, 0.0, 1e4)?;
                Ok(Event { trigger, action: Action::Turn { knob, pct, ramp_s } })
            }
            (Some(_), _) => Err("ramp_s: only an override can be turned slowly; leave it out here".into()),
        }
    }

    fn refuse_unavailable(&self) -> Result<(), String> {
        for (key, value) in [
            ("emergency_stop", &self.emergency_stop),
            ("kill", &self.kill),
            ("drive_fault", &self.drive_fault),
            ("packet", &self.packet),
        ] {
            if value.is_some() {
                return Err(format!("{key}: this action is not available yet; remove the event"));
            }
        }
        Ok(())
    }

    fn actions(self) -> Result<Vec<Action>, String> {
        let mut actions = Vec::new();
        for (key, given, knob, high) in [
            ("spindle_override_pct", self.spindle_override_pct, Knob::Spindle, 200.0),
            ("feed_override_pct", self.feed_override_pct, Knob::Feed, 200.0),
            ("rapid_override_pct", self.rapid_override_pct, Knob::Rapid, 100.0),
        ] {
            if let Some(pct) = given {
                range(key, pct, 0.0, high)?;
                actions.push(Action::Turn { knob, pct, ramp_s: 0.0 });
            }
        }
        for (key, given, request) in [
            ("feed_hold", self.feed_hold, Request::FeedHold),
            ("cycle_start", self.cycle_start, Request::CycleStart),
            ("stop", self.stop, Request::Stop),
            ("abort", self.abort, Request::Abort),
        ] {
            match given {
                Some(true) => actions.push(Action::Press(request)),
                Some(false) => {
                    return Err(format!(
                        "{key}: a button can only be pressed: write true; cycle_start releases a hold"
                    ));
                }
                None => {}
            }
        }
        actions.extend(self.single_block.map(|on| Action::Press(Request::SingleBlock(on))));
        let load = self.spindle_load.map(|load| load.check());
        let glitch = self.encoder_glitch_counts.map(|glitch| glitch.check());
        let lost = self.index_lost.map(|lost| lost.check());
        for action in [load, glitch, lost].into_iter().flatten() {
            actions.push(action?);
        }
        for (key, given, which) in [
            ("axial_force_n", self.axial_force_n, Burden::Axial),
            ("radial_force_n", self.radial_force_n, Burden::Radial),
        ] {
            let (force_n, for_s) = match given {
                Some(RawForce::Constant(force_n)) => (force_n, None),
                Some(RawForce::Passing(RawPassingForce { force_n, for_s })) => (force_n, for_s),
                None => continue,
            };
            range(key, force_n, -1e5, 1e5)?;
            actions.push(burden(key, which, force_n, for_s)?);
        }
        Ok(actions)
    }
}

fn burden(key: &str, burden: Burden, amount: f64, for_s: Option<f64>) -> Result<Action, String> {
    check_duration(key, for_s)?;
    Ok(Action::Burden { burden, amount, for_s })
}

pub(crate) fn check_duration(key: &str, for_s: Option<f64>) -> Result<(), String> {
    for_s.map_or(Ok(()), |for_s| range(&format!("{key}.for_s"), for_s, 1e-4, 1e6))
}

fn range(key: &str, value: f64, low: f64, high: f64) -> Result<(), String> {
    if (low..=high).contains(&value) {
        return Ok(());
    }
    Err(format!("{key} = {value}: must lie between {low} and {high}"))
}

fn at_least_one(key: &str, value: u32) -> Result<u32, String> {
    if value > 0 { Ok(value) } else { Err(format!("{key} = 0: counted from 1")) }
}
