//! The command line: what is wrong is named with its place and a remedy, the exit status tells whose fault it
//! is, and results go where programs look for them.

use std::fs;

use rig::observe::Summary;

use crate::shop::{Answer, Place, example, project};

/// A refusal of bad input: status 2, nothing on standard output, every one of these words on standard error.
fn refuses(place: &Place, arguments: &[&str], words: &[&str]) {
    let Answer { status, stdout, stderr } = place.ask(arguments);
    assert_eq!(status, Some(2), "{arguments:?}: {stdout} {stderr}");
    for word in words {
        assert!(stderr.contains(word), "{arguments:?} does not say {word:?}: {stderr}");
    }
    assert!(!stderr.contains("panicked"), "{arguments:?}: {stderr}");
    assert!(!place.at("runs").exists(), "{arguments:?} left a run folder");
}

pub(crate) fn accepts(place: &Place, arguments: &[&str]) -> Answer {
    let answer = place.ask(arguments);
    assert_eq!(answer.status, Some(0), "{arguments:?}: {}", answer.stderr);
    answer
}

pub(crate) fn m20x2() -> String {
    example("m20x2").display().to_string()
}

#[test]
fn a_bad_program_is_refused_with_every_place_in_it() {
    let place = Place::new();
    place.write("bad.ngc", "G21 G90\nG1 X10 Q5\nG99999\nM2\n");
    let words = ["bad.ngc:2:8: error[", "bad.ngc:3:1: error[", "help: "];
    for arguments in [&["run", "bad.ngc"][..], &["compile", "bad.ngc", "-o", "bad.mc"]] {
        refuses(&place, arguments, &words);
    }
    assert!(!place.at("bad.mc").exists());
    let checked = place.ask(&["check", "bad.ngc"]);
    assert_eq!(checked.status, Some(2));
    assert!(words.iter().all(|word| checked.stderr.contains(word)), "{}", checked.stderr);
    assert!(checked.stdout.starts_with("2 errors"), "{}", checked.stdout);
}

#[test]
fn a_bad_machine_file_is_refused_with_the_key() {
    let place = Place::new();
    let good = accepts(&place, &["machine"]).stdout;
    let cases = [
        ("velocity_mm_s = 150.0", "velosity_mm_s = 150.0", "in [axis.x]"),
        ("cycle_s = 0.0005", "cycle_s = \"fast\"", "in [machine]"),
        ("cycle_s = 0.0005", "cycle_s = \"fast\"", "expected a number"),
        ("encoder_lines = 2500", "encoder_lines = 2.5", "expected a whole number"),
        ("cycle_s = 0.0005", "", "`pitchlock machine` prints a whole one"),
        ("travel_mm = [-5.0, 120.0]", "travel_mm = [120.0, -5.0]", "the lower end comes first"),
        ("mass_kg = 1905.0", "mass_kg = -1.0", "axis.x.mass_kg"),
        ("mode_hz = 100.0", "mode_hz = -100.0", "plant.axis.x.mode_hz"),
        ("encoder_lines = 2500", "encoder_lines = 0", "spindle.encoder_lines"),
    ];
    for (right, wrong, named) in cases {
        assert!(good.contains(right), "{right}");
        place.write("bad.toml", good.replacen(right, wrong, 1));
        refuses(&place, &["run", &m20x2(), "--machine", "bad.toml"], &["bad.toml", named]);
    }
}

#[test]
fn a_bad_scenario_is_refused_with_the_event_and_the_key() {
    let place = Place::new();
    let first = "[[event]]\nat = { time_s = 1.0 }\nspindle_override_pct = 60\n";
    let cases = [
        ("at = { time_s = -1.0 }\nspindle_override_pct = 60", "time_s"),
        ("at = { time_s = 1.0 }\nspindle_overide_pct = 60", "spindle_overide_pct"),
        ("at = { moon = 1.0 }\nspindle_override_pct = 60", "moon"),
        ("at = { time_s = 1.0 }\nspindle_override_pct = -60", "spindle_override_pct"),
        ("spindle_override_pct = 60", "at"),
        ("at = { time_s = 1.0 }", "event 2"),
    ];
    for (second, key) in cases {
        place.write("bad.toml", format!("{first}[[event]]\n{second}\n"));
        refuses(&place, &["run", &m20x2(), "--scenario", "bad.toml"], &["bad.toml", "event 2", key]);
    }
}

