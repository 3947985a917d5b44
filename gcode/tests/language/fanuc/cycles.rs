//! Cutting cycles.

use super::recorded::{errors, moves, outcome, sound};

#[test]
fn g90_turns_and_is_repeated() {
    let text = "S500 M03\nG00 X50. Z2.\nG90 X46. Z-30. F0.2\nX42.\nU-12. W-20.\nG00 X60.";
    assert_eq!(
        moves(text)[1..],
        [
            "G0 23 2",
            "G1 23 -30",
            "G1 25 -30",
            "G0 25 2", //
            "G0 21 2",
            "G1 21 -30",
            "G1 25 -30",
            "G0 25 2", //
            "G0 19 2",
            "G1 19 -18",
            "G1 25 -18",
            "G0 25 2", //
            "G0 30 2"
        ]
    );
}

#[test]
fn g90_and_g94_with_a_taper() {
    let text = "S500 M03\nG00 X50. Z2.\nG90 X40. Z-30. R-3. F0.2";
    assert_eq!(moves(text)[1..], ["G0 17 2", "G1 20 -30", "G1 25 -30", "G0 25 2"]);
    let text = "S500 M03\nG00 X50. Z2.\nG94 X20. Z-5. R-2. F0.2\nZ-8.";
    assert_eq!(moves(text)[1..5], ["G0 25 -7", "G1 10 -5", "G1 10 2", "G0 25 2"]);
    assert_eq!(moves(text)[5..], ["G0 25 -10", "G1 10 -8", "G1 10 2", "G0 25 2"]);
}

#[test]
fn a_block_without_words_does_not_repeat_the_cycle() {
    assert_eq!(moves("S500 M03\nG00 X50. Z2.\nG90 X46. Z-30. F0.2\nM08\nM09").len(), 5);
}

#[test]
fn g74_drills_in_pecks() {
    let text = "S500 M03\nG00 X0. Z2.\nG74 R1.\nG74 Z-10. Q5000 F0.1";
    assert_eq!(
        moves(text)[1..],
        ["G1 0 -3", "G0 0 -2", "G1 0 -8", "G0 0 -7", "G1 0 -10", "G0 0 2", "G0 0 2"]
    );
}

#[test]
fn g75_cuts_grooves_side_by_side() {
    let text = "S500 M03\nG00 X42. Z-10.\nG75 R0.5\nG75 X30. Z-14. P3000 Q3000 F0.08";
    let column = |z: &str| ["G1 18 ", "G0 18.5 ", "G1 15 ", "G0 21 "].map(|x| format!("{x}{z}"));
    let mut wanted = column("-10").to_vec();
    for z in ["-13", "-14"] {
        wanted.push(format!("G0 21 {z}"));
        wanted.extend(column(z));
    }
    wanted.push("G0 21 -10".into());
    assert_eq!(moves(text)[1..], wanted);
}

/// A control has what the first line says in a parameter.
#[test]
fn g74_and_g75_without_a_first_line_go_back_by_what_the_one_line_form_does() {
    let text = "S500 M03\nG00 X42. Z-10.\nG75 X30. Z-14. P3000 Q3000 F0.08\nM30\n";
    let found = outcome(text);
    let told: Vec<_> = found.warnings.iter().map(|one| (one.line, one.code)).collect();
    assert_eq!((found.errors.len(), told), (0, vec![(3, "no-first-line")]));
    let (first, second) = text.split_at(text.find("G75").expect("it has one"));
    assert_eq!(found.sink.moves, outcome(&format!("{first}G75 R0.1\n{second}")).sink.moves);
    assert!(outcome("S500 M03\nG00 X42. Z-10.\nG75 X30. F0.08\nM30\n").warnings.is_empty(), "no pecks");
}

#[test]
fn what_belongs_to_a_first_line_that_is_refused_is_not_blamed() {
    for first in ["G71 U0. R0.5", "G72 W-1. R0.5", "G73 U3. W1."] {
        let code = &first[..3];
        let text = format!("S500 M03\nG00 X42. Z2.\n{first}\n{code} P10 Q50 U1. W0.2 F0.3\n{SHAFT}G00 X60.");
        assert_eq!(errors(&text), [(3, "bad-value")], "{first}");
        let again = format!("{text}\nG71 U4. R1.\nG71 P10 Q50 U1. F0.3\nG71 U0.\nG71 P10 Q50\nG72 P10 Q50");
        // The last one that was refused is that of G71 then.
        assert_eq!(errors(&again), [(3, "bad-value"), (13, "bad-value"), (15, "missing-word")], "{first}");
    }
}

