//! What happens to a machine in a case. In: numbers of cycles, names of wires and modules. Out: the kind an
//! event is counted by, its line in a scenario file, and what it may excuse of the physics.

use core::fmt::Write as _;

use protocol::{Axis, Module};

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
    /// So many messages in a row do not arrive as they were sent.
    Packet(Channel, Fate, u64),
    /// A module dies.
    Kill(Module),
    /// A module stands still: for s, or until its launcher loses patience.
    Freeze(Module, Option<f64>),
    /// Something at the machine breaks.
    Plant(Trouble),
}

/// Where messages go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Channel {
    /// Machine code to the interpolator.
    Code,
    /// Measurements to the interpolator.
    Ticks,
    /// Measurements to every regulator.
    Measurements,
    /// Measurements to one regulator.
    Measurement(Axis),
    /// Frames to a regulator.
    Frame(Axis),
    /// Statuses of a regulator.
    Status(Axis),
    /// Commands to the spindle.
    Spindle,
    /// Commands to a drive.
    Drive(Axis),
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
    /// It comes so many cycles later.
    Delay(u32),
    /// It comes twice.
    Duplicate,
    /// It comes behind the next one.
    Reorder,
    /// One bit of it is turned over.
    Corrupt(u32),
}

/// What breaks at the machine, in words of the scenario file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Trouble {
    /// Torque against the spindle, N·m, for s.
    Dip(f64, f64),
    /// Torque that the spindle drive does not overcome, N·m, for s.
    Load(f64, f64),
    /// A fault of the spindle, for s.
    Spindle(SpindleFault, f64),
    /// Force on the slide of Z or of X, N, for s, coming on and going softly.
    Force(Axis, f64, f64),
    /// Force on a slide, N, for s, at once.
    Spike(Axis, f64, f64),
    /// Counts of the spindle encoder that are lost (negative) or gained, for good.
    Counts(i64),
    /// The counter jumps and comes back after s.
    Glitch(i64, f64),
    /// No index for s.
    IndexLost(f64),
    /// The counter stands; for s, or for good.
    Stands(Option<f64>),
    /// Counts of noise.
    Noise(u32),
    /// Counts of eccentricity.
    Eccentricity(f64),
    /// The encoder of an axis jumps, mm.
    Jump(Axis, f64),
    /// A drive trips.
    DriveFault(Axis),
    /// A drive has no torque at once.
    TorqueLost(Axis),
    /// The mains fail.
    PowerLost,
}

/// What goes wrong with the spindle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SpindleFault {
    /// All the torque there is.
    Runaway,
    /// The wrong way round.
    Reversal,
    /// No torque.
    Stall,
    /// Something holds it.
    Jam,
}

impl What {
    /// The kind it is counted by.
    pub fn kind(&self) -> &'static str {
        match self {
            What::Press(button) => button.kind(),
            What::Packet(_, fate, _) => match fate {
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
            Trouble::Load(..) => "spindle-load",
            Trouble::Spindle(fault, _) => match fault {
                SpindleFault::Runaway => "spindle-runaway",
                SpindleFault::Reversal => "spindle-reversal",
                SpindleFault::Stall => "spindle-stall",
                SpindleFault::Jam => "spindle-jam",
            },
            Trouble::Force(..) => "force",
            Trouble::Spike(..) => "force-spike",
            Trouble::Counts(counts) if counts < 0 => "counts-lost",
            Trouble::Counts(_) => "counts-gained",
            Trouble::Glitch(..) => "encoder-glitch",
            Trouble::IndexLost(_) => "index-lost",
            Trouble::Stands(_) => "encoder-stands",
            Trouble::Noise(_) => "encoder-noise",
            Trouble::Eccentricity(_) => "encoder-eccentricity",
            Trouble::Jump(..) => "axis-jump",
            Trouble::DriveFault(_) => "drive-fault",
            Trouble::TorqueLost(_) => "torque-lost",
            Trouble::PowerLost => "power-lost",
        }
    }
}

