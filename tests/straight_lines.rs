//! Machine code against straight lines of the same accuracy: how much smaller it is, and that the lines are a program.

mod shop;

use std::fs;

use shop::{Place, project};

#[test]
fn a_surface_is_a_hundred_times_smaller_than_its_straight_lines_and_these_are_a_program() {
    let place = Place::new();
    let [job, machine] = ["examples/shape/wave.toml", "examples/machines/small-mill.toml"]
        .map(|file| project().join(file).display().to_string());
    let answer = place.ask(&["compile", &job, "--machine", &machine, "-o", "wave.mc", "--g1", "wave.ngc"]);
    assert_eq!(answer.status, Some(0), "{}", answer.stderr);
    let [code, lines] = ["wave.mc", "wave.ngc"].map(|file| fs::read(place.at(file)).expect("it was written"));
    assert!(lines.len() >= 100 * code.len(), "{} {}", lines.len(), code.len());

    // What is said of them is what they are.
    let digits: String = answer.stdout.lines().last().unwrap_or_default().replace(' ', "");
    let blocks = lines.iter().filter(|byte| **byte == b'\n').count();
    for said in [
        format!("machinecode{}bytes;", code.len()),
        format!("accuracy{}bytesin{blocks}blocks:", lines.len()),
        format!("{}timesasmany", lines.len() / code.len()),
    ] {
        assert!(digits.contains(&said), "{said}: {}", answer.stdout);
    }

    let checked = place.ask(&["check", "wave.ngc", "--machine", &machine]);
    assert_eq!(checked.status, Some(0), "{}", checked.stderr);
    assert!(checked.stdout.starts_with("0 errors, 0 warnings"), "{}", checked.stdout);
}

#[test]
fn a_thread_has_no_straight_lines_and_is_refused_with_its_line() {
    let place = Place::new();
    place.write("thread.ngc", "G21 G90 G18 G8\nS500 M3\nG0 X11 Z5\nG33 Z-20 K1\nM2\n");
    let answer = place.ask(&["compile", "thread.ngc", "-o", "thread.mc", "--g1", "lines.ngc"]);
    assert_eq!(answer.status, Some(2), "{}", answer.stdout);
    assert!(answer.stderr.contains("line 4") && !answer.stderr.contains("panicked"), "{}", answer.stderr);
    assert!(!place.at("thread.mc").exists() && !place.at("lines.ngc").exists());
}
