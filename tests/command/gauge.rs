//! The gauge of a thread: asked for by name, by numbers or in the program; what it says on the terminal, in
//! the documents and by the exit status; threads that are wrong on purpose.

use serde_json::Value;

use crate::shop::{Answer, Place, project};

/// M20x2-6g by a sharp point of 60°: its root lies P/2 cot 30° = 1.732 mm below the pitch line, in diameter.
pub(crate) const GOOD: &str = "G18 G21 G90 G7 G94 G97\nT3\nS600 M3\nG0 X22 Z8\n\
                    G76 P2 Z-22 I-2.18 J0.7 K2.969 R2 Q29.5 H2\nG0 X40\nG0 Z60\nM5\nM2\n";

/// A machine whose tool has another angle than the thread asks for.
const OTHER_ANGLE: &str = "\n[tools.3]\nname = \"55 degrees\"\nangle_deg = 55\n";

pub(crate) fn run(place: &Place, program: &str, more: &[&str]) -> Answer {
    place.clear("out");
    let mut args = vec!["run", program, "--in-process", "--trace", "none", "--out", "out"];
    args.extend(more);
    place.ask(&args)
}

pub(crate) fn summary(place: &Place) -> Value {
    let text = std::fs::read_to_string(place.at("out/summary.json")).expect("a summary");
    serde_json::from_str(&text).expect("a document")
}

/// One pass by G33 as deep as the good thread, from another place, along another taper.
fn single(z: f64, from_x: f64, to_x: f64) -> String {
    format!("G0 X22 Z{z}\nG0 X{from_x}\nG33 X{to_x} Z-22 K2\nG0 X22\n")
}

/// `docs/gauge.md` shows a program, and what is said of it.
#[test]
fn the_page_shows_what_is_said() {
    let place = Place::new();
    let page = std::fs::read_to_string(project().join("docs/gauge.md")).expect("there is a page");
    let program = page.split("```ngc machine\n").nth(1).and_then(|rest| rest.split("```").next());
    let program = program.expect("there is a program");
    place.write("good.ngc", program);
    place.write("lead.ngc", program.replace("G76 P2 ", "G76 P2.02 "));
    let check = place.ask(&["check", "good.ngc"]).stdout;
    let runs = ["good.ngc", "lead.ngc"].map(|name| run(&place, name, &[]).stdout);
    let said = runs.iter().chain([&check]).flat_map(|text| text.lines());
    let lines: Vec<&str> = said.filter(|line| line.starts_with("gauge ")).collect();
    assert_eq!(lines.len(), 3, "{runs:?}");
    for line in lines {
        assert!(page.contains(&format!("\n{line}\n")), "{line}");
    }
}

#[test]
fn a_good_thread_is_said_to_be_good_wherever_it_was_asked_for() {
    let place = Place::new();
    place.write("plain.ngc", GOOD);
    place.write("named.ngc", format!("(thread, M20x2-6g)\n{GOOD}"));
    let numbers = "P2 D2 18.503..18.663 A60 external root ..17.797 length 20";
    for (program, more) in [
        ("plain.ngc", &["--gauge", "M20x2-6g"][..]),
        ("plain.ngc", &["--gauge", numbers]),
        ("named.ngc", &[]),
    ] {
        let answer = run(&place, program, more);
        assert_eq!((answer.status, answer.stderr.as_str()), (Some(0), ""), "{}", answer.stdout);
        assert!(answer.stdout.contains(" good: pitch diameter 18.5"), "{}", answer.stdout);
        let gauge = &summary(&place)["gauge"];
        assert_eq!((&gauge["verdict"], &gauge["limits"]["pitch_mm"]), (&"good".into(), &2.0.into()));
        let diameters = ["pitch_diameter_min_mm", "pitch_diameter_max_mm", "virtual_pitch_diameter_mm"];
        for mm in diameters.map(|key| gauge[key].as_f64().expect("a diameter")) {
            assert!((mm - 18.583).abs() < 0.02, "{gauge}");
        }
    }
    // The run folder asks for the same gauge again.
    run(&place, "plain.ngc", &["--gauge", "M20x2-6g"]);
    let again = place.ask(&["run", "out", "--in-process", "--trace", "none", "--out", "again"]);
    assert!(again.stdout.contains("M20x2-6g good"), "{}", again.stdout);
    let report = std::fs::read_to_string(place.at("out/report.html")).expect("a report");
    assert!(report.contains("M20x2-6g good: pitch diameter"));
}

