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

/// Time for which a process has used a processor so far, in the ticks of the operating system.
pub fn used(pid: u32) -> Option<u64> {
    let text = std::fs::read_to_string(format!("/proc/{pid}/stat")).ok()?;
    // Behind the name, which may hold anything: the state is field 3, these are 14 and 15.
    let fields = text.rsplit_once(')')?.1;
    let ticks = |field: usize| fields.split_whitespace().nth(field - 3)?.parse::<u64>().ok();
    Some(ticks(14)? + ticks(15)?)
}

/// Whether a process is stopped by a signal, or by a debugger.
pub fn is_stopped(pid: u32) -> bool {
    let text = std::fs::read_to_string(format!("/proc/{pid}/stat")).unwrap_or_default();
    let state = text.rsplit_once(')').and_then(|(_, fields)| fields.split_whitespace().next());
    matches!(state, Some("T" | "t"))
}

/// Name of a signal that ends a process.
pub fn signal_name(number: i32) -> String {
    let name = match number {
        1 => "SIGHUP",
        2 => "SIGINT",
        3 => "SIGQUIT",
        4 => "SIGILL",
        6 => "SIGABRT",
        7 => "SIGBUS",
        8 => "SIGFPE",
        9 => "SIGKILL",
        11 => "SIGSEGV",
        13 => "SIGPIPE",
        15 => "SIGTERM",
        24 => "SIGXCPU",
        25 => "SIGXFSZ",
        31 => "SIGSYS",
        other => return format!("signal {other}"),
    };
    name.into()
}
