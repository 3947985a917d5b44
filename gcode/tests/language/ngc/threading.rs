//! G33, G33.1, G76.

use gcode::canon::{Degression, ThreadCycle};

use super::printed::{last_move, printed, refused, warned};
use super::recorded::messages;

const ON: &str = "G18 S100 M3\n";

/// What a program with a turning spindle sends, without the calls that start it.
fn calls(text: &str) -> Vec<String> {
    printed(&format!("{ON}{text}")).split_off(3)
}

fn cycle() -> ThreadCycle {
    ThreadCycle {
        from: [10.0, 0.0, 2.0, 0.0, 0.0, 0.0],
        end_z: -6.0,
        taper_x: 0.0,
        lead: 1.0,
        crest: -1.0,
        depth: 0.6,
        depth_is_told: true,
        degression: Degression { first: 0.2, exponent: 1.0, least: 0.0, finish: 0.0 },
        infeed_deg: 0.0,
        springs: 0,
        chamfer: 0.0,
        chamfer_in: false,
        chamfer_out: false,
        chamfer_yields: false,
        start_deg: 0.0,
    }
}

#[test]
fn q_is_the_angle_of_the_spindle_at_the_start_in_degrees() {
    for q in ["", " Q0", " Q180", " Q360"] {
        assert!(warned(&format!("{ON}G33 Z-1 K2{q}")).is_empty());
    }
    for wrong in ["Q-1", "Q361"] {
        refused(&format!("{ON}G33 Z-1 K2 {wrong}"), "bad-value", &["the angle of the spindle"]);
    }
    refused(&format!("{ON}G33.1 Z-1 K2 Q90"), "unused-word", &[]);
}

fn depths(degression: Degression, springs: u32) -> Vec<f64> {
    let cycle = ThreadCycle { degression, springs, ..cycle() };
    cycle.depths().map(|depth| (depth * 1e4).round() / 1e4).collect()
}

#[test]
fn g33_follows_the_spindle_along_its_way() {
    assert_eq!(
        calls("G33 Z-10 K1.5\nX3 Z-12 K2"),
        [
            "START_SPEED_FEED_SYNC 1.5,0".replace(',', " "),
            "STRAIGHT_FEED 0 0 -10".into(),
            "STOP_SPEED_FEED_SYNCH".into(),
            "START_SPEED_FEED_SYNC 2 0".into(),
            "STRAIGHT_FEED 3 0 -12".into(),
            "STOP_SPEED_FEED_SYNCH".into(),
        ]
    );
}

#[test]
fn g33_1_returns_to_where_it_began() {
    let text = "G0 Z5\nG33.1 Z-3 K1 I2\n(debug,#<_z>)";
    assert!(printed(&format!("{ON}{text}")).contains(&"RIGID_TAP 0 0 -3".to_owned()));
    assert_eq!(messages(&format!("{ON}{text}")), ["5.000000"]);
    assert_eq!(warned(&format!("{ON}G33.1 Z-3 K1 I.5")), ["no-effect"]);
    refused(&format!("{ON}G33.1 Z-3 A1 K1"), "unused-word", &["A"]);
}

#[test]
fn threads_need_a_spindle_a_lead_and_no_feed() {
    for code in ["G33 Z-1 K1", "G33.1 Z-1 K1", "G76 Z-1 P1 I-1 J.1 K.5"] {
        refused(&format!("G18\n{code}"), "spindle-not-turning", &[]);
        assert_eq!(warned(&format!("G18 G96 D1000 S100 M3\n{code}")), ["constant-surface-thread"]);
    }
    refused(&format!("{ON}G33 Z-1"), "missing-word", &["K"]);
    refused(&format!("{ON}G33 Z-1 K0"), "bad-value", &["K0"]);
    refused(&format!("{ON}G33 K1"), "missing-word", &["G33"]);
    refused(&format!("{ON}G33 Z-1 K1 F1"), "feed-in-thread", &[]);
    refused(&format!("{ON}G33 Z-1 K1 E1"), "unused-word", &[]);
}

#[test]
fn g76_cuts_pass_after_pass() {
    let pass = |clear: &str, depth: &str| {
        let lines = [
            format!("STRAIGHT_TRAVERSE {clear} 0 2"),
            format!("STRAIGHT_TRAVERSE {depth} 0 2"),
            "DISABLE_FEED_OVERRIDE".into(),
            "START_SPEED_FEED_SYNC 1 0".into(),
            format!("STRAIGHT_FEED {depth} 0 -6"),
            "STOP_SPEED_FEED_SYNCH".into(),
            format!("STRAIGHT_TRAVERSE {clear} 0 -6"),
            "ENABLE_FEED_OVERRIDE".into(),
        ];
        lines.to_vec()
    };
    let ends = [vec!["STRAIGHT_TRAVERSE 10 0 2".to_owned()], vec!["STRAIGHT_TRAVERSE 10 0 -6".to_owned()]];
    let outside =
        [&ends[0][..], &pass("10.35", "8.75"), &pass("10.1", "8.5"), &pass("10", "8.4"), &ends[1]].concat();
    assert_eq!(calls("G0 X10 Z2\nG76 P1 Z-6 I-1 J.25 K.6"), outside);
    let inside =
        [&ends[0][..], &pass("9.65", "11.25"), &pass("10", "11.6"), &pass("10", "11.6"), &ends[1]].concat();
    assert_eq!(calls("G0 X10 Z2\nG76 P1 Z-6 I1 J.25 K.6 R1.2 H1").len(), inside.len() + 8);
    assert_eq!(calls("G7 G0 X20 Z2\nG76 P1 Z-6 I-2 J.5 K1.2").split_off(1), outside);
    assert_eq!(calls("G0 X10 Z2\nG91 G76 P1 Z-8 I-1 J.25 K.6").split_off(2), outside.split_at(1).1);
    assert_eq!(last_move(&format!("{ON}G0 X10 Z2\nG76 P1 Z-6 I-1 J.25 K.6\nG1 X1 F1")), "G1 1 0 -6");
}

