//! What a process takes that is run to its end: processor time and memory. In: a command. Out: s, MiB.

use std::fs;
use std::process::Command;
use std::time::Duration;

use process::ipc::time::{Moment, sleep_until};

/// The kernel counts times of processes that have ended in steps of 10 ms.
const STEPS_PER_S: f64 = 100.0;

/// Processor time of all processes that were started here and have ended, s: `cutime` and `cstime` of
/// proc(5).
fn spent_s() -> f64 {
    let stat = fs::read_to_string("/proc/self/stat").unwrap();
    let behind_name = stat.rsplit_once(')').unwrap().1;
    let steps = behind_name.split_whitespace().skip(13).take(2).map(|steps| steps.parse::<f64>().unwrap());
    steps.sum::<f64>() / STEPS_PER_S
}

/// Processor time of one run, s.
pub(crate) fn run_s(mut command: Command) -> f64 {
    let before = spent_s();
    let status = command.status().unwrap();
    assert!(status.success(), "{command:?}: {status}");
    spent_s() - before
}

/// Peak of the resident memory of a process that is run to its end, MiB, read while it runs.
pub(crate) fn peak_mib(mut command: Command) -> f64 {
    let mut process = command.spawn().unwrap();
    let file = format!("/proc/{}/status", process.id());
    let mut peak_kib = 0.0_f64;
    while process.try_wait().unwrap().is_none() {
        let status = fs::read_to_string(&file).unwrap_or_default();
        let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:")).unwrap_or_default();
        let kib = line.trim().trim_end_matches(" kB").parse().unwrap_or(0.0);
        peak_kib = peak_kib.max(kib);
        sleep_until(Moment::now().after(Duration::from_millis(5)));
    }
    assert!(process.wait().unwrap().success());
    peak_kib / 1024.0
}
