//! A machine in real time: which processes it has, what becomes of it when one of them stands or dies.
//! Whoever was held up has missed cycles, and each of them is counted and can be made again.

use process::ipc::{Layout, hosts};
use protocol::Axis;
use rig::observe::{Channel, Outcome, Summary};

use crate::endings::{command, ends, pid_of, runs, slow_machine};
use crate::replay::{arrivals, is_the_same_again};
use crate::resume::killed;
use crate::shop::{Answer, Place, alive, name_spaces, shared_memory, signal, wait_s};

/// A control cycle of the slow machine, s.
const CYCLE_S: f64 = 0.004;
const WAITS: &str = "G18 G21 G90 G8 G94\nG0 X50 Z90\nG1 X49 F600\nG4 P90\nM2\n";

fn summary(place: &Place) -> Summary {
    Summary::read(&place.at("run/summary.json")).expect("a run leaves a summary")
}

fn channel<'a>(summary: &'a Summary, name: &str) -> &'a Channel {
    summary.channels.iter().find(|channel| channel.name == name).expect("every channel is there")
}

/// Whether cycles of the machine are missing in its record.
fn was_lost(summary: &Summary) -> bool {
    channel(summary, "truth").lost > 0
}

/// How long an input was without what was due, control cycles, and its longest time.
fn missed(place: &Place, input: &str) -> (u64, u64) {
    let lines = arrivals(place, "run");
    let changes = lines.iter().filter_map(|line| {
        let (cycle, rest) = line.split_once(' ')?;
        let (of, taken) = rest.split_once(' ')?;
        (of == input).then(|| (cycle.parse::<u64>().ok(), taken == "due"))
    });
    let (mut since, mut all, mut most) = (None, 0, 0);
    for (cycle, due) in changes {
        let cycle = cycle.expect("a cycle");
        match (since, due) {
            (Some(begun), true) => (since, all, most) = (None, all + cycle - begun, most.max(cycle - begun)),
            (None, false) => since = Some(cycle),
            _ => {}
        }
    }
    (all, most)
}

/// The process of plant and regulators is stopped for 10 to 50 ms: so many measurements has nobody seen, so
/// many answers are late, from the third on the axes leave what they do, and all of it is the same again.
#[test]
fn a_process_that_stood_has_missed_the_cycles_that_have_ended_meanwhile() {
    for stands in [2.5, 4.5, 12.5] {
        stood_for(stands);
    }
}

/// For so many cycles.
fn stood_for(stands: f64) {
    let place = Place::new();
    let mut launcher =
        command(&place, WAITS, &slow_machine()).args(["--clock", "real"]).spawn().expect("it starts");
    runs(&place);
    let real_time = pid_of(&launcher, "real-time");
    signal(real_time, "STOP");
    wait_s(stands * CYCLE_S);
    signal(real_time, "CONT");
    wait_s(0.2);
    signal(launcher.id(), "INT");
    assert!(ends(&mut launcher, 60.0), "it does not end");
    let summary = summary(&place);
    let (unseen, in_row) = missed(&place, "measurement/x");
    assert!(in_row as f64 + 1.5 >= stands && unseen >= in_row, "{unseen} {in_row}");
    for axis in ["x", "z"] {
        let counted = channel(&summary, &format!("drive-command/{axis}"));
        assert_eq!(missed(&place, &format!("measurement/{axis}")), (unseen, in_row), "one process, one time");
        // An answer that was not made when the process stood is late, and so may that be which was being
        // made.
        let (late, most) = missed(&place, &format!("drive-command/{axis}"));
        assert_eq!((counted.late, counted.late_in_row), (late, most));
        assert!((in_row..=in_row + 1).contains(&most) && late >= unseen, "{late} {most}, unseen {unseen}");
    }
    assert_eq!(summary.deadline_misses, 2 * channel(&summary, "drive-command/x").late);
    // The ledger of that process has the same: it names the cycle, and how many it has missed behind it.
    let ledger = summary.real_time.iter().find(|one| one.process == "real-time").expect("it has told");
    let stood = ledger.late.iter().max_by_key(|late| late.missed).expect("it was late");
    assert!(ledger.late_in_all > 8 || stood.missed == in_row, "{} {in_row}", stood.missed);
    let (woke_us, _) = *stood.before_us.last().expect("the cycle itself");
    assert!(woke_us >= stood.missed * 4000 && stood.before_us.len() <= 64, "{stood:?}");
    let times = [ledger.wake_up.as_ref(), ledger.answer.as_ref()].map(|times| times.expect("they are timed"));
    // Every cycle was timed but for those that were missed.
    assert!(
        times.iter().all(|times| times.count + unseen == summary.cycles || was_lost(&summary)),
        "{times:?} {unseen}"
    );
    let frames =
        summary.real_time.iter().find_map(|one| one.frame.as_ref()).expect("the interpolator has told");
    assert!(frames.count > 0 && frames.median_us <= frames.p99_us && frames.p99_us <= frames.most_us);
    let told = |code: &str| summary.faults.iter().any(|fault| fault.code == code);
    let most = missed(&place, "drive-command/x").1.max(in_row);
    assert!(most <= 2 || told("late-answers") || told("measurement-gap"), "{:?}", summary.faults);
    assert!(most > 2 || !told("late-answers"), "{most}: {:?}", summary.faults);
    is_the_same_again(&place, "run");
}

