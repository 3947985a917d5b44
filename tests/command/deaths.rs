//! Processes that are killed and frozen in any control cycle, launchers that are killed at any moment: the
//! machine comes to rest, an armed pass is finished or left, the dead are named, nothing is left behind, and
//! the next start works. What the machine did is judged by the truth of its trace, never by the time it took.

use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
    sync::OnceLock,
};

use protocol::Axis;
use rig::{
    observe::{Outcome, Summary},
    trace::{self, Row},
};
use testing::{Seed, count};

use crate::endings::has_come_to;
use crate::shop::{
    Answer, Place, alive, children, example, name_spaces, shared_memory, signal, until, wait_s,
};

const KILLS: u32 = 20;
/// What the next start is to run.
const SHORT: &str = "G18 G21 G90 G94\nG0 X50 Z90\nG1 X49 F600\nM2\n";
/// Deaths of each process in each way, unless `PITCHLOCK_DEATHS` says otherwise.
const DEATHS: u64 = 6;

/// Moments between 0 and 1.5 s, the first half of them within the start-up: a sequence of Weyl, so that they
/// are spread and the same every time.
fn moments() -> impl Iterator<Item = f64> {
    (1..=KILLS).map(|n| {
        let fraction = (f64::from(n) * 0.618_033_988_75).fract();
        if n <= KILLS / 2 { 0.12 * fraction } else { 1.5 * fraction }
    })
}

#[test]
fn a_launcher_killed_at_any_moment_spoils_no_later_run() {
    let place = Place::new();
    let short = place.write("short.ngc", SHORT);
    let mut ids = BTreeSet::new();
    for (n, moment) in moments().enumerate() {
        let mut launcher = place.start(&example("m20x2"));
        wait_s(moment);
        ids.extend(name_spaces(&place));
        signal(launcher.id(), "KILL");
        launcher.wait().expect("it was started here");
        ids.extend(name_spaces(&place));
        let summary = place.run(&short, "after", &["--trace", "none"]);
        assert_eq!(summary.outcome, Outcome::Completed, "after kill {n} at {moment} s");
    }
    assert!(ids.len() >= 8, "the kills came too early to prove anything: {}", ids.len());
    until("the orphans have ended", || !alive(&place));
    place.run(&short, "after", &["--trace", "none"]);
    assert_eq!((name_spaces(&place), shared_memory(&place, &ids)), (vec![], vec![]), "nothing is left");
}

#[test]
fn a_machine_whose_launcher_was_killed_comes_to_rest_and_wipes_itself() {
    for program in ["thread", "feed"] {
        let place = Place::new();
        let program = programs(&place).into_iter().find(|one| one.name == program).expect("it is one");
        let mut launcher = place.start(&program.path);
        has_come_to(&place, 5000);
        let ids: BTreeSet<_> = name_spaces(&place).into_iter().collect();
        signal(launcher.id(), "KILL");
        launcher.wait().expect("it was started here");
        // The pipe of its words is closed when the last of its processes has ended.
        let answer = Answer::from(launcher.wait_with_output().expect("it was started here"));
        let rests = answer.stderr.contains("emergency stop") && answer.stderr.contains("is at rest");
        assert!(rests, "{}: {}", program.name, answer.stderr);
        until("the orphans have ended", || !alive(&place));
        assert_eq!((ids.len(), name_spaces(&place), shared_memory(&place, &ids)), (1, vec![], vec![]));
    }
}

/// Where the programs begin: the part ends at Z 0.
const FRONT_MM: f64 = 19.0;

/// A stop on the tangent of the path (M101) goes on beyond a corner by 0.3 v²/A at most, A being what it
/// brakes with when it dies: X of a rapid with both axes has 75 mm/s and 1000 mm/s².
const BEYOND_CORNER_MM: f64 = 0.3 * 75.0 * 75.0 / 1000.0;

/// A program that somebody dies in.
struct Program {
    name: &'static str,
    path: PathBuf,
    /// Its length, control cycles.
    cycles: u64,
    /// At the end X is beyond this if its regulator lives, mm.
    clear_mm: f64,
}

