//! How long programs take: what `check` foretells, what the machine takes, and what planning ahead is worth.

use std::path::{Path, PathBuf};

use crate::shop::{Place, project};
use machine::Machine;
use motion::{FeedBlock, Limits};
use protocol::Axis;

/// A machine file with travel for programs that were written for other machines: that of the lathe, or of the
/// mill.
fn machine_file(place: &Place, mill: bool) -> PathBuf {
    let name = if mill { "small-mill" } else { "small-lathe" };
    let shipped = project().join("examples/machines").join(name).with_extension("toml");
    let text = std::fs::read_to_string(shipped).expect("examples are shipped");
    let line = |line: &str| match line.starts_with("travel_mm") {
        true => "travel_mm = [-1000.0, 1000.0]\n".to_owned(),
        false => format!("{line}\n"),
    };
    place.write(&format!("{name}.toml"), text.lines().map(line).collect::<String>())
}

/// The tools of the jobs.
const TOOLS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/conformance/tool.tbl");

/// Time that `check` foretells, s.
fn foretold(place: &Place, program: &str, machine: &str) -> f64 {
    let answer = place.ask(&["check", program, "--machine", machine, "--tools", TOOLS, "--json"]);
    assert_eq!(answer.status, Some(0), "{program}: {}", answer.stdout);
    let document: serde_json::Value = serde_json::from_str(&answer.stdout).expect("a document");
    document["time_s"].as_f64().expect("a time")
}

/// Time on the machine, s.
fn taken(place: &Place, program: &str, machine: &str) -> f64 {
    let options = ["--machine", machine, "--tools", TOOLS, "--in-process", "--trace", "none"];
    place.run(Path::new(program), "out", &options).simulated_s
}

/// A winding curve around the origin in 0.2 mm pieces, radii from 27 to 80 mm.
fn contour(pieces: u32, mode: &str) -> String {
    let mut text = format!("G21 G90 G94 G17 {mode} F3000\nG0 X0 Y0\n");
    let (mut x, mut y, mut heading) = (0.0, 0.0, 0.0);
    for i in 0..pieces {
        heading += 0.2 / 40.0 * (1.0 + 0.5 * libm::sin(f64::from(i) / 70.0));
        let (s, c) = libm::sincos(heading);
        (x, y) = (x + 0.2 * c, y + 0.2 * s);
        text += &format!("G1 X{x:.6} Y{y:.6}\n");
    }
    text + "M2\n"
}

#[test]
fn twenty_thousand_short_lines_take_the_time_of_their_feed() {
    let place = Place::new();
    let file = machine_file(&place, true);
    let machine = file.to_str().expect("a path in UTF-8");
    place.write("contour.ngc", contour(20_000, "G64 P0.01"));
    place.write("stops.ngc", contour(20_000, "G61.1"));
    let (foretold_s, taken_s) =
        (foretold(&place, "contour.ngc", machine), taken(&place, "contour.ngc", machine));
    assert!((foretold_s / taken_s - 1.0).abs() < 0.01, "{foretold_s} s foretold, {taken_s} s taken");
    let way_s = 20_000.0 * 0.2 / 50.0;
    assert!(taken_s < 1.01 * way_s, "{taken_s} s for a way of {way_s} s at its feed");

    // With a stop at every end each piece is a block from rest to rest, with the limits of one axis divided
    // by its share in the direction: 1 along an axis, the root of a half across.
    let stops = foretold(&place, "stops.ngc", machine);
    let text = std::fs::read_to_string(&file).expect("it was written");
    let axis = Machine::from_toml(&text).expect("it is right").axis[&Axis::X].limits();
    let alone = |k: f64| {
        let limits = Limits { v: k * axis.v, a: k * axis.a, j: k * axis.j, dj: k * axis.dj };
        20_000.0 * FeedBlock::plan(0.2, 0.0, 50.0, 0.0, &limits).expect("rest to rest").duration()
    };
    let (least, most) = (alone(std::f64::consts::SQRT_2), alone(1.0));
    assert!((least..most * 1.01).contains(&stops), "{stops} s with stops, {least} … {most} s by the block");
    assert!(stops / foretold_s > least / way_s * 0.98, "{} times as fast", stops / foretold_s);
}

