//! What the machine does, in words. In: a [`Record`], the tool by its name, the reference run in hand. Out:
//! the state by its name, and a line for people.

use protocol::{Axis, AxisState, MachineState, Motion, Panel};
use rig::observe::Record;

use super::homing::Homing;

/// An axis that is slower than this stands, mm/s.
const AXIS_STANDS: f64 = 0.05;

/// The state by its name and in words.
pub(super) fn words(record: &Record, tool_name: &str, homing: &Homing) -> (&'static str, String) {
    let Record { truth, axes, machine } = record;
    let panel = &truth.measurement.panel;
    let moves = moves(record);
    let in_pass = is_in_pass(record);
    let pass = machine.pass;
    let line = if homing.is_by_hand() {
        format!("block {}", machine.line)
    } else {
        format!("line {}", machine.line)
    };
    let said = |state: &'static str, words: String| (state, words);
    let fault = protocol::Fault::from_code(machine.fault);
    if panel.pressed(Panel::EMERGENCY_STOP) {
        return said("emergency-stop", "emergency stop is pressed".into());
    }
    if let Some(fault) = fault.filter(|_| machine.state() == MachineState::Fault) {
        return said("fault", format!("fault: {}", fault.text()));
    }
    if panel.pressed(Panel::STOP) || panel.pressed(Panel::ABORT) {
        return said("stopping", "comes to rest; the program ends".into());
    }
    if panel.pressed(Panel::FEED_HOLD) && machine.state() != MachineState::ToolChange {
        return match (in_pass, moves) {
            (true, _) => {
                said("holding", format!("hold is pressed; pass {pass} goes on as the machine file says"))
            }
            (_, true) => said("holding", "hold: comes to rest".into()),
            _ => match homing.axis() {
                Some(axis) => {
                    said("held", format!("held in the reference run of {axis}; start goes on with it"))
                }
                None => said("held", "held; start goes on".into()),
            },
        };
    }
    match machine.state() {
        MachineState::Starting => said("starting", "waits for the drives".into()),
        MachineState::Ready => said(
            "ready",
            homing.words().unwrap_or_else(|| format!("between two blocks, {line}{}", stands(record))),
        ),
        MachineState::Moving => match machine.motion() {
            Motion::Rapid => {
                said("rapid", homing.words().unwrap_or_else(|| format!("rapid, {line}{}", stands(record))))
            }
            _ => said("moving", homing.words().unwrap_or_else(|| format!("feed, {line}{}", stands(record)))),
        },
        MachineState::Waiting => {
            said("waiting", format!("waits for the spindle, or dwells, {line}{}", stands(record)))
        }
        MachineState::Threading => {
            said("threading", format!("{}, {line}{}", in_words(axes, pass), stands(record)))
        }
        MachineState::Paused => match homing.axis() {
            Some(axis) => {
                said("paused", format!("single block: start goes on with the reference run of {axis}"))
            }
            None if panel.pressed(Panel::SINGLE_BLOCK) => {
                said("paused", format!("single block, {line}: start goes on"))
            }
            None => said("paused", format!("{line} is a pause: start goes on")),
        },
        MachineState::ToolChange => said("tool-change", tool_in_words(machine.tool, tool_name)),
        MachineState::ByHand => said("by-hand", "ready: jog, or give a block".into()),
        MachineState::Ended => said("ended", "the program is over".into()),
        MachineState::Fault => said("fault", "fault".into()),
    }
}

/// What is turned down to nothing, if that is why nothing moves. Between two blocks it may be: a block waits
/// there for the spindle, or for its feed.
fn stands(record: &Record) -> String {
    let (panel, machine) = (&record.truth.measurement.panel, record.machine);
    let [spindle, feed] = [machine.spindle_override_pct, machine.feed_override_pct].map(|pct| pct == 0.0);
    let said = match (machine.state(), machine.motion()) {
        (MachineState::Ready, _) if spindle && feed => "; the overrides of spindle and feed are 0 %",
        (MachineState::Ready | MachineState::Waiting, _) if spindle => "; the spindle override is 0 %",
        (MachineState::Ready, _) if feed => "; the feed override is 0 %",
        (MachineState::Ready, _) if panel.rapid_override_pct == 0.0 => "; the rapid override is 0 %",
        (MachineState::Threading, _) if spindle => "; the spindle stands: its override is 0 %",
        (MachineState::Moving, Motion::Rapid) if panel.rapid_override_pct == 0.0 => {
            "; it stands: the rapid override is 0 %"
        }
        (MachineState::Moving, Motion::Feed) if feed => "; it stands: the feed override is 0 %",
        // A feed per revolution.
        (MachineState::Moving, Motion::Feed) if spindle && !moves(record) => {
            "; it stands: the spindle override is 0 %"
        }
        _ => "",
    };
    said.into()
}

