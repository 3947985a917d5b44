//! Words and plain moves.

use super::recorded::{errors, linuxcnc, moves, outcome, sound};

#[test]
fn x_is_a_diameter_and_u_w_count_from_the_point() {
    assert_eq!(moves("G00 X40. Z2.\nU-10. W-2.\nX[20.+1.] Z5."), ["G0 20 2", "G0 15 0", "G0 10.5 5"]);
}

#[test]
fn absolute_and_incremental_words_mix_in_a_block() {
    assert_eq!(
        moves("S500 M03\nG00 X40. Z2.\nG01 X50. W-12. F0.2\nU2. Z-30."),
        ["G0 20 2", "G1 25 -10", "G1 26 -30"]
    );
}

#[test]
fn lengths_without_a_point_count_micrometres() {
    assert_eq!(moves("G00 X40000 Z-2500"), ["G0 20 -2.5"]);
    assert_eq!(moves("G20\nG00 X40000 Z-2500"), ["G0 2 -0.25"]);
}

#[test]
fn computed_lengths_are_lengths_and_rounded() {
    assert_eq!(moves("#1=20.00049\nG00 X#1 Z-#1"), ["G0 10 -20"]);
}

#[test]
fn codes_that_end_what_never_begins_are_harmless() {
    assert_eq!(moves("G00 G40 G67 G69 G80 G97 G99 X40. (HERE) Z2."), ["G0 20 2"]);
}

#[test]
fn feed_is_per_revolution_until_g98() {
    let record = sound("S500 M03\nG00 X10. Z0.\nG01 Z-5. F0.2\nG98 G01 Z-6. F120.\nG99 Z-7. F.1");
    let modes: Vec<&String> = record.others.iter().filter(|call| call.starts_with("SetFeed")).collect();
    let wanted = [
        "SetFeedReference",
        "SetFeedMode(PerRevolution)",
        "SetFeedRate(0.2)",
        "SetFeedMode(PerMinute)",
        "SetFeedRate(0.0)",
        "SetFeedRate(120.0)",
        "SetFeedMode(PerRevolution)",
        "SetFeedRate(0.0)",
        "SetFeedRate(0.1)",
    ];
    assert_eq!(modes[..wanted.len()], wanted);
}

#[test]
fn repeating_g99_keeps_the_feed() {
    assert_eq!(moves("S500 M03\nG00 X10. Z0.\nG01 Z-5. F0.2\nG99\nZ-6.").last().unwrap(), "G1 5 -6");
}

#[test]
fn feed_without_a_point_is_taken_whole_and_warned_of() {
    let outcome = outcome("S500 M03\nG00 X10. Z0.\nG01 Z-5. F1\nM30\n");
    assert!(outcome.errors.is_empty());
    assert_eq!(outcome.warnings[0].code, "no-decimal-point");
}

#[test]
fn arcs_by_radius_and_by_centre_are_the_same() {
    let start = "S500 M03\nG00 X20. Z0.\n";
    let by_radius = moves(&format!("{start}G03 X30. Z-5. R5. F0.1"));
    assert_eq!(by_radius, moves(&format!("{start}G03 X30. Z-5. I0 K-5. F0.1")));
    assert_eq!(by_radius, ["G0 10 0", "G3 15 -5 c 10 -5"]);
    assert_eq!(by_radius, linuxcnc("S500 M3\nG0 X20 Z0\nG3 X30 Z-5 R5 F0.1"));
}

#[test]
fn dwells_are_seconds_or_milliseconds() {
    assert_eq!(
        moves("G04 X1.5\nG04 U0.25\nG04 P500\nG04 X2000"),
        ["dwell 1.5", "dwell 0.25", "dwell 0.5", "dwell 2"]
    );
}

#[test]
fn reference_point_by_an_intermediate_one() {
    assert_eq!(moves("G00 X40. Z2.\nG28 U0. W0."), ["G0 20 2", "G0 20 2", "G0 0 0"]);
    assert_eq!(moves("G00 X40. Z2.\nG28 U4."), ["G0 20 2", "G0 22 2", "G0 0 2"]);
}

#[test]
fn coordinates_are_set_and_left() {
    assert_eq!(moves("G00 X40. Z2.\nG50 X100. Z50.\nG00 X90. Z40."), ["G0 20 2", "G0 45 40"]);
    assert_eq!(moves("G10 L2 P2 X10. Z-100.\nG55 G00 X0 Z0\nG53 X20. Z-50."), ["G0 0 0", "G0 5 50"]);
}

#[test]
fn constant_surface_speed_is_bounded_by_g50() {
    let record = sound("G50 S2500\nG96 S200 M03\nG97 S800\n");
    let speeds: Vec<&String> = record.others.iter().filter(|call| call.contains("Spindle")).collect();
    assert_eq!(
        speeds[..5],
        [
            "SetSpindleMode(2500.0)",
            "SetSpindleSpeed(200.0)",
            "StartSpindle(Clockwise)",
            "SetSpindleMode(0.0)",
            "SetSpindleSpeed(800.0)"
        ]
    );
}

