//! How fast the machine reacts, row by row of the table of faults: every fault that the plant, the wires or a
//! module can cause is brought about at seeded places, in run-in, thread, run-out, timed motion and dwells,
//! and looked at from outside: from the cycle in which it is there to be seen to the one in which who must
//! react does. No row is left out: one that cannot be brought about here names the test that has it.
//! `cargo test -p rig reactions -- --nocapture` prints the second table of docs/faults.md.

mod case;
mod cases;
mod course;

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use machine::Machine;
use protocol::{AxisState, FAULTS, Fault, Span};

use case::{Case, PLACES, number};
use course::{Job, Moment};

use crate::stand::compiled;

const PAGE: &str = include_str!("../../../../docs/faults.md");

const REFERENCES: &str = include_str!("../references.rs");
const NOT_FOUND: &str = "a_switch_or_an_index_that_does_not_come_is_a_fault_by_name";

/// What neither plant nor wires nor a module can cause, and the test that has it: its file and its name.
const ELSEWHERE: [(Fault, &str, &str); 9] = [
    (
        Fault::PassNotFeasible,
        include_str!("mod.rs"),
        "a_pass_of_a_faster_machine_is_refused_before_it_is_armed",
    ),
    (
        Fault::TravelLimit,
        include_str!("../machine_code.rs"),
        "arcs_that_cannot_be_are_faults_and_move_nothing",
    ),
    (Fault::InputTimedOut, include_str!("../inputs.rs"), "an_input_that_does_not_come_in_time_is_a_fault"),
    (Fault::NotReferenced, REFERENCES, "a_move_by_hand_is_refused_before_the_reference_run_and_a_jog_is_not"),
    (Fault::SwitchNotFound, REFERENCES, NOT_FOUND),
    (Fault::SwitchNotReleased, REFERENCES, NOT_FOUND),
    (Fault::IndexNotFound, REFERENCES, NOT_FOUND),
    (Fault::IndexTooNear, REFERENCES, NOT_FOUND),
    // Nobody has ever seen one: this test plans at random, and none comes.
    (
        Fault::PlanRejected,
        include_str!("../../../../motion/tests/chain/limits.rs"),
        "random_programs_keep_every_limit_and_reach_their_end",
    ),
];

/// The cases, and the slowest reaction of each, on every core.
fn measure(cases: &[Case]) -> Vec<Result<Span, String>> {
    let (next, done) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    let work = || {
        loop {
            let number = next.fetch_add(1, Ordering::Relaxed);
            let Some(case) = cases.get(number) else { return };
            let slowest = case.slowest();
            done.lock().expect("no case panics").push((number, slowest));
        }
    };
    let jobs = std::thread::available_parallelism().map_or(1, usize::from);
    std::thread::scope(|scope| (0..jobs).for_each(|_| drop(scope.spawn(work))));
    let mut done = done.into_inner().expect("no case panics");
    done.sort_by_key(|(number, _)| *number);
    done.into_iter().map(|(_, slowest)| slowest).collect()
}

/// The row of a bound in the table of what was measured.
fn row(fault: Fault, bound: usize, cases: &[Case], slowest: &[Span]) -> String {
    let (code, within) = (fault.code(), &fault.row().within[bound]);
    let own = cases.iter().zip(slowest).filter(|(case, _)| (case.fault, case.bound) == (fault, bound));
    let measured: Vec<Span> = own.map(|(_, slowest)| *slowest).collect();
    let places = measured.len() * PLACES;
    match measured.into_iter().max_by(|one, other| number(*one).total_cmp(&number(*other))) {
        Some(slowest) => format!("| {code} | {within} | {slowest} | {places} |"),
        None => {
            let (.., test) = ELSEWHERE
                .iter()
                .find(|(elsewhere, ..)| *elsewhere == fault)
                .unwrap_or_else(|| panic!("{code}, {within}: nobody measures it"));
            format!("| {code} | {within} | `{test}` | – |")
        }
    }
}

#[test]
fn every_row_reacts_as_fast_as_it_says() {
    let cases = cases::cases();
    let (slowest, failed): (Vec<_>, Vec<_>) = measure(&cases).into_iter().partition(Result::is_ok);
    let failed: Vec<String> = failed.into_iter().filter_map(Result::err).collect();
    assert!(failed.is_empty(), "{}", failed.join("\n\n"));
    let slowest: Vec<Span> = slowest.into_iter().flatten().collect();
    let bounds = FAULTS.iter().flat_map(|row| (0..row.within.len()).map(|bound| (row.fault, bound)));
    let table: Vec<String> = bounds.map(|(fault, bound)| row(fault, bound, &cases, &slowest)).collect();
    println!("{}", table.join("\n"));
    let is_row = |line: &&str| FAULTS.iter().any(|row| line.starts_with(&format!("| {} |", row.code)));
    let shown: Vec<&str> = PAGE.lines().filter(is_row).collect();
    assert_eq!(shown, table, "docs/faults.md; it should read\n{}", table.join("\n"));
    for row in &FAULTS {
        assert!(!row.within.is_empty(), "{} may take as long as it likes", row.code);
    }
}

#[test]
fn what_cannot_be_brought_about_here_has_its_test() {
    for (fault, file, test) in ELSEWHERE {
        assert!(file.contains(&format!("fn {test}(")), "{}: there is no {test}", fault.code());
        assert!(cases::cases().iter().all(|case| case.fault != fault), "{} is measured", fault.code());
    }
}

#[test]
fn a_pass_of_a_faster_machine_is_refused_before_it_is_armed() {
    let program = "G18 G21 G90 G8\nM3 S600\nG0 X12 Z8\nG0 X9.5\nG33 Z-22 K2\nG0 X12\nM5\nM2\n";
    let items = compiled(&Machine::plain(), program);
    let mut machine = Machine::plain();
    machine.axis.values_mut().for_each(|axis| axis.velocity_mm_s = 10.0);
    let job = Job { machine: &machine, items: &items, scenario: "", stranger: None };
    let course = job.run(100_000, |now| now.machine.fault != 0);
    assert!(course.last().is_some_and(|last| last.machine_tells(Fault::PassNotFeasible)));
    let in_pass = |now: &Moment| now.axes.iter().any(|axis| axis.state() >= AxisState::Armed);
    assert!(!course.iter().any(in_pass), "an axis was armed");
}
