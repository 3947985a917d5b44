//! Whether the judge would notice: a machine to which something happens that the judge is not told of. What
//! an event excuses nobody excuses then, so the invariant that is named has to break; told of it, it holds.

use protocol::{Axis, AxisState, Cycle, Module, SpindleCommand, WayOut};
use rig::observe::Observer;
use rig::wires::{Straight, Wires};
use rig::{Exchange, Rig};
use sim_plant::Scenario;
use soak::case::{Case, Ready};
use soak::event::{Button, Event, Trouble, What};
use soak::judge::{Broken, Ending, Judge, Reference};
use soak::run;

use crate::mutants::{Blind, Row};

/// A case of the drawn ones, ready, with what it does undisturbed, and the cycle in the middle of its first
/// pass, 0 if it has none.
pub(crate) struct Thread {
    pub(crate) case: Case,
    pub(crate) ready: Ready,
    pub(crate) reference: Reference,
    pub(crate) middle: u64,
}

/// The first drawn case that a test wants.
pub(crate) fn thread(wanted: impl Fn(&Case, &Ready) -> bool) -> Thread {
    for seed in 0..500 {
        let (case, ready) = soak::draw(seed);
        if wanted(&case, &ready) {
            return drawn(seed);
        }
    }
    panic!("no seed draws it");
}

/// The case of a seed.
pub(crate) fn drawn(seed: u64) -> Thread {
    let (case, ready) = soak::draw(seed);
    let alone = run::undisturbed(&case, &ready);
    assert_eq!(alone.broken, None, "seed {seed}");
    let middle = middle(&case, &ready);
    Thread { case, ready, reference: alone.measured, middle }
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
    first.map_or(0, |first| (first + last) / 2)
}

