//! Packets: what is packed can be unpacked, and what no sender sends is refused.
#![allow(clippy::unwrap_used)]

use proptest::prelude::*;
use protocol::*;
use zerocopy::{FromBytes, IntoBytes};

fn law() -> AxisLaw {
    AxisLaw {
        stroke_mm: -3.0,
        stroke_c0_deg: 30.0,
        stroke_dc_deg: 300.0,
        lead_mm: -2.0,
        run_in_c0_deg: 60.0,
        run_in_dc_deg: 270.0,
        run_in_lambda: 0.25,
        brake_c_deg: 7200.0,
        brake_dc_deg: 270.0,
        brake_lambda: 0.5,
        retract_mm: 3.0,
        retract_c_deg: 7200.0,
        retract_dc_deg: 200.0,
        ..AxisLaw::default()
    }
}

fn pass() -> ThreadPass {
    let mut pass =
        ThreadPass { pass: 3, s_rpm: 600.0, direction: -1.0, max_ratio: 1.2, ..ThreadPass::default() };
    pass.axes[0] = law();
    pass
}

/// An eighth of a circle of 10 mm about X 5, Z −20 that ends level with its centre.
fn arc() -> Arc {
    let mut target = [Position(0); 8];
    (target[0], target[2]) = (Position::from_mm(5.0), Position::from_mm(-10.0));
    let center = [Position::from_mm(-20.0), Position::from_mm(5.0)];
    Arc { plane: Plane::Zx, target, center, turns: -1 }
}

fn arm(law: AxisLaw) -> AxisCommand {
    AxisCommand::Arm {
        pass: 3,
        s_rpm: 600.0,
        direction: 1.0,
        not_before: Cycle(77),
        out: WayOut::default(),
        law,
        changes: Changes::default(),
    }
}

fn setpoint() -> Setpoint {
    Setpoint { cycle: Cycle(12), position: Position(-5), velocity_mm_s: 1.0, acceleration_mm_s2: 2.0 }
}

#[test]
fn every_code_travels() {
    let target = std::array::from_fn(|axis| Position(axis as i64 - 4));
    let mut codes =
        vec![Code::Dwell { seconds: 0.5 }, Code::Tool { number: 7 }, Code::Pass(pass()), Code::End];
    for feed in [Feed::Rapid, Feed::PerMinute(100.0), Feed::PerRevolution(0.1)] {
        codes.push(Code::Line { target, feed });
    }
    for (feed, turns) in [(Feed::PerMinute(100.0), 1), (Feed::PerRevolution(0.1), -3)] {
        for plane in Plane::ALL {
            codes.push(Code::Arc { arc: Arc { plane, turns, ..arc() }, feed });
        }
    }
    codes.push(Code::Curve { curve: curve(), feed: Feed::PerMinute(100.0) });
    let blend = PathMode::Blend { tolerance_mm: 0.02, merge_mm: 0.01 };
    codes.extend([PathMode::ExactStop, PathMode::ExactPath, blend].map(Code::PathMode));
    for (mist, flood) in [(false, false), (true, false), (false, true), (true, true)] {
        codes.push(Code::Coolant { mist, flood });
    }
    for (set, in_step) in [(Set::Digital(true), false), (Set::Digital(false), true)] {
        codes.push(Code::Output { number: 63, set, in_step });
    }
    codes.push(Code::Output { number: 3, set: Set::Analog(-2.5), in_step: true });
    for until in [Until::Rise, Until::Fall, Until::High, Until::Low] {
        codes.push(Code::Await { input: 63, until, within_s: 0.5 });
    }
    codes.extend([Code::Pause, Code::OptionalPause]);
    let variation = Variation { shape: VariationShape::Triangle, share: 0.3, revolutions: 4.0 };
    codes.extend([Some(variation), None].map(Code::Variation));
    for mode in [SpindleMode::Stop, SpindleMode::Clockwise, SpindleMode::Counterclockwise] {
        let surface = SpindleSpeed::Surface { mm_s: 2500.0, max_rpm: 1800.0, axis_mm: Position(-7) };
        codes.extend([SpindleSpeed::Rpm(600.0), surface].map(|speed| Code::Spindle { mode, speed }));
    }
    for (sequence, code) in codes.into_iter().enumerate() {
        let (item, sequence) = (Item { line: 5, code }, sequence as u64);
        assert_eq!(CodePacket::pack(sequence, &item).unpack(sequence), Ok(item));
    }
}

