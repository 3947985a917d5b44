//! A machine on which the tests run machine code to its end, with an observer and an operator at it.

use machine::Machine;
use protocol::{Item, operator::Request};
use rig::{
    Rig,
    observe::{Observation, Observer, Record},
};
use sim_plant::Scenario;

/// Far beyond the end of every program here, control cycles.
const PATIENCE: u64 = 2_000_000;

/// What is run, and on what.
pub(crate) struct Stand<'a> {
    pub(crate) machine: &'a Machine,
    pub(crate) items: &'a [Item],
    /// As in a scenario file; empty for none.
    pub(crate) scenario: &'a str,
    pub(crate) seed: u64,
}

impl Stand<'_> {
    /// Runs to the end. `operator` sees every cycle and says what is done at the panel in the next one.
    pub(crate) fn run(&self, operator: impl FnMut(&Record) -> Option<Request>) -> Observation {
        self.run_as(self.items, operator)
    }

    /// The same with an observer who takes the program for another one.
    pub(crate) fn run_as(
        &self,
        observed: &[Item],
        mut operator: impl FnMut(&Record) -> Option<Request>,
    ) -> Observation {
        let scenario = Scenario::from_toml(self.scenario).expect("the scenarios of the tests are sound");
        let mut rig = Rig::new(self.machine, self.items.iter().copied(), scenario, self.seed)
            .expect("the machines of the tests can be built");
        let mut observer = Observer::new(self.machine, observed);
        let mut request = None;
        for _ in 0..PATIENCE {
            let now = request.take();
            let more = rig.cycle(now, |record| {
                observer.cycle(record);
                request = operator(record);
            });
            if !more {
                return observer.finish();
            }
        }
        panic!("the program does not end");
    }
}

/// Machine code of a program without errors.
pub(crate) fn compiled(machine: &Machine, program: &str) -> Vec<Item> {
    let check = interpreter::check("test.ngc", program, machine);
    assert!(check.is_good(), "{:#?}", check.diagnostics);
    check.items
}

/// What is done in the cycle after this one, of a list by cycles.
pub(crate) fn pressed(requests: &[(u64, Request)], record: &Record) -> Option<Request> {
    let next = record.truth.cycle.0 + 1;
    requests.iter().find(|(at, _)| *at == next).map(|(_, request)| *request)
}
