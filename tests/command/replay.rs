//! Recorded runs are made again, bit for bit: in one process and in several, in lock step and in real
//! time, with deaths, faults and operators in them; and two runs are compared.

use std::path::{Path, PathBuf};

use rig::observe::Summary;

use crate::endings::{ends, runs, slow_machine};
use crate::shop::{Answer, Place, SCENARIOS, children, project, scenario, signal, wait_s};
use crate::stood::stopped_s;

/// Makes the run of a folder again, which has to be the same.
pub(crate) fn is_the_same_again(place: &Place, folder: &str) -> Answer {
    let answer = place.ask(&["replay", folder]);
    let (status, stdout, stderr) = (answer.status, &answer.stdout, &answer.stderr);
    assert_eq!(status, Some(0), "{folder}: {stdout}{stderr}");
    assert!(stdout.starts_with("the same, bit for bit: "), "{folder}: {stdout}");
    answer
}

/// Runs something, whatever becomes of it, into a folder.
fn run(place: &Place, program: &Path, folder: &str, arguments: &[&str]) {
    place.clear(folder);
    let mut command = place.pitchlock();
    command.arg("run").arg(program).args(["--quiet", "--trace", "none", "--out", folder]).args(arguments);
    let answer = Answer::from(command.output().expect("it starts"));
    assert!(answer.status.is_some_and(|status| status != 2), "{}: {}", program.display(), answer.stderr);
}

/// Arrivals of a folder, line by line, without their head.
pub(crate) fn arrivals(place: &Place, folder: &str) -> Vec<String> {
    let text = std::fs::read_to_string(place.at(folder).join("arrivals.txt")).expect("a run leaves them");
    text.lines().skip(3).map(str::to_owned).collect()
}

/// All examples, each with its machine; the first three are made again in every run of the tests.
const EXAMPLES: [(&str, &str); 33] = [
    ("fanuc/shaft-m24.nc", "machines/small-lathe"),
    ("mill/contour.ngc", "machines/small-mill"),
    ("positioner/points.toml", "machines/positioner"),
    ("shaft.ngc", "machines/small-lathe"),
    ("m20x2.ngc", "machines/small-lathe"),
    ("worm-left.ngc", "machines/small-lathe"),
    ("internal-m30.ngc", "machines/small-lathe"),
    ("chain.ngc", "machines/small-lathe"),
    ("lead-table.ngc", "machines/small-lathe"),
    ("blunt-start.ngc", "machines/small-lathe"),
    ("two-inserts.ngc", "machines/small-lathe"),
    ("scroll.ngc", "machines/small-lathe"),
    ("tap-m8.ngc", "machines/small-lathe"),
    ("tap-npt.ngc", "machines/small-lathe"),
    ("varied.ngc", "machines/small-lathe"),
    ("fanuc/taper-g32.nc", "machines/small-lathe"),
    ("fanuc/tap-peck.nc", "machines/small-lathe"),
    ("fanuc/grooves-macro.nc", "machines/small-lathe"),
    ("fanuc/variable-lead.nc", "machines/small-lathe"),
    ("fanuc/barrel.nc", "machines/small-lathe"),
    ("fanuc/domed-face.nc", "machines/small-lathe"),
    ("fanuc/two-starts.nc", "machines/small-lathe"),
    ("mill/circle.ngc", "machines/small-mill"),
    ("mill/tap-m6.ngc", "machines/small-mill"),
    ("positioner/cylinders.toml", "machines/positioner"),
    ("positioner/wave.toml", "machines/positioner"),
    ("shape/contour.toml", "machines/small-mill"),
    ("shape/inline.ngc", "machines/small-mill"),
    ("shape/wave.toml", "machines/small-mill"),
    ("resumed/screw.ngc", "machines/small-lathe"),
    ("rechucked/thread.ngc", "machines/small-lathe"),
    ("bar-feeder/pin.ngc", "bar-feeder/lathe"),
    ("first-hour/bolt.ngc", "first-hour/my-lathe"),
];

