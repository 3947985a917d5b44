//! What breaks, and what inputs show: the spindle encoder, drives, modules, messages, inputs. In: the values
//! of an event. Out: checked actions.

use protocol::{Axis, Doom, INPUTS, Module};
use serde::Deserialize;

use super::{Action, SpindleFault, check_duration, range};
use crate::orders::{Channel, Packet, Tampering};

/// Most counts of a glitch.
const MOST_COUNTS: i64 = 1_000_000_000;
/// Most messages, and most cycles of a delay.
const MOST_MESSAGES: f64 = 1e6;
const MOST_CYCLES: f64 = 1e5;

/// `encoder_glitch_counts`
#[derive(Deserialize)]
#[serde(untagged, expecting = "expected a number of counts, or { counts, for_s }")]
pub(super) enum RawGlitch {
    Lasting(i64),
    Passing(RawPassingGlitch),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawPassingGlitch {
    counts: i64,
    for_s: f64,
}

impl RawGlitch {
    pub(super) fn check(&self) -> Result<Action, String> {
        const KEY: &str = "encoder_glitch_counts";
        let (counts, for_s) = match self {
            RawGlitch::Lasting(counts) => (*counts, None),
            RawGlitch::Passing(glitch) => (glitch.counts, Some(glitch.for_s)),
        };
        check_duration(KEY, for_s)?;
        if counts == 0 || !(-MOST_COUNTS..=MOST_COUNTS).contains(&counts) {
            return Err(format!(
                "{KEY} = {counts}: must lie between -{MOST_COUNTS} and {MOST_COUNTS}, and not be 0"
            ));
        }
        Ok(Action::Glitch { counts, for_s })
    }
}

/// `index_lost`, `encoder_stands`
#[derive(Deserialize)]
#[serde(untagged, expecting = "expected true, or { for_s }")]
pub(super) enum RawPassing {
    Lasting(bool),
    Passing(RawDuration),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawDuration {
    for_s: f64,
}

impl RawPassing {
    /// How long; `otherwise` says what is the case without it.
    pub(super) fn check(&self, key: &str, otherwise: &str) -> Result<Option<f64>, String> {
        let for_s = match self {
            RawPassing::Lasting(true) => None,
            RawPassing::Lasting(false) => {
                return Err(format!("{key}: write true or {{ for_s }}; {otherwise}"));
            }
            RawPassing::Passing(RawDuration { for_s }) => Some(*for_s),
        };
        check_duration(key, for_s)?;
        Ok(for_s)
    }
}

/// `encoder_noise_counts`
pub(super) fn noise(counts: i64) -> Result<Action, String> {
    range("encoder_noise_counts", counts as f64, 0.0, 1000.0)?;
    Ok(Action::EncoderNoise { counts: counts as u32 })
}

/// `encoder_eccentricity_counts`
pub(super) fn eccentricity(counts: f64) -> Result<Action, String> {
    range("encoder_eccentricity_counts", counts, 0.0, 1e6)?;
    Ok(Action::EncoderEccentricity { counts })
}

/// `axis_jump`
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawJump {
    axis: Axis,
    mm: f64,
}

impl RawJump {
    pub(super) fn check(&self) -> Result<Action, String> {
        range("axis_jump.mm", self.mm, -1e3, 1e3)?;
        if self.mm == 0.0 {
            return Err("axis_jump.mm = 0: must not be 0".into());
        }
        Ok(Action::AxisJump { axis: self.axis, mm: self.mm })
    }
}

/// `drive_fault`
#[derive(Deserialize)]
#[serde(untagged, expecting = "expected an axis, or { axis, torque_lost = true }")]
pub(super) enum RawDriveFault {
    Brakes(Axis),
    Which(RawWhichFault),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawWhichFault {
    axis: Axis,
    #[serde(default)]
    torque_lost: bool,
}

impl RawDriveFault {
    pub(super) fn check(&self) -> Result<Action, String> {
        let (axis, torque_lost) = match self {
            RawDriveFault::Brakes(axis) => (*axis, false),
            RawDriveFault::Which(RawWhichFault { axis, torque_lost }) => (*axis, *torque_lost),
        };
        Ok(Action::DriveFault { axis, torque_lost })
    }
}

/// `spindle_fault`
#[derive(Deserialize)]
#[serde(untagged, expecting = "expected the name of a fault, or { fault, for_s }")]
pub(super) enum RawSpindleFault {
    Lasting(String),
    Passing(RawPassingFault),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawPassingFault {
    fault: String,
    for_s: f64,
}

impl RawSpindleFault {
    pub(super) fn check(&self) -> Result<Action, String> {
        const KEY: &str = "spindle_fault";
        let (name, for_s) = match self {
            RawSpindleFault::Lasting(name) => (name, None),
            RawSpindleFault::Passing(fault) => (&fault.fault, Some(fault.for_s)),
        };
        let fault = match name.as_str() {
            "runaway" => SpindleFault::Runaway,
            "reversal" => SpindleFault::Reversal,
            "stall" => SpindleFault::Stall,
            "jam" => SpindleFault::Jam,
            _ => {
                return Err(format!(
                    "{KEY} = \"{name}\": must be \"runaway\", \"reversal\", \"stall\" or \"jam\""
                ));
            }
        };
        check_duration(KEY, for_s)?;
        Ok(Action::SpindleFault { fault, for_s })
    }
}

/// The module of a process.
pub(super) fn module(key: &str, name: &str) -> Result<Module, String> {
    Module::from_name(name).ok_or_else(|| {
        format!(
            "{key} = \"{name}\": must be \"interpreter\", \"interpolator\", or \"regulator-x\" of an axis"
        )
    })
}

/// `freeze`
#[derive(Deserialize)]
#[serde(untagged, expecting = "expected the name of a process, or { process, for_s }")]
pub(super) enum RawFreeze {
    Lasting(String),
    Passing(RawPassingFreeze),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawPassingFreeze {
    process: String,
    for_s: f64,
}

impl RawFreeze {
    pub(super) fn check(&self) -> Result<Action, String> {
        let (name, for_s) = match self {
            RawFreeze::Lasting(name) => (name, None),
            RawFreeze::Passing(freeze) => (&freeze.process, Some(freeze.for_s)),
        };
        check_duration("freeze", for_s)?;
        Ok(Action::Doom { doom: Doom::Freeze, module: module("freeze", name)?, for_s })
    }
}

/// `packet`
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawPacket {
    channel: String,
    #[serde(default)]
    drop: bool,
    #[serde(default)]
    duplicate: bool,
    #[serde(default)]
    reorder: bool,
    delay_cycles: Option<u32>,
    corrupt: Option<u32>,
    count: Option<u32>,
}

impl RawPacket {
    pub(super) fn check(&self) -> Result<Action, String> {
        let channel = Channel::from_name(&self.channel).ok_or_else(|| {
            let names = Channel::NAMES;
            format!("packet.channel = \"{}\": must be one of {names}", self.channel)
        })?;
        let given = [
            self.drop.then_some(Tampering::Drop),
            self.duplicate.then_some(Tampering::Duplicate),
            self.reorder.then_some(Tampering::Reorder),
            self.delay_cycles.map(|cycles| Tampering::Delay { cycles }),
            self.corrupt.map(|bit| Tampering::Corrupt { bit }),
        ];
        let mut given = given.into_iter().flatten();
        let (Some(tampering), None) = (given.next(), given.next()) else {
            return Err(
                "packet takes one of drop = true, duplicate = true, reorder = true, delay_cycles and \
                        corrupt (a bit of the message)"
                    .into(),
            );
        };
        if let Tampering::Delay { cycles } = tampering {
            range("packet.delay_cycles", f64::from(cycles), 1.0, MOST_CYCLES)?;
        }
        let count = self.count.unwrap_or(1);
        range("packet.count", f64::from(count), 1.0, MOST_MESSAGES)?;
        Ok(Action::Packet(Packet { channel, tampering, count }))
    }
}

/// `input`
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawInput {
    number: u32,
    on: bool,
    #[serde(default)]
    after_s: f64,
}

impl RawInput {
    pub(super) fn check(&self) -> Result<Action, String> {
        range("input.number", f64::from(self.number), 0.0, f64::from(INPUTS - 1))?;
        range("input.after_s", self.after_s, 0.0, 1e4)?;
        Ok(Action::Input { number: self.number as u8, on: self.on, after_s: self.after_s })
    }
}
