//! `pitchlock canon` and `pitchlock check --json`: what they print, what they write, and what they refuse.

use std::fs;
use std::io::Write;
use std::process::Stdio;

use crate::shop::{Answer, Place};

#[test]
fn canon_prints_in_millimetres_or_as_rs274_does() {
    let place = Place::new();
    place.write("part.ngc", "G20\nN010 G0 X1\nM2\n");
    let plain = place.ask(&["canon", "part.ngc"]);
    assert_eq!(plain.status, Some(0), "{}", plain.stderr);
    assert!(
        plain
            .stdout
            .starts_with("USE_LENGTH_UNITS(CANON_UNITS_MM)\nSTRAIGHT_TRAVERSE(25.4000, 0.0000, 0.0000)\n")
    );
    let linuxcnc = place.ask(&["canon", "-g", "part.ngc", "--format", "linuxcnc"]).stdout;
    assert!(
        linuxcnc
            .contains("\n    8 N010   STRAIGHT_TRAVERSE(1.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000)\n")
    );
    let answer = place.ask(&["canon", "part.ngc", "part.canon", "--format", "linuxcnc"]);
    assert_eq!(answer.stdout, "");
    assert_eq!(fs::read_to_string(place.at("part.canon")).unwrap(), linuxcnc);
}

#[test]
fn canon_reads_standard_input() {
    let place = Place::new();
    let mut process =
        place.pitchlock().arg("canon").stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
    process.stdin.take().unwrap().write_all(b"G0 X3\nM2\n").unwrap();
    let answer = Answer::from(process.wait_with_output().unwrap());
    assert_eq!(answer.status, Some(0));
    assert!(answer.stdout.contains("STRAIGHT_TRAVERSE(3.0000, 0.0000, 0.0000)\n"), "{}", answer.stdout);
}

#[test]
fn parameters_outlive_a_run_of_canon() {
    let place = Place::new();
    place.write("set.ngc", "G10 L2 P1 X7\n#100 = 5\n#31 = 2.5\nM2\n");
    place.write("lathe.var", "31\t0.0\n5161\t3.000000\n");
    let answer = place.ask(&["canon", "set.ngc", "-p", "lathe.var"]);
    assert_eq!(answer.status, Some(0), "{}", answer.stderr);
    let text = fs::read_to_string(place.at("lathe.var")).unwrap();
    assert!(text.starts_with("31\t2.500000\n5161\t3.000000\n"), "{text}");
    assert!(text.contains("5221\t7.000000\n") && !text.contains("100\t"), "{text}");
    assert_eq!(fs::read_to_string(place.at("lathe.var.bak")).unwrap(), "31\t0.0\n5161\t3.000000\n");
    place.write("use.ngc", "(PRINT,#31 #5221)\nM2\n");
    let answer = place.ask(&["canon", "use.ngc", "-p", "lathe.var"]);
    assert!(answer.stdout.contains("PRINT(\"2.500000 7.000000\")"), "{}", answer.stdout);
}

#[test]
fn shared_variables_of_fanuc_outlive_a_run_of_canon() {
    let place = Place::new();
    place.write("set.nc", "#500=#501+1.\n#501=#0\n#100=5.\nM30\n");
    place.write("lathe.var", "501\t7.000000\n");
    let answer = place.ask(&["canon", "--dialect", "fanuc", "set.nc", "-p", "lathe.var"]);
    assert_eq!(answer.status, Some(0), "{}", answer.stderr);
    let text = fs::read_to_string(place.at("lathe.var")).unwrap();
    assert!(text.starts_with("500\t8.000000\n5161\t"), "{text}");
}

#[test]
fn canon_stops_at_the_first_error_or_goes_on() {
    let place = Place::new();
    place.write("bad.ngc", "G0 X1\nG1 X2\nG99999\nG0 X4\nM2\n");
    let stopped = place.ask(&["canon", "bad.ngc"]);
    assert_eq!(stopped.status, Some(2));
    assert!(stopped.stdout.contains("TRAVERSE(1.0000") && !stopped.stdout.contains("TRAVERSE(4.0000"));
    assert!(stopped.stderr.starts_with("bad.ngc:2:") && !stopped.stderr.contains("bad.ngc:3:"));
    let all = place.ask(&["canon", "bad.ngc", "-n", "0"]);
    assert_eq!(all.status, Some(2));
    assert!(all.stdout.contains("TRAVERSE(4.0000") && all.stderr.contains("bad.ngc:3:"), "{}", all.stderr);
}

