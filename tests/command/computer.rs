//! A computer that has too little of something: it is said before anything starts, with what to do about it,
//! and nothing is left behind.

use std::{
    collections::BTreeSet,
    fs,
    process::{Command, Stdio},
};

use rig::observe::Summary;

use crate::shop::{
    Answer, Place, can_be_private, children, example, name_spaces, private, shared_memory, signal, until,
    wait_s,
};

/// A short program, which needs no trace to be seen to its end.
const SHORT: &str = "G18 G21 G90 G94 G8\nG0 X50 Z90\nG1 X50.1 F3000\nM2\n";

/// A command line in a mount namespace whose shared memory has so many kB.
fn with_shared_memory(place: &Place, kb: u64, words: &str) -> Command {
    let script = format!(
        "mount -t tmpfs -o mode=1777,size={kb}k tmpfs /dev/shm && \"$0\" {words}; status=$?; ls /dev/shm >&2; exit $status"
    );
    private(place, &script)
}

#[test]
fn shared_memory_that_is_too_small_is_said_before_the_run() {
    let place = Place::new();
    if !can_be_private("shared_memory_that_is_too_small_is_said_before_the_run") {
        return;
    }
    place.write("short.ngc", SHORT);
    let ask =
        |kb: u64, words: &str| Answer::from(with_shared_memory(&place, kb, words).output().expect("sh"));
    let run = "run short.ngc --trace none --out run";
    let mut needed: Option<u64> = None;
    for kb in [100, 300, 700] {
        let answer = ask(kb, run);
        assert_eq!(answer.status, Some(1), "{kb} kB: {}", answer.stderr);
        assert!(!place.at("run").exists(), "a run that never began leaves no folder");
        let said = answer.stderr.contains("kB free, and a machine needs");
        assert!(said && answer.stderr.contains("--shm-size"), "{}", answer.stderr);
        assert!(!answer.stderr.contains("pl0") && !answer.stderr.contains("pitchlock-"), "{}", answer.stderr);
        needed = answer.stderr.split(" needs ").nth(1).and_then(|text| text.split(' ').next()?.parse().ok());
        let doctor = ask(kb, "doctor");
        assert_eq!(doctor.status, Some(1), "{}", doctor.stdout);
        assert!(doctor.stdout.contains("FAIL  channels of a machine"), "{}", doctor.stdout);
    }
    // What it asks for is enough, beside the block that the marker takes.
    let needed = needed.expect("a number");
    assert_eq!(ask(needed + 8, run).status, Some(0), "{needed} kB");
    assert_eq!(ask(needed + 8, "doctor").status, Some(0), "{needed} kB");
}

/// All that a machine needs of shared memory it has before it starts: who fills the rest kills nobody.
#[test]
fn shared_memory_that_is_filled_during_a_run_ends_no_process() {
    let place = Place::new();
    if !can_be_private("shared_memory_that_is_filled_during_a_run_ends_no_process") {
        return;
    }
    let program = example("m20x2").display().to_string();
    let script = format!(
        "mount -t tmpfs -o mode=1777,size=16m tmpfs /dev/shm; \"$0\" run {program} --json --out run & \
         until [ -s run/moment.bin ]; do sleep 0.01; done; \
         dd if=/dev/zero of=/dev/shm/full bs=64k 2>/dev/null; wait $!"
    );
    let answer = Answer::from(private(&place, &script).output().expect("sh"));
    assert_eq!(answer.status, Some(0), "{}", answer.stderr);
    let summary: Summary = serde_json::from_str(&answer.stdout).expect("the summary");
    assert!(summary.faults.is_empty(), "{:?}", summary.faults);
}

