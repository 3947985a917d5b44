//! The spindle as a regulator sees it: counts in, angle, speed and acceleration out (M53).
//!
//! Counts are taken at the middle of their quantum. The observer runs from the first measurement on and is never
//! reset at the index; the index only gives the origin of C.

use motion::{SpindleMotion, SpindleObserver};
use protocol::{Cycle, Machine, Measurement};

/// An index of the spindle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Index {
    /// Count latched at it.
    pub count: i64,
    /// First cycle that shows it.
    pub cycle: Cycle,
    /// Whether as many counts lie between it and the one before as the encoder has.
    pub plausible: bool,
}

/// Tracks the spindle encoder. Angles in degrees, speeds in deg/s.
#[derive(Clone, Debug)]
pub struct Spindle {
    observer: SpindleObserver,
    degrees_per_count: f64,
    counts_per_turn: i64,
    index: Option<Index>,
    index_number: u64,
}

impl Spindle {
    /// A spindle with the encoder and the observer of a machine file.
    pub fn new(machine: &Machine) -> Spindle {
        let counts = machine.spindle_counts();
        Spindle {
            observer: SpindleObserver::new(machine.spindle.observer_hz, machine.machine.cycle_s),
            degrees_per_count: 360.0 / counts,
            counts_per_turn: counts as i64,
            index: None,
            index_number: 0,
        }
    }

    /// Takes the measurement of one control cycle.
    pub fn update(&mut self, measurement: &Measurement) {
        self.observer.update(measurement.spindle_count as f64 + 0.5);
        if measurement.index_number != self.index_number {
            self.index = Some(Index {
                count: measurement.index_count,
                cycle: measurement.index_cycle,
                plausible: self.plausible(measurement),
            });
            self.index_number = measurement.index_number;
        }
    }

    fn plausible(&self, measurement: &Measurement) -> bool {
        let Some(last) = self.index else { return true };
        let turned = (measurement.index_count - last.count).abs();
        turned <= 1 || (turned - self.counts_per_turn).abs() <= 1
    }

    /// The last index, if there was one.
    pub fn index(&self) -> Option<Index> {
        self.index
    }

    /// Angle since an index, speed and acceleration at `lead_s` after the measurement, positive in `direction` (±1).
    pub fn since(&self, index_count: i64, direction: f64, lead_s: f64) -> SpindleMotion {
        let motion = self.observer.at(lead_s);
        let scale = direction * self.degrees_per_count;
        SpindleMotion {
            angle: (motion.angle - (index_count as f64 + 0.5)) * scale,
            speed: motion.speed * scale,
            acceleration: motion.acceleration * scale,
        }
    }

    /// Observed speed, 1/min, positive clockwise.
    pub fn rpm(&self) -> f64 {
        self.observer.at(0.0).speed * self.degrees_per_count / 6.0
    }
}
