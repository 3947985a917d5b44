//! Jogs of an axis of which nobody knows where it is, watched from outside: they end at its switch, whatever
//! is pressed in every cycle round the moment in which it goes on; and reference runs so fast that more than
//! one index goes by.

use machine::{Machine, Method};
use protocol::{Axis, ByHand, Code, Fault, Feed, Item, PerAxis, Position, operator::Request};

use crate::references::{GIVEN, Seen, begins, count_mm, holds, homing, lathe, run, session};

/// Between two confirmations of a key that stays pressed, control cycles.
const AGAIN: u64 = 40;

/// A session of one jog of X so far and so fast, from there.
fn jog(at: PerAxis<Position>, mm: f64, mm_min: f64) -> Vec<Item> {
    let mut target = at;
    target[Axis::X.index()] = target[Axis::X.index()].moved(mm);
    session([
        Code::ByHand(ByHand::Begins { at, jogs: true }),
        Code::Line { target, feed: Feed::PerMinute(mm_min) },
        Code::ByHand(ByHand::Waits),
    ])
}

/// The key is pressed for so many cycles, and this besides.
fn pressed(cycles: u64, besides: &[(u64, Request)]) -> Vec<(u64, Request)> {
    let confirmed = (GIVEN - 1..GIVEN + cycles).step_by(AGAIN as usize).map(|at| (at, Request::Jog(true)));
    let mut presses: Vec<_> = confirmed.chain([(GIVEN, Request::Block)]).collect();
    // Two in one cycle would be one.
    presses.retain(|(at, _)| besides.iter().all(|(other, _)| at != other));
    presses.extend(besides);
    presses
}

/// In which cycle the switch is on first.
fn goes_on(seen: &[Seen]) -> u64 {
    seen.iter().position(|now| now.on).expect("it goes on") as u64
}

/// A lathe at which the switch of X is near, and that searches so fast, mm/s.
fn near(method: Method, search_mm_s: f64) -> Machine {
    let mut machine = lathe(method, "");
    let x = machine.axis.get_mut(&Axis::X).expect("it has an X");
    (x.home_mm, x.reference.as_mut().expect("it has one").search_mm_s) = (50.0, search_mm_s);
    machine
}

#[test]
fn a_jog_ends_at_the_switch_whatever_is_pressed_round_it() {
    for (method, mm_s) in [(Method::Switch, 25.0), (Method::SwitchAndIndex, 12.0)] {
        let machine = near(method, mm_s);
        machine.check().expect("there is room");
        let items = jog(begins(&machine, 3), 200.0, 60.0 * mm_s);
        let alone = run(&machine, &items, &pressed(8000, &[]), "", 3);
        let on = goes_on(&alone);
        let end = alone.last().expect("it ran");
        assert!(end.waits() && end.open && end.on && end.fault == 0, "{method:?}: {end:?}");
        for request in [
            Request::Jog(false),
            Request::FeedHold,
            Request::FeedOverride(40.0),
            Request::FeedOverride(200.0),
            Request::SingleBlock(true),
        ] {
            for cycle in on - 8..on + 13 {
                let mut besides = vec![(cycle, request)];
                if request == Request::FeedHold {
                    besides.push((cycle + 300, Request::CycleStart));
                }
                let seen = run(&machine, &items, &pressed(8000, &besides), "", 3);
                let (what, end) =
                    (format!("{method:?}, {request:?} in {cycle}"), seen.last().expect("it ran"));
                holds(&machine, &seen, 0.0, &what);
                assert!(end.waits() && end.open && end.fault == 0, "{what}: {end:?}");
                let beyond = seen.iter().fold(f64::MIN, |most, now| most.max(now.motor_mm));
                let at = seen.iter().find(|now| now.on).map_or(f64::MAX, |now| now.motor_mm);
                assert!(beyond - at < 2.5, "{what}: {} mm behind its switch", beyond - at);
            }
        }
    }
}

#[test]
fn one_that_stands_on_its_switch_jogs_off_it_and_no_further_onto_it() {
    let mut machine = lathe(Method::Switch, "");
    machine.axis.get_mut(&Axis::X).expect("it has an X").home_mm = 68.0;
    let at = begins(&machine, 3);
    for (mm, moves) in [(50.0, false), (-3.0, true)] {
        let seen = run(&machine, &jog(at, mm, 300.0), &pressed(2000, &[]), "", 3);
        let (first, end) = (seen[GIVEN as usize], seen.last().expect("it ran"));
        assert!(first.on && end.waits() && end.open && end.fault == 0, "{mm}: {end:?}");
        let went = end.commanded_mm - first.commanded_mm;
        assert!((went - if moves { mm } else { 0.0 }).abs() < 1e-6, "{mm}: it went {went} mm");
        assert_eq!(end.on, !moves, "{mm}: {end:?}");
    }
}

/// The true switch is where it is, whatever the controller takes for its direction; if nothing is said of it,
/// it is where it is looked for.
#[test]
fn a_search_the_wrong_way_finds_no_switch() {
    let [found, released] = [Some(Fault::SwitchNotFound), Some(Fault::SwitchNotReleased)];
    for (mm_s, truth, fault) in [
        (25.0, "switch_way = \"positive\"", None),
        (-25.0, "switch_way = \"positive\"", found),
        (25.0, "switch_way = \"negative\"\nswitch_mm = 20", found),
        // It stands on it.
        (25.0, "switch_way = \"negative\"", released),
        (-25.0, "", None),
    ] {
        let mut machine = lathe(Method::Switch, truth);
        let x = machine.axis.get_mut(&Axis::X).expect("it has an X");
        x.reference.as_mut().expect("it has one").search_mm_s = mm_s;
        machine.check().expect("there is room");
        let seen = run(&machine, &homing(&machine, 4), &[(GIVEN, Request::Block)], "", 4);
        let (what, end) = (format!("{mm_s} mm/s, {truth:?}"), seen.last().expect("it ran"));
        assert_eq!(Fault::from_code(end.fault), fault, "{what}: {end:?}");
        assert_eq!(end.open, fault.is_some(), "{what}: {end:?}");
        assert_eq!(end.speed_mm_s, 0.0, "{what}: {end:?}");
    }
}

/// The way to brake is longer than a turn of the motor: it passes more than one index behind the switch.
#[test]
fn the_first_index_behind_the_switch_counts_however_many_go_by() {
    for mm_s in [40.0, 120.0] {
        let mut machine = lathe(Method::SwitchAndIndex, "");
        let x = machine.axis.get_mut(&Axis::X).expect("it has an X");
        x.travel_mm[1] = 90.0;
        let reference = x.reference.as_mut().expect("it has one");
        (reference.search_mm_s, reference.latch_mm_s) = (mm_s, mm_s);
        machine.check().expect("there is room");
        for seed in 1..=5 {
            let seen = run(&machine, &homing(&machine, seed), &[(GIVEN, Request::Block)], "", seed);
            let (what, end) = (format!("{mm_s} mm/s, seed {seed}"), seen.last().expect("it ran"));
            assert!(end.waits() && !end.open && end.fault == 0, "{what}: {end:?}");
            assert!(end.off_mm.abs() <= count_mm(&machine), "{what}: {end:?}");
            let set = seen.windows(2).position(|two| two[0].open && !two[1].open).expect("it is set");
            let turns = (seen[set].motor_mm - 66.0) / 5.0;
            assert_eq!(turns > 1.0, mm_s > 100.0, "{what}: it latched {turns} turns behind its index");
        }
    }
}
