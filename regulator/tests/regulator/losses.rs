//! What a regulator makes of frames and measurements that do not arrive, arrive late, or come again; and of a
//! spindle that runs away from its pass.
#![allow(clippy::unwrap_used)]

use machine::Machine;
use protocol::{
    Axis, AxisCommand, AxisFrame, AxisState, Changes, Cycle, DriveState, Fault, Measurement, Panel, Position,
    StatusWord, WayOut,
};
use regulator::{In, Out, Regulator};

use crate::stand::{ARMED, BEGINS, HOME_MM, OVER, T, arm, follows, frame, law, machine, measurement, timed};

/// Deepest place of the pass.
const DEPTH_MM: f64 = HOME_MM + 12.0 - 5.0;
const CLEAR_MM: f64 = HOME_MM + 14.0;

/// An axis that follows, and what it is given.
struct Stand {
    regulator: Regulator,
    out: Out,
    cycle: u64,
}

impl Stand {
    fn new(machine: &Machine) -> Stand {
        let mut out = Out::default();
        out.status.commanded_mm = HOME_MM;
        Stand { regulator: Regulator::new(machine, Axis::X), out, cycle: 4 }
    }

    /// What is measured in this cycle.
    fn measured(&self) -> Measurement {
        let [motor_mm, scale_mm] = follows(self.cycle, &self.out);
        measurement(self.cycle, motor_mm, scale_mm)
    }

    /// The same of an axis that is where timed motion has it, whether it is told or not.
    fn on_its_way(&self) -> Measurement {
        let mm = timed(self.cycle as f64).s;
        measurement(self.cycle, mm, mm)
    }

    /// One cycle with these.
    fn take(&mut self, measurement: &Measurement, frame: Option<&AxisFrame>) -> &Out {
        self.out = *self.regulator.tick(&In { measurement, frame });
        self.cycle += 1;
        &self.out
    }

    /// One undisturbed cycle.
    fn step(&mut self) -> &Out {
        let (measurement, frame) = (self.measured(), due(self.cycle));
        self.take(&measurement, frame.as_ref())
    }

    fn run_to(&mut self, cycle: u64) {
        while self.cycle < cycle {
            self.step();
        }
    }

    fn fault(&self) -> Option<Fault> {
        Fault::from_code(self.out.status.fault)
    }
}

/// The frame of a cycle, if one is due: every fourth.
fn due(cycle: u64) -> Option<AxisFrame> {
    cycle.is_multiple_of(4).then(|| frame(cycle))
}

/// Where an undisturbed axis is led, cycle by cycle.
fn undisturbed() -> Vec<f64> {
    let mut stand = Stand::new(&machine(|_| ()));
    (4..OVER).map(|_| stand.step().status.commanded_mm).collect()
}

#[test]
fn a_frame_that_comes_with_an_old_measurement_is_kept() {
    let want = undisturbed();
    for at in (BEGINS..BEGINS + 200).step_by(4).chain([ARMED]) {
        let mut stand = Stand::new(&machine(|_| ()));
        stand.run_to(at - 1);
        let measurement = stand.measured();
        stand.take(&measurement, None);
        let frame = due(at).unwrap();
        assert_eq!(*stand.regulator.tick(&In { measurement: &measurement, frame: Some(&frame) }), stand.out);
        // The measurement of that cycle, without the frame: it is there already.
        let measurement = stand.measured();
        stand.take(&measurement, None);
        while stand.cycle < OVER {
            let cycle = stand.cycle as usize;
            let got = stand.step().status.commanded_mm;
            assert!((got - want[cycle - 4]).abs() < 1e-9, "frame of cycle {at}, cycle {cycle}");
        }
        assert_eq!((stand.fault(), stand.out.status.refused), (None, 0));
    }
}