#[test]
fn what_is_missing_or_unknown_is_named() {
    let place = Place::new();
    let m20x2 = m20x2();
    refuses(&place, &["run", "missing.ngc"], &["missing.ngc"]);
    refuses(&place, &["run", &m20x2, "--machine", "missing.toml"], &["missing.toml"]);
    refuses(&place, &["run", &m20x2, "--scenario", "missing.toml"], &["missing.toml"]);
    refuses(&place, &["run", &m20x2, "--frobnicate"], &["--frobnicate", "--help"]);
    refuses(&place, &["run", &m20x2, "--clock", "sundial"], &["sundial", "virtual", "real"]);
    refuses(&place, &["run", &m20x2, "--dialect", "klingon"], &["dialect"]);
    refuses(&place, &["run", &m20x2, "--in-process", "--clock", "real"], &["--in-process"]);
    refuses(&place, &["run", &m20x2, "--processes"], &["lock step", "--clock real"]);
    refuses(&place, &["run", &m20x2, "--processes", "--in-process"], &["--processes", "--in-process"]);
    refuses(&place, &["frobnicate"], &["frobnicate"]);
    refuses(&place, &["compile", &m20x2, "-o", "code.txt"], &["code.txt", ".mc"]);
    place.write("notes.txt", "no run folder");
    refuses(&place, &["report", "."], &["summary.json", "run folder"]);
    refuses(&place, &["report", "missing"], &["missing"]);
    fs::create_dir(place.at("empty")).expect("the place is new");
    refuses(&place, &["run", "empty"], &["summary.json"]);
}

#[test]
fn what_is_no_g_code_is_said_in_one_error() {
    let place = Place::new();
    let job = fs::read_to_string(project().join("examples/shape/wave.toml")).expect("it is shipped");
    let mill = project().join("examples/machines/small-mill.toml").display().to_string();
    place.write("wave.txt", &job);
    place.write("WAVE.TOML", &job);
    accepts(&place, &["compile", "WAVE.TOML", "--machine", &mill, "-o", "wave.mc"]);
    accepts(&place, &["canon", "WAVE.TOML"]);
    fs::copy(place.at("wave.mc"), place.at("code.ngc")).expect("it was just compiled");
    for (arguments, words) in [
        (&["check", "wave.txt", "--machine", &mill][..], ["looks like a job", "wave.toml"]),
        (&["canon", "wave.txt"], ["looks like a job", "wave.toml"]),
        (&["canon", "wave.mc"], ["is machine code", "`pitchlock run wave.mc`"]),
        (&["run", "code.ngc", "--machine", &mill], ["is machine code", "rename it"]),
    ] {
        let answer = place.ask(arguments);
        assert_eq!(answer.status, Some(2), "{}", answer.stdout);
        assert_eq!(answer.stderr.lines().count(), 1, "{}", answer.stderr);
        assert!(words.iter().all(|word| answer.stderr.contains(word)), "{}", answer.stderr);
    }
}

#[test]
fn damaged_machine_code_is_refused() {
    let place = Place::new();
    accepts(&place, &["compile", &m20x2(), "-o", "good.mc"]);
    let good = fs::read(place.at("good.mc")).expect("it was just compiled");
    let again = "compile the program again";
    let places = [(0, "not a machine-code file"), (5, "version"), (60, again), (good.len() / 2, again)];
    for (at, word) in places {
        let mut damaged = good.clone();
        damaged[at] ^= 0x55;
        place.write("bad.mc", damaged);
        refuses(&place, &["run", "bad.mc"], &["bad.mc", word]);
    }
    for length in [0, 3, 20, good.len() - 1] {
        place.write("bad.mc", &good[..length]);
        refuses(&place, &["check", "bad.mc"], &["bad.mc", "machine-code file"]);
    }
    let slower =
        accepts(&place, &["machine"]).stdout.replace("velocity_mm_s = 150.0", "velocity_mm_s = 10.0");
    place.write("slower.toml", slower);
    refuses(&place, &["run", "good.mc", "--machine", "slower.toml"], &["good.mc", again]);
}

