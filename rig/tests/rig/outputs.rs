//! Outputs against the plant: at rest, in step with motion, and at the end of a program, under whatever the
//! operator does meanwhile.
#![allow(clippy::unwrap_used)]

use machine::{AnalogOutput, Machine, Output};
use protocol::{
    Code, Feed, Item, MachineState, PathMode, Position, Set, SpindleMode, SpindleSpeed, operator::Request,
};
use rig::observe::{Observation, Outcome, Record};
use testing::{Seed, count};

use crate::stand::{Stand, compiled, pressed};

const FEED: Feed = Feed::PerMinute(600.0);

fn line(z: f64, feed: Feed) -> Code {
    let mut target = [Position(0); 8];
    (target[0], target[2]) = (Position::from_mm(50.0), Position::from_mm(z));
    Code::Line { target, feed }
}

const fn output(number: u8, on: bool, in_step: bool) -> Code {
    Code::Output { number, set: Set::Digital(on), in_step }
}

const ON: Code = output(3, true, false);
const OFF: Code = output(3, false, false);

/// Outputs 1, on and safe, 3, and 7, a chuck that is closed and opens; the analog one 2.
fn machine() -> Machine {
    let mut machine = Machine::plain();
    let output = |initial, safe, standstill| Output { name: "a".into(), initial, safe, standstill };
    let outputs =
        [(1, output(true, true, false)), (3, output(false, false, false)), (7, output(true, false, true))];
    machine.outputs = outputs.map(|(number, output)| (number.to_string(), output)).into();
    let range = [0.0, 10.0];
    let analog = AnalogOutput { name: "air".into(), unit: "bar".into(), range, initial: 1.0, safe: 0.5 };
    machine.analog_outputs = [("2".to_owned(), analog)].into();
    machine
}

/// A cycle of a run.
#[derive(Clone, Copy, Debug)]
struct Moment {
    cycle: u64,
    /// The digital outputs, and the analog one.
    on: u64,
    analog: f64,
    /// True position of the motor of Z, mm, the fastest axis, mm/s, and the spindle, 1/min.
    z: f64,
    mm_s: f64,
    rpm: f64,
    state: MachineState,
}

impl Moment {
    fn is_on(&self, number: u32) -> bool {
        self.on >> number & 1 == 1
    }

    fn is_over(&self) -> bool {
        matches!(self.state, MachineState::Ended | MachineState::Fault)
    }
}

/// On the exact path; lines of the program count from 1.
fn run(codes: &[Code], requests: &[(u64, Request)], scenario: &str) -> (Vec<Moment>, Observation) {
    let codes = [&Code::PathMode(PathMode::ExactPath)].into_iter().chain(codes);
    let items: Vec<_> = (0..).zip(codes).map(|(line, code)| Item { line, code: *code }).collect();
    let (machine, mut seen) = (machine(), Vec::new());
    let observation = Stand { machine: &machine, items: &items, scenario, seed: 5 }.run(|record: &Record| {
        let truth = record.truth;
        seen.push(Moment {
            cycle: truth.cycle.0,
            on: record.machine.outputs,
            analog: record.machine.analog[2],
            z: truth.axes[2].motor_mm,
            mm_s: truth.axes[0].velocity_mm_s.abs().max(truth.axes[2].velocity_mm_s.abs()),
            rpm: truth.spindle_rpm,
            state: record.machine.state(),
        });
        pressed(requests, record)
    });
    (seen, observation)
}

/// Number, on or off, line of each change, but for those of the chuck.
fn changes(observation: &Observation) -> Vec<(u32, bool, u32)> {
    let changes = observation.outputs.iter().map(|one| (one.number, one.on, one.line));
    changes.filter(|(number, ..)| *number != 7).collect()
}

