//! G73, G74, G80 to G89.

use super::printed::{moves, printed, refused, warned};
use super::recorded::{messages, run};
use gcode::{Options, Program};

/// The moves of a program that begins at Z10 with the spindle on.
fn holes(text: &str) -> Vec<String> {
    moves(&format!("S100 M3 F100\nG0 Z10\n{text}")).split_off(1)
}

/// What is sent between the path modes that frame a cycle.
fn framed(text: &str) -> Vec<String> {
    let calls = printed(&format!("S100 M3 F100\nG0 Z10\n{text}"));
    let inside = calls.split(|call| call.starts_with("SET_MOTION_CONTROL_MODE")).nth(1);
    inside.map(<[String]>::to_vec).unwrap_or_default()
}

#[test]
fn g81_goes_over_the_hole_and_down_to_r_first() {
    let down = ["G0 1 2 10", "G0 1 2 3", "G1 1 2 -5"];
    assert_eq!(holes("G99 G81 X1 Y2 Z-5 R3"), [&down[..], &["G0 1 2 3"]].concat());
    assert_eq!(holes("G98 G81 X1 Y2 Z-5 R3"), [&down[..], &["G0 1 2 10"]].concat());
    // From below R straight up first.
    assert_eq!(holes("G0 Z1\nG81 X1 Z-5 R3").split_off(1), ["G0 0 0 3", "G0 1 0 3", "G1 1 0 -5", "G0 1 0 3"]);
}

#[test]
fn r_and_depth_stick_until_another_motion_code() {
    let text = "G98 G81 X1 Y2 Z-5 R3\nX2\nY4 Z-6";
    assert_eq!(
        holes(text).split_off(4),
        [
            "G0 2 2 10",
            "G0 2 2 3",
            "G1 2 2 -5",
            "G0 2 2 10",
            "G0 2 4 10",
            "G0 2 4 3",
            "G1 2 4 -6",
            "G0 2 4 10"
        ]
    );
    refused("F1\nG81 X1", "missing-word", &["G81", "R"]);
    refused("F1\nG81 X1 R1", "missing-word", &["Z"]);
    refused("F1\nG81 X1 Z-1 R1\nG0 X2\nG81 X3", "missing-word", &["R"]);
    refused("F1\nG81 X1 Z-1 R1\nG82 X3", "missing-word", &["R"]);
    refused("F1\nG81 X1 Z-1 R1\nG80\nX3", "no-motion-mode", &[]);
    refused("F1\nG81 X1 Z-1 R1\nG18\nX3", "missing-word", &["R"]);
}

#[test]
fn the_level_is_that_before_the_first_of_a_row() {
    let text = "G99 G81 X1 Z-5 R3\nG98 G82 X2 Z-5 R4 P1";
    assert_eq!(holes(text).last().map(String::as_str), Some("G0 2 0 10"));
    let text = "G99 G81 X1 Z-5 R3\nG0 X2\nG98 G82 X2 Z-5 R4 P1";
    assert_eq!(holes(text).last().map(String::as_str), Some("G0 2 0 4"));
    assert_eq!(messages("F1\nG0 Z10\nG99 G81 X1 Z-5 R3\n(debug,#<_x> #<_z>)"), ["1.000000 3.000000"]);
    assert_eq!(warned("F1\nG0 Z10\nG99 G81 X1 Z-5 R3\nX2 R5"), ["slanting-rapid"]);
}

#[test]
fn sticky_lengths_keep_their_length_when_units_change() {
    let text = "G98 G81 X25.4 Z-5.08 R2.54\nG20 F1\nX2";
    assert_eq!(holes(text).split_off(4), ["G0 2 0 0.3937", "G0 2 0 0.1", "G1 2 0 -0.2", "G0 2 0 0.3937"]);
}

#[test]
fn g91_repeats_in_steps_from_the_level() {
    assert_eq!(
        holes("G91 G98 G81 X1 Y1 Z-6 R-8 L2"),
        [
            "G0 1 1 10",
            "G0 1 1 2",
            "G1 1 1 -4",
            "G0 1 1 10",
            "G0 2 2 10",
            "G0 2 2 2",
            "G1 2 2 -4",
            "G0 2 2 10"
        ]
    );
    assert_eq!(
        holes("G0 X3 Y4\nG91 G81 ^90 Z-1 R-8 L2").iter().filter(|call| call.starts_with("G1")).count(),
        2
    );
    refused("F1\nG91 G81 ^90 Z-1 R-8 L2", "bad-value", &["origin"]);
    for count in ["0", "1.5", "-2"] {
        refused(&format!("F1\nG81 X1 Z-1 R1 L{count}"), "bad-value", &[&format!("L{count}")]);
    }
}

