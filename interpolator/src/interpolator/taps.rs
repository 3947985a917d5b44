//! A tap in hand: what the spindle is told meanwhile. In: the task, what axes and spindle say. Out: a speed
//! of the spindle besides that of the program.

use protocol::{Axis, DriveState, Fault, Measurement, ThreadPass};

use crate::{
    axes::Axes,
    interpolator::Interpolator,
    tap::Turning,
    task::{Task, Why},
};

impl Interpolator {
    /// The pass in hand, if it returns.
    fn tapping(&self) -> Option<&ThreadPass> {
        self.task.pass().map(|arm| &arm.pass).filter(|pass| pass.returns())
    }

    /// Whether a tap is in hand.
    pub(super) fn taps(&self) -> bool {
        self.tapping().is_some()
    }

    /// The direction in which a pass in hand has the spindle turn, ±1; none without a pass, and while the
    /// spindle turns round.
    pub(super) fn turns_towards(&self) -> Option<f64> {
        let pass = &self.task.pass()?.pass;
        match pass.returns() {
            true => {
                let speed = 6.0 * self.spindle.observed() * pass.direction;
                self.tap.direction(speed).map(|towards| towards * pass.direction)
            }
            false => Some(pass.direction),
        }
    }

    /// Turns the spindle round where the tap in hand asks for it.
    pub(super) fn turn_tap(&mut self, measurement: &Measurement) {
        let begun = matches!(self.task, Task::Cutting(_) | Task::Leaving { .. });
        let Some(pass) = self.tapping().copied().filter(|_| begun) else {
            self.tap.reset();
            return self.spindle.tap(None);
        };
        let axes = Axes::new(&self.machine, &self.heard, measurement.cycle);
        let status = axes.status(pass.along());
        let turning = Turning {
            angle_deg: status.angle_deg,
            speed: 6.0 * status.spindle_rpm * pass.direction,
            of: status.cycle,
            tick: measurement.cycle,
            count: measurement.spindle_count,
            asked_rpm: self.spindle.asked().abs(),
            leaves: matches!(self.task, Task::Leaving { .. }),
            reversible: self.may_reverse(pass.along(), measurement),
        };
        let rpm = self.tap.tick(&pass, &turning);
        self.spindle.tap(rpm.map(|rpm| rpm * pass.direction));
    }

    /// Whether the spindle may take the tool out of its hole: it obeys, its angle is known, and the axis
    /// along the helix has torque and is led by it.
    fn may_reverse(&self, along: Axis, measurement: &Measurement) -> bool {
        let found = match self.task {
            Task::Leaving { why: Why::Fault(fault), .. } => Some(fault),
            _ => None,
        };
        let mut faults = self.heard.faults().chain(found).chain(self.second);
        let led = measurement.axes[along.index()].drive().state() == Some(DriveState::OperationEnabled);
        led && !self.opened && !faults.any(stops)
    }
}

/// Faults behind which the spindle stops in the hole: it is stopped by others, does not do what it is told,
/// or nobody knows its angle.
fn stops(fault: Fault) -> bool {
    use Fault::{
        EmergencyStop, EncoderGlitch, EncoderPlausibility, EncoderStands, PowerLost, SpindleDoesNotStop,
        SpindleNotAtSpeed, SpindleReversed, SpindleRunaway,
    };
    matches!(
        fault,
        EmergencyStop
            | EncoderGlitch
            | EncoderPlausibility
            | EncoderStands
            | PowerLost
            | SpindleDoesNotStop
            | SpindleNotAtSpeed
            | SpindleReversed
            | SpindleRunaway
    )
}
