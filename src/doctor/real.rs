//! `pitchlock doctor --real`: whether this computer can run the machine in real time. In: for how long. The
//! machine's own processes run, and nothing is asked of them: the drives are on, the axes rest. Out: how late
//! they woke, what that is worth, and what would help.

use std::{
    collections::BTreeMap,
    fmt::Write as _,
    fs,
    path::Path,
    process::{Command, ExitCode, Stdio},
};

use machine::Machine;
use process::ipc::channel;
use rig::observe::{Outcome, RealTimeReport, Summary, Times};
use serde_json::json;

use super::{
    DoctorArgs,
    checks::{Check, checks},
};
use crate::{
    error::CliError,
    run::{axes, interrupts::Interrupts},
    screen,
    temporary::Temporary,
};

/// What LinuxCNC says of the latest wake-up in its latency test, µs: what may be expected up to there.
const CLASSES: [(u64, &str); 4] = [
    (20, "very good, also for steps made in software"),
    (50, "good; steps made in software have a lower rate"),
    (1000, "steps have to be made by hardware"),
    (u64::MAX, "no candidate for LinuxCNC"),
];
/// Share of a cycle that 99 of 100 wake-ups may be late.
const BUDGET: f64 = 0.25;
/// A run counts for so long at least, s.
const SHORTEST_S: f64 = 0.05;

/// What was measured, of all runs together.
#[derive(Debug, Default)]
struct Measured {
    /// How many wake-ups were so late, µs, by the least of their bucket.
    buckets: BTreeMap<u64, u64>,
    most_us: u64,
    late_answers: u64,
    /// How often the machine stopped because three answers in a row were late.
    stopped: u64,
    /// What its processes were granted, and what not.
    granted: Vec<Check>,
    /// For how long the machine ran, s; somebody did not let it run to the end.
    ran_s: f64,
    broken_off: bool,
}

impl Measured {
    fn take(&mut self, summary: &Summary) {
        self.late_answers += summary.deadline_misses;
        self.stopped += u64::from(summary.outcome == Outcome::Faulted);
        for RealTimeReport { process, wake_up, set_up, .. } in &summary.real_time {
            let Some(Times { buckets, most_us, .. }) = wake_up else { continue };
            self.most_us = self.most_us.max(*most_us);
            buckets.iter().for_each(|(us, count)| *self.buckets.entry(*us).or_default() += count);
            let granted = set_up.iter().map(|item| {
                let (name, found) = (format!("{process}: {}", item.what), item.text.clone());
                Check { name, ok: item.done, found, remedy: "docs/real-time.md#what-is-set-up".into() }
            });
            self.granted = granted.collect();
        }
    }

    fn wake_ups(&self) -> u64 {
        self.buckets.values().sum()
    }

    /// So late were a share of the wake-ups at most, µs: the end of their bucket, a sixteenth of it wide.
    fn share_us(&self, per_cent: u64) -> u64 {
        let rank = (self.wake_ups() * per_cent).div_ceil(100);
        let mut below = 0;
        let found = self.buckets.iter().find(|(_, count)| {
            below += **count;
            below >= rank
        });
        found.map_or(0, |(us, _)| us + (1 << us.max(&16).ilog2() >> 4) - 1).min(self.most_us)
    }

    /// Whether a machine with such a cycle, µs, can be run. Too little of what was broken off is known.
    fn is_fit(&self, cycle_us: f64) -> bool {
        !self.broken_off
            && self.wake_ups() > 0
            && self.stopped == 0
            && self.share_us(99) as f64 <= BUDGET * cycle_us
    }
}

/// Measures for so long, and says what came of it.
pub(super) fn real(args: &DoctorArgs, seconds: f64) -> Result<ExitCode, CliError> {
    let (machine, text) = args.machine.read()?;
    let measured = measure(&text, seconds)?;
    let mut all = checks(Path::new("/"), channel::shared_bytes(&axes(&machine)));
    all.extend(measured.granted.iter().cloned());
    let fit = measured.is_fit(machine.general.cycle_s * 1e6);
    if args.json {
        let [p50, p99] = [50, 99].map(|per_cent| measured.share_us(per_cent));
        let document = json!({
            "fit": fit,
            "wakeups_us": { "p50": p50, "p99": p99, "max": measured.most_us },
            "wakeups": measured.wake_ups(),
            "late_answers": measured.late_answers,
            "stopped": measured.stopped,
            "ran_s": measured.ran_s,
            "broken_off": measured.broken_off,
            "checks": all,
        });
        screen::print(&format!("{document:#}\n"));
    } else {
        screen::print(&told(&machine, &measured, &all));
    }
    Ok(if fit { ExitCode::SUCCESS } else { ExitCode::from(1) })
}