#[test]
fn what_is_wrong_on_purpose_is_refused_with_its_reason_everywhere() {
    let place = Place::new();
    place.write("other.toml", place.ask(&["machine"]).stdout + OTHER_ANGLE);
    let head = "G18 G21 G90 G7 G94 G97\nT3\nS600 M3\n";
    let tail = "G0 Z60\nM5\nM2\n";
    let shifted =
        |by: f64| format!("{head}{}{}{tail}", single(8.0, 16.851, 16.851), single(8.0 + by, 16.851, 16.851));
    let tapered = format!("{head}{}{tail}", single(8.0, 16.75, 16.95));
    let cases = [
        ("wrong pitch", GOOD.replace("P2 ", "P2.02 "), "lead", "GO does not go on"),
        ("shallow", GOOD.replace("K2.969", "K2.85"), "too shallow", "GO does not go on"),
        ("deep", GOOD.replace("K2.969", "K3.1"), "too deep", "NO-GO goes on"),
        ("pass 100 µm aside", shifted(0.1), " µm apart)", "NO-GO goes on"),
        ("tapered", tapered, "tapered by", "go"),
        ("flank", GOOD.into(), "flanks of 27.50° and ", "go"),
    ];
    for (what, program, cause, says) in cases {
        place.write("bad.ngc", program);
        let mut more = vec!["--gauge", "M20x2-6g"];
        if what == "flank" {
            more.extend(["--machine", "other.toml"]);
        }
        let answer = run(&place, "bad.ngc", &more);
        assert_eq!(answer.status, Some(3), "{what}: {}{}", answer.stdout, answer.stderr);
        let gauge = summary(&place)["gauge"].clone();
        let reasons = gauge["reasons"].as_array().expect("reasons");
        let reason = reasons.iter().filter_map(Value::as_str).find(|reason| reason.contains(cause));
        let reason = reason.unwrap_or_else(|| panic!("{what}: {reasons:?}"));
        assert!(reason.contains(says), "{what}: {reason}");
        assert!(
            answer.stderr.contains(&format!("not good: M20x2-6g: {reason}")),
            "{what}: {}",
            answer.stderr
        );
        assert!(answer.stdout.contains("gauge     M20x2-6g not good: "), "{what}: {}", answer.stdout);
        let report = std::fs::read_to_string(place.at("out/report.html")).expect("a report");
        assert!(report.contains(reason), "{what}");
        more.push("--json");
        let json: Value = serde_json::from_str(&run(&place, "bad.ngc", &more).stdout).expect("a document");
        assert_eq!((&json["gauge"], &json["part"]["verdict"]), (&gauge, &"bad".into()), "{what}");
    }
    // 5 and 20 µm aside the groove is wider by as much, and still within its class.
    let low = |by: f64| {
        place.write("aside.ngc", shifted(by));
        run(&place, "aside.ngc", &["--gauge", "M20x2-6g"]);
        let gauge = summary(&place)["gauge"].clone();
        assert_eq!(gauge["verdict"], "good", "{by}: {gauge}");
        gauge["pitch_diameter_min_mm"].as_f64().expect("a diameter")
    };
    let together = low(0.0);
    for by in [0.005, 0.02] {
        let narrower = together - low(by);
        assert!((narrower - by * 3_f64.sqrt()).abs() < 0.001, "{by}: {narrower}");
    }
}

/// The crest is what was turned in the same program; without that it is said that nobody judges it.
/// A pass that is shorter than the others hides nothing of what they cut beyond its end.
#[test]
fn a_short_pass_hides_no_fault() {
    let place = Place::new();
    let pass = |x: f64, to: f64, lead: f64| format!("G0 X22 Z8\nG0 X{x}\nG33 Z{to} K{lead}\nG0 X22\n");
    let program = |passes: String| format!("G18 G21 G90 G7 G94 G97\nT3\nS600 M3\n{passes}G0 Z60\nM5\nM2\n");
    let long_lead = pass(16.851, -22.0, 2.02) + &pass(19.5, -4.0, 2.02);
    let half = pass(17.2, -22.0, 2.0) + &pass(16.851, -10.0, 2.0);
    let good = pass(16.851, -22.0, 2.0) + &pass(19.5, -4.0, 2.0);
    for (passes, cause) in [(long_lead, Some("lead")), (half, Some("tapered by")), (good, None)] {
        place.write("short.ngc", program(passes));
        let answer = run(&place, "short.ngc", &["--gauge", "M20x2-6g"]);
        let gauge = summary(&place)["gauge"].clone();
        assert_eq!(answer.status, Some(if cause.is_some() { 3 } else { 0 }), "{}{gauge}", answer.stderr);
        assert!(cause.is_none_or(|cause| answer.stderr.contains(cause)), "{cause:?}: {}", answer.stderr);
        assert!(gauge["length_mm"].as_f64().is_some_and(|mm| mm > 15.0), "{gauge}");
    }
}