/// Programs below a folder, with the names of their folders.
fn programs(folder: &Path) -> usize {
    let files = std::fs::read_dir(folder).expect("a folder").map(|file| file.expect("a file").path());
    let is_program = |path: &PathBuf| {
        let text = std::fs::read_to_string(path).unwrap_or_default();
        path.extension().is_some_and(|ending| ending == "ngc" || ending == "nc") || text.contains("\n[job]\n")
    };
    files.map(|path| if path.is_dir() { programs(&path) } else { usize::from(is_program(&path)) }).sum()
}

/// The scenarios that are shipped, and those that stand beside a program.
fn scenarios_of(program: &Path) -> Vec<String> {
    let folder = program.parent().expect("it is in a folder");
    let files = std::fs::read_dir(folder).expect("a folder").map(|file| file.expect("a file").path());
    let has_events = |path: &PathBuf| {
        path.extension().is_some_and(|ending| ending == "toml")
            && std::fs::read_to_string(path).is_ok_and(|text| text.contains("[[event]]"))
    };
    let all = SCENARIOS.into_iter().map(scenario).chain(files.filter(has_events));
    all.map(|path| path.display().to_string()).collect()
}

/// Without a scenario and, of `PITCHLOCK_REPLAYS=200`, in every one.
#[test]
fn examples_are_the_same_again() {
    let (place, examples) = (Place::new(), project().join("examples"));
    assert_eq!(programs(&examples), EXAMPLES.len(), "every example is in the table");
    let count = testing::count("PITCHLOCK_REPLAYS", 3).min(EXAMPLES.len() as u64) as usize;
    // Where the tutorial has the zero of its lathe.
    let g54 = place.write("g54.var", "5220 1\n5221 0\n5223 -310\n").display().to_string();
    let mut made = 0;
    for (program, machine) in &EXAMPLES[..count] {
        let machine = examples.join(machine).with_extension("toml").display().to_string();
        let tools = examples.join("first-hour/tools.tbl").display().to_string();
        let mut arguments = vec!["--in-process", "--machine", &machine];
        if program.starts_with("first-hour") {
            arguments.extend(["--tools", &tools, "--parameters", &g54]);
        }
        let table = examples.join("resumed/shop.tbl").display().to_string();
        if program.starts_with("resumed") {
            arguments.extend(["--tools", &table]);
        }
        let more = scenarios_of(&examples.join(program)).into_iter().filter(|_| count > 3).map(Some);
        for scenario in std::iter::once(None).chain(more) {
            let scenario = scenario.iter().flat_map(|path| ["--scenario", path]);
            let arguments: Vec<&str> = arguments.iter().copied().chain(scenario).collect();
            run(&place, &examples.join(program), "run", &arguments);
            is_the_same_again(&place, "run");
            made += 1;
        }
    }
    println!("{made} runs of {count} examples were made again");
}

#[test]
fn seeds_of_the_soak_with_their_faults_are_the_same_again() {
    let place = Place::new();
    let (mut seeds, mut left) = (0.., testing::count("PITCHLOCK_REPLAYS", 4));
    let mut over_processes = 0;
    while left > 0 {
        let seed = seeds.next().unwrap_or_default();
        let (case, ran) = soak::driver::one(seed);
        if case.events.is_empty() || ran.cycles > 60_000 {
            continue;
        }
        left -= 1;
        place.write("machine.toml", case.machine_file().expect("it can be written"));
        place.write("scenario.toml", case.scenario());
        let program = place.write("program.ngc", case.program());
        let arguments = ["--machine", "machine.toml", "--scenario", "scenario.toml", "--seed"];
        let plant_seed = case.plant_seed.to_string();
        let arguments = [&arguments[..], &[&plant_seed]].concat();
        run(&place, &program, "run", &[&arguments[..], &["--in-process"]].concat());
        is_the_same_again(&place, "run");
        // Over processes there is nobody who tampers with messages, and no time for who is frozen.
        if !case.scenario().contains("packet =") && !case.scenario().contains("freeze =") {
            run(&place, &program, "processes", &arguments);
            is_the_same_again(&place, "processes");
            over_processes += 1;
        }
    }
    assert!(over_processes > 0, "none of them ran as processes");
}

