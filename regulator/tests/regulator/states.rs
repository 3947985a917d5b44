//! Every state against every event: the transition table of `regulator::state`.

use protocol::{AxisCommand, AxisLaw, Cycle, Fault, Position, WayOut};
use regulator::{
    spindle::Index,
    state::{
        Event, Pass, Stage,
        State::{self, Idle, InPass, Streaming},
    },
};

/// Approach 1 mm over 100..200°, lead over 50..200°, braking 1000..1150°, retract over 990..1200°.
fn law() -> AxisLaw {
    AxisLaw {
        start: Position::from_mm(10.0),
        end: Position::from_mm(10.0),
        stroke_mm: -1.0,
        stroke_c0_deg: 100.0,
        stroke_dc_deg: 100.0,
        lead_mm: 2.0,
        run_in_c0_deg: 50.0,
        run_in_dc_deg: 150.0,
        run_in_lambda: 0.5,
        brake_c_deg: 1000.0,
        brake_dc_deg: 150.0,
        brake_lambda: 0.5,
        retract_mm: 1.0,
        retract_c_deg: 990.0,
        retract_dc_deg: 210.0,
    }
}

fn pass(index_count: i64) -> Pass {
    let law = law();
    Pass {
        number: 3,
        programmed_deg_s: 3600.0,
        direction: 1.0,
        not_before: Cycle(100),
        index_count,
        law,
        motion: law.law(600.0),
    }
}

fn armed(pass: Pass) -> State {
    InPass { pass, stage: Stage::Armed }
}

fn waiting_for_c0(pass: Pass) -> State {
    InPass { pass, stage: Stage::WaitingForC0 }
}

fn run_in(pass: Pass) -> State {
    InPass { pass, stage: Stage::RunIn }
}

fn locked(pass: Pass) -> State {
    InPass { pass, stage: Stage::Locked }
}

fn run_out(pass: Pass) -> State {
    InPass { pass, stage: Stage::RunOut }
}

fn arm(not_before: u64) -> AxisCommand {
    AxisCommand::Arm {
        pass: 3,
        s_rpm: 600.0,
        direction: 1.0,
        not_before: Cycle(not_before),
        out: WayOut::default(),
        law: law(),
    }
}

fn quiet() -> Event {
    Event {
        cycle: Cycle(90),
        enabled: true,
        fault: None,
        stream_begun: true,
        rests_at_start: true,
        command: None,
        index: None,
        angle_deg: 0.0,
        may_call_off: false,
    }
}

fn index(cycle: u64) -> Option<Index> {
    Some(Index { count: 77, cycle: Cycle(cycle) })
}

fn told(command: AxisCommand) -> Event {
    Event { command: Some(command), ..quiet() }
}

fn seen(cycle: u64) -> Event {
    Event { index: index(cycle), ..quiet() }
}

fn at(angle_deg: f64) -> Event {
    Event { angle_deg, ..quiet() }
}

/// What it shows, the state before, the event, the state after, whether a pass is refused.
type Row = (&'static str, State, Event, State, bool);

#[track_caller]
fn walk(table: &[Row]) {
    for (name, from, event, to, refused) in table {
        assert_eq!(from.next(event), (*to, *refused), "{name}");
    }
}

#[test]
fn from_idle_to_armed() {
    let no_drive = Event { enabled: false, ..quiet() };
    let no_stream = Event { stream_begun: false, ..quiet() };
    let elsewhere = Event { rests_at_start: false, ..told(arm(100)) };
    let last_moment = Event { cycle: Cycle(100), ..told(arm(100)) };
    let too_late = Event { cycle: Cycle(101), ..told(arm(100)) };
    walk(&[
        ("waits for the drive", Idle, no_drive, Idle, false),
        ("waits for the stream", Idle, no_stream, Idle, false),
        ("begins to stream", Idle, quiet(), Streaming, false),
        ("refuses a pass", Idle, Event { enabled: false, ..told(arm(100)) }, Idle, true),
        ("goes on", Streaming, quiet(), Streaming, false),
        ("arms", Streaming, told(arm(100)), armed(pass(0)), false),
        ("the last cycle in time", Streaming, last_moment, armed(pass(0)), false),
        ("too late", Streaming, too_late, Streaming, true),
        ("starts elsewhere", Streaming, elsewhere, Streaming, true),
    ]);
}

#[test]
fn from_armed_to_the_first_angle() {
    let call_off = told(AxisCommand::CallOff);
    let in_time = Event { may_call_off: true, ..call_off };
    walk(&[
        ("no index", armed(pass(0)), quiet(), armed(pass(0)), false),
        ("an index too early does not count", armed(pass(0)), seen(99), armed(pass(0)), false),
        ("the first index that counts", armed(pass(0)), seen(100), waiting_for_c0(pass(77)), false),
        ("armed, called off", armed(pass(0)), call_off, Streaming, false),
        ("armed, a second pass", armed(pass(0)), told(arm(100)), armed(pass(0)), true),
        ("waits for its first angle", waiting_for_c0(pass(77)), at(49.9), waiting_for_c0(pass(77)), false),
        ("waiting, called off in time", waiting_for_c0(pass(77)), in_time, Streaming, false),
        ("waiting, called off too late", waiting_for_c0(pass(77)), call_off, waiting_for_c0(pass(77)), false),
        ("at depth from the first, called off in time", locked(pass(77)), in_time, Streaming, false),
        ("C0", waiting_for_c0(pass(77)), at(50.0), run_in(pass(77)), false),
    ]);
}

#[test]
fn from_the_first_angle_to_the_end() {
    let call_off = told(AxisCommand::CallOff);
    walk(&[
        ("in the run-in", run_in(pass(77)), at(199.0), run_in(pass(77)), false),
        ("too late to call off", run_in(pass(77)), call_off, run_in(pass(77)), false),
        ("locked", run_in(pass(77)), at(200.0), locked(pass(77)), false),
        ("in the thread", locked(pass(77)), at(989.0), locked(pass(77)), false),
        ("the spindle turns back", locked(pass(77)), at(-10.0), locked(pass(77)), false),
        ("run-out", locked(pass(77)), at(990.0), run_out(pass(77)), false),
        ("in the run-out", run_out(pass(77)), at(1199.0), run_out(pass(77)), false),
        ("done", run_out(pass(77)), at(1200.0), Streaming, false),
    ]);
}

#[test]
fn faults_and_stops_end_every_state_and_stay() {
    let states = [
        State::Idle,
        State::Streaming,
        armed(pass(0)),
        waiting_for_c0(pass(77)),
        run_in(pass(77)),
        locked(pass(77)),
        run_out(pass(77)),
    ];
    for state in states {
        let fault = Event { fault: Some(Fault::DriveFault), ..quiet() };
        assert_eq!(state.next(&fault).0, State::Fault(Fault::DriveFault));
        let stop = Event { command: Some(AxisCommand::Stop), ..quiet() };
        assert_eq!(state.next(&stop).0, State::Fault(Fault::Stopped));
    }
    let latched = State::Fault(Fault::ThreadError);
    for event in [
        quiet(),
        Event { fault: Some(Fault::DriveFault), ..quiet() },
        Event { command: Some(AxisCommand::Stop), ..quiet() },
        Event { angle_deg: 1e9, index: index(200), ..quiet() },
    ] {
        assert_eq!(latched.next(&event).0, latched);
    }
}
