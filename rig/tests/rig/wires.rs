//! Wires that disturb: each does what it says to the messages it concerns and leaves the others alone; and
//! what the machine makes of it.
#![allow(clippy::unwrap_used)]

use std::{cell::RefCell, rc::Rc};

use machine::Machine;
use protocol::{
    Axis, AxisFrame, AxisState, Cycle, DriveState, Fault, Item, MachineState, MachineStatus, Measurement,
    Module, PerAxis, operator::Request,
};
use rig::wires::{Damaging, Disturbance, Doubling, Freezing, Late, Losing, Straight, Wire, Wires};
use rig::{Exchange, Rig};
use sim_plant::Scenario;

use crate::stand::{Stand, compiled};

const FRAMES_OF_X: Wire = Wire::Frame(Axis::X);

/// What arrives on a wire of frames of which each carries its moment as its line; a moment without a frame is
/// 0.
fn arriving(disturbance: impl Disturbance, sent: &[u32]) -> Vec<u32> {
    let mut wires = Straight.with(disturbance);
    let arrives = |(now, line): (usize, &u32)| {
        let frame = AxisFrame { line: *line, ..AxisFrame::default() };
        let sent = (*line != 0).then_some(&frame);
        wires.frame(Cycle(now as u64), Axis::X, sent).map_or(0, |frame| frame.line)
    };
    sent.iter().enumerate().map(arrives).collect()
}

/// Whether a message of these cycles is concerned.
fn in_cycles(cycles: &'static [u64]) -> impl Fn(Wire, Cycle) -> bool {
    move |wire, now| wire == FRAMES_OF_X && cycles.contains(&now.0)
}

#[test]
fn late_messages_keep_their_order_and_their_gaps() {
    let late = Late::new(2, |wire, _| wire == FRAMES_OF_X);
    assert_eq!(arriving(late, &[1, 2, 0, 4, 5, 0, 0]), [0, 0, 1, 2, 0, 4, 5]);
    let mut late = Late::new(2, |_, _| false);
    assert_eq!(late.carry(FRAMES_OF_X, Cycle(0), Some(7_u64)), Some(7));
    late.change(1, |_, _| true);
    assert_eq!(late.carry(FRAMES_OF_X, Cycle(1), Some(8_u64)), None);
    assert_eq!(late.carry(FRAMES_OF_X, Cycle(2), Some(9_u64)), Some(8));
    assert_eq!(late.carry(Wire::Spindle, Cycle(2), Some(1_u64)), None, "each wire has its own messages");
}

#[test]
fn lost_messages_are_gone() {
    assert_eq!(arriving(Losing::new(in_cycles(&[1, 3])), &[1, 2, 3, 4, 5]), [1, 0, 3, 0, 5]);
}

#[test]
fn doubled_messages_make_the_others_wait() {
    assert_eq!(arriving(Doubling::new(in_cycles(&[1])), &[1, 2, 3, 0, 5, 6]), [1, 2, 2, 3, 5, 6]);
}

#[test]
fn frozen_wires_show_the_last_message_again() {
    assert_eq!(arriving(Freezing::new(in_cycles(&[0, 2, 3])), &[1, 2, 3, 4, 5]), [0, 2, 2, 2, 5]);
}

#[test]
fn damaged_messages_differ_in_one_bit() {
    let mut damaging = Damaging::new(3, |_, now| now != Cycle(0));
    assert_eq!(damaging.carry(FRAMES_OF_X, Cycle(0), Some(0_u64)), Some(0));
    let mut turned = 0_u64;
    for now in 1..=64 {
        let bits = damaging.carry(FRAMES_OF_X, Cycle(now), Some(0_u64)).unwrap();
        assert_eq!(bits.count_ones(), 1);
        turned |= bits;
    }
    assert_eq!(turned, u64::MAX, "every bit has its turn");
}

#[test]
fn disturbances_can_be_stacked() {
    let mut wires = Straight.with(Losing::new(in_cycles(&[0]))).with(Late::new(1, |_, _| true));
    let frames = [1, 2, 3].map(|line| AxisFrame { line, ..AxisFrame::default() });
    let arrived = [0, 1, 2].map(|at| wires.frame(Cycle(at), Axis::X, Some(&frames[at as usize])).copied());
    assert_eq!(arrived.map(|frame| frame.map(|frame| frame.line)), [None, None, Some(2)]);
}