pub(crate) const THREAD: &str =
    "G18 G21 G90 G8\nM3 S1500\nG0 X20 Z20\nG0 X9\nG33 Z-60 K2\nG0 X20\nG0 Z20\nM5\nM2\n";

#[test]
fn runs_in_which_a_process_dies_are_the_same_again() {
    let place = Place::new();
    let program = place.write("program.ngc", THREAD);
    for fell in ["regulator-x:kill@5000", "interpolator:kill@5002", "interpreter:kill@3"] {
        run(&place, &program, "run", &["--fell", fell]);
        is_the_same_again(&place, "run");
    }
    // What the operator did came from outside, in a cycle that nobody foresaw.
    let long = place.write("long.ngc", THREAD.replace("Z-60", "Z-160").replace("S1500", "S60"));
    place.clear("run");
    let mut command = place.pitchlock();
    command.arg("run").arg(long).args(["--quiet", "--out", "run"]);
    let mut launcher = command.spawn().expect("it starts");
    runs(&place);
    signal(launcher.id(), "INT");
    assert!(ends(&mut launcher, 60.0), "it does not end");
    is_the_same_again(&place, "run");
    assert!(arrivals(&place, "run").iter().any(|line| line.ends_with(" operator 6")), "a stop, by its cycle");
}

#[test]
fn a_run_in_real_time_is_the_same_again() {
    for layout in [&["--processes"][..], &[]] {
        assert!((0..5).any(|_| in_real_time_the_same_again(layout)), "{layout:?}: five records had a gap");
    }
}

/// Whether its record was whole.
fn in_real_time_the_same_again(layout: &[&str]) -> bool {
    let place = Place::new();
    let text = "G18 G21 G90 G8 G94\nG0 X50 Z90\nG1 X49 F600\nG4 P1\nG1 X50 F600\nG4 P90\nM2\n";
    place.write("machine.toml", slow_machine());
    let program = place.write("program.ngc", text);
    let mut command = place.pitchlock();
    command.arg("run").arg(program).args(["--quiet", "--clock", "real", "--out", "run"]).args(layout);
    let mut launcher = command.args(["--machine", "machine.toml"]).spawn().expect("it starts");
    runs(&place);
    // Records that are lost, machine code that is not there, frames and commands that are late: then the
    // operator ends it. Whatever came of it is the same again.
    if !layout.is_empty() {
        signal(launcher.id(), "STOP");
        wait_s(stopped_s(5.0));
        signal(launcher.id(), "CONT");
        wait_s(0.5);
    }
    let regulator = if layout.is_empty() { "real-time" } else { "regulator-z" };
    for (name, s) in [("interpreter", 0.1), ("interpolator", 0.006), (regulator, 0.01)] {
        let child = children(&launcher).into_iter().find(|(child, _)| child == name);
        if let Some((_, pid)) = child {
            signal(pid, "STOP");
            wait_s(s);
            signal(pid, "CONT");
        }
        wait_s(0.3);
    }
    signal(launcher.id(), "INT");
    assert!(ends(&mut launcher, 60.0), "it does not end");
    // A record with a gap, as on a computer with too much to do, is refused and not made again otherwise.
    let answer = place.ask(&["replay", "run"]);
    if answer.status == Some(2) && answer.stderr.contains("has a gap") {
        assert_eq!(answer.stdout, "");
        return false;
    }
    is_the_same_again(&place, "run");
    let told = arrivals(&place, "run");
    assert!(!told.is_empty(), "a regulator that stood for two cycles was late");
    // What the recorder missed is counted, cycle by cycle.
    let cycle =
        |line: &String| line.split(' ').next().and_then(|cycle| cycle.parse::<u64>().ok()).unwrap_or(0);
    let moments: Vec<u64> = told.iter().filter(|line| line.contains(" truth ")).map(cycle).collect();
    let missed: u64 = moments.chunks(2).map(|gap| gap[1] - gap[0]).sum();
    let summary = Summary::read(&place.at("run/summary.json")).expect("a run leaves a summary");
    let truth = summary.channels.iter().find(|channel| channel.name == "truth").expect("it is counted");
    assert_eq!(missed, truth.lost, "{told:?}");
    let until = std::fs::read_to_string(place.at("run/arrivals.txt")).expect("it is there");
    assert!(
        until.contains(&format!("\nuntil {}\n", summary.cycles + missed)),
        "every cycle is there or counted"
    );
    true
}

