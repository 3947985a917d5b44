//! Between blocks that are given by hand. In: what the machine code says there. Out: the event.

use protocol::{ByHand, Fault, Measurement};

use crate::{
    hand::Jog,
    interpolator::Interpolator,
    task::{Event, Wait},
};

impl Interpolator {
    /// A block by hand is wanted, or begins where the axes rest; elsewhere it is refused.
    pub(crate) fn by_hand(&mut self, by_hand: ByHand, measurement: &Measurement) -> Event {
        match by_hand {
            ByHand::Waits => {
                self.hand.jog = Jog::No;
                Event::ByHand
            }
            ByHand::Begins { at, jogs } if self.travel.rests_at(&self.machine, &at) => {
                self.hand.jog = Jog::begins(jogs, &self.panel);
                Event::Waits(Wait::No)
            }
            ByHand::References(axis) if self.references.begin(&self.machine, axis, measurement) => {
                Event::Waits(Wait::No)
            }
            ByHand::Begins { .. } | ByHand::References(_) => {
                Event::refused(Fault::BadMachineCode, measurement.cycle)
            }
        }
    }
}
