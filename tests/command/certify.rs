//! What threads will be, told before anything is cut: `check --certify`, beside a run of the same program.

use serde_json::Value;

use crate::shop::{Place, project};

/// Two passes straight in, one that rubs, and a pause between the second and the rest.
const THREAD: &str = "G18 G21 G90 G7 G94 G97\nS600 M3\nG0 X22 Z8\n(MSG, look)\nM0\n\
                      G76 P2 Z-20 I-2.18 J0.8 K1.634 R1 Q29.5\nG0 X40\nM5\nM2\n";

fn steel(place: &Place) {
    let lathe =
        std::fs::read_to_string(project().join("examples/machines/small-lathe.toml")).expect("a lathe");
    place.write("steel.toml", lathe.replace("specific_force_n_mm2 = 0.0", "specific_force_n_mm2 = 2000.0"));
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

#[test]
fn a_certificate_says_what_the_run_then_does() {
    let place = Place::new();
    steel(&place);
    let part = THREAD.replace("M0\n", "");
    place.write("part.ngc", format!("(thread, M20x2-6g)\n{part}"));
    let args = ["--machine", "steel.toml", "--seed", "7"];
    let check = place.ask(&[&["check", "part.ngc", "--certify", "--json"][..], &args].concat());
    let document: Value = serde_json::from_str(&check.stdout).expect("a document");
    let run = ["run", "part.ngc", "--in-process", "--trace", "none", "--out", "out"];
    let run = place.ask(&[&run[..], &args].concat());
    let text = std::fs::read_to_string(place.at("out/summary.json")).expect("a summary");
    let summary: Value = serde_json::from_str(&text).expect("a document");
    assert_eq!(check.status, run.status, "{}{}", check.stdout, run.stderr);
    // Plain `check` tells chips and the warning as well.
    let plain = place.ask(&["check", "part.ngc", "--machine", "steel.toml", "--json"]);
    let plain: Value = serde_json::from_str(&plain.stdout).expect("a document");
    let told: Vec<&Value> =
        plain["diagnostics"].as_array().expect("a list").iter().map(|one| &one["code"]).collect();
    assert_eq!(told, ["thin-chip"]);
    for (pass, row) in plain["passes"]
        .as_array()
        .expect("passes")
        .iter()
        .zip(document["certificate"]["passes"].as_array().expect("rows"))
    {
        assert_eq!((&pass["chip_mm"], &pass["deeper_mm"]), (&row["chip_mm"], &row["deeper_mm"]));
    }

    let certificate = &document["certificate"];
    assert_eq!(
        (&certificate["verdict"], &certificate["reasons"]),
        (&summary["part"]["verdict"], &summary["part"]["reasons"])
    );
    let rows = certificate["passes"].as_array().expect("rows");
    let passes = summary["passes"].as_array().expect("passes");
    assert_eq!((rows.len(), passes.len()), (3, 3));
    for (row, pass) in rows.iter().zip(passes) {
        assert_eq!(row["helix_um"], pass["tool"]["helix_max_abs_um"]);
        for (key, of) in
            [("force_n", "force_max_n"), ("torque_nm", "torque_max_nm"), ("power_kw", "power_max_kw")]
        {
            assert_eq!(row[key], pass["cutting"][of], "{key}");
        }
        // 600 1/min, times what the axes can follow.
        assert!((number(&row["highest_rpm"]) - 6.0 * number(&row["highest_override_pct"])).abs() < 1e-9);
    }
    // Radii of the program: 0.4 each, and the rest; along the flank of 29.5° by Q, on the one of 30° that the
    // gauge names: Δd sin 30° + Δd tan 29.5° cos 30°.
    let deeper: Vec<f64> = rows.iter().map(|row| number(&row["deeper_mm"])).collect();
    for (deeper, told) in deeper.iter().zip([0.4, 0.4, 0.017]) {
        assert!((deeper - told).abs() < 1e-6, "{deeper} {told}");
    }
    let by_flank = 0.4 * (0.5 + libm::tan(29.5f64.to_radians()) * 0.75f64.sqrt());
    for (row, told) in rows.iter().zip([0.2, by_flank]) {
        assert!((number(&row["chip_mm"]) - told).abs() < 1e-6, "{row} {told}");
    }
    let notes = certificate["notes"].to_string();
    assert!(
        notes.contains("line 6: a pass goes no more than 0.017 mm deeper") && notes.contains("rubs"),
        "{notes}"
    );
}

/// Where the speed is varied, too: the override is that of the mean speed.
#[test]
fn the_highest_override_is_the_one_that_check_tells() {
    let place = Place::new();
    for (name, varied) in [("even", ""), ("varied", "(speed_variation, sine, 5, 4)\n")] {
        place.write(&format!("{name}.ngc"), format!("{varied}{}", THREAD.replace("M0\n", "")));
        let answer = place.ask(&["check", &format!("{name}.ngc"), "--certify", "--json"]);
        let document: Value = serde_json::from_str(&answer.stdout).expect("a document");
        let told = |rows: &Value, key: &str| {
            rows.as_array().expect("rows").iter().map(|row| number(&row[key])).collect::<Vec<_>>()
        };
        let certified = told(&document["certificate"]["passes"], "highest_override_pct");
        assert_eq!(certified, told(&document["passes"], "max_override_pct"), "{name}");
        assert_eq!(certified.len(), 3, "{name}");
    }
}

/// Nobody stands there who presses cycle start; and without forces that is said.
#[test]
fn pauses_are_gone_on_from_and_the_page_holds_what_the_table_does() {
    let place = Place::new();
    place.write("part.ngc", THREAD);
    let answer = place.ask(&["check", "part.ngc", "--certify", "--page", "part.html"]);
    assert_eq!(answer.status, Some(0), "{}{}", answer.stdout, answer.stderr);
    assert!(
        answer.stdout.contains("certificate: cut once on the simulated machine, seed 1: the part is good")
    );
    assert!(answer.stdout.contains("note: no forces"), "{}", answer.stdout);
    let page = std::fs::read_to_string(place.at("part.html")).expect("a page");
    assert!(page.contains("<title>pitchlock: certificate</title>"));
    let table = answer.stdout.split("certificate:").nth(1).expect("a certificate");
    let row = table.lines().find(|line| line.trim_start().starts_with("2     6")).expect("pass 2");
    for cell in row.split_whitespace() {
        assert!(page.contains(&format!("<td>{cell}</td>")), "{cell} of {row}");
    }
    let twice = place.ask(&["check", "part.ngc", "--certify", "--page", "part.ngc"]);
    assert_eq!(twice.status, Some(2), "a program is not a page: {}", twice.stderr);
}

#[test]
fn what_cannot_be_certified_is_said() {
    let place = Place::new();
    place.write("part.ngc", THREAD);
    place.write("plain.ngc", "G21 G90 G7 G94 F100\nG1 X30 Z5\nM2\n");
    place.write("wrong.ngc", "G21 G90 G99 Q\nM2\n");
    let plain = place.ask(&["check", "plain.ngc", "--certify"]);
    assert_eq!(plain.status, Some(0));
    assert!(plain.stdout.contains("certificate: none, there is no thread"), "{}", plain.stdout);
    let wrong = place.ask(&["check", "wrong.ngc", "--certify", "--json"]);
    assert_eq!(wrong.status, Some(2));
    assert!(!wrong.stdout.contains("\"certificate\""), "{}", wrong.stdout);
    for (args, said) in [
        (
            &["check", "part.ngc", "plain.ngc", "--certify", "--page", "p.html"][..],
            "--page is for one program",
        ),
        (&["check", "-", "--certify"], "standard input"),
        (&["check", "part.ngc", "--page", "p.html"], "--certify"),
    ] {
        let answer = place.ask(args);
        assert_eq!(answer.status, Some(2), "{args:?}");
        assert!(answer.stderr.contains(said), "{args:?}: {}", answer.stderr);
    }
    assert!(!place.at("p.html").exists());
}

/// A thread that no axis can follow any more is stopped short of its end, and the certificate is not good.
#[test]
fn a_part_that_would_not_be_good_has_status_3() {
    let place = Place::new();
    steel(&place);
    let lathe = std::fs::read_to_string(place.at("steel.toml")).expect("it was written");
    place
        .write("hard.toml", lathe.replace("specific_force_n_mm2 = 2000.0", "specific_force_n_mm2 = 20000.0"));
    place.write("part.ngc", THREAD.replace("J0.8", "J1.6"));
    let answer = place.ask(&["check", "part.ngc", "--certify", "--machine", "hard.toml"]);
    assert_eq!(answer.status, Some(3), "{}{}", answer.stdout, answer.stderr);
    assert!(answer.stdout.contains("not good") || answer.stdout.contains("note: fault"), "{}", answer.stdout);
}

/// `docs/certificate.md` shows what is printed.
#[test]
fn the_page_of_the_documents_shows_what_is_said() {
    let page = std::fs::read_to_string(project().join("docs/certificate.md")).expect("there is a page");
    let shown = page.split("```text\n").nth(1).and_then(|rest| rest.split("```").next()).expect("a sample");
    let place = Place::new();
    steel(&place);
    std::fs::copy(project().join("examples/m20x2.ngc"), place.at("m20x2.ngc")).expect("a copy");
    let answer = place.ask(&["check", "m20x2.ngc", "--machine", "steel.toml", "--certify"]);
    let said = answer.stdout.split_once("certificate:").map(|(_, rest)| format!("certificate:{rest}"));
    assert_eq!(said.as_deref(), Some(shown));
}

/// A tap goes to its depth along its axis: no figure of a turned pass is told of it.
#[test]
fn a_tap_is_certified_by_what_the_run_then_does() {
    let place = Place::new();
    let tap = std::fs::read_to_string(project().join("examples/tap-m8.ngc")).expect("a tap");
    place.write("tap.ngc", tap);
    let check = place.ask(&["check", "tap.ngc", "--certify", "--json", "--seed", "3"]);
    let document: Value = serde_json::from_str(&check.stdout).expect("a document");
    let run = place.ask(&["run", "tap.ngc", "--in-process", "--seed", "3", "--out", "out"]);
    assert_eq!((check.status, run.status), (Some(0), Some(0)), "{}{}", check.stdout, run.stderr);
    let text = std::fs::read_to_string(place.at("out/summary.json")).expect("a summary");
    let summary: Value = serde_json::from_str(&text).expect("a document");
    let certificate = &document["certificate"];
    assert_eq!(certificate["passes"].as_array().map(Vec::len), Some(0));
    for key in ["in_um", "turn_um", "out_um", "short_um"] {
        let (told, done) = (&certificate["taps"][0][key], &summary["passes"][0]["tap"][key]);
        assert!(told.is_number() && told == done, "{key}: {told} {done}");
    }
    // Nothing of it is a depth of X, and the page says so in its own table.
    assert_eq!(number(&summary["thread"]["tool_depth_off_um"]), 0.0);
    let report = std::fs::read_to_string(place.at("out/report.html")).expect("a report");
    assert!(report.contains("<h2>Taps</h2>") && report.contains("One tap was cut. It kept to the helix"));
    assert!(!report.contains("off in depth") && !report.contains("<h2>Passes</h2>"));
}