#[test]
fn the_turret_turns_without_stopping_the_spindle() {
    let record = sound("G97 S800 M03\nT0101\nG00 X20.\nT0100");
    let wanted = ["SelectTool(1)", "ChangeTool(1)", "UseToolLengthOffset([0.0, 0.0, 0.0, 0.0, 0.0, 0.0])"];
    let start = record.others.iter().position(|call| call == "SelectTool(1)").unwrap();
    assert_eq!(record.others[start..start + 3], wanted);
    let stop = record.others.iter().position(|call| call == "StopSpindle").unwrap();
    assert!(stop > start + 3, "only M30 stops the spindle");
}

#[test]
fn an_offset_moves_the_coordinates() {
    let mut options = super::recorded::fanuc();
    options.tools = gcode::files::ToolTable::parse("tools", "T2 P2 X-10 Z-30 D0.8 Q3\n").unwrap();
    let program = gcode::Program::from_text(
        "O1",
        "G00 X40. Z2.\nT0102\n#1=#5001\n#2=#5002\nG04 U[#1]\nG04 U[#2]\nM30\n",
        &options,
    );
    let outcome = super::recorded::run(program);
    assert!(outcome.errors.is_empty(), "{:?}", outcome.errors);
    assert_eq!(outcome.sink.moves, ["G0 20 2", "dwell 60", "dwell 32"]);
}

#[test]
fn coolant_and_spindle_stop_behind_the_move() {
    let outcome = outcome("S500 M03\nG00 X10. Z0.\nG01 Z-5. F0.2 M05\nM30\n");
    assert!(outcome.errors.is_empty() && outcome.warnings.is_empty(), "{:?}", outcome.warnings);
}

#[test]
fn corners_are_cut_off_and_rounded() {
    let start = "S500 M03\nG00 X20. Z0.\n";
    let chamfer = moves(&format!("{start}G01 Z-20. ,C2. F0.1\nX40."));
    assert_eq!(chamfer, ["G0 10 0", "G1 10 -18", "G1 12 -20", "G1 20 -20"]);
    assert_eq!(chamfer, moves(&format!("{start}G01 Z-20. C2. F0.1\nX40.")));
    assert_eq!(chamfer, moves(&format!("{start}G01 Z-20. I2. F0.1\nX40.")));
    let round = moves(&format!("{start}G01 Z-20. ,R2. F0.1\nX40."));
    assert_eq!(round, ["G0 10 0", "G1 10 -18", "G2 12 -20 c 12 -18", "G1 20 -20"]);
    assert_eq!(round, moves(&format!("{start}G01 W-20. R2. F0.1\nU20.")));
    assert_eq!(
        moves(&format!("{start}G01 X30. K-1. F0.1\nZ-9.")),
        ["G0 10 0", "G1 14 0", "G1 15 -1", "G1 15 -9"]
    );
}

#[test]
fn a_blunt_corner_is_rounded_tangentially() {
    // 45 degrees: the rounding begins r tan 22.5 before the corner
    let text = "S500 M03\nG00 X20. Z0.\nG01 Z-10. ,R10. F0.1\nX40. Z-20.";
    assert_eq!(moves(text)[1..], ["G1 10 -5.8579", "G2 12.9289 -12.9289 c 20 -5.8579", "G1 20 -20"]);
}

#[test]
fn two_corners_in_a_row() {
    let text = "S500 M03\nG00 X20. Z0.\nG01 Z-10. ,C1. F0.1\nX40. ,R1.\nZ-20.";
    assert_eq!(moves(text)[1..], ["G1 10 -9", "G1 11 -10", "G1 19 -10", "G3 20 -11 c 19 -11", "G1 20 -20"]);
}

#[test]
fn corner_moves_keep_the_line_they_stand_in() {
    let record = sound("S500 M03\nG00 X20. Z0.\nG01 Z-20. ,C2. F0.1\nX40.");
    assert_eq!(record.lines, [2, 3, 3, 4]);
}

#[test]
fn g61_stops_until_g64_and_g09_stops_once() {
    let (exact, on) = ("ExactStop", "Continuous(0.0)");
    assert_eq!(
        moves("G00 X10. Z0.\nG09 X12.\nX14.\nG61\nG09 Z-5.\nG64 Z-6."),
        ["G0 5 0", exact, "G0 6 0", on, "G0 7 0", exact, "G0 7 -5", on, "G0 7 -6"]
    );
}

#[test]
fn g09_without_a_move_is_refused() {
    assert_eq!(errors("G09"), [(1, "missing-word")]);
    assert_eq!(errors("G98 G01 X10. F100.\nG09 G01 X20. ,C1.\nZ-5."), [(2, "not-available")]);
    assert_eq!(errors("G09 G28 U0."), [(1, "missing-word")]);
}
