//! One half of the way is gone, stands, or is another one than it was: what is named, and what goes on.

use std::{
    fs,
    io::Write as _,
    net::TcpListener,
    os::unix::fs::PermissionsExt as _,
    path::{Path, PathBuf},
    process::{Output, Stdio},
    thread::Builder,
    time::Duration,
};

use hosts::{call::call, proof::Role, seal::Key};
use process::ipc::time::{Moment, sleep_until};
use serde_json::Value;

use crate::{
    place::{Host, Place, control, ended, project, signal, summary, until, wait_s},
    refusals::{text, waiting},
};

/// A machine with a file of its own, the text of that, and the same file on this computer.
fn waiting_with_a_file() -> (Place, String, PathBuf) {
    let mut place = Place::new(None);
    let lathe = fs::read_to_string(project("examples/machines/small-lathe.toml")).expect("a machine file");
    let (here, there) = (place.write("here.toml", &lathe), place.write("there.toml", &lathe));
    place.write("short.ngc", "G18 G21 G90 G94\nG0 X50 Z90\nM2\n");
    place.serve(&["--machine", &there.display().to_string()]);
    (place, lathe, here)
}

/// What comes of a run with this machine file.
fn runs(place: &Place, here: &Path, what: &str, status: i32) {
    let far = ["--machine", &here.display().to_string()];
    let output = place.far(&place.at("short.ngc"), &far).output().expect("it starts");
    assert_eq!(output.status.code(), Some(status), "{what}: {}", text(&output));
    assert!(text(&output).contains(what), "{}", text(&output));
}

/// The file that was compared is the one that is run, or nothing is.
#[test]
fn a_machine_file_that_was_changed_while_it_waited_is_refused_and_then_compared_anew() {
    let (place, lathe, here) = waiting_with_a_file();
    let runs = |what: &str, status: i32| runs(&place, &here, what, status);
    runs("completed", 0);
    let other = lathe.clone() + "# another one\n";
    place.write("there.toml", &other);
    // Seen there by itself, or when somebody asks.
    runs("the machine file", 2);
    wait_s(1.0);
    runs("the machine file differs", 2);
    assert_eq!(place.runs().len(), 1, "nothing has moved");
    place.write("here.toml", &other);
    runs("completed", 0);
    // Both are changed while nobody asks, and one of them back.
    for text in [&lathe, &other, &lathe] {
        place.write("here.toml", text);
        place.write("there.toml", text);
        wait_s(1.0);
        runs("completed", 0);
    }
}

/// Whatever keeps the machine from starting is said to whoever has asked for it, and nothing has moved.
#[test]
fn a_machine_that_cannot_start_says_why_to_the_other_computer() {
    let place = waiting();
    let short = place.at("short.ngc");
    let refused = |what: &str| {
        let output = place.far(&short, &[]).output().expect("it starts");
        assert_eq!(output.status.code(), Some(2), "{}", text(&output));
        assert!(text(&output).contains(what), "{}", text(&output));
        assert!(!text(&output).contains("tool in a thread"), "{}", text(&output));
        let there = format!("on the computer at {}: ", place.address);
        assert!(text(&output).contains(&there), "{}", text(&output));
    };
    // Run folders cannot be made.
    let runs = place.at("b/runs");
    fs::write(&runs, "a file").expect("written");
    (0..5).for_each(|_| refused("runs"));
    fs::remove_file(&runs).expect("removed");
    assert_eq!(place.run(&short, &[])["outcome"], "completed");
    // Somebody has cleaned up where programs come.
    for entry in fs::read_dir(place.at("b/tmp")).expect("a folder").flatten() {
        fs::remove_dir_all(entry.path()).expect("removed");
    }
    let seen = |times| place.said().matches("was removed: another one waits").count() == times;
    until("it is seen", 10.0, || seen(1));
    assert_eq!(place.run(&short, &[])["outcome"], "completed");
    // And with that the folder of all temporary files.
    fs::remove_dir_all(place.at("b/tmp")).expect("removed");
    until("it is seen", 10.0, || seen(2));
    assert_eq!(place.run(&short, &[])["outcome"], "completed");
}

