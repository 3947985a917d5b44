//! One pass of the reference simulation on the whole machine. In: a machine, an override in per cent, a seed.
//! Out: servo errors of X in µm, and how far its slide is off.
//!
//! | figure | is taken |
//! |---|---|
//! | approach | while X is under its stroke |
//! | end | at the first sample after the stroke |
//! | thread | from a tenth of a turn later to the end of the thread: its largest magnitude |
//! | slide | commanded minus true slide, in the mean of 0.1 s about [`CREEP_S`] behind the end |
//!
//! In the approach and at its end samples are those of the position loop: where that runs every other control
//! cycle, so do they. That the thread counts from a tenth of a turn is identified: only so all rows of the
//! reference come out.

use machine::Machine;
use protocol::{Axis, AxisState};
use rig::{observe::Record, trial::Trial};

use crate::{ExperimentError, stand::Stand};

/// When the creep of the slide is looked at, s.
const CREEP_S: f64 = 1.35;
/// How long it is averaged over, s.
const MEAN_S: f64 = 0.1;
/// Turns of the thread: 9 at 300 1/min are 1.8 s.
const TURNS: f64 = 9.0;
/// Angle behind the end of the stroke from which on it counts as thread, degrees.
const SETTLED_DEG: f64 = 36.0;

/// What was measured of a pass, µm.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Measured {
    /// Least and largest in the approach, at its end, in the thread.
    pub(super) errors_um: [f64; 4],
    pub(super) slide_um: f64,
}

/// What has been seen of a pass so far.
#[derive(Default)]
struct Seen {
    approach_um: [f64; 2],
    end_um: Option<f64>,
    end_deg: Option<f64>,
    thread_um: f64,
    /// Errors of the slide from the end on, one a control cycle.
    slide_um: Vec<f64>,
}

impl Seen {
    fn take(&mut self, record: &Record, sampled: bool) {
        let Some((_, status)) = record.axes.iter().find(|(axis, _)| *axis == Axis::X) else { return };
        let error_um = 1e3 * status.servo_error_mm;
        match status.state() {
            AxisState::RunIn if sampled => {
                let [least, most] = self.approach_um;
                self.approach_um = [least.min(error_um), most.max(error_um)];
            }
            AxisState::Locked => {
                let slide_mm = record.truth.axes[Axis::X.index()].slide_mm;
                self.slide_um.push(1e3 * (status.commanded_mm - slide_mm));
                self.rest(error_um, status.angle_deg, sampled);
            }
            _ => {}
        }
    }

    fn rest(&mut self, error_um: f64, angle_deg: f64, sampled: bool) {
        let end_deg = *self.end_deg.get_or_insert(angle_deg);
        if sampled {
            self.end_um.get_or_insert(error_um);
        }
        if angle_deg >= end_deg + SETTLED_DEG {
            self.thread_um = self.thread_um.max(error_um.abs());
        }
    }

    fn measured(&self, cycle_s: f64) -> Measured {
        let [least, most] = self.approach_um;
        let about = |s: f64| ((s / cycle_s) as usize).min(self.slide_um.len());
        let creep = &self.slide_um[about(CREEP_S - 0.5 * MEAN_S)..about(CREEP_S + 0.5 * MEAN_S)];
        Measured {
            errors_um: [least, most, self.end_um.unwrap_or(f64::NAN), self.thread_um],
            slide_um: creep.iter().sum::<f64>() / creep.len() as f64,
        }
    }
}

/// Runs the pass; the position loop goes on every so many control cycles.
///
/// # Errors
/// As [`Stand::run`].
pub(super) fn measure(
    machine: &Machine,
    override_pct: f64,
    cycles: u64,
    seed: u64,
) -> Result<Measured, ExperimentError> {
    let mut seen = Seen::default();
    let trial = [Trial { turns: TURNS, ..Trial::default() }];
    Stand::run(machine, &trial, override_pct, seed, &mut |record: &Record| {
        seen.take(record, record.truth.cycle.0.is_multiple_of(cycles));
    })?;
    Ok(seen.measured(machine.general.cycle_s))
}
