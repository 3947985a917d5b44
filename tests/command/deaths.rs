//! Processes that are killed at any moment: the machine comes to rest, says who died, leaves nothing behind,
//! and the next start works.

use std::{collections::BTreeSet, path::Path};

use crate::shop::{
    Answer, Place, alive, children, example, name_spaces, shared_memory, signal, until, wait_s,
};
use rig::observe::{Outcome, Summary};

const KILLS: u32 = 20;

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
    let short = place.write("short.ngc", "G18 G21 G90 G94\nG0 X50 Z90\nG1 X49 F600\nM2\n");
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

/// Starts a run, kills one of its processes when the machine is under way, and gives the answer.
fn killed(place: &Place, program: &Path, name: &str) -> (Answer, BTreeSet<String>) {
    let launcher = place.start(program);
    until("the machine runs", || place.at("run/trace.mcap").exists());
    wait_s(0.4);
    let ids = name_spaces(place).into_iter().collect();
    let victim = children(&launcher).into_iter().find(|(child, _)| child == name);
    let (_, pid) = victim.unwrap_or_else(|| panic!("{name} does not run: {:?}", children(&launcher)));
    signal(pid, "KILL");
    (Answer::from(launcher.wait_with_output().expect("it was started here")), ids)
}

#[test]
fn whoever_dies_is_named_and_everything_is_wiped() {
    for name in ["regulator-x", "interpolator", "sim-plant", "interpreter", "regulator-z"] {
        let place = Place::new();
        let (answer, ids) = killed(&place, &example("m20x2"), name);
        let summary: Summary = match serde_json::from_str(&answer.stdout) {
            Ok(summary) => summary,
            Err(error) => panic!("{name}: {error}: {} {}", answer.stdout, answer.stderr),
        };
        if name == "interpreter" && summary.outcome == Outcome::Completed {
            continue; // Its work was done: the whole program fits into the queue.
        }
        assert_eq!(answer.status, Some(1), "{name}: {}", answer.stderr);
        assert_eq!(summary.outcome, Outcome::Faulted, "{name}");
        let named = summary.faults.iter().any(|fault| fault.source == name && fault.code == "process-died");
        assert!(named, "{name}: {:?}", summary.faults);
        let exit = summary.processes.iter().find(|process| process.name == name).map(|process| process.exit);
        assert_eq!(exit, Some(None), "{name} was ended by a signal");
        assert!(place.at("run/report.html").exists() && place.at("run/summary.json").exists(), "{name}");
        let left = (name_spaces(&place), shared_memory(&place, &ids), alive(&place));
        assert_eq!(left, (vec![], vec![], false), "{name}");
    }
}

/// Self-contained rule over processes: 50 s on the machine in one pass, its interpolator is killed near the
/// beginning.
#[test]
fn a_pass_is_cut_to_its_end_though_the_interpolator_was_killed() {
    let place = Place::new();
    let text = "G18 G21 G90 G8\nM3 S300\nG0 X20 Z150\nG0 X9\nG33 Z-350 K2\nG0 X20\nG0 Z150\nM5\nM2\n";
    let program = place.write("long.ngc", text);
    let (answer, _) = killed(&place, &program, "interpolator");
    let summary: Summary = serde_json::from_str(&answer.stdout).expect("--json prints the summary");
    assert_eq!((answer.status, summary.outcome), (Some(1), Outcome::Faulted), "{}", answer.stderr);
    assert!(summary.faults.iter().any(|fault| fault.source == "interpolator"), "{:?}", summary.faults);
    assert_eq!(summary.passes.len(), 1, "the kill came too early");
    let pass = &summary.passes[0];
    assert!(pass.complete && pass.same_index && pass.thread_cycles > 90_000, "{pass:#?}");
    assert!(pass.helix_max_abs_um <= 1.5 && pass.x.thread_max_abs_um <= 0.5, "{pass:#?}");
    assert!(summary.cycles < pass.end_cycle + 10_000, "the machine ends after the pass");
}