/// Behind a gap of more than two frames in timed motion the axis has braked; it never jumps to where it
/// should be by then.
#[test]
fn frames_that_are_lost_make_no_axis_jump() {
    let limits = machine(|_| ()).axis[&Axis::X].limits();
    for at in (BEGINS - 40..BEGINS + 400).step_by(4) {
        for lost in [1, 2, 3, 5, 20, 100] {
            let mut stand = Stand::new(&machine(|_| ()));
            stand.run_to(at);
            let mut before = (stand.out.status.commanded_mm, stand.out.status.velocity_mm_s);
            while stand.cycle < ARMED {
                let frame = due(stand.cycle).filter(|_| stand.cycle >= at + 4 * lost);
                let measurement = stand.measured();
                let now = stand.take(&measurement, frame.as_ref()).status.commanded_mm;
                let what = format!("{lost} lost from {at}, cycle {}", stand.cycle);
                // In fault the reference is what is measured.
                if stand.out.status.state() != AxisState::Fault {
                    let [step, speed] = [now - before.0, stand.out.status.velocity_mm_s];
                    let mean = 0.5 * (speed + before.1) * T;
                    assert!(speed.abs() <= limits.v, "{what}: {speed} mm/s");
                    assert!((speed - before.1).abs() <= 1.02 * limits.a * T, "{what}: {speed} mm/s");
                    // A setpoint within 1 µm of where the axis rests is taken as it comes.
                    assert!((step - mean).abs() <= 1e-3, "{what}: {step} mm");
                    before = (now, speed);
                }
            }
            let ended = (before.0 - HOME_MM - 12.0).abs() < 1e-9;
            match stand.fault() {
                None => assert!(ended, "{lost} lost from {at}: it rests at {} mm", before.0),
                fault => assert!(
                    fault == Some(Fault::StreamStarved) && lost > 1,
                    "{lost} lost from {at}: {fault:?}"
                ),
            }
        }
    }
}

#[test]
fn a_tenth_of_the_measurements_may_be_lost_and_no_more() {
    for (every, faulted) in [(8, true), (9, true), (11, false), (20, false)] {
        let mut stand = Stand::new(&machine(|_| ()));
        stand.run_to(150);
        let mut kept = None;
        while stand.cycle < ARMED && stand.fault().is_none() {
            let frame = due(stand.cycle).or(kept.take());
            if stand.cycle.is_multiple_of(every) {
                (kept, stand.cycle) = (frame, stand.cycle + 1);
                continue;
            }
            let measurement = stand.on_its_way();
            stand.take(&measurement, frame.as_ref());
        }
        assert_eq!(stand.fault(), faulted.then_some(Fault::MeasurementGap), "one of {every} lost");
    }
}

#[test]
fn a_gap_of_three_measurements_is_a_fault_and_one_of_two_is_none() {
    for (gap, fault) in [(1, None), (2, None), (3, Some(Fault::MeasurementGap))] {
        let mut stand = Stand::new(&machine(|_| ()));
        // No frame is due in it.
        stand.run_to(BEGINS + 101);
        stand.cycle += gap;
        let measurement = stand.on_its_way();
        let frame = due(BEGINS + 104).filter(|_| stand.cycle >= BEGINS + 104);
        stand.take(&measurement, frame.as_ref());
        assert_eq!(stand.fault(), fault, "{gap} missing");
    }
}

/// The pass with a way out, at a programmed speed.
fn pass(s_rpm: f64) -> AxisFrame {
    let AxisCommand::Arm { pass, direction, not_before, .. } = arm() else { panic!("it arms") };
    let out = WayOut {
        axis: Axis::X.index() as u32,
        leaves: WayOut::ON_STOP,
        clear: Position::from_mm(CLEAR_MM),
        free: Position::from_mm(HOME_MM + 11.0),
    };
    let command =
        AxisCommand::Arm { pass, s_rpm, direction, not_before, out, law: law(), changes: Changes::default() };
    let frame = frame(ARMED);
    AxisFrame::pack(Cycle(ARMED - 4), 7, frame.setpoint, frame.stop_s, &command)
}

/// A stand that has armed the pass.
fn armed(machine: &Machine, s_rpm: f64) -> Stand {
    let mut stand = Stand::new(machine);
    stand.run_to(ARMED);
    let measurement = stand.measured();
    stand.take(&measurement, Some(&pass(s_rpm)));
    assert_eq!(stand.out.status.state(), AxisState::Armed);
    stand
}

