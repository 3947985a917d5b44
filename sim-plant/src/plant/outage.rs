//! What becomes of a machine whose controls and whose mains are gone at once, and how it is when it is
//! switched on again. In: the last commands. Out: the machine at rest; then before its first cycle.
//!
//! Drives that are not commanded any more brake as long as their link holds, then brakes hold the axes. The
//! spindle coasts. Nothing lifts a tool out of the thread in which it stands.
//!
//! | what is switched on again | what it still knows |
//! |---|---|
//! | encoders of the axes | all: they are absolute |
//! | encoder of the spindle | where its lines and its index are; it counts from where the spindle stands |
//! | drives, bus, panel | nothing; knobs stand where they were left |
//! | inputs | what they showed: it is the machine that makes them |
//! | mechanics, the part with its grooves | all |

use protocol::{Cycle, DriveCommand, Measurement, PerAxis, SpindleCommand, Truth};

use super::{AxisPlant, Plant};
use crate::PlantError;
use crate::bus::Bus;
use crate::scenario::Scenario;

/// Slower than this nothing moves, 1/min and mm/s.
const STANDS: f64 = 0.01;
/// It has to stand for so many control cycles.
const FOR_CYCLES: u64 = 200;
/// A spindle without friction is not waited for any longer, s.
const LONGEST_S: f64 = 1800.0;

impl Plant {
    /// Mains and controls fail in this cycle, behind these commands: goes on until nothing moves any more.
    /// Each cycle is shown. The control cycles that it took.
    pub fn lose_power(
        &mut self,
        drives: &PerAxis<DriveCommand>,
        spindle: &SpindleCommand,
        mut see: impl FnMut(&Truth),
    ) -> u64 {
        self.timeline.lose_power();
        self.truth.measurement.panel = self.timeline.panel();
        let begun = self.truth.cycle.0;
        let longest = (LONGEST_S / self.timeline.cycle_s) as u64;
        let mut stood = 0;
        while stood < FOR_CYCLES && self.truth.cycle.0 - begun < longest {
            self.tick(drives, spindle, None);
            see(&self.truth);
            let Truth { spindle_rpm, axes, .. } = &self.truth;
            let moves = axes.iter().any(|axis| axis.velocity_mm_s.abs() > STANDS);
            stood = if moves || spindle_rpm.abs() > STANDS { 0 } else { stood + 1 };
        }
        self.truth.cycle.0 - begun
    }

    /// The machine is switched on again, and plays a scenario from cycle 0 on. It stands where it stood.
    ///
    /// # Errors
    /// [`PlantError`] if an event is for an axis or an input that there is not.
    pub fn switch_on(&mut self, scenario: Scenario) -> Result<(), PlantError> {
        self.axes.iter_mut().for_each(AxisPlant::switch_on);
        self.spindle.switch_on();
        self.timeline.switch_on();
        self.freshness = self.freshness.anew();
        self.outage = 0;
        (self.fresh, self.truth) = (Measurement::default(), Truth::default());
        let [input_cycles, output_cycles] = self.bus.cycles();
        self.bus = Bus::new(0, 0, &self.fresh);
        self.play(scenario)?;
        self.sample(Cycle(0), &SpindleCommand::default());
        self.bus = Bus::new(input_cycles, output_cycles, &self.fresh);
        Ok(())
    }

    /// Another tool is put in, as soon as the one in place is out of the material: the axes carry its point X
    /// (a radius) and Z so far beside where they carried the one before, mm.
    pub fn change_tool(&mut self, by_mm: [f64; 2]) {
        self.cutter.change(by_mm);
    }
}
