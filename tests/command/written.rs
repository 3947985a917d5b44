//! No command replaces what it has not made.

use std::{collections::BTreeMap, fs};

use crate::command_line::{accepts, m20x2};
use crate::shop::{Answer, Place, project, signal, until};

const SHORT: &str = "G18 G21 G90 G8\nG0 X14 Z2\nM2\n";

/// Every file of a place, with what is in it.
fn files(place: &Place, folder: &str) -> BTreeMap<String, Vec<u8>> {
    let entries = fs::read_dir(place.at(folder)).expect("a folder").map(|entry| entry.expect("an entry"));
    let files = entries.filter(|entry| entry.path().is_file());
    files
        .map(|entry| (entry.file_name().to_string_lossy().into(), fs::read(entry.path()).expect("read")))
        .collect()
}

/// A command is refused with a remedy, and no file of the place has changed.
fn touches_nothing(place: &Place, arguments: &[&str], file: &str) {
    let before = files(place, ".");
    let answer = place.ask(arguments);
    assert_eq!(answer.status, Some(2), "{arguments:?}: {}{}", answer.stdout, answer.stderr);
    for word in [file, "already", "name ", "remove"] {
        assert!(answer.stderr.contains(word), "{arguments:?}: {word}: {}", answer.stderr);
    }
    assert!(files(place, ".") == before, "{arguments:?} changed a file");
}

#[test]
fn a_run_wants_a_folder_of_its_own() {
    let place = Place::new();
    place.write("short.ngc", SHORT);
    place.write("machine.toml", "# mine\n");
    let run = |out: &str| place.ask(&["run", "short.ngc", "--in-process", "--out", out]);
    touches_nothing(&place, &["run", "short.ngc", "--in-process", "--out", "."], "other files are");
    fs::create_dir(place.at("empty")).expect("made");
    for out in ["empty", "below/new"] {
        assert_eq!(run(out).status, Some(0));
        assert!(place.at(out).join("summary.json").is_file());
    }
    let before = files(&place, "empty");
    let answer = run("empty");
    assert_eq!(answer.status, Some(2), "{}", answer.stdout);
    assert!(answer.stderr.contains("a run is in this folder already"), "{}", answer.stderr);
    // The same run again, from its folder and into it.
    let again = place.ask(&["run", "empty", "--in-process", "--out", "empty"]);
    assert_eq!(again.status, Some(2), "{}", again.stdout);
    assert!(files(&place, "empty") == before);
    // A path that is a file.
    let file = run("short.ngc");
    assert!(file.status == Some(2) && file.stderr.contains("short.ngc: "), "{}", file.stderr);
    accepts(&place, &["report", "empty"]);
    place.write("empty/report.html", "<p>mine</p>");
    let answer = place.ask(&["report", "empty"]);
    assert!(answer.status == Some(2) && answer.stderr.contains("not a page"), "{}", answer.stderr);
    assert_eq!(fs::read(place.at("empty/report.html")).expect("kept"), b"<p>mine</p>");
}

#[test]
fn a_file_is_replaced_only_by_the_command_that_made_it() {
    let place = Place::new();
    let program = m20x2();
    let mill = project().join("examples/machines/small-mill.toml").display().to_string();
    let wave = project().join("examples/shape/wave.toml").display().to_string();
    for name in ["own.mc", "own.ngc", "own.html", "own.toml", "own.txt", "own.var"] {
        place.write(name, "G21 (MINE)\nG0 X1\nM2\n");
    }
    fs::create_dir(place.at("own")).expect("made");
    place.write("own/rows.json", "[1]");
    let commands: [(&[&str], &str); 8] = [
        (&["compile", &program, "-o", "own.mc"], "own.mc"),
        (&["compile", &wave, "--machine", &mill, "-o", "new.mc", "--g1", "own.ngc"], "own.ngc"),
        (&["resolution", "--page", "own.html"], "own.html"),
        (&["tune", "--page", "own.html"], "own.html"),
        (&["tune", "-o", "own.toml"], "own.toml"),
        (&["experiment", "feed", "--out", "own"], "rows.json"),
        (&["soak", "--seeds", "0..1", "--out", "own"], "own"),
        (&["canon", &program, "own.txt"], "own.txt"),
    ];
    for (arguments, file) in commands {
        touches_nothing(&place, arguments, file);
    }
    assert_eq!(fs::read(place.at("own/rows.json")).expect("kept"), b"[1]");
    // Its own it writes again, and to what is no file.
    for _ in 0..2 {
        accepts(&place, &["compile", &program, "-o", "new.mc"]);
        accepts(&place, &["canon", &program, "new.txt"]);
        accepts(&place, &["canon", &program, "/dev/null"]);
        accepts(&place, &["canon", "--format", "linuxcnc", &program, "linuxcnc.txt"]);
        accepts(&place, &["resolution", "--page", "new.html"]);
        accepts(&place, &["experiment", "feed"]);
        accepts(&place, &["compile", &wave, "--machine", &mill, "-o", "wave.mc", "--g1", "wave.ngc"]);
    }
}