/// It is read once: neither a run nor its outcome needs the file again.
#[test]
fn a_key_that_is_removed_in_a_run_or_read_by_others_ends_nothing() {
    let place = waiting();
    let key = place.at("key");
    for change in [
        |key: &Path| fs::rename(key, key.with_extension("away")),
        |key: &Path| fs::set_permissions(key, fs::Permissions::from_mode(0o644)),
    ] {
        let before = place.runs().len();
        let program = project("examples/m20x2.ngc");
        let run = place.far(&program, &["--json", "--trace", "none", "--pace", "20"]).spawn();
        let run = run.expect("it starts");
        until("the run has begun", 20.0, || {
            place.runs().get(before).is_some_and(|run| run.join("journal.bin").exists())
        });
        change(&key).expect("changed");
        let output = ended(run, 60.0);
        assert_eq!(output.status.code(), Some(0), "{}\n{}", text(&output), place.said());
        assert_eq!(summary(&output)["outcome"], "completed");
        // Whoever calls from here reads the same file.
        let _ = fs::rename(key.with_extension("away"), &key);
        fs::set_permissions(&key, fs::Permissions::from_mode(0o600)).expect("changed");
        assert_eq!(place.run(&place.at("short.ngc"), &[])["outcome"], "completed");
    }
}

/// Its folder of temporary files is so deep that no socket has a place in it: that is found behind the files.
#[test]
fn a_machine_whose_name_space_cannot_be_made_is_refused_at_once() {
    let mut place = Place::new(None);
    let short = place.write("short.ngc", "G18 G21 G90 G94\nG0 X50 Z90\nM2\n");
    // Not below that of the tests, whose name may be of any length.
    let memory = tempfile::tempdir_in("/dev/shm").expect("a folder");
    let missing = 66 - memory.path().as_os_str().len();
    let deep = memory.path().join("d".repeat(missing - 1));
    fs::create_dir(&deep).expect("a folder");
    place.serve_with_temporary(&deep);
    let begun = Moment::now();
    let output = place.far(&short, &[]).output().expect("it starts");
    assert!(output.status.code().is_some_and(|code| code > 0), "{}", text(&output));
    assert!(text(&output).contains("TMPDIR"), "{}", text(&output));
    assert!(begun.elapsed().as_secs_f64() < 15.0, "{}", text(&output));
    assert!(!text(&output).contains("tool in a thread"), "{}", text(&output));
}

/// Not even the link has a place there.
#[test]
fn a_folder_of_temporary_files_that_is_too_deep_for_the_link_is_named() {
    let place = Place::new(None);
    let deep = place.at("b").join("d".repeat(100));
    fs::create_dir(&deep).expect("a folder");
    let mut serve = place.command(Host::B, &control());
    serve.args(["serve", "--listen", &place.address, "--key"]).arg(place.at("key")).env("TMPDIR", deep);
    let output = serve.output().expect("it starts");
    assert_eq!(output.status.code(), Some(2), "{}", text(&output));
    assert!(text(&output).contains("too long: set TMPDIR"), "{}", text(&output));
}

/// On one computer nobody is in a hurry with it; on two nobody sees from there that it computes.
#[test]
fn an_interpreter_that_computes_for_longer_than_the_watchdog_waits_is_left_alone() {
    let place = waiting();
    let sines = "SIN[#1]+".repeat(80);
    let heavy =
        format!("G21\n#1=0\no1 while [#1 LT 1200000]\n#2=[{sines}1]\n#1=[#1+1]\no1 endwhile\nG0 X25\nM2\n");
    let program = place.write("heavy.ngc", &heavy);
    let begun = Moment::now();
    let output = place.far(&program, &["--watchdog-s", "1"]).output().expect("it starts");
    assert_eq!(output.status.code(), Some(0), "{}\n{}", text(&output), place.said());
    let took_s = begun.elapsed().as_secs_f64();
    assert!(took_s > 4.0, "{took_s} s: the program is too short for this computer to say anything");
}

