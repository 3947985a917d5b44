//! Reference runs, watched from outside: where the axes truly are beside where they are measured, before and
//! behind them; what is pressed and what breaks in every cycle round each border of their phases.

use machine::{Machine, Method};
use protocol::{
    Axis, ByHand, Code, Fault, Item, MachineState, MachineStatus, PerAxis, Position, operator::Request,
};
use rig::{Rig, observe::Record};
use sim_plant::Scenario;

use crate::stand::{compiled, pressed};

pub(crate) const PLAIN: &str = include_str!("../../../examples/machines/plain-lathe.toml");
const SMALL: &str = include_str!("../../../examples/machines/small-lathe.toml");
/// The first block is given in this cycle: the machine waits for it.
pub(crate) const GIVEN: u64 = 200;
/// Behind every reference run here, control cycles.
const LATEST: u64 = 60_000;
/// How far beside home X truly is when the machine is switched on, mm.
const OFF_MM: f64 = -0.737;
/// What the switch of the plant repeats, mm.
const SCATTER_MM: f64 = 0.002;

/// The plain lathe, its X with a reference near the upper end of its travel.
pub(crate) fn lathe(method: Method, truth: &str) -> Machine {
    made_of(PLAIN, method, "", truth)
}

/// A lathe of `examples/machines` with that and these keys of X: believed, and true.
pub(crate) fn made_of(lathe: &str, method: Method, believed: &str, truth: &str) -> Machine {
    let method = match method {
        Method::Switch => "switch",
        Method::SwitchAndIndex => "switch-and-index",
        Method::Index => "index",
    };
    let reference = format!(
        "{believed}\n[axis.x.reference]\nmethod = \"{method}\"\nposition_mm = 66\nsearch_mm_s = 25\nlatch_mm_s = 1\n\n[axis.z]"
    );
    let truth =
        format!("[plant.axis.x]\nhome_off_mm = {OFF_MM}\nswitch_scatter_mm = {SCATTER_MM}\n{truth}\n");
    let own = lathe.replacen("home_off_mm = 0.005", "", 1);
    let text = own.replacen("[axis.z]", &reference, 1).replacen("[plant.axis.x]", &truth, 1);
    let mut machine = Machine::from_toml(&text).expect("a sound machine");
    machine.axis.get_mut(&Axis::X).expect("it has an X").travel_mm[1] = 70.0;
    machine
}

/// Where the axes are led before anything is given.
pub(crate) fn begins(machine: &Machine, seed: u64) -> PerAxis<Position> {
    let mut rig = Rig::new(machine, session([]).into_iter(), Scenario::none(), seed).expect("a machine");
    let mut at = PerAxis::default();
    for _ in 0..GIVEN {
        rig.cycle(None, |record: &Record| {
            for (axis, status) in record.axes {
                at[axis.index()] = Position::from_mm(status.commanded_mm);
            }
        });
    }
    at
}

pub(crate) fn session(codes: impl IntoIterator<Item = Code>) -> Vec<Item> {
    let codes = std::iter::once(Code::ByHand(ByHand::Waits)).chain(codes);
    codes.chain([Code::End]).map(|code| Item { line: 1, code }).collect()
}

/// A session of one reference run of X.
pub(crate) fn homing(machine: &Machine, seed: u64) -> Vec<Item> {
    let at = begins(machine, seed);
    session([
        Code::ByHand(ByHand::Begins { at, jogs: false }),
        Code::ByHand(ByHand::References(Axis::X)),
        Code::ByHand(ByHand::Waits),
    ])
}

/// What is seen of X in a cycle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Seen {
    /// Where its motor truly is, mm, and how far beside that it is measured.
    pub(crate) motor_mm: f64,
    pub(crate) off_mm: f64,
    pub(crate) commanded_mm: f64,
    pub(crate) speed_mm_s: f64,
    pub(crate) error_mm: f64,
    pub(crate) state: MachineState,
    pub(crate) fault: u32,
    pub(crate) open: bool,
    pub(crate) on: bool,
}