/// Switches of rs274 go on to mean what they mean there, where they can mean nothing else.
#[test]
fn v_is_verbose_and_a_parameter_file_never_printed_to() {
    let place = Place::new();
    place.write("set.ngc", "#500 = 3\nM2\n");
    place.write("lathe.var", "500\t1.0\n");
    for switch in [["-p", "lathe.var"], ["--parameters", "lathe.var"], ["-v", "lathe.var"]] {
        accepts(&place, &["canon", "set.ngc", switch[0], switch[1]]);
        let kept = fs::read_to_string(place.at("lathe.var")).expect("kept");
        assert!(kept.contains("500\t3.0"), "{switch:?}: {kept}");
        place.write("lathe.var", "500\t1.0\n");
    }
    accepts(&place, &["canon", "-v", "set.ngc"]);
    accepts(&place, &["canon", "set.ngc", "-vv"]);
    let answer = place.ask(&["canon", "set.ngc", "other.var"]);
    assert!(answer.status == Some(2) && answer.stderr.contains("-p"), "{}", answer.stderr);
    assert!(!place.at("other.var").exists());
}

/// Lines that are printed are those of the file, alone and as a whole; interrupted, there are none.
#[test]
fn lines_that_are_printed_are_whole_or_none() {
    let place = Place::new();
    let [mill, wave] = ["machines/small-mill.toml", "shape/wave.toml"]
        .map(|name| project().join("examples").join(name).display().to_string());
    let arguments = ["compile", &wave, "--machine", &mill, "-o", "own.mc", "--g1"];
    let answer = place.ask(&[&arguments[..], &["own.ngc"]].concat());
    assert_eq!(answer.status, Some(0), "{}", answer.stderr);
    let lines = fs::read(place.at("own.ngc")).expect("they are written");
    let print = |to: std::process::Stdio| {
        let mut command = place.pitchlock();
        command.args(arguments).arg("/dev/stdout").stdout(to).stderr(std::process::Stdio::piped());
        command.spawn().expect("it starts")
    };
    let file = fs::File::create(place.at("printed.ngc")).expect("room");
    let answer = Answer::from(print(file.into()).wait_with_output().expect("it was started here"));
    assert_eq!(answer.status, Some(0), "{}", answer.stderr);
    assert!(
        answer.stderr.contains("own.mc: ") && answer.stderr.contains("times as many"),
        "{}",
        answer.stderr
    );
    let printed = fs::read(place.at("printed.ngc")).expect("it is there");
    assert!(printed == lines, "{} bytes of {}", printed.len(), lines.len());
    // The machine code is there before the first line.
    fs::remove_file(place.at("own.mc")).expect("it is ours");
    let compiler = print(std::process::Stdio::piped());
    until("the machine code is written", || place.at("own.mc").exists());
    signal(compiler.id(), "INT");
    let printed = compiler.wait_with_output().expect("it was started here").stdout;
    assert!(printed.is_empty() || printed == lines, "{} bytes of {}", printed.len(), lines.len());
}
