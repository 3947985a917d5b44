//! Examples of threads are held against their gauge or against the groove that they draw: as they are they
//! are accepted, and with one word changed they are refused for what is wrong.

use std::path::PathBuf;

use serde_json::Value;

use crate::shop::{Answer, Place, project};

fn run(place: &Place, program: &str) -> Answer {
    place.clear("out");
    place.ask(&["run", program, "--in-process", "--trace", "none", "--out", "out"])
}

fn run_on(place: &Place, program: &str, machine: &str) -> Answer {
    place.clear("out");
    let alone = ["--in-process", "--trace", "none", "--out", "out", "--machine", machine];
    place.ask(&[&["run", program][..], &alone].concat())
}

fn path(name: &str) -> PathBuf {
    project().join("examples").join(name)
}

fn text(name: &str) -> String {
    std::fs::read_to_string(path(name)).expect("the example is there")
}

/// Every example that cuts a thread and needs nothing besides; the bolt of the first hour has its page.
const THREADS: [&str; 20] = [
    "m20x2.ngc",
    "internal-m30.ngc",
    "varied.ngc",
    "two-inserts.ngc",
    "chain.ngc",
    "lead-table.ngc",
    "blunt-start.ngc",
    "scroll.ngc",
    "tap-m8.ngc",
    "tap-npt.ngc",
    "worm-left.ngc",
    "fanuc/shaft-m24.nc",
    "fanuc/taper-g32.nc",
    "fanuc/variable-lead.nc",
    "fanuc/barrel.nc",
    "fanuc/domed-face.nc",
    "fanuc/two-starts.nc",
    "fanuc/grooves-macro.nc",
    "fanuc/tap-peck.nc",
    "rechucked/thread.ngc",
];

#[test]
fn every_example_of_a_thread_ends_with_a_thread_that_is_accepted() {
    let place = Place::new();
    for name in THREADS {
        let answer = run(&place, path(name).to_str().expect("a path"));
        assert_eq!(answer.status, Some(0), "{name}: {}{}", answer.stdout, answer.stderr);
        let summary = std::fs::read_to_string(place.at("out/summary.json")).expect("a summary");
        let summary: Value = serde_json::from_str(&summary).expect("a document");
        assert_eq!(summary["part"]["verdict"], "good", "{name}");
        let verdicts = ["gauge", "groove"].map(|judge| summary[judge]["verdict"].clone());
        assert!(verdicts.contains(&"good".into()), "{name}: {verdicts:?}");
        assert!(
            !verdicts.iter().any(|verdict| verdict == "bad" || verdict == "none"),
            "{name}: {verdicts:?}"
        );
        let report = std::fs::read_to_string(place.at("out/report.html")).expect("a report");
        assert!(report.contains("Gauge: ") || report.contains("Groove: as drawn"), "{name}");
    }
}