/// A stepped shaft: 20 to Z-10, 30 to Z-20.
const SHAFT: &str = "N10 G00 X20.\nN20 G01 Z-10. F0.1\nN30 X30.\nN40 Z-20.\nN50 X42.\n";

#[test]
fn g71_roughs_from_outside_in_and_follows_the_contour() {
    let text = format!("S500 M03\nG00 X42. Z2.\nG71 U4. R1.\nG71 P10 Q50 U1. W0.2 F0.3\n{SHAFT}G00 X60.");
    let moves = moves(&text);
    // allowances 0.5 and 0.2; passes at 21.5 - 4 n
    assert_eq!(moves[1], "G0 21.5 2.2");
    assert_eq!(moves[2], "G0 17.5 2.2");
    assert!(moves.contains(&"G1 17.5 -19.8".into()), "{moves:?}");
    assert!(moves.contains(&"G1 13.5 -9.8".into()), "{moves:?}");
    let last: Vec<&str> = moves.iter().rev().take(9).rev().map(String::as_str).collect();
    assert!(last.contains(&"G1 15.5 -19.8"), "{last:?}");
    assert_eq!(moves[moves.len() - 2..], ["G0 21 2", "G0 30 2"]);
}

#[test]
fn roughing_leaves_the_allowance_everywhere() {
    let text = format!("S500 M03\nG00 X42. Z2.\nG71 U1.5 R0.5\nG71 P10 Q50 U0.6 W0.1 F0.3\n{SHAFT}");
    for call in moves(&text) {
        let mut words = call.split(' ').skip(1).map(|word| word.parse::<f64>().unwrap());
        let (x, z) = (words.next().unwrap(), words.next().unwrap());
        let surface = if z > -10.0 + 0.1 - 1e-9 { 10.0 } else { 15.0 };
        assert!(x > surface + 0.3 - 1e-4 || z > 2.0, "{call}");
    }
}

#[test]
fn g71_bores_from_inside_out() {
    let text = "S500 M03\nG00 X18. Z2.\nG71 U2. R0.5\nG71 P10 Q40 U-1. W0.1 F0.3\n\
                N10 G00 X40.\nN20 G01 Z-10. F0.1\nN30 X30.\nN40 Z-20.\n";
    let moves = moves(text);
    assert!(moves.contains(&"G1 14.5 -19.9".into()), "{moves:?}");
    assert!(moves.contains(&"G1 19.5 -9.9".into()), "{moves:?}");
}

#[test]
fn an_allowance_on_the_wrong_side_is_warned_of() {
    let text = format!("S500 M03\nG00 X42. Z2.\nG71 U4. R1.\nG71 P10 Q50 U-1. W0.2 F0.3\n{SHAFT}M30\n");
    let outcome = outcome(&text);
    assert!(outcome.errors.is_empty());
    assert_eq!(outcome.warnings[0].code, "allowance-sign");
}

#[test]
fn a_contour_may_stand_before_its_cycle() {
    let text = format!(
        "S500 M03\nG00 X42. Z2.\nGOTO 60\n{SHAFT}N60 G71 U4. R1.\nG71 P10 Q50 U1. W0.2 F0.3\nG00 X60."
    );
    let behind = format!("S500 M03\nG00 X42. Z2.\nG71 U4. R1.\nG71 P10 Q50 U1. W0.2 F0.3\n{SHAFT}G00 X60.");
    assert_eq!(moves(&text), moves(&behind));
}

#[test]
fn g72_faces() {
    let text = "S500 M03\nG00 X42. Z1.\nG72 W2. R0.5\nG72 P10 Q40 U0.4 W0.2 F0.3\n\
                N10 G00 Z-12.\nN20 G01 X30. F0.1\nN30 Z-6.\nN40 X10.\n";
    let moves = moves(text);
    assert!(moves.contains(&"G1 5.2 -5.8".into()), "{moves:?}");
    assert!(moves.contains(&"G1 15.2 -11.8".into()), "{moves:?}");
    assert_eq!(moves.last().unwrap(), "G0 21 1");
}

#[test]
fn g73_repeats_the_contour_from_farther_away() {
    let text = format!("S500 M03\nG00 X50. Z5.\nG73 U4. W2. R3\nG73 P10 Q50 U1. W0.5 F0.2\n{SHAFT}");
    let moves = moves(&text);
    let first: Vec<&String> =
        moves.iter().filter(|call| call.starts_with("G1") && call.contains(' ')).collect();
    // first way to the contour: 10 + 4 + 0.5; -10 + 2 + 0.5
    assert_eq!(first[0], "G1 14.5 -7.5");
    assert_eq!(first[4], "G1 12.5 -8.5");
    assert_eq!(first[8], "G1 10.5 -9.5");
    assert_eq!(moves.last().unwrap(), "G0 25 5");
}

