//! Moves that run without a stop between them unless their path needs one: the chain that looks ahead, and
//! its last leg.
//!
//! All moves of a run are of one kind, so that the same override acts on them. A move of the other kind ends
//! the run; it begins the next one.

use machine::Machine;
use motion::chain::{Ask, Block, Chain, Step};
use protocol::{PerAxis, Position, units::AXES};
use route::{Move, Route};

/// The moves under way.
#[derive(Clone, Debug)]
pub(crate) struct Run {
    chain: Chain<AXES, Move>,
    last: Option<Move>,
    /// Moves appended and completed so far, in all runs.
    pushed: u64,
    completed: u64,
}

/// A move has begun when the machine is so far on it, mm: by rounding alone it is not.
const BEGUN_MM: f64 = 1e-9;

impl Run {
    pub(crate) fn new(machine: &Machine) -> Run {
        Run { chain: Chain::new(Route::settings(machine)), last: None, pushed: 0, completed: 0 }
    }

    /// Moves that are not completed.
    pub(crate) fn len(&self) -> usize {
        self.chain.len()
    }

    /// Whether no move is under way.
    pub(crate) fn is_over(&self) -> bool {
        self.chain.is_empty()
    }

    /// Whether the machine stands, on its path or between runs.
    pub(crate) fn rests(&self) -> bool {
        self.chain.is_empty() || self.chain.rests()
    }

    /// Whether nothing has been appended since the run before ended.
    pub(crate) fn is_new(&self) -> bool {
        self.last.is_none()
    }

    /// Where the next move begins, if the axes rest at `here` between runs.
    pub(crate) fn end(&self, here: &PerAxis<Position>) -> PerAxis<Position> {
        self.last.map_or(*here, |last| last.to)
    }

    /// The last move.
    pub(crate) fn last(&self) -> Option<&Move> {
        self.last.as_ref()
    }

    /// Whether a move can be appended.
    pub(crate) fn has_room(&self) -> bool {
        self.chain.has_room()
    }

    /// Appends a move if it is of the same kind as those before it; else the run ends before it.
    pub(crate) fn push(&mut self, block: Block<AXES, Move>) -> bool {
        if self.last.is_some_and(|last| !last.joins(&block.tag)) {
            self.close();
            return false;
        }
        self.last = Some(block.tag);
        self.pushed += 1;
        self.chain.push(block);
        true
    }

    /// Nothing follows in this run.
    pub(crate) fn close(&mut self) {
        self.chain.close();
    }

    /// One interpolator cycle; nothing if no move is under way.
    pub(crate) fn tick(&mut self, ask: &Ask) -> Option<Step<AXES, Move>> {
        let step = self.chain.tick(ask)?;
        self.completed += u64::from(step.completed);
        Some(step)
    }

    /// Moves appended so far, in all runs.
    pub(crate) fn pushed(&self) -> u64 {
        self.pushed
    }

    /// How many of them have begun at the end of a step.
    pub(crate) fn begun(&self, step: &Step<AXES, Move>) -> u64 {
        let left = u64::from(step.last.is_some());
        self.completed + left + u64::from(!self.is_over() && step.along.s > BEGUN_MM)
    }

    /// Forgets what is left. The machine stands.
    pub(crate) fn clear(&mut self) {
        self.chain.clear();
        self.last = None;
        self.completed = self.pushed;
    }
}
