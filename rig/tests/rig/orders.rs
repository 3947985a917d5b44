//! What a scenario orders of whoever runs the machine: modules killed and frozen, messages tampered with.
#![allow(clippy::unwrap_used)]

use machine::Machine;
use protocol::{Axis, Fault, Item, MachineState, MachineStatus, Module};
use rig::Rig;
use sim_plant::Scenario;

use crate::stand::compiled;

/// A move of X and one of Z.
const PROGRAM: &str = "G18 G21 G90 G8 G94\nG0 X20 Z50\nG1 Z10 F3000\nM2\n";

fn rig(event: &str) -> Rig<std::vec::IntoIter<Item>> {
    let scenario = Scenario::from_toml(&format!("[[event]]\nat = {{ cycle = 900 }}\n{event}\n")).unwrap();
    let machine = Machine::plain();
    Rig::new(&machine, compiled(&machine, PROGRAM).into_iter(), scenario, 1).unwrap()
}

/// Ages of what the drive of X goes on with in the cycles from 898 to 910; and of the frames that arrive at X
/// from cycle 896 on, in ticks, with −1 for none.
fn ages(event: &str) -> (Vec<u64>, Vec<i64>) {
    let mut rig = rig(event);
    let (mut drives, mut frames) = (Vec::new(), Vec::new());
    for cycle in 0..=932 {
        rig.exchange(None, |exchange| {
            let x = Axis::X.index();
            if (898..=910).contains(&cycle) {
                drives.push(cycle - exchange.drives[x].cycle.0);
            }
            if cycle >= 896 && cycle % 4 == 0 {
                frames.push(exchange.frames[x].map_or(-1, |frame| (cycle - frame.cycle.0) as i64 / 4));
            }
        });
    }
    (drives, frames)
}

#[test]
fn messages_are_dropped_late_twice_and_in_another_order() {
    let drive = |what: &str| ages(&format!("packet = {{ channel = \"drive-command/x\", {what} }}")).0;
    assert_eq!(drive("drop = true"), [0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]);
    assert_eq!(drive("drop = true, count = 2")[..6], [0, 0, 1, 2, 0, 0]);
    assert_eq!(drive("delay_cycles = 2, count = 5"), [0, 0, 1, 2, 2, 2, 2, 0, 0, 0, 0, 0, 0]);
    assert_eq!(drive("delay_cycles = 2")[..6], [0, 0, 1, 0, 0, 0]);
    // The second is lost behind the first that comes again.
    assert_eq!(drive("duplicate = true")[..6], [0, 0, 0, 1, 0, 0]);
    assert_eq!(drive("duplicate = true, count = 2")[..8], [0, 0, 0, 1, 0, 1, 0, 0]);
    // The first comes behind the second, in the place of the third.
    assert_eq!(drive("reorder = true")[..7], [0, 0, 1, 0, 2, 0, 0]);

    let frame = |what: &str| ages(&format!("packet = {{ channel = \"axis-command/x\", {what} }}")).1;
    assert_eq!(frame("drop = true"), [1, -1, 1, 1, 1, 1, 1, 1, 1, 1]);
    assert_eq!(frame("delay_cycles = 3, count = 3")[..6], [1, -1, 2, 2, 1, 1]);
    assert_eq!(frame("reorder = true")[..6], [1, -1, 1, 3, 1, 1]);
}

fn end(event: &str) -> (MachineStatus, Vec<u32>) {
    let mut rig = rig(event);
    let mut ended = (MachineStatus::default(), Vec::new());
    for cycle in 0.. {
        assert!(cycle < 100_000, "the machine ends: {event}");
        let goes_on = rig.cycle(None, |record| {
            ended = (*record.machine, record.axes.iter().map(|(_, status)| status.fault).collect());
        });
        if !goes_on {
            break;
        }
    }
    ended
}

/// Of six hundred moves, so that code is still on its way in cycle 900.
fn code(event: &str) -> MachineStatus {
    let moves: String = (0..600).map(|line| format!("G1 X{} F3000\n", 20 - line % 2)).collect();
    let scenario = Scenario::from_toml(&format!("[[event]]\nat = {{ cycle = 900 }}\n{event}\n")).unwrap();
    let machine = Machine::plain();
    let items = compiled(&machine, &format!("G18 G21 G90 G8 G94\nG0 X20 Z50\n{moves}M2\n"));
    let mut rig = Rig::new(&machine, items.into_iter(), scenario, 1).unwrap();
    let mut status = MachineStatus::default();
    while rig.cycle(None, |record| status = *record.machine) {}
    status
}

#[test]
fn machine_code_that_is_late_is_not_lost_and_all_else_is_found() {
    let packet = |what: &str| format!("packet = {{ channel = \"machine-code\", {what} }}");
    let whole = code(&packet("delay_cycles = 40, count = 3"));
    assert_eq!((whole.fault, whole.state), (0, MachineState::Ended as u32));
    for what in ["drop = true", "duplicate = true", "reorder = true", "corrupt = 70"] {
        assert_eq!(code(&packet(what)).fault, Fault::BadMachineCode as u32, "{what}");
    }
}

#[test]
fn a_channel_to_every_regulator_is_that_of_each() {
    // The drive is late at the third answer that does not come; its regulator knows why none came.
    let (_, axes) = end("packet = { channel = \"measurement\", drop = true, count = 3 }");
    assert_eq!(axes, [Fault::MeasurementGap as u32; 2]);
    let (_, axes) = end("packet = { channel = \"measurement/z\", drop = true, count = 3 }");
    assert_eq!(axes[1], Fault::MeasurementGap as u32);
    assert_ne!(axes[0], Fault::MeasurementGap as u32);
}

#[test]
fn a_scenario_kills_freezes_and_thaws() {
    for (event, cycles) in [
        ("kill = \"regulator-x\"", 900..1000),
        ("freeze = { process = \"regulator-x\", for_s = 0.01 }", 900..920),
        ("freeze = \"regulator-x\"", 900..1000),
    ] {
        let mut rig = rig(event);
        for cycle in 0..1000 {
            rig.exchange(None, |exchange| {
                let age = cycle - exchange.drives[Axis::X.index()].cycle.0;
                assert!(cycle >= cycles.start || age == 0, "{event} in cycle {cycle}");
                assert!(cycle < cycles.end + 20 || age == 0, "{event} in cycle {cycle}");
                assert!(!cycles.contains(&cycle) || age > 0, "{event} in cycle {cycle}");
            });
        }
        assert_eq!(rig.is_dead(Module::Regulator(Axis::X)), event.starts_with("kill"));
    }
}
