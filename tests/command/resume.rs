//! Runs whose processes are all killed in seeded cycles, and whose files are torn and damaged, gone on with
//! by `pitchlock run RUN_DIR --resume`; the same behind faults, behind an abort, in a run that went on
//! already; and what is refused.

use std::{fs, path::Path};

use process::ipc::time::Moment;
use rig::{
    observe::{Outcome, PartVerdict, Summary},
    replay::Arrivals,
};
use serde_json::Value;
use testing::Seed;

use crate::shop::{Place, children, signal, until, wait_s};

/// Turned, then threaded in passes that take a second each on the machine.
const PROGRAM: &str = "(thread, M20x2-6g)\nG18 G21 G90 G8 G94 G97\nT1\nM3 S800\nG0 X9.91 Z1\nG1 Z-16 F600\nG1 X12\nG0 Z8\n\
    T3\nM3 S900\nG0 X11 Z8\nG76 P2 Z-14 I-1.09 J0.8 K1.4845 R2 Q29.5 H1\nG0 X20\nM5\nM2\n";
/// Cuts, unless `PITCHLOCK_CUTS` says otherwise.
const CUTS: u64 = 40;
/// A thread that was broken off is finished in its groove, µm.
const SAME_GROOVE_UM: f64 = 1.5;

/// What is said of a run whose launcher did not see its end.
const NO_END: &str = "not known whether its machine lost its power";

fn cuts() -> u64 {
    std::env::var("PITCHLOCK_CUTS").ok().and_then(|cuts| cuts.parse().ok()).unwrap_or(CUTS)
}

/// Control cycles that are recorded so far.
pub(crate) fn recorded(folder: &Path) -> u64 {
    let bytes = fs::read(folder.join("moment.bin")).unwrap_or_default();
    bytes.get(..8).and_then(|cycles| cycles.try_into().ok()).map_or(0, u64::from_le_bytes)
}

/// Starts a run and kills everybody as soon as so many cycles are recorded; whether the run was still on.
pub(crate) fn killed(place: &Place, at: u64, arguments: &[&str]) -> bool {
    place.clear("run");
    let mut command = place.pitchlock();
    command.args(["run", "--out", "run", "--quiet", "--trace", "none"]).args(arguments);
    let mut launcher = command.spawn().expect("it starts");
    let patience = Moment::in_s(60.0);
    while recorded(&place.at("run")) < at && launcher.try_wait().expect("a child").is_none() {
        assert!(!patience.passed(), "cycle {at} does not come");
        wait_s(2e-4);
    }
    let everybody: Vec<u32> = children(&launcher).into_iter().map(|(_, pid)| pid).collect();
    let was_on = launcher.try_wait().expect("a child").is_none();
    signal(launcher.id(), "KILL");
    everybody.into_iter().for_each(|pid| signal(pid, "KILL"));
    launcher.wait().expect("it was started here");
    was_on
}

/// What the journal knows.
fn known(place: &Place) -> Option<Value> {
    let answer = place.ask(&["journal", "run", "--json"]);
    (answer.status == Some(0)).then(|| serde_json::from_str(&answer.stdout).expect("one document"))
}

/// What a loss of power may do to the files that were being written: the end of the journal torn, a bit of it
/// turned over, the record of the machine damaged.
fn damage(place: &Place, random: &mut Seed) {
    let path = place.at("run/journal.bin");
    let mut bytes = fs::read(&path).expect("a journal");
    if bytes.len() > 2048 {
        bytes.truncate(bytes.len() - random.below(1500));
        let at = random.below(bytes.len());
        bytes[at] ^= 1 << random.below(8);
    }
    fs::write(&path, &bytes).expect("room");
    for name in ["run/moment.bin", "run/arrivals.live"] {
        let path = place.at(name);
        let Ok(mut bytes) = fs::read(&path) else { continue };
        match random.below(3) {
            0 => bytes.truncate(random.below(bytes.len() + 1)),
            1 => {
                let at = random.below(bytes.len());
                bytes[at] ^= 1 << random.below(8);
            }
            _ => {}
        }
        fs::write(&path, &bytes).expect("room");
    }
}

