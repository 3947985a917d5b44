//! The tool that the axes carry in a control cycle, and how they are moved in it. In: the status of every
//! tick. Out: both as they belong to the commanded positions of the cycle.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | n | control cycles | a tick, whose status tells of the setpoint that it sends |
//! | L | control cycles | how far ahead of its tick a setpoint is due, [`SETPOINT_LEAD`] ticks |
//!
//! Regulators go to the setpoint that is due at n + L from the one before it. So a cycle belongs to the first
//! setpoint that is due in it or after it.

use std::collections::VecDeque;

use machine::Machine;
use protocol::{Cycle, MachineStatus, Motion, frame::SETPOINT_LEAD};

/// A tool, and how it is moved.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Led {
    /// Number of the tool; 0 if none was selected.
    pub tool: u32,
    /// How the axes are moved; not at all in a pass.
    pub motion: Motion,
}

/// What is known of the setpoints that are due.
#[derive(Clone, Debug)]
pub(super) struct Setpoints {
    lead: u64,
    due: VecDeque<(u64, Led)>,
    now: Led,
}

impl Setpoints {
    pub(super) fn of(machine: &Machine) -> Setpoints {
        let lead = SETPOINT_LEAD * machine.cycles_per_tick();
        Setpoints { lead, due: VecDeque::with_capacity(SETPOINT_LEAD as usize + 2), now: Led::default() }
    }

    /// Takes one control cycle.
    pub(super) fn cycle(&mut self, Cycle(cycle): Cycle, status: &MachineStatus, is_tick: bool) {
        if is_tick {
            let led = Led { tool: status.tool, motion: status.motion() };
            self.due.push_back((cycle + self.lead, led));
        }
        while self.due.front().is_some_and(|(due, _)| *due < cycle) {
            self.due.pop_front();
        }
        let dead = Led { motion: Motion::None, ..self.now };
        self.now = self.due.front().map_or(dead, |(_, led)| *led);
    }

    /// What holds in the cycle taken last.
    pub(super) fn now(&self) -> Led {
        self.now
    }
}

#[cfg(test)]
mod tests {
    use machine::Machine;
    use protocol::{Cycle, MachineStatus, Motion};

    use super::{Led, Setpoints};

    /// Four control cycles a tick, three ticks ahead: what tick 8 says holds from the cycle behind 16 to 20.
    #[test]
    fn a_cycle_belongs_to_the_setpoint_that_it_leads_to() {
        let machine = Machine::plain();
        let mut setpoints = Setpoints::of(&machine);
        let mut seen = Vec::new();
        for cycle in 0..40 {
            let tick = cycle / 4 * 4;
            let motion = if tick == 8 { Motion::Feed } else { Motion::Rapid };
            let tool = if tick >= 8 { 7 } else { 0 };
            let status =
                MachineStatus { cycle: Cycle(tick), tool, motion: motion as u32, ..MachineStatus::default() };
            // The interpolator dies with tick 24.
            let is_tick = cycle == tick && tick <= 24;
            setpoints.cycle(Cycle(cycle), &status, is_tick);
            seen.push(setpoints.now());
        }
        let led = |tool, motion| Led { tool, motion };
        assert!(seen[..=16].iter().all(|now| *now == led(0, Motion::Rapid)), "{:?}", &seen[..=16]);
        assert!(seen[17..=20].iter().all(|now| *now == led(7, Motion::Feed)), "{:?}", &seen[17..=20]);
        assert_eq!((seen[21], seen[36]), (led(7, Motion::Rapid), led(7, Motion::Rapid)));
        assert_eq!(seen[37], led(7, Motion::None), "nobody leads the axes");
    }
}
