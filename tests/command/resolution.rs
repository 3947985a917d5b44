//! `pitchlock resolution`: what is needed follows from the limits, verdicts follow from what there is, what
//! is wrong is refused with a remedy, and what its documentation shows is what it prints.

use std::fs;

use crate::shop::{Place, project};
use machine::{SMALL_LATHE, SMALL_MILL};
use serde_json::Value;

fn found(place: &Place, arguments: &[&str]) -> Value {
    let answer = place.ask(&[&["resolution", "--json"], arguments].concat());
    assert_eq!(answer.status, Some(0), "{arguments:?}: {}", answer.stderr);
    serde_json::from_str(&answer.stdout).expect("one document and nothing else")
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("a number, not {value}"))
}

fn list(value: &Value) -> &Vec<Value> {
    value.as_array().unwrap_or_else(|| panic!("a list, not {value}"))
}

/// Steps and orders of the four quantities of the first axis.
fn steps(document: &Value) -> Vec<(f64, i64)> {
    let quantities = list(&document["axes"][0]["quantities"]).iter();
    quantities.map(|q| (number(&q["step"]), q["order"].as_i64().expect("a whole number"))).collect()
}

fn near(got: f64, want: f64) -> bool {
    (got / want - 1.0).abs() < 1e-9
}

/// The published examples, with the order rounded so that it is never coarser than what is needed: 30 m/min
/// at 2.5 kHz then need 1e-6 mm and not 1e-5.
#[test]
fn published_motions_need_what_is_published() {
    let place = Place::new();
    let cases: [(&str, [f64; 4], [i64; 4]); 3] = [
        (
            "--grade IT7 --size 18 --feed 30000 --acceleration 1.962 --jerk 1 --cycle 2500",
            [1.8e-3, 2e-5 / 3.0, 3.1392e-7, 6.4e-10],
            [-3, -6, -7, -10],
        ),
        // Of no reference file: other cycles, tolerances and steps, worked by hand.
        (
            "--tolerance 4 --feed 1200 --acceleration 8 --jerk 400 --cycle 4000 --k-f 1e4",
            [4e-4, 5e-7, 5e-7, 6.25e-8],
            [-4, -7, -7, -8],
        ),
        (
            "--grade IT01 --size 2 --feed 60 --acceleration 0.5 --jerk 2 --cycle 100 --k-m 3 --k-a 2000 --k-j 1000",
            [1e-4, 1e-6 / 3.0, 2.5e-5, 2e-6],
            [-4, -7, -5, -6],
        ),
    ];
    for (line, want, orders) in cases {
        let arguments: Vec<&str> = line.split(' ').collect();
        let got = steps(&found(&place, &arguments));
        for ((step, order), (want, wanted)) in got.into_iter().zip(want.into_iter().zip(orders)) {
            assert!(near(step, want) && order == wanted, "{line}: {step} 1e{order} for {want} 1e{wanted}");
        }
    }
}

/// M29 and M34 at the cases of the source, with counts of 1 µm and 0.1 µm.
#[test]
fn a_motion_is_seen_in_counts() {
    let place = Place::new();
    let motion = ["--feed", "20000", "--acceleration", "19.62", "--jerk", "5", "--cycle", "1000"];
    for (counts, per_mm) in [("1000", 1e3), ("10000", 1e4)] {
        let document = found(&place, &[&motion[..], &["--counts", counts]].concat());
        let quantities = list(&document["axes"][0]["quantities"]);
        assert!(quantities[0]["internal"].is_null());
        for (quantity, internal) in quantities[1..].iter().zip([1.0 / 3.0, 0.01962, 5e-6]) {
            assert!(near(number(&quantity["internal"]), internal * per_mm), "{quantity}");
            assert!(
                near(number(&quantity["discrepancy"]) * number(&quantity["step"]), 1.0 / per_mm),
                "{quantity}"
            );
        }
        assert_eq!(document["fine"], false);
        let answers = list(&document["verdicts"]);
        let coarse = answers.iter().filter(|answer| answer["fine"] == false);
        assert!(
            coarse
                .clone()
                .all(|answer| answer["remedy"].as_str().is_some_and(|text| text.contains("law of motion")))
        );
        assert_eq!(coarse.count(), 3, "speed, acceleration, jerk by differences");
    }
}