/// Goes on with a run; what it came to.
fn resumed(place: &Place, what: &str) -> Summary {
    place.clear("on");
    let answer = place.ask(&["run", "run", "--resume", "--out", "on", "--trace", "none"]);
    assert!(matches!(answer.status, Some(0 | 3)), "{what}: {:?} {}", answer.status, answer.stderr);
    Summary::read(&place.at("on/summary.json")).expect("it has one")
}

/// Every kill is followed by a start that is not refused. Nothing that the journal had is lost with the files
/// behind it, and all passes lie in the groove of those before.
#[test]
fn runs_that_are_killed_in_any_cycle_are_finished_in_their_groove() {
    let place = Place::new();
    let program = place.write("screw.ngc", PROGRAM).display().to_string();
    let whole = place.run(Path::new(&program), "whole", &["--in-process", "--trace", "none"]);
    assert_eq!(whole.gauge.as_ref().map(|gauge| gauge.verdict), Some(PartVerdict::Good), "{:?}", whole.gauge);
    let (mut in_thread, mut good, mut most_um) = (0, 0, 0.0_f64);
    // A thousand can be shared by several processors.
    let first = testing::count("PITCHLOCK_FIRST_CUT", 0);
    for number in first..first + cuts() {
        let mut random = Seed::of_case(number);
        let at = random.within(1..whole.cycles);
        // Every fourth as processes: these take longer to start.
        let how: &[&str] = if number % 4 == 0 { &[] } else { &["--in-process"] };
        if !killed(&place, at, &[how, &[program.as_str()]].concat()) {
            continue;
        }
        let before = known(&place);
        // It may have come to its end before everybody was dead.
        if before.as_ref().is_some_and(|known| known["end"] == "completed") {
            continue;
        }
        let what = format!("case {number}, cycle {at}");
        if number % 2 == 1 {
            damage(&place, &mut random);
        }
        let passes = |known: &Option<Value>| {
            known.as_ref().map_or(0, |known| known["passes"].as_u64().expect("a number"))
        };
        let (had, has) = (passes(&before), passes(&known(&place)));
        assert!(has + 1 >= had, "{what}: {has} passes are left of {had}");
        let on = resumed(&place, &what);
        assert_eq!((on.outcome, &on.faults[..]), (Outcome::Completed, &[][..]), "{what}");
        assert_eq!(on.passes.len() as u64 + has, whole.passes.len() as u64, "{what}: all passes are cut");
        let apart_um = on.thread.tool_phase_spread_um;
        assert!(apart_um <= SAME_GROOVE_UM, "{what}: {apart_um:.2} um from the groove");
        let report = on.resumed.as_ref().expect("it says what it goes on with");
        let verdict = on.gauge.as_ref().map(|gauge| gauge.verdict);
        // The only thing that can have spoilt the thread is a tool that stood in it while the spindle ran
        // down, and nothing but that has.
        match &report.rings[..] {
            [] => assert_eq!(verdict, Some(PartVerdict::Good), "{what}: {:?}", on.part.reasons),
            _ => assert_eq!(report.gauge_without_rings, Some(PartVerdict::Good), "{what}: {:?}", on.part),
        }
        assert_eq!(report.rings.is_empty(), on.part.reasons.is_empty(), "{what}: {:?}", on.part.reasons);
        in_thread += u32::from(report.pass.is_some());
        good += u32::from(verdict == Some(PartVerdict::Good));
        most_um = most_um.max(apart_um);
        println!(
            "{what}: line {} pass {:?}, {apart_um:.3} um, {verdict:?} {:?}",
            report.line, report.pass, report.rings
        );
    }
    println!("{in_thread} begun in the thread, {most_um:.3} um apart at most, {good} good by the gauge");
}

