//! What ends a pass early, row by row of the table of faults: how long it takes until the axes leave, in
//! control cycles; that the tool stays in its groove until it is out of it; that it is out at the end.
//! `cargo test -p rig leaving -- --nocapture` prints the table.

use machine::{Machine, Reaction};
use protocol::{Axis, AxisState, Fault};
use rig::observe::Outcome;

use crate::stand::{Stand, compiled};

/// Lead 2 mm, groove 2.5 mm deep seen from where the tool is clear.
const PROGRAM: &str =
    "G18 G21 G90 G8 G94 G97\nM3 S{S}\nG0 X12 Z8\nG0 X9.5\nG33 Z-22 K2\nG0 X12\nG0 Z10\nM5\nM2\n";
const LEAD_MM: f64 = 2.0;
/// The steepest flank that it may have.
const TAN_FLANK: f64 = 0.258_6;
/// A tool that has been lifted by so much touches nothing, mm.
const OUT_MM: f64 = 2.3;

/// What happens in the thread, and what is to come of it.
struct Row {
    name: &'static str,
    action: &'static str,
    /// Control cycles until an axis leaves.
    within: u64,
    /// The fault of the machine; none for what the operator does.
    fault: Option<Fault>,
    /// Which axes can be led.
    sound: &'static [Axis],
    /// How far the tool may be off its groove while it touches, µm.
    off_um: Option<f64>,
}

/// What an outside observer saw.
#[derive(Debug)]
struct Seen {
    /// Cycles from the event until the first axis leaves.
    reaction: Option<u64>,
    /// Turns from the event until the tool is lifted by half of the way, and until it is out.
    half: Option<f64>,
    out: Option<f64>,
    /// Farthest off the groove in contact, µm.
    off_um: f64,
    lifted_mm: f64,
    outcome: Outcome,
    fault: u32,
}

/// Runs the thread with an event in the middle of it, at a cycle.
fn run(machine: &Machine, s_rpm: u32, action: &str, at: u64) -> Seen {
    let items = compiled(machine, &PROGRAM.replace("{S}", &s_rpm.to_string()));
    let scenario = format!(
        "[[event]]\nat = {{ cycle = {at} }}\n{action}\n[[event]]\nat = {{ cycle = {} }}\ncycle_start = true\n",
        at + 8000
    );
    let stand = Stand { machine, items: &items, scenario: &scenario, seed: 3 };
    let (mut groove, mut from_deg, mut from_x) = (None, 0.0, 0.0);
    let mut seen = Seen {
        reaction: None,
        half: None,
        out: None,
        off_um: 0.0,
        lifted_mm: 0.0,
        outcome: Outcome::Completed,
        fault: 0,
    };
    let mut over = false;
    let observation = stand.run(|record| {
        let (truth, cycle) = (record.truth, record.truth.cycle.0);
        let (x, z) = (truth.axes[0].slide_mm, truth.axes[2].slide_mm);
        let phase = z + LEAD_MM * truth.spindle_deg / 360.0;
        if cycle <= at {
            (groove, from_deg, from_x) = (Some(phase), truth.spindle_deg, x);
        }
        seen.fault = if record.machine.fault != 0 { record.machine.fault } else { seen.fault };
        over |= seen.out.is_some();
        if let (Some(groove), true, false) = (groove, cycle > at, over) {
            let leaves = |status: &protocol::AxisStatus| status.state() == AxisState::Leaving;
            if seen.reaction.is_none() && record.axes.iter().any(|(_, status)| leaves(status)) {
                seen.reaction = Some(cycle - at);
            }
            let lift = x - from_x;
            seen.lifted_mm = seen.lifted_mm.max(lift);
            let turns = (truth.spindle_deg - from_deg).abs() / 360.0;
            seen.half = seen.half.or((lift > 0.5 * LEAD_MM * 0.613).then_some(turns));
            seen.out = seen.out.or((lift > OUT_MM).then_some(turns));
            // The groove is what the same thread leaves without the event: its servo error is in it.
            let off_mm = (phase - groove).abs() - TAN_FLANK * lift.max(0.0);
            seen.off_um = seen.off_um.max(1e3 * off_mm);
        }
        None
    });
    seen.outcome = observation.outcome;
    seen
}

fn leaves_on_everything() -> Machine {
    let mut machine = Machine::plain();
    machine.threading.on_hold = Reaction::Leave;
    machine
}

const BOTH: &[Axis] = &[Axis::X, Axis::Z];

