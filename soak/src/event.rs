//! What happens to a machine in a case. In: numbers of cycles, names of wires and modules. Out: the kind an
//! event is counted by, its line in a scenario file, and what it may excuse of the physics.

use core::fmt::Write as _;

use protocol::{Axis, Module};
use rig::wires::Wire;

/// Something that happens in a cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Event {
    /// The control cycle in which it begins.
    pub at: u64,
    /// What it is.
    pub what: What,
}

/// What can happen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum What {
    /// Somebody does something at the panel.
    Press(Button),
    /// Messages on a wire do not arrive as they were sent, so many of them in a row.
    Wire {
        /// Which wire.
        wire: Wire,
        /// What becomes of each.
        fate: Fate,
        /// For so many cycles.
        cycles: u64,
    },
    /// A module dies.
    Kill(Module),
    /// A module stands still: for so many cycles, or until its launcher loses patience.
    Freeze(Module, Option<u64>),
    /// Something at the machine breaks.
    Plant(Trouble),
}

/// What an operator does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Button {
    /// Feed hold, and cycle start so many cycles later.
    Hold(u64),
    /// Cycle start, perhaps for nothing.
    Start,
    /// Stop.
    Stop,
    /// Abort.
    Abort,
    /// Emergency stop.
    EmergencyStop,
    /// Single block on; cycle start is pressed every so many cycles from then on.
    SingleBlock(u64),
    /// Spindle override, per cent.
    Spindle(f64),
    /// Feed override, per cent.
    Feed(f64),
    /// Rapid override, per cent.
    Rapid(f64),
}

/// What becomes of a message.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fate {
    /// It never arrives.
    Drop,
    /// It comes so many moments of its wire later.
    Delay(u32),
    /// It comes twice.
    Duplicate,
    /// It changes places with the next one.
    Reorder,
    /// One bit of it is turned over.
    Corrupt(u32),
}

/// What breaks at the machine, in words of the scenario file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Trouble {
    /// Torque against the spindle, N·m, for s.
    Dip(f64, f64),
    /// Torque that no spindle drive overcomes, N·m, for s.
    Stall(f64, f64),
    /// Force on the slide of Z or of X, N, for s.
    Force(Axis, f64, f64),
    /// Counts of the spindle encoder that are lost (negative) or gained, for good.
    Counts(i64),
    /// The counter jumps and comes back after s.
    Glitch(i64, f64),
    /// No index for s.
    IndexLost(f64),
}

impl What {
    /// The kind it is counted by.
    pub fn kind(&self) -> &'static str {
        match self {
            What::Press(button) => button.kind(),
            What::Wire { fate, .. } => match fate {
                Fate::Drop => "packet-drop",
                Fate::Delay(_) => "packet-delay",
                Fate::Duplicate => "packet-duplicate",
                Fate::Reorder => "packet-reorder",
                Fate::Corrupt(_) => "packet-corrupt",
            },
            What::Kill(module) => match module {
                Module::Interpreter => "kill-interpreter",
                Module::Interpolator => "kill-interpolator",
                Module::Regulator(_) => "kill-regulator",
            },
            What::Freeze(module, until) => match (module, until) {
                (Module::Interpreter, _) => "freeze-interpreter",
                (Module::Interpolator, None) => "freeze-interpolator",
                (Module::Regulator(_), None) => "freeze-regulator",
                (Module::Interpolator, Some(_)) => "pause-interpolator",
                (Module::Regulator(_), Some(_)) => "pause-regulator",
            },
            What::Plant(trouble) => trouble.kind(),
        }
    }
}

impl Button {
    fn kind(self) -> &'static str {
        match self {
            Button::Hold(_) => "hold",
            Button::Start => "cycle-start",
            Button::Stop => "stop",
            Button::Abort => "abort",
            Button::EmergencyStop => "emergency-stop",
            Button::SingleBlock(_) => "single-block",
            Button::Spindle(_) => "spindle-override",
            Button::Feed(_) => "feed-override",
            Button::Rapid(_) => "rapid-override",
        }
    }
}