#[test]
fn a_run_that_is_another_one_is_told_where_and_one_without_its_record_is_refused() {
    let place = Place::new();
    let program = place.write("program.ngc", THREAD);
    let arguments = ["--in-process", "--out", "run"];
    place.ask(&[&["run", &program.display().to_string(), "--quiet"], &arguments[..]].concat());
    is_the_same_again(&place, "run");
    // A file that was changed is named, even where it makes no difference.
    let kept = place.at("run/machine.toml");
    let machine = std::fs::read_to_string(&kept).expect("it is there");
    std::fs::write(&kept, format!("{machine}# seen by somebody\n")).expect("room");
    let answer = place.ask(&["replay", "run"]);
    assert_eq!(answer.status, Some(0), "{}", answer.stderr);
    assert_eq!(answer.stderr, "note: machine.toml is not what it was when the run was made\n");
    std::fs::write(&kept, machine).expect("room");
    let path = place.at("run/summary.json");
    let summary = std::fs::read_to_string(&path).expect("it is there");
    std::fs::write(&path, summary.replace("\"seed\": 1,", "\"seed\": 2,")).expect("room");
    let other = place.ask(&["replay", "run"]);
    assert_eq!(other.status, Some(1), "{}{}", other.stdout, other.stderr);
    assert!(
        other.stdout.contains("NOT the same") && other.stdout.contains("first in cycle 0, sim-plant, "),
        "{}",
        other.stdout
    );
    let path = place.at("run/arrivals.txt");
    let text = std::fs::read_to_string(&path).expect("it is there");
    let refused = |text: Option<String>, words: &str| {
        text.map_or_else(|| std::fs::remove_file(&path), |text| std::fs::write(&path, text))
            .expect("it is ours");
        let answer = place.ask(&["replay", "run"]);
        assert!(answer.status == Some(2) && answer.stderr.contains(words), "{words}: {}", answer.stderr);
    };
    refused(
        Some(format!("{text}incomplete 3 of what interpolator told\n")),
        "has a gap: 3 of what interpolator told",
    );
    refused(Some(format!("{text}12 drive-command/q due\n")), "line 6");
    let end = text.rfind("end ").expect("it says where it ends");
    refused(Some(text[..end].into()), "arrivals.txt is torn behind control cycle 0");
    refused(Some(text.replacen("until ", "until 1", 1)), "behind line 1, from control cycle 0 on");
    refused(None, "what reached its modules and when");
}

