//! G10 L2 L20, G28 G30, G52, G54 to G59.3, G92.

use proptest::prelude::*;

use super::recorded::{calls, errors, messages, run};
use gcode::{Options, Program};

const SYSTEMS: [&str; 9] = ["G54", "G55", "G56", "G57", "G58", "G59", "G59.1", "G59.2", "G59.3"];

#[test]
fn every_coordinate_system_has_its_offset() {
    for (system, code) in (1..).zip(SYSTEMS) {
        let text =
            format!("G10 L2 P{system} X{system}0\n{code}\n(debug,#5220 #<_x> #5{})", 201 + 20 * system);
        assert_eq!(messages(&text), [format!("{system}.000000 -{system}0.000000 {system}0.000000")]);
    }
}

#[test]
fn g10_l20_makes_the_point_read_as_given() {
    let text = "G10 L2 P1 X1 Y2 R30\nG0 X3 Y4 Z5\nG10 L20 P0 X7 Z-1\n(debug,#<_x> #<_y> #<_z> #<_abs_z>)";
    assert_eq!(messages(text), ["7.000000 4.000000 -1.000000 5.000000"]);
    let text = "G92 X9\nG0 X3\nG10 L20 P2 X1 Y1\nG55\n(debug,#<_x> #<_y>)";
    assert_eq!(messages(text), ["1.000000 1.000000"]);
}

#[test]
fn g92_and_g52_shift_and_can_be_suspended() {
    let text =
        "G0 X10\nG92 X4\n(debug,#<_x> #5211 #5210)\nG92.2\n(debug,#<_x> #5211 #5210)\nG92.3\n(debug,#<_x>)";
    assert_eq!(messages(text), ["4.000000 6.000000 1.000000", "10.000000 6.000000 0.000000", "4.000000"]);
    let text = "G0 X10\nG52 X4\n(debug,#<_x> #5211)\nG92.1\n(debug,#<_x> #5211)\nG92.3\n(debug,#<_x>)";
    assert_eq!(messages(text), ["6.000000 4.000000", "10.000000 0.000000", "10.000000"]);
}

#[test]
fn g28_goes_by_the_point_of_its_words() {
    let traverses = |text: &str| {
        let calls = calls(text);
        let all = calls.iter().filter_map(|call| call.strip_prefix("StraightTraverse([").map(str::to_owned));
        all.collect::<Vec<_>>()
    };
    let text = "G0 X5 Y6\nG28.1\nG0 X1 Y1\nG28 X2\nG91 G28 Y1";
    let rest = "0.0, 0.0, 0.0, 0.0])";
    let expected = ["5.0, 6.0", "1.0, 1.0", "2.0, 1.0", "5.0, 1.0", "5.0, 2.0", "5.0, 6.0"]
        .map(|xy| format!("{xy}, {rest}"));
    assert_eq!(traverses(text), expected);
    let text = "G0 X5 Y6\nG30.1\nG10 L2 P1 X1 Y1\nG43.1 X1\nG0 X0 Y0\nG30";
    assert_eq!(traverses(text).last(), Some(&format!("3.0, 5.0, {rest}")));
}

#[test]
fn words_that_make_no_sense_are_refused() {
    let bad = [
        "G10",
        "G10 L2 X1",
        "G10 L2 P10 X1",
        "G10 L3 P1 X1",
        "G10 L2 P1.5",
        "G10 L20 P1 R1",
        "G10 L2 P1 I1",
        "G10 L0",
    ];
    for block in bad.into_iter().chain(["G52", "G92", "G92.1 X1", "G92 X1 G0 X1", "G10 L1 P1", "G92 @1"]) {
        assert_eq!(errors(&format!("{block}\nM2\n")).len(), 1, "{block}");
    }
}

fn offset_blocks() -> impl Strategy<Value = String> {
    let number = -20.0..20.0_f64;
    (0..10_usize, number.clone(), number.clone(), 1..=9_usize).prop_map(|(kind, x, y, system)| match kind {
        0 => format!("G10 L2 P{system} X{x:.3} Y{y:.3} R{:.3}", 7.0 * x),
        1 => format!("G10 L20 P{system} X{x:.3} Z{y:.3}"),
        2 => format!("G92 X{x:.3} A{y:.3}"),
        3 => format!("G52 Y{y:.3} Z{x:.3}"),
        4 => SYSTEMS[system - 1].into(),
        5 => format!("G43.1 X{x:.3} Y{y:.3} Z{x:.3}"),
        6 => "G92.1".into(),
        7 => "G92.2".into(),
        8 => "G92.3".into(),
        _ => "G49".into(),
    })
}

proptest! {
    #[test]
    fn no_offset_moves_the_machine(blocks in prop::collection::vec(offset_blocks(), 1..12)) {
        let where_it_is = "(debug,#<_abs_x> #<_abs_y> #<_abs_z> #<_abs_a>)";
        let text = format!("G0 X1 Y2 Z3 A4\n{}\n{where_it_is}", blocks.join("\n"));
        let text = messages(&text).concat();
        let numbers: Vec<f64> = text.split(' ').map(|number| number.parse().expect("a number")).collect();
        for (number, expected) in numbers.iter().zip([1.0, 2.0, 3.0, 4.0]) {
            prop_assert!((number - expected).abs() < 2e-6, "{text}");
        }
    }
}

#[test]
fn the_shift_of_g92_ends_with_the_program_where_the_machine_says_so() {
    let shift = |forgets_g92| {
        let options = Options { forgets_g92, ..Options::default() };
        let outcome = run(Program::from_text("test.ngc", "G0 X10\nG92 X4\nM2\n", &options));
        (outcome.program.parameter(5210), outcome.program.parameter(5211))
    };
    assert_eq!(shift(false), (Some(1.0), Some(6.0)));
    assert_eq!(shift(true), (Some(0.0), Some(0.0)));
}
