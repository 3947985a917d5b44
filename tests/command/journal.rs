//! The journal of a run: what is known when all of its processes are killed, when its file is damaged, and
//! when it came to its end.

use serde_json::Value;

use crate::shop::{Place, children, signal, until};

/// What is known of the run in the folder `run`, if anything is.
fn known(place: &Place) -> Option<Value> {
    let answer = place.ask(&["journal", "run", "--json"]);
    (answer.status == Some(0)).then(|| serde_json::from_str(&answer.stdout).expect("one document"))
}

#[test]
fn a_run_that_is_killed_leaves_what_it_knew() {
    let place = Place::new();
    assert_eq!(place.ask(&["journal", "run"]).status, Some(2), "there is no run yet");
    // Far longer than anybody needs to look and to kill it.
    let threads = "G0 Z8\nG76 P2 Z-20 I-1 J0.1 R1 K0.8\n".repeat(40);
    let text = format!("G18 G21 G90 G8\nM3 S600\nG0 X12 Z8\n{threads}M5\nM2\n");
    let mut launcher = place.start(&place.write("threads.ngc", &text));
    let cuts = |known: Value| known["passes"].as_u64() > Some(0) && known["open_pass"].is_u64();
    until("a later pass is being cut", || known(&place).is_some_and(cuts));
    let everybody = children(&launcher).into_iter().map(|(_, pid)| pid).chain([launcher.id()]);
    everybody.for_each(|pid| signal(pid, "KILL"));
    launcher.wait().expect("it was started here");

    let left = known(&place).expect("a start is never refused");
    let number = |field: &str| left[field].as_u64().expect("a number");
    // It may have been killed a moment later, in or behind a later pass.
    assert_eq!(left["end"], "open", "{left}");
    assert!(number("passes") >= 1 && number("pass") >= 2 && number("steps") > 0, "{left}");
    assert!(
        left["spindle"]["indexes"].as_u64() > Some(0) && left["axes"]["z"]["measured"].is_f64(),
        "{left}"
    );
    let told = place.ask(&["journal", "run"]);
    assert!(told.stdout.contains("the run was broken off"), "{}", told.stdout);

    // A torn end and a bit that has turned over cost nothing; a file that is not one is told.
    let path = place.at("run/journal.bin");
    let mut bytes = std::fs::read(&path).expect("it is there");
    let length = bytes.len();
    bytes[length - 700] ^= 4;
    bytes.extend([0x55; 300]);
    std::fs::write(&path, &bytes).expect("room");
    assert_eq!(known(&place).expect("a record is left"), left);
    std::fs::write(&path, vec![0x55; 4096]).expect("room");
    let told = place.ask(&["journal", "run"]);
    assert_eq!(told.status, Some(2));
    assert!(told.stderr.contains("holds no whole record"), "{}", told.stderr);
}

#[test]
fn a_run_that_ended_says_so() {
    let place = Place::new();
    let program = place.write("short.ngc", "G18 G21 G90 G94\nG0 X50 Z90\nG1 X49 F600\nM2\n");
    let summary = place.run(&program, "run", &["--in-process"]);
    let left = known(&place).expect("it is there");
    assert_eq!((&left["end"], left["moves"].as_u64()), (&"completed".into(), Some(summary.moves.count)));
    assert_eq!(left["seed"], 1);
    let told = place.ask(&["journal", "run"]);
    assert!(told.stdout.contains("the program came to its end"), "{}", told.stdout);
}

/// The machine has not started, nothing has moved, and every command says so and what to do.
#[test]
fn a_run_that_was_killed_before_its_machine_started_is_told_as_such() {
    let place = Place::new();
    let program = place.write("short.ngc", "G18 G21 G90 G94\nG0 X50 Z90\nG1 X49 F600\nM2\n");
    place.run(&program, "run", &["--in-process"]);
    // What it leaves when it is killed then: copies, and room for the summary.
    for name in ["summary.json", "journal.bin", "arrivals.txt", "trace.mcap", "report.html"] {
        std::fs::remove_file(place.at("run").join(name)).expect("it is there");
    }
    std::fs::write(place.at("run/summary.json.new"), [0; 4096]).expect("room");
    let told = |words: &[&str]| {
        for command in [
            &["journal", "run"][..],
            &["run", "run"],
            &["run", "run", "--resume"],
            &["replay", "run"],
            &["diff", "run", "run"],
            &["report", "run"],
            &["panel", "run"],
        ] {
            let answer = place.ask(command);
            assert_eq!(answer.status, Some(2), "{command:?}: {}", answer.stderr);
            for words in words {
                assert!(answer.stderr.contains(words), "{command:?}: {}", answer.stderr);
            }
        }
    };
    told(&["run: this run was broken off before its machine started", "from its beginning"]);
    // Killed a moment later there is a journal, and nothing in it.
    std::fs::write(place.at("run/journal.bin"), []).expect("room");
    let known = place.ask(&["journal", "run"]);
    assert!(known.status == Some(2) && known.stderr.contains("run run --resume`"), "{}", known.stderr);
    let on = place.ask(&["run", "run", "--resume", "--out", "on"]);
    assert_eq!(on.status, Some(0), "{}", on.stderr);
    std::fs::remove_file(place.at("run/journal.bin")).expect("it is there");

    let folder = std::fs::File::open(place.at("run")).expect("a folder");
    folder.try_lock().expect("nobody holds it");
    // --resume says that it goes on.
    let goes_on = place.ask(&["journal", "run"]);
    assert!(goes_on.stderr.contains("about to begin"), "{}", goes_on.stderr);
}
