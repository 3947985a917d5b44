//! G0, G1, G53, polar points, feeds, G38.n.

use super::printed::{last_move, moves, printed, refused};
use super::recorded::messages;

#[test]
fn words_are_points_or_distances() {
    assert_eq!(
        moves("G0 X1 Y2 Z3\nX4\nG91 X1 Z-1\nG1 Y.5 F100"),
        ["G0 1 2 3", "G0 4 2 3", "G0 5 2 2", "G1 5 2.5 2"]
    );
    assert_eq!(moves("G0 A90 C-10\nG91 B5 C5"), ["G0 0 0 0 90 0 -10", "G0 0 0 0 90 5 -5"]);
    assert_eq!(moves("G0"), ["G0 0 0 0"]);
}

#[test]
fn x_is_a_diameter_under_g7() {
    assert_eq!(moves("G7 G0 X10\nG91 X-4\nG8 X-1"), ["G0 5 0 0", "G0 3 0 0", "G0 2 0 0"]);
    assert_eq!(last_move("G10 L2 P1 X1\nG7 G53 G0 X10"), "G0 4 0 0");
}

#[test]
fn g53_names_points_of_the_machine() {
    let set = "G10 L2 P1 X10 Y20 Z30 R90\nG92 X1 Y2 Z3\n";
    assert_eq!(
        messages(&format!("{set}G53 G0 X11 Z0\n(debug,#<_abs_x> #<_abs_y> #<_abs_z>)")),
        ["11.000000 0.000000 0.000000"]
    );
    assert_eq!(last_move("G10 L2 P1 A5 C1\nG53 G0 A90"), "G0 0 0 0 85 0 -1");
    refused("G91\nG53 G0 X1", "modal-group", &[]);
    refused("G53 G0 @1", "unused-word", &[]);
}

#[test]
fn polar_points_are_about_the_origin() {
    assert_eq!(last_move("G0 @10 ^90"), "G0 0 10 0");
    assert_eq!(last_move("G0 X3 Y4\n@10"), "G0 6 8 0");
    assert_eq!(last_move("G0 X3 Y4\n^180"), "G0 -5 0 0");
    assert_eq!(last_move("G0 X3 Y4\nG91 @5 ^90 Z1"), "G0 -8 6 1");
    refused("G0 @10", "bad-value", &["origin"]);
    refused("G91 G0 @1 ^1", "bad-value", &["origin"]);
    refused("G0 X1 @10 ^2", "repeated-word", &[]);
    refused("G18 G0 @10 ^2", "bad-value", &["XY plane"]);
}

#[test]
fn cutting_needs_a_feed() {
    refused("G1 X1", "no-feed", &[]);
    refused("F100\nG95\nG1 X1", "no-feed", &[]);
    refused("G95 F1\nG1 X1", "no-spindle-speed", &[]);
    refused("G93 F2\nG1 X1", "no-feed", &["G93"]);
    refused("G93\nG1 X1 F0", "bad-value", &["1/F"]);
    refused("G93\nG2 X1 I.5", "no-feed", &["G93"]);
}

#[test]
fn inverse_time_becomes_a_feed() {
    let feed = |text: &str| printed(&format!("G93\n{text}")).iter().rev().nth(1).cloned();
    assert_eq!(feed("G1 X3 Y4 F2").as_deref(), Some("SET_FEED_RATE 10"));
    assert_eq!(feed("G1 A30 B40 F2").as_deref(), Some("SET_FEED_RATE 100"));
    assert_eq!(feed("G1 X3 Y4 A7 F2").as_deref(), Some("SET_FEED_RATE 10"));
    assert_eq!(feed("G3 X0 I1 F1").as_deref(), Some("SET_FEED_RATE 6.2832"));
    assert_eq!(feed("G2 X2 I1 P2 Z4 F1").as_deref(), Some("SET_FEED_RATE 10.2385"));
}

#[test]
fn probing_is_shown_and_leaves_the_tool_short_of_the_point() {
    let text = "G0 X1 Z5\nG38.2 Z-3 F50\n(debug,#5061 #5063 #5070 #<_z>)\nG38.3 X1";
    assert_eq!(
        printed(text).get(1..),
        Some(
            &[
                "SET_FEED_RATE 50".to_owned(),
                "TURN_PROBE_ON".to_owned(),
                "STRAIGHT_PROBE 1 0 -3".to_owned(),
                "TURN_PROBE_OFF".to_owned(),
                "MESSAGE \"1 -3 0 -2.746000\"".to_owned(),
                "TURN_PROBE_ON".to_owned(),
                "STRAIGHT_PROBE 1 0 -2.746".to_owned(),
                "TURN_PROBE_OFF".to_owned(),
            ][..]
        )
    );
    assert_eq!(messages("G20 F5\nG38.2 Z-3\n(debug,#<_z>)"), ["-2.990000"]);
    refused("G38.2 Z-3", "no-feed", &[]);
    refused("F1\nG38.2 X0", "bad-value", &[]);
    refused("F1\nG38.3", "missing-word", &["G38.3"]);
    refused("S1 M3 G95 F1\nG38.2 X1", "bad-value", &["G95"]);
}

#[test]
fn g6_3_is_refused_by_name() {
    refused("F1\nG6.3", "not-available", &["G6.3"]);
}