/// The cycles in which the retract of X begins, undisturbed.
fn retracts(Thread { case, ready, .. }: &Thread) -> Vec<u64> {
    let (mut begun, mut before) = (Vec::new(), false);
    let mut rig = Rig::new(&ready.machine, ready.items.iter().copied(), Scenario::none(), case.plant_seed)
        .expect("what is drawn is a plant");
    while rig.cycle(None, |record| {
        let x = record.axes.iter().find(|(axis, _)| *axis == Axis::X);
        let now = x.is_some_and(|(_, status)| status.state() == AxisState::RunOut);
        if now && !before {
            begun.push(record.truth.cycle.0);
        }
        before = now;
    }) {}
    begun
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
    let mut observer = Some(Observer::new(&thread.ready.machine, &thread.ready.items).in_brief());
    for _ in 0..4 * thread.reference.cycles {
        let goes_on = rig.exchange(None, |exchange: &Exchange| {
            let record = &exchange.record;
            judge.cycle(exchange);
            observer.iter_mut().for_each(|observer| observer.cycle(record));
            if record.truth.measurement.last != 0 {
                let done = observer.take().map(Observer::finish).unwrap_or_default();
                judge.finish(Ending::Finished, record, &done);
            }
        });
        if !goes_on {
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
fn z_may_let_go_beside_an_x_that_is_stuck_if_nobody_believes_the_encoder() {
    let thread = drawn(22137);
    let before = |cycles: u64| thread.middle - cycles;
    let frozen = Event { at: before(335), what: What::Freeze(Module::Regulator(Axis::X), Some(1.48)) };
    let happens = |happen: &[Event], told: &[Event]| name(judged(&thread, happen, told, Straight));
    // So noisy that it is taken for a glitch three cycles later.
    let loud = [plant(before(468), Trouble::Noise(6)), frozen];
    assert_eq!(happens(&loud, &loud), None);
    // X has not let go yet.
    let early = plant(before(342), Trouble::TorqueLost(Axis::Z));
    assert_eq!(happens(&[loud[0], early], &loud), Some("let-go"));
    // An encoder that is eccentric counts wrongly, too, and everybody believes it.
    let believed = [plant(before(468), Trouble::Eccentricity(5.0)), frozen];
    assert_eq!(happens(&believed, &believed), None);
    let later = plant(before(307), Trouble::TorqueLost(Axis::Z));
    assert_eq!(happens(&[believed[0], frozen, later], &believed), Some("let-go"));
}

#[test]
fn mains_that_are_away_explain_lost_torque_only_when_the_link_is_empty() {
    let thread = thread(|case, _| case.kinds.contains(&"g33-external"));
    let lost = plant(thread.middle, Trouble::PowerLost);
    let fails = plant(thread.middle + 5, Trouble::TorqueLost(Axis::X));
    assert_eq!(name(judged(&thread, &[lost], &[lost], Straight)), None);
    assert_eq!(name(judged(&thread, &[lost, fails], &[lost], Straight)), Some("let-go"));
}

#[test]
fn z_is_judged_behind_an_x_without_torque() {
    let thread = thread(|case, _| case.kinds.contains(&"g33-external"));
    let lost = plant(thread.middle - 40, Trouble::TorqueLost(Axis::X));
    let pushed = plant(thread.middle - 20, Trouble::Force(Axis::Z, 4000.0, 0.02));
    assert_eq!(name(judged(&thread, &[lost, pushed], &[lost], Straight)), Some("flank"));
    assert_eq!(name(judged(&thread, &[lost, pushed], &[lost, pushed], Straight)), None);
}

#[test]
fn x_is_judged_in_front_of_a_z_without_torque() {
    let thread = thread(|case, _| case.kinds.contains(&"g33-external"));
    let lost = plant(thread.middle - 40, Trouble::TorqueLost(Axis::Z));
    let pushed = plant(thread.middle - 39, Trouble::Force(Axis::X, -8000.0, 0.01));
    assert_eq!(name(judged(&thread, &[lost, pushed], &[lost], Straight)), Some("bottom"));
    assert_eq!(name(judged(&thread, &[lost, pushed], &[lost, pushed], Straight)), None);
}

/// A spindle that hears nothing new for some cycles.
struct Deaf {
    from: u64,
    until: u64,
    last: SpindleCommand,
}

impl Wires for Deaf {
    fn spindle<'a>(&'a mut self, now: Cycle, sent: Option<&'a SpindleCommand>) -> Option<&'a SpindleCommand> {
        let deaf = (self.from..self.until).contains(&now.0);
        if let Some(sent) = sent.filter(|_| !deaf) {
            self.last = *sent;
        }
        sent.map(|_| &self.last)
    }
}

#[test]
fn a_spindle_that_turns_three_times_more_against_a_stuck_tool_is_found() {
    let thread = thread(|case, ready| {
        let fast = ready
            .passes()
            .all(|pass| pass.s_rpm > 300.0 && pass.s_rpm < 800.0 && pass.out.on(WayOut::ON_FAULT));
        case.kinds.contains(&"g33-external") && fast
    });
    let s_rpm = thread.ready.passes().next().map_or(0.0, |pass| pass.s_rpm);
    let lost = plant(thread.middle, Trouble::TorqueLost(Axis::X));
    let turns = |turns: f64| {
        let cycles = (turns * 60.0 / s_rpm / thread.ready.machine.general.cycle_s) as u64;
        Deaf { from: thread.middle, until: thread.middle + cycles, last: SpindleCommand::default() }
    };
    assert_eq!(name(judged(&thread, &[lost], &[lost], turns(0.0))), None);
    assert_eq!(name(judged(&thread, &[lost], &[lost], turns(3.0))), Some("ring"));
}

#[test]
fn what_is_pressed_and_what_breaks_before_the_end_does_not_complete() {
    let timed =
        |case: &Case, ready: &Ready| case.kinds == ["timed-motion"] && ready.passes().next().is_none();
    let thread = thread(timed);
    // Told, and it has not happened: the machine goes on as if nothing were.
    let stop = |at: u64| Event { at, what: What::Press(Button::Stop) };
    assert_eq!(name(judged(&thread, &[], &[stop(10)], Straight)), Some("stops"));
    let hold = Event { at: 10, what: What::Press(Button::Hold(100_000)) };
    assert_eq!(name(judged(&thread, &[], &[hold], Straight)), Some("stops"));
    let fails = plant(10, Trouble::DriveFault(Axis::X));
    assert_eq!(name(judged(&thread, &[], &[fails], Straight)), Some("untrue"));
    assert_eq!(name(judged(&thread, &[], &[], Straight)), None);
    let half = stop(thread.reference.cycles / 2);
    assert_eq!(name(judged(&thread, &[half], &[half], Straight)), None);
}

#[test]
fn a_regulator_that_hangs_is_not_missed_once_its_axis_is_there() {
    let thread = drawn(93009);
    let ends = thread.reference.cycles;
    let frozen = |at: u64| Event { at, what: What::Freeze(Module::Regulator(Axis::C), None) };
    for event in (ends - 20..ends).map(frozen) {
        assert_eq!(name(judged(&thread, &[event], &[event], Straight)), None, "{event:?}");
    }
    // Nobody is shown that it hangs on its way: its drive goes on for twelve cycles by itself.
    let early = frozen(ends - 70);
    let hidden = Blind::new(Row::SilentRegulators, 1.0);
    assert_eq!(name(judged(&thread, &[early], &[early], hidden)), Some("untrue"));
}

#[test]
fn a_tool_is_as_far_in_the_flank_where_it_leaves_the_part_between_two_cycles_as_undisturbed() {
    let thread = drawn(11066);
    // The tool leaves the part at 42 mm/s while Z brakes: a cycle later it is 18 µm farther in the flank.
    let eccentric = plant(thread.middle + 5, Trouble::Eccentricity(11.05));
    assert_eq!(name(judged(&thread, &[eccentric], &[eccentric], Straight)), None);
    let pushed = plant(thread.middle + 35, Trouble::Force(Axis::Z, 3000.0, 0.05));
    assert_eq!(name(judged(&thread, &[eccentric, pushed], &[eccentric], Straight)), Some("flank"));
    assert_eq!(name(judged(&thread, &[eccentric, pushed], &[eccentric, pushed], Straight)), None);
}

#[test]
fn a_tool_that_leaves_from_its_retract_is_no_deeper_than_where_it_began() {
    let thread = drawn(41171);
    // The retract is slower than a way out, but for its first 30 ms.
    let retract = retracts(&thread)[1];
    let hold = Event { at: retract + 21, what: What::Press(Button::Hold(400)) };
    assert_eq!(name(judged(&thread, &[hold], &[hold], Straight)), None);
    let pushed = plant(retract + 45, Trouble::Force(Axis::X, -1500.0, 0.05));
    assert_eq!(name(judged(&thread, &[hold, pushed], &[hold], Straight)), Some("bottom"));
    assert_eq!(name(judged(&thread, &[hold, pushed], &[hold, pushed], Straight)), None);
}
