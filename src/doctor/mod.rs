//! `pitchlock doctor`: can this computer run the machine, and what to change if not.

mod checks;
mod real;

use std::{fmt::Write as _, path::Path, process::ExitCode, time::Duration};

use process::ipc::{
    IpcError, NameSpace, computer,
    time::{Moment, be_punctual, lock_memory, processors, sleep_until},
};

use clap::Args;

use crate::{
    args::MachineArgs,
    error::CliError,
    run::{FarArgs, axes, hosts},
    screen,
};

#[derive(Clone, Debug, Args)]
pub(crate) struct DoctorArgs {
    #[command(flatten)]
    pub(crate) machine: MachineArgs,
    /// Run the machine in real time for so long, at rest, and say whether this computer will do: 0.1 to
    /// 100000 s.
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    pub(crate) real: Option<f64>,
    #[command(flatten)]
    pub(crate) far: FarArgs,
    /// With --real: print one JSON document, and nothing else.
    #[arg(long, requires = "real")]
    pub(crate) json: bool,
}

fn seconds(text: &str) -> Result<f64, String> {
    let given = text.parse::<f64>().ok().filter(|seconds| (0.1..=1e5).contains(seconds));
    given.ok_or_else(|| "seconds, 0.1 to 100000".into())
}

/// Wake-ups that are measured.
const WAKE_UPS: usize = 2000;
/// What a run of some minutes leaves in its folder, bytes.
const RUN_BYTES: u64 = 256 << 20;

/// Looks, or with `--real` measures.
pub(crate) fn doctor(args: &DoctorArgs) -> Result<ExitCode, CliError> {
    if let (Some(at), Some(key)) = (&args.far.at, &args.far.key) {
        return hosts::ping(&args.machine, (at, key));
    }
    args.real.map_or_else(|| look(args), |seconds| real::real(args, seconds))
}

/// Tries the name space, files, disks, processors, memory locking, priority and wake-ups, and says what it
/// found.
fn look(args: &DoctorArgs) -> Result<ExitCode, CliError> {
    let (machine, _) = args.machine.read()?;
    let mut text = String::new();
    let begun = Moment::now();
    let space = NameSpace::create(&axes(&machine));
    let can_run = space.is_ok();
    text += &channels(space.map(|_| begun.elapsed()));
    // Whoever cannot have them has been told so above.
    let needed = computer::files(&axes(&machine));
    if computer::allow_files(needed).is_ok() {
        let _ = writeln!(text, "ok    {needed} files may be open at once (ulimit -n)");
    }
    text += &disk();
    let processors = processors().len();
    let needed = 3 + machine.axis.len();
    let _ = if processors >= needed {
        writeln!(text, "ok    {processors} processors for {needed} processes")
    } else {
        writeln!(
            text,
            "note  {processors} processors for {needed} processes: virtual time is fine, real time will miss cycles \
             under load"
        )
    };
    let _ = match lock_memory() {
        Ok(()) => writeln!(text, "ok    memory can be locked"),
        Err(error) => writeln!(text, "note  {error}: real time needs `ulimit -l unlimited`"),
    };
    let _ = match be_punctual() {
        Ok(()) => writeln!(text, "ok    the priority can be raised"),
        Err(error) => writeln!(text, "note  {error}: real time needs `ulimit -e 40`, or `chrt -f 80`"),
    };
    let late = wake_up_lateness_us(machine.general.cycle_s);
    let cycle_us = machine.general.cycle_s * 1e6;
    let verdict = if late[1] < cycle_us / 4.0 { "ok  " } else { "note" };
    let _ = writeln!(
        text,
        "{verdict}  wake-ups every {cycle_us:.0} µs come late by {:.0} µs (median), {:.0} µs (99 %), {:.0} µs (worst of {WAKE_UPS}){}",
        late[0],
        late[1],
        late[2],
        if verdict == "ok  " {
            ""
        } else {
            "; use a kernel with PREEMPT_RT and a real-time priority (chrt -f 80)"
        }
    );
    let _ = writeln!(
        text,
        "{}",
        if can_run {
            "this computer can run the machine in virtual time"
        } else {
            "this computer cannot run the machine"
        }
    );
    screen::print(&text);
    Ok(if can_run { ExitCode::SUCCESS } else { ExitCode::from(1) })
}

/// Whether the channels of a machine could be made, and how long that took.
fn channels(made: Result<Duration, IpcError>) -> String {
    match made {
        Ok(took) => format!(
            "ok    shared memory and channels of a machine: made in {:.0} ms\n",
            took.as_secs_f64() * 1e3
        ),
        Err(error) => format!(
            "FAIL  channels of a machine: {}\n      this user needs a writable /dev/shm and a folder for temporary \
             files (TMPDIR), with room in both\n",
            // That is what is run here.
            error.to_string().trim_end_matches("; run `pitchlock doctor`")
        ),
    }
}

/// Room where run folders are made.
fn disk() -> String {
    match computer::free_bytes(Path::new(".")) {
        None => "note  nobody knows how much room there is for run folders here\n".into(),
        Some(free) if free < RUN_BYTES => format!(
            "note  {} MB are free for run folders here: a long trace takes more; name another folder with --out, or take \
             `--trace none`\n",
            free >> 20
        ),
        Some(free) => format!("ok    {} MB are free for run folders here\n", free >> 20),
    }
}

/// Median, 99th percentile and worst lateness of absolute waits, µs.
fn wake_up_lateness_us(cycle_s: f64) -> [f64; 3] {
    let period = std::time::Duration::from_secs_f64(cycle_s);
    let mut moment = Moment::now();
    let mut late: Vec<f64> = (0..WAKE_UPS)
        .map(|_| {
            moment = moment.after(period);
            sleep_until(moment);
            moment.elapsed().as_secs_f64() * 1e6
        })
        .collect();
    late.sort_by(f64::total_cmp);
    [late[WAKE_UPS / 2], late[WAKE_UPS * 99 / 100], late[WAKE_UPS - 1]]
}
