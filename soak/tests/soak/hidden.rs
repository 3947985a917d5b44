//! Whether the judge would notice: a machine to which something happens that the judge is not told of. What
//! an event excuses nobody excuses then, so the invariant that is named has to break; told of it, it holds.

use protocol::{Axis, AxisState};
use rig::wires::{Straight, Wires};
use rig::{Exchange, Rig};
use sim_plant::Scenario;
use soak::case::{Case, Ready};
use soak::event::{Event, Trouble, What};
use soak::judge::{Broken, Judge, Reference};
use soak::run;

/// A thread of the drawn ones, ready, with what it does undisturbed, and the cycle in the middle of its pass.
pub(crate) struct Thread {
    pub(crate) case: Case,
    pub(crate) ready: Ready,
    pub(crate) reference: Reference,
    pub(crate) middle: u64,
}

/// The first drawn thread from a seed on that a test wants.
pub(crate) fn thread(wanted: impl Fn(&Case, &Ready) -> bool) -> Thread {
    for seed in 0..500 {
        let (case, ready) = soak::draw(seed);
        if ready.passes().next().is_none() || !wanted(&case, &ready) {
            continue;
        }
        let alone = run::undisturbed(&case, &ready);
        assert_eq!(alone.broken, None, "seed {seed}");
        let middle = middle(&case, &ready);
        return Thread { case, ready, reference: alone.measured, middle };
    }
    panic!("no seed draws it");
}

/// The cycle in the middle of the first time that Z is synchronised.
fn middle(case: &Case, ready: &Ready) -> u64 {
    let (mut first, mut last) = (None, 0);
    let mut rig = Rig::new(&ready.machine, ready.items.iter().copied(), Scenario::none(), case.plant_seed)
        .expect("what is drawn is a plant");
    let mut over = false;
    while !over {
        let goes_on = rig.cycle(None, |record| {
            let z = record.axes.iter().find(|(axis, _)| *axis == Axis::Z);
            let (now, synchronised) =
                (record.truth.cycle.0, z.is_some_and(|(_, status)| status.state() == AxisState::Locked));
            match (synchronised, first) {
                (true, _) => (first, last) = (first.or(Some(now)), now),
                (false, Some(_)) => over = true,
                (false, None) => {}
            }
        });
        over |= !goes_on;
    }
    (first.expect("a thread is cut") + last) / 2
}

/// What a judge finds who is told of some events, while others happen, over wires of a test.
pub(crate) fn judged<W: Wires>(
    thread: &Thread,
    happen: &[Event],
    told: &[Event],
    wires: W,
) -> Option<Broken> {
    let case = Case { events: happen.to_vec(), ..thread.case.clone() };
    let scenario = Scenario::from_toml(&case.scenario()).expect("a scenario");
    let items = thread.ready.items.iter().copied();
    let mut rig = Rig::with_wires(&thread.ready.machine, items, scenario, case.plant_seed, wires)
        .expect("what is drawn is a plant");
    let mut judge = Judge::new(&thread.ready, told, Some(&thread.reference));
    for _ in 0..4 * thread.reference.cycles {
        if !rig.exchange(None, |exchange: &Exchange| judge.cycle(exchange)) {
            break;
        }
    }
    judge.broken().cloned()
}

/// Something breaks at the machine.
pub(crate) fn plant(at: u64, trouble: Trouble) -> Event {
    Event { at, what: What::Plant(trouble) }
}

fn name(broken: Option<Broken>) -> Option<&'static str> {
    broken.map(|broken| broken.invariant)
}

#[test]
fn an_axis_that_lets_go_in_the_thread_is_found_unless_its_drive_has_failed() {
    let thread = thread(|case, _| case.kinds.contains(&"g33-external"));
    for axis in [Axis::X, Axis::Z] {
        for trouble in [Trouble::DriveFault(axis), Trouble::TorqueLost(axis)] {
            let event = plant(thread.middle, trouble);
            assert_eq!(name(judged(&thread, &[event], &[], Straight)), Some("let-go"), "{event:?}");
            assert_eq!(name(judged(&thread, &[event], &[event], Straight)), None, "{event:?}");
            // The drive of the other axis does not explain it.
            let other = if axis == Axis::X { Axis::Z } else { Axis::X };
            let told = plant(thread.middle, Trouble::DriveFault(other));
            assert_eq!(name(judged(&thread, &[event], &[told], Straight)), Some("let-go"), "{event:?}");
        }
    }
}

#[test]
fn mains_that_are_away_explain_lost_torque_only_when_the_link_is_empty() {
    let thread = thread(|case, _| case.kinds.contains(&"g33-external"));
    let lost = plant(thread.middle, Trouble::PowerLost);
    let fails = plant(thread.middle + 5, Trouble::TorqueLost(Axis::X));
    assert_eq!(name(judged(&thread, &[lost], &[lost], Straight)), None);
    assert_eq!(name(judged(&thread, &[lost, fails], &[lost], Straight)), Some("let-go"));
}