/// A faster finish leaves earlier: the thread is judged where every pass is deep, of whatever tool it is.
#[test]
fn a_finish_by_another_tool_at_another_speed_is_judged_where_both_are_deep() {
    let place = Place::new();
    let text = std::fs::read_to_string(project().join("examples/two-inserts.ngc")).expect("an example");
    let (rough, finish) = text.rsplit_once("M3 S400").expect("it finishes at a speed of its own");
    place.write("faster.ngc", format!("{rough}M3 S600{finish}"));
    let answer = run(&place, "faster.ngc", &[]);
    assert_eq!(
        (answer.status, &summary(&place)["gauge"]["verdict"]),
        (Some(0), &"good".into()),
        "{}",
        answer.stdout
    );
}

#[test]
fn the_crest_is_what_was_turned_before() {
    let place = Place::new();
    let turned = |diameter: f64| {
        let turning = format!("G0 X{diameter} Z2\nG1 Z-26 F600\nG0 X24\nG0 Z8\nG0 X22 Z8\nG76");
        GOOD.replace("G0 X22 Z8\nG76", &turning)
    };
    for (diameter, status, says) in [(19.82, 0, ""), (20.0, 3, "crest"), (19.6, 3, "crest")] {
        place.write("turned.ngc", turned(diameter));
        let answer = run(&place, "turned.ngc", &["--gauge", "M20x2-6g"]);
        assert_eq!(answer.status, Some(status), "{diameter}: {}{}", answer.stdout, answer.stderr);
        assert!(answer.stderr.contains(says), "{diameter}: {}", answer.stderr);
        let gauge = summary(&place)["gauge"].clone();
        for mm in gauge["crest_mm"].as_array().expect("two diameters").iter().filter_map(Value::as_f64) {
            assert!((mm - diameter).abs() < 0.02, "{gauge}");
        }
        assert!(!answer.stdout.contains("crest is not judged"), "{}", answer.stdout);
    }
    place.write("plain.ngc", GOOD);
    assert!(run(&place, "plain.ngc", &["--gauge", "M20x2-6g"]).stdout.contains("crest is not judged"));
}

#[test]
fn a_second_start_in_the_wrong_place_is_refused() {
    let place = Place::new();
    // Two starts of 2 mm: the second one a pitch further, and 0.12 mm beside that.
    let pass = |z: f64| format!("G0 X22 Z{z}\nG0 X16.851\nG33 Z-22 K4\nG0 X22\n");
    for (second, verdict) in [(12.0, "good"), (12.12, "bad")] {
        let program =
            format!("G18 G21 G90 G7 G94 G97\nS400 M3\n{}{}G0 Z60\nM5\nM2\n", pass(10.0), pass(second));
        place.write("two.ngc", program);
        let answer = run(&place, "two.ngc", &["--gauge", "P2 D2 18.503..18.663 starts 2"]);
        let gauge = summary(&place)["gauge"].clone();
        assert_eq!(gauge["verdict"], verdict, "{gauge}");
        assert_eq!(answer.status, Some(if verdict == "good" { 0 } else { 3 }), "{}", answer.stderr);
        assert_eq!(answer.stderr.contains("starts 120."), verdict == "bad", "{}", answer.stderr);
    }
}

#[test]
fn without_a_thread_to_judge_the_verdict_says_why() {
    let place = Place::new();
    place.write("none.ngc", "G18 G21 G90 G94\nG0 X22 Z8\nM2\n");
    let answer = run(&place, "none.ngc", &["--gauge", "M20x2-6g"]);
    assert_eq!(answer.status, Some(0), "{}", answer.stderr);
    assert!(answer.stdout.contains("M20x2-6g no verdict: the program cuts no thread"), "{}", answer.stdout);
    place.write("short.ngc", GOOD.replace("Z-22", "Z-2.5"));
    let answer = run(&place, "short.ngc", &["--gauge", "M20x2-6g"]);
    assert!(answer.stdout.contains("M20x2-6g no verdict: "), "{}", answer.stdout);
    assert_eq!(summary(&place)["gauge"]["verdict"], "none");
}

#[test]
fn names_that_no_gauge_has_are_refused_with_a_remedy() {
    let place = Place::new();
    place.write("plain.ngc", GOOD);
    for (name, words) in [
        ("M20x2-6z", "M20x2"),
        ("M20x2", "6g or M20x2-6H"),
        ("BSW 1/2-12 external", "P2.1167 D2"),
        ("P2", "D2"),
    ] {
        for command in ["check", "run"] {
            let answer = place.ask(&[command, "plain.ngc", "--gauge", name]);
            assert_eq!(answer.status, Some(2), "{name}: {}", answer.stdout);
            assert!(answer.stderr.contains("help: ") && answer.stderr.contains(words), "{}", answer.stderr);
        }
    }
    for (comment, words) in [
        ("(thread, M20x2)", "6g or M20x2-6H"),
        ("(thread, M20x2-6z)", "help: "),
        ("(thread M20x2-6g)", "a comma is missing"),
        ("(thread, P2 D2 18.5)", "\"18.5\" behind D2"),
    ] {
        let lines = 1 + comment.matches('\n').count();
        place.write("named.ngc", format!("{comment}\n{GOOD}"));
        let answer = place.ask(&["check", "named.ngc"]);
        assert_eq!(answer.status, Some(2), "{comment}");
        let at = format!("named.ngc:{lines}:1: error[bad-thread]");
        assert!(answer.stderr.contains(&at) && answer.stderr.contains(words), "{}", answer.stderr);
    }
}