/// The same for people.
fn told(machine: &Machine, measured: &Measured, all: &[Check]) -> String {
    let mut text = String::new();
    for Check { name, ok, found, remedy } in all {
        let _ = match ok {
            true => writeln!(text, "ok    {name}: {found}"),
            false => writeln!(text, "note  {name}: {found}; {remedy}"),
        };
    }
    let cycle_us = machine.general.cycle_s * 1e6;
    let [p50, p99] = [50, 99].map(|per_cent| measured.share_us(per_cent));
    let most_us = measured.most_us;
    let _ = writeln!(
        text,
        "{} wake-ups every {cycle_us:.0} µs were late by {p50} µs (median), {p99} µs (99 %), {most_us} µs (worst)",
        measured.wake_ups()
    );
    let class = CLASSES.iter().find(|(us, _)| most_us <= *us).map_or("", |(_, class)| *class);
    let _ = writeln!(text, "by LinuxCNC's classes: {class}");
    let _ = writeln!(
        text,
        "by our budget: 99 of 100 within {:.0} µs, a quarter of a cycle, and never three late answers in a row; {} \
         answers were late, and {} times the machine stopped for it",
        BUDGET * cycle_us,
        measured.late_answers,
        measured.stopped
    );
    let verdict = match (measured.broken_off, measured.is_fit(cycle_us)) {
        (true, _) => "broken off: whether this computer can run the machine in real time is not known",
        (false, true) => "this computer can run the machine in real time",
        (false, false) => "this computer cannot run the machine in real time",
    };
    let _ = writeln!(text, "measured for {:.1} s; {verdict}", measured.ran_s);
    text
}

/// Runs the machine again and again until the time is over: a run that late answers end is a finding, and
/// the next one goes on. Ctrl-C ends it sooner. A process that dies says nothing of the computer.
fn measure(machine: &str, seconds: f64) -> Result<Measured, CliError> {
    let folder = Temporary::new("doctor")?;
    let mut interrupts = Interrupts::catch()?;
    let place = |name: &str| folder.path().join(name);
    let put = |name: &str, text: &str| {
        fs::write(place(name), text)
            .map_err(|error| CliError::Machine(format!("{}: {error}", folder.path().display())))
    };
    put("machine.toml", machine)?;
    let mut measured = Measured::default();
    while seconds - measured.ran_s >= SHORTEST_S && !interrupts.is_wished() {
        put("idle.ngc", &format!("G21\nG4 P{:.3}\nM2\n", seconds - measured.ran_s))?;
        let _ = fs::remove_dir_all(place("run"));
        let said = run(folder.path())?;
        let summary = Summary::read(&place("run/summary.json"))
            .map_err(|_| CliError::Machine(format!("the machine did not start: {}", said.trim())))?;
        if let Some(fault) = summary.faults.iter().find(|fault| fault.code.starts_with("process-")) {
            return Err(CliError::Machine(format!("{}: {}", fault.code, fault.text)));
        }
        measured.take(&summary);
        measured.ran_s += summary.simulated_s.max(SHORTEST_S);
        if summary.outcome != Outcome::Faulted {
            break;
        }
    }
    measured.broken_off = interrupts.is_wished();
    Ok(measured)
}

/// One run of the idle machine; what it said.
fn run(folder: &Path) -> Result<String, CliError> {
    let failed = |error: std::io::Error| CliError::Machine(error.to_string());
    let output = Command::new(std::env::current_exe().map_err(failed)?)
        .current_dir(folder)
        .args(["run", "idle.ngc", "--machine", "machine.toml", "--dialect", "linuxcnc", "--out", "run"])
        .args(["--clock", "real", "--trace", "none", "--unkept", "--quiet"])
        .stdin(Stdio::null())
        .output()
        .map_err(failed)?;
    Ok(String::from_utf8_lossy(&output.stderr).into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn summary(outcome: Outcome, buckets: &[(u64, u64)], most_us: u64) -> Summary {
        let wake_up = Some(Times { buckets: buckets.to_vec(), most_us, ..Times::default() });
        let report = RealTimeReport { process: "real-time".into(), wake_up, ..RealTimeReport::default() };
        Summary { outcome, deadline_misses: 3, real_time: vec![report], ..Summary::default() }
    }

    #[test]
    fn wake_ups_of_several_runs_are_counted_together() {
        let mut measured = Measured::default();
        measured.take(&summary(Outcome::Faulted, &[(5, 60), (128, 1)], 130));
        measured.take(&summary(Outcome::Completed, &[(5, 38), (40, 1)], 41));
        assert_eq!((measured.wake_ups(), measured.late_answers, measured.stopped), (100, 6, 1));
        assert_eq!([50, 98, 99, 100].map(|share| measured.share_us(share)), [5, 5, 41, 130]);
        let mut wide = Measured::default();
        wide.take(&summary(Outcome::Completed, &[(15, 1), (16, 1), (31, 1), (32, 1), (1024, 1)], 5000));
        assert_eq!([20, 40, 60, 80, 100].map(|share| wide.share_us(share)), [15, 16, 31, 33, 1087]);
    }

    #[test]
    fn who_stops_or_wakes_late_too_often_is_not_fit() {
        let measured = |outcome, buckets: &[(u64, u64)]| {
            let mut measured = Measured::default();
            measured.take(&summary(outcome, buckets, 100_000));
            measured.is_fit(500.0)
        };
        assert!(measured(Outcome::Completed, &[(5, 990), (400, 10)]));
        assert!(!measured(Outcome::Completed, &[(5, 989), (400, 11)]));
        assert!(!measured(Outcome::Faulted, &[(5, 1000)]));
        assert!(!measured(Outcome::Completed, &[]));
        let mut broken_off = Measured { broken_off: true, ..Measured::default() };
        broken_off.take(&summary(Outcome::Stopped, &[(5, 1000)], 5));
        assert!(!broken_off.is_fit(500.0));
        let machine = Machine::from_toml(machine::SMALL_LATHE).expect("a machine");
        assert!(told(&machine, &broken_off, &[]).contains("is not known"));
    }

    #[test]
    fn every_latency_has_a_class() {
        assert!(CLASSES.is_sorted_by(|one, other| one.0 < other.0) && CLASSES[3].0 == u64::MAX);
    }
}
