//! Whole programs: order of calls, refusals and their lines.

use super::run;

/// The calls after the prologue of a program that must not fail.
fn calls(text: &str) -> Vec<String> {
    let (record, problem) = run(text);
    if let Some(problem) = problem {
        panic!("{}", problem.render(false));
    }
    record.calls
}

/// Line and code of the first error.
fn refused(text: &str) -> (u32, &'static str) {
    let (_, problem) = run(text);
    let problem = problem.unwrap_or_else(|| panic!("this should be refused:\n{text}"));
    (problem.line, problem.code)
}

fn place_of(calls: &[String], start: &str) -> usize {
    let found = calls.iter().position(|call| call.starts_with(start));
    found.unwrap_or_else(|| panic!("no {start} in {calls:#?}"))
}

#[test]
fn what_is_called_behind_a_waiting_move_stays_behind_it() {
    let calls = calls("F100\nG41.1 D2\nG1 X10\nM3 S500 M8\n(comment)\nF200\nG4 P1\nY10\nG40 X0\nM2\n");
    let corner = place_of(&calls, "StraightFeed([9.0, 1.0");
    for (distance, start) in
        ["SetSpindleSpeed", "StartSpindle", "FloodOn", "Comment", "SetFeedRate(200", "Dwell"]
            .iter()
            .enumerate()
    {
        assert!(calls[corner + 1 + distance].starts_with(start), "{start} {calls:#?}");
    }
}

#[test]
fn messages_do_not_wait() {
    let calls = calls("F100\nG41.1 D2\nG1 X10\n(MSG,hello)\nY10\nG40 X0\nM2\n");
    assert!(place_of(&calls, "Message") < place_of(&calls, "StraightFeed"));
}

#[test]
fn moves_across_the_plane_follow_the_corner() {
    let calls = calls("F100\nG41.1 D2\nG1 X10\nG0 Z5\nZ-1\nG1 Y10\nG40 X0\nM2\n");
    let corner = place_of(&calls, "StraightFeed([9.0, 1.0");
    for (call, height) in [(1, ", 5.0, 0.0"), (2, ", -1.0, 0.0")] {
        let call = &calls[corner + call];
        assert!(call.starts_with("StraightTraverse([9.0, 1.0") && call.contains(height), "{calls:#?}");
    }
    assert!(calls[corner + 3].starts_with("StraightFeed([9.0, 10.0, -1.0"), "{calls:#?}");
}

#[test]
fn units_change_within_a_contour() {
    let (record, problem) = run("G21 F100\nG41.1 D2\nG1 X10\nG20 Y1 F1\nG21 X0 F10\nG40 G0 X0 Y0\nM2\n");
    assert!(problem.is_none());
    let ends: Vec<[f64; 2]> = record.moves.iter().map(|(_, made)| made.end()).collect();
    for (end, [x, y]) in ends.iter().zip([[9.0 / 25.4, 1.0 / 25.4], [9.0, 24.4], [0.0, 24.4], [0.0, 0.0]]) {
        assert!(libm::hypot(end[0] - x, end[1] - y) < 1e-9, "{end:?} {x} {y}");
    }
}

#[test]
fn a_rapid_goes_straight_around_a_corner() {
    let calls = calls("F100\nG42.1 D2\nG0 X10\nY10\nG40 X0\nM2\n");
    let first = place_of(&calls, "StraightTraverse([10.0, -1.0");
    assert!(calls[first + 1].starts_with("StraightTraverse([11.0, 0.0"), "{calls:#?}");
    assert!(calls[first + 2].starts_with("StraightTraverse([11.0, 10.0"), "{calls:#?}");
}

#[test]
fn a_stop_sends_what_waits() {
    let calls = calls("F100\nG42.1 D2\nG1 X10\nM0\nY10\nG40 X0\nM2\n");
    assert!(place_of(&calls, "ProgramStop") > place_of(&calls, "StraightFeed([10.0, -1.0"));
}