impl Seen {
    fn of(record: &Record) -> Seen {
        let (_, x) = record.axes.iter().find(|(axis, _)| *axis == Axis::X).expect("there is an X");
        let measured = &record.truth.measurement.axes[Axis::X.index()];
        let motor_mm = record.truth.axes[Axis::X.index()].motor_mm;
        let MachineStatus { fault, .. } = *record.machine;
        Seen {
            motor_mm,
            off_mm: motor_mm - measured.position.mm(),
            commanded_mm: x.commanded_mm,
            speed_mm_s: x.velocity_mm_s,
            error_mm: x.servo_error_mm,
            state: record.machine.state(),
            fault,
            open: record.machine.is_unreferenced(Axis::X),
            on: measured.is_switched(),
        }
    }

    /// By hand, at rest.
    pub(crate) fn waits(&self) -> bool {
        self.state == MachineState::ByHand && self.speed_mm_s == 0.0
    }
}

/// A session with these presses up to where nothing moves any more.
pub(crate) fn run(
    machine: &Machine,
    items: &[Item],
    presses: &[(u64, Request)],
    scenario: &str,
    seed: u64,
) -> Vec<Seen> {
    let scenario = Scenario::from_toml(scenario).expect("a scenario");
    let mut rig = Rig::new(machine, items.iter().copied(), scenario, seed).expect("a machine");
    let (mut seen, mut request): (Vec<Seen>, Option<Request>) = (Vec::new(), None);
    let mut last = presses.iter().map(|(at, _)| *at).max().unwrap_or(0) as usize;
    while seen.len() < LATEST as usize {
        let now = request.take();
        let more = rig.cycle(now, |record: &Record| {
            seen.push(Seen::of(record));
            last = if record.truth.pending == 0 { last } else { seen.len() };
            request = pressed(presses, record);
        });
        let (len, end) = (seen.len(), seen[seen.len() - 1]);
        let over = len > last + 400 && end.waits() && len > GIVEN as usize + 400;
        if !more || over {
            break;
        }
    }
    seen
}

/// Cycles in which something new begins: way, phase, offset.
pub(crate) fn borders(seen: &[Seen]) -> Vec<u64> {
    let sign = |seen: &Seen| (seen.speed_mm_s.signum() * f64::from(u8::from(seen.speed_mm_s != 0.0))) as i8;
    let differs =
        |two: &[Seen]| sign(&two[0]) != sign(&two[1]) || two[0].open != two[1].open || two[0].on != two[1].on;
    let at = seen.windows(2).enumerate().filter(|(_, two)| differs(two)).map(|(at, _)| at as u64 + 1);
    at.filter(|at| *at > GIVEN).collect()
}

/// What holds of every run, whatever happens: no place beyond the travel, no position that is believed and
/// wrong by more than `most_mm`, no step but that of the offset, which no servo notices, at the end at rest.
pub(crate) fn holds(machine: &Machine, seen: &[Seen], most_mm: f64, what: &str) {
    let [low, high] = machine.axis[&Axis::X].travel_mm;
    for (cycle, now) in seen.iter().enumerate() {
        assert!((low..=high).contains(&now.motor_mm), "{what}: {cycle}: {now:?}");
        assert!(now.open || now.off_mm.abs() <= most_mm, "{what}: {cycle}: {now:?}");
        assert!(now.error_mm.abs() < 0.3, "{what}: {cycle}: {now:?}");
    }
    for (cycle, two) in seen.windows(2).enumerate() {
        let (led, offset) = (two[1].commanded_mm - two[0].commanded_mm, two[0].off_mm - two[1].off_mm);
        let step = if offset.abs() > 1e-3 { led - offset } else { led };
        assert!(step.abs() < 0.1, "{what}: {cycle}: {:?}", two);
        let swung = two[1].error_mm - two[0].error_mm;
        assert!(offset.abs() < 1e-3 || swung.abs() < 1e-4, "{what}: {cycle}: {two:?}");
    }
    let end = seen.last().expect("it ran");
    assert!(end.speed_mm_s == 0.0, "{what}: {end:?}");
}

