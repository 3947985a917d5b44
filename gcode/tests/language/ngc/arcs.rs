//! G2 and G3.

use gcode::canon::LinuxcncPrinter;
use gcode::{Options, Program, Step};
use proptest::prelude::*;

use super::printed::{last_move, moves, refused, warned};

const F: &str = "F100\n";

fn arc(text: &str) -> String {
    last_move(&format!("{F}{text}"))
}

#[test]
fn centres_are_from_the_start_or_points() {
    assert_eq!(arc("G2 X2 I1"), "ARC 2 0 1 0 -1 0");
    assert_eq!(arc("G0 X1 Y1\nG3 X0 Y2 J1"), "ARC 0 2 1 2 1 0");
    assert_eq!(arc("G0 X1 Y1\nG90.1 G3 X3 I2 J1"), "ARC 3 1 2 1 1 0");
    assert_eq!(arc("G0 X1 Y1\nG91 G3 X2 I1"), "ARC 3 1 2 1 1 0");
    refused("F1\nG90.1 G2 X2 I1", "missing-word", &["J", "G90.1"]);
}

#[test]
fn every_plane_has_its_axes() {
    assert_eq!(arc("G18 G2 Z2 K1 Y5"), "ARC 2 0 1 0 -1 5");
    assert_eq!(arc("G18 G0 X3\nG3 X5 I1"), "ARC 0 5 0 4 1 0");
    assert_eq!(arc("G19 G3 Y2 J1 X5 A7"), "ARC 2 0 1 0 1 5 7 0 0");
    refused("F1\nG18 G2 Z2 J1", "unused-word", &["J", "G18"]);
    refused("F1\nG17 G2 X2 I1 K1", "unused-word", &["K", "G17"]);
}

#[test]
fn x_is_a_diameter_and_i_is_not() {
    assert_eq!(arc("G18 G7 G0 X10\nG3 X14 I1"), "ARC 0 7 0 6 1 0");
    assert_eq!(arc("G18 G7 G0 X10\nG90.1 G3 X14 I6 K0"), "ARC 0 7 0 6 1 0");
}

#[test]
fn turns_and_full_circles() {
    assert_eq!(arc("G2 I1"), "ARC 0 0 1 0 -1 0");
    assert_eq!(arc("G3 I1 P3 Z-6"), "ARC 0 0 1 0 3 -6");
    assert_eq!(moves("F1\nG3 X2 I1\nI-1"), ["ARC 2 0 1 0 1 0", "ARC 2 0 1 0 1 0"]);
    for p in ["0", "-1", "1.5"] {
        refused(&format!("F1\nG2 I1 P{p}"), "bad-value", &[&format!("P{p}")]);
    }
}

#[test]
fn a_radius_takes_the_shorter_arc_and_a_negative_one_the_longer() {
    assert_eq!(arc("G0 X3\nG3 X0 Y3 R3"), "ARC 0 3 0 0 1 0");
    assert_eq!(arc("G0 X3\nG3 X0 Y3 R-3"), "ARC 0 3 3 3 1 0");
    assert_eq!(arc("G0 X3\nG2 X0 Y3 R3"), "ARC 0 3 3 3 -1 0");
    assert_eq!(arc("G0 X3\nG2 X0 Y3 R-3"), "ARC 0 3 0 0 -1 0");
    // Half a circle, a little too short.
    assert_eq!(arc("G2 X10 R4.999"), "ARC 10 0 5 0 -1 0");
    refused("F1\nG2 X10 R4.9", "arc-radius", &["4.9", "5"]);
    refused("F1\nG2 X10 R0", "arc-radius", &["0"]);
    refused("F1\nG2 Z1 R1", "arc-radius", &["X0 Y0"]);
}

#[test]
fn a_centre_or_a_radius() {
    refused("F1\nG2 X1 Y1", "missing-word", &["I, J", "R"]);
    refused("F1\nG19 G2 Y1", "missing-word", &["J, K"]);
    refused("F1\nG2 X2 I1 R1", "bad-value", &["centre", "radius"]);
    refused("G2 X2 I1", "no-feed", &[]);
}

#[test]
fn ends_may_miss_the_circle_by_a_little() {
    assert_eq!(arc("G2 X10.02 I5"), "ARC 10.02 0 5 0 -1 0");
    refused("F1\nG2 X10.04 I5", "arc-radius", &["5.04", "0.04"]);
    // A thousandth of a large radius is more, but never more than a hundred tolerances.
    assert_eq!(arc("G2 X1000.4 I500"), "ARC 1000.4 0 500 0 -1 0");
    refused("F1\nG2 X1000.6 I500", "arc-radius", &["0.6"]);
    refused("F1\nG2 X20003 I10000", "arc-radius", &["3"]);
    refused("F1\nG2 X2 I0 J0", "arc-radius", &["is 0"]);
    assert_eq!(arc("G20 G2 X1.0028 I.5"), "ARC 1.0028 0 0.5 0 -1 0");
    refused("G20 F1\nG2 X1.0029 I.5", "arc-radius", &[]);
    assert_eq!(warned("F1\nG2 X10.012 I5"), ["arc-radius"]);
    assert!(warned("F1\nG2 X10.008 I5").is_empty());
    assert_eq!(warned("G20 F1\nG2 X1.001 I.5"), ["arc-radius"]);
}

proptest! {
    /// The centre that R finds is R away from start and end, and the arc is at most half a turn for a
    /// positive R.
    #[test]
    fn the_centre_of_a_radius_is_that_far_from_both_ends(
        end in prop::array::uniform2(-50i32..50), extra in 0u32..40, clockwise: bool, longer: bool,
    ) {
        prop_assume!(end != [0, 0]);
        let [x, y] = end.map(f64::from);
        let radius = libm::hypot(x, y) / 2.0 + f64::from(extra) + 0.01;
        let code = if clockwise { "G2" } else { "G3" };
        let sign = if longer { "-" } else { "" };
        let text = format!("F1\n{code} X{x} Y{y} R{sign}{radius:.6}\nM2\n");
        let mut program = Program::from_text("test.ngc", text, &Options::default());
        let mut bytes = Vec::new();
        let mut printer = LinuxcncPrinter::new(&mut bytes);
        while program.step(&mut printer).unwrap() == Step::More {}
        printer.flush().unwrap();
        drop(printer);
        let text = String::from_utf8(bytes).unwrap();
        let (_, numbers) = text.split_once("ARC_FEED(").unwrap();
        let numbers: Vec<f64> = numbers.split(", ").take(4).map(|number| number.parse().unwrap()).collect();
        let center = [numbers[2], numbers[3]];
        prop_assert!((libm::hypot(center[0], center[1]) - radius).abs() < 1e-3);
        prop_assert!((libm::hypot(center[0] - x, center[1] - y) - radius).abs() < 1e-3);
        // The centre is to the left of the chord for a short arc to the left, and for a long one to the
        // right.
        let left = x * center[1] - y * center[0];
        let side = if clockwise == longer { left } else { -left };
        prop_assert!(side > -1e-2);
    }
}