/// Between two moves that would be one chain the axes stop, and the output changes where the first ends.
#[test]
fn an_output_is_switched_at_rest_between_the_moves() {
    let codes = [line(90.0, FEED), ON, output(1, false, false), line(80.0, FEED), OFF, Code::End];
    let (seen, observation) = run(&codes, &[], "");
    assert_eq!(observation.outcome, Outcome::Completed, "{:?}", observation.faults);
    let expected = [(1, true, 0), (3, true, 3), (1, false, 4), (3, false, 6), (1, true, 6)];
    assert_eq!(changes(&observation), expected);
    for (number, on, z) in [(3, true, 90.0), (3, false, 80.0)] {
        let change = observation.outputs.iter().find(|one| (one.number, one.on) == (number, on)).unwrap();
        let at = seen.iter().find(|moment| moment.cycle == change.cycle).unwrap();
        assert!((at.z - z).abs() < 0.02, "{at:?} beside {z}");
    }
    assert_eq!(seen.last().unwrap().on, 2, "safe at the end");
    assert_eq!(run(&codes, &[], "").1.trace_hash, observation.trace_hash);
}

/// On and off again without a move in between is a pulse: three interpolator cycles, and the one that
/// begins them.
#[test]
fn a_pulse_is_seen() {
    let (_, observation) = run(&[line(90.0, FEED), ON, OFF, Code::End], &[], "");
    assert_eq!(numbers(&observation), [(1, true), (3, true), (3, false)]);
    let of = |on| observation.outputs.iter().find(|one| (one.number, one.on) == (3, on)).unwrap().cycle;
    assert_eq!(of(false) - of(true), 4 * Machine::plain().cycles_per_tick());
}

/// Without the lines.
fn numbers(observation: &Observation) -> Vec<(u32, bool)> {
    changes(observation).iter().map(|(number, on, _)| (*number, *on)).collect()
}

/// A hold leaves outputs as they are; whatever ends the program makes them safe.
#[test]
fn outputs_stay_at_a_hold_and_are_safe_behind_whatever_ends_the_program() {
    let codes = [ON, line(50.0, FEED), Code::End];
    let held = [(2000, Request::FeedHold), (4000, Request::CycleStart)];
    let (_, observation) = run(&codes, &held, "");
    assert_eq!(observation.outcome, Outcome::Completed, "{:?}", observation.faults);
    assert_eq!(changes(&observation), [(1, true, 0), (3, true, 2), (3, false, 3)]);
    for request in [Request::Stop, Request::Abort, Request::EmergencyStop] {
        let (seen, observation) = run(&codes, &[(2000, request)], "");
        assert_ne!(observation.outcome, Outcome::Completed);
        assert_eq!(numbers(&observation), [(1, true), (3, true), (3, false)]);
        assert_eq!(seen.last().unwrap().on, 2, "{request:?}");
        let off = observation.outputs.iter().find(|one| (one.number, one.on) == (3, false)).unwrap();
        assert!(off.cycle > 1999, "{request:?}");
    }
}

/// Z goes down through 90, 80 and 70 mm in one chain; 3 is on from 90 to 70, the analog one 7 from 80 on.
fn in_step() -> Vec<Code> {
    let analog = Code::Output { number: 2, set: Set::Analog(7.0), in_step: true };
    vec![
        line(95.0, Feed::Rapid),
        line(90.0, FEED),
        output(3, true, true),
        line(80.0, FEED),
        analog,
        line(70.0, FEED),
        output(3, false, true),
        line(60.0, FEED),
        output(3, true, true),
        Code::End,
    ]
}

/// What Z does while the outputs have the state that they have: they change in the interpolator cycle in
/// which the path passes their place. `mm` is the way of that cycle and what the servo lags by.
fn follows_the_path(seen: &[Moment], mm: f64) {
    for moment in seen.iter().take_while(|moment| !moment.is_over()) {
        let Moment { z, .. } = *moment;
        if moment.is_on(3) {
            assert!(z < 90.0 + mm && z > 70.0 - mm, "on too early or too long: {moment:?}");
        } else {
            assert!(z > 90.0 - mm || z < 70.0 + mm, "off too long or too early: {moment:?}");
        }
        let analog = if moment.analog == 7.0 { z < 80.0 + mm } else { moment.analog == 1.0 && z > 80.0 - mm };
        assert!(analog, "{moment:?}");
    }
}