#[test]
fn too_few_files_are_said_before_the_run() {
    let place = Place::new();
    place.write("short.ngc", SHORT);
    let ask = |limit: &str, words: &str| {
        let mut command = place.pitchlock();
        let pitchlock = command.get_program().to_owned();
        command = Command::new("sh");
        command.arg("-c").arg(format!("ulimit {limit} && exec \"$0\" {words}")).arg(pitchlock);
        command.current_dir(place.path()).env("TMPDIR", place.path()).stdin(Stdio::null());
        Answer::from(command.output().expect("sh"))
    };
    let run = "run short.ngc --trace none --out run";
    for words in [run, "doctor"] {
        let refused = ask("-n 64", words);
        assert_eq!(refused.status, Some(1), "{words}: {}", refused.stderr);
        let all = refused.stderr + &refused.stdout;
        assert!(all.contains("a process may open 64 files at once") && all.contains("`ulimit -n`"), "{all}");
    }
    assert_eq!(shared_memory(&place, &BTreeSet::new()), Vec::<String>::new());
    assert!(name_spaces(&place).is_empty());
    // A limit that may be raised is raised.
    let raised = ask("-Sn 64", run);
    assert_eq!(raised.status, Some(0), "{}", raised.stderr);
    // Exactly what is said to be needed is enough.
    place.clear("run");
    let needed = process::ipc::computer::files(&[protocol::Axis::X, protocol::Axis::Z]);
    let enough = ask(&format!("-n {needed}"), run);
    assert_eq!(enough.status, Some(0), "{}", enough.stderr);
}

/// The signal that ended a process is told by its name and in words.
#[test]
fn a_signal_that_ends_a_process_is_told_in_words() {
    for (name, words) in
        [("BUS", "SIGBUS (memory that is not there"), ("KILL", "SIGKILL (somebody killed it")]
    {
        let place = Place::new();
        let launcher = place.start(&example("m20x2"));
        until("the machine runs", || place.at("run/trace.mcap").exists());
        wait_s(0.2);
        let regulator = children(&launcher).into_iter().find(|(child, _)| child == "regulator-z");
        // The first SIGBUS is looked at by the standard library of Rust, which lets the next one through.
        let pid = regulator.expect("it runs").1;
        (0..20).for_each(|_| signal(pid, name));
        let answer = Answer::from(launcher.wait_with_output().expect("it was started here"));
        assert_eq!(answer.status, Some(1), "{}", answer.stderr);
        let summary: Summary = serde_json::from_str(&answer.stdout).expect("the summary");
        let fault = &summary.faults[0];
        assert_eq!(fault.code, "process-died");
        assert!(fault.text.contains(words), "{}", fault.text);
        assert!(answer.stderr.contains(words), "{}", answer.stderr);
    }
}

/// A file that may not become longer costs the trace, not the launcher.
#[test]
fn a_file_that_may_not_grow_costs_the_trace() {
    let place = Place::new();
    let mut command = Command::new("sh");
    let program = example("m20x2").display().to_string();
    let words =
        format!("ulimit -f 512 && exec \"$0\" run {program} --json --trace csv --in-process --out run");
    command.arg("-c").arg(words).arg(place.pitchlock().get_program());
    command.current_dir(place.path()).env("TMPDIR", place.path()).stdin(Stdio::null());
    let answer = Answer::from(command.output().expect("sh"));
    assert_eq!(answer.status, Some(1), "{}", answer.stderr);
    let summary: Summary = serde_json::from_str(&answer.stdout).expect("the summary");
    assert!(summary.faults.is_empty());
    assert!(answer.stderr.contains("the run goes on without a trace"), "{}", answer.stderr);
    let length = fs::metadata(place.at("run/trace.csv")).expect("what could be written").len();
    assert!((1..=512 * 1024).contains(&length), "{length}");
}

/// Processes of a machine start elsewhere than where the launcher was: a folder without its whole name is
/// completed, one that the bus cannot name is told.
#[test]
fn a_folder_for_temporary_files_is_found_or_named() {
    let place = Place::new();
    let program = place.write("short.ngc", SHORT).display().to_string();
    fs::create_dir(place.at("near")).expect("room");
    let ask = |folder: &str, out: &str| {
        let mut command = place.pitchlock();
        command.env("TMPDIR", folder).args(["run", &program, "--trace", "none", "--out", out]);
        Answer::from(command.output().expect("it starts"))
    };
    for (folder, out) in [("near", "one"), ("", "two")] {
        let answer = ask(folder, out);
        assert_eq!(answer.status, Some(0), "{folder:?}: {}", answer.stderr);
    }
    let far = place.at("n\u{e4}her").display().to_string();
    fs::create_dir(&far).expect("room");
    let answer = ask(&far, "three");
    let named = answer.stderr.contains("not ASCII") && answer.stderr.contains("set TMPDIR to");
    assert!(answer.status == Some(1) && named, "{}", answer.stderr);
}
