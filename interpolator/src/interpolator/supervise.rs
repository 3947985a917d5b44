//! What ends every task: what the panel, the axes, their drives and the spindle say, and waits that are too
//! long. In: a tick. Out: the first trouble, most urgent first, so that a cause comes before what it did.

use protocol::{Cycle, Fault, Measurement, Panel, frame::SETPOINT_LEAD};

use crate::{
    axes::Axes,
    interpolator::Interpolator,
    task::{Task, Trouble, Way, Why},
};

/// Ticks from an order to leave a pass until it is in force on every axis: one for the way there, two that
/// may be lost.
const LEAVING_TICKS: u64 = 3;

impl Interpolator {
    /// What ends every task.
    pub(crate) fn trouble(&self, measurement: &Measurement) -> Option<Trouble> {
        if matches!(self.task, Task::Fault { .. } | Task::Ended { .. }) {
            return None;
        }
        let axes = Axes::new(&self.machine, &self.heard, measurement.cycle);
        let found = self.outside(measurement).or_else(|| self.axes_fail(&axes, measurement));
        let waits = || self.spindle_fails().or_else(|| self.in_vain(&axes));
        let (fault, at_once) =
            found.map(|fault| (fault, true)).or_else(|| waits().map(|fault| (fault, false)))?;
        let way = Way::Leave(self.leave_at(measurement.cycle));
        let axis = axes.silent().filter(|_| fault == Fault::RegulatorSilent);
        Some(Trouble { fault, axis, at_once, way })
    }

    /// The cycle in which every axis leaves its pass if it is told so in this tick.
    pub(crate) fn leave_at(&self, tick: Cycle) -> Cycle {
        tick.after(LEAVING_TICKS * self.machine.cycles_per_tick())
    }

    fn outside(&self, measurement: &Measurement) -> Option<Fault> {
        let pressed = |button| measurement.panel.pressed(button);
        match () {
            () if pressed(Panel::EMERGENCY_STOP) => Some(Fault::EmergencyStop),
            () if pressed(Panel::POWER_LOST) => Some(Fault::PowerLost),
            () => None,
        }
    }

    /// An axis cannot be led any more.
    fn axes_fail(&self, axes: &Axes, measurement: &Measurement) -> Option<Fault> {
        let enabled = !matches!(self.task, Task::Enabling);
        match axes.cause() {
            Some(cause) => Some(cause),
            None if axes.silent().is_some() && axes.ahead() => Some(Fault::InterpolatorSilent),
            None if axes.silent().is_some() => Some(Fault::RegulatorSilent),
            None if enabled && axes.drive_off(measurement) => Some(Fault::DriveFault),
            None if self.leads() && self.has_strayed(axes) => Some(Fault::StreamStarved),
            None if self.ends_at_rest() && axes.elsewhere(self.travel.here()) => Some(Fault::StreamStarved),
            None if axes.in_fault() => Some(Fault::AxisFault),
            None => None,
        }
    }

    fn has_strayed(&self, axes: &Axes) -> bool {
        axes.astray(&self.machine, self.travel.here(), self.travel.since(), self.ahead_s())
    }

    /// Whether the axes are led by setpoints.
    fn leads(&self) -> bool {
        matches!(self.task, Task::Moving { .. } | Task::Ready { .. })
    }

    /// Whether the program is over, and every status knows the last setpoint.
    fn ends_at_rest(&self) -> bool {
        matches!(self.task, Task::Ending { .. }) && self.patience.waited() > SETPOINT_LEAD + 3
    }

    /// How far the last setpoint lies ahead of the statuses at most, s: of the tick before, and two more.
    fn ahead_s(&self) -> f64 {
        (SETPOINT_LEAD + 3) as f64 * self.machine.general.interpolator_cycle_s
    }

    fn spindle_fails(&self) -> Option<Fault> {
        // What is wrong with the program waits until everything before it is done and the axes rest.
        if matches!(self.task, Task::Ready { .. }) && self.program.is_broken_off() {
            return Some(Fault::BadMachineCode);
        }
        self.spindle.fault()
    }

    /// A wait that is too long.
    fn in_vain(&self, axes: &Axes) -> Option<Fault> {
        let (spindle, in_vain) = (&self.spindle, self.patience.is_over(&self.spindle));
        let turning = spindle.commanded() != 0.0;
        match self.task {
            Task::Enabling | Task::Starting | Task::Referencing { .. } if in_vain => Some(Fault::DriveFault),
            Task::Ready { .. } if in_vain && self.references.runs() => Some(Fault::AxisNotInPosition),
            Task::Ready { .. }
                if in_vain
                    && (turning || self.machine.spindle.is_none() || self.program.sets_output())
                    && self.program.queue.in_hand().is_some() =>
            {
                Some(if !turning || spindle.at_speed() {
                    Fault::AxisNotInPosition
                } else {
                    Fault::SpindleNotAtSpeed
                })
            }
            Task::Armed(_) if in_vain && turning && !axes.begun() => Some(Fault::IndexNotSeen),
            Task::CallingOff { .. } if in_vain => Some(Fault::PassCalledOff),
            Task::Leaving { .. } if in_vain => Some(Fault::AxisNotInPosition),
            Task::Cutting(_) if self.guard.in_vain() => Some(Fault::ForceTooHigh),
            _ if self.taps() && self.tap.lags() => Some(Fault::SpindleNotAtSpeed),
            _ if self.taps() && self.tap.is_stuck() => Some(Fault::EncoderStands),
            _ if self.patience.stalled(spindle) => Some(Fault::SpindleNotAtSpeed),
            _ => None,
        }
    }