/// In one chain at 10 mm/s, which outputs at rest would break: it is as long and as fast as without them, and
/// each output changes as the path passes its place.
#[test]
fn in_step_with_motion_an_output_costs_no_time() {
    let (seen, observation) = run(&in_step(), &[], "");
    assert_eq!(observation.outcome, Outcome::Completed, "{:?}", observation.faults);
    assert_eq!(numbers(&observation), [(1, true), (3, true), (3, false)], "no move follows");
    let values: Vec<_> = observation.analog_outputs.iter().map(|one| (one.number, one.value)).collect();
    assert_eq!(values, [(2, 1.0), (2, 7.0), (2, 0.5)]);
    // 2 ms at 10 mm/s, and 10 µm of the servo.
    follows_the_path(&seen, 0.03);
    let moves: Vec<_> = in_step().into_iter().filter(|code| !matches!(code, Code::Output { .. })).collect();
    let (without, _) = run(&moves, &[], "");
    let z = |seen: &[Moment]| {
        seen.iter().take_while(|moment| moment.z > 60.1).map(|one| one.z).collect::<Vec<_>>()
    };
    assert_eq!(z(&seen), z(&without), "the same way to the last bit");
}

/// Whatever the operator does, and in whichever cycle: hold, override, single block and stop let the outputs
/// follow the path, an abort and an emergency stop make them safe at once.
#[test]
fn in_step_with_motion_whatever_is_pressed_and_when() {
    let (calm, _) = run(&in_step(), &[], "");
    let passes = |z: f64| calm.iter().find(|moment| moment.z < z).unwrap().cycle;
    let around = |at: u64| (at - 60..at + 20).step_by(17);
    for at in around(passes(90.0)).chain(around(passes(70.0))).chain([passes(85.0)]) {
        let goes_on = [
            vec![(at, Request::FeedHold), (at + 400, Request::CycleStart)],
            vec![
                (at, Request::FeedOverride(150.0)),
                (at + 300, Request::FeedOverride(20.0)),
                (at + 900, Request::FeedOverride(100.0)),
            ],
            vec![
                (at, Request::SingleBlock(true)),
                (at + 4000, Request::SingleBlock(false)),
                (at + 4001, Request::CycleStart),
            ],
        ];
        for requests in goes_on {
            let (seen, observation) = run(&in_step(), &requests, "");
            assert_eq!(observation.outcome, Outcome::Completed, "{requests:?}: {:?}", observation.faults);
            follows_the_path(&seen, 0.04);
        }
        for request in [Request::Stop, Request::Abort, Request::EmergencyStop] {
            let (seen, _) = run(&in_step(), &[(at, request)], "");
            if request == Request::Stop {
                follows_the_path(&seen, 0.04);
            }
            let last = seen.last().unwrap();
            assert!(!last.is_on(3) && last.is_on(1) && last.analog == 0.5, "{request:?} in {at}: {last:?}");
            // A tick, and the way there.
            let late = |moment: &&Moment| moment.cycle > at + 8 && moment.is_on(3);
            let stays = seen.iter().filter(late).count();
            assert!(request == Request::Stop || stays == 0, "{request:?} in {at}: on for {stays} cycles");
        }
    }
}