/// A move of X and one of Z.
const PROGRAM: &str = "G18 G21 G90 G8 G94\nG0 X20 Z50\nG1 Z10 F3000\nM2\n";

fn items() -> Vec<Item> {
    compiled(&Machine::plain(), PROGRAM)
}

/// Runs the program on a machine with these wires; everything that `see` returns, up to the end.
fn run<T>(wires: impl Wires, mut see: impl FnMut(&Exchange) -> T) -> Vec<T> {
    let mut rig =
        Rig::with_wires(&Machine::plain(), items().into_iter(), Scenario::none(), 1, wires).unwrap();
    let mut seen = Vec::new();
    while rig.exchange(None, |exchange| seen.push(see(exchange))) {
        assert!(seen.len() < 200_000, "the program ends");
    }
    seen
}

/// What the machine says at the end: its state and its fault, and the faults of its axes.
fn end(wires: impl Wires) -> (MachineStatus, Vec<u32>) {
    let ends = run(wires, |exchange| {
        let axes = exchange.record.axes.iter().map(|(_, status)| status.fault).collect();
        (*exchange.record.machine, axes)
    });
    ends.into_iter().next_back().unwrap()
}

#[test]
fn disturbances_that_concern_nothing_change_nothing() {
    let nothing = |_: Wire, _: Cycle| false;
    let wires = Straight
        .with(Late::new(3, nothing))
        .with(Losing::new(nothing))
        .with(Doubling::new(nothing))
        .with(Damaging::new(0, nothing))
        .with(Freezing::new(nothing));
    let positions = |exchange: &Exchange| exchange.record.truth.axes.map(|axis| axis.motor_mm.to_bits());
    assert_eq!(run(wires, positions), run(Straight, positions));
}

/// Frames of the tick before, drive commands and statuses of this cycle, the panel in the cycle after the
/// request.
#[test]
fn an_exchange_shows_what_went_between_the_modules() {
    let machine = Machine::plain();
    let k = machine.cycles_per_tick();
    let mut rig = Rig::new(&machine, items().into_iter(), Scenario::none(), 1).unwrap();
    let mut pressed = Vec::new();
    for cycle in 0..400 {
        let request = (cycle == 201).then_some(Request::FeedHold);
        rig.exchange(request, |exchange| {
            let Measurement { cycle: now, panel, .. } = exchange.record.truth.measurement;
            assert_eq!(now, Cycle(cycle));
            for (axis, status) in exchange.record.axes {
                let frame: Option<AxisFrame> = exchange.frames[axis.index()];
                let made = (cycle >= k && cycle % k == 0).then(|| Cycle(cycle - k));
                assert_eq!(frame.map(|frame| frame.cycle), made, "{axis:?} at {cycle}");
                assert_eq!(exchange.drives[axis.index()].cycle, now);
                assert_eq!(status.cycle, now);
            }
            assert_eq!(exchange.record.machine.cycle, Cycle(cycle / k * k));
            assert_eq!(exchange.spindle.cycle, Cycle((cycle / k).saturating_sub(1) * k));
            pressed.extend((panel.buttons != 0).then_some(cycle));
        });
    }
    assert_eq!(pressed.first(), Some(&202));
}

#[test]
fn a_lost_frame_is_bridged_and_many_are_a_fault() {
    let one = |wire, now: Cycle| wire == FRAMES_OF_X && now == Cycle(800);
    let (machine, axes) = end(Straight.with(Losing::new(one)));
    assert_eq!((machine.state, machine.fault), (MachineState::Ended as u32, 0), "{axes:?}");
    let all = |wire, now: Cycle| wire == FRAMES_OF_X && now >= Cycle(800);
    let (machine, axes) = end(Straight.with(Losing::new(all)));
    assert_eq!(machine.fault, Fault::StreamStarved as u32, "the cause, not that an axis has a fault");
    assert_eq!(axes[0], Fault::StreamStarved as u32);
}

