//! What of a block takes effect before what.

use super::recorded::{errors, fanuc, moves, outcome, sound};
use gcode::Program;

/// What is said to the machine about feeds.
fn feeds(text: &str) -> Vec<String> {
    let others = sound(text).others;
    others.into_iter().filter(|call| call.starts_with("SetFeedRate")).collect()
}

#[test]
fn incremental_words_count_from_the_point_in_the_new_units() {
    // 50.8 mm are a radius of 1 inch
    let start = "S500 M03\nG00 X50.8 Z25.4\n";
    let inches = |text: &str| moves(&format!("{start}{text}"))[1..].to_vec();
    assert_eq!(inches("G20 G28 U0 W0"), ["G0 1 1", "G0 0 0"]);
    assert_eq!(inches("G20 G00 U1. W-.5"), ["G0 1.5 0.5"]);
    assert_eq!(inches("G20 G01 U1. F.01"), ["G1 1.5 1"]);
    assert_eq!(inches("G20 G50 U1.\nG00 W1."), ["G0 1.5 2"]);
    assert_eq!(inches("G20 G32 W-1. F.1"), ["lead 0.1 at 0", "G1 1 0", "free"]);
}

#[test]
fn incremental_words_count_from_the_point_in_the_new_coordinate_system() {
    let start = "S500 M03\nG10 L2 P2 X20. Z-5.\nG00 X50. Z2.\n";
    let shifted = |text: &str| moves(&format!("{start}{text}"))[1..].to_vec();
    assert_eq!(shifted("G55 G00 U0 W1."), ["G0 15 8"]);
    assert_eq!(shifted("G55\nG00 U0 W1."), ["G0 15 8"]);
    assert_eq!(shifted("G55 G28 U0"), ["G0 15 7", "G0 -10 7"]);
}

#[test]
fn the_feed_of_a_block_is_in_its_units() {
    assert_eq!(feeds("G20 F.01"), feeds("G20\nF.01"));
    assert_eq!(feeds("G20 F.01")[0], "SetFeedRate(0.01)");
    let outcome = outcome("S500 M03\nG00 X10. Z0\nG20 G01 Z-1. F.01\n#1=#4109\nG04 U[#1*100.]\nM30\n");
    assert!(outcome.errors.is_empty(), "{:?}", outcome.errors);
    assert_eq!(outcome.sink.moves.last().unwrap(), "dwell 1");
}

#[test]
fn words_in_force_are_the_same_lengths_in_other_units() {
    // the lead of a thread
    let thread = moves("S500 M03\nG00 X10. Z0\nG32 Z-5. F2.54\nG20\nG32 W-.1");
    assert_eq!(thread[4], "lead 0.1 at 0");
    // the corner of a cycle and its taper
    let cycle = moves("S500 M03\nG00 X50.8 Z25.4\nG90 X25.4 Z0 R-2.54 F.1\nG20\nU-.2");
    assert_eq!(cycle[5..], ["G0 0.8 1", "G1 0.9 0", "G1 1 0", "G0 1 1"]);
    // how far a peck goes back
    let pecks = moves("S500 M03\nG00 X0 Z0\nG74 R2.54\nG20\nG74 Z-1. Q5000 F.01");
    assert_eq!(pecks[1..4], ["G1 0 -0.5", "G0 0 -0.4", "G1 0 -1"]);
    // depth of cut and retract
    let contour = "N1 G00 X1.\nN2 G01 Z-1.";
    let rough = |first: &str, units: &str| {
        moves(&format!("S500 M03\n{first}\n{units}G00 X2. Z.1\nG71 P1 Q2 F.01\n{contour}"))
    };
    assert_eq!(rough("G71 U2.54 R.254", "G20\n"), rough("G20\nG71 U.1 R.01", ""));
    let repeated = |first: &str, units: &str| {
        moves(&format!("S500 M03\n{first}\n{units}G00 X2. Z.1\nG73 P1 Q2 F.01\n{contour}"))
    };
    assert_eq!(repeated("G73 U2.54 W2.54 R3", "G20\n"), repeated("G20\nG73 U.1 W.1 R3", ""));
    // the first line of a thread
    let threads = |first: &str, units: &str| {
        let cycle = "G00 X1.2 Z.1\nG76 X.9 Z-1. P500 Q100 F.1";
        moves(&format!("S500 M03\n{first}\n{units}{cycle}"))
    };
    assert_eq!(threads("G76 P021060 Q254 R.0254", "G20\n"), threads("G20\nG76 P021060 Q100 R.001", ""));
}

#[test]
fn a_surface_speed_is_not_taken_over_into_other_units() {
    let start = "G50 S2000\nG96 S200 M03\nG97 S500\n";
    assert_eq!(errors(&format!("{start}G96")), []);
    assert_eq!(errors(&format!("{start}G20\nG96")), [(5, "missing-word")]);
}

#[test]
fn tool_units_and_coordinates_stay_until_a_corner_is_closed() {
    let errors = |last: &str| errors(&format!("S500 M03 F0.1\nG00 X20. Z0.\nG01 Z-20. ,C2.\n{last}"));
    assert_eq!(errors("X40."), []);
    assert_eq!(errors("X40. T0101"), [(4, "bad-corner")]);
    assert_eq!(errors("G20 X40."), [(4, "bad-corner")]);
    assert_eq!(errors("G55 X40."), [(4, "bad-corner")]);
    assert_eq!(errors("#3006=1 (LOOK)\nX40."), [(3, "bad-corner")]);
}

#[test]
fn nothing_acts_at_the_end_of_a_move_that_becomes_a_corner() {
    let start = "S500 M03 F0.1\nG00 X20. Z0.\n";
    for code in ["M05", "M09", "M00", "M30"] {
        for corner in [",C2.", ",R2."] {
            let errors = errors(&format!("{start}G01 Z-20. {corner} {code}\nX40."));
            assert_eq!(errors[0], (3, "bad-corner"), "{code} {corner}");
        }
    }
    // in the next block it acts after both moves
    assert_eq!(moves(&format!("{start}G01 Z-20. ,C2.\nX40. M05")).len(), 4);
}

#[test]
fn shared_variables_come_from_the_options_and_are_there_afterwards() {
    let mut options = fanuc();
    options.parameters = vec![(500, 2.5), (501, 7.0), (5221, 3.0)];
    let mut program = Program::from_text("O1", "#502=#500+1.\n#501=#0\nM30\n", &options);
    let mut record = super::recorded::Record::default();
    while !matches!(program.step(&mut record), Ok(gcode::Step::Ended)) {}
    let values = [500, 501, 502, 100, 5221].map(|number| program.parameter(number));
    assert_eq!(values, [Some(2.5), None, Some(3.5), None, Some(3.0)]);
    let other = Program::from_text(
        "test.ngc",
        "",
        &gcode::Options { parameters: options.parameters, ..Default::default() },
    );
    assert_eq!(other.parameter(501), Some(7.0));
}
