//! `pitchlock pick-up`: a thread is found from a file of touches; what is refused names the file, the line or
//! the touch, and the remedy.

use serde_json::Value;

use crate::shop::Place;

/// A thread of lead −2 through Z −3.2 at angle 0, on a taper of X.
const TOUCHES: &str =
    "# angle, Z, X\n0, -3.2, 9.0\n\n180.0  -12.2 8.91 # the fourth groove\n72 -19.6 8.836\n";

#[test]
fn a_thread_is_found_and_the_start_point_told() {
    let place = Place::new();
    place.write("touches.txt", TOUCHES);
    let asked = ["pick-up", "touches.txt", "--lead", "-2", "--start", "8"];
    let answer = place.ask(&[&asked[..], &["--json"]].concat());
    assert_eq!(answer.status, Some(0), "{}", answer.stderr);
    let found: Value = serde_json::from_str(&answer.stdout).expect("one document and nothing else");
    let near = |value: &Value, wanted: f64| {
        let value = value["value"].as_f64().expect("a number");
        assert!((value - wanted).abs() < 1e-6, "{value}, not {wanted}: {found}");
    };
    near(&found["lead_mm"], -2.0);
    near(&found["taper"], 0.01);
    near(&found["start_mm"], 8.8);
    let told = place.ask(&asked);
    assert!(told.stdout.contains("start     at Z 8.8000 mm ±"), "{}", told.stdout);
}

/// The example of a part that was re-chucked starts where its touches say, beside where its groove was put,
/// and not by what was put there.
#[test]
fn the_example_of_a_rechucked_part_starts_where_its_touches_say() {
    let place = Place::new();
    let touches = include_str!("../../examples/rechucked/touches.txt");
    let program = include_str!("../../examples/rechucked/thread.ngc");
    place.write("touches.txt", touches);
    let told = place.ask(&["pick-up", "touches.txt", "--lead", "-2", "--start", "8"]).stdout;
    let z = told.split("start     at Z ").nth(1).and_then(|rest| rest.split(' ').next()).expect("it is told");
    let [first, second]: [&str; 2] =
        program.split("M6\n").nth(1).zip(program.split("M6  ").nth(1)).expect("two").into();
    assert!(first.contains("G0 X22 Z8.731\n") && second.contains(&format!("G0 X22 Z{z} ")), "{told}");
    let apart = z.parse::<f64>().expect("a number") - 8.731;
    assert!(apart != 0.0 && apart.abs() < 0.0077, "{apart}");
}

#[test]
fn what_is_no_such_thread_and_no_such_file_is_refused_with_its_reason() {
    let place = Place::new();
    place.write("touches.txt", TOUCHES);
    place.write("words.txt", "0 -3.2\n90 here\n");
    place.write("long.txt", "0 1 2 3\n");
    place.write("few.txt", "0 -3.2\n90 -3.7\n");
    for (file, lead, status, words) in [
        ("touches.txt", "-1.75", 1, "not touches of one thread of lead -1.75 mm"),
        ("touches.txt", "0", 2, "the lead is not 0"),
        ("words.txt", "-2", 2, "line 2: here is not a number"),
        ("long.txt", "-2", 2, "line 1: a touch is an angle, Z, and perhaps X"),
        ("few.txt", "-2", 2, "3 touches at least"),
        ("missing.txt", "-2", 2, "missing.txt"),
    ] {
        let answer = place.ask(&["pick-up", file, "--lead", lead]);
        assert_eq!(answer.status, Some(status), "{file} {lead}: {} {}", answer.stdout, answer.stderr);
        assert!(answer.stderr.contains(words), "{file} {lead}: {}", answer.stderr);
    }
}

#[test]
fn a_start_that_is_not_known_well_enough_enters_no_groove_and_is_not_told() {
    let place = Place::new();
    place.write("touches.txt", TOUCHES);
    let asked = ["pick-up", "touches.txt", "--lead", "-2"];
    for (more, status, words) in [
        (["--start", "nan"], 2, "--start NaN"),
        (["--start", "1e300"], 2, "--start 1"),
        (["--start", "50000"], 1, "more than a tenth of the pitch"),
    ] {
        let answer = place.ask(&[&asked[..], &more].concat());
        assert_eq!(
            (answer.status, answer.stdout.as_str()),
            (Some(status), ""),
            "{more:?}: {}",
            answer.stderr
        );
        assert!(answer.stderr.contains(words), "{more:?}: {}", answer.stderr);
    }
}