/// A count of the motor of X, mm.
pub(crate) fn count_mm(machine: &Machine) -> f64 {
    let x = &machine.axis[&Axis::X];
    x.screw_lead_mm / f64::from(x.encoder_counts)
}

/// What a method may be wrong by: a count of an index; of a switch what it repeats, and how the slide, at
/// which it is, stands beside the motor.
pub(crate) fn most_mm(machine: &Machine, method: Method) -> f64 {
    if method == Method::Switch { SCATTER_MM + 0.004 } else { count_mm(machine) }
}

#[test]
fn ten_machines_are_true_to_what_their_switch_or_index_repeats() {
    for method in [Method::Switch, Method::SwitchAndIndex, Method::Index] {
        let machine = lathe(method, "");
        let mut found = Vec::new();
        for seed in 1..=10 {
            let items = homing(&machine, seed);
            let seen = run(&machine, &items, &[(GIVEN, Request::Block)], "", seed);
            holds(&machine, &seen, most_mm(&machine, method), &format!("{method:?}, seed {seed}"));
            let end = seen.last().expect("it ran");
            assert!(end.waits() && !end.open && end.fault == 0, "{method:?}, seed {seed}: {end:?}");
            assert!((end.commanded_mm - machine.axis[&Axis::X].home_mm).abs() < 1e-6, "{end:?}");
            assert!((seen[GIVEN as usize].off_mm - OFF_MM).abs() < 1e-3, "it was not where it believed");
            found.push(1e3 * end.off_mm);
        }
        let (least, most) = found.iter().fold((f64::MAX, f64::MIN), |(a, b), um| (a.min(*um), b.max(*um)));
        println!("{method:?}: {least:.3} to {most:.3} µm beside the truth");
    }
}

/// Everything that an operator can press, in every cycle round each border.
#[test]
fn what_is_pressed_in_a_reference_run_leaves_the_axis_at_rest_and_lost_or_true() {
    let machine = lathe(Method::SwitchAndIndex, "");
    let items = homing(&machine, 5);
    let whole = run(&machine, &items, &[(GIVEN, Request::Block)], "", 5);
    let borders = borders(&whole);
    assert!(borders.len() >= 8, "search, back off, latch, set, home: {borders:?}");
    let most = most_mm(&machine, Method::SwitchAndIndex);
    let mut referenced = [0, 0];
    for request in [Request::FeedHold, Request::Stop, Request::Abort, Request::EmergencyStop] {
        for cycle in borders.iter().flat_map(|at| at - 6..at + 7) {
            let mut presses = vec![(GIVEN, Request::Block), (cycle, request)];
            if request == Request::FeedHold {
                presses.push((cycle + 500, Request::CycleStart));
            }
            let seen = run(&machine, &items, &presses, "", 5);
            let (what, end) = (format!("{request:?} in {cycle}"), *seen.last().expect("it ran"));
            holds(&machine, &seen, most, &what);
            referenced[usize::from(end.open)] += 1;
            match request {
                Request::FeedHold => assert!(end.waits() && !end.open && end.fault == 0, "{what}: {end:?}"),
                Request::EmergencyStop => assert_eq!(end.fault, Fault::EmergencyStop as u32, "{what}"),
                _ => assert!(end.state == MachineState::Ended && end.fault == 0, "{what}: {end:?}"),
            }
        }
    }
    assert!(referenced.iter().all(|runs| *runs > 20), "runs that end before and behind it: {referenced:?}");
}