#[test]
fn depths_grow_by_the_root_and_end_at_full_depth() {
    let even = Degression { first: 0.2, exponent: 1.0, least: 0.0, finish: 0.0 };
    assert_eq!(depths(even, 0), [0.2, 0.4, 0.6]);
    assert_eq!(depths(even, 2), [0.2, 0.4, 0.6, 0.6, 0.6]);
    let area = Degression { exponent: 2.0, ..even };
    assert_eq!(depths(area, 0), [0.2, 0.2828, 0.3464, 0.4, 0.4472, 0.4899, 0.5292, 0.5657, 0.6]);
    assert_eq!(depths(Degression { least: 0.1, ..area }, 0), [0.2, 0.3, 0.4, 0.5, 0.6]);
    assert_eq!(depths(Degression { finish: 0.05, ..even }, 1), [0.2, 0.4, 0.55, 0.6, 0.6]);
}

#[test]
fn infeed_and_chamfers_move_the_ends() {
    let text = "G0 X12 Z5\nG76 P2 Z-25 I-2 J.3 K1.2 Q30 E2 L3";
    let calls = calls(text);
    let passes: Vec<_> = calls.split(|call| call == "ENABLE_FEED_OVERRIDE").collect();
    assert_eq!(passes.len(), 5);
    // The last pass: K tan 30° = 0.6928 nearer to the end at its start, at the end at its end.
    assert_eq!(
        passes[3],
        [
            "STRAIGHT_TRAVERSE 12 0 4.3072",
            "DISABLE_FEED_OVERRIDE",
            "START_SPEED_FEED_SYNC 2.332381 0",
            "STRAIGHT_FEED 10 0 4.3072",
            "STRAIGHT_FEED 8.8 0 2.3072",
            "START_SPEED_FEED_SYNC 2 0",
            "STRAIGHT_FEED 8.8 0 -23",
            "START_SPEED_FEED_SYNC 2.332381 0",
            "STRAIGHT_FEED 10 0 -25",
            "STOP_SPEED_FEED_SYNCH",
            "STRAIGHT_TRAVERSE 12 0 -25",
        ]
    );
}

#[test]
fn a_tapered_thread_shifts_every_x() {
    let cycle = ThreadCycle { taper_x: 0.8, ..cycle() };
    let mut ends = Vec::new();
    let sent: Result<(), ()> = cycle.expand(&mut |call| {
        if let gcode::Call::StraightFeed(end) = call {
            ends.push(((end[0] * 1e4).round() / 1e4, end[2]));
        }
        Ok(())
    });
    assert!(sent.is_ok());
    assert_eq!(ends, [(9.6, -6.0), (9.4, -6.0), (9.2, -6.0)]);
    let mut count = 0;
    let stopped = cycle.expand(&mut |_| {
        count += 1;
        if count < 3 { Ok(()) } else { Err(count) }
    });
    assert_eq!((stopped, count), (Err(3), 3));
}

#[test]
fn g76_refuses_what_makes_no_thread() {
    let bad = [
        ("P1 Z-6 I0 J.2 K.6", "I0"),
        ("P1 Z-6 I-1 J0 K.6", "J0"),
        ("P1 Z-6 I-1 J.6 K.6", "J0.6"),
        ("P0 Z-6 I-1 J.2 K.6", "P0"),
        ("P1 Z-6 I-1 J.2 K.6 R.5", "R0.5"),
        ("P1 Z-6 I-1 J.2 K.6 R9", "10000"),
        ("P1 Z-6 I-1 J.2 K.6 H-1", "H-1"),
        ("P1 Z-6 I-1 J.2 K.6 H1.5", "H1.5"),
        ("P1 Z-6 I-1 J.2 K.6 Q90", "Q90"),
        ("P1 Z-6 I-1 J.2 K.6 L4 E1", "L4"),
        ("P1 Z-6 I-1 J.2 K.6 L3 E-1", "E-1"),
        ("P1 Z-6 I-1 J.2 K.6 L3 E5", "E5"),
        ("P1 Z2 I-1 J.2 K.6", "Z2"),
    ];
    for (words, part) in bad {
        refused(&format!("{ON}G0 X10 Z2\nG76 {words}"), "bad-value", &[part]);
    }
    refused(&format!("{ON}G76 P1 X1 Z-6 I-1 J.2 K.6"), "unused-word", &["X"]);
    refused(&format!("{ON}G17\nG76 P1 Z-6 I-1 J.2 K.6"), "not-available", &["G76"]);
    refused(&format!("{ON}G76 P1 Z-6 I-1 J.2"), "missing-word", &["K"]);
    assert_eq!(warned(&format!("{ON}G76 P1 Z-6 I-1 J.2 K.6 E1")), ["no-effect"]);
    assert_eq!(warned(&format!("{ON}G76 P1 Z-6 I-1 J.2 K.6 L1")), ["no-effect"]);
}
