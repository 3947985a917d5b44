//! What a gauge has to know before it judges: how wide a hole was drilled, what edge cut the thread, whether
//! the part is finished. Where it does not know, it says so.

use serde_json::Value;

use crate::gauge::{GOOD, run, summary};
use crate::shop::{Place, project};

/// A hole is as wide as its drill, by the machine file or by the tool table: one for the class, one that is
/// too small, one that is too large; of a drill that nobody described the crest is not judged, and `check`
/// says so.
#[test]
fn the_crest_of_a_nut_is_what_was_drilled() {
    let place = Place::new();
    let drilling =
        "G7 G18 G21 G90 G94 G97\nT1 M6\nS600 M3\nG17 G0 X0 Z10\nG83 X0 Z-28 R2 Q8 F60\nG80 G0 Z10\nG18\n";
    let tapped = "S400 M3\nG0 Z12\nG33.1 Z-20 K1.5\nG0 Z30\nM5\nM2\n";
    place.write("tap.ngc", format!("(thread, M10x1.5-6H)\n{drilling}{tapped}"));
    let bored = "T2 M6\nS600 M3\nG0 X17 Z6\nG76 P1.5 Z-18 I1.5 J0.4 K1.84 R2 Q29.5 H2\nG0 Z50\nM5\nM2\n";
    place.write("bore.ngc", format!("(thread, M20x1.5-6H)\n{drilling}{bored}"));
    let shop =
        std::fs::read_to_string(project().join("examples/machines/small-lathe.toml")).expect("shipped");
    for (program, good_mm, small_mm, large_mm) in [("tap.ngc", 8.5, 8.3, 8.8), ("bore.ngc", 18.5, 18.2, 18.8)]
    {
        for (mm, verdict) in [(good_mm, "good"), (small_mm, "bad"), (large_mm, "bad")] {
            place.write("drill.tbl", format!("T1 P1 D{mm} ; drill\nT2 P2\n"));
            place.write(
                "shop.toml",
                format!("{shop}\n[tools.1]\nname = \"drill\"\nwidth_mm = {mm}\n[tools.2]\nname = \"bar\"\n"),
            );
            for more in [["--tools", "drill.tbl"], ["--machine", "shop.toml"]] {
                let answer = run(&place, program, &more);
                let gauge = summary(&place)["gauge"].clone();
                let told = format!("{program} {mm} {more:?}: {gauge:#}{}", answer.stderr);
                assert_eq!(gauge["verdict"], verdict, "{told}");
                assert_eq!(answer.status, Some(if verdict == "good" { 0 } else { 3 }), "{told}");
                assert_eq!(answer.stderr.contains("crest: minor diameter"), verdict == "bad", "{told}");
                assert!((gauge["crest_mm"][0].as_f64().expect("a diameter") - mm).abs() < 1e-9, "{told}");
                assert!(!answer.stderr.contains("crest-unknown"), "{told}");
            }
        }
        let answer = run(&place, program, &[]);
        assert_eq!(answer.status, Some(0), "{}", answer.stderr);
        let says =
            "the crest is not judged: nobody said how wide tool 1, which drilled the hole, is; give D in";
        assert!(answer.stdout.contains(says), "{}", answer.stdout);
        assert_eq!(summary(&place)["gauge"]["crest_mm"], Value::Array(Vec::new()));
        let check = place.ask(&["check", program]);
        assert!(check.stderr.contains(&format!("{program}:6:1: warning[crest-unknown]")), "{}", check.stderr);
    }
}