#[test]
fn machine_code_out_of_order_is_refused() {
    let packet = CodePacket::pack(8, &Item { line: 1, code: Code::End });
    assert_eq!(packet.unpack(7), Err(Refused::OutOfOrder { what: "machine code", expected: 7, received: 8 }));
}

#[test]
fn machine_code_that_no_interpreter_sends_is_refused() {
    let unpack = |code| CodePacket::pack(0, &Item { line: 1, code }).unpack(0).unwrap_err();
    let line = |feed| Code::Line { target: Default::default(), feed };
    assert_eq!(unpack(line(Feed::PerMinute(0.0))), Refused::OutOfRange("feed"));
    assert_eq!(unpack(line(Feed::PerRevolution(-1.0))), Refused::OutOfRange("feed"));
    assert_eq!(unpack(Code::Dwell { seconds: f64::INFINITY }), Refused::NotFinite("dwell"));
    let spindle = |speed| Code::Spindle { mode: SpindleMode::Clockwise, speed };
    let surface = |mm_s, max_rpm| SpindleSpeed::Surface { mm_s, max_rpm, axis_mm: Position(0) };
    assert_eq!(unpack(spindle(SpindleSpeed::Rpm(-1.0))), Refused::OutOfRange("spindle speed"));
    assert_eq!(unpack(spindle(surface(-1.0, 100.0))), Refused::OutOfRange("surface speed"));
    assert_eq!(unpack(spindle(surface(1.0, 0.0))), Refused::OutOfRange("highest spindle speed"));
    assert_eq!(unpack(spindle(surface(1.0, f64::INFINITY))), Refused::NotFinite("highest spindle speed"));
    let blend = |tolerance_mm, merge_mm| Code::PathMode(PathMode::Blend { tolerance_mm, merge_mm });
    assert_eq!(unpack(blend(-1e-9, 0.0)), Refused::OutOfRange("tolerance of the path"));
    assert_eq!(unpack(blend(10.1, 0.0)), Refused::OutOfRange("tolerance of the path"));
    assert_eq!(unpack(blend(f64::NAN, 0.0)), Refused::NotFinite("tolerance of the path"));
    assert_eq!(unpack(blend(0.0, 10.1)), Refused::OutOfRange("tolerance of merging"));
    let varied = |share, revolutions| {
        Code::Variation(Some(Variation { shape: VariationShape::Sine, share, revolutions }))
    };
    for share in [0.0, -0.1, 0.51, f64::NAN] {
        assert_eq!(unpack(varied(share, 4.0)), Refused::OutOfRange("share of a speed variation"));
    }
    for revolutions in [0.24, 1001.0, f64::NAN] {
        assert_eq!(unpack(varied(0.3, revolutions)), Refused::OutOfRange("period of a speed variation"));
    }
    assert_eq!(unpack(Code::Pass(ThreadPass::default())), Refused::OutOfRange("S"));
}

#[test]
fn arcs_that_no_interpreter_sends_are_refused() {
    let unpack = |change: fn(&mut Arc), feed| {
        let mut arc = arc();
        change(&mut arc);
        CodePacket::pack(0, &Item { line: 1, code: Code::Arc { arc, feed } }).unpack(0).unwrap_err()
    };
    let feed = Feed::PerMinute(100.0);
    assert_eq!(unpack(|_| (), Feed::Rapid), Refused::OutOfRange("feed of an arc"));
    assert_eq!(unpack(|_| (), Feed::PerRevolution(f64::NAN)), Refused::NotFinite("feed"));
    assert_eq!(unpack(|arc| arc.turns = 0, feed), Refused::OutOfRange("turns of an arc"));
    assert_eq!(unpack(|arc| arc.turns = i32::MIN, feed), Refused::OutOfRange("turns of an arc"));
    let at_center = |arc: &mut Arc| (arc.target[2], arc.target[0]) = (arc.center[0], arc.center[1]);
    assert_eq!(unpack(at_center, feed), Refused::OutOfRange("radius of an arc"));
    let far = |arc: &mut Arc| arc.center = [Position(i64::MAX); 2];
    assert_eq!(unpack(far, feed), Refused::OutOfRange("radius of an arc"));
}