#[test]
fn check_foretells_the_time_of_jobs_and_examples() {
    let place = Place::new();
    let machines = [machine_file(&place, false), machine_file(&place, true)];
    for (file, mill) in [
        ("tests/conformance/programs/job_groove_part_off.ngc", 0),
        ("tests/conformance/programs/job_thread_m20.ngc", 0),
        ("tests/conformance/programs/job_mill_pocket_helix.ngc", 1),
        ("examples/shaft.ngc", 0),
        ("examples/mill/contour.ngc", 1),
        ("examples/m20x2.ngc", 0),
        ("examples/worm-left.ngc", 0),
        ("examples/internal-m30.ngc", 0),
    ] {
        let program = project().join(file);
        let [program, machine] =
            [&program, &machines[mill]].map(|path| path.to_str().expect("a path in UTF-8"));
        let place = Place::new();
        let (foretold, taken) = (foretold(&place, program, machine), taken(&place, program, machine));
        let off = foretold / taken - 1.0;
        // A run ends when the spindle has come to rest: what the loop of the mill's swings over at 8000 1/min
        // nobody foretells.
        let most = if file == "examples/mill/contour.ngc" { 0.02 } else { 0.01 };
        assert!(off.abs() < most, "{file}: {foretold} s foretold, {taken} s taken, {:.2} %", 100.0 * off);
    }
}

/// What docs/motion.md says of the jobs: their moves are long, and planning ahead is worth less than a
/// hundredth there.
#[test]
fn jobs_of_long_moves_gain_nothing_by_planning_ahead() {
    let place = Place::new();
    let machines = [machine_file(&place, false), machine_file(&place, true)];
    for (name, mill) in [
        ("job_turn_shaft", 0),
        ("job_groove_part_off", 0),
        ("job_thread_m20", 0),
        ("job_mill_pocket_helix", 1),
    ] {
        let machine = machines[mill].to_str().expect("a path in UTF-8");
        let job = project().join("tests/conformance/programs").join(name).with_extension("ngc");
        let text = std::fs::read_to_string(&job).expect("it is there");
        let stops = text.replacen('\n', "\nG61.1\n", 1).replace("G64 P", "G61.1 (P)").replace("G64", "G61.1");
        place.write("stops.ngc", stops);
        let ahead = foretold(&place, job.to_str().expect("a path in UTF-8"), machine);
        let factor = foretold(&place, "stops.ngc", machine) / ahead;
        assert!((factor - 1.0).abs() < 0.01, "{name}: {factor}");
    }
}

/// What ARCHITECTURE.md says of merging: a circle in short and very short chords, rounded to a thousandth,
/// with and without it.
#[test]
fn very_short_lines_that_were_rounded_are_merged() {
    let place = Place::new();
    let mill = machine_file(&place, true);
    let page = std::fs::read_to_string(project().join("ARCHITECTURE.md")).expect("it is there");
    let page = page.split_whitespace().collect::<Vec<_>>().join(" ");
    for (chords, said) in [(1000, " merging"), (10_000, "")] {
        let [alone, merged] = ["Q0", ""].map(|q| {
            let mut text = format!("G21 G17 G64 P0.01 {q} F3000\nG0 X20 Y0\n");
            for i in 1..=chords {
                let (s, c) = libm::sincos(f64::from(i) * std::f64::consts::TAU / f64::from(chords));
                text += &format!("G1 X{:.3} Y{:.3}\n", 20.0 * c, 20.0 * s);
            }
            place.write("circle.ngc", text + "M2\n");
            foretold(&place, "circle.ngc", mill.to_str().expect("a path in UTF-8"))
        });
        let sentence = format!("{alone:.1} s without{said}, {merged:.1} s with");
        assert!(page.contains(&sentence), "{sentence}");
        assert!(merged < 3.0, "{sentence}: 2.5 s at the feed");
    }
}