/// Somebody is killed or frozen in cycle 250, which is a second behind the start. A computer that holds the
/// machine up so long that it has ended before is given another try.
fn felled(place: &Place, what: &str, more: &[&str]) -> Summary {
    for _ in 0..10 {
        let summary = run_and_felled(place, what, more);
        if summary.cycles > 250 || summary.processes.iter().any(|process| process.exit != Some(0)) {
            return summary;
        }
        eprintln!("{what} {more:?}: it had ended before: {:?}", summary.faults);
    }
    panic!("{what} {more:?}: this computer ends every run within a second");
}

fn run_and_felled(place: &Place, what: &str, more: &[&str]) -> Summary {
    let mut command = command(place, WAITS, &slow_machine());
    command.args(["--clock", "real", "--watchdog-s", "2", "--trace", "none", "--fell", what]).args(more);
    let mut launcher = command.spawn().expect("it starts");
    assert!(ends(&mut launcher, 60.0), "{what} {more:?}: it does not end");
    let ids = name_spaces(place).into_iter().collect();
    assert_eq!(
        (name_spaces(place), shared_memory(place, &ids), alive(place)),
        (vec![], vec![], false),
        "{what}"
    );
    summary(place)
}

/// Whoever of those in one process is meant, the process dies, is named with all who lived in it, and nobody
/// else dies.
#[test]
fn in_real_time_the_dead_are_named_in_both_layouts() {
    let place = Place::new();
    let axes = [Axis::X, Axis::Z];
    for (what, more, name, code) in [
        ("regulator-z:kill@250", &[][..], "real-time", "process-died"),
        ("sim-plant:freeze@250", &[], "real-time", "process-frozen"),
        ("interpolator:kill@250", &[], "interpolator", "process-died"),
        ("regulator-z:kill@250", &["--processes"], "regulator-z", "process-died"),
    ] {
        let summary = felled(&place, what, more);
        let case = format!("{what} {more:?}: {:?} {:?}", summary.faults, summary.processes);
        let layout = if more.is_empty() { Layout::Together } else { Layout::Apart };
        let hosts = hosts(layout, &axes);
        let names: Vec<_> = summary.processes.iter().map(|process| process.name.as_str()).collect();
        assert!(hosts.iter().map(|host| host.name.as_str()).eq(names), "{case}");
        assert_eq!(summary.outcome, Outcome::Faulted, "{case}");
        let death = summary.faults.iter().find(|fault| fault.code == code);
        let death = death.unwrap_or_else(|| panic!("{case}"));
        assert_eq!(death.source, name, "{case}");
        let dead = hosts.iter().find(|host| host.name == name).expect("it is one");
        if let Some(whom) = dead.of_whom().filter(|_| code == "process-died") {
            assert!(death.text.contains(&whom), "{case}");
        }
        for process in &summary.processes {
            let killed = process.signal.as_deref() == Some("SIGKILL");
            assert_eq!(
                (killed, process.exit == Some(0)),
                (process.name == name, process.name != name),
                "{case}"
            );
        }
        let gone: Vec<String> = dead.modules.iter().map(|module| module.name()).collect();
        assert_eq!(channel(&summary, "arrival").not_counted.len(), gone.len(), "{case}");
        assert!(channel(&summary, "arrival").not_counted.iter().all(|one| gone.contains(one)), "{case}");
    }
}

/// What each process with a deadline needs of the computer is told, done or refused with what helps; and who
/// wants all of it starts nothing where something is refused.
#[test]
fn what_real_time_needs_is_told_and_a_strict_one_does_not_start_without_it() {
    let place = Place::new();
    let short = "G18 G21 G90 G8 G94\nG0 X50 Z90\nM2\n";
    let mut launcher =
        command(&place, short, &slow_machine()).args(["--clock", "real"]).spawn().expect("it starts");
    assert!(ends(&mut launcher, 60.0), "it does not end");
    let told = summary(&place).real_time;
    let whose: Vec<_> = told.iter().map(|one| one.process.as_str()).collect();
    assert_eq!(whose, ["interpolator", "real-time"]);
    let items =
        ["memory", "stack and heap", "processor states", "isolated processor", "priority", "throttling"];
    for process in &told {
        let named: Vec<_> = process.set_up.iter().map(|item| item.what.as_str()).collect();
        assert_eq!(named, items, "{}", process.process);
        let helps = process.set_up.iter().all(|item| item.done || item.text.len() > 20);
        assert!(helps, "{process:?}");
    }
    // The one that beats the time stands above the other.
    let fifo = |of: usize| told[of].set_up[4].text.strip_prefix("SCHED_FIFO ")?.parse::<u32>().ok();
    assert!(fifo(0).zip(fifo(1)).is_none_or(|(below, above)| below < above), "{told:?}");
    let refused: Vec<_> = told[1].set_up.iter().filter(|item| !item.done).collect();
    let mut strict = command(&place, short, &slow_machine());
    let answer = Answer::from(strict.args(["--clock", "real=strict"]).output().expect("it starts"));
    if refused.is_empty() {
        return assert_eq!(answer.status, Some(0), "{}", answer.stderr);
    }
    assert_eq!(answer.status, Some(1), "{}", answer.stderr);
    assert!(!place.at("run/summary.json").exists(), "nothing has run");
    assert!(answer.stderr.contains("nothing has moved"), "{}", answer.stderr);
    for item in refused {
        assert!(answer.stderr.contains(&item.what), "{}: {}", item.what, answer.stderr);
    }
}