/// An example, the word that is changed, and what is said.
#[test]
fn an_example_that_is_cut_otherwise_is_refused_for_what_is_wrong() {
    let place = Place::new();
    let last_pass =
        ("G0 X24\nG0 Z-1\nG33 X90 K4\nG0 Z2\n\nG0 Z60", "G0 X24.2\nG0 Z-1\nG33 X90 K4\nG0 Z2\n\nG0 Z60");
    let mut others = Vec::new();
    for (name, [from, to], why) in [
        ("scroll.ngc", ["G33 X90 K4", "G33 X90 K4.02"], "lead 1"),
        ("scroll.ngc", [last_pass.0, last_pass.1], "passes lie "),
        ("scroll.ngc", ["G0 Z-1\n", "G0 Z-0.96\n"], "too shallow"),
        ("fanuc/variable-lead.nc", ["F3. K0.2", "F3. K0.19"], "lead "),
        ("fanuc/barrel.nc", ["R150. F2.", "R155. F2."], "too "),
        ("fanuc/domed-face.nc", ["R200. F4.", "R210. F4."], "too "),
        ("fanuc/domed-face.nc", ["R200. F4.", "R200. F4.01"], "lead "),
        ("fanuc/taper-g32.nc", ["[9.5+6.]/16", "[9.5+6.]/15"], "too deep"),
        ("fanuc/two-starts.nc", ["Q180000", "Q170000"], "starts "),
        ("lead-table.ngc", ["lead_table, Z-18 K2, Z-28", "lead_table, Z-18 K2, Z-29"], " short over "),
        ("chain.ngc", ["Z-44 K2.5", "Z-44 K2.52"], "beside the groove"),
        ("chain.ngc", ["Z-44 K2.5", "Z-44 K2.52"], "P2.5 D2 27.16..27.24 A60 external: GO does not go on"),
        ("chain.ngc", ["[2 * SQRT", "[2.01 * SQRT"], "taper 1:1.467 at -24: GO does not go on"),
        ("fanuc/taper-g32.nc", ["#101=1.452", "#101=1.3"], "R3/4: GO does not go on"),
        ("fanuc/grooves-macro.nc", ["Q[#100*180000]", "Q[#100*170000]"], "starts "),
        ("blunt-start.ngc", ["Z0 T0.9 D0.1", "Z0 T0.7 D0.1"], "blunt start: 0.7"),
        ("blunt-start.ngc", ["Z0 T0.9 D0.1", "Z0 T1.2 D0.1"], "has to be whole from 1 on"),
        ("blunt-start.ngc", ["Z0 T0.9 D0.1", "Z-1 T0.9 D0.1"], "blunt start: "),
        ("blunt-start.ngc", ["Z0 T0.9 D0.1", "Z0 T0.9 D0.7"], "has to be gone for 0.88"),
        ("tap-m8.ngc", ["K1.25", "K1.26"], "(the tap is fed by 1.26 mm in a turn, and its thread has 1.25)"),
        ("fanuc/tap-peck.nc", ["F1.25 Q6.", "F1.26 Q6."], "NO-GO goes in"),
        ("tap-m8.ngc", ["G0 X0 Z8", "G0 X0.1 Z8"], "(the tap stands 0.100 mm beside the axis of its hole)"),
        ("tap-npt.ngc", ["G33.1 Z-19 ", "G33.1 Z-21 "], "NO-GO goes in"),
        ("tap-npt.ngc", ["G33.1 Z-19 ", "G33.1 Z-17 "], "GO does not go in"),
        ("tap-m8.ngc", ["M8x1.25-6H", "M8x1.25-6g"], "and M8x1.25-6g is a screw"),
    ] {
        let program = text(name);
        assert!(program.contains(from), "{name}: {from}");
        place.write("other.ngc", program.replace(from, to));
        if name.starts_with("fanuc") {
            place.write("other.nc", program.replace(from, to));
        }
        let file = if name.starts_with("fanuc") { "other.nc" } else { "other.ngc" };
        let answer = run(&place, file);
        let said = format!("{name}, {to}: {}{}", answer.stdout, answer.stderr);
        let mut reasons = answer.stderr.lines().filter(|line| line.starts_with("not good: "));
        if answer.status != Some(3) || !reasons.any(|line| line.contains(why)) {
            others.push(said);
        }
    }
    assert!(others.is_empty(), "{}", others.join("\n\n"));
}

/// A tap of two starts cuts both grooves at once; of another lead it makes them too wide.
#[test]
fn a_tap_of_two_starts_is_judged() {
    let place = Place::new();
    let program = text("tap-m8.ngc").replace("M8x1.25-6H", "M12x3P1.5-6H").replace("Z8\n", "Z12\n");
    assert!(program.contains("Z-18 K1.25 I1.5") && program.contains("S500"));
    for (lead, verdict) in [("K3", "good"), ("K3.06", "bad")] {
        let program = program.replace("S500", "S300").replace("K1.25", lead);
        place.write("other.ngc", program);
        let answer = run(&place, "other.ngc");
        let summary = std::fs::read_to_string(place.at("out/summary.json")).expect("a summary");
        let summary: Value = serde_json::from_str(&summary).expect("a document");
        assert_eq!(summary["gauge"]["verdict"], verdict, "{lead}: {}{}", answer.stdout, answer.stderr);
    }
}

