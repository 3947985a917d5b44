//! Pauses of the program, and what ended each of them. In: the record of every control cycle. Out: a
//! [`PauseReport`] of each, s.

use protocol::Panel;
use serde::{Deserialize, Serialize};

use super::Record;

/// A pause of the program.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PauseReport {
    /// Line of the part program.
    pub line: u32,
    /// Control cycle in which it was first seen.
    pub cycle: u64,
    /// How long the program waited, s.
    pub waited_s: f64,
    /// What ended it.
    #[serde(default)]
    pub ended_by: PauseEnd,
}

/// What ended a pause.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PauseEnd {
    /// The program went on.
    #[default]
    CycleStart,
    /// The operator ended the program.
    Stop,
    /// The operator ended the program at once.
    Abort,
    /// Emergency stop.
    EmergencyStop,
    /// The mains failed.
    PowerLost,
    /// Another fault.
    Fault,
    /// Nothing: the record ends before it.
    Nothing,
}

impl PauseEnd {
    /// For people.
    pub fn text(self) -> &'static str {
        match self {
            PauseEnd::CycleStart => "cycle start",
            PauseEnd::Stop => "stop",
            PauseEnd::Abort => "abort",
            PauseEnd::EmergencyStop => "emergency stop",
            PauseEnd::PowerLost => "loss of power",
            PauseEnd::Fault => "a fault",
            PauseEnd::Nothing => "end of the record",
        }
    }
}

/// Watches the pauses of a run.
#[derive(Clone, Default)]
pub(super) struct Pauses {
    paused: bool,
    /// Buttons that were pressed in the pause in hand: one press may be shorter than a tick.
    buttons: u32,
    seen: Vec<PauseReport>,
}

impl Pauses {
    /// Takes one control cycle; the status that ends a pause is of the tick that saw why.
    pub(super) fn cycle(&mut self, record: &Record, cycle_s: f64) {
        let paused = record.machine.state().waits_for_start();
        let was = std::mem::replace(&mut self.paused, paused);
        let cycle = record.truth.cycle.0;
        if paused && !was {
            let (line, ended_by) = (record.machine.line, PauseEnd::Nothing);
            self.seen.push(PauseReport { line, cycle, waited_s: 0.0, ended_by });
            self.buttons = 0;
        }
        if !paused && !was {
            return;
        }
        self.buttons |= record.truth.measurement.panel.buttons;
        let Some(pause) = self.seen.last_mut() else { return };
        if paused {
            pause.waited_s = (cycle + 1 - pause.cycle) as f64 * cycle_s;
        } else {
            pause.ended_by = ended_by(self.buttons, record.machine.fault != 0);
        }
    }

    /// The pauses in the order of their coming.
    pub(super) fn finish(self) -> Vec<PauseReport> {
        self.seen
    }
}

/// By the buttons of the pause, most urgent first, and whether a fault is latched behind it.
fn ended_by(buttons: u32, faulted: bool) -> PauseEnd {
    let pressed = |button: u32| buttons & button != 0;
    match () {
        () if pressed(Panel::EMERGENCY_STOP) => PauseEnd::EmergencyStop,
        () if pressed(Panel::POWER_LOST) => PauseEnd::PowerLost,
        () if faulted => PauseEnd::Fault,
        () if pressed(Panel::ABORT) => PauseEnd::Abort,
        () if pressed(Panel::STOP) => PauseEnd::Stop,
        () => PauseEnd::CycleStart,
    }
}
