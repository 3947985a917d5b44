//! `pitchlock check`: many programs, standard input, and JSON whatever happens.

use serde_json::Value;

use crate::shop::Place;

const GOOD: &str = "G18 G8\nS500 M3\nG0 X12 Z5\nG76 P2 Z-20 I-1 J0.2 K1.2\nM2\n";
const BAD: &str = "G1 X10\nM2\n";

fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap_or_else(|error| panic!("{error}: {text}"))
}

#[test]
fn many_programs_are_told_one_by_one_and_counted() {
    let place = Place::new();
    place.write("good.ngc", GOOD);
    place.write("bad.ngc", BAD);
    let answer = place.ask(&["check", "good.ngc", "bad.ngc", "missing.ngc"]);
    assert_eq!(answer.status, Some(2));
    for line in ["good.ngc: 0 errors, ", "bad.ngc: 1 error, 0 warnings, ", "1 of 3 programs are good"] {
        assert!(answer.stdout.contains(line), "{line}: {}", answer.stdout);
    }
    assert!(answer.stderr.contains("bad.ngc:1:1: error[") && answer.stderr.contains("missing.ngc: "));
    let good = place.ask(&["check", "good.ngc", "good.ngc"]);
    assert!(good.status == Some(0) && good.stdout.ends_with("2 of 2 programs are good\n"), "{}", good.stdout);
    let quiet = place.ask(&["check", "good.ngc", "bad.ngc", "--quiet"]);
    assert!(quiet.stdout.is_empty() && quiet.stderr.contains("bad.ngc:1:1: error["), "{}", quiet.stdout);
}

#[test]
fn standard_input_is_a_program() {
    let place = Place::new();
    let answer = place.tell(&["check", "-"], BAD);
    assert_eq!(answer.status, Some(2));
    assert!(answer.stderr.starts_with("-:1:1: error["), "{}", answer.stderr);
    let fanuc = place.tell(&["check", "-", "--json"], "O1000\nG97 S500 M03\nG00 X40. Z2.\nM30\n");
    assert_eq!((fanuc.status, json(&fanuc.stdout)["dialect"].as_str()), (Some(0), Some("fanuc")));
}

/// Fifty lines of it would be fifty errors.
#[test]
fn a_program_of_another_control_is_refused_once_by_its_name() {
    let place = Place::new();
    let okuma = "OPULL (A PULL OF THE BAR)\nNB1 VZOFZ=0\nCALL OO30 LENG=2\nRTS\n";
    place.write("pull.min", okuma);
    for answer in [place.ask(&["check", "pull.min"]), place.tell(&["check", "-"], okuma)] {
        assert_eq!((answer.status, answer.stderr.lines().count()), (Some(2), 1), "{}", answer.stderr);
        assert!(answer.stderr.contains("Okuma OSP"), "{}", answer.stderr);
    }
}

/// A drawing, or UTF-16 that does not say so.
#[test]
fn what_is_no_text_is_refused_once() {
    let place = Place::new();
    let wide: Vec<u8> = "O1000\nG00 X40. Z2.\nM30\n".bytes().flat_map(|byte| [0, byte]).collect();
    let noise: Vec<u8> = (0..3000_u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 24) as u8).collect();
    for (name, bytes) in [("wide.nc", wide), ("noise.nc", noise)] {
        std::fs::write(place.at(name), bytes).expect("room");
        let answer = place.ask(&["check", name]);
        assert_eq!((answer.status, answer.stderr.lines().count()), (Some(2), 1), "{}", answer.stderr);
        assert!(answer.stderr.contains("is not text"), "{}", answer.stderr);
    }
    let tape = [&[0; 40][..], b"%\nO1\nG00 X40. Z2.\0\0\nM30\n%\n", &[0; 40]].concat();
    std::fs::write(place.at("tape.nc"), tape).expect("room");
    assert_eq!(place.ask(&["check", "tape.nc"]).status, Some(0));
}

