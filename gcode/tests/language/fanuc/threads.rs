//! Threads: the same as in the other dialect.

use super::recorded::{errors, linuxcnc, moves};

const START: &str = "G97 S600 M03\nG00 X22. Z8.\n";
const THERE: &str = "G97 S600 M3\nG0 X22 Z8\n";

fn here(text: &str) -> Vec<String> {
    moves(&format!("{START}{text}"))
}

fn there(text: &str) -> Vec<String> {
    linuxcnc(&format!("{THERE}{text}"))
}

#[test]
fn g32_is_g33() {
    let straight = here("G00 X19.\nG32 Z-20. F2.\nG00 X22.");
    assert_eq!(straight, there("G0 X19\nG33 Z-20 K2\nG0 X22"));
    assert_eq!(straight[1..5], ["G0 9.5 8", "lead 2 at 0", "G1 9.5 -20", "free"]);
}

#[test]
fn g32_takes_the_lead_along_the_longer_way() {
    // 10 mm in X (radius 5), 28 in Z: the way is longer than Z by its slope
    let lead = 2.0 * ((28.0_f64 * 28.0 + 5.0 * 5.0).sqrt() / 28.0);
    assert_eq!(here("G32 X32. Z-20. F2."), there(&format!("G33 X32 Z-20 K{lead:.17}")));
    assert_eq!(here("G32 X2. F1.5"), there("G33 X2 K1.5"));
}

/// F is the lead where it begins, K by how much it grows in a turn, both along the longer way; every block
/// says both.
#[test]
fn g34_is_g32_with_a_lead_that_grows() {
    let moves = here("G34 Z-20. F2. K0.1 Q90000\nG34 Z-30. F3. K-0.1");
    assert_eq!(moves[1..4], ["lead 2 at 90 growing by 0.1", "G1 11 -20", "free"]);
    assert_eq!(moves[4..], ["lead 3 at 0 growing by -0.1", "G1 11 -30", "free"]);
    let stretch = (28.0_f64 * 28.0 + 5.0 * 5.0).sqrt() / 28.0;
    let cone = here("G34 X32. Z-20. F2. K0.1");
    assert_eq!(cone[1], format!("lead {:.4} at 0 growing by {:.4}", 2.0 * stretch, 0.1 * stretch));
}

/// The arc is that of G02 and G03, by its centre or its radius; F is the lead.
#[test]
fn g35_and_g36_are_threads_along_the_arcs_of_g02_and_g03() {
    for words in ["X22. Z-20. R50.", "X22. Z-20. I48. K-14.", "U2. W-28. R60."] {
        for (thread, arc) in [("G35", "G02"), ("G36", "G03")] {
            let moves = here(&format!("{thread} {words} F2. Q90000"));
            assert_eq!(moves[1], "lead 2 at 90");
            assert_eq!(moves[2], here(&format!("{arc} {words} F2."))[1], "{thread} {words}");
            assert_eq!(moves[3..], ["free"]);
        }
    }
}

#[test]
fn chained_threads_keep_the_lead_and_q_turns_the_start() {
    let moves = here("G32 Z-10. F2. Q180000\nX24. Z-12.");
    assert_eq!(moves[1..4], ["lead 2 at 180", "G1 11 -10", "free"]);
    assert_eq!(moves[5..], ["G1 12 -12", "free"]);
}

#[test]
fn g76_in_two_lines_is_g76() {
    let fanuc = here("G76 P011060 Q0 R0\nG76 X17.546 Z-22. P1227 Q350 F2.");
    // one spring: the finishing pass
    let same = there("G76 P2 Z-22 I-2 J0.7 K2.454 R2 Q30 H1 E2 L2");
    assert_eq!(fanuc[1], same[1].replace("chamfer_yields: false", "chamfer_yields: true"));
    assert_ne!(fanuc[1], same[1], "where X cannot make the taper one yields, the other is an error");
    assert_eq!(fanuc[2], "G0 11 8", "and it goes back to its start");
}

#[test]
fn g76_in_one_line_is_g76() {
    let fanuc = here("G76 X17.546 Z-22. K1.227 D0350 A60 F2. P1");
    assert_eq!(fanuc[1], there("G76 P2 Z-22 I-2 J0.7 K2.454 R2 Q30")[1]);
    let fanuc = here("G76 X17.546 Z-22. K1.227 D0.35 A0 F2. P3");
    assert_eq!(fanuc[1], there("G76 P2 Z-22 I-2 J0.7 K2.454 R1")[1]);
}

#[test]
fn g76_keeps_least_cut_finish_and_number_of_finishing_passes() {
    let thread = &here("G76 P021055 Q50 R0.1\nG76 X17.546 Z-22. P1227 Q350 F2.")[1];
    for part in
        ["least: 0.05", "finish: 0.1", "exponent: 2.0", "springs: 1", "infeed_deg: 27.5", "chamfer: 2.0"]
    {
        assert!(thread.contains(part), "{part} in {thread}");
    }
}