#[test]
fn g70_finishes_with_the_feeds_of_the_contour() {
    let text = format!(
        "S500 M03\nG00 X42. Z2.\nG71 U4. R1.\nG71 P10 Q50 U1. W0.2 F0.3\n{SHAFT}G70 P10 Q50\nG00 X60."
    );
    let record = sound(&text);
    let end = record.moves.len();
    assert_eq!(
        record.moves[end - 7..],
        ["G0 10 2", "G1 10 -10", "G1 15 -10", "G1 15 -20", "G1 21 -20", "G0 21 2", "G0 30 2"]
    );
    assert!(record.others.contains(&"SetFeedRate(0.1)".to_owned()));
}

#[test]
fn contours_with_arcs_and_corners() {
    let text = "S500 M03\nG00 X42. Z2.\nG71 U3. R1.\nG71 P10 Q50 U0.4 W0.1 F0.3\n\
                N10 G00 X10. F0.1\nN20 G01 Z-5. ,R2.\nN30 X20. ,C1.\nN40 Z-10.\nG02 X30. Z-15. R5.\nN50 G01 X42.\nG70 P10 Q50";
    let moves = moves(text);
    assert!(moves.contains(&"G2 7 -5 c 7 -3".into()), "{moves:?}");
    assert!(moves.contains(&"G2 15 -15 c 15 -10".into()), "{moves:?}");
    assert!(moves.contains(&"G1 9 -5".into()) && moves.contains(&"G1 10 -6".into()), "{moves:?}");
}

#[test]
fn contours_with_variables() {
    let text = "S500 M03\n#1=20.\nG00 X42. Z2.\nG71 U4. R1.\nG71 P10 Q50 U0 W0 F0.3\n\
                N10 G00 X#1\n#2=-10.\nN20 G01 Z#2\nN50 X42.\nG04 U[-#2]";
    assert!(moves(text).contains(&"G1 10 -10".into()));
}

#[test]
fn cycles_that_make_no_sense_are_refused() {
    let errors = |text: &str| errors(&format!("S500 M03\nG00 X42. Z2.\n{text}"));
    assert_eq!(errors("G71 P10 Q20 U1. F0.3\nN10 G00 X20.\nN20 G01 Z-9."), [(3, "missing-word")]);
    assert_eq!(errors("G71 U2. R1.\nG71 P10 Q20 U1. F0.3"), [(4, "bad-contour")]);
    assert_eq!(errors("G71 U2. R1.\nG71 P10 Q20 F0.3\nN10 G00 X20.\nG01 Z-9."), [(4, "bad-contour")]);
    assert_eq!(
        errors("G71 U2. R1.\nG71 P10 Q20 F0.3\nN10 G00 X20.\nG01 Z-9.\nZ-5.\nN20 X42."),
        [(4, "bad-contour")]
    );
    assert_eq!(errors("G71 U2. R1.\nG71 P10 Q20 F0.3\nN10 G00 X20.\nM98 P1\nN20 X42."), [(6, "bad-contour")]);
    let contour = "N10 G00 X20.\nN20 G01 Z-9. F0.1\nN30 X42.";
    assert_eq!(errors(&format!("G71 U0.0001 R1.\nG71 P10 Q30 F0.3\n{contour}")), [(4, "bad-value")]);
    assert_eq!(errors(&format!("G71 U2. R1.\nG71 P10 Q30 R1. F0.3\n{contour}")), [(4, "unused-word")]);
    assert_eq!(errors("G71 U2. I1."), [(3, "unused-word")]);
    assert_eq!(errors(&format!("G71 P10 Q30 U1. D0 F0.3\n{contour}")), [(3, "bad-value")]);
    assert_eq!(errors(&format!("G73 P10 Q30 U1. D2. F0.3\n{contour}")), [(3, "unused-word")]);
    assert_eq!(errors("G75 X20. I1. Q1000 F0.1"), [(3, "unused-word")]);
    assert_eq!(errors("G75 X20. I-1. F0.1"), [(3, "bad-value")]);
    assert_eq!(errors("G74 R1.\nG74 Z-10. Q1.5 F0.1"), [(4, "bad-value")]);
    assert_eq!(errors("G90 X30. F0.2"), [(3, "missing-word")]);
}