/// G95 that was forgotten is one slip, not one in every line.
#[test]
fn feeds_of_the_other_mode_are_told_once_for_each_mode() {
    let place = Place::new();
    let minute = "G94\nG1 Z1 F0.1\nZ0 F0.2\nZ-1 F0.15\n";
    let turn = "G95\nZ-2 F100\nZ-3 F150\n";
    let answer = place.tell(&["check", "-"], &format!("S800 M3\nG0 X20 Z2\n{minute}{turn}M2\n"));
    let told: Vec<&str> = answer.stderr.lines().filter(|line| line.contains("unlikely-feed")).collect();
    assert_eq!(told.len(), 2, "{}", answer.stderr);
    assert!(told[0].contains("(and 2 times more, up to line 6)"), "{}", told[0]);
    assert!(told[1].contains("(and again in line 9)"), "{}", told[1]);
}

#[test]
fn switches_of_optional_blocks_have_numbers() {
    let place = Place::new();
    place.write("O1.nc", "O1000\n/ G00 X1A\n/2 G00 X1B\nG00 X40. Z2.\nM30\n");
    let refused = |switch: &str| {
        let answer = place.ask(&["check", "O1.nc", switch]);
        (2..=3).filter(|line| answer.stderr.contains(&format!("O1.nc:{line}:"))).collect::<Vec<_>>()
    };
    assert_eq!(refused("-q"), [2, 3]);
    assert_eq!(refused("--block-delete"), [3]);
    assert_eq!(refused("--block-delete=2"), [2]);
    assert_eq!(refused("--block-delete=1,2"), [0; 0]);
    let none = place.ask(&["check", "O1.nc", "--block-delete=10"]);
    assert!(none.status == Some(2) && none.stderr.contains("1..=9"), "{}", none.stderr);
}

#[test]
fn json_is_json_whatever_happens() {
    let place = Place::new();
    place.write("good.ngc", GOOD);
    place.write("bad.toml", "[machine]\n");
    for (arguments, said) in [
        (&["check", "missing.ngc", "--json"][..], "missing.ngc"),
        (&["check", "good.ngc", "--json", "--machine", "bad.toml"], "bad.toml"),
        (&["check", "good.ngc", "--json", "--gauge", "M20x"], "M20x"),
        (&["check", "good.ngc", "--json", "--tools", "no.tbl"], "no.tbl"),
    ] {
        let answer = place.ask(arguments);
        let document = json(&answer.stdout);
        assert_eq!((answer.status, &document["errors"]), (Some(2), &Value::from(1)), "{arguments:?}");
        assert!(document["error"].as_str().is_some_and(|text| text.contains(said)), "{document}");
    }
    let several = json(&place.ask(&["check", "good.ngc", "missing.ngc", "--json"]).stdout);
    assert_eq!(several.as_array().map(Vec::len), Some(2));
    let good = &several[0];
    assert!(good["error"].is_null() && good["errors"] == 0 && several[1]["errors"] == 1, "{several}");
    let passes = good["passes"].as_array().expect("a list");
    assert!(passes.len() > 3 && passes[0]["pass"] == 1 && passes[0]["line"] == 4, "{good}");
    let depths: Vec<f64> = passes.iter().filter_map(|pass| pass["depth_mm"].as_f64()).collect();
    assert!(depths.is_sorted() && depths.last().is_some_and(|depth| (depth - 1.2).abs() < 1e-9));
    let time_s = good["time_s"].to_string();
    assert!(time_s.split('.').nth(1).is_some_and(|digits| digits.len() <= 6), "{time_s}");
}

/// What is refused is not warned of as well.
#[test]
fn what_is_an_error_is_told_once() {
    let place = Place::new();
    place.write("tool.tbl", "T1 P1 Z1\n");
    place.write("tool.ngc", "G18 G8\nT99 M6 G43\nG0 X12 Z5\nM2\n");
    let answer = place.ask(&["check", "tool.ngc", "--tools", "tool.tbl"]);
    assert!(answer.stdout.starts_with("1 error, 0 warnings"), "{}{}", answer.stdout, answer.stderr);
}