/// A tenth of a millimetre along X.
fn curve() -> Curve {
    let (mut target, straight) = (PerAxis::default(), [[1.0, 0.0, 0.0], [0.0; 3], [0.0; 3]]);
    target[0] = Position::from_mm(0.1);
    Curve { target, way: [0.1, 0.0, 0.0], start: straight, end: straight, length_mm: 0.1 }
}

#[test]
fn curves_that_no_interpreter_sends_are_refused() {
    let unpack = |change: fn(&mut Curve), feed| {
        let mut curve = curve();
        change(&mut curve);
        CodePacket::pack(0, &Item { line: 1, code: Code::Curve { curve, feed } }).unpack(0).unwrap_err()
    };
    let feed = Feed::PerMinute(100.0);
    assert_eq!(unpack(|_| (), Feed::Rapid), Refused::OutOfRange("feed of a curve"));
    assert_eq!(unpack(|_| (), Feed::PerMinute(-1.0)), Refused::OutOfRange("feed"));
    assert_eq!(unpack(|curve| curve.length_mm = 0.0, feed), Refused::OutOfRange("length of a curve"));
    assert_eq!(unpack(|curve| curve.way[1] = f64::NAN, feed), Refused::NotFinite("derivative of a curve"));
    assert_eq!(
        unpack(|curve| curve.end[2][0] = f64::INFINITY, feed),
        Refused::NotFinite("derivative of a curve")
    );
    assert_eq!(unpack(|curve| curve.start[0][1] = 0.1, feed), Refused::OutOfRange("direction of a curve"));
}

#[test]
fn a_curve_leads_from_where_it_begins_to_its_target_and_nowhere_else() {
    let from = PerAxis::default();
    let path = curve().path(&from).expect("a path");
    assert!((path.at(0.05)[0][0] - 0.05).abs() < 1e-15 && path.length() == 0.1);
    let mut elsewhere = from;
    elsewhere[0] = Position(-9_000_000);
    let path = curve().path(&elsewhere).expect("a path from beside its start");
    assert!((path.at(0.1)[0][0] - 0.109).abs() < 1e-12, "to its target");
    elsewhere[0] = Position(-10_001_000);
    assert_eq!(curve().path(&elsewhere).unwrap_err(), Refused::OutOfRange("way of a curve"));
    (elsewhere[0], elsewhere[3]) = (Position(0), Position(10_001_000));
    assert_eq!(curve().path(&elsewhere).unwrap_err(), Refused::OutOfRange("way of a curve"), "C stands");
}

#[test]
fn every_axis_command_travels() {
    for command in
        [AxisCommand::Stream, AxisCommand::Hold, arm(law()), AxisCommand::CallOff, AxisCommand::Stop]
    {
        let frame = AxisFrame::pack(Cycle(9), 4, setpoint(), 0.5, &command);
        assert_eq!((frame.cycle, frame.line, frame.setpoint), (Cycle(9), 4, setpoint()));
        assert_eq!(frame.unpack(), Ok(command));
    }
}