#[test]
fn canon_takes_the_place_of_rs274() {
    let place = Place::new();
    let rs274 =
        |arguments: &[&str]| place.ask(&[&["canon", "--format", "linuxcnc", "-g"][..], arguments].concat());
    place.write("twice.ngc", "o1 sub\n(msg,in)\n#1=[1/0]\n(msg,not here)\no1 endsub\no1 call\no1 call\nM2\n");
    let all = rs274(&["-n", "0", "twice.ngc"]);
    assert_eq!((all.status, all.stdout.matches("MESSAGE(\"in\")").count()), (Some(0), 2), "{}", all.stdout);
    assert!(
        !all.stdout.contains("not here") && all.stderr.contains("twice.ngc:3:"),
        "an error ends all calls"
    );
    assert_eq!(rs274(&["twice.ngc"]).status, Some(2));
    place.write("open.ngc", "G0 X1\n");
    assert_eq!(rs274(&["-n", "0", "open.ngc"]).status, Some(2), "its end was not reached");

    place.write("end.ngc", "#1=2\n  (abort,turn the part, #1 mm)\nM2\n");
    let answer = rs274(&["end.ngc"]);
    assert_eq!(answer.status, Some(2));
    assert_eq!(answer.stderr, "executing\nturn the part, 2.000000 mm\n  (abort,turn the part, #1 mm)\n");

    place.write("none.ngc", "%\nN1 016 G0 X1\nM98 P7\n%\n");
    let answer = rs274(&["none.ngc"]);
    assert!(answer.stdout.contains(" 7 N1     STRAIGHT_TRAVERSE(1.0000"), "{}", answer.stdout);
    assert!(answer.stdout.contains(" 8 N..... FINISH()\n"), "{}", answer.stdout);
}

#[test]
fn canon_names_the_file_that_is_wrong() {
    let place = Place::new();
    place.write("good.ngc", "M2\n");
    place.write("tool.tbl", "T1 P1 Z5\nT2 P2 Z1.2.3\n");
    place.write("bad.var", "10 1\n9 1\n");
    place.write("bad.ini", "[TRAJ]\nLINEAR_UNITS = ell\n");
    for (arguments, named) in [
        (&["-t", "tool.tbl"], "tool.tbl:2:7: error["),
        (&["-p", "bad.var"], "bad.var:2:1: error["),
        (&["-i", "bad.ini"], "bad.ini:2:16: error["),
        (&["-t", "none.tbl"], "none.tbl: cannot be read"),
        (&["-n", "1"], "use 0 to go on or 2 to stop"),
    ] {
        let answer = place.ask(&[&["canon", "good.ngc"][..], arguments].concat());
        assert_eq!(answer.status, Some(2), "{arguments:?}");
        assert!(answer.stderr.contains(named), "{arguments:?}: {}", answer.stderr);
    }
    let nothing = place.ask(&["canon", "missing.ngc"]);
    assert!(nothing.status == Some(2) && nothing.stderr.contains("missing.ngc"), "{}", nothing.stderr);
}

#[test]
fn check_gives_editors_every_diagnostic_as_json() {
    let place = Place::new();
    place.write("bad.ngc", "G21 G90\nG1 X10 Q5\nG99999\nM2\n");
    let answer = place.ask(&["check", "bad.ngc", "--json"]);
    assert_eq!((answer.status, answer.stderr.as_str()), (Some(2), ""));
    let document: serde_json::Value = serde_json::from_str(&answer.stdout).unwrap();
    assert_eq!(document["version"], 1);
    assert_eq!(document["program"], "bad.ngc");
    let diagnostics = document["diagnostics"].as_array().unwrap();
    assert_eq!(document["errors"], diagnostics.len());
    let first = diagnostics.iter().find(|one| one["line"] == 2).unwrap();
    assert!(first["column"] == 8 && first["end_column"] == 10, "{first}");
    assert!(first["file"] == "bad.ngc" && first["severity"] == "error", "{first}");
    for key in ["code", "message", "help"] {
        assert!(first[key].as_str().is_some_and(|text| !text.is_empty()), "{first}");
    }
    assert!(diagnostics.iter().any(|one| one["line"] == 3));
}

#[test]
fn folders_of_subroutines_are_given_or_missed() {
    let place = Place::new();
    fs::create_dir(place.at("subs")).unwrap();
    place.write("subs/there.ngc", "o<there> sub\nG0 X4\no<there> endsub\nM2\n");
    place.write("main.ngc", "G18 G21\no<there> call\nM2\n");
    for command in ["canon", "check"] {
        let found = place.ask(&[command, "main.ngc", "--subroutines", "subs"]);
        assert_eq!(found.status, Some(0), "{}", found.stderr);
        let missed = place.ask(&[command, "main.ngc", "--subroutines", "nowhere"]);
        assert_eq!(missed.status, Some(2));
        assert!(missed.stderr.contains("nowhere: there is no such folder"), "{}", missed.stderr);
    }
    let program = place.ask(&["canon", "main.ngc", "subs/there.ngc"]);
    assert_eq!(program.status, Some(2), "a program is not printed over");
    assert_eq!(place.ask(&["check", "."]).status, Some(2), "a folder is not a program");
}