/// A tapered tap leaves its own cone, as far as each of its three flutes came: every millimetre that it goes
/// deeper makes the hole wider by the taper.
#[test]
fn a_tapered_tap_is_judged_by_how_deep_it_goes() {
    let place = Place::new();
    let program = text("tap-npt.ngc");
    let plain = path("machines/plain-lathe.toml").display().to_string();
    let tapped = |depth_mm: f64, name: &str| {
        let program = program.replace("1/2-14 NPT internal tap 19", name);
        place.write("other.ngc", program.replace("G33.1 Z-19 ", &format!("G33.1 Z-{depth_mm} ")));
        run_on(&place, "other.ngc", &plain);
        let summary = std::fs::read_to_string(place.at("out/summary.json")).expect("a summary");
        serde_json::from_str::<Value>(&summary).expect("a document")["gauge"].clone()
    };
    // ASME B1.20.1: E1 of 1/2-14 is 0.77843 in, the taper 1 in 16, a turn to either side is good.
    let (e1_mm, pitch_mm) = (25.4 * 0.77843, 25.4 / 14.0);
    for (depth_mm, good) in [(18.0, true), (19.0, true), (20.0, true), (21.0, false), (17.0, false)] {
        let gauge = tapped(depth_mm, "1/2-14 NPT internal tap 19");
        assert_eq!(gauge["verdict"] == "good", good, "{depth_mm}: {gauge:#}");
        let measured = |of: &str| gauge[format!("pitch_diameter_{of}_mm")].as_f64().expect("a diameter");
        // The way out lies 5 um beside the way in, which widens the groove by 1.7 times as much.
        let wider = measured("max") - (e1_mm + (depth_mm - 19.0) / 16.0);
        assert!((0.0..0.015).contains(&wider), "{depth_mm}: {wider} mm beyond the cone");
        let third = measured("max") - measured("min") - pitch_mm / 3.0 / 16.0;
        assert!(third.abs() < 0.003, "{depth_mm}: {third} mm beside a third of a turn");
    }
    // Nobody says where the tap has its diameter: no verdict.
    let gauge = tapped(19.0, "1/2-14 NPT internal");
    assert_eq!(gauge["verdict"], "none", "{gauge:#}");
    for (name, why) in [("M8x1.25-6H tap 19", "tapered"), ("1/2-14 NPT internal tap x", "is not a length")] {
        place.write("other.ngc", program.replace("1/2-14 NPT internal tap 19", name));
        let answer = place.ask(&["check", "other.ngc"]);
        assert!(answer.status == Some(2) && answer.stderr.contains(why), "{name}: {}", answer.stderr);
    }
}

/// The holes of a mill are judged one by one: the second is cut otherwise, or a hole twice, a little beside.
#[test]
fn the_taps_of_a_mill_are_judged_hole_by_hole() {
    let place = Place::new();
    let mill = path("machines/small-mill.toml").display().to_string();
    let program = text("mill/tap-m6.ngc");
    let second = "G0 X30\nG33.1 Z-14 K1\n";
    for (to, verdict, why) in [
        (second, "good", ""),
        ("G0 X30\nG33.1 Z-14 K1.01\n", "bad", "hole at X 30.000 Y 20.000 of the machine: NO-GO goes in"),
        ("G0 Y20.1\nG33.1 Z-14 K1\n", "bad", "NO-GO goes in"),
        ("G0 X10.1\nG33.1 Z-14 K1\n", "bad", "NO-GO goes in"),
        ("G0 X30\nG4 P0.1\n", "good", ""),
    ] {
        assert!(program.contains(second));
        place.write("other.ngc", program.replace(second, to));
        let answer = run_on(&place, "other.ngc", &mill);
        let summary = std::fs::read_to_string(place.at("out/summary.json")).expect("a summary");
        let summary: Value = serde_json::from_str(&summary).expect("a document");
        let gauge = &summary["gauge"];
        let told = gauge["reasons"][0].as_str().unwrap_or_default();
        assert!(gauge["verdict"] == verdict && told.contains(why), "{to}: {gauge:#} {}", answer.stderr);
        assert_eq!(summary["part"]["verdict"], verdict, "{to}");
        assert_eq!(answer.status, Some(if verdict == "good" { 0 } else { 3 }), "{to}: {}", answer.stderr);
    }
}

