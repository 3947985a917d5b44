//! Somebody turns the override in a pass, and while the spindle is on its way to the new speed the tool
//! leaves: for a dead encoder, a glitch of it, an abort, at any moment of that way. The regulators foretell
//! an angle that they cannot see by the speed they knew, so the spindle has to keep it
//! (`interpolator/src/spindle`).
//! In: cycles of the turn and of what happens, by seeds. Checked from outside, on the built-in lathe: how far
//! the slide is beside the groove in the part, how far beyond its flank, and the speed of the spindle.

use machine::Machine;
use protocol::{Axis, AxisState, Item};
use testing::Seed;

use crate::stand::{Stand, compiled};

const PROGRAM: &str =
    "G18 G21 G90 G8 G94 G97\nM3 S600\nG0 X12 Z8\nG0 X9.5\nG33 Z-60 K2\nG0 X12\nG0 Z10\nM5\nM2\n";
const LEAD_MM: f64 = 2.0;
/// A tool that is lifted by so much touches nothing, mm; the steepest flank that a groove may have.
const OUT_MM: f64 = 1.3;
const TAN_FLANK: f64 = 0.258_6;
/// A fault is told one or two ticks after it; the spindle may change its speed by the ramp until then, 1/min,
/// and by what its ripple makes of it.
const CHANGE_RPM: f64 = 12.0;

/// What is seen between the event and the end of the way out.
#[derive(Debug, Default)]
struct Seen {
    beside_um: f64,
    beyond_um: f64,
    lifted_mm: f64,
    /// Slowest and fastest the spindle was then, without its ripple, 1/min.
    rpm: Option<(f64, f64)>,
}

fn run(machine: &Machine, items: &[Item], seed: u64, turned: u64, pct: f64, at: u64, action: &str) -> Seen {
    let scenario = format!(
        "[[event]]\nat = {{ cycle = {turned} }}\nspindle_override_pct = {pct}\n[[event]]\nat = {{ cycle = {at} }}\n{action}\n"
    );
    let (mut seen, mut groove, mut from_x) = (Seen::default(), 0.0, 0.0);
    Stand { machine, items, scenario: &scenario, seed }.run(|record| {
        let (truth, cycle) = (record.truth, record.truth.cycle.0);
        let (x, z) = (truth.axes[0].slide_mm, truth.axes[2].slide_mm);
        let phase = z + LEAD_MM * truth.spindle_deg / 360.0;
        if cycle <= turned {
            (groove, from_x) = (phase, x);
        }
        let lift = x - from_x;
        let leaves = record.axes.iter().any(|(_, status)| status.state() == AxisState::Leaving);
        if cycle > at && leaves && lift < OUT_MM {
            let off_mm = (phase - groove).abs();
            seen.beside_um = seen.beside_um.max(1e3 * off_mm);
            seen.beyond_um = seen.beyond_um.max(1e3 * (off_mm - TAN_FLANK * lift.max(0.0)));
            let rpm = truth.spindle_rpm;
            let (least, most) = seen.rpm.unwrap_or((rpm, rpm));
            seen.rpm = Some((least.min(rpm), most.max(rpm)));
        }
        if cycle > at {
            seen.lifted_mm = seen.lifted_mm.max(lift);
        }
        None
    });
    seen
}

/// The cycle in which the tool is so far along its thread, undisturbed.
fn cycle_at(machine: &Machine, items: &[Item], z_mm: f64) -> u64 {
    let mut found = None;
    Stand { machine, items, scenario: "", seed: 1 }.run(|record| {
        let locked = |(axis, status): &(Axis, protocol::AxisStatus)| {
            *axis == Axis::Z && status.state() == AxisState::Locked
        };
        let led = record.axes.iter().any(locked);
        let there = led && record.truth.axes[2].slide_mm < z_mm;
        found = found.or(there.then_some(record.truth.cycle.0));
        None
    });
    found.expect("the thread is that long")
}

#[test]
fn a_tool_that_leaves_while_the_override_is_turned_keeps_to_its_groove() {
    let machine = Machine::default();
    let items = compiled(&machine, PROGRAM);
    let in_thread = cycle_at(&machine, &items, -10.0);
    let mut seeds = Seed::new(0x7e57);
    for case in 0..90 {
        let turned = in_thread + seeds.within(0..300);
        let at = turned + seeds.within(0..1400);
        let pct = [30.0, 60.0, 115.0][case % 3];
        let action = ["encoder_stands = true", "encoder_glitch_counts = 3000", "abort = true"][case / 3 % 3];
        let seen = run(&machine, &items, case as u64, turned, pct, at, action);
        let what = format!("to {pct} % at {turned}, {action} at {at}: {seen:?}");
        println!("{what}");
        assert!(seen.lifted_mm > OUT_MM, "{what}");
        assert!(seen.beyond_um < 5.0, "{what}");
        let (least, most) = seen.rpm.expect("it leaves");
        assert!(most - least < CHANGE_RPM, "{what}");
    }
}