/// The operator aborts in a pass: the machine came to rest by itself. The run that goes on is killed and gone
/// on with as well, and made again from its folder.
#[test]
fn a_run_that_goes_on_is_gone_on_with_and_made_again() {
    let place = Place::new();
    let program = place.write("screw.ngc", PROGRAM).display().to_string();
    let scenario = "[[event]]\nat = { pass = 2, z_mm = -5.0 }\nabort = true\n";
    let scenario = place.write("abort.toml", scenario).display().to_string();
    let aborted = place.ask(&[
        "run",
        &program,
        "--in-process",
        "--scenario",
        &scenario,
        "--trace",
        "none",
        "--out",
        "first",
    ]);
    assert_eq!(aborted.status, Some(1), "{}", aborted.stderr);
    // Without what has happened to it it was another run.
    fs::rename(place.at("first/scenario.toml"), place.at("kept.toml")).expect("it is there");
    let other = place.ask(&["run", "first", "--resume", "--dry-run"]);
    assert!(other.status == Some(2) && other.stderr.contains("(scenario.toml)"), "{}", other.stderr);
    fs::rename(place.at("kept.toml"), place.at("first/scenario.toml")).expect("it is there");
    let told = place.ask(&["run", "first", "--resume", "--dry-run"]);
    assert_eq!(told.status, Some(0), "{}", told.stderr);
    assert!(!told.stdout.contains(NO_END), "{}", told.stdout);
    for words in ["the operator ended the program", "not known", "begins    at line 12, pass 2, whole"] {
        assert!(told.stdout.contains(words), "{}", told.stdout);
    }
    let told = place.ask(&["run", "first", "--resume", "--dry-run", "--json"]);
    let document: Value = serde_json::from_str(&told.stdout).expect("one document");
    assert_eq!((&document["pass"], &document["passes_done"]), (&2.into(), &1.into()));

    assert!(killed(&place, 6000, &["first", "--resume"]), "it is killed in the middle");
    let on = resumed(&place, "the second time");
    assert_eq!(on.outcome, Outcome::Completed);
    // A tool that stood in its groove when it was killed has cut a ring there.
    let report = on.resumed.as_ref().expect("it says what it goes on with");
    let verdict = match &report.rings[..] {
        [] => on.gauge.as_ref().map(|gauge| gauge.verdict),
        _ => report.gauge_without_rings,
    };
    assert_eq!(verdict, Some(PartVerdict::Good), "{:?} {:?}", report.rings, on.gauge);
    assert!(on.thread.tool_phase_spread_um <= SAME_GROOVE_UM);
    let again = place.ask(&["replay", "on"]);
    assert_eq!(again.status, Some(0), "{}{}", again.stdout, again.stderr);
    let repeated = place.ask(&["run", "on"]);
    assert!(
        repeated.status == Some(2) && repeated.stderr.contains("goes on with another run"),
        "{}",
        repeated.stderr
    );
    // Whatever is left of its journal, it came to its end.
    fs::write(place.at("on/journal.bin"), []).expect("room");
    let over = place.ask(&["run", "on", "--resume"]);
    assert!(over.status == Some(2) && over.stderr.contains("nothing to go on with"), "{}", over.stderr);
}

/// Runs the program in a scenario to its fault, and goes on with it.
fn after(place: &Place, event: &str, words: &str) -> Summary {
    let program = place.at("screw.ngc").display().to_string();
    let scenario = place.write("scenario.toml", format!("[[event]]\n{event}\n")).display().to_string();
    place.clear("run");
    let asked = [
        "run",
        &program,
        "--in-process",
        "--quiet",
        "--trace",
        "none",
        "--out",
        "run",
        "--scenario",
        &scenario,
    ];
    let broken = place.ask(&asked);
    assert!(broken.status == Some(1) && broken.stderr.contains(words), "{event}: {}", broken.stderr);
    let on = resumed(place, event);
    assert_eq!((on.outcome, &on.faults[..]), (Outcome::Completed, &[][..]), "{event}");
    assert!(on.thread.tool_phase_spread_um <= SAME_GROOVE_UM, "{event}: {:?}", on.thread);
    on
}

