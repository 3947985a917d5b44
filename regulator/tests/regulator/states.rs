//! Every state against every event: the transition table of `regulator::state`.

use motion::{Exit, Sample};
use protocol::{AxisCommand, AxisLaw, Changes, Cycle, Fault, Position, WayOut};
use regulator::leave::{Cause, Leaving, Way};
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
        unload_mm: 0.0,
        unload_dc_deg: 0.0,
        lead_mm: 2.0,
        steepest_mm: 0.0,
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
        turned: false,
        out: WayOut::default(),
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
        changes: Changes::default(),
    }
}

fn quiet() -> Event<'static> {
    Event {
        cycle: Cycle(90),
        enabled: true,
        cause: None,
        way: None,
        brake: None,
        rests: false,
        waits: false,
        stream_begun: true,
        rests_at_start: true,
        command: None,
        index: None,
        angle_deg: 0.0,
        may_call_off: false,
        turns_back: false,
    }
}

fn index(cycle: u64) -> Option<Index> {
    Some(Index { count: 77, cycle: Cycle(cycle) })
}

fn told(command: &AxisCommand) -> Event<'_> {
    Event { command: Some(command), ..quiet() }
}

fn seen(cycle: u64) -> Event<'static> {
    Event { index: index(cycle), ..quiet() }
}

fn at(angle_deg: f64) -> Event<'static> {
    Event { angle_deg, ..quiet() }
}

/// What it shows, the state before, the event, the state after, whether a pass is refused.
type Row<'a> = (&'static str, State, Event<'a>, State, bool);

/// The state after an event, and whether a pass was refused.
fn after(mut state: State, event: &Event) -> (State, bool) {
    let refused = state.step(event);
    (state, refused)
}

#[track_caller]
fn walk(table: &[Row]) {
    for (name, from, event, to, refused) in table {
        assert_eq!(after(*from, event), (*to, *refused), "{name}");
    }
}

#[test]
fn from_idle_to_armed() {
    let arm = arm(100);
    let no_drive = Event { enabled: false, ..quiet() };
    let no_stream = Event { stream_begun: false, ..quiet() };
    let elsewhere = Event { rests_at_start: false, ..told(&arm) };
    let last_moment = Event { cycle: Cycle(100), ..told(&arm) };
    let too_late = Event { cycle: Cycle(101), ..told(&arm) };
    walk(&[
        ("waits for the drive", Idle, no_drive, Idle, false),
        ("waits for the stream", Idle, no_stream, Idle, false),
        ("begins to stream", Idle, quiet(), Streaming, false),
        ("refuses a pass", Idle, Event { enabled: false, ..told(&arm) }, Idle, true),
        ("goes on", Streaming, quiet(), Streaming, false),
        ("arms", Streaming, told(&arm), armed(pass(0)), false),
        ("the last cycle in time", Streaming, last_moment, armed(pass(0)), false),
        ("too late", Streaming, too_late, Streaming, true),
        ("starts elsewhere", Streaming, elsewhere, Streaming, true),
    ]);
}

#[test]
fn from_armed_to_the_first_angle() {
    let arm = arm(100);
    let call_off = told(&AxisCommand::CallOff);
    let in_time = Event { may_call_off: true, ..call_off };
    walk(&[
        ("no index", armed(pass(0)), quiet(), armed(pass(0)), false),
        ("an index too early does not count", armed(pass(0)), seen(99), armed(pass(0)), false),
        ("the first index that counts", armed(pass(0)), seen(100), waiting_for_c0(pass(77)), false),
        ("armed, called off", armed(pass(0)), call_off, Streaming, false),
        ("armed, a second pass", armed(pass(0)), told(&arm), armed(pass(0)), true),
        ("waits for its first angle", waiting_for_c0(pass(77)), at(49.9), waiting_for_c0(pass(77)), false),
        ("waiting, called off in time", waiting_for_c0(pass(77)), in_time, Streaming, false),
        ("waiting, called off too late", waiting_for_c0(pass(77)), call_off, waiting_for_c0(pass(77)), false),
        ("at depth from the first, called off in time", locked(pass(77)), in_time, Streaming, false),
        ("C0", waiting_for_c0(pass(77)), at(50.0), run_in(pass(77)), false),
    ]);
}

#[test]
fn from_the_first_angle_to_the_end() {
    let call_off = told(&AxisCommand::CallOff);
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

fn leaving(way: Way, fault: Option<Fault>) -> State {
    State::Leaving(Leaving { pass: Some(pass(77)), way, fault })
}

fn because(cause: Cause) -> Event<'static> {
    Event { cause: Some(cause), ..quiet() }
}

fn timed() -> Way {
    Way::Timed { exit: Exit::stop_in(&Sample::default(), 0.1), from: Cycle(90) }
}