#[test]
fn the_built_in_machine_is_fine_and_a_coarse_one_is_not() {
    let place = Place::new();
    let fine = found(&place, &[]);
    assert_eq!((&fine["fine"], &fine["tolerance"]["um"]), (&true.into(), &25.0.into()));
    assert!(list(&fine["verdicts"]).iter().all(|answer| answer["remedy"].is_null()));

    let coarse = SMALL_LATHE
        .replacen("encoder_counts = 131072 ", "encoder_counts = 1000 ", 1)
        .replacen("# feedforward = \"full\" ", "feedforward = \"difference-va\" # ", 1)
        .replace("encoder_lines = 2500", "encoder_lines = 250");
    place.write("coarse.toml", coarse);
    let answer = place.ask(&["resolution", "--machine", "coarse.toml"]);
    assert_eq!(answer.status, Some(0), "{}", answer.stderr);
    for words in [
        // 5 mm by 1000 counts, against a tenth of 12.5 µm: the tolerance is one of the diameter.
        "X: count of the encoder: 4 times too coarse; an encoder of 4000 counts a turn or more (axis.x.encoder_counts)",
        // 1 µm over two cycles, against 9000 mm/min in 3e4 steps at 2 kHz; over four against 2 m/s² in 1000.
        "X: speed by differences: 200 times too coarse; axis.x.feedforward = \"full\"",
        "X: acceleration by differences: 500 times too coarse; axis.x.feedforward = \"full\"",
        // 5 mm by 4 · 250 counts.
        "spindle: count of its encoder at a lead of 5 mm: 2 times too coarse; an encoder of 500 lines",
        "leads up to 2.5 mm",
        "positions of X do for tolerances of 100 µm and more, IT10 at 50 mm",
    ] {
        assert!(answer.stdout.contains(words), "{words}:\n{}", answer.stdout);
    }
    // What was proposed is fine.
    let text = fs::read_to_string(place.at("coarse.toml")).expect("it was written");
    let better = text
        .replacen("encoder_counts = 1000 ", "encoder_counts = 4000 ", 1)
        .replace("difference-va", "full")
        .replace("encoder_lines = 250", "encoder_lines = 500");
    place.write("better.toml", better);
    assert_eq!(found(&place, &["--machine", "better.toml"])["fine"], true);
}

#[test]
fn a_scale_stands_in_for_the_encoder() {
    let place = Place::new();
    place
        .write("scale.toml", SMALL_LATHE.replacen("# scale_step_mm = 0.0001 ", "scale_step_mm = 0.0001 ", 1));
    let arguments = ["--machine", "scale.toml", "--tolerance", "0.9"];
    let document = found(&place, &arguments);
    let answers = list(&document["verdicts"]);
    let scale = answers.iter().find(|answer| answer["what"] == "X: step of the scale").expect("a scale");
    assert_eq!((&scale["has"], &scale["fine"]), (&1e-4.into(), &false.into()));
    assert_eq!(scale["remedy"], "a scale of 1e-5 mm (axis.x.scale_step_mm)");
    assert!(answers.iter().all(|answer| answer["what"] != "X: count of the encoder"));
    assert!(answers.iter().any(|answer| answer["what"] == "Z: count of the encoder"));
}

