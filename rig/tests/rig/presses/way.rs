//! Runs that are disturbed late: what comes before is made once, and copied. In: a run with its observer.
//! Out: what was seen of it.

use protocol::operator::Request;
use rig::observe::{Observation, Record};

use super::{Seen, watch::Watch};
use crate::stand::Run;

/// A run on its way that nobody has disturbed yet. A copy of it is as good as one from the beginning, and
/// faster.
#[derive(Clone)]
pub(super) struct Way<'a> {
    run: Run<'a>,
    watch: Watch<'a>,
    /// The last cycle that was made.
    cycle: u64,
}

impl<'a> Way<'a> {
    pub(super) fn new(run: Run<'a>, watch: Watch<'a>) -> Way<'a> {
        Way { run, watch, cycle: 0 }
    }

    /// Goes on to just before a cycle, or stays behind it.
    pub(super) fn to(&mut self, cycle: u64) {
        let Way { run, watch, cycle: at } = self;
        while *at + 1 < cycle {
            let more = run.cycle(&mut |record| {
                watch.cycle("undisturbed", record);
                *at = record.truth.cycle.0;
                None
            });
            assert!(more, "it has ended before cycle {cycle}");
        }
    }

    /// What is left of it happens to a machine to which something is done from here on.
    pub(super) fn playing(mut self, scenario: &str) -> Way<'a> {
        self.run.play(scenario);
        self
    }

    /// What is left of it, before an observer who asks less.
    pub(super) fn seen_by(self, mut see: impl FnMut(&Record)) -> Observation {
        self.run.finished(&mut |record| {
            see(record);
            None
        })
    }

    /// What is left of it, with what the operator does in each cycle.
    pub(super) fn finished(self, what: &str, presses: impl Fn(u64) -> Option<Request>) -> Seen {
        let Way { run, mut watch, .. } = self;
        let observation = run.finished(&mut |record| {
            watch.cycle(what, record);
            presses(record.truth.cycle.0)
        });
        let Watch { end_mm, moves, borders, cut, late, turns_at_depth, most_turns, most_mm, .. } = watch;
        let turns = [turns_at_depth, most_turns];
        let cycles = observation.cycles;
        Seen { cycles, observation, moves, end_mm, borders, cut, late, turns, most_mm }
    }
}