#[test]
fn chips_are_broken_and_cleared_with_a_clearance_each() {
    let options = Options { peck_clearances: [0.5, 1.0], ..Options::default() };
    let text = "F1\nG73 X1 Z-2 R0 Q1\nG83 X2 Z-2 R0 Q1\nM2\n";
    let calls = run(Program::from_text("t", text, &options)).sink.calls;
    for depth in ["1.0, 0.0, -0.5", "2.0, 0.0, 0.0"] {
        assert!(calls.contains(&format!("StraightTraverse([{depth}, 0.0, 0.0, 0.0])")), "{calls:?}");
    }
}

#[test]
fn pecks_go_back_by_the_clearance_in_any_units() {
    assert_eq!(
        holes("G73 X1 Z-5 R3 Q3").split_off(2),
        ["G1 1 0 0", "G0 1 0 0.254", "G1 1 0 -3", "G0 1 0 -2.746", "G1 1 0 -5", "G0 1 0 3"]
    );
    assert_eq!(
        holes("G83 X1 Z-5 R3 Q5").split_off(2),
        ["G1 1 0 -2", "G0 1 0 3", "G0 1 0 -1.746", "G1 1 0 -5", "G0 1 0 3"]
    );
    assert_eq!(
        moves("G20 F1\nG73 X1 Z-.3 R.1 Q.3").split_off(2),
        ["G1 1 0 -0.2", "G0 1 0 -0.19", "G1 1 0 -0.3", "G0 1 0 0.1"]
    );
    refused("F1\nG83 X1 Z-5 R3", "missing-word", &["Q"]);
    refused("F1\nG83 X1 Z-5 R3 Q0", "bad-value", &["Q0"]);
    refused("F1\nG73 X1 Z-5 R3 Q.0000001", "bad-value", &["1000000 moves", "moves_of_block"]);
}

#[test]
fn each_cycle_does_its_own_at_the_bottom() {
    let tail = |text: &str| framed(text).split_off(2);
    assert_eq!(tail("G82 X1 Z-5 R3 P.5"), ["STRAIGHT_FEED 1 0 -5", "DWELL 0.5", "STRAIGHT_TRAVERSE 1 0 3"]);
    assert_eq!(
        tail("G98 G85 X1 Z-5 R3"),
        ["STRAIGHT_FEED 1 0 -5", "STRAIGHT_FEED 1 0 3", "STRAIGHT_TRAVERSE 1 0 10"]
    );
    assert_eq!(tail("G89 X1 Z-5 R3 P1"), ["STRAIGHT_FEED 1 0 -5", "DWELL 1", "STRAIGHT_FEED 1 0 3"]);
    assert_eq!(
        tail("G86 X1 Z-5 R3 P1"),
        [
            "STRAIGHT_FEED 1 0 -5",
            "DWELL 1",
            "STOP_SPINDLE_TURNING 0",
            "STRAIGHT_TRAVERSE 1 0 3",
            "START_SPINDLE_CLOCKWISE 0",
        ]
    );
    for code in ["G82", "G86", "G88", "G89"] {
        refused(&format!("S1 M3 F1\n{code} X1 Z-5 R3"), "missing-word", &["P"]);
        refused(&format!("S1 M3 F1\n{code} X1 Z-5 R3 P-1"), "bad-value", &["P-1"]);
    }
}

#[test]
fn taps_reverse_with_the_overrides_off() {
    let tapped = [
        "DISABLE_FEED_OVERRIDE",
        "DISABLE_SPEED_OVERRIDE 0",
        "STRAIGHT_FEED 1 0 -5",
        "STOP_SPINDLE_TURNING 0",
        "START_SPINDLE_COUNTERCLOCKWISE 0",
        "DWELL 0",
        "STRAIGHT_FEED 1 0 3",
        "STOP_SPINDLE_TURNING 0",
        "START_SPINDLE_CLOCKWISE 0",
        "ENABLE_FEED_OVERRIDE",
        "ENABLE_SPEED_OVERRIDE 0",
    ];
    assert_eq!(framed("G84 X1 Z-5 R3").split_off(2), tapped);
    assert_eq!(framed("M50 P0\nG84 X1 Z-5 R3").split_off(2), [&tapped[..9], &tapped[10..]].concat());
    refused("S1 M4 F1\nG84 X1 Z-5 R3", "spindle-direction", &["G84"]);
    refused("S1 M3 F1\nG74 X1 Z-5 R3", "spindle-direction", &["G74"]);
    for code in ["G74", "G84", "G86", "G87", "G88"] {
        refused(
            &format!("F1\n{code} X1 Z-5 R3 P1 I1 J1 K1")
                .replace(if code == "G87" { " P1" } else { " I1 J1 K1" }, ""),
            "spindle-not-turning",
            &[code],
        );
    }
}

#[test]
fn g88_leaves_the_way_out_to_the_operator() {
    assert_eq!(
        framed("G88 X1 Z-5 R3 P1").split_off(2),
        ["STRAIGHT_FEED 1 0 -5", "DWELL 1", "STOP_SPINDLE_TURNING 0",]
    );
    assert_eq!(warned("S1 M3 F1\nG88 X1 Z-5 R3 P1"), ["retract-by-hand"]);
}

