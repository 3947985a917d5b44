//! What a launcher does to a process that it has started, and what it sees of it from outside.

use protocol::Doom;
use rustix::process::{Pid, Signal, kill_process};

/// Kills, stops or continues a process.
///
/// # Errors
/// What the operating system says, for instance that there is no such process.
pub fn doom(pid: u32, doom: Doom) -> std::io::Result<()> {
    let signal = match doom {
        Doom::Kill => Signal::KILL,
        Doom::Freeze => Signal::STOP,
        Doom::Thaw => Signal::CONT,
    };
    let pid = i32::try_from(pid).ok().and_then(Pid::from_raw).ok_or(std::io::ErrorKind::InvalidInput)?;
    Ok(kill_process(pid, signal)?)
}

/// A field of what the operating system says of a process, by its number in proc_pid_stat(5), from 3 on.
fn field(pid: u32, number: usize) -> Option<String> {
    let text = std::fs::read_to_string(format!("/proc/{pid}/stat")).ok()?;
    // The name before them may hold anything.
    text.rsplit_once(')')?.1.split_whitespace().nth(number - 3).map(String::from)
}

fn number(pid: u32, field: usize) -> Option<u64> {
    self::field(pid, field)?.parse().ok()
}

/// Time for which a process has used a processor so far, in the ticks of the operating system.
pub fn used(pid: u32) -> Option<u64> {
    Some(number(pid, 14)? + number(pid, 15)?)
}

/// Pages that a process had to wait for so far, because they were on a disk.
pub fn waited_for_pages(pid: u32) -> Option<u64> {
    number(pid, 12)
}

/// Whether a process waits for a device, such as a disk: no signal ends it before that answers.
pub fn waits_for_device(pid: u32) -> bool {
    field(pid, 3).as_deref() == Some("D")
}

/// Whether a process is stopped by a signal, or by a debugger.
pub fn is_stopped(pid: u32) -> bool {
    matches!(field(pid, 3).as_deref(), Some("T" | "t"))
}

/// Signals that end a process: number, name, what they are in words.
const SIGNALS: [(i32, &str, &str); 14] = [
    (1, "SIGHUP", "its terminal was closed"),
    (2, "SIGINT", "it was interrupted"),
    (3, "SIGQUIT", "it was told to quit"),
    (4, "SIGILL", "an instruction that this processor does not have"),
    (6, "SIGABRT", "it gave up by itself"),
    (7, "SIGBUS", "memory that is not there: a full /dev/shm, or a file that became shorter"),
    (8, "SIGFPE", "a calculation that has no result"),
    (9, "SIGKILL", "somebody killed it, or the system because memory ran out (`dmesg` says so)"),
    (11, "SIGSEGV", "it touched memory that is not its own"),
    (13, "SIGPIPE", "nobody reads what it writes"),
    (15, "SIGTERM", "somebody ended it"),
    (24, "SIGXCPU", "its time on the processor is used up (`ulimit -t`)"),
    (25, "SIGXFSZ", "a file became longer than it may (`ulimit -f`)"),
    (31, "SIGSYS", "a system call that is not allowed here"),
];

/// Name of a signal that ends a process.
pub fn signal_name(number: i32) -> String {
    let known = SIGNALS.iter().find(|(known, ..)| *known == number);
    known.map_or_else(|| format!("signal {number}"), |(_, name, _)| (*name).into())
}

/// The same with what it is in words.
pub fn signal_words(number: i32) -> String {
    let known = SIGNALS.iter().find(|(known, ..)| *known == number);
    known.map_or_else(|| format!("signal {number}"), |(_, name, words)| format!("{name} ({words})"))
}