#[test]
fn the_end_of_a_tape_sends_what_waits() {
    let calls = calls("%\nF100\nG42.1 D2\nG1 X10\n%\n");
    assert!(place_of(&calls, "Finish") > place_of(&calls, "StraightFeed([10.0, -1.0"));
}

#[test]
fn a_negative_diameter_changes_sides() {
    assert_eq!(calls("F100\nG41.1 D-2\nG1 X10\nG40 X0\nM2\n"), calls("F100\nG42.1 D2\nG1 X10\nG40 X0\nM2\n"));
}

#[test]
fn a_point_is_not_compensated() {
    let calls = calls("F100\nG41.1 D0\nG1 X10\nG2 X20 I5\nG40 G1 X0\nM2\n");
    assert!(place_of(&calls, "StraightFeed([10.0, 0.0") < place_of(&calls, "ArcFeed"));
}

#[test]
fn gouges_are_refused_at_their_line() {
    // An arc smaller than the tool.
    assert_eq!(refused("F100\nG41.1 D10\nG1 X10\nX20\nG3 X23 Y3 R3\nY20\nM2\n"), (5, "compensation-gouge"));
    // A groove narrower than the tool: its bottom is to blame.
    assert_eq!(refused("F1\nG41.1 D.25\nG1 X1\nX2\nY.1\nX1\nG40 X2\nM2\n"), (5, "compensation-gouge"));
    // A step lower than the corner takes from it, and a tangent move after it.
    assert_eq!(refused("F1\nG41.1 D4\nG1 X10\nY1\nY2\nY10\nM2\n"), (4, "compensation-gouge"));
    // A stop in an inside corner.
    assert_eq!(refused("F1\nG41.1 D4\nG1 X10\nM0\nY10\nM2\n"), (5, "compensation-gouge"));
    // A slot that is wide enough, and a pocket after it that is not.
    assert_eq!(refused("F1\nG41.1 D4\nG0 X-10\nG1 X3\nG3 X0 Y3 I-3\nM2\n"), (5, "compensation-gouge"));
}

#[test]
fn a_groove_of_the_tools_width_is_cut() {
    let text = "F1\nG41.1 D2\nG1 X10\nX20\nY2\nX10\nG40 X0\nM2\n";
    assert!(run(text).1.is_none());
}

#[test]
fn several_gouges_are_found_one_by_one() {
    let text = "F1\nG41.1 D.25\nG1 X1\nX2\nY.1\nX1\nY5\nX0\nG40 X2\nM2\n";
    let mut record = super::Record::default();
    let mut program = gcode::Program::from_text("test.ngc", text, &gcode::Options::default());
    let mut lines = Vec::new();
    loop {
        match program.step(&mut record) {
            Ok(gcode::Step::More) => {}
            Ok(gcode::Step::Ended) => break,
            Err(problem) => lines.push(problem.line),
        }
    }
    assert_eq!(lines, [5]);
}

#[test]
fn entries_must_be_long_enough() {
    assert_eq!(refused("F1\nG41.1 D4\nG1 X2\nM2\n"), (3, "compensation-entry"));
    assert_eq!(refused("F1\nG41.1 D4\nG1 Z-5\nM2\n"), (3, "compensation-entry"));
    assert_eq!(refused("F1\nG41.1 D4\nG2 X1 Y1 I1\nM2\n"), (3, "compensation-entry"));
}

#[test]
fn an_arc_may_not_follow_g40() {
    let contour = "F1\nG41.1 D.25\nG1 X1\nX2\nG40\n";
    assert_eq!(refused(&format!("{contour}G2 I1\nM2\n")), (6, "compensation-exit"));
    calls(&format!("{contour}G1 X3\nG2 I1\nM2\n"));
}