/// Holes of a mill and of a lathe that are too wide, beside their tap, not as deep as they are tapped, or not
/// there: what the gauge says, and the exit status.
#[test]
fn a_tapped_hole_is_as_good_as_what_was_drilled() {
    let place = Place::new();
    let block = "(part, block X0 Y0 Z-20 X60 Y40 Z0)\n";
    let mill = |part: &str, x: f64, z: f64| {
        let drilled = format!("T2 M6\nM3 S900\nG0 X{x} Y20\nG0 Z5\nG1 Z{z} F200\nG0 Z5\n");
        let drilled = if z < 0.0 { drilled } else { String::new() };
        format!(
            "{part}(thread, M6x1-6H)\nG17 G21 G90 G94\n{drilled}T1 M6\nM3 S600\nG0 X10 Y20\nG0 Z5\n\
             G33.1 Z-14 K1\nG0 Z30\nM5\nM2\n"
        )
    };
    let lathe = |part: &str, z: f64| {
        let drilled = format!("T2 M6\nM3 S800\nG0 X0 Z8\nG1 Z{z} F100\nG0 Z8\n");
        let drilled = if z < 0.0 { drilled } else { String::new() };
        format!(
            "{part}(thread, M8x1.25-6H)\nG18 G21 G90 G8 G94 G97\n{drilled}T5 M6\nM3 S500\nG0 X0 Z8\n\
             G33.1 Z-18 K1.25\nG0 Z60\nM5\nM2\n"
        )
    };
    let bar = "(part, bar D30 L60)\n";
    let solid = "nothing drilled the hole that is tapped, and the part that is described is solid there";
    let shallow = " and tapped to Z-";
    let small = ["--machine", "mill.toml"];
    let cases = [
        (mill("", 10.0, -16.0), Some(5.0), "good", ""),
        (mill(block, 10.0, -16.0), Some(5.0), "good", ""),
        (mill("", 10.0, -16.0), Some(6.2), "bad", "crest: minor diameter 6.2"),
        (mill("", 10.0, -16.0), Some(9.0), "bad", "crest: minor diameter 9.0"),
        (mill("", 10.6, -16.0), Some(5.0), "bad", "the hole is drilled 0.600 mm beside the tap"),
        (mill("", 10.0, -16.0), None, "good", "nobody said how wide tool 2, which drilled the hole, is"),
        (mill("", 10.0, 0.0), Some(5.0), "good", "nothing in the program drilled the hole"),
        (mill(block, 10.0, 0.0), Some(5.0), "none", solid),
        (mill("", 10.0, -10.0), Some(5.0), "none", shallow),
        (mill(block, 10.0, -10.0), Some(5.0), "bad", shallow),
        (lathe("", -20.0), Some(6.8), "good", ""),
        (lathe("", -10.0), Some(6.8), "none", shallow),
        (lathe(bar, -10.0), Some(6.8), "bad", shallow),
        (lathe(bar, 0.0), Some(6.8), "none", solid),
        (lathe("(part, tube D30 I6.8 L60)\n", 0.0), Some(6.8), "good", "nothing in the program drilled"),
    ];
    place.write("mill.toml", machine::SMALL_MILL);
    for (program, width_mm, verdict, says) in cases {
        place.write("tap.ngc", &program);
        let d = width_mm.map_or_else(String::new, |mm| format!(" D{mm}"));
        place.write("tools.tbl", format!("T1 P1\nT2 P2{d}\nT5 P5\n"));
        let machine = if program.contains("G17") { &small[..] } else { &[] };
        let answer = run(&place, "tap.ngc", &[&["--tools", "tools.tbl"], machine].concat());
        let gauge = summary(&place)["gauge"].clone();
        let told = format!("{program}{width_mm:?} {gauge:#}\n{}", answer.stderr);
        assert_eq!(gauge["verdict"], verdict, "{told}");
        assert_eq!(answer.status, Some(if verdict == "bad" { 3 } else { 0 }), "{told}");
        assert!(
            gauge.to_string().contains(says) && answer.stdout.contains(says),
            "{told}\n{}",
            answer.stdout
        );
        assert_eq!(summary(&place)["part"]["verdict"], verdict, "{told}");
        if verdict == "good" && says.is_empty() {
            let crest_mm = gauge["crest_mm"][0].as_f64().expect("a diameter");
            assert!((crest_mm - width_mm.unwrap_or_default()).abs() < 0.02, "{told}");
        }
    }
}

/// Half of a thread is no thread: a run that is aborted has no verdict of its gauge, and says so everywhere.
#[test]
fn a_part_that_is_not_finished_has_no_verdict_of_its_gauge() {
    let place = Place::new();
    place.write("two.ngc", format!("(thread, M20x4P2-6g)\n{}", GOOD.replace("P2 Z-22", "P4 Z-22")));
    place.write("abort.toml", "[[event]]\nat = { pass = 3, z_mm = -5.0 }\nabort = true\n");
    assert_eq!(run(&place, "two.ngc", &[]).status, Some(3), "one start of two");
    let answer = run(&place, "two.ngc", &["--scenario", "abort.toml"]);
    assert_eq!(answer.status, Some(1), "{}", answer.stderr);
    let says = "no verdict: the program was not executed to its end";
    assert!(answer.stdout.contains(says) && !answer.stderr.contains("number of starts"), "{}", answer.stderr);
    let gauge = summary(&place)["gauge"].clone();
    assert!(
        gauge["verdict"] == "none" && gauge["reasons"].as_array().is_some_and(|all| all.len() == 1),
        "{gauge}"
    );
    let page = std::fs::read_to_string(place.at("out/report.html")).expect("a report");
    assert!(page.contains(says), "the report");
}

/// Where nobody described the edge, the gauge says what it took.
#[test]
fn the_edge_that_is_taken_is_said() {
    let place = Place::new();
    place.write("good.ngc", GOOD);
    let shop =
        std::fs::read_to_string(project().join("examples/machines/plain-lathe.toml")).expect("shipped");
    for (keys, says) in [
        (
            "",
            "the edge is taken to be a sharp point of 60°, for nobody described tool 3: [tools.3] angle_deg, nose_mm",
        ),
        (
            "angle_deg = 60\n",
            "the edge is taken to be a sharp point, for nobody described tool 3: [tools.3] nose_mm",
        ),
        (
            "nose_mm = 0.1\n",
            "taken to be 60° between its flanks, for nobody described tool 3: [tools.3] angle_deg",
        ),
        ("angle_deg = 60\nnose_mm = 0.1\n", ""),
    ] {
        place.write("shop.toml", format!("{shop}\n[tools.3]\nname = \"insert\"\n{keys}"));
        let answer = run(&place, "good.ngc", &["--gauge", "M20x2-6g", "--machine", "shop.toml"]);
        let told = answer.stdout.contains("the edge is taken");
        assert!(told != says.is_empty() && answer.stdout.contains(says), "{keys}: {}", answer.stdout);
        let notes = summary(&place)["gauge"]["notes"].to_string();
        assert_eq!(notes.contains("the edge is taken"), told, "{notes}");
    }
}