/// (M103): the spindle turns at 300 1/min, whatever the pass says.
#[test]
fn a_spindle_that_runs_away_is_left_in_the_first_cycle_of_the_pass() {
    let machine = machine(|_| ());
    let spindle = &machine.spindle;
    let most = (300.0 - 0.02 * spindle.max_rpm) / (1.15 * spindle.override_max_pct / 100.0);
    for (s_rpm, fault) in [(most + 3.0, None), (most - 3.0, Some(Fault::SpindleRunaway))] {
        let mut stand = armed(&machine, s_rpm);
        while matches!(stand.out.status.state(), AxisState::Armed) {
            stand.step();
        }
        stand.step();
        assert_eq!(stand.fault(), fault, "S {s_rpm}");
    }
}

/// Stop at every cycle of the way in: X comes to rest before it lifts, so it is never deeper than the pass,
/// and it ends where the tool is clear.
#[test]
fn who_leaves_on_the_way_in_goes_no_deeper_than_the_pass() {
    let machine = machine(|_| ());
    let limits = machine.axis[&Axis::X].limits();
    let mut stand = armed(&machine, 300.0);
    let mut pressed = 0;
    while stand.out.status.state() != AxisState::Locked {
        if matches!(stand.out.status.state(), AxisState::WaitingForC0 | AxisState::RunIn) {
            pressed += 1;
            leaves(&Stand { regulator: stand.regulator.clone(), ..stand }, &limits);
        }
        stand.step();
    }
    assert!(pressed > 300, "the way in has {pressed} cycles");
}

#[track_caller]
fn leaves(stand: &Stand, limits: &motion::Limits) {
    let from = stand.cycle;
    let mut stand = Stand { regulator: stand.regulator.clone(), ..*stand };
    let (mut before, mut last) = (stand.out.status, f64::MAX);
    while stand.cycle < from + 1000 {
        let mut measurement = stand.measured();
        measurement.panel.buttons |= Panel::STOP;
        let frame = stand.cycle.is_multiple_of(4).then(|| {
            let still = frame(OVER);
            AxisFrame::pack(Cycle(stand.cycle - 4), 7, still.setpoint, 1.0, &AxisCommand::Hold)
        });
        let now = stand.take(&measurement, frame.as_ref()).status;
        let what = format!("pressed in {from}, cycle {}", stand.cycle);
        assert!(now.commanded_mm >= DEPTH_MM - 1e-6, "{what}: {} mm", now.commanded_mm);
        assert!(now.velocity_mm_s.abs() <= limits.v && now.acceleration_mm_s2.abs() <= 1.02 * limits.a);
        let step = now.velocity_mm_s - before.velocity_mm_s;
        assert!(step.abs() <= 1.02 * limits.a * T, "{what}: the speed jumps by {step} mm/s");
        (before, last) = (now, now.commanded_mm);
    }
    assert!((last - CLEAR_MM).abs() < 1e-6, "pressed in {from}: it rests at {last} mm");
}

/// X fails between its arming and the index: who is armed with it must not go alone.
#[test]
fn an_armed_axis_does_not_begin_without_another() {
    let mut tried = 0;
    for at in ARMED..ARMED + 400 {
        let mut stand = Stand::new(&machine(|_| ()));
        stand.run_to(at);
        if stand.out.status.state() != AxisState::Armed {
            continue;
        }
        let before_mm = stand.out.status.commanded_mm;
        for _ in 0..600 {
            let (mut measurement, frame) = (stand.measured(), due(stand.cycle));
            measurement.axes[Axis::Z.index()].status_word = u32::from(StatusWord::of(DriveState::Fault).0);
            let out = stand.take(&measurement, frame.as_ref());
            assert!((out.status.commanded_mm - before_mm).abs() < 0.1, "{at}: {:?}", out.status);
        }
        assert_eq!(stand.fault(), Some(Fault::OtherAxis), "{at}");
        tried += 1;
    }
    assert!(tried > 20, "armed in {tried} cycles");
}