/// 12.5 µm of X in ten steps are 1.25 µm, 25 µm of Z 2.5 µm: lost motion and screw within that do not count,
/// beyond it they do, however fine the count is; a scale sees both.
#[test]
fn lost_motion_and_screws_are_named_beside_the_count() {
    let place = Place::new();
    let worn = |backlash: &str, rows: &str, more: &str| {
        let text = SMALL_LATHE
            .replacen("[axis.x]\n", &format!("[axis.x]\nbacklash_mm = {backlash}\n{more}"), 1)
            .replacen("[[-400.0, -19.0], [200.0, 10.0]]", rows, 1);
        place.write("worn.toml", text);
        let text = place.ask(&["resolution", "--machine", "worn.toml"]).stdout;
        (text, list(&found(&place, &["--machine", "worn.toml"])["unseen"]).clone())
    };
    let (text, unseen) = worn("0.0012", "[[-90, 1.0], [-80, -1.4]]", "");
    let named: Vec<_> = unseen.iter().map(|one| (&one["axis"], &one["what"], &one["limits"])).collect();
    assert_eq!(
        named,
        [(&"x".into(), &"lost motion".into(), &false.into()), (&"z".into(), &"screw".into(), &false.into())]
    );
    assert!(text.contains("\neverything is fine enough\npositions of X"), "{text}");

    let (text, unseen) = worn("0.0013", "[[-90, 1.0], [-80, -1.6]]", "");
    assert!(unseen.iter().all(|one| one["limits"] == true), "{unseen:?}");
    assert!(
        near(number(&unseen[1]["size"]), 0.0026) && near(number(&unseen[1]["within"]), 0.0025),
        "{unseen:?}"
    );
    for words in [
        "\nevery count is fine enough\nby counts alone positions of X do for tolerances of 0.763 µm",
        "X: its lost motion of 1.3e-3 mm, 34.1 counts, limits the accuracy: axis.x.backlash_mm has to be right within 1.25e-3 mm",
        "Z: its screw of 2.6e-3 mm, 68.2 counts, limits the accuracy: axis.z.screw_error has to be right within 2.5e-3 mm",
        "until the motor has crossed it",
        "X: nothing is known of the error of the screw",
    ] {
        assert!(text.contains(words), "{words}:\n{text}");
    }
    let (text, unseen) = worn("0.0013", "[[-90, 0.0], [-80, 0.0]]", "scale_step_mm = 0.0001\n");
    assert!(unseen.is_empty() && !text.contains("do not see") && !text.contains("X: nothing"), "{text}");
}

/// An axis C of 0.001 degrees a count: 25 µm are 0.0573 degrees at 25 mm, and four times less at 100 mm.
#[test]
fn what_turns_is_asked_in_degrees() {
    let place = Place::new();
    let z = SMALL_MILL.split("[axis.z]").nth(1).and_then(|rest| rest.split("\n[").next()).expect("an axis");
    let plant =
        SMALL_MILL.split("[plant.axis.z]").nth(1).and_then(|rest| rest.split("\n[").next()).expect("a plant");
    let keys = z.replace("_mm", "_deg").replace("encoder_counts = 1048576", "encoder_counts = 10000");
    let keys = keys.replace("travel_deg = [-200.0, 50.0]", "travel_deg = [-360.0, 360.0]");
    place.write("c.toml", format!("{SMALL_MILL}\n[axis.c]{keys}\n[plant.axis.c]{plant}"));
    let c = |arguments: &[&str]| {
        let document = found(&place, &[&["--machine", "c.toml"], arguments].concat());
        let axes = list(&document["axes"]);
        axes.iter().find(|axis| axis["axis"] == "c").cloned().expect("it is there")
    };
    let near_step =
        |axis: &Value, want: f64| (number(&axis["quantities"][0]["step"]) / want - 1.0).abs() < 1e-9;
    let half = c(&[]);
    assert_eq!((&half["unit"], &half["count"]), (&"deg".into(), &1e-3.into()));
    assert_eq!(half["quantities"][1]["step_unit"], "deg/cycle");
    assert!(near_step(&half, 0.1 * 0.001_f64.to_degrees()), "{half}");
    assert!(near_step(&c(&["--radius", "100"]), 0.1 * 0.000_25_f64.to_degrees()));
    assert!(near_step(&c(&["--tolerance", "5", "--radius", "100"]), 0.1 * 0.000_05_f64.to_degrees()));
    let answer = place.ask(&["resolution", "--machine", "c.toml", "--tolerance", "5"]);
    assert_eq!(answer.status, Some(2));
    assert!(answer.stderr.contains("C turns") && answer.stderr.contains("--radius"), "{}", answer.stderr);
    let answer = place.ask(&["resolution", "--machine", "c.toml", "--radius", "2000"]);
    assert!(
        answer.stdout.contains("C: count of the encoder: 14 times too coarse; an encoder of"),
        "{}",
        answer.stdout
    );
    assert!(answer.stdout.contains("axis.c.scale_step_deg"), "{}", answer.stdout);
}