/// The drive of the axis fails, loses its torque, the mains fail, the encoder jumps, the regulator or the
/// interpolator dies, round each border.
#[test]
fn what_breaks_in_a_reference_run_leaves_the_axis_at_rest_and_lost_or_true() {
    let machine = lathe(Method::SwitchAndIndex, "");
    let items = homing(&machine, 5);
    let borders = borders(&run(&machine, &items, &[(GIVEN, Request::Block)], "", 5));
    let most = most_mm(&machine, Method::SwitchAndIndex);
    for breaks in [
        "drive_fault = \"x\"",
        "drive_fault = \"z\"",
        "drive_fault = { axis = \"x\", torque_lost = true }",
        "power_lost = true",
        "axis_jump = { axis = \"z\", mm = 0.5 }",
        "kill = \"regulator-x\"",
        "kill = \"interpolator\"",
    ] {
        for cycle in borders.iter().flat_map(|at| (at - 5..at + 6).step_by(2)) {
            let scenario = format!("[[event]]\nat = {{ cycle = {cycle} }}\n{breaks}\n");
            let seen = run(&machine, &items, &[(GIVEN, Request::Block)], &scenario, 5);
            let (what, end) = (format!("{breaks} in {cycle}"), *seen.last().expect("it ran"));
            let [low, high] = machine.axis[&Axis::X].travel_mm;
            for (cycle, now) in seen.iter().enumerate() {
                assert!((low..=high).contains(&now.motor_mm), "{what}: {cycle}: {now:?}");
                assert!(now.open || now.off_mm.abs() <= most, "{what}: {cycle}: {now:?}");
            }
            let still = seen[seen.len() - 20..]
                .windows(2)
                .all(|two| (two[1].motor_mm - two[0].motor_mm).abs() < 1e-3);
            assert!(still, "{what}: {end:?}");
            let told = end.fault != 0 || breaks.contains("interpolator");
            assert!(told, "{what}: {end:?}");
        }
    }
}

#[test]
fn a_switch_or_an_index_that_does_not_come_is_a_fault_by_name() {
    let index = "switch_mm = 65.9\nindex_mm = 66.0";
    for (method, truth, fault) in [
        (Method::Switch, "reference_fault = \"switch-open\"", Fault::SwitchNotFound),
        (Method::SwitchAndIndex, "reference_fault = \"switch-open\"", Fault::SwitchNotFound),
        (Method::Switch, "reference_fault = \"switch-closed\"", Fault::SwitchNotReleased),
        (Method::SwitchAndIndex, "reference_fault = \"no-index\"", Fault::IndexNotFound),
        (Method::Index, "reference_fault = \"no-index\"", Fault::IndexNotFound),
        (Method::SwitchAndIndex, index, Fault::IndexTooNear),
    ] {
        let machine = lathe(method, truth);
        let items = homing(&machine, 3);
        let seen = run(&machine, &items, &[(GIVEN, Request::Block)], "", 3);
        let end = seen.last().expect("it ran");
        assert_eq!(Fault::from_code(end.fault), Some(fault), "{method:?}, {truth}: {end:?}");
        assert!(seen.iter().all(|now| now.open) && end.speed_mm_s == 0.0, "{truth}: {end:?}");
    }
}

#[test]
fn an_axis_that_stands_on_its_switch_backs_off_first() {
    let mut machine = lathe(Method::SwitchAndIndex, "");
    machine.axis.get_mut(&Axis::X).expect("it has an X").home_mm = 65.0;
    let seen = run(&machine, &homing(&machine, 9), &[(GIVEN, Request::Block)], "", 9);
    holds(&machine, &seen, count_mm(&machine), "on the switch");
    let (first, end) = (seen.iter().find(|now| now.speed_mm_s != 0.0), seen.last().expect("it ran"));
    assert!(first.is_some_and(|first| first.on && first.speed_mm_s < 0.0), "{first:?}");
    assert!(end.waits() && !end.open, "{end:?}");
}

/// A program makes the runs that are to be made, and cuts where the axes truly are.
#[test]
fn a_program_begins_with_its_reference_runs() {
    let machine = lathe(Method::SwitchAndIndex, "");
    let items = compiled(&machine, "G18 G21 G90 G94 G8\nG0 X30 Z20\nG1 X29 F600\nM2\n");
    let seen = run(&machine, &items, &[], "", 7);
    holds(&machine, &seen, count_mm(&machine), "a program");
    let end = seen.last().expect("it ran");
    assert!(end.state == MachineState::Ended && end.fault == 0 && !end.open, "{end:?}");
    assert!((end.motor_mm - 29.0).abs() < 0.003, "it stands where the program wants it: {end:?}");
}