#[test]
fn axis_commands_that_no_interpolator_sends_are_refused() {
    let frame = AxisFrame::pack(Cycle(9), 4, setpoint(), 0.5, &arm(law()));
    assert_eq!(
        AxisFrame { command: 99, ..frame }.sealed().unpack(),
        Err(Refused::UnknownCode { field: "axis command", code: 99 })
    );
    for s_rpm in [0.0, 1e-305, 1e308] {
        assert_eq!(AxisFrame { s_rpm, ..frame }.sealed().unpack(), Err(Refused::OutOfRange("S")));
    }
    assert_eq!(AxisFrame { s_rpm: f64::NAN, ..frame }.sealed().unpack(), Err(Refused::NotFinite("S")));
    assert_eq!(
        AxisFrame { direction: 0.5, ..frame }.sealed().unpack(),
        Err(Refused::OutOfRange("spindle direction"))
    );
    let broken = Setpoint { velocity_mm_s: f64::NAN, ..setpoint() };
    assert_eq!(
        AxisFrame { setpoint: broken, ..frame }.sealed().unpack(),
        Err(Refused::NotFinite("setpoint velocity"))
    );
    let broken = Setpoint { acceleration_mm_s2: f64::INFINITY, ..setpoint() };
    let expected = Err(Refused::NotFinite("setpoint acceleration"));
    assert_eq!(AxisFrame { setpoint: broken, ..frame }.sealed().unpack(), expected);
}

#[test]
fn one_bit_that_is_turned_over_is_found_wherever_it_is() {
    let frame = AxisFrame::pack(Cycle(9), 4, setpoint(), 0.5, &arm(law()));
    for bit in 0..8 * size_of::<AxisFrame>() {
        let mut bytes = frame.as_bytes().to_vec();
        bytes[bit / 8] ^= 1 << (bit % 8);
        let damaged = AxisFrame::read_from_bytes(&bytes).unwrap();
        assert_eq!(damaged.unpack(), Err(Refused::Unreadable("an axis frame")), "bit {bit}");
    }
}

#[test]
fn laws_that_cannot_be_evaluated_are_refused() {
    law().check().unwrap();
    AxisLaw::default().check().unwrap();
    let mut wrong: Vec<(AxisLaw, Refused)> = Vec::new();
    let mut case = |change: fn(&mut AxisLaw), refused| {
        let mut law = law();
        change(&mut law);
        wrong.push((law, refused));
    };
    case(|law| law.stroke_mm = f64::NAN, Refused::NotFinite("stroke"));
    case(|law| law.lead_mm = 2e5, Refused::OutOfRange("lead"));
    case(|law| law.retract_mm = f64::INFINITY, Refused::NotFinite("retract stroke"));
    case(|law| law.stroke_c0_deg = -1.0, Refused::OutOfRange("approach angle"));
    case(|law| law.stroke_dc_deg = 0.0, Refused::OutOfRange("approach angle"));
    let unloading = Refused::OutOfRange("unloading");
    case(|law| (law.unload_mm, law.unload_dc_deg) = (0.01, 0.0), unloading);
    case(|law| (law.unload_mm, law.unload_dc_deg) = (0.01, law.stroke_dc_deg), unloading);
    case(|law| (law.unload_mm, law.unload_dc_deg) = (-0.01 * law.stroke_mm, 10.0), unloading);
    case(|law| law.run_in_dc_deg = 1e10, Refused::OutOfRange("run-in angle"));
    case(|law| law.brake_dc_deg = f64::NAN, Refused::NotFinite("braking angle"));
    case(|law| law.retract_dc_deg = -5.0, Refused::OutOfRange("retract angle"));
    case(|law| law.run_in_lambda = 0.0, Refused::OutOfRange("run-in lambda"));
    case(|law| law.run_in_lambda = 1e-320, Refused::OutOfRange("run-in lambda"));
    case(|law| law.brake_lambda = 0.6, Refused::OutOfRange("braking lambda"));
    case(|law| law.brake_c_deg = 100.0, Refused::OutOfRange("braking angle"));
    for (law, refused) in wrong {
        assert_eq!(law.check(), Err(refused));
    }
}

#[test]
fn passes_that_cannot_be_cut_are_refused() {
    pass().check().unwrap();
    let check = |change: fn(&mut ThreadPass)| {
        let mut pass = pass();
        change(&mut pass);
        pass.check().unwrap_err()
    };
    assert_eq!(check(|pass| pass.s_rpm = 1e6), Refused::OutOfRange("S"));
    assert_eq!(check(|pass| pass.direction = 0.0), Refused::OutOfRange("spindle direction"));
    assert_eq!(check(|pass| pass.start_angle_deg = f64::NAN), Refused::NotFinite("start angle"));
    assert_eq!(check(|pass| pass.max_ratio = 0.99), Refused::OutOfRange("highest ratio"));
    assert_eq!(check(|pass| pass.axes[7].lead_mm = f64::NAN), Refused::NotFinite("lead"));
}

