//! `[spindle]` and `[threading]` of the machine file: the spindle as the controller believes it to be, and
//! how threads are laid out. Out: checked values, or the path of the key and the reason.

use protocol::WayOut;
use serde::{Deserialize, Serialize};

use super::{Kinematics, Machine, MachineError, VariationConfig, range, refuse};

/// `[spindle]`
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SpindleConfig {
    /// Highest speed, 1/min.
    pub max_rpm: f64,
    /// Lines of the encoder (four counts each).
    pub encoder_lines: u32,
    /// Ramp of the drive, 1/min per s.
    pub ramp_rpm_s: f64,
    /// Bandwidth of the angle observer (M53) that leads an axis along a thread, Hz.
    pub observer_hz: f64,
    /// Bandwidth of the one that leads an axis which only strokes to depth and back, Hz.
    #[serde(default = "stroke_observer_hz")]
    pub stroke_observer_hz: f64,
    /// How much older than those of the axes the counts of the spindle are, s: the delay of its encoder.
    #[serde(default)]
    pub encoder_delay_s: f64,
    /// Jitter of the latch at the index, s: what it may be early or late.
    #[serde(default)]
    pub index_jitter_s: f64,
    /// Observers that know nothing of ripple and look at the encoder once in so many control cycles. No key
    /// of a file: experiments ask what it costs, in runs where no measurement is lost.
    #[serde(skip)]
    pub plain_observer_cycles: Option<u32>,
    /// Highest spindle override, per cent.
    pub override_max_pct: f64,
    /// Band around the commanded speed that counts as "at speed", per cent.
    pub at_speed_pct: f64,
}

fn stroke_observer_hz() -> f64 {
    20.0
}

/// `[threading]`
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Threading {
    /// Where the run-out ends.
    pub run_out: RunOut,
    /// Spindle override that run-ins are laid out for, per cent, ≥ 100.
    pub design_override_pct: f64,
    /// Share of the axis limits that a law may use at that override, per cent; the rest is for changes of the
    /// spindle's speed (M8).
    pub limit_share_pct: f64,
    /// Half angle of the flank that a run-out must not touch, degrees: the smallest among the threads to cut.
    pub flank_half_angle_deg: f64,
    /// What feed hold does in a thread.
    pub on_hold: Reaction,
    /// What stop and abort do in a thread.
    pub on_stop: Reaction,
    /// What a fault does that would let the pass be finished.
    pub on_fault: Reaction,
    /// How far the tool lifts off when it leaves a thread whose program names no way out (a G33 without a
    /// retract), mm.
    pub lift_mm: f64,
    /// Counts of the spindle encoder that are lost or gained are corrected within ten turns up to this error
    /// of the lead, µm; beyond it the tool leaves the thread.
    pub lost_counts_um: f64,
    /// Turns without an index after which the tool leaves the thread.
    pub index_lost_turns: f64,
    /// What a thread may be off at the tool before the part counts as not good, µm: the swing of each pass
    /// about its mean, passes and starts against each other, the depth, and that from end to end.
    pub part_error_um: f64,
    /// `[threading.variation]`: how the speed of the spindle is varied in a thread.
    #[serde(skip_serializing_if = "VariationConfig::is_default")]
    pub variation: VariationConfig,
}

/// What becomes of a pass that is interrupted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Reaction {
    /// It is cut to its end first.
    Finish,
    /// The tool leaves the thread at once.
    Leave,
}

impl Default for Threading {
    fn default() -> Self {
        Threading {
            run_out: RunOut::Within,
            design_override_pct: 120.0,
            limit_share_pct: 90.0,
            flank_half_angle_deg: 14.5,
            on_hold: Reaction::Finish,
            on_stop: Reaction::Leave,
            on_fault: Reaction::Leave,
            lift_mm: 2.0,
            lost_counts_um: 5.0,
            index_lost_turns: 3.0,
            part_error_um: 10.0,
            variation: VariationConfig::default(),
        }
    }
}

/// Where the run-out of a thread ends.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum RunOut {
    /// At the programmed end: nothing moves beyond it.
    #[default]
    Within,
    /// Full depth to the programmed end, at rest after it.
    Beyond,
}

impl SpindleConfig {
    /// Bandwidth of the filter through which the interpolator watches the speed, Hz: slow, because it only
    /// judges.
    pub const WATCH_HZ: f64 = 5.0;
    /// Speed below which the spindle counts as standing, 1/min.
    pub const STANDSTILL_RPM: f64 = 1.0;
    /// Time in which the loop of its speed settles behind its ramp, s: an encoder that shows it standing
    /// sooner is not believed.
    pub const SETTLES_S: f64 = 0.2;