/// Whether an axis moves.
fn moves(record: &Record) -> bool {
    record.axes.iter().any(|(_, status)| status.velocity_mm_s.abs() > AXIS_STANDS)
}

/// The tool that is waited for, in words.
fn tool_in_words(number: u32, name: &str) -> String {
    match (number, name) {
        (0, _) => "take the tool out, and say so".into(),
        (number, "") => format!("put in T{number}, and say that it is in"),
        (number, name) => format!("put in T{number}, {name}, and say that it is in"),
    }
}

/// Whether an axis is in a pass that has begun.
pub(super) fn is_in_pass(record: &Record) -> bool {
    record.axes.iter().any(|(_, status)| status.state().has_begun())
}

/// Where a pass is.
fn in_words(axes: &[(Axis, protocol::AxisStatus)], pass: u32) -> String {
    let state = axes.iter().map(|(_, status)| status.state()).find(|state| state.is_in_pass());
    match state {
        Some(AxisState::Armed) => format!("pass {pass} waits for the index"),
        Some(AxisState::WaitingForC0 | AxisState::RunIn) => format!("pass {pass} runs in"),
        Some(AxisState::Locked) => format!("pass {pass} is on the helix"),
        Some(AxisState::RunOut) => format!("pass {pass} runs out"),
        Some(AxisState::Leaving) => format!("pass {pass} is left"),
        _ => format!("pass {pass}"),
    }
}

#[cfg(test)]
mod tests {
    use protocol::{MachineStatus, Truth};

    use super::*;

    #[test]
    fn what_is_turned_down_to_nothing_is_said_where_it_stands_for_that() {
        let said = |state: MachineState, motion: Motion, overrides: [f64; 3]| {
            let [spindle_override_pct, feed_override_pct, rapid] = overrides;
            let mut truth = Truth::default();
            truth.measurement.panel.rapid_override_pct = rapid;
            let machine = MachineStatus {
                state: state as u32,
                motion: motion as u32,
                spindle_override_pct,
                feed_override_pct,
                ..MachineStatus::default()
            };
            stands(&Record { truth: &truth, axes: &[], machine: &machine })
        };
        let (threading, moving) = (MachineState::Threading, MachineState::Moving);
        assert!(said(threading, Motion::Feed, [0.0, 100.0, 100.0]).contains("spindle"));
        assert!(said(moving, Motion::Feed, [100.0, 0.0, 100.0]).contains("feed"));
        assert!(said(moving, Motion::Rapid, [100.0, 100.0, 0.0]).contains("rapid"));
        for (state, motion) in [(threading, Motion::Feed), (moving, Motion::Feed), (moving, Motion::Rapid)] {
            assert_eq!(said(state, motion, [100.0; 3]), "");
        }
        assert_eq!(said(moving, Motion::Rapid, [0.0, 0.0, 100.0]), "", "neither is why");
        // No axis moves: a feed per revolution stands with the spindle.
        assert!(said(moving, Motion::Feed, [0.0, 100.0, 0.0]).contains("spindle"));
        let (ready, waiting) = (MachineState::Ready, MachineState::Waiting);
        assert!(said(ready, Motion::None, [0.0, 100.0, 100.0]).contains("spindle"));
        assert!(said(ready, Motion::None, [100.0, 0.0, 100.0]).contains("feed"));
        assert!(said(ready, Motion::None, [0.0; 3]).contains("spindle and feed"));
        assert!(said(ready, Motion::None, [100.0, 100.0, 0.0]).contains("rapid"));
        assert!(said(waiting, Motion::None, [0.0, 100.0, 100.0]).contains("spindle"));
        assert_eq!(said(waiting, Motion::None, [100.0, 0.0, 0.0]), "", "neither is why");
        assert_eq!(said(ready, Motion::None, [100.0; 3]), "");
    }
}