#[test]
fn the_help_of_every_command_teaches() {
    let place = Place::new();
    let general = accepts(&place, &["--help"]).stdout;
    assert!(general.contains("pitchlock run examples/m20x2.ngc"), "{general}");
    for command in ["run", "check", "compile", "canon", "machine", "report", "experiment", "doctor"] {
        let help = accepts(&place, &[command, "--help"]).stdout;
        let example = format!("  pitchlock {command}");
        assert!(help.lines().any(|line| line.starts_with(&example)), "{command} has no example: {help}");
        assert!(general.contains(command));
    }
    for process in ["interpreter", "interpolator", "regulator", "sim-plant"] {
        let help = accepts(&place, &[process, "--help"]).stdout;
        assert!(help.contains("as `run` starts it") && help.contains("--address"), "{process}: {help}");
    }
}

#[test]
fn the_built_in_machine_file_is_a_start_for_ones_own() {
    let place = Place::new();
    let printed = accepts(&place, &["machine"]).stdout;
    let shipped = project().join("examples/machines/small-lathe.toml");
    assert_eq!(printed, fs::read_to_string(shipped).expect("it is shipped"));
    let mill = accepts(&place, &["machine", "--kinematics", "mill"]).stdout;
    let shipped = project().join("examples/machines/small-mill.toml");
    assert_eq!(mill, fs::read_to_string(shipped).expect("it is shipped"));
    place.write("own.toml", printed);
    let own = place.run(&example("m20x2"), "own", &["--in-process", "--machine", "own.toml"]);
    let built_in = place.run(&example("m20x2"), "built-in", &["--in-process"]);
    assert_eq!(own.trace_hash, built_in.trace_hash);
}

#[test]
fn json_is_one_document_and_nothing_else() {
    let place = Place::new();
    let arguments = ["run", &m20x2(), "--in-process", "--json", "--out", "run", "--trace", "csv"];
    let answer = accepts(&place, &arguments);
    let documents = serde_json::Deserializer::from_str(&answer.stdout).into_iter::<serde_json::Value>();
    let documents: Vec<_> = documents.map(|document| document.expect("it is JSON")).collect();
    assert_eq!(documents.len(), 1);
    for key in ["version", "outcome", "trace_hash", "processes", "channels", "passes", "thread", "moves"] {
        assert!(documents[0].get(key).is_some(), "{key}");
    }
    let trace = fs::read_to_string(place.at("run/trace.csv")).expect("a CSV trace was asked for");
    let head = trace.lines().next().expect("a trace has a head");
    assert!(
        head.starts_with("cycle,t_s,spindle_true_deg,spindle_counts,spindle_rpm,override_pct,"),
        "{head}"
    );
    assert_eq!(Some(trace.lines().count() as u64 - 1), documents[0]["cycles"].as_u64());
}

#[test]
fn results_are_for_people_and_for_pipes() {
    let place = Place::new();
    let program = m20x2();
    let run = accepts(&place, &["run", &program, "--in-process", "--out", "run"]);
    for word in ["completed", "15 passes", "helix error", "report.html"] {
        assert!(run.stdout.contains(word), "{word}: {}", run.stdout);
    }
    assert!(!run.stderr.contains('\r'), "no progress bar but on a terminal");
    let quiet = accepts(&place, &["run", &program, "--in-process", "--out", "quiet", "-q"]);
    assert_eq!((quiet.stdout.as_str(), quiet.stderr.as_str()), ("", ""));
    let check = accepts(&place, &["check", &program]).stdout;
    assert!(check.starts_with("0 errors, 0 warnings, 25 moves\n"), "{check}");
    assert!(check.contains("Z is that of the machine"), "{check}");
    assert!(check.contains("gauge M20x2-6g"), "{check}");
    assert_eq!(check.lines().count(), 1 + 1 + 15 + 1 + 1 + 1, "{check}");
    assert!(check.contains("s on the machine"), "{check}");
    let report = accepts(&place, &["report", "run"]).stdout;
    assert_eq!(report.trim_end(), "run/report.html");
    let doctor = accepts(&place, &["doctor"]).stdout;
    assert!(doctor.contains("this computer can run the machine in virtual time"), "{doctor}");
}

#[test]
fn nothing_is_coloured_when_nobody_looks() {
    let place = Place::new();
    place.write("bad.ngc", "G99999\nM2\n");
    for no_colour in [true, false] {
        let mut command = place.pitchlock();
        command.args(["check", "bad.ngc", "-v"]);
        if no_colour {
            command.env("NO_COLOR", "1");
        }
        let answer = Answer::from(command.output().expect("the program is there"));
        assert!(!answer.stderr.contains('\u{1b}') && !answer.stdout.contains('\u{1b}'), "{}", answer.stderr);
    }
}