/// What led the tool out of its thread leaves a thread that is finished and good. A regulator that is dead
/// leads it nowhere: the gauge sees that.
#[test]
fn behind_every_fault_the_thread_is_finished() {
    let place = Place::new();
    place.write("screw.ngc", PROGRAM);
    let in_pass = "at = { pass = 3, z_mm = -5.0 }\n";
    for (action, words) in [
        ("power_lost = true", "power-lost"),
        ("drive_fault = \"x\"", "drive-fault"),
        ("encoder_stands = true", "encoder-stands"),
        ("emergency_stop = true", "emergency-stop"),
        ("kill = \"interpolator\"", "process-died"),
    ] {
        let on = after(&place, &format!("{in_pass}{action}"), words);
        let report = on.resumed.as_ref().expect("it says what it goes on with");
        assert_eq!((report.pass, on.passes.len()), (Some(3), 3), "{action}");
        let verdict = on.gauge.as_ref().map(|gauge| gauge.verdict);
        assert_eq!(verdict, Some(PartVerdict::Good), "{action}: {:?}", on.part.reasons);
    }
    // Before the change of the tool and behind it nothing is in the material; the tool is called for again.
    for line in [8, 11] {
        let event = format!("at = {{ line = {line} }}\nemergency_stop = true");
        let on = after(&place, &event, "emergency-stop");
        assert_eq!((on.passes.len(), on.part.verdict), (5, PartVerdict::Good), "{:?}", on.part.reasons);
    }
}

/// Names of all that is in a folder, with what it holds.
fn held(folder: &Path) -> Vec<(std::ffi::OsString, Vec<u8>)> {
    let files = fs::read_dir(folder).expect("a folder").map(|file| file.expect("a file"));
    let mut held: Vec<_> =
        files.map(|file| (file.file_name(), fs::read(file.path()).unwrap_or_default())).collect();
    held.sort();
    held
}

/// A journal as another version would leave it.
fn of_other_version(place: &Place, journal: &[u8]) -> Vec<u8> {
    let mut other = journal[..1024].to_vec();
    for sector in other.chunks_mut(512) {
        sector[7] += 1;
        let path = place.at("sector");
        fs::write(&path, &sector[..504]).expect("room");
        let hash = rig::hash::of_file(&path).expect("it is there");
        sector[504..].copy_from_slice(&hash.as_bytes()[..8]);
    }
    other
}

/// Who takes a run for one that came to its end is told what it is.
fn is_told_to_be_broken_off(place: &Place) {
    for command in [&["run", "run"][..], &["replay", "run"], &["report", "run"], &["diff", "run", "run"]] {
        let answer = place.ask(command);
        assert_eq!(answer.status, Some(2), "{command:?}: {}", answer.stderr);
        for words in ["was broken off", "run --resume` goes on"] {
            assert!(answer.stderr.contains(words), "{command:?}: {}", answer.stderr);
        }
    }
}

