//! A machine on which the tests run machine code to its end, with an observer and an operator at it.

use std::{iter::Copied, slice};

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

impl<'a> Stand<'a> {
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
        let run = Run { observer: Observer::new(self.machine, observed), ..self.begin() };
        run.finished(&mut operator)
    }

    /// A run that has not begun yet.
    pub(crate) fn begin(&self) -> Run<'a> {
        let scenario = Scenario::from_toml(self.scenario).expect("the scenarios of the tests are sound");
        let rig = Rig::new(self.machine, self.items.iter().copied(), scenario, self.seed);
        Run {
            rig: rig.expect("the machines of the tests can be built"),
            observer: Observer::new(self.machine, self.items),
            request: None,
        }
    }
}

/// A run on its way. A copy of it goes on as if there were no other.
#[derive(Clone)]
pub(crate) struct Run<'a> {
    rig: Rig<Copied<slice::Iter<'a, Item>>>,
    observer: Observer,
    /// What is done in the next cycle.
    request: Option<Request>,
}

impl Run<'_> {
    /// Plays a scenario from here on; so far there was none, and all of its events lie ahead.
    pub(crate) fn play(&mut self, scenario: &str) {
        let scenario = Scenario::from_toml(scenario).expect("the scenarios of the tests are sound");
        self.rig.play(scenario).expect("it is for axes that there are");
    }

    /// One control cycle; says whether there are more.
    pub(crate) fn cycle(&mut self, operator: &mut impl FnMut(&Record) -> Option<Request>) -> bool {
        let Run { rig, observer, request } = self;
        rig.cycle(request.take(), |record| {
            observer.cycle(record);
            *request = operator(record);
        })
    }

    /// All that is left of it.
    pub(crate) fn finished(mut self, operator: &mut impl FnMut(&Record) -> Option<Request>) -> Observation {
        for _ in 0..PATIENCE {
            if !self.cycle(operator) {
                return self.observer.finish();
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