/// What a program tells comes when the machine is there, not when the line is read.
#[test]
fn messages_are_shown_at_their_place_and_kept() {
    let place = Place::new();
    place.write("tell.ngc", "G0 X14 Z2\n#1=12\n(MSG, chuck the bar)\nM0\nG0 Z-10\n(DEBUG, X #1)\nM2\n");
    let answer = place.ask(&["run", "tell.ngc", "--in-process", "--trace", "none", "--out", "out"]);
    assert_eq!(answer.status, Some(0), "{}", answer.stderr);
    let told = "pitchlock: line 3: chuck the bar\npitchlock: line 6: X 12.000000\n";
    assert!(answer.stderr.contains(told), "{}", answer.stderr);
    let summary = Summary::read(&place.at("out/summary.json")).expect("a summary");
    let [first, second] = &summary.messages[..] else { panic!("{:?}", summary.messages) };
    let [pause] = &summary.pauses[..] else { panic!("{:?}", summary.pauses) };
    let before = pause.cycle.abs_diff(first.cycle) < 20;
    let waited = (pause.waited_s / summary.cycle_s) as u64;
    assert!(before && second.cycle > first.cycle + waited, "{:?} {pause:?}", summary.messages);
    let quiet =
        place.ask(&["run", "tell.ngc", "--in-process", "--quiet", "--trace", "none", "--out", "quiet"]);
    assert!(quiet.stderr.is_empty(), "{}", quiet.stderr);
}

/// Whoever asks for JSON gets one document, whatever is wrong.
#[test]
fn json_is_json_where_there_is_nothing_to_say_but_an_error() {
    let place = Place::new();
    place.write("bad.ngc", "G99999\nM2\n");
    let commands: [&[&str]; 10] = [
        &["run", "none.ngc", "--json"],
        &["run", "bad.ngc", "--json"],
        &["run", "bad.ngc", "--json", "--machine", "none.toml"],
        &["check", "none.ngc", "--json"],
        &["check", "bad.ngc", "--json", "--no-such-switch"],
        &["tune", "--json", "--machine", "none.toml"],
        &["resolution", "--json", "--machine", "none.toml"],
        &["experiment", "feed", "--json", "--machine", "none.toml"],
        &["soak", "--json", "--seeds", "3..1"],
        &["thread", "M20x99999", "--json"],
    ];
    for arguments in commands {
        let answer = place.ask(arguments);
        assert_eq!(answer.status, Some(2), "{arguments:?}: {}", answer.stderr);
        let document: serde_json::Value = serde_json::from_str(&answer.stdout)
            .unwrap_or_else(|error| panic!("{arguments:?}: {error}: {}", answer.stdout));
        let told = document["error"].as_str().unwrap_or_default();
        assert!(!told.is_empty() && !told.contains('\u{1b}'), "{arguments:?}: {document}");
        assert!(
            arguments[0] == "check" || !answer.stderr.is_empty(),
            "{arguments:?}: people are told as well"
        );
    }
    let full = std::fs::OpenOptions::new().write(true).open("/dev/full").expect("it is there");
    let mut command = place.pitchlock();
    let answer = command.args(["check", "bad.ngc", "--json"]).stdout(full).output().expect("it starts");
    assert!(!answer.status.success() && !answer.stderr.is_empty());
}

/// `--log-format json` is for whoever reads what is said by a program: diagnostics, too.
#[test]
fn what_is_said_is_json_if_asked_for() {
    let place = Place::new();
    place.write("bad.ngc", "G99999\nG0 X1 X2\nM2\n");
    for arguments in [&["check", "bad.ngc"][..], &["run", "bad.ngc"], &["compile", "none.ngc", "-o", "x.mc"]]
    {
        let answer = place.ask(&[arguments, &["--log-format", "json"]].concat());
        assert_eq!(answer.status, Some(2));
        let mut lines = answer.stderr.lines();
        assert!(lines.clone().count() > 0, "{arguments:?}");
        let is_json = |line: &str| {
            serde_json::from_str::<serde_json::Value>(line).is_ok_and(|line| line["level"] == "ERROR")
        };
        assert!(lines.all(is_json), "{arguments:?}: {}", answer.stderr);
    }
}