/// A block has ends as a bar has: what is in it of a tapped hole has the figures that it has without it, at
/// any depth; of a hole through it that is all of the block. A verdict it has not, where nothing drilled it.
#[test]
fn the_taps_of_a_block_are_judged_as_those_of_a_plate_that_nobody_described() {
    let place = Place::new();
    let mill = path("machines/small-mill.toml").display().to_string();
    let program = text("mill/tap-m6.ngc");
    let gauge = |block_mm: Option<f64>, tap: &str| -> Value {
        let part = block_mm.map_or(String::new(), |mm| format!("(part, block X0 Y0 Z{mm} X40 Y40 Z0)\n"));
        place.write("block.ngc", format!("{part}{}", program.replace("G33.1 Z-14 K1", tap)));
        let answer = run_on(&place, "block.ngc", &mill);
        assert_eq!(answer.status, Some(0), "{tap} in {part}: {}", answer.stderr);
        let summary = std::fs::read_to_string(place.at("out/summary.json")).expect("a summary");
        serde_json::from_str::<Value>(&summary).expect("a document")["gauge"].clone()
    };
    let length = |gauge: &Value| gauge["length_mm"].as_f64().expect("a length");
    for tap in ["G33.1 Z-14 K1", "G33.1 Z-12 K1", "G33.1 Z-10 K1", "G84 X10 Y20 Z-12 R5 F600"] {
        let (plate, block) = (gauge(None, tap), gauge(Some(-20.0), tap));
        assert_eq!((&plate["verdict"], &block["verdict"]), (&"good".into(), &"none".into()), "{block:#}");
        assert!(block["reasons"][0].as_str().is_some_and(|why| why.contains("nothing drilled")), "{block:#}");
        for figure in ["pitch_diameter_max_mm", "virtual_pitch_diameter_mm"] {
            let [plate, block] = [&plate, &block].map(|gauge| gauge[figure].as_f64().expect("a diameter"));
            assert!((plate - block).abs() < 0.002, "{tap}, {figure}: {plate} {block}");
        }
        assert!(length(&block) <= length(&plate), "{tap}: {plate:#} {block:#}");
    }
    let through = gauge(Some(-8.0), "G33.1 Z-14 K1");
    assert!(through["verdict"] == "none" && (length(&through) - 8.0).abs() < 1.01, "{through:#}");
}

/// `docs/gauge.md` shows what is said of the example.
#[test]
fn the_page_shows_what_is_said_of_a_groove() {
    let place = Place::new();
    let page = std::fs::read_to_string(project().join("docs/gauge.md")).expect("there is a page");
    for name in ["fanuc/variable-lead.nc", "tap-m8.ngc"] {
        let answer = run(&place, path(name).to_str().expect("a path"));
        let mut lines =
            answer.stdout.lines().filter(|line| line.starts_with("groove ") || line.starts_with("gauge "));
        let line = lines.next().expect("a verdict");
        assert!(page.contains(&format!("\n{line}\n")), "{line}");
    }
}

#[test]
fn a_drawing_that_cannot_be_read_is_refused() {
    let place = Place::new();
    let program = text("scroll.ngc");
    for (drawing, why) in [
        ("(groove, face, D30 Z-1 K4)", "2 to 64 rows"),
        ("(groove, D30 Z-1 K4, Q5)", "\"Q5\" is not understood"),
        ("(groove, D30 Z-1 K4, Z-5)\n(groove, D30 Z-1 K4, Z-6)", "another groove"),
    ] {
        let from = "(groove, face, D30 Z-1 K4, D86, within 0.02)";
        assert!(program.contains(from));
        place.write("wrong.ngc", program.replace(from, drawing));
        let answer = place.ask(&["check", "wrong.ngc"]);
        let said = answer.stdout + &answer.stderr;
        assert!(
            answer.status == Some(2) && said.contains("bad-groove") && said.contains(why),
            "{drawing}: {said}"
        );
    }
}