#[test]
fn check_says_which_gauge_judges_and_what_the_program_cuts_otherwise() {
    let place = Place::new();
    place.write("named.ngc", format!("(thread, M20x2-6g)\n(thread milling is something else)\n{GOOD}"));
    let check = |gauge: &str| {
        let mut args = vec!["check", "named.ngc"];
        if !gauge.is_empty() {
            args.extend(["--gauge", gauge]);
        }
        place.ask(&args)
    };
    let good = check("");
    assert_eq!((good.status, good.stderr.as_str()), (Some(0), ""));
    assert!(good.stdout.contains("gauge M20x2-6g, a screw: GO 18.663 mm, NO-GO 18.503"), "{}", good.stdout);
    for (gauge, words) in [
        ("M20x1.5-6g", "advances by 2 mm in a turn, and M20x1.5-6g by 1.5 mm"),
        ("M20x2-6H", "a screw is cut here, towards the axis, and M20x2-6H is a nut"),
        ("M20x2-6g LH", "is right-hand here, and M20x2-6g LH is left-hand"),
        ("P1 D2 18.5..18.6 starts 2", "1 of the 2 starts"),
    ] {
        let answer = check(gauge);
        assert_eq!(answer.status, Some(0), "{gauge}: {}", answer.stderr);
        assert!(answer.stderr.contains("named.ngc:7:1: warning[gauge-differs]"), "{}", answer.stderr);
        assert!(answer.stderr.contains(words), "{gauge}: {}", answer.stderr);
    }
    let json = place.ask(&["check", "named.ngc", "--json"]);
    let json: Value = serde_json::from_str(&json.stdout).expect("a document");
    assert_eq!(json["gauge"], "M20x2-6g");
}

/// A screw with a tapped hole: each name judges the passes behind it, and the worst verdict is that of the
/// part.
#[test]
fn several_threads_of_a_part_have_each_their_gauge() {
    let place = Place::new();
    let tap = "(thread, M8x1.25-6H)\nT5\nM3 S500\nG0 X0 Z8\nG33.1 Z-18 K1.25\nG0 Z60\nM5\nM2\n";
    let screw = GOOD.trim_end().trim_end_matches("M2");
    let both = format!("(thread, M20x2-6g)\n{screw}{tap}");
    for (program, verdicts, worst) in [
        (both.clone(), ["good", "good"], "M20x2-6g"),
        (both.replace("K1.25", "K1.26"), ["good", "bad"], "M8x1.25-6H"),
        (both.replace("K2.969", "K2.85"), ["bad", "good"], "M20x2-6g"),
    ] {
        place.write("both.ngc", program);
        let answer = run(&place, "both.ngc", &[]);
        let summary = summary(&place);
        let gauges = summary["gauges"].as_array().expect("two gauges");
        let told: Vec<_> = gauges.iter().map(|gauge| gauge["verdict"].as_str().unwrap_or_default()).collect();
        assert_eq!(told, verdicts, "{} {}", answer.stdout, answer.stderr);
        assert_eq!(summary["gauge"]["name"], worst);
        let is_good = verdicts == ["good"; 2];
        assert_eq!(answer.status, Some(if is_good { 0 } else { 3 }), "{}", answer.stderr);
        assert_eq!(summary["part"]["verdict"], if is_good { "good" } else { "bad" });
        let [screw, hole] = [0, 1].map(|at| gauges[at]["passes"].as_array().expect("passes").clone());
        assert!(screw.len() > 10 && hole.len() == 1 && !screw.contains(&hole[0]), "{screw:?} {hole:?}");
        let report = std::fs::read_to_string(place.at("out/report.html")).expect("a report");
        assert_eq!(report.matches(">Gauge</h2>").count(), 2);
    }
    place.write("both.ngc", both);
    let check = place.ask(&["check", "both.ngc"]);
    assert!(
        check.stdout.contains("gauge M20x2-6g, a screw") && check.stdout.contains("gauge M8x1.25-6H, a nut")
    );
    // A run that is repeated has its names from the program.
    let again = place.ask(&["run", "out", "--in-process", "--trace", "none", "--out", "again"]);
    assert_eq!(again.stdout.matches("\ngauge     ").count(), 2, "{}", again.stdout);
}
