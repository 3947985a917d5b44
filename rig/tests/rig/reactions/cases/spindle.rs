//! What the spindle does, what its encoder shows, and what somebody waits for in vain.

use machine::Machine;
use protocol::Fault;
use testing::Seed;

use super::super::case::Case;
use super::super::course::{AXES, Course, Moment, Stage};
use super::{EVERYWHERE, IN_PASS, WHOLE, Z, always, event, one_of, when};

/// A thread of 64 turns at 600 1/min.
const LONG: &str = "M3 S600\nG0 X12 Z8\nG0 X9.5\nG33 Z-120 K2\nG0 X12\nG0 Z10\nM5\nM2\n";
/// Slow ones: five counts in a control cycle, and less than its ramp leaves within 30 ms.
const SLOW: &str = "M3 S60\nG0 X12 Z8\nG0 X9.5\nG33 Z0 K2\nG0 X12\nM5\nM2\n";
const SLOWEST: &str = "M3 S20\nG0 X22 Z8\nG0 X20\nG33 Z0 K2\nG0 X22\nM5\nM2\n";
const CREEPS: &str = "M3 S40\nG0 X20 Z20\nG4 P3\nM5\nM2\n";
/// One long move.
const GLIDES: &str = "M3 S100\nG0 X20 Z20\nG1 X100 Z-300 F4000\nM5\nM2\n";
/// The spindle there and back, from different angles.
const TURNS: &str = "M3 S150\nG4 P0.71\nM4 S150\nG4 P0.77\nM3\nG4 P0.83\nM4\nG4 P0.89\nM3\nG4 P0.93\nM4\nG4 P0.97\n\
    M3\nG4 P1.03\nM4\nG4 P1.1\nM5\nM2\n";
/// A feed, which waits for the spindle.
const FEED: &str = "M3 S600\nG1 X50 Z90 F1000\nM5\nM2\n";

pub(super) fn cases() -> Vec<Case> {
    of_encoder().into_iter().chain(of_counts()).chain(of_spindle()).chain(of_waits()).collect()
}

fn of_encoder() -> Vec<Case> {
    // More than what an index that is met again is corrected by.
    let slips = |seed: &mut Seed, at| {
        let counts = if seed.below(2) == 0 { 4 } else { -4 };
        (0..3).map(|n| event(at + n, &format!("encoder_glitch_counts = {counts}"))).collect()
    };
    const GLITCHES: &[&str] = &[
        "encoder_glitch_counts = 40",
        "encoder_glitch_counts = -40",
        "encoder_glitch_counts = 3000",
        "encoder_glitch_counts = { counts = 40, for_s = 0.02 }",
        "encoder_glitch_counts = { counts = -5000, for_s = 0.0005 }",
    ];
    let met = |course: &Course, _: &Course, at: usize| {
        let number = |n: usize| course[n].measurement.index_number;
        (at..course.len()).find(|n| number(*n) > number(at))
    };
    let blind = |course: &Course, _: &Course, at: usize| {
        let turns = (course[at].deg / 360.0).floor() + Machine::plain().threading.index_lost_turns;
        (at..course.len()).find(|n| course[*n].deg >= 360.0 * turns)
    };
    vec![
        Case::new((Fault::EncoderPlausibility, 0), TURNS, &[Stage::Returning], slips).seen(met),
        Case::new((Fault::EncoderGlitch, 0), WHOLE, EVERYWHERE, one_of(GLITCHES)).seen(count_differs()),
        Case::new((Fault::EncoderIndexMissing, 0), WHOLE, EVERYWHERE, always("index_lost = { for_s = 99 }"))
            .seen(blind),
        Case::new((Fault::EncoderStands, 0), WHOLE, EVERYWHERE, always("encoder_stands = true"))
            .seen(count_differs()),
        Case::new((Fault::EncoderStands, 1), SLOW, IN_PASS, always("encoder_stands = true"))
            .lasting(60)
            .seen(count_differs()),
    ]
}

/// Counts that are lost and gained: corrected everywhere, and a fault where they are too many for a thread.
fn of_counts() -> Vec<Case> {
    let strict = |machine: &mut Machine| machine.threading.lost_counts_um = 0.1;
    let corrected = |now: &Moment, quiet: &Moment| {
        now.axes.iter().zip(&quiet.axes).all(|(now, quiet)| now.encoder_counts != quiet.encoder_counts)
    };
    let slips = |sign: i64| {
        move |seed: &mut Seed, at| {
            event(at, &format!("encoder_glitch_counts = {}", sign * (1 + seed.below(4) as i64)))
        }
    };
    let both = [(Fault::EncoderPulsesLost, -1), (Fault::EncoderPulsesGained, 1)];
    let cases = both.into_iter().flat_map(|(fault, sign)| {
        [
            Case::new((fault, 0), WHOLE, EVERYWHERE, slips(sign)).seen(count_differs()).reacts(corrected),
            Case::new((fault, 0), WHOLE, &[Stage::Thread], slips(sign))
                .on(strict)
                .lasting(210)
                .seen(count_differs())
                .told_by(Z),
        ]
    });
    cases.collect()
}