#[test]
fn what_leads_an_axis_no_more_ends_every_state() {
    let states = [
        Idle,
        Streaming,
        armed(pass(0)),
        waiting_for_c0(pass(77)),
        run_in(pass(77)),
        locked(pass(77)),
        run_out(pass(77)),
        leaving(timed(), None),
    ];
    for state in states {
        let lost = because(Cause::Lost(Fault::DriveFault));
        assert_eq!(after(state, &lost).0, State::Fault(Fault::DriveFault));
    }
    let first = leaving(timed(), Some(Fault::ThreadError));
    let lost = because(Cause::Lost(Fault::DriveFault));
    assert_eq!(after(first, &lost).0, State::Fault(Fault::ThreadError), "what came first is the fault");
    let latched = State::Fault(Fault::ThreadError);
    for event in [
        quiet(),
        lost,
        because(Cause::Leave(Some(Fault::EncoderGlitch))),
        told(&AxisCommand::Stop),
        Event { angle_deg: 1e9, index: index(200), ..quiet() },
    ] {
        assert_eq!(after(latched, &event).0, latched);
    }
}

#[test]
fn a_cause_to_leave_in_every_state() {
    let (glitch, operator) = (Cause::Leave(Some(Fault::EncoderGlitch)), Cause::Leave(None));
    let fault = Some(Fault::EncoderGlitch);
    let dry = State::Leaving(Leaving { pass: None, way: Way::Dry, fault });
    let stopped = State::Leaving(Leaving { pass: None, way: Way::Dry, fault: Some(Fault::Stopped) });
    walk(&[
        ("idle", Idle, because(glitch), State::Fault(Fault::EncoderGlitch), false),
        ("in timed motion", Streaming, because(glitch), dry, false),
        ("told to stop", Streaming, told(&AxisCommand::Stop), stopped, false),
        ("armed", armed(pass(0)), because(glitch), State::Fault(Fault::EncoderGlitch), false),
        ("the operator holds timed motion", Streaming, because(operator), Streaming, false),
        ("told to leave what has not begun", armed(pass(0)), because(operator), Streaming, false),
    ]);
    for stage in [Stage::WaitingForC0, Stage::RunIn, Stage::Locked, Stage::RunOut] {
        let from = InPass { pass: pass(77), stage };
        let [lifts, follows] = [timed(), Way::Along(stage)].map(Some);
        let event = |cause, way| Event { way, angle_deg: 0.0, ..because(cause) };
        walk(&[
            ("lifts", from, event(glitch, lifts), leaving(timed(), fault), false),
            ("follows the helix", from, event(operator, follows), leaving(Way::Along(stage), None), false),
        ]);
    }
}

#[test]
fn from_leaving_to_rest() {
    let arm = arm(100);
    let along = |stage, fault| leaving(Way::Along(stage), fault);
    let (fault, free) = (Some(Fault::OtherAxis), Event { brake: Some(timed()), ..quiet() });
    let over = Event { rests: true, ..quiet() };
    walk(&[
        ("on the helix", along(Stage::Locked, None), at(500.0), along(Stage::Locked, None), false),
        ("the end comes first", along(Stage::Locked, None), at(991.0), along(Stage::RunOut, None), false),
        ("at the end of the pass", along(Stage::RunOut, None), at(1200.0), Streaming, false),
        (
            "the same with a fault",
            along(Stage::RunOut, fault),
            at(1200.0),
            State::Fault(Fault::OtherAxis),
            false,
        ),
        (
            "at the end, the tool still in its groove",
            along(Stage::RunOut, fault),
            Event { waits: true, ..at(1200.0) },
            along(Stage::RunOut, fault),
            false,
        ),
        (
            "at rest, the tool still in its groove",
            leaving(timed(), fault),
            Event { waits: true, ..over },
            leaving(timed(), fault),
            false,
        ),
        ("the tool is free", along(Stage::Locked, fault), free, leaving(timed(), fault), false),
        ("on its way", leaving(timed(), None), quiet(), leaving(timed(), None), false),
        ("at rest", leaving(timed(), None), over, Streaming, false),
        ("at rest with a fault", leaving(timed(), fault), over, State::Fault(Fault::OtherAxis), false),
        ("refuses a pass", leaving(timed(), None), told(&arm), leaving(timed(), None), true),
        (
            "is not called off",
            leaving(timed(), None),
            told(&AxisCommand::CallOff),
            leaving(timed(), None),
            false,
        ),
    ]);
    let late = because(Cause::Leave(Some(Fault::EmergencyStop)));
    assert_eq!(after(along(Stage::Locked, None), &late).0, along(Stage::Locked, Some(Fault::EmergencyStop)));
}
