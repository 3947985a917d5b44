//! `[bus]` of the machine file: how long messages between drives and regulators are under way, as the
//! controller believes it. In: control cycles. Out: checked values, and times in s.

use serde::{Deserialize, Serialize};

use super::{General, MachineError, refuse};

/// Longest way that a message may be under way, control cycles.
pub const LONGEST_CYCLES: u32 = 4;

/// `[bus]`: without one, what is measured in a cycle is known in it, and what is commanded acts in it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Bus {
    /// Control cycles from the instant of a measurement to the cycle in which regulators get it.
    pub input_cycles: u32,
    /// Control cycles from the cycle in which a regulator commands to that in which the drive takes it.
    pub output_cycles: u32,
}

impl Bus {
    /// How old what a regulator gets is, s.
    pub fn input_s(&self, cycle_s: f64) -> f64 {
        f64::from(self.input_cycles) * cycle_s
    }

    /// How much later the drive takes what is commanded, s.
    pub fn output_s(&self, cycle_s: f64) -> f64 {
        f64::from(self.output_cycles) * cycle_s
    }

    pub(super) fn check(&self, general: &General) -> Result<(), MachineError> {
        for (key, cycles) in [("input_cycles", self.input_cycles), ("output_cycles", self.output_cycles)] {
            let key = format!("bus.{key}");
            if cycles > LONGEST_CYCLES {
                return Err(refuse(&key, cycles, &format!("must lie between 0 and {LONGEST_CYCLES}")));
            }
        }
        // A stream knows where it was one interpolator cycle back.
        let known = (general.interpolator_cycle_s / general.cycle_s).round() as u32;
        if self.input_cycles > known {
            let reason = format!("must be at most {known}: setpoints reach one interpolator cycle back");
            return Err(refuse("bus.input_cycles", self.input_cycles, &reason));
        }
        Ok(())
    }
}
