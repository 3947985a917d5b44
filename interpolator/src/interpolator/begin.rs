//! At rest: what begins next. In: the item in hand, the panel. Out: the setpoints of the tick, the event.

use protocol::{Cycle, Fault, Feed, Measurement, Panel, PerAxis, Setpoint};

use crate::{
    hand::Jog,
    interpolator::{Interpolator, ends},
    program::Next,
    task::{Await, Event, Wait},
};

impl Interpolator {
    /// Goes on to wait for an input. Under a feed hold no time passes.
    pub(super) fn await_input(&self, wait: Await, cycle: Cycle) -> Event {
        let (panel, now) = (&self.panel, self.inputs >> wait.input & 1 == 1);
        let left = wait.left.saturating_sub(u64::from(!panel.pressed(Panel::FEED_HOLD)));
        match () {
            () if ends(panel) => Event::Over(Wait::No),
            () if wait.until.has_come(wait.before, now) => Event::Over(Wait::behind_block(panel)),
            () if wait.left == 0 => Event::refused(Fault::InputTimedOut, cycle),
            () => Event::Awaits(Await { before: now, left, ..wait }),
        }
    }

    /// At rest: begins what is next.
    pub(super) fn begin(
        &mut self,
        measurement: &Measurement,
        due: Cycle,
        wait: Wait,
    ) -> (PerAxis<Setpoint>, Event) {
        let (panel, cycle) = (&self.panel, measurement.cycle);
        let event = if ends(panel) {
            Event::Ends(true)
        } else if wait != Wait::No {
            self.patience.begin();
            Event::Waits(wait)
        } else if let Some(begun) = self.goes_to_reference(measurement, due) {
            return begun;
        } else {
            let panel = &self.panel;
            let known = (self.travel.blocks(), self.stands());
            let next = self.program.next(panel, &mut self.spindle, self.travel.route(), known);
            if matches!(next, Next::Move(_)) {
                self.ends_jog_at_switch(measurement);
            }
            let panel = &self.panel;
            match next {
                Next::Nothing | Next::Standstill => Event::Waits(Wait::No),
                Next::Impossible => Event::refused(Fault::BadMachineCode, cycle),
                Next::Held => {
                    self.patience.begin();
                    Event::Waits(Wait::No)
                }
                Next::Move(_) | Next::Work(_) | Next::Pass(_) if self.is_lost() => {
                    Event::refused(Fault::NotReferenced, cycle)
                }
                Next::Move(_) if self.hand.jog == Jog::LetGo => {
                    self.program.queue.done();
                    Event::Waits(Wait::No)
                }
                Next::Move(feed) if !self.spindle.lets(feed) => Event::Waits(Wait::No),
                Next::Move(_) => return self.move_on(due, 1, Wait::No, false, None),
                Next::Work(work) if !self.spindle.lets(Feed::PerMinute(work.feed_mm_min)) => {
                    Event::Waits(Wait::No)
                }
                Next::Work(work) => match self.travel.begin_work(self.program.line, &work) {
                    Ok(()) => return self.move_on(due, 1, Wait::No, false, None),
                    Err(fault) => Event::refused(fault, cycle),
                },
                Next::Pass(pass) => self.begin_pass(cycle, &pass),
                Next::Dwell(seconds) => {
                    Event::Dwells((seconds / self.machine.general.interpolator_cycle_s).ceil() as u64)
                }
                Next::Await { input, until, within_s } => {
                    let left = (within_s / self.machine.general.interpolator_cycle_s).ceil() as u64;
                    let before = self.inputs >> input & 1 == 1;
                    Event::Awaits(Await { input, until, before, left })
                }
                Next::Pause => Event::Pauses(panel.cycle_starts),
                Next::ToolChange => Event::ChangesTool(panel.cycle_starts),
                Next::ByHand(by_hand) => self.by_hand(by_hand, measurement),
                Next::End => Event::Ends(false),
            }
        };
        (self.travel.rest(due), event)
    }
}