#[test]
fn two_lost_measurements_are_bridged_and_the_third_is_named() {
    for (lost, fault) in [(2, 0), (3, Fault::MeasurementGap as u32)] {
        let some =
            move |wire, now: Cycle| wire == Wire::Measurement(Axis::Z) && (900..900 + lost).contains(&now.0);
        let (_, axes) = end(Straight.with(Losing::new(some)));
        assert_eq!(axes[1], fault, "{lost} measurements lost");
    }
}

#[test]
fn two_lost_commands_are_bridged_and_the_third_is_named() {
    let late = Fault::LateAnswers as u32;
    for (lost, fault) in [(2, 0), (3, late), (30, late)] {
        let some = move |wire, now: Cycle| wire == Wire::Drive(Axis::X) && (900..900 + lost).contains(&now.0);
        let (_, axes) = end(Straight.with(Losing::new(some)));
        assert_eq!(axes[0], fault, "{lost} commands lost");
    }
}

#[test]
fn machine_code_with_a_gap_or_twice_is_refused() {
    let second = || {
        let mut packets = 0;
        move |wire, _| {
            packets += u32::from(wire == Wire::Code);
            wire == Wire::Code && packets == 2
        }
    };
    for (machine, _) in
        [end(Straight.with(Losing::new(second()))), end(Straight.with(Doubling::new(second())))]
    {
        assert_eq!(machine.fault, Fault::BadMachineCode as u32);
    }
}

/// Wires of a test's own: only what is carried otherwise is written down.
struct Noting(Rc<RefCell<PerAxis<u32>>>);

impl Wires for Noting {
    fn frame<'a>(&'a mut self, _: Cycle, axis: Axis, sent: Option<&'a AxisFrame>) -> Option<&'a AxisFrame> {
        self.0.borrow_mut()[axis.index()] += u32::from(sent.is_some());
        sent
    }
}

#[test]
fn a_test_can_bring_wires_of_its_own() {
    let frames = Rc::new(RefCell::new(PerAxis::default()));
    let states = run(Noting(Rc::clone(&frames)), |exchange| exchange.record.axes[0].1.state);
    assert!(states.contains(&(AxisState::Streaming as u32)));
    let ticks = (states.len() as u64 - 1) / Machine::plain().cycles_per_tick();
    assert_eq!(u64::from(frames.borrow()[Axis::X.index()]), ticks);
}

/// What is seen of a machine whose module dies in one cycle, or freezes and thaws: for each cycle the ages of
/// the commands of the drives, whether a frame came, and the code that was taken.
fn ages(
    doom: impl Fn(&mut Rig<std::vec::IntoIter<Item>>, u64),
    cycles: u64,
) -> Vec<([u64; 2], bool, DriveState)> {
    let mut rig = Rig::new(&Machine::plain(), items().into_iter(), Scenario::none(), 1).unwrap();
    let mut seen = Vec::new();
    for cycle in 0..cycles {
        doom(&mut rig, cycle);
        rig.exchange(None, |exchange| {
            let age = |axis: Axis| cycle - exchange.drives[axis.index()].cycle.0;
            let drive = exchange.record.truth.measurement.axes[Axis::X.index()].drive();
            let frame = exchange.frames[Axis::X.index()].is_some();
            seen.push(([age(Axis::X), age(Axis::Z)], frame, drive.state().unwrap()));
        });
    }
    seen
}

#[test]
fn a_dead_regulator_answers_nothing_and_its_drive_trips() {
    let x = Module::Regulator(Axis::X);
    let seen = ages(|rig, cycle| if cycle == 900 { rig.kill(x) } else { rig.thaw(x) }, 1000);
    for (cycle, (ages, frame, drive)) in (0..).zip(&seen) {
        let dead_for = (cycle + 1_u64).saturating_sub(900);
        assert_eq!(*ages, [dead_for, 0], "in cycle {cycle}");
        assert_eq!(*frame, cycle > 0 && cycle % 4 == 0);
        if cycle > 8 && cycle <= 911 {
            assert_eq!(*drive, DriveState::OperationEnabled, "in cycle {cycle}");
        }
    }
    assert_eq!(seen[912].2, DriveState::FaultReaction);
    assert_eq!(seen[999].2, DriveState::Fault);
}

