//! The status tells which tool the axes carry and how they are moved: of the setpoint of its tick, however
//! far the control looks ahead.

use machine::Machine;
use protocol::{MachineState, Motion, operator::Request};
use rig::observe::Record;

use crate::stand::{Stand, compiled};

/// Moves of two tools at Z of their own, and a thread.
const PROGRAM: &str = "G21 G90 G94\nG0 X20 Z50\nG1 Z40 F600\nG0 X25\nT1 M6\nG0 Z30\nG1 Z20\nG1 X22 Z15\n\
                       G4 P0.1\nT3 M6\nS600 M3\nG0 Z8\nG33 Z-10 K2\nG0 X40\nM2\n";

/// Of each tick the line, the tool, the motion, the state, and whether a pass has begun.
fn seen(request: impl Fn(&Record) -> Option<Request>) -> Vec<(u32, u32, Motion, MachineState, bool)> {
    let machine = Machine::plain();
    let items = compiled(&machine, PROGRAM);
    let mut seen = Vec::new();
    Stand { machine: &machine, items: &items, scenario: "", seed: 1 }.run(|record| {
        let status = record.machine;
        let in_pass = record.axes.iter().any(|(_, axis)| axis.state().has_begun());
        if status.cycle == record.truth.cycle {
            seen.push((status.line, status.tool, status.motion(), status.state(), in_pass));
        }
        request(record)
    });
    seen
}

#[test]
fn motion_and_tool_are_those_of_the_setpoint() {
    let of_line = |line: u32| match line {
        2 | 4 | 6 | 12 | 14 => Motion::Rapid,
        3 | 7 | 8 => Motion::Feed,
        _ => Motion::None,
    };
    let mut moved = [0; 16];
    for (line, tool, motion, state, in_pass) in seen(|_| None) {
        let expected = match line {
            0..=4 => 0,
            5..=9 => 1,
            _ => 3,
        };
        assert_eq!(tool, expected, "line {line}");
        // The tick in which a chain ends is Ready, or already at what follows.
        if motion != Motion::None {
            assert!(motion == of_line(line) && !in_pass, "{motion:?} in line {line}");
            moved[line as usize] += 1;
        } else {
            assert!(state != MachineState::Moving, "line {line} moves");
        }
    }
    for line in [2, 3, 4, 6, 7, 8, 12] {
        assert!(moved[line] > 10, "line {line}: {moved:?}");
    }
}

#[test]
fn a_feed_hold_on_the_way_changes_nothing() {
    let held = std::cell::Cell::new(0);
    let seen = seen(|record| {
        if record.machine.line != 7 {
            return None;
        }
        held.set(held.get() + 1);
        match held.get() {
            1000 => Some(Request::FeedHold),
            3000 => Some(Request::CycleStart),
            _ => None,
        }
    });
    let moving = seen.iter().filter(|(line, ..)| *line == 3 || *line == 7);
    let fed = moving.clone().filter(|(_, _, motion, ..)| *motion == Motion::Feed).count();
    assert!(fed + 2 >= moving.count() && fed > 1400, "{fed}");
}
