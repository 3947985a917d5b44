//! Machine code against straight lines of the same accuracy: how much smaller it is, and that the lines are a
//! program.

use std::fs;

use crate::shop::{Place, project};

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
    let text = String::from_utf8(lines).expect("it is text");
    let (header, lines): (Vec<&str>, Vec<&str>) = text.lines().partition(|line| line.starts_with(';'));
    let bytes: usize = lines.iter().map(|line| line.len() + 1).sum();
    for said in [
        format!("machinecode{}bytes;", code.len()),
        format!("accuracy{bytes}bytesin{}blocks:", lines.len()),
        format!("{}timesasmany", bytes / code.len()),
    ] {
        assert!(digits.contains(&said), "{said}: {}", answer.stdout);
    }
    for told in
        ["wave.toml", "small mill", "z = 0.02*x^2 + 8*sin(x/15)*cos(y/20)", "ball of 6 mm", "0.002 mm", "G54"]
    {
        assert!(header.iter().any(|line| line.contains(told)), "{told}: {header:?}");
    }
    // Up, across, down.
    let rapids: Vec<&str> = lines.iter().copied().filter(|line| line.contains('Z')).skip(1).take(2).collect();
    assert!(rapids[0].starts_with("G0 Z") && rapids[1].starts_with('Z'), "{rapids:?}");

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
    for told in ["thread.ngc: line 4", "leave --g1 out", "thread.mc"] {
        assert!(answer.stderr.contains(told), "{told}: {}", answer.stderr);
    }
    assert!(place.at("thread.mc").exists() && !place.at("lines.ngc").exists());
}