/// In the middle of the blend of a right angle, without a stop.
#[test]
fn in_step_with_motion_an_output_changes_within_a_blend() {
    let corner = |x: f64, z: f64| {
        let mut target = [Position(0); 8];
        (target[0], target[2]) = (Position::from_mm(x), Position::from_mm(z));
        Code::Line { target, feed: FEED }
    };
    let blend = Code::PathMode(PathMode::Blend { tolerance_mm: 0.2, merge_mm: 0.0 });
    let codes = [blend, corner(60.0, 95.0), output(3, true, true), corner(55.0, 95.0), Code::End];
    let (seen, observation) = run(&codes, &[], "");
    assert_eq!(observation.outcome, Outcome::Completed, "{:?}", observation.faults);
    let at = seen.iter().find(|moment| moment.is_on(3)).unwrap();
    // The middle of the blend is 0.2 mm from the corner, 0.14 mm in Z; the way of a tick is 0.02 mm.
    assert!((at.z - 95.0).abs() < 0.2 && at.z > 95.05 && at.mm_s > 4.0, "{at:?}");
}

/// More outputs than a chain has blocks, in lines of which several pass in a tick: none is lost, nothing is
/// slower.
#[test]
fn in_step_with_motion_every_short_line_may_have_an_output() {
    let feed = Feed::PerMinute(6000.0);
    let lines: Vec<Code> = (0..1500).map(|number| line(98.0 - 0.01 * f64::from(number), feed)).collect();
    let with = lines.iter().zip(0..).flat_map(|(line, number)| [output(3, number % 3 == 2, true), *line]);
    let with: Vec<Code> = with.chain([Code::End]).collect();
    let (seen, observation) = run(&with, &[], "");
    assert_eq!(observation.outcome, Outcome::Completed, "{:?}", observation.faults);
    assert!(observation.outputs.len() > 30 && observation.moves.starved == 0, "{observation:?}");
    assert!(seen.iter().any(|moment| moment.z < 83.013 && moment.is_on(3)), "the last one is on");
    let (without, _) = run(&[lines, vec![Code::End]].concat(), &[], "");
    let arrives = |seen: &[Moment]| seen.iter().position(|moment| moment.z < 83.1).unwrap();
    assert_eq!(arrives(&seen), arrives(&without), "the look-ahead is as long");
}

/// With a pass of a thread it changes with the index, and back with the move behind it.
#[test]
fn in_step_with_a_pass_an_output_changes_with_its_index() {
    let program =
        "G18 G21 G90 G8\nM3 S600\nG0 X12 Z8\nG0 X9.5\nM62 P3\nG33 Z-6 K2\nG0 X12\nM63 P3\nG0 Z8\nM5\nM2\n";
    let (machine, mut seen) = (machine(), Vec::new());
    let items = compiled(&machine, program);
    let stand = Stand { machine: &machine, items: &items, scenario: "", seed: 5 };
    let observation = stand.run(|record: &Record| {
        let begun = record.axes.iter().any(|(_, axis)| axis.state().has_begun());
        seen.push((record.truth.cycle.0, begun, record.machine.outputs >> 3 & 1 == 1, record.machine.line));
        None
    });
    assert_eq!(observation.outcome, Outcome::Completed, "{:?}", observation.faults);
    let index = seen.iter().find(|(_, begun, ..)| *begun).unwrap().0;
    let on = seen.iter().find(|(.., on, _)| *on).unwrap().0;
    // The tick that hears of it, and the one before.
    assert!((index..=index + 8).contains(&on), "on in {on}, index in {index}");
    let off = seen.iter().rfind(|(.., on, _)| *on).unwrap();
    assert_eq!(off.3, 9, "it goes off with the move in line 9: {off:?}");
}

/// The spindle turns, the axes move, and the program ends so, as M30 without M5 does.
fn turning() -> Vec<Code> {
    let speed = SpindleSpeed::Rpm(600.0);
    vec![
        Code::Spindle { mode: SpindleMode::Clockwise, speed },
        line(98.0, FEED),
        ON,
        line(96.0, FEED),
        Code::End,
    ]
}