/// In real time the machine of a run that came to rest by itself is made again by its record; that of one
/// whose processes were all killed is not, whose record has no end.
#[test]
fn a_run_in_real_time_is_gone_on_with_unless_it_was_killed() {
    let place = Place::new();
    place.write("machine.toml", slow_machine());
    let text = "G18 G21 G90 G94\nG0 X50 Z90\nG1 X49 F600\nG4 P60\nG1 X48\nM2\n";
    let program = place.write("program.ngc", text).display().to_string();
    place.write("abort.toml", "[[event]]\nat = { time_s = 2.5 }\nabort = true\n");
    let real = ["--clock", "real", "--machine", "machine.toml", "--scenario", "abort.toml"];
    let attempt = || {
        place.clear("run");
        let run = [&["run", &program, "--out", "run", "--quiet", "--trace", "none"][..], &real].concat();
        let broken = place.ask(&run);
        assert_eq!(broken.status, Some(1), "{}", broken.stderr);
        place.clear("on");
        let on = place.ask(&["run", "run", "--resume", "--out", "on", "--trace", "none"]);
        // On a computer with too much to do the launcher misses a part of the record.
        let has_gap = on.status == Some(2) && on.stderr.contains("has a gap");
        assert!(has_gap || on.status == Some(0), "{}", on.stderr);
        !has_gap
    };
    assert!((0..5).any(|_| attempt()), "five records had a gap");
    let on = Summary::read(&place.at("on/summary.json")).expect("it has one");
    assert_eq!(
        (on.outcome, &on.clock[..], on.resumed.map(|on| on.line)),
        (Outcome::Completed, "virtual", Some(3))
    );
    is_the_same_again(&place, "on");
    assert!(killed(&place, 300, &[&real[..4], &[&program]].concat()), "it is killed in its dwell");
    let answer = place.ask(&["run", "run", "--resume", "--out", "never"]);
    assert!(answer.status == Some(2) && answer.stderr.contains("ran in real time"), "{}", answer.stderr);
}

/// The machine's own processes run for two seconds. Whether this computer will do, nobody here can know; but
/// what is told hangs together, and nothing is left behind.
#[test]
fn the_doctor_runs_the_machine_and_says_whether_this_computer_will_do() {
    let place = Place::new();
    let answer = place.ask(&["doctor", "--real", "2", "--json"]);
    let told: serde_json::Value = serde_json::from_str(&answer.stdout).expect("one document");
    let number = |value: &serde_json::Value| value.as_u64().expect("a number");
    let [p50, p99, max] = ["p50", "p99", "max"].map(|name| number(&told["wakeups_us"][name]));
    assert!(p50 <= p99 && p99 <= max && number(&told["wakeups"]) > 100, "{told:#}");
    assert!(told["broken_off"] == false && told["ran_s"].as_f64().is_some_and(|ran| ran > 1.9), "{told:#}");
    // A quarter of 0.5 ms.
    let fit = number(&told["stopped"]) == 0 && p99 <= 125;
    assert_eq!((told["fit"].as_bool(), answer.status), (Some(fit), Some(i32::from(!fit))), "{told:#}");
    let checks = told["checks"].as_array().expect("checks");
    let says =
        |check: &serde_json::Value, what: &str| check[what].as_str().is_some_and(|text| !text.is_empty());
    assert!(
        checks.iter().all(|check| says(check, "name") && says(check, "remedy") && check["ok"].is_boolean())
    );
    for name in ["kernel", "hypervisor", "limit of locked memory", "real-time: priority"] {
        assert!(checks.iter().any(|check| check["name"] == name), "{name}: {told:#}");
    }
    assert_eq!((name_spaces(&place), alive(&place)), (vec![], false));
    for wrong in [&["doctor", "--real", "0"][..], &["doctor", "--json"], &["doctor", "--real", "NaN"]] {
        assert_eq!(place.ask(wrong).status, Some(2), "{wrong:?}");
    }
}