#[test]
fn what_compensation_cannot_bear_is_refused() {
    let on = "F1 G41.1 D2\nG1 X10\n";
    for line in [
        "G81 X20 Z-1 R1",
        "G64 P0.01",
        "G18",
        "G92 X0",
        "G28",
        "M6 T0",
        "G43 H0",
        "G10 L2 P1 X0",
        "G53 G0 X0",
        "M62 P0",
        "M48",
    ] {
        let (at, code) = refused(&format!("{on}{line}\nM2\n"));
        assert_eq!((at, code), (3, "compensation-on"), "{line}");
    }
    assert_eq!(refused(&format!("{on}G42.1 D2\n")), (3, "compensation-on"));
    assert_eq!(refused(&format!("{on}#1=#5420\n")), (3, "compensation-on"));
    assert_eq!(refused("G19\nG41.1 D2\n"), (2, "compensation-plane"));
    assert_eq!(refused("G41.1 D2 L3\n"), (1, "compensation-plane"));
    assert_eq!(refused("G18\nG41.1 D2 L10\n"), (2, "bad-value"));
    assert_eq!(refused("G41.1\n"), (1, "missing-word"));
    assert_eq!(refused("G41 D7\n"), (1, "unknown-tool"));
    assert_eq!(refused("G41 D0.5\n"), (1, "unknown-tool"));
}

#[test]
fn the_tip_of_a_turning_tool() {
    // Facing and turning with a nose of 0.4 at the lower left of the tool: the tip touches both.
    let text = "G18 G8 F1\nG0 X20 Z5\nG42.1 D0.8 L2\nG1 X10 Z0\nX12\nZ-10\nG40 X20\nM2\n";
    let calls = calls(text);
    let start = place_of(&calls, "StraightFeed");
    let moves: Vec<_> = calls[start..].iter().filter(|call| call.contains("Feed(")).collect();
    assert_eq!(moves.len(), 5, "{moves:#?}");
}

#[test]
fn the_position_that_names_tell_is_that_of_the_tool() {
    let calls = calls("F1 G41.1 D2\nG1 X10\n(DEBUG,#<_x> #<_y>)\nG40\n(DEBUG,#<_x> #<_y>)\nM2\n");
    let said: Vec<_> = calls.iter().filter(|call| call.starts_with("Message")).collect();
    assert_eq!(said, ["Message(\"10.000000 1.000000\")", "Message(\"10.000000 0.000000\")"]);
}

/// The units go out at once, so the F that waits after a move must be in the new ones.
#[test]
fn a_feed_that_waits_follows_the_units() {
    let feeds = |stand_alone| {
        let options = gcode::Options { stand_alone, ..gcode::Options::default() };
        let text = "F100 G41.1 D4\nG1 X10\nX50 Y3\nF254\nG20\nX5 Y5\nG40\nM2\n";
        let mut program = gcode::Program::from_text("units.ngc", text, &options);
        let mut record = super::Record::default();
        while program.step(&mut record).expect("a program without fault") == gcode::Step::More {}
        let units = place_of(&record.calls, "UseLengthUnits(Inch)");
        record.calls[units..].iter().find(|call| call.starts_with("SetFeedRate")).cloned()
    };
    assert_eq!(feeds(false).as_deref(), Some("SetFeedRate(10.0)"));
    assert_eq!(feeds(true).as_deref(), Some("SetFeedRate(254.0)"));
}

#[test]
fn a_return_restores_the_modes_within_a_contour() {
    let sub = |inside: &str| {
        format!("o1 sub\nM73\n{inside}\no1 endsub\nG64 P0.1\nF100 G41.1 D4\nG1 X5\no1 call\nX9 Y5\nG40\nM2\n")
    };
    let calls = calls(&sub("G91 F7"));
    let modes: Vec<_> = calls.iter().filter(|call| call.starts_with("SetMotionControlMode")).collect();
    assert_eq!(modes.len(), 1, "a path mode that is still in force is not sent again: {modes:?}");
    assert!(calls.contains(&"Note(\"distance mode changed to absolute\")".to_owned()), "{calls:#?}");
    assert_eq!(refused(&sub("G64 P0.2")).1, "compensation-on");
}
