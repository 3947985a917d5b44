//! A plant without a launcher. In: the truth of each cycle. Out: what is asked of the machine instead of it,
//! and when that is over.

use machine::{Machine, SpindleConfig};
use protocol::{Cycle, Truth, operator::Request};

/// The launcher has gone: nobody records any more, nobody would end the machine. It is stopped like by an
/// emergency stop, and ends when it rests, or when it should have come to rest long ago.
pub(super) struct Forsaken {
    cycles: u64,
    rests: u64,
    longest: u64,
}

/// That many control cycles in a row without motion are rest.
const REST_CYCLES: u64 = 20;

impl Forsaken {
    pub(super) fn new(machine: &Machine) -> Forsaken {
        let ramp_s = machine.spindle.max_rpm / machine.spindle.ramp_rpm_s;
        let longest = ((3.0 * ramp_s + 10.0) / machine.general.cycle_s) as u64;
        Forsaken { cycles: 0, rests: 0, longest }
    }

    /// One control cycle without a launcher.
    pub(super) fn asks(&mut self, truth: &Truth) -> Option<Request> {
        let stands = truth.axes.iter().all(|axis| axis.velocity_mm_s.abs() < 0.01);
        let stands = stands && truth.spindle_rpm.abs() < SpindleConfig::STANDSTILL_RPM;
        if self.cycles == 0 {
            tracing::warn!("the launcher has gone: emergency stop in cycle {}", truth.cycle.0);
        }
        self.cycles += 1;
        self.rests = if stands { self.rests + 1 } else { 0 };
        (self.cycles == 1).then_some(Request::EmergencyStop)
    }

    pub(super) fn is_over(&self) -> bool {
        self.cycles > self.longest || self.rests > REST_CYCLES
    }

    /// Nobody but the log will know how it ended.
    pub(super) fn tell(&self, now: Cycle) {
        match (self.cycles, self.rests) {
            (0, _) => {}
            (_, 0) => tracing::warn!("the machine has not come to rest by cycle {}", now.0),
            _ => tracing::warn!("the machine is at rest in cycle {}", now.0),
        }
    }
}
