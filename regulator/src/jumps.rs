//! Whether the measured position of an axis jumps: by more than the axis can be accelerated (M102). In: what
//! is measured, cycle by cycle. Out: the same without what has jumped, so that the axis goes on from where it
//! was.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | T | s | control cycle |
//! | d, d′ | mm | change of the measured position over this cycle, over the one before |
//! | A | mm/s² | highest acceleration of the axis |
//!
//! ```text
//! jump     |d − d′| > 10 A T² + 4 quanta                                                        (M102)
//! ```
//! Ten times the acceleration that is asked of an axis is more than its motor and any cut can give it.

use machine::AxisConfig;

/// How much more an axis may be accelerated than is ever asked of it.
const BEYOND: f64 = 10.0;

/// Watches one position.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Jumps {
    /// 10 A T² and four quanta, mm.
    most_mm: f64,
    seen: Option<Seen>,
    /// How far it has jumped, there and perhaps back, mm.
    jumped_mm: Option<f64>,
}

#[derive(Clone, Copy, Debug)]
struct Seen {
    mm: f64,
    change: Option<f64>,
}

impl Jumps {
    /// Those of an axis.
    pub(crate) fn of(config: &AxisConfig, cycle_s: f64) -> Jumps {
        let motor_mm = config.screw_lead_mm / f64::from(config.encoder_counts);
        let quantum_mm = config.scale_step_mm.unwrap_or(motor_mm).max(motor_mm);
        let most_mm = BEYOND * config.acceleration_mm_s2 * cycle_s * cycle_s + 4.0 * quantum_mm;
        Jumps { most_mm, ..Jumps::default() }
    }

    /// Takes the position of a cycle, which comes so many cycles late, and gives it back without its jumps.
    /// They are looked for as long as the axis follows something.
    pub(crate) fn position(&mut self, measured_mm: f64, missed: u64, follows: bool) -> f64 {
        let seen = self.seen.filter(|_| missed == 0);
        let change = seen.map(|seen| measured_mm - seen.mm);
        let beyond = match (change, seen.and_then(|seen| seen.change)) {
            (Some(change), Some(before)) => change - before,
            _ => 0.0,
        };
        let jumps = follows && (beyond.is_nan() || beyond.abs() > self.most_mm);
        if jumps {
            self.jumped_mm = Some(self.jumped_mm.unwrap_or(0.0) + beyond);
        }
        let change = change.map(|change| if jumps { change - beyond } else { change });
        self.seen = Some(Seen { mm: measured_mm, change });
        measured_mm - self.jumped_mm.unwrap_or(0.0)
    }

    /// Whether it has jumped.
    pub(crate) fn has_jumped(&self) -> bool {
        self.jumped_mm.is_some()
    }

    /// What is measured next is believed.
    pub(crate) fn forget(&mut self) {
        (self.seen, self.jumped_mm) = (None, None);
    }
}