/// The chuck opens at standstill alone, seen from outside; whether it has opened.
fn chuck_opens(seen: &[Moment], what: &str) -> bool {
    for pair in seen.windows(2) {
        if pair[0].is_on(7) != pair[1].is_on(7) && pair[0].cycle > 2 {
            let moment = pair[1];
            assert!(moment.rpm.abs() < 1.0 && moment.mm_s < 0.2, "{what}: {moment:?}");
        }
    }
    !seen.last().unwrap().is_on(7)
}

#[test]
fn a_chuck_opens_at_standstill_whatever_ends_the_program_and_when() {
    let (calm, observation) = run(&turning(), &[], "");
    assert_eq!(observation.outcome, Outcome::Completed, "{:?}", observation.faults);
    assert!(chuck_opens(&calm, "M30"));
    // Others, too, wait for the end of the motion.
    let off = observation.outputs.iter().find(|one| (one.number, one.on) == (3, false)).unwrap();
    let at = calm.iter().find(|moment| moment.cycle == off.cycle).unwrap();
    assert!(at.rpm.abs() < 1.0 && at.mm_s < 0.2, "{at:?}");
    let ends = calm.len() as u64;
    let mut random = Seed::new(16);
    let moments = count("PITCHLOCK_ENDS", 12);
    // Two in three around the end: the last 60 cycles, those in which the spindle runs down, all of it.
    for moment in 0..moments {
        let before = [60, 1500, ends - 100][moment as usize % 3];
        let at = ends - 1 - random.below(before as usize) as u64;
        for request in [Request::FeedHold, Request::Stop, Request::Abort, Request::EmergencyStop] {
            let more = (request == Request::FeedHold).then_some((at + 500, Request::CycleStart));
            let requests: Vec<_> = [(at, request)].into_iter().chain(more).collect();
            let (seen, _) = run(&turning(), &requests, "");
            assert!(
                chuck_opens(&seen, &format!("{request:?} in {at}")),
                "{request:?} in {at}: it stays closed"
            );
        }
    }
}

/// Faults: of the spindle, of a drive, of power. With an encoder that is not believed it stays closed.
#[test]
fn a_chuck_opens_at_standstill_whatever_fails() {
    let faults = [
        ("power_lost = true", true),
        ("drive_fault = \"z\"", true),
        ("spindle_fault = \"runaway\"", true),
        ("spindle_fault = \"reversal\"", true),
        ("encoder_stands = true", false),
    ];
    for (fault, opens) in faults {
        for cycle in [700, 2300, 3900] {
            let scenario = format!("[[event]]\nat = {{ cycle = {cycle} }}\n{fault}\n");
            let (seen, observation) = run(&turning(), &[], &scenario);
            let what = format!("{fault} in {cycle}");
            if observation.outcome == Outcome::Faulted {
                assert_eq!(chuck_opens(&seen, &what), opens, "{what}");
                assert!(!seen.last().unwrap().is_on(3), "{what}");
            } else {
                chuck_opens(&seen, &what);
            }
        }
    }
}

/// By the program: it waits for the spindle that runs down, and nothing makes it move under one that turns.
#[test]
fn a_program_moves_a_chuck_at_standstill_only() {
    let stop = Code::Spindle { mode: SpindleMode::Stop, speed: SpindleSpeed::Rpm(0.0) };
    let mut codes = turning();
    codes.splice(4.., [stop, output(7, false, false), line(94.0, FEED), output(7, true, false), Code::End]);
    let (seen, observation) = run(&codes, &[], "");
    assert_eq!(observation.outcome, Outcome::Completed, "{:?}", observation.faults);
    assert!(chuck_opens(&seen, "M5"));
    let times = observation.outputs.iter().filter(|one| one.number == 7).count();
    assert_eq!(times, 4, "closed, open, closed, open at the end");
    for wrong in [output(7, false, false), output(7, false, true)] {
        let mut codes = turning();
        codes.insert(4, wrong);
        let (seen, observation) = run(&codes, &[], "");
        assert_eq!(observation.outcome, Outcome::Faulted, "machine code of another hand");
        assert!(chuck_opens(&seen, "refused"));
    }
}