#[test]
fn the_operator_is_understood_or_refused() {
    let requests = [
        Request::SpindleOverride(60.0),
        Request::FeedOverride(0.0),
        Request::RapidOverride(25.0),
        Request::FeedHold,
        Request::Stop,
        Request::CycleStart,
        Request::SingleBlock(true),
        Request::SingleBlock(false),
        Request::OptionalStop(false),
        Request::OptionalStop(true),
        Request::Abort,
    ];
    for request in requests {
        assert_eq!(OperatorRequest::pack(1, request).unpack(), Ok(request));
    }
    let mut panel = Panel::default();
    panel.press(Panel::FEED_HOLD, true);
    panel.press(Panel::STOP, true);
    panel.start_cycle();
    assert_eq!(panel, Panel { buttons: Panel::STOP, cycle_starts: 1, ..Panel::default() });
    panel.press(Panel::STOP, false);
    assert_eq!(panel.buttons, 0);
    let refused = |request| OperatorRequest::pack(1, request).unpack().unwrap_err();
    assert_eq!(refused(Request::RapidOverride(101.0)), Refused::OutOfRange("override"));
    assert_eq!(refused(Request::SpindleOverride(f64::NAN)), Refused::NotFinite("override"));
    let unknown = OperatorRequest::default().unpack();
    assert_eq!(unknown, Err(Refused::UnknownCode { field: "operator request", code: 0 }));
}

#[test]
fn a_status_word_says_its_state_and_the_way_on() {
    use DriveState::*;
    let way = [
        (NotReady, Some(ControlWord::DisableVoltage)),
        (SwitchOnDisabled, Some(ControlWord::Shutdown)),
        (ReadyToSwitchOn, Some(ControlWord::SwitchOn)),
        (SwitchedOn, Some(ControlWord::Enable)),
        (OperationEnabled, Some(ControlWord::Enable)),
        (QuickStopActive, Some(ControlWord::Enable)),
        (FaultReaction, None),
        (Fault, None),
    ];
    for (state, control_word) in way {
        let word = StatusWord::of(state);
        // Manufacturer and remote bits do not matter.
        for noise in [0, 0xFF00, 0x0080] {
            assert_eq!(StatusWord(word.0 | noise).state(), Some(state));
        }
        assert_eq!(word.towards_operation(), control_word);
    }
    assert_eq!(StatusWord(0x01).state(), None);
}

#[test]
fn codes_of_states_and_faults_are_stable() {
    for (code, state) in AxisState::ALL.into_iter().enumerate() {
        assert_eq!((state as usize, AxisState::from_code(code as u32)), (code, Ok(state)));
    }
    assert_eq!(AxisState::from_code(9), Err(Refused::UnknownCode { field: "axis state", code: 9 }));
    for (number, fault) in protocol::Fault::ALL.into_iter().enumerate() {
        assert_eq!((fault as usize, protocol::Fault::from_code(fault as u32)), (number + 1, Some(fault)));
    }
    assert_eq!(protocol::Fault::from_code(0), None);
    assert_eq!(protocol::Fault::from_code(u32::MAX), None);
    for code in 0..10 {
        assert_eq!(MachineState::from_code(code).map(|state| state as u32), Ok(code));
    }
    assert_eq!(MachineState::from_code(10), Err(Refused::UnknownCode { field: "machine state", code: 10 }));
}

proptest! {
    #[test]
    fn any_bytes_are_some_packet_and_never_a_panic(
        frame in prop::collection::vec(any::<u8>(), size_of::<AxisFrame>()),
        number in 0u32..5,
    ) {
        let frame = AxisFrame::read_from_bytes(&frame).unwrap();
        if let Ok(AxisCommand::Arm { law, .. }) = (AxisFrame { command: number, ..frame }).sealed().unpack() {
            prop_assert!(law.check().is_ok());
        }
    }
}