/// One long thread, timed motion, many short passes.
fn programs(place: &Place) -> Vec<Program> {
    let head = "G18 G21 G90 G8\nM3 S1500\nG0 X20 Z20\n";
    let thread = format!("{head}G0 X9\nG33 Z-120 K2\nG0 X20\nG0 Z20\nM5\nM2\n");
    let feed = format!("{head}G94 G1 Z-100 F3000\nG3 X30 Z-110 K-10 I0\nG1 Z20 X20 F2000\nM5\nM2\n");
    let pass = |n: u32| format!("G0 X{:.2}\nG33 Z-8 K2\nG0 X20\nG0 Z20\n", 9.9 - 0.05 * f64::from(n));
    let many = format!("{head}{}M5\nM2\n", (0..8).map(pass).collect::<String>());
    let all = [("thread", thread, 12.0), ("feed", feed, 20.0 - BEYOND_CORNER_MM), ("many", many, 12.0)];
    // How long they are is found out once for all tests.
    static CYCLES: [OnceLock<u64>; 3] = [const { OnceLock::new() }; 3];
    let program = |((name, text, clear_mm), cycles): ((_, String, _), &OnceLock<u64>)| {
        let path = place.write(&format!("{name}.ngc"), text);
        let cycles = *cycles.get_or_init(|| place.run_inside(&path, None).cycles);
        Program { name, path, cycles, clear_mm }
    };
    all.into_iter().zip(&CYCLES).map(program).collect()
}

/// Runs a program, in which a process is felled in a control cycle.
fn felled(place: &Place, program: &Program, out: &str, what: &str) -> (Answer, BTreeSet<String>) {
    place.clear(out);
    let mut command = place.pitchlock();
    command.arg("run").arg(&program.path).args(["--json", "--out", out, "--trace", "csv"]);
    command.args(["--watchdog-s", "2", "--fell", what]);
    command.stdout(std::process::Stdio::piped()).stderr(std::process::Stdio::piped());
    let launcher = command.spawn().expect("it starts");
    let mut ids = BTreeSet::new();
    until("it has a name space, or has ended", || {
        ids.extend(name_spaces(place));
        !ids.is_empty() || !Path::new(&format!("/proc/{}/fd/1", launcher.id())).exists()
    });
    (Answer::from(launcher.wait_with_output().expect("it was started here")), ids)
}

/// The axes have to stand for so many cycles in the end: a tenth of a second.
const STILL_CYCLES: usize = 190;

/// The last rows of a trace: X clear, no axis moves, the spindle stands.
fn is_at_rest(folder: &Path, program: &Program, x_lives: bool) -> Result<(), String> {
    let mut rows: Vec<Row> = Vec::new();
    trace::read(&folder.join("trace.csv"), |row| {
        rows.push(row);
        if rows.len() > STILL_CYCLES {
            rows.remove(0);
        }
    })
    .map_err(|error| error.to_string())?;
    let (Some(first), Some(last)) = (rows.first(), rows.last()) else { return Err("no trace".into()) };
    for axis in [Axis::X, Axis::Z] {
        let at = |row: &Row| row.axis(axis).map_or(f64::NAN, |axis| axis.true_mm);
        // As far as a loop at rest hunts.
        let way = (at(last) - at(first)).abs();
        if way.is_nan() || way > 1e-3 {
            return Err(format!("{axis} moves from {} to {}", at(first), at(last)));
        }
    }
    // In front of the part there is no thread to be clear of.
    let at = |axis| last.axis(axis).map_or(f64::NAN, |axis| axis.true_mm);
    let (x_mm, z_mm) = (at(Axis::X), at(Axis::Z));
    if x_lives && !(x_mm > program.clear_mm || z_mm > FRONT_MM) {
        return Err(format!("X rests at {x_mm} mm, Z at {z_mm} mm"));
    }
    if last.spindle_rpm.abs() >= 1.0 {
        return Err(format!("the spindle turns at {} 1/min", last.spindle_rpm));
    }
    Ok(())
}

