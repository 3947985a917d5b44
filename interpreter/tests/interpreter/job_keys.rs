//! Keys of jobs that are wrong: what is said, and which line it points at.

use gcode::{Program, files::ToolTable};
use interpreter::{Check, check, check_job, check_program};
use machine::{Machine, POSITIONER};

use super::jobs::{WAVE, mill};

const SEAM: &str = include_str!("../../../examples/positioner/cylinders.toml");
const POINTS: &str = include_str!("../../../examples/positioner/points.toml");

fn positioner() -> Machine {
    Machine::from_toml(POSITIONER).expect("the built-in positioner")
}

/// The only thing that is said: code, message and help, and the text of the line it points at.
fn only(check: &Check) -> (String, String) {
    let said: String = check.diagnostics.iter().map(|one| one.render(false)).collect();
    let [wrong] = check.diagnostics.as_slice() else { panic!("{said}") };
    (format!("{} | {} | {}", wrong.code, wrong.message, wrong.help), wrong.text.clone())
}

/// Of a job with a change: what is said has these words, and points at a line that begins so.
fn says(job: &str, [from, to]: [&str; 2], machine: &Machine, words: &[&str], line: &str) {
    assert!(job.contains(from), "{from}");
    let (said, at) = only(&check_job("job.toml", &job.replacen(from, to, 1), machine));
    assert!(words.iter().all(|words| said.contains(words)), "{to}: {said}");
    assert!(at.trim_start().starts_with(line), "{to}: {at}");
}

#[test]
fn an_array_has_as_many_values_as_there_must_be() {
    let three = ["3 values where there must be 2"];
    let four = ["4 values where there must be 3"];
    says(WAVE, ["x = [0, 100]", "x = [0, 100, 110]"], &mill(), &three, "x = ");
    says(WAVE, ["-170]", "-170, 5]"], &mill(), &four, "origin_mm");
    let path = "path = { pattern = \"curve\", x = \"10*t\", y = \"9\", t = [0, 2, 3] } #";
    says(WAVE, ["path = {", path], &mill(), &three, "path");
    says(SEAM, ["370.0]", "370.0, 1]"], &positioner(), &three, "angle_deg");
    says(SEAM, ["at_mm = [", "at_mm = [0, "], &positioner(), &four, "first");
    says(SEAM, ["axis = [", "axis = [0, "], &positioner(), &four, "first");
    says(POINTS, ["1.00]", "1.00, 1]"], &positioner(), &["7 values where there must be 6"], "[ 30.0");
    for key in ["beam_mm", "travel_mm"] {
        let machine = POSITIONER.replacen(&format!("{key} = ["), &format!("{key} = [1.0, "), 1);
        assert!(machine != POSITIONER && Machine::from_toml(&machine).is_err(), "{key}");
    }
}

#[test]
fn a_machine_of_another_kind_comes_before_what_it_lacks() {
    says(WAVE, ["12000", "9000"], &Machine::plain(), &["a surface needs a mill"], "kind");
    says(WAVE, ["12000", "9000"], &positioner(), &["a surface needs a mill"], "kind");
    let spindle = ["share", "spindle_rpm = 3\nshare"];
    says(SEAM, spindle, &mill(), &["a seam needs a positioner"], "kind");
    says(SEAM, spindle, &positioner(), &["has no spindle", "leave spindle_rpm out"], "spindle_rpm");
}

#[test]
fn unknown_keys_come_before_missing_ones_with_those_of_their_table() {
    says(WAVE, ["feed_mm_min", "feed"], &mill(), &["`feed`", "feed_mm_min"], "feed = ");
    says(
        WAVE,
        ["along =", "allong ="],
        &mill(),
        &["`allong`", "`pattern`", "`along`", "keys of path"],
        "path",
    );
    says(WAVE, ["diameter_mm", "diameter"], &mill(), &["`diameter`", "`corner_mm`", "keys of tool"], "tool");
    let words = ["`radius_mm`", "`half_angle_deg`", "keys of second"];
    says(SEAM, ["diameter_mm = 60.0", "radius_mm = 30.0"], &positioner(), &words, "second");
}

#[test]
fn what_leaves_the_travel_points_at_the_key_that_says_it() {
    says(WAVE, ["[-50,", "[-500,"], &mill(), &["X would go from", "give origin_mm ", " for X"], "origin_mm");
    let wide = "x = [0, 1000]\ny = [0, 10]\npath = { pattern = \"lines\", step_mm = 5 } #";
    let job = WAVE.replace("0.02*x^2 + 8*sin(x/15)*cos(y/20)", "0*x").replace("y = [0, 80]\n", "");
    let job = job.replace("path = { pattern = \"lines\", along = \"x\", scallop_mm = 0.01 }\n", "");
    says(&job, ["x = [0, 100]", wide], &mill(), &["more than X can travel: change x"], "x = ");
    says(
        WAVE,
        ["clearance_mm = 5", "clearance_mm = 40"],
        &mill(),
        &["Z would go from", "lower clearance_mm"],
        "clearance_mm",
    );
    let far = ["share", "origin_mm = [3000, 0, 0]\nshare"];
    says(SEAM, far, &positioner(), &["travel"], "origin_mm");
}

