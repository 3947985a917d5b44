//! One `[[event]]` as it is written. In: its table. Out: a trigger and one action, or what is wrong with it.

use protocol::Doom;
use protocol::operator::Request;
use serde::Deserialize;

use super::faults::{
    RawDriveFault, RawFreeze, RawGlitch, RawInput, RawJump, RawPacket, RawPassing, RawSpindleFault,
    eccentricity, module, noise,
};
use super::loads::{RawForce, RawLoad, RawSpike};
use super::trigger::{RawTrigger, TRIGGERS};
use super::{Action, Burden, Event, Knob, range};

/// Every key an event can have; [`RawEvent::check`] sees that there is one trigger and one action.
#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(super) struct RawEvent {
    at: Option<RawTrigger>,
    spindle_override_pct: Option<f64>,
    feed_override_pct: Option<f64>,
    rapid_override_pct: Option<f64>,
    ramp_s: Option<f64>,
    feed_hold: Option<bool>,
    cycle_start: Option<bool>,
    stop: Option<bool>,
    abort: Option<bool>,
    emergency_stop: Option<bool>,
    power_lost: Option<bool>,
    single_block: Option<bool>,
    optional_stop: Option<bool>,
    jog: Option<bool>,
    block: Option<bool>,
    spindle_load: Option<RawLoad>,
    axial_force_n: Option<RawForce>,
    radial_force_n: Option<RawForce>,
    force_spike: Option<RawSpike>,
    encoder_glitch_counts: Option<RawGlitch>,
    index_lost: Option<RawPassing>,
    encoder_stands: Option<RawPassing>,
    encoder_noise_counts: Option<i64>,
    encoder_eccentricity_counts: Option<f64>,
    axis_jump: Option<RawJump>,
    drive_fault: Option<RawDriveFault>,
    spindle_fault: Option<RawSpindleFault>,
    kill: Option<String>,
    freeze: Option<RawFreeze>,
    packet: Option<RawPacket>,
    input: Option<RawInput>,
}

impl RawEvent {
    pub(super) fn check(self) -> Result<Event, String> {
        let trigger = match &self.at {
            Some(at) => at.check()?,
            None => return Err(format!("at: missing; give one of {TRIGGERS}")),
        };
        let mut actions = self.turned()?;
        actions.extend(self.pressed()?);
        actions.extend(self.done_to_the_machine()?);
        actions.extend(self.broken()?);
        let action = match (actions.pop(), actions.pop()) {
            (Some(action), None) => action,
            (None, _) => return Err("no action; give one, such as spindle_override_pct = 60".into()),
            (Some(_), Some(_)) => {
                return Err("more than one action; give each its own [[event]] with the same at".into());
            }
        };
        match (self.ramp_s, action) {
            (None, action) => Ok(Event { trigger, action }),
            (Some(ramp_s), Action::Turn { knob, pct, .. }) => {
                range("ramp_s", ramp_s, 0.0, 1e4)?;
                Ok(Event { trigger, action: Action::Turn { knob, pct, ramp_s } })
            }
            (Some(_), _) => Err("ramp_s: only an override can be turned slowly; leave it out here".into()),
        }
    }

    fn turned(&self) -> Result<Vec<Action>, String> {
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
        Ok(actions)
    }

    fn pressed(&self) -> Result<Vec<Action>, String> {
        let mut actions = Vec::new();
        for (key, given, action, remedy) in [
            ("feed_hold", self.feed_hold, Action::Press(Request::FeedHold), "cycle_start releases a hold"),
            ("cycle_start", self.cycle_start, Action::Press(Request::CycleStart), "it releases itself"),
            ("stop", self.stop, Action::Press(Request::Stop), "it stays pressed"),
            ("block", self.block, Action::Press(Request::Block), "each begins one block by hand"),
            ("abort", self.abort, Action::Press(Request::Abort), "it stays pressed"),
            (
                "emergency_stop",
                self.emergency_stop,
                Action::Press(Request::EmergencyStop),
                "it stays pressed",
            ),
            ("power_lost", self.power_lost, Action::PowerLost, "the mains do not come back"),
        ] {
            match given {
                Some(true) => actions.push(action),
                Some(false) if key == "power_lost" => return Err(format!("{key}: write true; {remedy}")),
                Some(false) => {
                    return Err(format!("{key}: a button can only be pressed: write true; {remedy}"));
                }
                None => {}
            }
        }
        actions.extend(self.single_block.map(|on| Action::Press(Request::SingleBlock(on))));
        actions.extend(self.optional_stop.map(|on| Action::Press(Request::OptionalStop(on))));
        actions.extend(self.jog.map(|on| Action::Press(Request::Jog(on))));
        Ok(actions)
    }

    /// By the cut, and to the spindle encoder.
    fn done_to_the_machine(&self) -> Result<Vec<Action>, String> {
        let all = [
            self.spindle_load.as_ref().map(RawLoad::check),
            self.axial_force_n.as_ref().map(|force| force.check("axial_force_n", Burden::Axial)),
            self.radial_force_n.as_ref().map(|force| force.check("radial_force_n", Burden::Radial)),
            self.force_spike.as_ref().map(RawSpike::check),
            self.encoder_glitch_counts.as_ref().map(RawGlitch::check),
            self.index_lost.as_ref().map(|lost| {
                let for_s = lost.check("index_lost", "without an event every index is seen")?;
                Ok(Action::IndexLost { for_s })
            }),
            self.encoder_stands.as_ref().map(|stands| {
                let for_s = stands.check("encoder_stands", "without an event it counts")?;
                Ok(Action::EncoderStands { for_s })
            }),
            self.encoder_noise_counts.map(noise),
            self.encoder_eccentricity_counts.map(eccentricity),
        ];
        all.into_iter().flatten().collect()
    }

    /// Drives, modules and what lies between them.
    fn broken(&self) -> Result<Vec<Action>, String> {
        let kill =
            |name: &String| Ok(Action::Doom { doom: Doom::Kill, module: module("kill", name)?, for_s: None });
        let all = [
            self.axis_jump.as_ref().map(RawJump::check),
            self.drive_fault.as_ref().map(RawDriveFault::check),
            self.spindle_fault.as_ref().map(RawSpindleFault::check),
            self.kill.as_ref().map(kill),
            self.freeze.as_ref().map(RawFreeze::check),
            self.packet.as_ref().map(RawPacket::check),
            self.input.as_ref().map(RawInput::check),
        ];
        all.into_iter().flatten().collect()
    }
}
