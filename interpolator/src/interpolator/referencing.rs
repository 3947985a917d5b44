//! Reference runs between blocks. In: what the run in hand wants next, and what is measured. Out: the
//! setpoints and the event of a tick. Its ways are timed motion like any other: hold, stop, overrides, faults
//! and limits act on them.

use protocol::{Axis, Code, Cycle, Fault, Item, Measurement, PerAxis, Position, Setpoint};

use crate::{
    axes::Axes,
    hand::Jog,
    interpolator::Interpolator,
    reference::Then,
    task::{Event, Trouble, Wait, Way},
};

impl Interpolator {
    /// At rest: goes on with a reference run, or begins one; nothing if there is none.
    pub(crate) fn goes_to_reference(
        &mut self,
        measurement: &Measurement,
        due: Cycle,
    ) -> Option<(PerAxis<Setpoint>, Event)> {
        self.begins_with_references(measurement);
        self.travel.route().set_unreferenced(self.references.open());
        if !self.references.runs() {
            return None;
        }
        let cycle = measurement.cycle;
        // The drive takes an offset while the axis stands, and what stands is known where it does.
        let axes = Axes::new(&self.machine, &self.heard, cycle);
        if !(self.led_to_rest() && axes.rest() && axes.in_position()) {
            return Some((self.travel.rest(due), Event::Waits(Wait::No)));
        }
        let here = *self.travel.here();
        let event = match self.references.then(&self.machine, measurement, &here) {
            // Another axis may be next.
            Then::Nothing => Event::Waits(Wait::No),
            Then::Sets(axis, home_offset) => Event::Sets(axis, home_offset),
            Then::Fails(axis, fault) => failed(axis, fault, cycle),
            Then::Way(target, feed) => match self.travel.lead_to(self.program.line, &target, feed) {
                Ok(()) => return Some(self.move_on(due, 1, Wait::No, false, None)),
                Err(fault) => Event::refused(fault, cycle),
            },
        };
        Some((self.travel.rest(due), event))
    }

    /// A program begins with the reference runs that are to be made. Who works by hand asks for each.
    fn begins_with_references(&mut self, measurement: &Measurement) {
        if self.references.runs() || self.references.by_hand || self.references.open() == 0 {
            return;
        }
        let by_hand = match self.program.queue.head() {
            None => return,
            Some(item) => matches!(item.code, Code::ByHand(_)),
        };
        self.references.by_hand = by_hand;
        if let Some(axis) = self.references.first(&self.machine).filter(|_| !by_hand) {
            self.references.begin(&self.machine, axis, measurement);
        }
    }

    /// Whether nobody knows where the axes are: only a jog moves them then.
    pub(crate) fn is_lost(&self) -> bool {
        self.references.open() != 0 && self.hand.jog == Jog::No
    }

    /// A jog of an axis of which nobody knows where it is ends at its switch, and one that stands on it goes
    /// no further.
    pub(crate) fn ends_jog_at_switch(&mut self, measurement: &Measurement) {
        if self.hand.jog != Jog::Pressed {
            return;
        }
        let to = match self.program.queue.in_hand() {
            Some(Item { code: Code::Line { target, .. }, .. }) => *target,
            _ => self.travel.end(),
        };
        let way = [self.travel.here(), &to];
        if self.references.ends_at_switch(&self.machine, measurement, way) {
            self.hand.jog = Jog::LetGo;
        }
    }

    /// The drive of an axis has taken its offset, and its regulator is led from there.
    pub(crate) fn sets_reference(
        &mut self,
        axis: Axis,
        home_offset: Position,
        measurement: &Measurement,
    ) -> Event {
        let axes = Axes::new(&self.machine, &self.heard, measurement.cycle);
        let shown = self.references.shows(axis, home_offset, measurement);
        if shown.is_none_or(|shown| axes.status(axis).cycle < shown) {
            return Event::Nothing;
        }
        let mut here = *self.travel.here();
        here[axis.index()] = axes.commanded(&here)[axis.index()];
        self.travel.rest_at(here);
        self.references.is_set(axis);
        Event::IsSet
    }
}

/// An axis that cannot be referenced.
fn failed(axis: Axis, fault: Fault, cycle: Cycle) -> Event {
    Event::Fault(Trouble { fault, axis: Some(axis), at_once: false, way: Way::Leave(cycle) })
}