/// What a program switches is in the documents of `replay` and `diff`.
#[test]
fn outputs_are_in_the_documents() {
    let place = Place::new();
    let machine = format!("{}\n[outputs.3]\nname = \"chip conveyor\"\n", machine::SMALL_LATHE);
    place.write("lathe.toml", &machine);
    let program = place.write("program.ngc", "G21 G90 G94\nM64 P3\nG0 X50 Z90\nM65 P3\nM2\n");
    run(&place, &program, "one", &["--in-process", "--machine", "lathe.toml"]);
    let switched = |outputs: &serde_json::Value| -> Vec<(u64, bool)> {
        let all = outputs.as_array().expect("a list");
        let one = |output: &serde_json::Value| Some((output["number"].as_u64()?, output["on"].as_bool()?));
        all.iter().map(|output| one(output).expect("a change")).collect()
    };
    for (arguments, path) in
        [(&["replay", "one", "--json"][..], "/again"), (&["diff", "one", "one", "--json"], "/runs/1")]
    {
        let answer = place.ask(arguments);
        assert_eq!(answer.status, Some(0), "{arguments:?}: {}", answer.stderr);
        let document: serde_json::Value = serde_json::from_str(&answer.stdout).expect("a document");
        let outputs = document.pointer(path).map(|made| &made["outputs"]).expect("a run");
        assert_eq!(switched(outputs), [(3, true), (3, false)], "{document}");
    }
}

#[test]
fn two_runs_are_compared_message_by_message() {
    let place = Place::new();
    let program = place.write("program.ngc", THREAD);
    let scenario = "[[event]]\nat = { cycle = 3000 }\nspindle_override_pct = 90.0\n";
    place.write("scenario.toml", scenario);
    run(&place, &program, "one", &["--in-process"]);
    run(&place, &program, "two", &[]);
    run(&place, &program, "slower", &["--in-process", "--scenario", "scenario.toml"]);
    let same = place.ask(&["diff", "one", "two"]);
    assert_eq!(same.status, Some(0), "{}{}", same.stdout, same.stderr);
    assert!(!place.at("diff.html").exists(), "nothing to draw");
    let other = place.ask(&["diff", "one", "slower", "-o", "other.html"]);
    assert_eq!(other.status, Some(1), "{}", other.stderr);
    let words = "first in cycle 3000 (1.5000 s), sim-plant, truth: measurement.panel.spindle_override_pct\n  one: 100.0 %\n  slower: 90.0 %";
    assert!(other.stdout.contains(words), "{}", other.stdout);
    let page = std::fs::read_to_string(place.at("other.html")).expect("it was drawn");
    assert!(page.contains("<td>90.0 %</td>") && page.contains(r#""text":"%""#), "units in the page");
    assert!(other.stdout.contains("that differ: scenario"), "{}", other.stdout);
    let document = |arguments: &[&str], status| -> serde_json::Value {
        let answer = place.ask(arguments);
        assert_eq!(answer.status, Some(status), "{arguments:?}: {}", answer.stderr);
        serde_json::from_str(&answer.stdout).expect("one document and nothing else")
    };
    let differ = document(&["diff", "one", "slower", "--json"], 1);
    assert_eq!((&differ["equal"], &differ["first"]["cycle"]), (&false.into(), &3000.into()));
    assert_eq!(differ["first"]["module"], "sim-plant");
    assert_eq!(differ["inputs_that_differ"], serde_json::json!(["scenario"]));
    assert!(!place.at("diff.html").exists(), "JSON draws nothing");
    let equal = document(&["diff", "one", "two", "--json"], 0);
    assert_eq!((&equal["equal"], &equal["first"]), (&true.into(), &serde_json::Value::Null));
    let again = document(&["replay", "slower", "--json"], 0);
    assert_eq!((&again["equal"], &again["first"]), (&true.into(), &serde_json::Value::Null));
    assert_eq!(again["recorded"]["trace_hash"], again["again"]["trace_hash"]);
    let page: PathBuf = place.at("other.html");
    let page = std::fs::read_to_string(page).expect("it is drawn");
    assert!(
        page.contains("<title>pitchlock: ") && page.contains("spindle_override_pct"),
        "it shows the field"
    );
    let refused = place.ask(&["diff", "one", "slower", "-o", "program.ngc"]);
    assert!(refused.status == Some(2) && refused.stderr.contains("is there already"), "{}", refused.stderr);
}
