//! What the printers print, call by call.

use gcode::canon::{Arc, FeedMode, LinuxcncPrinter, PathMode, PlainPrinter, Plane, Turn, Units};
use gcode::files::Tool;
use gcode::{Call, Place, Sink};

fn linuxcnc(calls: &[(Place, Call<'_>)]) -> String {
    let mut text = Vec::new();
    let mut printer = LinuxcncPrinter::new(&mut text);
    for (place, call) in calls {
        printer.call(*place, *call).expect("a buffer takes everything");
    }
    printer.flush().expect("a buffer takes everything");
    drop(printer);
    String::from_utf8(text).expect("a buffer takes everything")
}

fn plain(calls: &[Call<'_>]) -> String {
    let mut text = Vec::new();
    let mut printer = PlainPrinter::new(&mut text, Units::Millimetre);
    for call in calls {
        printer.call(Place::default(), *call).expect("a buffer takes everything");
    }
    printer.flush().expect("a buffer takes everything");
    drop(printer);
    String::from_utf8(text).expect("a buffer takes everything")
}

/// The line of one call, without its number and N.
fn line(call: Call<'_>) -> String {
    let text = linuxcnc(&[(Place::default(), call)]);
    text.strip_prefix("    1 N..... ").unwrap_or(&text).trim_end_matches('\n').to_owned()
}

#[test]
fn lines_are_numbered_and_carry_n_as_it_was_written() {
    let place = |n, n_digits| Place { n, n_digits, ..Place::default() };
    let places = [
        place(None, 0),
        place(Some(10), 4),
        place(Some(20), 2),
        place(Some(30), 0),
        place(Some(1_234_567), 7),
    ];
    let calls = places.map(|place| (place, Call::MistOn));
    assert_eq!(
        linuxcnc(&calls),
        "    1 N..... MIST_ON()\n    2 N0010  MIST_ON()\n    3 N20    MIST_ON()\n    4 N      MIST_ON()\n    5 N1234567MIST_ON()\n"
    );
}

#[test]
fn the_number_of_a_line_grows_beyond_its_five_columns() {
    let text = linuxcnc(&vec![(Place::default(), Call::Finish); 100_010]);
    for (n, line) in text.lines().enumerate() {
        assert_eq!(line, format!("{:5} N..... FINISH()", n + 1));
    }
}

#[test]
fn a_print_is_its_text_alone_and_takes_no_number() {
    let calls = [Call::MistOn, Call::Print("to the log 12.5"), Call::MistOff];
    let calls = calls.map(|call| (Place::default(), call));
    assert_eq!(linuxcnc(&calls), "    1 N..... MIST_ON()\nto the log 12.5\n    2 N..... MIST_OFF()\n");
}

#[test]
fn every_call_has_the_arguments_of_rs274() {
    let at = [1.0, -2.5, 0.0, 0.0, 0.0, -0.0];
    let arc = Arc { end: [2.0, 0.0], center: [1.0, 0.0], turns: -1, along: 5.0, rotary: [0.0; 3] };
    let tool = Tool {
        index: 12,
        number: 112,
        offset: [-8.5, 0.0, -30.0, 0.0, 0.0, 0.0],
        front_angle: 93.0,
        back_angle: 148.0,
        orientation: 2,
        ..Tool::default()
    };
    for (call, text) in [
        (Call::UseLengthUnits(Units::Inch), "USE_LENGTH_UNITS(CANON_UNITS_INCHES)"),
        (
            Call::SetG5xOffset(9, [0.0; 6]),
            "SET_G5X_OFFSET(9, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000)",
        ),
        (Call::StraightFeed(at), "STRAIGHT_FEED(1.0000, -2.5000, 0.0000, 0.0000, 0.0000, -0.0000)"),
        (Call::ArcFeed(arc), "ARC_FEED(2.0000, 0.0000, 1.0000, 0.0000, -1, 5.0000, 0.0000, 0.0000, 0.0000)"),
        (Call::RigidTap(at, 1.0, 0.0), "RIGID_TAP(1.0000, -2.5000, 0.0000)"),
        (Call::SelectPlane(Plane::Xz), "SELECT_PLANE(CANON_PLANE_XZ)"),
        (Call::SetFeedMode(FeedMode::PerRevolution), "SET_FEED_MODE(0, 1)"),
        (Call::SetSpindleMode(f64::INFINITY), "SET_SPINDLE_MODE(0 1000000000000000019884624838656.0000)"),
        (Call::SetSpindleSpeed(500.0), "SET_SPINDLE_SPEED(0, 500.0000)"),
        (Call::StartSpindle(Turn::Counterclockwise), "START_SPINDLE_COUNTERCLOCKWISE(0)"),
        (Call::OrientSpindle(45.0, 2), "ORIENT_SPINDLE(0, 45.0000, 2)"),
        (Call::WaitSpindleOrient(5.0), "SPINDLE.0.WAIT_ORIENT_COMPLETE(5.0000)"),
        (
            Call::StartSpeedFeedSynch { lead: 1.25, velocity: false, start_deg: 0.0, growth: 0.0 },
            "START_SPEED_FEED_SYNC(1.250000,0)",
        ),
        (
            Call::SetMotionControlMode(PathMode::Continuous(0.02)),
            "SET_MOTION_CONTROL_MODE(CANON_CONTINUOUS, 0.020000)",
        ),
        (Call::SetNaivecamTolerance { tolerance: 0.02, programmed: false }, "SET_NAIVECAM_TOLERANCE(0.0200)"),
        (Call::ChangeTool(3), "CHANGE_TOOL()"),
        (Call::ChangeToolNumber(3), "CHANGE_TOOL_NUMBER(3)"),
        (
            Call::UseToolLengthOffset(at),
            "USE_TOOL_LENGTH_OFFSET(1.0000 -2.5000 0.0000, 0.0000 0.0000 -0.0000, 0.0000 0.0000 0.0000)",
        ),
        (
            Call::SetToolTableEntry(&tool),
            "SET_TOOL_TABLE_ENTRY(12, 112, -8.5000 0.0000 -30.0000 0.0000 0.0000 0.0000 0.0000 0.0000 0.0000, 93.0000, 148.0000, 2)",
        ),
        (Call::EnableSpeedOverride(false), "DISABLE_SPEED_OVERRIDE(0)"),
        (Call::SetMotionOutputBit(3, false), "CLEAR_MOTION_OUTPUT_BIT(3)"),
        (Call::SetAuxOutputValue(1, 0.5), "SET_AUX_OUTPUT_VALUE(1,0.500000)"),
        (
            Call::Note("feed mode set to inverse time"),
            "COMMENT(\"interpreter: feed mode set to inverse time\")",
        ),
        (Call::Message(" lower the tailstock "), "MESSAGE(\" lower the tailstock \")"),
        (Call::Log("LOGOPEN", "a.txt"), "LOGOPEN(\"a.txt\")"),
        (Call::Log("LOGCLOSE", ""), "LOGCLOSE()"),
        (Call::SetFeedMode(FeedMode::InverseTime), "SET_FEED_MODE(0, 0)"),
        (Call::WaitInput { index: 0, analog: false, wait: 1, timeout: 1.0 }, ""),
    ] {
        assert_eq!(line(call), text);
    }
}

#[test]
fn plain_calls_are_in_millimetres_and_say_only_what_changes() {
    let text = plain(&[
        Call::UseLengthUnits(Units::Millimetre),
        Call::SetG5xOffset(1, [0.0; 6]),
        Call::SetFeedReference,
        Call::OnReset,
        Call::UseLengthUnits(Units::Inch),
        Call::Note("feed mode set to units per minute"),
        Call::SetG5xOffset(2, [1.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
        Call::SetG5xOffset(2, [1.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
        Call::SetFeedRate(10.0),
        Call::StraightFeed([1.0, 0.0, 0.5, 0.0, 0.0, 0.0]),
        Call::StraightFeed([1.0, 0.0, 0.5, 90.0, 0.0, 0.0]),
        Call::StraightTraverse([0.0; 6]),
        Call::StartSpeedFeedSynch { lead: 0.1, velocity: false, start_deg: 0.0, growth: 0.0 },
    ]);
    assert_eq!(
        text,
        "USE_LENGTH_UNITS(CANON_UNITS_MM)\nSET_G5X_OFFSET(2, 25.4000, 0.0000, 0.0000)\nSET_FEED_RATE(254.0000)\n\
         STRAIGHT_FEED(25.4000, 0.0000, 12.7000)\nSTRAIGHT_FEED(25.4000, 0.0000, 12.7000, 90.0000, 0.0000, 0.0000)\n\
         STRAIGHT_TRAVERSE(0.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000)\nSTART_SPEED_FEED_SYNCH(0, 2.5400, 0)\n"
    );
}

/// A file on a disk that is full.
struct Full;

impl std::io::Write for Full {
    fn write(&mut self, _: &[u8]) -> std::io::Result<usize> {
        Err(std::io::ErrorKind::StorageFull.into())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

#[test]
fn a_full_disk_ends_the_program_and_is_told_at_the_end_too() {
    let mut printer = LinuxcncPrinter::new(Full);
    let error = (0..10_000)
        .find_map(|_| printer.call(Place::default(), Call::MistOn).err())
        .expect("a buffer takes everything");
    assert_eq!(error.code, "output");
    assert_eq!(printer.flush().unwrap_err().kind(), std::io::ErrorKind::StorageFull);
}
