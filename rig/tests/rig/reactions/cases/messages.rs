//! What is lost on the wires, or not sent by a module.

use machine::Machine;
use protocol::Fault;
use testing::Seed;

use super::super::case::Case;
use super::super::course::{AXES, Course, Moment, Stage};
use super::{EVERYWHERE, MISSING, WHOLE, Z, always, event, later, one_of, when};

/// Moves, with dwells shorter than a second.
const MOVES: &str = "M3 S100\nG0 X20 Z20\nG4 P0.5\nG1 X50 Z60 F8000\nG4 P0.5\nG1 X20 Z20\nG4 P0.5\nG1 X50 Z60\n\
    G4 P0.5\nM2\n";
/// Passes of a cycle.
const PASSES: &str = "M3 S900\nG0 X12 Z6\nG76 P2 Z-4 I-1 J0.1 K0.8 R1\nM5\nM2\n";

/// No more messages on a wire.
const FOR_GOOD: u64 = 9999;
/// Regulators that say nothing.
const DEAD: &[&str] = &["kill = \"regulator-z\"", "freeze = \"regulator-z\""];

pub(super) fn cases() -> Vec<Case> {
    of_frames().into_iter().chain(of_regulators()).chain(of_measurements()).collect()
}

/// Frames, machine code, and who sends and reads them.
fn of_frames() -> Vec<Case> {
    let steps = |line: u32| format!("G1 X{0} Z{0} F3000\n", 20 - line % 2);
    let steps: String = format!("G0 X20 Z20\n{}M2\n", (0..600).map(steps).collect::<String>());
    vec![
        Case::new(
            (Fault::StreamStarved, 0),
            WHOLE,
            &[Stage::Timed],
            lost("axis-command/z", FOR_GOOD, FOR_GOOD),
        )
        .lasting(60)
        .seen(when(|course, _, n| {
            let last = &course[n].led[Z];
            let moves = last.velocity_mm_s != 0.0 || last.acceleration_mm_s2 != 0.0;
            moves && course[n].measurement.cycle > last.cycle
        }))
        .told_by(Z),
        // They come again, and the axis rests where they were.
        Case::new((Fault::StreamStarved, 0), MOVES, &[Stage::SetOff], lost("axis-command/z", 15, 15))
            .seen(|course, _, at| (at + 4..course.len()).find(|n| course[*n].framed[Z]))
            .told_by(Z),
        Case::new(
            (Fault::StreamStarved, 1),
            MOVES,
            &[Stage::SetOff],
            lost("axis-command/z", FOR_GOOD, FOR_GOOD),
        )
        .seen(led_elsewhere())
        .told_above(),
        Case::new((Fault::Stopped, 0), WHOLE, &[Stage::Timed], always("drive_fault = \"x\""))
            .lasting(12)
            .seen(when(|course, _, n| course[n].stopped[Z]))
            .told_by(Z),
        // Counted from the tick that tells it to arm.
        Case::new((Fault::PassCalledOff, 0), PASSES, &[Stage::Arming], lost("axis-command/z", 1, 3))
            .seen(|_, _, at| Some(at - 3))
            .told_above(),
        Case::new((Fault::BadMachineCode, 0), &steps, &[Stage::Timed], lost("machine-code", 1, 3))
            .before(1000)
            .seen(|course, _, at| {
                let all = course.last()?.machine.moves;
                (at..course.len()).find(|n| course[*n].machine.moves == all)
            })
            .told_above(),
        // The next frame is due at the tick behind the next one.
        Case::new((Fault::InterpolatorSilent, 0), WHOLE, &[Stage::Dwell], always("kill = \"interpolator\""))
            .seen(|_, _, at| Some(at.div_ceil(TICK) * TICK + TICK + MISSING)),
    ]
}

/// Regulators and their drives.
fn of_regulators() -> Vec<Case> {
    // A status is more than three cycles old in the fourth cycle that gets none.
    let old = MISSING + 3;
    vec![
        Case::new((Fault::AxisFault, 0), WHOLE, EVERYWHERE, |_, _| String::new())
            .by_a_stranger()
            .seen(later(MISSING))
            .told_above(),
        Case::new((Fault::LateAnswers, 0), WHOLE, EVERYWHERE, lost("drive-command/z", 3, 30))
            .seen(later(MISSING))
            .told_by(Z),
        Case::new((Fault::RegulatorSilent, 0), WHOLE, EVERYWHERE, one_of(DEAD))
            .seen(later(MISSING))
            .reacts(asks),
        Case::new((Fault::RegulatorSilent, 1), WHOLE, EVERYWHERE, one_of(DEAD)).seen(later(old)).told_above(),
        Case::new((Fault::RegulatorSilent, 1), WHOLE, EVERYWHERE, lost("axis-status/z", FOR_GOOD, FOR_GOOD))
            .seen(later(old))
            .told_above(),
    ]
}

/// Three in a row: the regulator says so; more: its drive asks the others meanwhile. One in three: with the
/// thirteenth there are more than ten and a tenth of all.
fn of_measurements() -> [Case; 3] {
    let one_in_three = |_: &mut Seed, at: u64| {
        let drop = "packet = { channel = \"measurement/z\", drop = true }";
        (0..15).map(|n| event(at + 3 * n, drop)).collect::<String>()
    };
    [
        Case::new((Fault::MeasurementGap, 0), WHOLE, EVERYWHERE, lost("measurement/z", 3, 3))
            .seen(later(MISSING))
            .told_by(Z),
        Case::new((Fault::MeasurementGap, 0), WHOLE, EVERYWHERE, lost("measurement/z", 4, 40))
            .seen(later(MISSING))
            .reacts(asks),
        Case::new((Fault::MeasurementGap, 1), WHOLE, EVERYWHERE, one_in_three)
            .seen(later(12 * 3 + MISSING))
            .told_by(Z),
    ]
}

/// Control cycles of a tick.
const TICK: usize = 4;

fn lost(channel: &'static str, low: u64, high: u64) -> impl Fn(&mut Seed, u64) -> String {
    move |seed, at| {
        let count = seed.within(low..high + 1);
        event(at, &format!("packet = {{ channel = \"{channel}\", count = {count}, drop = true }}"))
    }
}

/// The drive of Z tells the others that it has had no command for too long.
fn asks(now: &Moment, _: &Moment) -> bool {
    now.measurement.axes[AXES[Z].index()].drive().is_late()
}

/// The setpoint that would arrive lies farther from the axis than it goes in six ticks.
fn led_elsewhere() -> impl Fn(&Course, &Course, usize) -> Option<usize> {
    let machine = Machine::plain();
    let most_mm = 6.0 * machine.general.interpolator_cycle_s * machine.axis[&AXES[Z]].velocity_mm_s;
    when(move |course, twin, n| {
        (twin[n].led[Z].position.mm() - course[n - 1].axes[Z].commanded_mm).abs() > most_mm
    })
}