#[test]
fn what_cannot_be_gone_on_with_is_refused_and_left_as_it_is() {
    let place = Place::new();
    let program = place.write("screw.ngc", PROGRAM).display().to_string();
    assert!(killed(&place, 9000, &["--in-process", &program]), "it is killed in the middle");
    let refused = |arguments: &[&str], words: &str| {
        let answer = place.ask(&[&["run", "run", "--resume", "--out", "on"], arguments].concat());
        assert!(answer.status == Some(2) && answer.stderr.contains(words), "{words}: {}", answer.stderr);
        assert!(!place.at("on").exists());
    };
    refused(&["--clock", "real"], "virtual time only");
    refused(&["--panel"], "has no panel");
    refused(&["--seed", "7"], "leave out everything that says others");
    let in_place_of = |name: &str, other: &[u8], words: &str| {
        let path = place.at("run").join(name);
        let kept = fs::read(&path).expect("it is there");
        fs::write(&path, other).expect("room");
        refused(&[], words);
        fs::write(&path, kept).expect("room");
    };
    in_place_of("screw.ngc", PROGRAM.replace("J0.8", "J0.7").as_bytes(), "were changed since");
    let machine = fs::read_to_string(place.at("run/machine.toml")).expect("a machine file");
    in_place_of("machine.toml", format!("{machine}\n# mended\n").as_bytes(), "were changed since");
    // Nothing has happened to it that was not to happen.
    fs::write(place.at("run/scenario.toml"), "").expect("room");
    refused(&[], "the scenario, tools or parameters in it are not those of its journal");
    fs::remove_file(place.at("run/scenario.toml")).expect("it is there");
    let journal = fs::read(place.at("run/journal.bin")).expect("a journal");
    in_place_of("journal.bin", &of_other_version(&place, &journal), "another version of pitchlock");
    let live = "pitchlock arrivals 1\nby 0.0.1 0.0.1\nmachine one-process\nclock virtual\nseed 1\n";
    in_place_of("arrivals.live", Arrivals::live(0, live).as_bytes(), "a run of pitchlock 0.0.1");
    let real = Arrivals::head(true, true, 1);
    in_place_of("arrivals.live", real.as_bytes(), "ran in real time");
    // One bit costs nothing; what is torn is told.
    let live = fs::read(place.at("run/arrivals.live")).expect("it is there");
    for (left, is_told) in [(live.len() - 1, false), (live.len() / 2, true), (0, true)] {
        fs::write(place.at("run/arrivals.live"), &live[..left]).expect("room");
        let told = place.ask(&["run", "run", "--resume", "--dry-run"]);
        assert_eq!(told.status, Some(0), "{left} bytes: {}", told.stderr);
        assert_eq!(told.stdout.contains("arrivals.live is damaged"), is_told, "{left}: {}", told.stdout);
        assert!(told.stdout.contains(NO_END), "{left}: {}", told.stdout);
    }
    fs::write(place.at("run/arrivals.live"), &live).expect("room");
    for (name, words) in [("nowhere", "journal.bin"), (program.as_str(), "journal.bin")] {
        let answer = place.ask(&["run", name, "--resume"]);
        assert!(answer.status == Some(2) && answer.stderr.contains(words), "{}", answer.stderr);
    }
    for alone in [&["run", &program, "--dry-run"][..], &["panel", "run", "--resume"]] {
        assert_eq!(place.ask(alone).status, Some(2), "{alone:?}");
    }

    is_told_to_be_broken_off(&place);
    // Nothing is written by a dry run.
    let before = held(&place.at("run"));
    let told = place.ask(&["run", "run", "--resume", "--dry-run"]);
    assert!(told.status == Some(0) && told.stdout.contains("begins    at line"), "{}", told.stderr);
    assert!(held(&place.at("run")) == before && !place.at("runs").exists());

    // Nothing is left of its journal: it is gone on with if there is one tool only.
    fs::write(place.at("run/journal.bin"), [0x55; 700]).expect("room");
    refused(&[], "nobody knows which one is in the holder");
    let program = place.write("screw.ngc", PROGRAM.replace("T1\n", "T3\n")).display().to_string();
    assert!(killed(&place, 9000, &["--in-process", &program]), "it is killed in the middle");
    fs::write(place.at("run/journal.bin"), [0x55; 700]).expect("room");
    let told = place.ask(&["run", "run", "--resume", "--dry-run"]);
    assert!(told.status == Some(0) && told.stdout.contains("no whole record"), "{}", told.stderr);
    let on = resumed(&place, "without a journal");
    assert_eq!((on.outcome, on.passes.len()), (Outcome::Completed, 5));
}

#[test]
fn a_run_that_still_goes_on_is_left_alone() {
    let place = Place::new();
    let program = place.write("screw.ngc", PROGRAM).display().to_string();
    let mut command = place.pitchlock();
    command.args(["run", &program, "--in-process", "--pace", "0.05", "--out", "run", "--quiet"]);
    let mut launcher = command.spawn().expect("it starts");
    until("it runs", || recorded(&place.at("run")) > 0);
    for (arguments, words) in [
        (&["run", "run", "--resume"][..], "still goes on"),
        (&["report", "run"], "still goes on"),
        (&["run", &program, "--in-process", "--out", "run"], "another run writes into this folder"),
    ] {
        let answer = place.ask(arguments);
        assert!(
            answer.status == Some(2) && answer.stderr.contains(words),
            "{arguments:?}: {}",
            answer.stderr
        );
    }
    signal(launcher.id(), "KILL");
    launcher.wait().expect("it was started here");
    let answer = place.ask(&["run", "run", "--resume", "--dry-run"]);
    assert_eq!(answer.status, Some(0), "{}", answer.stderr);
}