impl Channel {
    /// Its name, as in the table of channels.
    pub fn name(self) -> String {
        match self {
            Channel::Code => "machine-code".into(),
            Channel::Ticks => "measurement/interpolator".into(),
            Channel::Measurements => "measurement".into(),
            Channel::Measurement(axis) => format!("measurement/{}", axis.name()),
            Channel::Frame(axis) => format!("axis-command/{}", axis.name()),
            Channel::Status(axis) => format!("axis-status/{}", axis.name()),
            Channel::Spindle => "spindle-command".into(),
            Channel::Drive(axis) => format!("drive-command/{}", axis.name()),
        }
    }
}

impl Fate {
    fn key(self) -> String {
        match self {
            Fate::Drop => "drop = true".into(),
            Fate::Delay(cycles) => format!("delay_cycles = {cycles}"),
            Fate::Duplicate => "duplicate = true".into(),
            Fate::Reorder => "reorder = true".into(),
            Fate::Corrupt(bit) => format!("corrupt = {bit}"),
        }
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
            What::Packet(channel, fate, count) => {
                let (name, key) = (channel.name(), fate.key());
                event(at, &format!("packet = {{ channel = \"{name}\", count = {count}, {key} }}"));
            }
            What::Kill(module) => event(at, &format!("kill = \"{}\"", module.name())),
            What::Freeze(module, None) => event(at, &format!("freeze = \"{}\"", module.name())),
            What::Freeze(module, Some(s)) => {
                event(at, &format!("freeze = {{ process = \"{}\", for_s = {s:.5} }}", module.name()));
            }
        }
    }

    /// The same event as a person reads it.
    pub fn told(&self) -> String {
        format!("cycle {}: {:?}", self.at, self.what)
    }
}

impl Trouble {
    fn action(self) -> String {
        match self {
            Trouble::Dip(nm, s) | Trouble::Load(nm, s) => {
                format!("spindle_load = {{ torque_nm = {nm:.3}, for_s = {s:.4} }}")
            }
            Trouble::Spindle(fault, s) => {
                let name = match fault {
                    SpindleFault::Runaway => "runaway",
                    SpindleFault::Reversal => "reversal",
                    SpindleFault::Stall => "stall",
                    SpindleFault::Jam => "jam",
                };
                format!("spindle_fault = {{ fault = \"{name}\", for_s = {s:.4} }}")
            }
            Trouble::Force(Axis::Z, n, s) => {
                format!("axial_force_n = {{ force_n = {n:.1}, for_s = {s:.4} }}")
            }
            Trouble::Force(_, n, s) => format!("radial_force_n = {{ force_n = {n:.1}, for_s = {s:.4} }}"),
            Trouble::Spike(axis, n, s) => {
                format!("force_spike = {{ axis = \"{}\", force_n = {n:.1}, for_s = {s:.4} }}", axis.name())
            }
            Trouble::Counts(counts) => format!("encoder_glitch_counts = {counts}"),
            Trouble::Glitch(counts, s) => {
                format!("encoder_glitch_counts = {{ counts = {counts}, for_s = {s:.4} }}")
            }
            Trouble::IndexLost(s) => format!("index_lost = {{ for_s = {s:.4} }}"),
            Trouble::Stands(Some(s)) => format!("encoder_stands = {{ for_s = {s:.4} }}"),
            Trouble::Stands(None) => "encoder_stands = true".into(),
            Trouble::Noise(counts) => format!("encoder_noise_counts = {counts}"),
            Trouble::Eccentricity(counts) => format!("encoder_eccentricity_counts = {counts:.2}"),
            Trouble::Jump(axis, mm) => {
                format!("axis_jump = {{ axis = \"{}\", mm = {mm:.5} }}", axis.name())
            }
            Trouble::DriveFault(axis) => format!("drive_fault = \"{}\"", axis.name()),
            Trouble::TorqueLost(axis) => {
                format!("drive_fault = {{ axis = \"{}\", torque_lost = true }}", axis.name())
            }
            Trouble::PowerLost => "power_lost = true".into(),
        }
    }
}