/// What one forgotten word makes of every block behind it is told once, with how often.
#[test]
fn what_follows_from_one_cause_is_told_once_with_its_count() {
    let place = Place::new();
    place.write(
        "a.ngc",
        "G18 G8 G21\nG0 X12 Z5\nG33 Z-10 K1\nG33 Z-12 K1\nG33 Z-14 K1\nG90 G91 G0 X10\nG90 G91 G0 X11\nM2\n",
    );
    let answer = place.ask(&["check", "a.ngc"]);
    assert!(answer.stdout.starts_with("2 errors, "), "{}", answer.stdout);
    assert!(
        answer.stderr.contains("which is not turning (and 2 times more, up to line 5)"),
        "{}",
        answer.stderr
    );
    assert!(answer.stderr.contains("in one block (and again in line 7)"), "{}", answer.stderr);
    // A program of a mill on a lathe: an axis that is not there, and arcs of a post in diameters.
    place.write("mill.ngc", "F100 S500 M3\nG0 X10 Y1\nY2\nX12 Y3\nG18 G0 X18 Z1\nG1 Z0\nG3 X19.2 Z-0.6 K-0.6\nG3 X20.4 Z-1.2 K-0.6\nM2\n");
    let answer = place.ask(&["check", "mill.ngc"]);
    assert!(answer.stdout.starts_with("2 errors, "), "{}", answer.stdout);
    assert!(
        answer.stderr.contains("Y, which would leave its zero here (and 2 times more, up to line 4)"),
        "{}",
        answer.stderr
    );
    assert!(answer.stderr.contains("off the circle (and again in line 8)"), "{}", answer.stderr);
    // Warnings of every kind, whatever figures they give; what has another name is another one.
    place.write("c.nc", "O1\nG97 S2500 M03\nG00 X32. Z8.\nG92 X29.5 Z-20. F3.\nX29.\nX28.\nM30\n");
    let answer = place.ask(&["check", "c.nc"]);
    for code in ["steep-chamfer", "mostly-shallow"] {
        assert_eq!(answer.stderr.matches(code).count(), 1, "{}", answer.stderr);
    }
    assert_eq!(answer.stderr.matches("(and 2 times more, up to line 6)").count(), 2, "{}", answer.stderr);
    place
        .write("d.ngc", "G7\nS400 M3\nG0 X40 Z2\nG33 Z-5 K1\nG0 X44 Z2\nG0 X39\nG33 Z-5 K1\nG0 X44 Z2\nM2\n");
    let answer = place.ask(&["check", "d.ngc"]);
    assert!(
        answer.stderr.contains("no-retract") && answer.stderr.contains("(and again in line 7)"),
        "{}",
        answer.stderr
    );
    place.write("e.nc", "O1\nT0102\nT0203\nG00 X40. Z2.\nM30\n");
    place.write("tools.tbl", "T1 P1\n");
    let answer = place.ask(&["check", "e.nc", "--tools", "tools.tbl"]);
    assert_eq!(answer.stderr.matches("is not in the tool table").count(), 2, "{}", answer.stderr);
    place.write("f.nc", "O1\nM03 S600\nG00 X42. Z2\nX40\nX38 Z1\nM30\n");
    let answer = place.ask(&["check", "f.nc"]);
    assert!(answer.stdout.starts_with("1 error, "), "{}{}", answer.stdout, answer.stderr);
    assert!(
        answer.stderr.contains("others of the program have one (and 2 times more, up to line 5)"),
        "{}",
        answer.stderr
    );
    let thread = "G76 P010060 Q20 R0.02\nG76 X20. Z-20. P900 Q200 F2.\nG92 X21. Z-20. F2.\nX20.8\nX20.6\n";
    place.write("b.nc", format!("%\nO1\nG50 S2000\nG96 S60 M03\nG00 X24. Z8.\n{thread}M30\n"));
    let answer = place.ask(&["check", "b.nc"]);
    assert_eq!(answer.stderr.matches("constant-surface-thread").count(), 1, "{}", answer.stderr);
    assert!(answer.stderr.contains("(and 3 times more, up to line 10)"), "{}", answer.stderr);
}
