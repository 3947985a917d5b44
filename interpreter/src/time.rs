//! How long machine code takes. In: codes in the order of the program. Out: seconds at 100 % override.
//!
//! A move stops at its end and keeps the limits of both axes (M21–M23), the spindle follows its ramp, a pass takes its
//! angle at the programmed speed and, in the mean, half a turn of waiting for the index.

use motion::{FeedBlock, Limits};
use protocol::{Axis, Code, Feed, Machine, PerAxis, Position};

/// Adds up time.
pub(crate) struct Clock<'m> {
    machine: &'m Machine,
    at: PerAxis<Position>,
    /// Signed speed of the spindle, 1/min.
    rpm: f64,
    seconds: f64,
}

impl<'m> Clock<'m> {
    pub(crate) fn new(machine: &'m Machine) -> Clock<'m> {
        let mut at = PerAxis::<Position>::default();
        for (axis, config) in machine.axes() {
            at[axis.index()] = Position::from_mm(config.home_mm);
        }
        Clock { machine, at, rpm: 0.0, seconds: 0.0 }
    }

    pub(crate) fn seconds(&self) -> f64 {
        self.seconds
    }

    pub(crate) fn add(&mut self, code: &Code) {
        self.seconds += match code {
            Code::Line { target, feed } => self.line(target, *feed),
            Code::Dwell { seconds } => *seconds,
            Code::Spindle { mode, rpm } => {
                let rpm = mode.sign() * rpm;
                let ramp = (rpm - self.rpm).abs() / self.machine.spindle.ramp_rpm_s;
                self.rpm = rpm;
                ramp
            }
            Code::Pass(pass) => {
                for (axis, _) in self.machine.axes() {
                    self.at[axis.index()] = pass.axis(axis).end;
                }
                (pass.done_deg() + 180.0) / (6.0 * pass.s_rpm)
            }
            Code::Tool { .. } | Code::End => 0.0,
        };
    }

    fn line(&mut self, target: &PerAxis<Position>, feed: Feed) -> f64 {
        let way = |axis: Axis| target[axis.index()].mm_from(self.at[axis.index()]).abs();
        let length = self.machine.axes().fold(0.0, |sum, (axis, _)| libm::hypot(sum, way(axis)));
        if length == 0.0 {
            return 0.0;
        }
        let none = Limits { v: f64::INFINITY, a: f64::INFINITY, j: f64::INFINITY, dj: f64::INFINITY };
        let limits =
            self.machine.axes().filter(|(axis, _)| way(*axis) > 0.0).fold(none, |limits, (axis, config)| {
                let path = length / way(axis);
                Limits {
                    v: limits.v.min(config.velocity_mm_s * path),
                    a: limits.a.min(config.acceleration_mm_s2 * path),
                    j: limits.j.min(config.jerk_mm_s3 * path),
                    dj: limits.dj.min(config.jerk_rate_mm_s4 * path),
                }
            });
        let speed = match feed {
            Feed::Rapid => limits.v,
            Feed::PerMinute(feed) => feed / 60.0,
            Feed::PerRevolution(feed) => feed * self.rpm.abs() / 60.0,
        };
        self.at = *target;
        FeedBlock::plan(length, 0.0, speed, 0.0, &limits).map_or(0.0, |block| block.duration())
    }
}
