//! Holes: G81, G82, G83, G85.

use super::recorded::{errors, moves, sound};

const START: &str = "G97 S500 M03\nG00 X0. Z5.\n";

/// The moves of a cycle from X0 Z5.
fn hole(text: &str) -> Vec<String> {
    moves(&format!("{START}{text}"))[1..].to_vec()
}

#[test]
fn a_hole_in_one_go() {
    let wanted = ["G0 0 5", "G0 0 2", "G1 0 -10", "G0 0 2", "G0 0 5"];
    assert_eq!(hole("G81 Z-10. R2. F0.1"), wanted);
    assert_eq!(hole("G83 Z-10. R-3. F0.1"), wanted, "R is a distance");
    assert_eq!(hole("G85 Z-10. R2. F0.1")[3], "G1 0 2", "a bored hole is left at the feed");
}

#[test]
fn r_is_read_so_that_the_tool_stops_farther_from_the_bottom() {
    assert_eq!(hole("G81 Z-10. F0.1")[1], "G0 0 5");
    assert_eq!(hole("G81 Z-10. R0. F0.1")[1], "G0 0 5", "not Z0");
    assert_eq!(hole("G81 Z-10. R-1. F0.1")[1], "G0 0 4", "not Z-1");
    assert_eq!(errors(&format!("{START}G81 Z-10. R6. F0.1")), [(3, "bad-value")]);
}

#[test]
fn pecks_come_back_and_go_on_above_the_bottom() {
    let wanted = [
        "G0 0 5",
        "G0 0 2",
        "G1 0 -3",
        "G0 0 2",
        "G0 0 -2.5",
        "G1 0 -8",
        "G0 0 2",
        "G0 0 -7.5",
        "G1 0 -10",
        "G0 0 2",
        "G0 0 5",
    ];
    assert_eq!(hole("G83 Z-10. R2. Q5000 F0.1"), wanted);
    assert_eq!(hole("G83 Z-10. R2. Q5. F0.1"), wanted);
    assert_eq!(errors(&format!("{START}G83 Z-200. R2. Q1 F0.1")), [(3, "bad-value")]);
    assert_eq!(errors(&format!("{START}G81 Z-10. R2. Q1. F0.1")), [(3, "bad-value")]);
}

#[test]
fn a_dwell_at_the_bottom_is_in_milliseconds_or_seconds() {
    assert_eq!(hole("G82 Z-10. R2. P500 F0.1")[2..4], ["G1 0 -10", "dwell 0.5"]);
    assert_eq!(hole("G82 Z-10. R2. P.5 F0.1"), hole("G82 Z-10. R2. P500 F0.1"));
}

#[test]
fn a_cycle_is_in_force_until_it_is_ended() {
    let first = hole("G83 Z-10. R2. Q5. F0.1");
    let again = hole("G83 Z-10. R2. Q5. F0.1\nM08\nZ-12.");
    assert_eq!(again[..first.len()], first);
    assert_eq!(again[again.len() - 3..], ["G1 0 -12", "G0 0 2", "G0 0 5"]);
    let ended = |end: &str| hole(&format!("G83 Z-10. R2. F0.1\n{end}"))[5..].to_vec();
    assert_eq!(ended("G80\nX10."), ["G0 5 5"], "the code before it is in force again");
    assert_eq!(ended("G00 X10."), ["G0 5 5"]);
    assert_eq!(ended("G28 U0. W0.\nX10."), ["G0 0 5", "G0 0 0", "G0 5 0"]);
}

/// K makes a hole so often at its place; none at first, and the next block makes it.
#[test]
fn a_hole_is_made_as_often_as_k_says() {
    let once = hole("G81 Z-10. R2. F0.1");
    assert_eq!(hole("G81 Z-10. R2. K3 F0.1"), [&once[..]; 3].concat());
    assert_eq!(hole("G81 Z-10. R2. K0 F0.1\nX0."), once);
}

#[test]
fn holes_that_make_no_sense_are_refused() {
    let errors = |text: &str| errors(&format!("{START}{text}"));
    assert_eq!(errors("G83 R2. F0.1"), [(3, "missing-word")]);
    assert_eq!(errors("G83 Z5. F0.1"), [(3, "bad-value")]);
    assert_eq!(errors("G83 W-10. F0.1"), [(3, "not-available")]);
    assert_eq!(errors("G83 G01 Z-10. F0.1"), [(3, "modal-group")]);
    assert_eq!(errors("G88 Z-10. R2. F1."), [(3, "not-available")]);
    assert_eq!(errors("G83 Z-10. K2.5 F0.1"), [(3, "bad-value")]);
    assert_eq!(errors("G83 Z-10. K-1 F0.1"), [(3, "bad-value")]);
    assert_eq!(errors("G83 U2. Z-10. K2 F0.1"), [(3, "not-available")]);
    assert_eq!(errors("G83 Z-10. R2. Q.01 K9999 F0.1"), [(3, "bad-value")]);
}

#[test]
fn inches_have_their_own_gap() {
    let text = "G20 G97 S500 M03\nG00 X0. Z.2\nG83 Z-1. R.1 Q.25 F.005";
    assert_eq!(sound(text).moves[5], "G0 0 -0.13");
}
