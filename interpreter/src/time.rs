//! How long machine code takes. In: codes in the order of the program. Out: seconds at 100 % override.
//!
//! A line or an arc stops at its end and keeps the limits of both axes (M21–M23, M58), the spindle follows its ramp, a
//! pass takes its angle at the programmed speed and, in the mean, half a turn of waiting for the index. How long a pause
//! lasts is up to the operator; it counts as nothing.

use motion::{FeedBlock, Path};
use protocol::{Axis, Code, Feed, Machine, PerAxis, Position, units::AXES};

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
            Code::Line { target, feed } => self.travel(self.line(target), target, *feed),
            Code::Arc { arc, feed } => self.travel(arc.path(&self.at).ok(), &arc.target, *feed),
            Code::Dwell { seconds } => *seconds,
            Code::Spindle { mode, speed } => {
                let rpm = mode.sign() * speed.rpm(self.at[0]);
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
            Code::PathMode(_)
            | Code::Tool { .. }
            | Code::Coolant { .. }
            | Code::Pause
            | Code::End => 0.0,
        };
    }

    /// Along a path to `target`; none takes no time.
    fn travel(&mut self, path: Option<Path<AXES>>, target: &PerAxis<Position>, feed: Feed) -> f64 {
        self.at = *target;
        let Some(path) = path else { return 0.0 };
        let limits = path.limits(&self.machine.limits());
        let speed = match feed {
            Feed::Rapid => limits.v,
            Feed::PerMinute(feed) => feed / 60.0,
            Feed::PerRevolution(feed) => feed * self.rpm.abs() / 60.0,
        };
        FeedBlock::plan(path.length(), 0.0, speed, 0.0, &limits).map_or(0.0, |block| block.duration())
    }

    fn line(&self, target: &PerAxis<Position>) -> Option<Path<AXES>> {
        let mut displacement = [0.0; AXES];
        for (axis, _) in self.machine.axes() {
            displacement[axis.index()] = target[axis.index()].mm_from(self.at[axis.index()]);
        }
        Path::line(displacement, &Axis::METRIC)
    }
}