/// Cycles in one block are those in two, with the retract that the first one would have told.
#[test]
fn cycles_in_one_block() {
    let two = format!("S500 M03\nG00 X42. Z2.\nG71 U2. R0.5\nG71 P10 Q50 U1. W0.2 F0.3\n{SHAFT}G00 X60.");
    let one = format!("S500 M03\nG00 X42. Z2.\nG71 P10 Q50 U1. W0.2 D2. F0.3\n{SHAFT}G00 X60.");
    assert_eq!(moves(&one), moves(&two));
    assert_eq!(moves(&one.replace("D2.", "D2000")), moves(&two), "as X without a point");
    let inch = |text: &str| text.replace("S500", "G20 S500");
    assert_eq!(moves(&inch(&one)), moves(&inch(&two).replace("R0.5", "R0.02")));
    // It says nothing of the blocks that follow.
    let later = two.replace("G00 X60.", "G71 P10 Q50 U1. W0.2 F0.3\n");
    assert_eq!(moves(&later), moves(&later.replacen("W0.2 F", "W0.2 D2. F", 1)));
    let face = "N10 G00 Z-20.\nN20 G01 X30. F0.1\nN30 Z-5.\nN40 X0.\n";
    let two = format!("S500 M03\nG00 X42. Z2.\nG72 W2. R0.5\nG72 P10 Q40 U1. W0.2 F0.3\n{face}");
    let one = two.replace("G72 W2. R0.5\nG72 P10 Q40 ", "G72 P10 Q40 D2. ");
    assert_eq!(moves(&one), moves(&two));
    for (two, one) in [
        ("G75 R0.1\nG75 X30. Z-14. P3000 Q3000 F0.08", "G75 X30. Z-14. I3. K3. F0.08"),
        ("G75 R0.1\nG75 X30. P3000 F0.08", "G75 X30. I3. F0.08"),
        ("G74 R0.1\nG74 Z-30. Q3000 F0.08", "G74 Z-30. K3. F0.08"),
        ("G74 R0.1\nG74 X30. Z-30. P2000 Q3000 R0.5 F0.08", "G74 X30. Z-30. I2. K3. R0.5 F0.08"),
    ] {
        let [two, one] = [two, one].map(|cycle| moves(&format!("S500 M03\nG00 X42. Z-10.\n{cycle}")));
        assert_eq!(one, two);
    }
}

/// A rapid that leads back behind a contour is no part of what is roughed.
#[test]
fn the_way_back_behind_a_contour_is_not_roughed() {
    let start = "S500 M03\nG00 X42. Z2.\nG71 U4. R1.\nG71 P10 Q60 U1. W0.2 F0.3\n";
    let contour = SHAFT.replace("N50", "G01");
    let plain = format!("{start}{}", contour.replace("G01 X42.", "N60 X42."));
    let back = format!("{start}{contour}N60 G00 Z0.1\n");
    assert_eq!(moves(&back), moves(&plain));
    let cut = format!("{start}{contour}N60 G01 Z0.1\n");
    assert_eq!(errors(&cut).last().map(|(_, code)| *code), Some("bad-contour"));
    let on = format!("{start}{contour}N60 G00 X44.\n");
    let reach =
        |text: &str| moves(text).iter().any(|one| one.starts_with("G1 22.5 ") || one.starts_with("G1 22 "));
    assert!(!reach(&plain) && reach(&on), "a rapid that goes on is a part of it: {:?}", moves(&on));
}

#[test]
fn g28_alone_sends_both_axes_home() {
    let start = "S500 M03\nG00 X42. Z2.\n";
    assert_eq!(moves(&format!("{start}G28")), moves(&format!("{start}G28 U0. W0.")));
    assert_eq!(moves(&format!("{start}G30")), moves(&format!("{start}G30 U0. W0.")));
}

/// The line to mend is that of the cycle, not one that stands behind the contour.
#[test]
fn p_and_q_that_name_no_contour_are_told_at_the_cycle() {
    let contour = "N10 G00 X20.\nN20 G01 Z-5. F0.2\nG00 X60.\n";
    for (cycle, line, says) in [
        ("G71 U1. R0.5\nG71 P10 Q99 U0.2 F0.2\n", 4, "no block has N99 behind N10"),
        ("G70 P20 Q10\n", 3, "no block has N10 behind N20"),
        ("G71 U1. R0.5\nG71 P15 Q20 U0.2 F0.2\n", 4, "no block of this program has N15"),
    ] {
        let found = outcome(&format!("G97 S800 M03\nG00 X50. Z2.\n{cycle}{contour}G70 P10 Q20\nM30\n"));
        let said: Vec<_> = found.errors.iter().map(|one| (one.line, one.code)).collect();
        assert_eq!(said, [(line, "bad-contour")], "{cycle}");
        assert!(found.errors[0].message.contains(says), "{}", found.errors[0].message);
    }
}