fn of_spindle() -> Vec<Case> {
    const REVERSAL: &str = "spindle_fault = \"reversal\"";
    const RUNAWAY: &str = "spindle_fault = \"runaway\"";
    const DEAF: &str = "packet = { channel = \"spindle-command\", count = 1000000, drop = true }";
    let softly = |machine: &mut Machine| {
        machine.plant = "[cutting]\nrise_s = 0.5".parse().expect("the plant of a test is a table");
    };
    let pushed =
        |seed: &mut Seed, at| event(at, &format!("axial_force_n = {:.0}", seed.between(15_800.0, 16_800.0)));
    vec![
        Case::new((Fault::SpindleReversed, 0), LONG, &[Stage::Thread], always(REVERSAL))
            .before(6000)
            .seen(backwards),
        Case::new((Fault::SpindleReversed, 1), LONG, &[Stage::Thread], always(REVERSAL))
            .before(6000)
            .seen(backwards)
            .told_above(),
        Case::new((Fault::SpindleRunaway, 0), LONG, &[Stage::Thread], always(RUNAWAY))
            .before(8000)
            .seen(too_fast),
        Case::new((Fault::SpindleRunaway, 1), CREEPS, &[Stage::Dwell], always(RUNAWAY))
            .lasting(1500)
            .seen(turn_too_much)
            .told_above(),
        // It is told once the axes stand: before, they brake.
        Case::new((Fault::SpindleRunaway, 1), GLIDES, &[Stage::Timed], always(RUNAWAY))
            .lasting(900)
            .seen(turn_too_much)
            .reacts(|now, quiet| now.led != quiet.led),
        Case::new((Fault::SpindleDoesNotStop, 0), CREEPS, &[Stage::Dwell], always(DEAF))
            .seen(turns_on)
            .told_above(),
        Case::new((Fault::ForceTooHigh, 0), LONG, &[Stage::Thread], pushed)
            .on(softly)
            .before(8000)
            .seen(when(forced))
            .told_above(),
    ]
}

fn of_waits() -> Vec<Case> {
    let blind = |machine: &mut Machine| machine.threading.index_lost_turns = 1e6;
    let fussy = |machine: &mut Machine| {
        machine.axis.values_mut().for_each(|axis| axis.in_position_mm = 1e-7);
    };
    let pushed =
        |seed: &mut Seed, at| event(at, &format!("axial_force_n = {:.0}", seed.between(100.0, 1000.0)));
    const LOADED: &str = "spindle_load = { torque_nm = 90000 }";
    vec![
        Case::new((Fault::SpindleNotAtSpeed, 0), FEED, &[Stage::Start], always("spindle_fault = \"stall\""))
            .seen(waits)
            .told_above(),
        // A tenth of its speed.
        Case::new((Fault::SpindleNotAtSpeed, 1), SLOWEST, &[Stage::Thread], always(LOADED))
            .lasting(400)
            .seen(when(|course, _, n| course[n].rpm < 2.0))
            .told_above(),
        Case::new((Fault::AxisNotInPosition, 0), WHOLE, &[Stage::Start], pushed)
            .on(fussy)
            .seen(waits)
            .told_above(),
        Case::new((Fault::IndexNotSeen, 0), LONG, &[Stage::Arming], always("index_lost = { for_s = 999 }"))
            .on(blind)
            // The next tick sees that every axis is armed.
            .seen(|course, twin, at| waits(course, twin, at).map(|armed| armed + 4))
            .told_above(),
    ]
}

/// The encoder of the spindle shows something else than without the event.
fn count_differs() -> impl Fn(&Course, &Course, usize) -> Option<usize> {
    when(|course, twin, n| course[n].measurement.spindle_count != twin[n].measurement.spindle_count)
}

/// Back faster than 5 % of the speed and a count in a tick. Who foresees it by a little has seen it in time.
fn backwards(course: &Course, _: &Course, at: usize) -> Option<usize> {
    let last = course.len() - 1;
    (at..=last).find(|n| course[*n].rpm < if *n == last { -27.0 } else { -33.0 })
}

/// Faster than the highest override (M103). Who foresees it by a little has seen it in time.
fn too_fast(course: &Course, _: &Course, at: usize) -> Option<usize> {
    let Machine { spindle, .. } = Machine::plain();
    let most = 1.15 * spindle.override_max_pct / 100.0 * 600.0 + 0.02 * spindle.max_rpm;
    let last = course.len() - 1;
    (at..=last).find(|n| course[*n].rpm > if *n == last { 0.97 * most } else { most })
}

/// It has turned a turn more than its commands explain.
fn turn_too_much(course: &Course, _: &Course, at: usize) -> Option<usize> {
    let Machine { spindle, general, .. } = Machine::plain();
    let told = course[at].machine.spindle_rpm;
    let explained = (1.0 + 0.02 * spindle.at_speed_pct) * told + 0.02 * spindle.max_rpm;
    let mut turns = 0.0;
    (at..course.len()).find(|n| {
        turns = f64::max(0.0, turns + (course[*n].rpm - explained) / 60.0 * general.cycle_s);
        turns > 1.0
    })
}

/// It was told to stop, and has had three times the time of its ramp.
fn turns_on(course: &Course, _: &Course, at: usize) -> Option<usize> {
    let Machine { spindle, general, .. } = Machine::plain();
    let ramp_s = course[at].machine.spindle_rpm / spindle.ramp_rpm_s;
    let told = (at..course.len()).find(|n| course[*n].machine.spindle_rpm == 0.0);
    told.map(|told| told + (3.0 * ramp_s / general.cycle_s) as usize)
}

/// Z needs 85 % of its torque for 20 ms.
fn forced(course: &Course, _: &Course, n: usize) -> bool {
    let most_nm = 0.85 * Machine::plain().axis[&AXES[Z]].torque_limit_nm;
    (n.saturating_sub(40)..=n).all(|n| course[n].measurement.axes[AXES[Z].index()].torque_nm.abs() > most_nm)
}

/// The last wait of the machine begins.
fn waits(course: &Course, _: &Course, _: usize) -> Option<usize> {
    let state = |n: usize| (course[n].machine.state, course[n].axes[Z].state);
    let last = course.len() - 2;
    (1..=last).rev().find(|n| state(*n - 1) != state(last))
}