impl Trouble {
    fn kind(self) -> &'static str {
        match self {
            Trouble::Dip(..) => "spindle-dip",
            Trouble::Stall(..) => "spindle-stall",
            Trouble::Force(..) => "force-spike",
            Trouble::Counts(counts) if counts < 0 => "counts-lost",
            Trouble::Counts(_) => "counts-gained",
            Trouble::Glitch(..) => "encoder-glitch",
            Trouble::IndexLost(_) => "index-lost",
        }
    }
}

/// The wire's channel and receiver, as in the table of channels.
pub fn channel(wire: Wire) -> String {
    match wire {
        Wire::Code => "machine-code".into(),
        Wire::TickMeasurement => "measurement/interpolator".into(),
        Wire::Measurement(axis) => format!("measurement/{}", axis.name()),
        Wire::Frame(axis) => format!("axis-command/{}", axis.name()),
        Wire::Status(axis) => format!("axis-status/{}", axis.name()),
        Wire::Spindle => "spindle-command".into(),
        Wire::Drive(axis) => format!("drive-command/{}", axis.name()),
    }
}

impl Event {
    /// What the plant plays of it: `[[event]]` tables of a scenario file.
    pub fn scenario(&self, text: &mut String) {
        let mut event = |at: u64, action: &str| {
            let _ = writeln!(text, "[[event]]\nat = {{ cycle = {at} }}\n{action}");
        };
        let at = self.at;
        match self.what {
            What::Press(button) => match button {
                Button::Hold(cycles) => {
                    event(at, "feed_hold = true");
                    event(at + cycles, "cycle_start = true");
                }
                Button::Start => event(at, "cycle_start = true"),
                Button::Stop => event(at, "stop = true"),
                Button::Abort => event(at, "abort = true"),
                Button::EmergencyStop => event(at, "emergency_stop = true"),
                Button::SingleBlock(every) => {
                    event(at, "single_block = true");
                    (1..30).for_each(|n| event(at + n * every, "cycle_start = true"));
                    event(at + 30 * every, "single_block = false");
                    event(at + 31 * every, "cycle_start = true");
                }
                Button::Spindle(pct) => event(at, &format!("spindle_override_pct = {pct:.1}")),
                Button::Feed(pct) => event(at, &format!("feed_override_pct = {pct:.1}")),
                Button::Rapid(pct) => event(at, &format!("rapid_override_pct = {pct:.1}")),
            },
            What::Plant(trouble) => event(at, &trouble.action()),
            What::Wire { .. } | What::Kill(_) | What::Freeze(..) => {}
        }
    }

    /// The same event as a person reads it.
    pub fn told(&self) -> String {
        let at = self.at;
        match self.what {
            What::Wire { wire, fate, cycles } => {
                format!("cycle {at}: {fate:?} on {} for {cycles} cycles", channel(wire))
            }
            What::Kill(module) => format!("cycle {at}: kill {}", module.name()),
            What::Freeze(module, None) => format!("cycle {at}: freeze {}", module.name()),
            What::Freeze(module, Some(cycles)) => {
                format!("cycle {at}: freeze {} for {cycles} cycles", module.name())
            }
            What::Press(button) => format!("cycle {at}: {button:?}"),
            What::Plant(trouble) => format!("cycle {at}: {trouble:?}"),
        }
    }
}

impl Trouble {
    fn action(self) -> String {
        match self {
            Trouble::Dip(nm, s) | Trouble::Stall(nm, s) => {
                format!("spindle_load = {{ torque_nm = {nm:.3}, for_s = {s:.4} }}")
            }
            Trouble::Force(Axis::Z, n, s) => {
                format!("axial_force_n = {{ force_n = {n:.1}, for_s = {s:.4} }}")
            }
            Trouble::Force(_, n, s) => format!("radial_force_n = {{ force_n = {n:.1}, for_s = {s:.4} }}"),
            Trouble::Counts(counts) => format!("encoder_glitch_counts = {counts}"),
            Trouble::Glitch(counts, s) => {
                format!("encoder_glitch_counts = {{ counts = {counts}, for_s = {s:.4} }}")
            }
            Trouble::IndexLost(s) => format!("index_lost = {{ for_s = {s:.4} }}"),
        }
    }
}