#[test]
fn depths_follow_the_square_root_with_a_least_cut() {
    use gcode::canon::{Degression, ThreadCycle};
    let cycle = ThreadCycle {
        from: [11.0, 0.0, 8.0, 0.0, 0.0, 0.0],
        end_z: -22.0,
        taper_x: 0.0,
        lead: 2.0,
        crest: -1.0,
        depth: 1.0,
        depth_is_told: true,
        degression: Degression { first: 0.4, exponent: 2.0, least: 0.12, finish: 0.1 },
        infeed_deg: 30.0,
        springs: 1,
        chamfer: 0.0,
        chamfer_in: false,
        chamfer_out: false,
        chamfer_yields: true,
        start_deg: 0.0,
    };
    let depths: Vec<f64> = cycle.depths().map(|depth| (depth * 1e4).round() / 1e4).collect();
    // 0.4 √n grows by 0.1657, 0.1271, then 0.1072 < 0.12
    assert_eq!(depths, [0.4, 0.5657, 0.6928, 0.8128, 0.9, 1.0, 1.0]);
}

#[test]
fn tapered_and_internal_threads() {
    let thread = &here("G76 P010060 Q0 R0\nG76 X18. Z-22. R-1. P1000 Q400 F2.")[1];
    assert!(thread.contains("taper_x: 1.0") && thread.contains("crest: -2.0"), "{thread}");
    let thread = &moves("G97 S600 M03\nG00 X16. Z8.\nG76 P010060 Q0 R0\nG76 X20. Z-22. P1000 Q400 F2.")[1];
    assert!(thread.contains("crest: 1.0"), "{thread}");
}

#[test]
fn the_first_line_stays() {
    let twice = here("G76 P011060 Q0 R0\nG76 X17.546 Z-22. P1227 Q350 F2.\nG76 X17.546 Z-22. P1227 Q350");
    assert_eq!(twice[1], twice[3]);
}

#[test]
fn g92_is_repeated_while_x_changes() {
    let moves = here("G92 X19.3 Z-20. F2.\nX18.9\nX18.6\nG00 X40.");
    let threads: Vec<&String> = moves.iter().filter(|call| call.starts_with("ThreadCycle")).collect();
    assert_eq!(threads.len(), 3);
    assert!(threads.iter().all(|thread| thread.contains("end_z: -20.0") && thread.contains("chamfer: 2.0")));
    assert_eq!(moves[2], "G0 11 8");
    assert_eq!(moves.last().unwrap(), "G0 20 8");
}

#[test]
fn g92_goes_to_its_x_with_start_angle_and_taper() {
    let thread = &here("G92 X19. Z-20. R-0.5 F2. Q90000")[1];
    assert!(thread.contains("start_deg: 90.0") && thread.contains("taper_x: 0.5"), "{thread}");
    // X 9.5 at the end, 9 at the start: 2 in from 11; half of it is the height
    assert!(thread.contains("crest: -1.0") && thread.contains("depth: 1.0"), "{thread}");
}

#[test]
fn the_start_angle_holds_for_its_block_alone() {
    let moves = here("G92 X19. Z-20. F2. Q90000\nX18.6\nX18.2 Q90000");
    let starts: Vec<bool> = moves
        .iter()
        .filter(|call| call.starts_with("Th"))
        .map(|call| call.contains("start_deg: 90.0"))
        .collect();
    assert_eq!(starts, [true, false, true]);
}

#[test]
fn threads_that_make_no_sense_are_refused() {
    let errors = |text: &str| errors(&format!("{START}{text}"));
    assert_eq!(errors("G32 Z-20."), [(3, "missing-word")]);
    assert_eq!(errors("G32 F2."), [(3, "bad-value")]);
    assert_eq!(errors("G32 Z-20. F2. Q400000"), [(3, "bad-value")]);
    assert_eq!(errors("G76 X18. Z-20. P900 Q300 F2."), [(3, "missing-word")]);
    assert_eq!(errors("G76 P011060 Q0 R0\nG76 X18. Z-20. P900 Q0.3 F2."), [(4, "bad-value")]);
    assert_eq!(errors("G76 P011045 Q0 R0"), [(3, "bad-value")]);
    assert_eq!(errors("G76 P011060 Q0 R0\nG76 X21. Z-20. P900 Q300 F2."), [(4, "bad-value")]);
    assert_eq!(errors("G76 X18. Z-20. K0.9 D300 A60 F2. P2"), [(3, "not-available")]);
    assert_eq!(errors("M05\nG32 Z-20. F2."), [(4, "spindle-not-turning")]);
    assert_eq!(errors("G34 Z-20. F2."), [(3, "missing-word")]);
    assert_eq!(errors("G32 Z-5. F2.\nG34 Z-20. K0.1"), [(4, "missing-word")]);
    assert_eq!(errors("G34 F2. K0.1"), [(3, "bad-value")]);
    assert_eq!(errors("G34 Z-20. F-2. K0.1"), [(3, "bad-value")]);
    assert_eq!(errors("M05\nG34 Z-20. F2. K0.1"), [(4, "spindle-not-turning")]);
    assert_eq!(errors("G35 X22. Z-20. F2."), [(3, "missing-word")]);
    assert_eq!(errors("G35 X22. Z-20. R50."), [(3, "missing-word")]);
    assert_eq!(errors("G36 X22. F2."), [(3, "not-available")]);
    assert_eq!(errors("G35 X22. Z-20. R-50. F2."), [(3, "bad-value")]);
    assert_eq!(errors("G35 X22. Z-20. R5. F2."), [(3, "arc-radius")]);
    assert_eq!(errors("M05\nG35 X22. Z-20. R50. F2."), [(4, "spindle-not-turning")]);
}