#[test]
fn a_measurement_that_is_broken_off_shows_what_it_has_and_says_why() {
    let place = waiting();
    let mut doctor = place.command(Host::A, &control());
    doctor.args(["doctor", "--at", &place.address, "--key"]).arg(place.at("key"));
    let doctor = doctor.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("it starts");
    wait_s(1.5);
    place.links(Host::B).iter().for_each(|link| signal(*link, "KILL"));
    let output = ended(doctor, 20.0);
    assert_eq!(output.status.code(), Some(1), "{}", text(&output));
    assert!(text(&output).contains("on the other host has ended"), "{}", text(&output));
    assert!(text(&output).contains("| bytes | sent |"), "{}", text(&output));
}

/// No process of it goes on, and why is said.
#[test]
fn a_measurement_that_is_told_to_end_ends_with_its_link() {
    let place = waiting();
    for name in ["TERM", "INT"] {
        let mut doctor = place.command(Host::A, &control());
        doctor.args(["doctor", "--at", &place.address, "--key"]).arg(place.at("key"));
        let doctor = doctor.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("it starts");
        until("it measures", 20.0, || !place.links_of("ping").is_empty());
        signal(doctor.id(), name);
        let output = ended(doctor, 20.0);
        assert_eq!(output.status.code(), Some(1), "{name}: {}", text(&output));
        assert!(text(&output).contains("broken off here"), "{name}: {}", text(&output));
        assert!(place.links_of("ping").is_empty(), "{name}");
    }
}

/// A run whose link is stopped on one of the hosts in its second pass: what is said of it.
fn cut_where_the_link_stops(place: &Place, host: Host) -> Output {
    let run = place.far(&project("examples/m20x2.ngc"), &["--trace", "none", "--pace", "2"]).spawn();
    let run = run.expect("it starts");
    place.cuts(1);
    place.links(host).iter().for_each(|link| signal(*link, "STOP"));
    let output = ended(run, 15.0);
    assert_eq!(output.status.code(), Some(1), "{}", text(&output));
    output
}

#[test]
fn a_link_that_is_stopped_beside_the_program_is_given_up() {
    let place = waiting();
    let output = cut_where_the_link_stops(&place, Host::A);
    assert!(text(&output).contains("pitchlock-link here does not answer any more"), "{}", text(&output));
    assert!(place.links(Host::A).is_empty(), "it is ended");
    until("the machine there rests", 60.0, || place.is_clean(Host::B));
}

/// As behind a cable that is cut, and not when all is cut that was sent.
#[test]
fn a_link_that_is_stopped_at_the_machine_stops_it() {
    let place = waiting();
    cut_where_the_link_stops(&place, Host::B);
    let path = place.runs()[0].join("summary.json");
    until("the machine rests", 30.0, || path.exists());
    let summary: Value = serde_json::from_str(&fs::read_to_string(path).expect("read")).expect("a summary");
    let fault = &summary["faults"][0];
    assert_eq!((&fault["source"], &fault["code"]), (&"pitchlock-link".into(), &"process-frozen".into()));
    let passes = summary["passes"].as_array().expect("passes").len();
    assert!(passes < 10, "{passes} of 15 passes were cut");
    assert_eq!(place.run(&place.at("short.ngc"), &[])["outcome"], "completed");
}

/// So long nobody heard the link but because he was stopped himself.
#[test]
fn a_launcher_beside_the_program_that_was_stopped_blames_nobody() {
    let place = waiting();
    let run =
        place.far(&project("examples/m20x2.ngc"), &["--json", "--trace", "none", "--pace", "4"]).spawn();
    let run = run.expect("it starts");
    place.cuts(1);
    signal(run.id(), "STOP");
    wait_s(7.0);
    signal(run.id(), "CONT");
    let output = ended(run, 60.0);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output));
    assert_eq!(summary(&output)["outcome"], "completed");
}