#[test]
fn a_dead_interpolator_sends_no_frame_and_a_dead_interpreter_no_code() {
    let seen = ages(
        |rig, cycle| {
            if cycle == 900 {
                rig.kill(Module::Interpolator)
            }
        },
        1000,
    );
    // What the tick before made still arrives.
    let last = seen.iter().rposition(|(_, frame, _)| *frame);
    assert_eq!(last, Some(900));

    let program = |line: u32| format!("G1 X{} F3000\n", 20 - line % 2);
    let program: String = (0..400).map(program).collect();
    let items = compiled(&Machine::plain(), &format!("G18 G21 G90 G8 G94\nG0 X20 Z50\n{program}M2\n"));
    let ends = |killed: Option<u64>| {
        let mut rig = Rig::new(&Machine::plain(), items.clone().into_iter(), Scenario::none(), 1).unwrap();
        let mut machine = MachineStatus::default();
        for cycle in 0.. {
            assert!(cycle < 100_000, "the program ends");
            if killed == Some(cycle) {
                rig.kill(Module::Interpreter);
                assert!(rig.is_dead(Module::Interpreter) && !rig.is_dead(Module::Interpolator));
            }
            if !rig.cycle(None, |record| machine = *record.machine) {
                break;
            }
        }
        machine
    };
    let (whole, early) = (ends(None), ends(Some(200)));
    assert_eq!((whole.fault, early.fault), (0, Fault::BadMachineCode as u32));
    assert!(early.moves > 0 && early.moves < whole.moves, "what was sent is executed: {early:?}");
    assert_eq!(ends(Some(9000)).moves, whole.moves, "whose code has all been sent may die");
}

#[test]
fn a_frozen_regulator_works_off_what_waited_for_it() {
    let z = Module::Regulator(Axis::Z);
    let doom = |from: u64, to: u64| {
        move |rig: &mut Rig<_>, cycle| match cycle {
            _ if cycle == from => rig.freeze(z),
            _ if cycle == to => rig.thaw(z),
            _ => {}
        }
    };
    // Two cycles are made good at once: nothing has changed afterwards.
    let seen = ages(doom(900, 902), 1200);
    let ages_of_z =
        |range: std::ops::Range<usize>| seen[range].iter().map(|(ages, ..)| ages[1]).collect::<Vec<_>>();
    assert_eq!(ages_of_z(899..904), [0, 1, 2, 0, 0]);
    // Twelve take four cycles, three of each going into the old ones.
    let seen = ages(doom(900, 912), 1200);
    let ages_of_z: Vec<_> = seen[910..918].iter().map(|(ages, ..)| ages[1]).collect();
    assert_eq!(ages_of_z, [11, 12, 9, 6, 3, 0, 0, 0]);
}

#[test]
fn a_frozen_interpreter_counts_as_dead_after_a_second() {
    let mut rig = Rig::new(&Machine::plain(), items().into_iter(), Scenario::none(), 1).unwrap();
    rig.freeze(Module::Interpreter);
    let mut machine = MachineStatus::default();
    let mut cycles = 0;
    while rig.cycle(None, |record| machine = *record.machine) {
        cycles += 1;
        assert!(cycles < 10_000, "the machine ends");
        assert_eq!(rig.is_dead(Module::Interpreter), cycles > 2000, "in cycle {cycles}");
    }
    assert_eq!(machine.fault, Fault::BadMachineCode as u32);
}

/// Nobody acts on what has been damaged, whatever bit of it: it is like a measurement that is lost.
#[test]
fn a_damaged_measurement_is_one_that_is_missing() {
    let machine = Machine::plain();
    let items = compiled(&machine, "G18 G21 G90 G8 G94 G97\nM3 S600\nG0 X12 Z8\nG0 X9.5\nM5\nM2\n");
    let told = |fate: &str| {
        let packet = format!("packet = {{ channel = \"measurement\", count = 2, {fate} }}");
        let scenario = format!("[[event]]\nat = {{ cycle = 400 }}\n{packet}\n");
        let seen = Stand { machine: &machine, items: &items, scenario: &scenario, seed: 3 }.run(|_| None);
        seen.trace_hash
    };
    let lost = told("drop = true");
    for bit in (0..size_of::<Measurement>() * 8).step_by(37) {
        assert_eq!(told(&format!("corrupt = {bit}")), lost, "bit {bit}");
    }
}