impl Row {
    /// What the operator does: both axes leave in the next cycle.
    const fn press(name: &'static str, action: &'static str) -> Row {
        Row { name, action, within: 1, fault: None, sound: BOTH, off_um: Some(5.0) }
    }

    /// A fault that both axes survive.
    const fn fault(name: &'static str, action: &'static str, fault: Fault) -> Row {
        Row { within: 2, fault: Some(fault), ..Row::press(name, action) }
    }

    /// The other axis is wherever it is.
    const fn leaves_only(self, sound: &'static [Axis]) -> Row {
        Row { sound, off_um: None, ..self }
    }

    const fn within(self, within: u64) -> Row {
        Row { within, ..self }
    }
}

/// The rows. An encoder of Z that jumps kicks the velocity loop of its drive for a cycle, whatever the
/// regulator does. An axis whose drive has failed is wherever it is.
const ROWS: [Row; 17] = [
    Row::press("hold", "feed_hold = true"),
    Row::press("stop", "stop = true"),
    Row::press("abort", "abort = true"),
    Row::fault("emergency stop", "emergency_stop = true", Fault::EmergencyStop).within(1),
    Row::fault("power lost", "power_lost = true", Fault::PowerLost).within(1),
    Row::fault("40 counts lost", "encoder_glitch_counts = -40", Fault::EncoderGlitch),
    Row::fault("glitch", "encoder_glitch_counts = 3000", Fault::EncoderGlitch),
    Row::fault("encoder dead", "encoder_stands = true", Fault::EncoderStands),
    Row::fault("drive of X", "drive_fault = \"x\"", Fault::DriveFault).leaves_only(&[Axis::Z]),
    Row::fault("drive of Z", "drive_fault = \"z\"", Fault::DriveFault).leaves_only(&[Axis::X]),
    Row::fault("torque of Z", "drive_fault = { axis = \"z\", torque_lost = true }", Fault::DriveFault)
        .leaves_only(&[Axis::X]),
    Row::fault("regulator of X dies", "kill = \"regulator-x\"", Fault::RegulatorSilent)
        .leaves_only(&[Axis::Z])
        .within(3),
    Row::fault("regulator of Z dies", "kill = \"regulator-z\"", Fault::RegulatorSilent)
        .leaves_only(&[Axis::X])
        .within(3),
    Row {
        off_um: Some(20.0),
        ..Row::fault("encoder of Z jumps", "axis_jump = { axis = \"z\", mm = 0.045 }", Fault::AxisJump)
    },
    Row::fault("encoder of X jumps", "axis_jump = { axis = \"x\", mm = 0.045 }", Fault::AxisJump),
    Row::press("spindle jams", "spindle_fault = \"jam\"").leaves_only(&[Axis::X]).within(4000),
    Row::press("spindle turns back", "spindle_fault = \"reversal\"").leaves_only(&[Axis::X]).within(20_000),
];

#[test]
fn every_row_leaves_the_thread_in_time_and_in_its_groove() {
    let machine = leaves_on_everything();
    println!("{:20} {:>6} {:>8} {:>7} {:>7} {:>8}  ended", "", "S", "cycles", "half", "out", "off µm");
    // In the middle of the thread, some turns behind its beginning.
    for (s_rpm, at) in [(200, 7800), (600, 5800), (2000, 5900)] {
        for Row { name, action, within, fault, sound, off_um } in &ROWS {
            if s_rpm > 200 && *name == "spindle turns back" {
                continue; // the thread is over before it does
            }
            let seen = run(&machine, s_rpm, action, at);
            let figures = format!("{name:20} {s_rpm:6} {seen:?}");
            let turns = |turns: Option<f64>| turns.map_or("-".into(), |turns| format!("{turns:.2}"));
            println!(
                "{name:20} {s_rpm:6} {:>8} {:>7} {:>7} {:8.2}  {:?} {:?}",
                seen.reaction.map_or("-".into(), |cycles| cycles.to_string()),
                turns(seen.half),
                turns(seen.out),
                seen.off_um,
                seen.outcome,
                Fault::from_code(seen.fault).map(Fault::code)
            );
            assert!(seen.reaction.is_some_and(|cycles| cycles <= *within), "{figures}");
            if let Some(fault) = fault {
                assert_eq!(Fault::from_code(seen.fault), Some(*fault), "{figures}");
            }
            if sound.contains(&Axis::X) {
                assert!(seen.lifted_mm > OUT_MM, "{figures}");
                assert!(seen.half.is_some_and(|turns| turns < 1.6), "{figures}");
            }
            if let Some(most_um) = off_um {
                assert!(seen.off_um < *most_um, "{figures}");
            }
        }
    }
}