#[test]
fn the_page_has_everything_in_it() {
    let place = Place::new();
    let answer = place.ask(&["resolution", "--page", "needs.html", "--size", "30"]);
    assert!(answer.stdout.ends_with("\npage    needs.html\n"), "{}", answer.stdout);
    let page = fs::read_to_string(place.at("needs.html")).expect("it is written");
    // X, whose tolerance is that of a diameter, Z, and the errors of differences on each.
    assert_eq!(page.matches("<figure>").count(), 4);
    let before_the_library = page.split("</main>").next().unwrap_or_default();
    for needed in ["What was done", "Verdict", "int-up", "How to repeat it", "--size 30", "aria-label"] {
        assert!(before_the_library.contains(needed), "{needed} is missing");
    }
    for foreign in ["http://", "https://", "<link", " src="] {
        assert!(!before_the_library.contains(foreign), "{foreign} in the page");
    }
    let motion = ["--feed", "1", "--acceleration", "1", "--jerk", "1", "--cycle", "1"];
    let answer =
        place.ask(&[&["resolution", "--tolerance", "8", "--page", "given.html"], &motion[..]].concat());
    assert_eq!(answer.status, Some(0), "{}", answer.stderr);
    let page = fs::read_to_string(place.at("given.html")).expect("it is written");
    assert_eq!(page.matches("<figure>").count(), 2, "no grade, no picture of grades");
}

#[test]
fn what_cannot_be_asked_is_refused() {
    let place = Place::new();
    place.write("mill.toml", SMALL_MILL);
    let cases: [(&[&str], &[&str]); 17] = [
        (&["--grade", "IT19"], &["--grade IT19", "IT01, IT0, IT1 … IT18", "--tolerance"]),
        (&["--grade", "H7"], &["\"H7\"", "not a grade"]),
        (&["--size", "4000"], &["--size 4000", "up to 3150 mm"]),
        (&["--size", "0"], &["--size 0", "above 0"]),
        (&["--grade", "IT0", "--size", "600"], &["--grade IT0", "IT1 or coarser"]),
        (&["--tolerance", "6", "--grade", "IT6"], &["leave out --grade"]),
        (&["--tolerance", "6", "--size", "10"], &["leave out --size"]),
        (&["--tolerance", "nan"], &["--tolerance NaN", "between"]),
        (&["--tolerance", "1e-300"], &["--tolerance 1e-300:", "between"]),
        (&["--k-f", "0"], &["--k-f 0", "between"]),
        (&["--feed", "100"], &["--feed", "without --acceleration, --jerk, --cycle"]),
        (&["--counts", "100"], &["--counts", "--feed, --acceleration, --jerk and --cycle"]),
        (&["--machine", "mill.toml", "--feed", "100"], &["--machine mill.toml", "leave out --feed"]),
        (&["--machine", "mill.toml", "--lead", "2"], &["mill.toml cuts no threads"]),
        (&["--radius", "2"], &["no rotary axis", "leave out --radius"]),
        (&["--machine", "none.toml"], &["none.toml"]),
        (&["--page", "none/x.html"], &["none/x.html"]),
    ];
    for (arguments, words) in cases {
        let answer = place.ask(&[&["resolution"], arguments].concat());
        assert_eq!(answer.status, Some(2), "{arguments:?}: {}", answer.stderr);
        assert!(words.iter().all(|word| answer.stderr.contains(word)), "{arguments:?}: {}", answer.stderr);
        assert!(answer.stdout.is_empty() && !answer.stderr.contains("panicked"), "{arguments:?}");
    }
    let motion = ["--feed", "1", "--acceleration", "1", "--jerk", "1", "--cycle", "1"];
    for flag in ["--radius", "--lead"] {
        let answer = place.ask(&[&["resolution", flag, "2"], &motion[..]].concat());
        assert!(answer.status == Some(2) && answer.stderr.contains(flag), "{}", answer.stderr);
    }
}

/// The blocks below the commands in `docs/resolution.md` are what the commands print.
#[test]
fn the_documentation_shows_what_is_printed() {
    let page = fs::read_to_string(project().join("docs/resolution.md")).expect("it is there");
    let commands: Vec<_> = page.lines().filter_map(|line| line.strip_prefix("$ pitchlock ")).collect();
    assert_eq!(commands.len(), 2);
    for command in commands {
        let answer = Place::new().ask(&command.split(' ').collect::<Vec<_>>());
        let shown = format!("```text\n$ pitchlock {command}\n{}```\n", answer.stdout);
        assert!(page.contains(&shown), "docs/resolution.md should have:\n{shown}");
    }
}