/// Whether a death ended as it has to.
fn judge(answer: &Answer, folder: &Path, program: &Program, name: &str, how: &str) -> Result<(), String> {
    let summary: Summary = serde_json::from_str(&answer.stdout).map_err(|error| error.to_string())?;
    let code = if how == "kill" { "process-died" } else { "process-frozen" };
    let named = |fault: &rig::observe::FaultReport| fault.source == name && fault.code == code;
    let done = name == "interpreter" && summary.outcome == Outcome::Completed;
    if done {
        // It had sent all there was; one that was frozen in its last sleep has not missed anything.
        let told = summary.warnings.iter().all(named) && summary.faults.is_empty();
        let good = told && answer.status == Some(0) && summary.passes.iter().all(|pass| pass.complete);
        return if good { Ok(()) } else { Err(format!("{:?} {:?}", answer.status, summary.warnings)) };
    }
    let ends = (answer.status, summary.outcome) == (Some(1), Outcome::Faulted);
    // The cause is listed before what came of it.
    if !ends || !summary.faults.first().is_some_and(named) {
        return Err(format!("status {:?}, {:?}: {:?}", answer.status, summary.outcome, summary.faults));
    }
    if summary.faults.iter().any(|fault| fault.code == "no-rest") {
        return Err(format!("{:?}", summary.faults));
    }
    let exit = summary.processes.iter().find(|process| process.name == name);
    if exit.and_then(|exit| exit.signal.as_deref()) != Some("SIGKILL") {
        return Err(format!("{exit:?}"));
    }
    let others = summary.processes.iter().filter(|process| process.name != name);
    if let Some(other) = others.into_iter().find(|other| other.exit != Some(0)) {
        return Err(format!("{other:?}"));
    }
    let of_dead = |channel: &&rig::observe::Channel| channel.not_counted.iter().any(|dead| dead == name);
    let (uncounted, counted): (Vec<_>, Vec<_>) = summary.channels.iter().partition(of_dead);
    // Whom it sent to has told how much came: everybody lives but the dead.
    let silent = |channel: &&rig::observe::Channel| channel.sent < channel.received + channel.lost;
    if uncounted.is_empty() || counted.iter().any(|channel| !channel.not_counted.is_empty()) {
        return Err(format!("{uncounted:?} {counted:?}"));
    }
    if let Some(channel) = summary.channels.iter().find(silent) {
        return Err(format!("more came than was sent: {channel:?}"));
    }
    if name == "sim-plant" { Ok(()) } else { is_at_rest(folder, program, name != "regulator-x") }
}

/// One process, killed or frozen in seeded cycles of all programs.
fn dies_anywhere(name: &str, how: &str) -> Vec<String> {
    let place = Place::new();
    let programs = programs(&place);
    let mut seed = Seed::of_case(
        name.bytes().chain(how.bytes()).map(u64::from).fold(0, |sum, byte| (31 * sum + byte) % 65_521),
    );
    let (mut wrong, mut ids) = (Vec::new(), BTreeSet::new());
    for n in 0..count("PITCHLOCK_DEATHS", DEATHS) {
        let program = &programs[n as usize % programs.len()];
        let cycle = seed.within(1..program.cycles - 1);
        let what = format!("{name}:{how}@{cycle}");
        let (answer, space) = felled(&place, program, "run", &what);
        ids.extend(space);
        if let Err(reason) = judge(&answer, &place.at("run"), program, name, how) {
            wrong.push(format!("{} {what}: {reason}\n{}", program.name, answer.stderr));
        }
        let left = (name_spaces(&place), shared_memory(&place, &ids), alive(&place));
        if left != (vec![], vec![], false) {
            wrong.push(format!("{} {what} leaves {left:?}", program.name));
        }
    }
    let short = place.write("short.ngc", SHORT);
    let summary = place.run(&short, "after", &["--trace", "none"]);
    assert_eq!(summary.outcome, Outcome::Completed, "after all of {name} {how}");
    wrong
}

