//! How fast a path can be gone along at all. In: pieces of it, limits of the axes, mm and s. Out: the highest
//! feed of any place, and what is said of a job that asks for more.
//!
//! At the feed v the axes have the speed v p′, the acceleration v² p″ and the jerk v³ p‴, if v is constant;
//! each has a limit.

use machine::Machine;
use motion::Path;
use protocol::Axis;

use super::{Fault, Job};

/// Highest speed, acceleration and jerk of an axis, mm and s.
type Limits = [f64; 3];

/// The highest feed so far.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pace<const N: usize> {
    limits: [Limits; N],
    mm_s: f64,
}

impl<const N: usize> Pace<N> {
    /// Of nothing yet.
    pub(super) fn new(machine: &Machine, axes: [Axis; N]) -> Pace<N> {
        let limits = axes.map(|axis| {
            let of = |config: &machine::AxisConfig| {
                [config.velocity_mm_s, config.acceleration_mm_s2, config.jerk_mm_s3]
            };
            machine.axis.get(&axis).map_or([f64::INFINITY; 3], of)
        });
        Pace { limits, mm_s: 0.0 }
    }

    /// Takes a piece into account, at its ends and its middle.
    pub(super) fn goes_along(&mut self, path: &Path<N>) {
        for share in [0.0, 0.5, 1.0] {
            let [_, slope, bend, change, _] = path.at(share * path.length());
            let mut mm_s = f64::INFINITY;
            for (i, [speed, acceleration, jerk]) in self.limits.into_iter().enumerate() {
                mm_s = mm_s
                    .min(speed / slope[i].abs())
                    .min((acceleration / bend[i].abs()).sqrt())
                    .min(libm::cbrt(jerk / change[i].abs()));
            }
            self.mm_s = self.mm_s.max(mm_s);
        }
    }

    /// Warns of a feed that no place allows.
    pub(super) fn warning(&self, job: &Job) -> Option<Fault> {
        let highest = 60.0 * self.mm_s;
        let message =
            format!("this feed is reached nowhere: the axes allow at most {highest:.0} mm/min on this path");
        (job.feed_mm_min > highest + 0.5).then(|| {
            Fault::new("feed_mm_min", message, "give at most that, or leave it: the axes keep their limits")
        })
    }
}
