//! Outputs. In: what the program sets, at rest or with the next motion, and how many blocks of motion have
//! begun. Out: the outputs as they are.
//!
//! Setpoints are ahead of the axes. A block that begins with one of them begins at the machine in the control
//! cycle that the setpoint is for, and what is set with it is set then.

use std::collections::VecDeque;

use machine::{ANALOG_OUTPUTS, Machine};
use motion::chain::BLOCKS;
use protocol::{Cycle, Set};

/// How many blocks with outputs of theirs may wait to begin. There is one at most for each block of the
/// chain, and those of a few ticks that have begun and are not at the machine yet: it never gets full.
const DEPTH: usize = 2 * BLOCKS;

/// The outputs. They allocate once, in `new`.
#[derive(Clone, Debug, Default)]
pub(crate) struct Outputs {
    now: Values,
    /// What they are once the program is over.
    safe: Values,
    /// Those that change only while axes and spindle stand.
    standstill: u64,
    waiting: VecDeque<Change>,
}

/// The state of all outputs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Values {
    /// The digital ones that are on, bit by bit.
    pub(crate) digital: u64,
    /// The analog ones.
    pub(crate) analog: [f64; ANALOG_OUTPUTS],
}

impl Values {
    fn set(&mut self, number: u8, set: Set) {
        let bit = 1 << u32::from(number);
        match set {
            Set::Digital(true) => self.digital |= bit,
            Set::Digital(false) => self.digital &= !bit,
            Set::Analog(value) => self.analog[usize::from(number)] = value,
        }
    }
}

/// What is set as a block begins.
#[derive(Clone, Copy, Debug)]
struct Change {
    /// Blocks that were appended before it.
    block: u64,
    /// The cycle in which it begins, as soon as that is known.
    due: Option<Cycle>,
    to: Values,
    /// The digital outputs that it sets, bit by bit; the analog ones.
    digital: u64,
    analog: [bool; ANALOG_OUTPUTS],
}

impl Change {
    fn new(block: u64) -> Change {
        Change { block, due: None, to: Values::default(), digital: 0, analog: [false; ANALOG_OUTPUTS] }
    }

    fn add(&mut self, number: u8, set: Set) {
        match set {
            Set::Digital(_) => self.digital |= 1 << u32::from(number),
            Set::Analog(_) => self.analog[usize::from(number)] = true,
        }
        self.to.set(number, set);
    }

    fn act(&self, now: &mut Values) {
        now.digital = now.digital & !self.digital | self.to.digital;
        for (number, set) in self.analog.iter().enumerate() {
            if *set {
                now.analog[number] = self.to.analog[number];
            }
        }
    }
}

impl Outputs {
    /// As they are before the program begins.
    pub(crate) fn new(machine: &Machine) -> Outputs {
        let now = Values {
            digital: machine.outputs_with(|output| output.initial),
            analog: machine.analog_outputs_at(|output| output.initial),
        };
        let safe = Values {
            digital: machine.outputs_with(|output| output.safe),
            analog: machine.analog_outputs_at(|output| output.safe),
        };
        let standstill = machine.outputs_with(|output| output.standstill);
        Outputs { now, safe, standstill, waiting: VecDeque::with_capacity(DEPTH) }
    }

    /// As they are.
    pub(crate) fn now(&self) -> &Values {
        &self.now
    }

    /// Whether an output changes only while axes and spindle stand.
    pub(crate) fn needs_standstill(&self, number: u8, set: Set) -> bool {
        matches!(set, Set::Digital(_)) && self.standstill >> number & 1 == 1
    }

    /// Sets an output at once.
    pub(crate) fn set(&mut self, number: u8, set: Set) {
        self.now.set(number, set);
    }

    /// Sets an output as a block begins, behind so many that have been appended.
    pub(crate) fn set_with(&mut self, block: u64, number: u8, set: Set) {
        match self.waiting.back_mut() {
            Some(last) if last.block == block && last.due.is_none() => last.add(number, set),
            _ => {
                assert!(self.waiting.len() < DEPTH, "more outputs wait than blocks");
                let mut change = Change::new(block);
                change.add(number, set);
                self.waiting.push_back(change);
            }
        }
    }

    /// So many blocks have begun with the setpoints for `due`.
    pub(crate) fn begun(&mut self, blocks: u64, due: Cycle) {
        for change in self.waiting.iter_mut().take_while(|change| change.block < blocks) {
            change.due = change.due.or(Some(due));
        }
    }

    /// A control cycle has come: sets what is due.
    pub(crate) fn tick(&mut self, cycle: Cycle) {
        while let Some(change) = self.waiting.front()
            && change.due.is_some_and(|due| due <= cycle)
        {
            change.act(&mut self.now);
            self.waiting.pop_front();
        }
    }

    /// No block begins any more.
    pub(crate) fn forget(&mut self) {
        self.waiting.retain(|change| change.due.is_some());
    }

    /// Whether the end of a program changes any of them.
    pub(crate) fn are_safe(&self) -> bool {
        self.now == self.safe && self.waiting.is_empty()
    }

    /// Makes them safe, whatever waits; without standstill those that need it stay as they are.
    pub(crate) fn make_safe(&mut self, stands: bool) {
        let those = if stands { u64::MAX } else { !self.standstill };
        self.now.digital = self.now.digital & !those | self.safe.digital & those;
        self.now.analog = self.safe.analog;
        self.waiting.clear();
    }
}