fn missed(names: &[&'static str], how: &'static str) -> Vec<String> {
    // A machine that waits for a watchdog leaves the processors to others.
    std::thread::scope(|scope| {
        let all: Vec<_> = names.iter().map(|name| scope.spawn(move || dies_anywhere(name, how))).collect();
        all.into_iter().flat_map(|one| one.join().expect("it judges")).collect()
    })
}

fn nobody_is_missed(how: &str, wrong: &[String]) {
    assert!(wrong.is_empty(), "{how}: {} wrong:\n{}", wrong.len(), wrong.join("\n"));
}

const NAMES: [&str; 5] = ["interpreter", "interpolator", "regulator-x", "regulator-z", "sim-plant"];

#[test]
fn whoever_is_killed_in_any_cycle_is_named_and_the_machine_comes_to_rest() {
    let wrong = [&NAMES[..3], &NAMES[3..]].map(|names| missed(names, "kill"));
    nobody_is_missed("kill", &wrong.concat());
}

#[test]
fn whoever_freezes_in_any_cycle_is_named_and_the_machine_comes_to_rest() {
    nobody_is_missed("freeze", &missed(&NAMES, "freeze"));
}

#[test]
fn a_kill_by_a_regulators_cycle_gives_the_same_run_each_time() {
    let place = Place::new();
    let program = &programs(&place)[0];
    let run = |out: &str| {
        let (answer, _) = felled(&place, program, out, "regulator-z:kill@5001");
        let summary: Summary = serde_json::from_str(&answer.stdout).expect("--json prints the summary");
        (summary.trace_hash, summary.faults, summary.channels)
    };
    let (hash, faults, channels) = run("one");
    let again = run("two");
    assert_eq!((&hash, &faults), (&again.0, &again.1));
    // What the dead regulator has not told is what others took of it, at least, and says so.
    let of =
        |name: &str| channels.iter().find(|channel| channel.name == name).expect("every channel is there");
    let (dead, other) = (of("drive-command/z"), of("drive-command/x"));
    assert!((5000..=5002).contains(&dead.sent) && dead.sent == dead.received, "{dead:?}");
    assert_eq!((&dead.not_counted[..], other.not_counted.len()), (&["regulator-z".to_string()][..], 0));
    assert!(other.sent > dead.sent && other.lost == 0, "{other:?}");
    for name in ["axis-command/z", "measurement", "axis-status/z", "arrival"] {
        assert_eq!(of(name).not_counted, ["regulator-z"], "{name}");
    }
}

/// Self-contained rule over processes: 50 s on the machine in one pass, its interpolator is killed near the
/// beginning.
#[test]
fn a_pass_is_cut_to_its_end_though_the_interpolator_was_killed() {
    let place = Place::new();
    let text = "G18 G21 G90 G8\nM3 S300\nG0 X20 Z150\nG0 X9\nG33 Z-350 K2\nG0 X20\nG0 Z150\nM5\nM2\n";
    let path = place.write("long.ngc", text);
    let program = Program { name: "long", path, cycles: 0, clear_mm: 12.0 };
    let (answer, _) = felled(&place, &program, "run", "interpolator:kill@6000");
    let summary: Summary = serde_json::from_str(&answer.stdout).expect("--json prints the summary");
    assert_eq!((answer.status, summary.outcome), (Some(1), Outcome::Faulted), "{}", answer.stderr);
    assert!(summary.faults.iter().any(|fault| fault.source == "interpolator"), "{:?}", summary.faults);
    assert_eq!(summary.passes.len(), 1, "the kill came too early");
    let pass = &summary.passes[0];
    // One axis may be at the end of its law some cycles before the other, which then calls the pass left.
    assert!(pass.thread_cycles > 99_500 && pass.same_index, "{pass:#?}");
    // The screw is off by 4 µm along 350 mm, more than the table of the machine file says.
    assert!(pass.z.thread_max_abs_um <= 1.5 && pass.x.thread_max_abs_um <= 0.5, "{pass:#?}");
    assert!(pass.tool.helix_max_abs_um <= 4.0, "{pass:#?}");
    assert!(summary.cycles < pass.end_cycle + 10_000, "the machine ends after the pass");
    assert_eq!(is_at_rest(&place.at("run"), &program, true), Ok(()));
}

/// A process that is killed from outside, with a signal that comes when it comes.
#[test]
fn a_signal_from_outside_is_told_by_its_name() {
    let place = Place::new();
    let launcher = place.start(&example("m20x2"));
    until("the machine runs", || place.at("run/trace.mcap").exists());
    let victim = children(&launcher).into_iter().find(|(child, _)| child == "regulator-x");
    // Not QUIT: a shell that starts something in the background has it ignore that, and all that it starts.
    signal(victim.expect("it runs").1, "ABRT");
    let answer = Answer::from(launcher.wait_with_output().expect("it was started here"));
    let summary: Summary = serde_json::from_str(&answer.stdout).expect("--json prints the summary");
    assert_eq!(answer.status, Some(1), "{}", answer.stderr);
    let process = summary.processes.iter().find(|process| process.name == "regulator-x");
    assert_eq!(process.map(|one| (one.exit, one.signal.as_deref())), Some((None, Some("SIGABRT"))));
    assert!(summary.faults[0].text.contains("SIGABRT"), "{:?}", summary.faults);
    assert!(place.at("run/report.html").exists() && place.at("run/summary.json").exists());
}