    /// A spindle that turns in a pass so many times as fast as the highest override makes it, and a share of
    /// its highest speed on top, is taken by the axes for one that has run away (M103).
    pub const RUNAWAY: [f64; 2] = [1.15, 0.02];

    /// Turns at a new speed, or time if that is shorter, s, after which it has settled and regulators know
    /// what repeats with every turn (M130): a pass waits for it.
    pub const KNOWN: (f64, f64) = (7.0, 1.2);

    /// Bandwidth of the slower of the two observers, Hz: a pass waits for ten of its periods.
    pub fn slowest_observer_hz(&self) -> f64 {
        self.observer_hz.min(self.stroke_observer_hz)
    }

    /// No spindle: one that never turns, with an encoder that nobody reads.
    pub fn none() -> SpindleConfig {
        SpindleConfig {
            max_rpm: 0.0,
            encoder_lines: 1024,
            ramp_rpm_s: 1000.0,
            observer_hz: 30.0,
            stroke_observer_hz: stroke_observer_hz(),
            encoder_delay_s: 0.0,
            index_jitter_s: 0.0,
            plain_observer_cycles: None,
            override_max_pct: 100.0,
            at_speed_pct: 5.0,
        }
    }

    /// Whether there is none.
    pub fn is_none(&self) -> bool {
        self.max_rpm == 0.0
    }

    fn check(&self) -> Result<(), MachineError> {
        range("spindle.max_rpm", self.max_rpm, 1.0, 1e5)?;
        range("spindle.encoder_lines", f64::from(self.encoder_lines), 25.0, 250_000.0)?;
        range("spindle.ramp_rpm_s", self.ramp_rpm_s, 1.0, 1e6)?;
        range("spindle.observer_hz", self.observer_hz, 1.0, 500.0)?;
        range("spindle.stroke_observer_hz", self.stroke_observer_hz, 1.0, 500.0)?;
        range("spindle.encoder_delay_s", self.encoder_delay_s, -2e-4, 2e-4)?;
        range("spindle.index_jitter_s", self.index_jitter_s, 0.0, 1e-4)?;
        range("spindle.override_max_pct", self.override_max_pct, 100.0, 200.0)?;
        range("spindle.at_speed_pct", self.at_speed_pct, 0.5, 100.0)
    }
}

impl Machine {
    /// Refuses a positioner with a spindle, and another machine without one.
    pub(super) fn check_spindle(&self) -> Result<(), MachineError> {
        match (self.general.kinematics, self.spindle.is_none()) {
            (Kinematics::Positioner, true) => Ok(()),
            (Kinematics::Positioner, false) => {
                Err(refuse("spindle", "a table", "a positioner has no spindle: leave [spindle] out"))
            }
            (Kinematics::Lathe | Kinematics::Mill, true) => Err(refuse(
                "spindle",
                "nothing",
                "a lathe or a mill needs [spindle], with max_rpm and its other keys",
            )),
            (Kinematics::Lathe | Kinematics::Mill, false) => self.spindle.check(),
        }
    }
}

impl Threading {
    pub(super) fn check(&self) -> Result<(), MachineError> {
        range("threading.design_override_pct", self.design_override_pct, 100.0, 200.0)?;
        range("threading.limit_share_pct", self.limit_share_pct, 10.0, 100.0)?;
        range("threading.flank_half_angle_deg", self.flank_half_angle_deg, 1.0, 60.0)?;
        range("threading.lift_mm", self.lift_mm, 0.01, 100.0)?;
        range("threading.lost_counts_um", self.lost_counts_um, 0.0, 1000.0)?;
        range("threading.index_lost_turns", self.index_lost_turns, 1.0, 100.0)?;
        range("threading.part_error_um", self.part_error_um, 0.1, 1000.0)?;
        self.variation.check()
    }

    /// What makes the axes leave a pass ([`WayOut::leaves`](protocol::WayOut::leaves)).
    pub fn leaves(&self) -> u32 {
        let on = |reaction, what| if reaction == Reaction::Leave { what } else { 0 };
        on(self.on_hold, WayOut::ON_HOLD)
            | on(self.on_stop, WayOut::ON_STOP)
            | on(self.on_fault, WayOut::ON_FAULT)
    }
}
