//! Whether a module of the rig works. In: what arrives for it. Out: what it works on in this cycle. A dead
//! module takes nothing; a frozen one lets its messages wait, as many as its channel holds, and works them
//! off, oldest first, when it has thawed.

use std::collections::VecDeque;

/// Messages that a thawed module works off in one of its cycles, until it has caught up.
const CATCH_UP: usize = 4;

/// How a module is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Life {
    #[default]
    Works,
    Frozen,
    Dead,
}

impl Life {
    /// Nothing brings a dead module back.
    pub(crate) fn turn(&mut self, life: Life) {
        if *self != Life::Dead {
            *self = life;
        }
    }
}

/// What waits for a module.
#[derive(Clone)]
pub(crate) struct Desk<T> {
    pub(crate) life: Life,
    waiting: VecDeque<T>,
    most: usize,
}

impl<T> Desk<T> {
    /// A module that works, behind a channel that holds so many messages.
    pub(crate) fn new(most: usize) -> Desk<T> {
        Desk { life: Life::Works, waiting: VecDeque::new(), most }
    }

    /// Whether the module works on what arrives when it arrives.
    pub(crate) fn is_up_to_date(&self) -> bool {
        self.life == Life::Works && self.waiting.is_empty()
    }

    /// A message arrives. It is lost if nobody lives who could take it, and if the channel is full.
    pub(crate) fn arrives(&mut self, message: T) {
        if self.life != Life::Dead && self.waiting.len() < self.most {
            self.waiting.push_back(message);
        }
    }

    /// How many messages the module works on in this cycle.
    pub(crate) fn ready(&self) -> usize {
        let most = if self.life == Life::Works { CATCH_UP } else { 0 };
        most.min(self.waiting.len())
    }

    /// The oldest message.
    pub(crate) fn take(&mut self) -> Option<T> {
        self.waiting.pop_front()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_thawed_module_catches_up_and_a_dead_one_does_not() {
        let mut desk = Desk::new(6);
        desk.life.turn(Life::Frozen);
        let mut worked = Vec::new();
        for cycle in 0..12 {
            if cycle == 8 {
                desk.life.turn(Life::Works);
            }
            desk.arrives(cycle);
            worked.push((0..desk.ready()).filter_map(|_| desk.take()).collect::<Vec<_>>());
        }
        assert!(worked[..8].iter().all(Vec::is_empty));
        // Two did not fit, and the one of the cycle in which it thaws.
        assert_eq!(worked[8..], [vec![0, 1, 2, 3], vec![4, 5, 9], vec![10], vec![11]]);
        assert!(desk.is_up_to_date());
        desk.life.turn(Life::Dead);
        desk.life.turn(Life::Works);
        desk.arrives(12);
        assert_eq!((desk.ready(), desk.is_up_to_date()), (0, false));
    }
}