#[test]
fn a_dwell_does_not_pass_from_one_cycle_to_another() {
    assert!(framed("G84 X1 Z-5 R3").contains(&"DWELL 0".to_owned()));
    let calls = printed("S100 M3 F100\nG82 X1 Z-5 R3 P.5\nG84 X1 Z-5 R3");
    assert_eq!(calls.iter().filter(|call| *call == "DWELL 0.5").count(), 1);
}

#[test]
fn g87_passes_the_hole_beside_its_axis() {
    let framed = framed("G87 X1 Y2 Z-5 R3 I.5 J-.5 K-2");
    assert_eq!(
        framed.split_at(2).1,
        [
            "STRAIGHT_TRAVERSE 1.5 1.5 3",
            "STOP_SPINDLE_TURNING 0",
            "ORIENT_SPINDLE 0 0 2",
            "STRAIGHT_TRAVERSE 1.5 1.5 -5",
            "STRAIGHT_TRAVERSE 1 2 -5",
            "START_SPINDLE_CLOCKWISE 0",
            "STRAIGHT_FEED 1 2 -2",
            "STRAIGHT_FEED 1 2 -5",
            "STOP_SPINDLE_TURNING 0",
            "ORIENT_SPINDLE 0 0 2",
            "STRAIGHT_TRAVERSE 1.5 1.5 -5",
            "STRAIGHT_TRAVERSE 1.5 1.5 3",
            "STRAIGHT_TRAVERSE 1 2 3",
            "START_SPINDLE_CLOCKWISE 0",
        ]
    );
    refused("S1 M3 F1\nG87 X1 Z-5 R3 I1 J1", "missing-word", &["K"]);
}

#[test]
fn every_plane_drills_across_it() {
    assert_eq!(
        moves("F1\nG18 G0 Y5\nG98 G81 X1 Z2 Y-3 R1").split_off(1),
        ["G0 1 5 2", "G0 1 1 2", "G1 1 -3 2", "G0 1 5 2"]
    );
    assert_eq!(
        moves("F1\nG19 G0 X5\nG7 G98 G81 Y1 Z2 X-6 R1").split_off(1),
        ["G0 5 1 2", "G0 1 1 2", "G1 -3 1 2", "G0 5 1 2"]
    );
    // Where LinuxCNC mixes the axes up.
    assert_eq!(moves("S1 M3 F1\nG19 G0 X5\nG84 Y1 Z2 X-3 R1").split_off(3), ["G1 -3 1 2", "G1 1 1 2"]);
}

#[test]
fn the_path_mode_is_exact_and_then_as_before() {
    let modes = |text: &str| {
        let calls = printed(&format!("F1\n{text}\nG81 X1 Z-5 R3"));
        calls
            .into_iter()
            .filter(|call| call.contains("CONTROL_MODE") || call.contains("NAIVE"))
            .collect::<Vec<_>>()
    };
    assert!(modes("G61").split_off(1).is_empty());
    assert_eq!(
        modes("G64 P.1 Q.2").split_off(2),
        [
            "SET_MOTION_CONTROL_MODE CANON_EXACT_PATH",
            "SET_MOTION_CONTROL_MODE CANON_CONTINUOUS 0.1",
            "SET_NAIVECAM_TOLERANCE 0.2",
        ]
    );
}

#[test]
fn cycles_refuse_what_they_cannot_do() {
    refused("G81 X1 Z-5 R3", "no-feed", &[]);
    refused("G93\nG81 X1 Z-5 R3 F1", "bad-value", &["G93"]);
    refused("F1\nG81 X1 Z5 R3", "bad-value", &["Z3", "5"]);
    refused("F1\nG81 X1 A1 Z-5 R3", "unused-word", &["A"]);
    refused("F1\nG81 Z-5 R3\nG81 R2", "missing-word", &["G81"]);
}

#[test]
fn d_is_the_clearance_of_the_pecks_of_its_block() {
    let text = "G98 G83 X1 Y1 Z-10 R2 Q6 D1";
    let first = ["G0 1 1 10", "G0 1 1 2", "G1 1 1 -4", "G0 1 1 2", "G0 1 1 -3", "G1 1 1 -10", "G0 1 1 10"];
    assert_eq!(holes(text), first);
    let back = |text: &str| holes(&format!("G98 G73 X1 Y1 Z-10 R2 Q6{text}"))[3..].join(", ");
    assert_eq!(back(" D0.5"), "G0 1 1 -3.5, G1 1 1 -10, G0 1 1 10");
    assert!(back(" D0.5\nX2").contains("G0 2 1 -3.746"), "it does not stay");
    refused("F1\nG83 X1 Z-10 R2 Q6 D-1", "bad-value", &["D-1"]);
}
