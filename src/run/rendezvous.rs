//! The start of a machine as processes: everybody has connected all ports, or it is said who has not. In: the
//! name space, processes that were started. Out: nothing, or why the machine does not start.

use process::{
    ipc::{NameSpace, Process, child::is_stopped, time::Moment},
    shell::START_S,
};

use super::{
    channels::Channels,
    children::Started,
    interrupts::{Interrupts, Wish},
    watchdog::Watchdog,
};
use crate::error::CliError;

/// Waits until every process has connected all its ports.
pub(super) fn rendezvous(
    space: &mut NameSpace,
    channels: &Channels,
    started: &mut [Started],
    interrupts: &mut Interrupts,
    watchdog_s: f64,
) -> Result<(), CliError> {
    let deadline = Moment::in_s(START_S);
    let (mut stopped, mut looked) = (Watchdog::new(watchdog_s), Moment::now());
    loop {
        let missing = space.missing(&channels.ports())?;
        if missing.is_empty() {
            return Ok(());
        }
        if looked.passed() {
            looked = Moment::in_s(0.1);
            match started.iter().find(|one| is_stopped(one.pid())) {
                None => stopped.calm(),
                Some(one) if stopped.is_over() => {
                    let text = "is stopped, and did not answer while the machine was starting";
                    return Err(CliError::Machine(format!("{} {text}", one.host.name)));
                }
                Some(_) => {}
            }
        }
        for one in started.iter_mut() {
            if one.has_ended()? {
                return Err(CliError::Machine(format!(
                    "while the machine was starting, {} {}",
                    one.host.name,
                    one.ending()
                )));
            }
        }
        if interrupts.wish() != Wish::None {
            return Err(CliError::Machine("interrupted while the machine was starting".into()));
        }
        if deadline.passed() {
            let names: Vec<_> = missing.into_iter().map(Process::name).collect();
            return Err(CliError::Machine(format!(
                "{} did not connect within {START_S} s; run `pitchlock doctor`",
                names.join(", ")
            )));
        }
        process::ipc::time::sleep_until(Moment::in_s(0.001));
    }
}
