//! To the start of a pass: at first, and again after it was left. In: the pass, where the axes are. Out: what
//! comes next.

use protocol::{Cycle, Feed, Panel, ThreadPass};

use crate::{
    axes::Axes,
    interpolator::{Interpolator, ends},
    pass::{self, Ready, Stand},
    task::{Back, Event, Moved, Task, Wait},
};

impl Interpolator {
    /// A pass is next: leads the axes to its start, waits for speed and rest, then arms every axis.
    pub(super) fn begin_pass(&mut self, cycle: Cycle, pass: &ThreadPass) -> Event {
        let stand = Stand {
            machine: &self.machine,
            here: self.travel.here(),
            axes: &Axes::new(&self.machine, &self.heard, cycle),
            cycle,
            rested: self.patience.waited(),
            variation: self.program.variation,
        };
        match pass::prepare(pass, &stand, &mut self.spindle) {
            Ok(Ready::Arm(arm)) => Event::Pass(arm, cycle),
            Ok(Ready::Wait) => Event::Waits(Wait::No),
            Ok(Ready::Lead(start)) => match self.travel.lead_to(self.program.line, &start, Feed::Rapid) {
                Ok(()) => Event::Moved(Moved::default()),
                Err(fault) => Event::refused(fault, cycle),
            },
            Err(fault) => Event::refused(fault, cycle),
        }
    }

    /// The speed is varied while a pass is cut, but for a tap; while the tool leaves, it stays what it is.
    pub(super) fn vary(&mut self, leaves: bool) {
        match (&self.task, self.program.variation) {
            (Task::Cutting(arm), Some(variation)) if !arm.pass.returns() => {
                self.spindle.vary(variation, arm.pass.pass);
            }
            _ if leaves => {}
            _ => self.spindle.turn_evenly(),
        }
    }

    /// A pass was left, the tool is clear: leads the other axes to its start, waits, then leads the tool
    /// there.
    pub(super) fn lead_back(&mut self, cycle: Cycle, back: Back) -> Event {
        let (here, panel) = (*self.travel.here(), &self.panel);
        if ends(panel) {
            return Event::Ends(true);
        }
        let Some(pass) = self.program.pass() else { return Event::Returned };
        let mut start = here;
        self.machine.axes().for_each(|(axis, _)| start[axis.index()] = pass.axis(axis).start);
        let mut clear = start;
        let lifts = pass.out.axis as usize;
        clear[lifts] = here[lifts];
        let waits = back != Back::Goes || panel.pressed(Panel::FEED_HOLD);
        let target = match () {
            () if here != clear => clear,
            () if waits => {
                self.patience.begin();
                return Event::Waiting(back);
            }
            () if here == start => return Event::Returned,
            () => start,
        };
        match self.travel.lead_to(self.program.line, &target, Feed::Rapid) {
            Ok(()) => Event::Moved(Moved { back: Some(back), ..Moved::default() }),
            Err(fault) => Event::refused(fault, cycle),
        }
    }
}