/// The bound of the docs is one for all bytes, and not for each.
#[test]
fn whoever_answers_byte_by_byte_is_somebody_who_says_nothing() {
    let place = Place::new(None);
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let at = listener.local_addr().expect("an address").to_string();
    let drips = move || {
        for stream in listener.incoming().flatten() {
            let drop_by_drop = move || {
                let mut stream = stream;
                while stream.write_all(b"p").is_ok() {
                    sleep_until(Moment::now().after(Duration::from_millis(900)));
                }
            };
            let _ = Builder::new().spawn(drop_by_drop);
        }
    };
    let _drips = Builder::new().spawn(drips).expect("a thread");
    let key = Key::read(&place.at("key")).expect("a key");
    let begun = Moment::now();
    let why = call(&at, &key.gate(), Role::Operator, Duration::from_secs(5)).expect_err("nobody").to_string();
    assert!(why.contains("says nothing"), "{why}");
    assert!(begun.elapsed().as_secs_f64() < 10.0, "it took {:?}", begun.elapsed());
}

#[test]
fn a_link_that_dies_between_two_runs_is_followed_by_another() {
    let place = waiting();
    let key = Key::read(&place.at("key")).expect("a key");
    for time in 1..=3 {
        // Whoever is let in is let in by one that has begun to wait.
        drop(call(&place.address, &key.gate(), Role::Hall, Duration::from_secs(5)).expect("it waits"));
        wait_s(0.2);
        place.links(Host::B).iter().for_each(|link| signal(*link, "KILL"));
        let again = || place.said().matches("another one waits for programs").count() == time;
        until("another one waits", 20.0, again);
    }
    assert_eq!(place.run(&place.at("short.ngc"), &[])["outcome"], "completed");
}

#[test]
fn a_machine_that_is_told_to_end_stops_its_run_says_how_it_ended_and_ends() {
    let mut place = waiting();
    let run =
        place.far(&project("examples/m20x2.ngc"), &["--json", "--trace", "none", "--pace", "2"]).spawn();
    let run = run.expect("it starts");
    place.cuts(1);
    place.signal_serve("TERM");
    let output = ended(run, 20.0);
    assert_eq!((summary(&output)["outcome"].as_str(), output.status.code()), (Some("stopped"), Some(1)));
    assert_eq!(place.serve_ends(6.0), Some(0), "{}", place.said());
    assert!(place.links(Host::B).is_empty() && place.is_clean(Host::B));
    let nobody = place.far(&place.at("short.ngc"), &[]).output().expect("it starts");
    assert!(text(&nobody).contains("nobody answers"), "{}", text(&nobody));
}

/// Nobody fetches how the run has ended: that is waited for, and not for ever.
#[test]
fn a_machine_that_is_told_to_end_beside_a_program_that_is_gone_ends_as_well() {
    let mut place = waiting();
    let mut run = place.far(&project("examples/m20x2.ngc"), &["--trace", "none", "--pace", "2"]);
    let mut run = run.spawn().expect("it starts");
    place.cuts(1);
    place.signal_serve("TERM");
    run.kill().expect("it lives");
    run.wait().expect("it is ours");
    assert_eq!(place.serve_ends(30.0), Some(0), "{}", place.said());
    assert!(place.links(Host::B).is_empty() && place.is_clean(Host::B));
}

#[test]
fn a_machine_file_that_is_wrong_for_a_while_ends_nothing() {
    let (place, lathe, here) = waiting_with_a_file();
    let runs = |what: &str, status: i32| runs(&place, &here, what, status);
    place.write("there.toml", "[machine]\ncycle_s = true\n");
    for _ in 0..2 {
        runs("there.toml", 2);
    }
    // That is the reason also where the file that was there before is another one than here.
    place.write("here.toml", &(lathe.clone() + "# another one\n"));
    wait_s(1.0);
    runs("there.toml", 2);
    place.write("here.toml", &lathe);
    place.write("there.toml", &lathe);
    runs("completed", 0);
}

#[test]
fn the_port_that_the_system_chose_is_told() {
    let mut place = waiting();
    place.kill_serve();
    place.address = "127.0.0.1:0".into();
    place.serve(&[]);
    let said = place.said();
    let at =
        said.split("the machine waits at ").nth(1).and_then(|rest| rest.lines().next()).expect("an address");
    assert!(!at.ends_with(":0"), "{at}");
    place.address = at.to_owned();
    assert_eq!(place.run(&place.at("short.ngc"), &[])["outcome"], "completed");
}