#[test]
fn a_move_by_hand_is_refused_before_the_reference_run_and_a_jog_is_not() {
    let machine = lathe(Method::Switch, "");
    let at = begins(&machine, 4);
    for (jogs, fault) in [(false, Some(Fault::NotReferenced)), (true, None)] {
        let mut target = at;
        // Beyond the travel that it believes in: a jog may have to go there.
        target[Axis::X.index()] = Position::from_mm(if jogs { 71.0 } else { 50.0 });
        let feed = protocol::Feed::PerMinute(1200.0);
        let codes = [
            Code::ByHand(ByHand::Begins { at, jogs }),
            Code::Line { target, feed },
            Code::ByHand(ByHand::Waits),
        ];
        let presses =
            [(GIVEN - 1, Request::Jog(true)), (GIVEN, Request::Block), (GIVEN + 60, Request::Jog(false))];
        let seen = run(&machine, &session(codes), &presses, "", 4);
        let end = seen.last().expect("it ran");
        assert_eq!(Fault::from_code(end.fault), fault, "{end:?}");
        let moved = (end.motor_mm - seen[GIVEN as usize].motor_mm).abs() > 0.1;
        assert!(moved == jogs && end.open && end.speed_mm_s == 0.0, "{end:?}");
    }
}

/// The slide is at its switch, the nut on a flank: half the backlash is no error of the position.
#[test]
fn behind_a_switch_backlash_is_known() {
    let backlash = "backlash_mm = 0.1";
    let machine = made_of(PLAIN, Method::Switch, backlash, backlash);
    for seed in 1..=10 {
        let seen = run(&machine, &homing(&machine, seed), &[(GIVEN, Request::Block)], "", seed);
        let end = seen.last().expect("it ran");
        assert!(end.waits() && !end.open && end.fault == 0, "seed {seed}: {end:?}");
        assert!(end.off_mm.abs() <= most_mm(&machine, Method::Switch), "seed {seed}: {end:?}");
    }
}

/// With a bus that delays, a screw whose error is compensated, backlash, a slide that hangs, a motor that
/// cogs; and with a scale at the slide.
#[test]
fn lathes_of_other_kinds_are_true_behind_their_reference_runs() {
    let compensated = "screw_error = [[0, 0], [60, 12], [120, -9]]\nbacklash_mm = 0.003";
    let scale = "scale_step_mm = 0.0001";
    let plain_truth = "backlash_mm = 0.003\nscrew_error = [[0, 0], [60, 12], [120, -9]]";
    for (lathe, believed, truth, most_mm) in [
        // A count; what is measured is a cycle old, and a motor that stands is not quite still.
        (SMALL, "", "", count_mm(&Machine::default()) + 5e-5),
        // Where the nut stands beside the motor is the screw's affair.
        (PLAIN, compensated, plain_truth, 0.005),
        // The slide is not where its motor is: by the friction of its guide.
        (PLAIN, scale, "", 0.005),
    ] {
        for method in [Method::SwitchAndIndex, Method::Index] {
            let machine = made_of(lathe, method, believed, truth);
            let seen = run(&machine, &homing(&machine, 2), &[(GIVEN, Request::Block)], "", 2);
            let (what, end) = (format!("{method:?} with {believed:?}"), seen.last().expect("it ran"));
            println!("{what}: {:.3} µm beside the truth", 1e3 * end.off_mm);
            assert!(end.waits() && !end.open && end.fault == 0, "{what}: {end:?}");
            assert!(end.off_mm.abs() <= most_mm, "{what}: {end:?}");
            let [low, high] = machine.axis[&Axis::X].travel_mm;
            let steady = |now: &Seen| (low..=high).contains(&now.motor_mm) && now.error_mm.abs() < 0.3;
            assert!(seen.iter().all(steady), "{what}: {:?}", seen.iter().find(|now| !steady(now)));
        }
    }
}