#[test]
fn tools_of_a_job_are_those_of_the_table() {
    let with = |table: &str| {
        let tools = ToolTable::parse("tool.tbl", table).expect("a table");
        let options = gcode::Options { tools, ..gcode::Options::default() };
        check_program(Program::from_job("job.toml", WAVE, &options), &mill(), |_| {})
    };
    let (said, at) = only(&with("T1 P1 D6\n"));
    assert!(said.starts_with("unknown-tool | tool 3 is not in the tool table"), "{said}");
    assert!(at.starts_with("tool_number"), "{at}");
    let other = with("T3 P3 D4\n");
    let (said, at) = only(&other);
    assert!(said.contains("diameter of 4 mm in the tool table, that of the job 6 mm"), "{said}");
    assert!(other.is_good() && at.starts_with("tool = "), "{at}");
    assert!(with("T3 P3 D6\n").diagnostics.is_empty());
}

#[test]
fn a_feed_that_no_place_allows_is_a_warning() {
    let check = check_job("job.toml", &WAVE.replace("= 3000", "= 300000"), &mill());
    let (said, at) = only(&check);
    assert!(check.is_good() && at.starts_with("feed_mm_min"), "{at}: {said}");
    let highest = said.split("the axes allow at most ").nth(1).and_then(|rest| rest.split(' ').next());
    let highest: f64 = highest.unwrap_or_else(|| panic!("{said}")).parse().unwrap();
    let fastest = mill().axis.values().map(|axis| 60.0 * axis.velocity_mm_s).fold(0.0, f64::max);
    assert!((3000.0..1.8 * fastest).contains(&highest), "{highest}");
    let just = WAVE.replace("= 3000", &format!("= {}", highest - 1.0));
    assert!(check_job("job.toml", &just, &mill()).diagnostics.is_empty());
}

#[test]
fn places_and_numbers_are_told_so_that_people_can_read_them() {
    let path = "path = { pattern = \"curve\", x = \"50\", y = \"40\", t = [0, 2] } #";
    says(
        WAVE,
        ["path =", path],
        &mill(),
        &["at t = 0.0000, x = 50.0000, y = 40.0000: it stands still"],
        "path",
    );
    let share = ["share = 2 is not between 0 and 1 |"];
    says(SEAM, ["share = 0.5", "share = 2"], &positioner(), &share, "share");
    let twice = "  [ 32.0, -12.0, 22.5,  0.66, -0.15, 1.00],\n  [ 32.0,";
    says(POINTS, ["  [ 32.0,", twice], &positioner(), &["points 2 and 3 are one"], "points");
}

#[test]
fn two_thousand_points_are_a_job() {
    let row = |n: i32| {
        let (sin, cos) = libm::sincos(f64::from(n) * 0.003);
        format!(
            "[{:.15}, {:.15}, 40.000000000000001, {cos:.15}, {sin:.15}, 1.732050807568877],\n",
            35.0 * cos,
            35.0 * sin
        )
    };
    let rows: String = (0..2000).map(row).collect();
    let job = format!("kind = \"seam\"\nfeed_mm_min = 600\npoints = [\n{rows}]\n");
    assert!(job.len() > 150_000);
    let check = check_job("job.toml", &job, &positioner());
    assert!(check.is_good(), "{:?}", check.diagnostics.first().map(|one| &one.message));
}

#[test]
fn parameters_are_not_read_in_jobs() {
    let words = ["parameters such as #1 are not read in jobs"];
    says(WAVE, ["x = [0, 100]", "x = [0, #1]"], &mill(), &words, "");
    says(WAVE, ["0.02*x^2", "#1*x^2"], &mill(), &words, "z = ");
    let job = ";@ kind = \"contour\"\n;@ y = \"x/2\"\n;@ x = [0, 20]\n;@ depth_z_mm = #2\n";
    let check = check("part.ngc", &format!("G21 S1000 M3 F300\n{job}M2\n"), &mill());
    assert!(only(&check).0.contains(words[0]), "{}", only(&check).0);
}

/// A machine file in the place of a program is named as such.
#[test]
fn a_machine_file_is_not_a_job() {
    let check = check_job("lathe.toml", machine::SMALL_LATHE, &mill());
    let [found] = &check.diagnostics[..] else { panic!("{:#?}", check.diagnostics) };
    assert_eq!((found.code, &*found.message), ("job", "this is a machine file, and not a program"));
    assert!(found.help.contains("pitchlock run PROGRAM --machine FILE"), "{}", found.help);
}
