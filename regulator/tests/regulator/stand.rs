//! A stand for the regulator of one axis: frames, a spindle that does not turn evenly, and measurements. The
//! axis goes 12 mm up in timed motion, 5 mm down and up again in a pass.
#![allow(clippy::unwrap_used, dead_code)]

use machine::{AxisConfig, Machine};
use motion::{Exit, FeedBlock, Limits, Sample};
use protocol::{
    Axis, AxisCommand, AxisFrame, AxisLaw, Changes, Cycle, DriveState, Measurement, Position, Setpoint,
    StatusWord, WayOut,
};
use regulator::{In, Out, Regulator};

/// The control cycle, s.
pub(crate) const T: f64 = 0.0005;
/// Where the axis starts, mm.
pub(crate) const HOME_MM: f64 = 60.0;
/// The drive is enabled in this cycle, timed motion begins, the pass is armed, and everything is over.
pub(crate) const ENABLED: u64 = 100;
pub(crate) const BEGINS: u64 = 400;
pub(crate) const ARMED: u64 = 2000;
pub(crate) const OVER: u64 = 6000;

const INDEX_COUNT: i64 = 5000;

/// The built-in lathe with another X.
pub(crate) fn machine(change: impl FnOnce(&mut AxisConfig)) -> Machine {
    let mut machine = Machine::plain();
    change(machine.axis.get_mut(&Axis::X).unwrap());
    machine.check().unwrap();
    machine
}

/// Those of timed motion: X can do more.
const LIMITS: Limits = Limits { v: 100.0, a: 1500.0, j: 60_000.0, dj: 6e6 };

/// Timed motion at a cycle.
pub(crate) fn timed(cycle: f64) -> Sample {
    let block = FeedBlock::plan(12.0, 0.0, 80.0, 0.0, &LIMITS).unwrap();
    let mut sample = block.at((cycle - BEGINS as f64) * T);
    sample.s += HOME_MM;
    sample
}

/// The pass: 5 mm down in a turn, a turn and a half at depth, up again in a turn.
pub(crate) fn law() -> AxisLaw {
    AxisLaw {
        start: Position::from_mm(HOME_MM + 12.0),
        end: Position::from_mm(HOME_MM + 12.0),
        stroke_mm: -5.0,
        stroke_c0_deg: 40.0,
        stroke_dc_deg: 360.0,
        retract_mm: 5.0,
        retract_c_deg: 940.0,
        retract_dc_deg: 360.0,
        ..AxisLaw::default()
    }
}

pub(crate) fn arm() -> AxisCommand {
    let not_before = Cycle(ARMED + 20);
    AxisCommand::Arm {
        pass: 1,
        s_rpm: 300.0,
        direction: 1.0,
        not_before,
        out: WayOut::default(),
        law: law(),
        changes: Changes::default(),
    }
}

/// The frame that takes effect in a cycle.
pub(crate) fn frame(cycle: u64) -> AxisFrame {
    let at = timed((cycle + 8) as f64);
    let node = Setpoint {
        cycle: Cycle(cycle + 8),
        position: Position::from_mm(at.s),
        velocity_mm_s: at.v,
        acceleration_mm_s2: at.a,
    };
    let command = match cycle {
        ARMED => arm(),
        _ if (ARMED..OVER).contains(&cycle) => AxisCommand::Hold,
        _ => AxisCommand::Stream,
    };
    // Another axis needs longer.
    let stop_s = Exit::stop_s(at.v, at.a, &LIMITS).max(0.1);
    AxisFrame::pack(Cycle(cycle - 4), 7, node, stop_s, &command)
}

/// What is measured in a cycle with the motor and the scale at these places.
pub(crate) fn measurement(cycle: u64, motor_mm: f64, scale_mm: f64) -> Measurement {
    let mut measurement = Measurement { cycle: Cycle(cycle), ..Measurement::default() };
    let turned = |cycle: u64| {
        let t = cycle as f64 * T;
        (50_000.0 * t + 20.0 * libm::sin(20.0 * t)).floor() as i64
    };
    let indexes = |cycle: u64| ((turned(cycle) + 10_000 - INDEX_COUNT) / 10_000) as u64;
    measurement.spindle_count = turned(cycle);
    measurement.index_number = indexes(cycle);
    if measurement.index_number > 0 {
        measurement.index_count = (measurement.index_number as i64 - 1) * 10_000 + INDEX_COUNT;
        let first =
            (0..=cycle).rev().take_while(|before| indexes(*before) == measurement.index_number).last();
        measurement.index_cycle = Cycle(first.unwrap());
    }
    let drive = if cycle < ENABLED { DriveState::SwitchedOn } else { DriveState::OperationEnabled };
    for axis in &mut measurement.axes {
        axis.position = Position::from_mm(motor_mm);
        axis.scale = Position::from_mm(scale_mm);
        axis.status_word = u32::from(StatusWord::of(drive).0);
    }
    measurement
}

/// Runs the regulator of X over everything. `axis` says where motor and scale are in a cycle, given the
/// answer of the cycle before; `see` gets what was measured and what the regulator answered.
pub(crate) fn run(
    machine: &Machine,
    mut axis: impl FnMut(u64, &Out) -> [f64; 2],
    mut see: impl FnMut(u64, &Measurement, &Out),
) {
    let mut regulator = Regulator::new(machine, Axis::X);
    let mut out = Out::default();
    out.status.commanded_mm = HOME_MM;
    for cycle in 4..OVER + 400 {
        let [motor_mm, scale_mm] = axis(cycle, &out);
        let measurement = measurement(cycle, motor_mm, scale_mm);
        let frame = cycle.is_multiple_of(4).then(|| frame(cycle));
        out = *regulator.tick(&In { measurement: &measurement, frame: frame.as_ref() });
        assert_eq!(out.status.refused, 0, "in cycle {cycle}");
        see(cycle, &measurement, &out);
    }
}

/// An axis that follows its command within half a micrometre.
pub(crate) fn follows(cycle: u64, before: &Out) -> [f64; 2] {
    let off_mm = 1e-4 * ((cycle * 7919 % 11) as f64 - 5.0);
    [before.status.commanded_mm + before.status.velocity_mm_s * T + off_mm; 2]
}
