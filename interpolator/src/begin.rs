//! What begins at rest: the next item of the program.

use protocol::{
    AxisCommand, Code, Cycle, Fault, Feed, MachineStatus, Panel, PerAxis, Setpoint, ThreadPass,
    frame::SETPOINT_LEAD,
};

use crate::{In, Interpolator, interpolator::ends, task::Task};

/// Items without motion that one tick may work off.
const ITEMS_PER_TICK: usize = 8;

/// Interpolator cycles from arming to the first index that counts: one for the way there, one for the status to come
/// back, one for calling off, one to spare.
const ARMING_TICKS: u64 = 4;

/// The regulators have watched the spindle for so many periods of their observer before a pass: what they did not know of
/// its speed when they began is forgotten then.
const WATCHED_PERIODS: f64 = 10.0;

/// Farthest the axes may be from the start of a pass and still be led there by a move of its own, mm.
const START_REACH_MM: f64 = 0.01;

impl Interpolator {
    /// At rest: works off items until one takes time.
    pub(crate) fn begin(&mut self, input: &In, cycle: Cycle, due: Cycle) -> (PerAxis<Setpoint>, AxisCommand) {
        let resting = (self.rest(due), AxisCommand::Stream);
        let panel = &input.measurement.panel;
        if ends(panel) {
            self.stopped = true;
            self.end();
            return resting;
        }
        if self.travel.waits(panel) {
            self.waited = 0;
            return resting;
        }
        for _ in 0..ITEMS_PER_TICK {
            self.next = self.next.or_else(|| self.queue.pop());
            let Some(item) = self.next else { return resting };
            let moves = item.is_move() || matches!(item.code, Code::Pass(_));
            if moves && panel.pressed(Panel::FEED_HOLD) {
                self.waited = 0;
                return resting;
            }
            self.line = item.line;
            match item.code {
                Code::Line { feed, .. } | Code::Arc { feed, .. } => {
                    if !self.may_feed(feed) {
                        return resting;
                    }
                    self.task = Task::Moving;
                    return (self.go_on(panel, due), AxisCommand::Stream);
                }
                Code::Dwell { seconds } => {
                    let left = (seconds / self.machine.machine.interpolator_cycle_s).ceil() as u64;
                    self.task = Task::Dwelling { left };
                    self.next = None;
                    return resting;
                }
                Code::PathMode(mode) => self.travel.route.set_mode(mode),
                Code::Spindle { mode, speed } => self.spindle.program(mode, speed),
                Code::Tool { .. } => {}
                Code::Coolant { mist, flood } => self.coolant = MachineStatus::coolant(mist, flood),
                Code::Pause => {
                    self.task = Task::Paused { cycle_starts: panel.cycle_starts };
                    self.next = None;
                    return resting;
                }
                Code::Pass(pass) => {
                    let command = self.begin_pass(input, cycle, &pass);
                    return (self.rest(due), command);
                }
                Code::Formula { slot, formula } => self.travel.route.set_formula(slot, formula),
                Code::Trace(trace) => {
                    if !self.may_feed(Feed::PerMinute(trace.feed_mm_min)) || !self.begin_trace(&trace) {
                        return resting;
                    }
                    self.task = Task::Moving;
                    return (self.go_on(panel, due), AxisCommand::Stream);
                }
                Code::End => {
                    self.end();
                    return resting;
                }
            }
            self.next = None;
        }
        resting
    }

    /// A pass is next: leads the axes to its start, waits for speed and rest, then arms every axis.
    fn begin_pass(&mut self, input: &In, cycle: Cycle, pass: &ThreadPass) -> AxisCommand {
        let mut start = self.here;
        let mut reach = 0.0_f64;
        for axis in self.axes.into_iter().flatten() {
            start[axis.index()] = pass.axis(axis).start;
            reach = reach.max(start[axis.index()].mm_from(self.here[axis.index()]).abs());
        }
        if reach > START_REACH_MM {
            self.enter_fault(Fault::BadMachineCode);
            return AxisCommand::Hold;
        }
        if start != self.here {
            self.lead_to(&start);
            return AxisCommand::Stream;
        }
        if !self.machine.can_follow(pass) {
            self.enter_fault(Fault::PassNotFeasible);
            return AxisCommand::Hold;
        }
        if (pass.direction * pass.s_rpm - self.spindle.programmed()).abs() > 1e-9 * pass.s_rpm {
            self.enter_fault(Fault::BadMachineCode);
            return AxisCommand::Hold;
        }
        // The ceiling of this pass holds from here on, so that the spindle settles below it before arming.
        self.spindle.set_ceiling(pass.max_ratio * 100.0);
        // A status tells of rest only when the last setpoint, which lies ahead, has been reached.
        let reached = self.waited > SETPOINT_LEAD;
        let at_rest = reached && self.statuses(input).all(|status| status.in_position != 0);
        let watched_s = cycle.0 as f64 * self.machine.machine.cycle_s;
        let watched = watched_s * self.machine.spindle.slowest_observer_hz() >= WATCHED_PERIODS;
        if !at_rest || !watched || !self.spindle.at_speed() {
            return AxisCommand::Stream;
        }
        self.index_not_before = cycle.after(ARMING_TICKS * self.machine.cycles_per_tick());
        self.pass = pass.pass;
        self.depth_mm = pass.depth_mm;
        self.task = Task::Arming { pass: *pass, sent: cycle };
        self.next = None;
        AxisCommand::Arm {
            pass: pass.pass,
            s_rpm: pass.s_rpm,
            direction: pass.direction,
            not_before: self.index_not_before,
            law: protocol::AxisLaw::default(),
        }
    }
}
