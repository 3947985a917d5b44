//! Endings that somebody or something is in the way of: words that nobody reads, a launcher that stands or is
//! gone, a process that hangs where nobody notices.

use std::{
    collections::BTreeSet,
    io::Write as _,
    path::Path,
    process::{Child, Command, Stdio},
};

use process::ipc::time::Moment;
use rig::observe::{Outcome, Summary};

use crate::resume::recorded;
use crate::shop::{Answer, Place, alive, children, name_spaces, shared_memory, signal, until, wait_s};

/// Bytes that a pipe holds.
pub(crate) const PIPE: usize = 65_536;

/// One thread of a minute, on a machine that is long enough.
fn long_thread(place: &Place, machine: &str) -> Command {
    let text = "G18 G21 G90 G8\nM3 S300\nG0 X20 Z150\nG0 X9\nG33 Z-1350 K2\nG0 X20\nG0 Z150\nM5\nM2\n";
    command(place, text, &machine.replace("[-400.0", "[-2000.0"))
}

/// A run of a program on a machine, into the folder `run`.
pub(crate) fn command(place: &Place, text: &str, machine: &str) -> Command {
    place.write("machine.toml", machine);
    let program = place.write("program.ngc", text);
    place.clear("run");
    let mut command = place.pitchlock();
    command.arg("run").arg(&program).args(["--json", "--out", "run", "--machine", "machine.toml"]);
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

/// Of a machine that a busy computer follows in real time: the longest cycle, and loops that suit it.
const SLOW: [(&str, &str); 11] = [
    ("cycle_s", "0.004"),
    ("interpolator_cycle_s", "0.004"),
    ("position_gain_1_s", "15.0"),
    ("velocity_bandwidth_hz", "10.0"),
    ("velocity_integral_s", "0.06"),
    ("velocity_lead_s", "-0.002"),
    ("acceleration_lead_s", "0.006"),
    ("following_error_mm", "5.0"),
    ("thread_error_mm", "0.4"),
    ("in_position_mm", "0.02"),
    ("observer_hz", "20.0"),
];

pub(crate) fn slow_machine() -> String {
    let line = |line: &str| {
        let key = line.split(" =").next().unwrap_or_default();
        let slow = SLOW.iter().find(|(slow, _)| *slow == key);
        slow.map_or_else(|| format!("{line}\n"), |(key, value)| format!("{key} = {value}\n"))
    };
    machine::PLAIN_LATHE.lines().map(line).collect()
}

/// Waits until so many control cycles of a run are recorded.
pub(crate) fn has_come_to(place: &Place, cycle: u64) {
    until("the machine runs", || recorded(&place.at("run")) >= cycle);
}

/// Waits until the machine of a run has moved for a while, and is not only being started.
pub(crate) fn runs(place: &Place) {
    has_come_to(place, 1);
    wait_s(0.3);
}

pub(crate) fn pid_of(launcher: &Child, name: &str) -> u32 {
    let child = children(launcher).into_iter().find(|(child, _)| child == name);
    child.unwrap_or_else(|| panic!("{name} runs")).1
}

/// Whether a launcher ends within so many seconds. If not, what everybody does is said and it is killed. What
/// it prints is read meanwhile: a summary with sixteen late cycles is longer than a pipe.
pub(crate) fn ends(launcher: &mut Child, within_s: f64) -> bool {
    let printed = launcher.stdout.take();
    std::thread::scope(|scope| {
        scope.spawn(|| printed.map(|mut printed| std::io::copy(&mut printed, &mut std::io::sink())));
        ends_read(launcher, Moment::in_s(within_s))
    })
}

fn ends_read(launcher: &mut Child, deadline: Moment) -> bool {
    while launcher.try_wait().expect("it was started here").is_none() {
        if deadline.passed() {
            let own = ("launcher".to_owned(), launcher.id());
            for (name, pid) in children(launcher).into_iter().chain([own]) {
                let read = |file| std::fs::read_to_string(format!("/proc/{pid}/{file}")).unwrap_or_default();
                eprintln!("{name}: {} {}", read("stat"), read("wchan"));
            }
            launcher.kill().expect("it was started here");
            return false;
        }
        wait_s(0.01);
    }
    true
}

pub(crate) fn summary(folder: &Path) -> Summary {
    Summary::read(&folder.join("summary.json")).expect("a run leaves a summary")
}

fn codes(summary: &Summary) -> Vec<(&str, &str)> {
    summary.faults.iter().map(|fault| (fault.source.as_str(), fault.code.as_str())).collect()
}

#[test]
fn words_that_nobody_reads_hold_up_no_stop_and_no_death() {
    let faulted = ["INT", "regulator-x", "launcher"].map(|what| (what, Outcome::Faulted));
    for (what, outcome) in [("TERM", Outcome::Stopped)].into_iter().chain(faulted) {
        let place = Place::new();
        let (_unread, mut full) = std::io::pipe().expect("a pipe");
        full.write_all(&[b'x'; PIPE]).expect("it holds that much");
        let mut command = long_thread(&place, machine::SMALL_LATHE);
        let mut launcher = command.stderr(full).spawn().expect("it starts");
        // The other end is held by the processes alone.
        drop(command);
        runs(&place);
        match what {
            "TERM" => signal(launcher.id(), "TERM"),
            // Twice: an emergency stop. The plant stands meanwhile, so that the first press has not ended the
            // run when the second comes.
            "INT" => {
                let plant = pid_of(&launcher, "sim-plant");
                signal(plant, "STOP");
                (0..2).for_each(|_| {
                    signal(launcher.id(), "INT");
                    wait_s(0.1);
                });
                signal(plant, "CONT");
            }
            "launcher" => signal(launcher.id(), "KILL"),
            name => signal(pid_of(&launcher, name), "KILL"),
        }
        assert!(ends(&mut launcher, 30.0), "{what}: the launcher waits for a reader");
        until("all processes have ended", || !alive(&place));
        if what != "launcher" {
            assert_eq!(summary(&place.at("run")).outcome, outcome, "{what}");
        }
    }
}

#[test]
fn a_process_that_died_with_the_launcher_is_given_up_once() {
    for name in ["regulator-x", "interpolator", "interpreter"] {
        let place = Place::new();
        let launcher = long_thread(&place, machine::SMALL_LATHE).spawn().expect("it starts");
        runs(&place);
        let ids: BTreeSet<_> = name_spaces(&place).into_iter().collect();
        let victim = pid_of(&launcher, name);
        signal(launcher.id(), "STOP");
        signal(victim, "KILL");
        signal(launcher.id(), "KILL");
        let answer = Answer::from(launcher.wait_with_output().expect("it was started here"));
        assert!(answer.stderr.contains("is at rest"), "{name}: {}", answer.stderr);
        until("all processes have ended", || !alive(&place));
        assert_eq!((name_spaces(&place), shared_memory(&place, &ids)), (vec![], vec![]), "{name}");
    }
}

#[test]
fn a_plant_that_died_is_named_though_a_signal_comes_then() {
    let place = Place::new();
    let launcher = long_thread(&place, machine::SMALL_LATHE).spawn().expect("it starts");
    runs(&place);
    // The interpreter is stopped so that the launcher still waits for it when the signal comes.
    signal(pid_of(&launcher, "interpreter"), "STOP");
    signal(pid_of(&launcher, "sim-plant"), "KILL");
    wait_s(0.5);
    signal(launcher.id(), "TERM");
    let answer = Answer::from(launcher.wait_with_output().expect("it was started here"));
    let summary = summary(&place.at("run"));
    assert_eq!((answer.status, summary.outcome), (Some(1), Outcome::Faulted), "{}", answer.stderr);
    assert_eq!(codes(&summary).first(), Some(&("sim-plant", "process-died")), "{}", answer.stderr);
    let hung = summary.faults.iter().chain(&summary.warnings);
    assert!(hung.into_iter().any(|one| one.code == "process-frozen"), "the interpreter is named as well");
}

/// In real time a computer that is too busy stops the machine by itself: one of so many attempts is to be
/// quiet.
pub(crate) const ATTEMPTS: usize = 6;

/// What is told of somebody who was late.
const LATE: [&str; 5] =
    ["late-answers", "measurement-gap", "regulator-silent", "interpolator-silent", "stream-starved"];

/// Whether somebody was so late that the machine stopped, or that others took him for dead.
pub(crate) fn was_busy(summary: &Summary) -> bool {
    summary.faults.iter().any(|fault| LATE.contains(&fault.code.as_str()))
}

#[test]
fn in_real_time_an_interpreter_that_hangs_is_killed_and_named() {
    let line = |n: u32| format!("G1 X{:.3}\n", 50.0 + f64::from(n % 2) * 0.5);
    let text =
        format!("G18 G21 G90 G8 G94 F600\nG0 X50 Z90\n{}M2\n", (0..6000).map(line).collect::<String>());
    let attempt = || {
        let place = Place::new();
        let mut command = command(&place, &text, &slow_machine());
        let mut launcher = command.args(["--clock", "real", "--watchdog-s", "3"]).spawn().expect("it starts");
        runs(&place);
        signal(pid_of(&launcher, "interpreter"), "STOP");
        let deadline = Moment::in_s(40.0);
        let lives = |name: &str| children(&launcher).iter().any(|(child, _)| child == name);
        while lives("interpreter") && lives("real-time") && !deadline.passed() {
            wait_s(0.02);
        }
        let killed = !lives("interpreter") && lives("real-time");
        signal(launcher.id(), "TERM");
        assert!(ends(&mut launcher, 60.0), "it does not end");
        let summary = summary(&place.at("run"));
        assert!(killed || was_busy(&summary), "nobody has noticed: {:?}", summary.faults);
        let mut told = summary.faults.iter().chain(&summary.warnings);
        assert!(
            told.any(|one| (one.source.as_str(), one.code.as_str()) == ("interpreter", "process-frozen"))
        );
        killed && !was_busy(&summary)
    };
    assert!((0..ATTEMPTS).any(|_| attempt()), "answers were late each time");
}

#[test]
fn a_machine_needs_no_more_shared_memory_than_is_asked_for() {
    use std::os::unix::fs::MetadataExt as _;
    let place = Place::new();
    let mut launcher = long_thread(&place, machine::SMALL_LATHE).spawn().expect("it starts");
    runs(&place);
    wait_s(1.0);
    let ids: BTreeSet<_> = name_spaces(&place).into_iter().collect();
    let size = |name: &String| {
        Path::new("/dev/shm").join(name).metadata().map_or(0, |found| found.len().max(512 * found.blocks()))
    };
    let used: u64 = shared_memory(&place, &ids).iter().map(size).sum();
    signal(launcher.id(), "TERM");
    assert!(ends(&mut launcher, 60.0));
    let asked = process::ipc::channel::shared_bytes(&[protocol::Axis::X, protocol::Axis::Z]);
    assert!(used > 1_000_000 && used <= asked && asked < 3 * used, "{used} of {asked} bytes");
}

const FROZEN: &str = "G18 G21 G90 G8\nM3 S1500\nG0 X20 Z20\nG0 X9\nG33 Z-120 K2\nG0 X20\nG0 Z20\nM5\nM2\n";

#[test]
fn who_is_frozen_for_a_while_thaws_and_who_is_frozen_for_a_second_is_killed() {
    let place = Place::new();
    let run = |scenario: &str, more: &[&str]| {
        place.write("scenario.toml", format!("[[event]]\nat = {{ cycle = 5000 }}\n{scenario}\n"));
        let program = place.write("frozen.ngc", FROZEN).display().to_string();
        let arguments =
            ["run", &program, "--json", "--trace", "none", "--out", "run", "--scenario", "scenario.toml"];
        place.clear("run");
        place.ask(&[&arguments[..], more].concat())
    };
    let of = |answer: &Answer| serde_json::from_str::<Summary>(&answer.stdout).expect("a summary");
    // Two late answers are bridged.
    let short = of(&run("freeze = { process = \"regulator-x\", for_s = 0.001 }", &["--in-process"]));
    assert!(!short.faults.iter().any(|fault| fault.code == "process-frozen"), "{:?}", short.faults);
    // Longer, and the thread is left; much longer, and the drive trips: the cause is the same.
    for for_s in [0.002, 0.02] {
        let freeze = format!("freeze = {{ process = \"regulator-x\", for_s = {for_s} }}");
        let long = of(&run(&freeze, &["--in-process"]));
        assert!(codes(&long).contains(&("regulator-x", "late-answers")), "{:?}", long.faults);
        let stays = long.warnings.iter().any(|warning| warning.code == "tool-in-thread");
        assert_eq!(stays, for_s == 0.02, "{:?}", long.warnings);
        assert!(!long.faults.iter().any(|fault| fault.code == "process-frozen"), "{:?}", long.faults);
    }
    // For good: a second later it is killed, and says nothing after that.
    let killed = of(&run("freeze = \"regulator-x\"", &["--in-process"]));
    assert_eq!(codes(&killed).first(), Some(&("regulator-x", "process-frozen")), "{:?}", killed.faults);
    let own = |fault: &&rig::observe::FaultReport| fault.source == "regulator-x";
    assert_eq!(killed.faults.iter().filter(own).count(), 1, "{:?}", killed.faults);
    // Between processes in lock step no time passes in which it could thaw.
    let refused = run("freeze = { process = \"regulator-x\", for_s = 0.002 }", &[]);
    assert_eq!(refused.status, Some(2), "{}", refused.stderr);
    assert!(refused.stderr.contains("--in-process or --clock real"), "{}", refused.stderr);
    let packet = "packet = { channel = \"drive-command/x\", count = 1, drop = true }";
    assert_eq!(run(packet, &[]).status, Some(2));
}

#[test]
fn a_process_that_stands_while_the_machine_starts_is_named() {
    let place = Place::new();
    let mut command = long_thread(&place, machine::SMALL_LATHE);
    let mut launcher = command.args(["--watchdog-s", "1"]).spawn().expect("it starts");
    until("it is started", || children(&launcher).iter().any(|(child, _)| child == "regulator-z"));
    signal(pid_of(&launcher, "regulator-z"), "STOP");
    let begun = Moment::now();
    launcher.wait().expect("it was started here");
    let answer = Answer::from(launcher.wait_with_output().expect("it was started here"));
    // If it was stopped too late, the machine has begun, and the watchdog kills it.
    let named = answer.stderr.contains("regulator-z is stopped") || answer.stdout.contains("process-frozen");
    assert!(named && answer.status == Some(1), "{}", answer.stderr);
    assert!(begun.elapsed().as_secs_f64() < 15.0, "{:?}", begun.elapsed());
    assert!(!alive(&place), "nobody is left");
}

/// More than a pipe holds: a launcher whose result was not read never ended.
#[test]
fn a_result_that_is_longer_than_a_pipe_is_read() {
    let place = Place::new();
    let told: String = (0..200).map(|n| format!("(MSG,{n} {})\n", "word ".repeat(80))).collect();
    let mut command = command(&place, &format!("G21\n{told}M2\n"), machine::SMALL_LATHE);
    let mut launcher = command.args(["--in-process", "--trace", "none"]).spawn().expect("it starts");
    assert!(ends(&mut launcher, 60.0), "nobody reads its result");
    let size = place.at("run/summary.json").metadata().expect("a summary").len();
    assert!(size > PIPE as u64, "{size} bytes");
}

#[test]
fn closing_the_terminal_after_ctrl_c_asks_for_no_more_than_a_stop() {
    let place = Place::new();
    let mut launcher = long_thread(&place, machine::SMALL_LATHE).spawn().expect("it starts");
    runs(&place);
    for name in ["INT", "HUP", "TERM"] {
        signal(launcher.id(), name);
        wait_s(0.1);
    }
    assert!(ends(&mut launcher, 60.0));
    let summary = summary(&place.at("run"));
    assert_eq!((summary.outcome, codes(&summary)), (Outcome::Stopped, vec![]));
}

/// A cycle start that comes before the hold does nothing, and nobody presses another one.
#[test]
fn a_hold_that_nobody_releases_ends_the_run_and_is_named() {
    let place = Place::new();
    let event = |at: &str, does: &str| format!("[[event]]\nat = {{ {at} }}\n{does} = true\n");
    let hold = event("pass = 1, angle_deg = 720", "feed_hold") + &event("time_s = 0.1", "cycle_start");
    place.write("hold.toml", &hold);
    for how in [&["--in-process"][..], &[]] {
        let text = "G18 G21 G90 G8\nM3 S600\nG0 X20 Z8\nG0 X9\nG33 Z-10 K2\nG0 X20\nG0 Z8\nM5\nM2\n";
        let mut command = command(&place, text, machine::SMALL_LATHE);
        command.args(["--scenario", "hold.toml", "--trace", "none"]).args(how);
        let answer = Answer::from(command.output().expect("it starts"));
        assert_eq!(answer.status, Some(1), "{how:?}: {}", answer.stderr);
        let summary = summary(&place.at("run"));
        assert_eq!((summary.outcome, codes(&summary)), (Outcome::Stopped, vec![]), "{how:?}");
        let [warning] = &summary.warnings[..] else { panic!("{how:?}: {:?}", summary.warnings) };
        assert_eq!(warning.code, "nobody-at-the-panel", "{how:?}");
        assert!(warning.text.contains("no cycle_start = true"), "{how:?}: {}", warning.text);
        std::fs::remove_dir_all(place.at("run")).expect("the run folder");
    }
}

/// The last cycle of such a machine has a tick, behind the one in which its interpolator had finished: the
/// launcher waited for it for ever.
#[test]
fn a_machine_with_a_tick_in_every_control_cycle_comes_to_its_end() {
    let place = Place::new();
    let text = "G18 G21 G90 G8\nM3 S300\nG0 X20 Z15\nG0 X9.9\nG33 Z-5 K2\nG0 X20\nM5\nM2\n";
    let hash = |more: &[&str]| {
        let mut command = command(&place, text, &slow_machine());
        let mut launcher = command.args(["--trace", "none"]).args(more).spawn().expect("it starts");
        assert!(ends(&mut launcher, 30.0), "{more:?}: it does not end");
        let summary = summary(&place.at("run"));
        assert_eq!(summary.outcome, Outcome::Completed, "{more:?}: {:?}", summary.faults);
        (summary.trace_hash, summary.cycles)
    };
    assert_eq!(hash(&[]), hash(&["--in-process"]));
}
