//! The bus between drives and regulators: what is measured arrives later, what is commanded acts later. In:
//! what there is in a cycle. Out: what has arrived in it.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | d_i | cycles | from the instant of a measurement to the cycle in which regulators get it |
//! | d_o | cycles | from the cycle in which a regulator commands to that in which the drive takes it |
//!
//! Axes, spindle and status words travel together. The loop of speed is in the drive and sees its own encoder
//! at once. The panel, the inputs and the command of the spindle do not travel: who presses and who commands
//! does so at any time.

use protocol::{Cycle, DriveCommand, Measurement, PerAxis};

use machine::LONGEST_CYCLES;

/// As many messages as can be under way, and the one that arrives.
const LONGEST: usize = LONGEST_CYCLES as usize + 1;

/// What is under way.
#[derive(Clone, Debug)]
pub(crate) struct Bus {
    inputs: UnderWay<Measurement>,
    outputs: UnderWay<PerAxis<DriveCommand>>,
}

impl Bus {
    /// With nothing under way but what is true at the start.
    pub(crate) fn new(input_cycles: u32, output_cycles: u32, first: &Measurement) -> Bus {
        Bus {
            inputs: UnderWay::new(input_cycles, *first),
            outputs: UnderWay::new(output_cycles, Default::default()),
        }
    }

    /// Sends what is measured in a cycle; what arrives in it, an index in the cycle that shows it.
    pub(crate) fn measured(&mut self, fresh: &Measurement) -> Measurement {
        let Measurement { cycle, last, panel, inputs, .. } = *fresh;
        let mut arrived = *self.inputs.pass(fresh);
        if arrived.index_number > 0 {
            arrived.index_cycle = Cycle(arrived.index_cycle.0 + self.inputs.cycles as u64);
        }
        (arrived.cycle, arrived.last, arrived.panel, arrived.inputs) = (cycle, last, panel, inputs);
        arrived
    }

    /// Sends what is commanded in a cycle; what arrives in it.
    pub(crate) fn commanded(&mut self, drives: &PerAxis<DriveCommand>) -> &PerAxis<DriveCommand> {
        self.outputs.pass(drives)
    }

    /// Cycles for which measurements and commands are under way.
    pub(crate) fn cycles(&self) -> [u32; 2] {
        [self.inputs.cycles, self.outputs.cycles].map(|cycles| cycles as u32)
    }

    /// Cycles for which a command is under way.
    pub(crate) fn output_cycles(&self) -> u64 {
        self.outputs.cycles as u64
    }
}

/// Messages under way for so many cycles.
#[derive(Clone, Debug)]
struct UnderWay<T> {
    cycles: usize,
    ring: [T; LONGEST],
    next: usize,
}

impl<T: Copy> UnderWay<T> {
    fn new(cycles: u32, first: T) -> UnderWay<T> {
        UnderWay { cycles: cycles.min(LONGEST_CYCLES) as usize, ring: [first; LONGEST], next: 0 }
    }

    /// Puts a message in, and takes the one that arrives.
    fn pass(&mut self, message: &T) -> &T {
        self.ring[self.next] = *message;
        let arrives = (self.next + LONGEST - self.cycles) % LONGEST;
        self.next = (self.next + 1) % LONGEST;
        &self.ring[arrives]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_message_arrives_so_many_cycles_later() {
        for cycles in 0..=LONGEST_CYCLES {
            let mut way = UnderWay::new(cycles, 0_u32);
            for now in 1..20_u32 {
                assert_eq!(*way.pass(&now), now.saturating_sub(cycles), "after {cycles}");
            }
        }
    }

    #[test]
    fn what_arrives_says_when_it_is_there() {
        let mut bus = Bus::new(2, 0, &Measurement::default());
        let fresh = |n: u64| Measurement {
            cycle: Cycle(n),
            spindle_count: 100 * n as i64,
            index_number: u64::from(n >= 5),
            index_cycle: Cycle(5),
            ..Measurement::default()
        };
        let arrived: Vec<_> = (1..10).map(|n| bus.measured(&fresh(n))).collect();
        assert!(arrived.iter().zip(1..).all(|(arrived, n)| arrived.cycle == Cycle(n)));
        assert_eq!([arrived[3].spindle_count, arrived[5].index_number as i64], [200, 0]);
        assert_eq!((arrived[6].index_number, arrived[6].index_cycle), (1, Cycle(7)));
        assert_eq!(arrived[8].index_cycle, Cycle(7));
    }
}