    /// Whether the spindle is stopped while the axes leave a pass: a fault of its encoder leaves the axes no
    /// angle but the one that its speed foretells.
    pub(crate) fn stops_spindle(&self) -> bool {
        let Task::Leaving { why: Why::Fault(fault), .. } = self.task else { return false };
        let by_angle = of_encoder(fault) && !self.taps();
        !by_angle
    }

    /// With a fault latched: a spindle that does not obey is left to the brake of its drive, by the
    /// emergency stop. What it does then is told as well. Behind a fault of its encoder the axes leave on the
    /// speed that was last known: nobody touches that until they are out. And whether a spindle obeys that
    /// nobody sees, or that has run away before its encoder died, nobody knows: it is braked then in any
    /// case.
    pub(crate) fn look_after_spindle(&mut self) {
        let Some(fault) = self.task.fault() else { return };
        let out = matches!(self.task, Task::Fault { .. });
        if of_encoder(fault) && !out && !self.taps() {
            return;
        }
        let doubtful = |fault| matches!(fault, Fault::EncoderStands | Fault::SpindleRunaway);
        let unseen = self.heard.faults().chain([fault]).any(doubtful);
        let found = match () {
            () if self.spindle.never_stops() => Some(Fault::SpindleDoesNotStop),
            () if self.spindle.runs_away() => Some(Fault::SpindleRunaway),
            () if out && unseen => None,
            () => return,
        };
        self.second = found.filter(|found| *found != fault).or(self.second);
        if !self.opened {
            self.opened = true;
            self.spindle.wait_anew(unseen);
        }
    }

    /// Whether axes and spindle stand beyond doubt, so that what holds the part may let go. An encoder that
    /// is not believed shows nothing.
    pub(crate) fn stands(&self) -> bool {
        let seen = !self.heard.faults().chain(self.task.fault()).any(of_encoder);
        seen && self.standing.holds() && self.spindle.rests()
    }

    /// What the end of a program makes of its outputs: safe at once by an abort or a fault, else once all has
    /// come to rest; those that need standstill never before.
    pub(crate) fn end_outputs(&mut self) {
        let at_once = self.task.fault().is_some() || self.panel.pressed(Panel::ABORT);
        let over = self.task.is_over();
        if at_once || matches!(self.task, Task::Ended { .. }) {
            let stands = over && self.stands();
            self.program.outputs.make_safe(stands);
        } else if over {
            self.program.outputs.forget();
        }
    }

    /// Whether all rests behind the program: surely, if outputs change then.
    pub(crate) fn is_at_rest(&self, stopped: bool) -> bool {
        let outputs = self.program.outputs.are_safe() || self.stands();
        let rests = self.spindle.stands() && (!stopped || self.led_to_rest());
        rests && (outputs || self.patience.is_over(&self.spindle))
    }

    /// Whether the axes have reached their last setpoint, which lay ahead when they were told to rest.
    pub(crate) fn led_to_rest(&self) -> bool {
        self.patience.waited() > SETPOINT_LEAD
    }

    /// Whether everything is at rest and the machine may be switched off. After a fault nobody waits for ever
    /// for an axis or a spindle that does not come to rest.
    pub fn finished(&self) -> bool {
        match self.task {
            Task::Ended { .. } => true,
            Task::Fault { fault, .. } => {
                let spindle = self.spindle_is_over(fault);
                let axes = self.standing.holds() || self.patience.is_over(&self.spindle);
                spindle && axes && self.led_to_rest()
            }
            _ => false,
        }
    }

    /// Whether the spindle rests after a fault, or nobody waits for it any longer.
    pub(crate) fn spindle_is_over(&self, fault: Fault) -> bool {
        // One that is not at speed may have a dead encoder, too.
        // And whatever is latched here, a regulator may have found that out first.
        let dead = of_encoder(fault) || self.heard.faults().any(of_encoder);
        let blind = dead || fault == Fault::SpindleNotAtSpeed;
        let rests = self.spindle.rests() && (self.spindle.ran_down() || !blind);
        rests || self.spindle.never_stops() && self.opened
    }
}

/// Whether a fault is one of the spindle's encoder: what it shows is not to be believed.
fn of_encoder(fault: Fault) -> bool {
    use Fault::{
        EncoderGlitch, EncoderIndexMissing, EncoderPlausibility, EncoderPulsesGained, EncoderPulsesLost,
        EncoderStands,
    };
    matches!(
        fault,
        EncoderGlitch
            | EncoderIndexMissing
            | EncoderPlausibility
            | EncoderPulsesGained
            | EncoderPulsesLost
            | EncoderStands
    )
}
