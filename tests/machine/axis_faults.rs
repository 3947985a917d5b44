//! One axis faults in a thread while the other is sound: the spindle runs down, and the run ends.
#![allow(clippy::unwrap_used)]

use machine::Machine;
use protocol::Axis;
use rig::{observe::Outcome, trial};
use sim_plant::Scenario;

/// Control cycles in which ten turns at 300 1/min are over for long.
const SOON: u64 = 20_000;

#[test]
fn a_run_ends_when_one_axis_faults_in_a_thread() {
    for axis in [Axis::X, Axis::Z] {
        let mut machine = Machine::plain();
        machine.axis.get_mut(&axis).unwrap().thread_error_mm = 1e-5;
        let items = trial::program(&machine, &[trial::Trial::default()]).unwrap();
        let mut cycles = 0;
        let seen = trial::run(&machine, &items, &Scenario::none(), 1, &mut |_| {
            cycles += 1;
            assert!(cycles < SOON, "{axis}: it goes on and on");
        });
        let seen = seen.unwrap();
        let named: Vec<_> = seen.faults.iter().map(|fault| fault.code.as_str()).collect();
        assert!(
            seen.outcome == Outcome::Faulted && named == ["thread-error", "other-axis", "thread-error"],
            "{axis}: {named:?}"
        );
    }
}
