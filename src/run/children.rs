//! The processes of a run: how they are started, how they ended.

use std::{
    io::Read as _,
    os::unix::process::{CommandExt as _, ExitStatusExt as _},
    process::{Child, ChildStdin, Command, ExitStatus, Stdio},
};

use process::{
    ipc::{
        Host, Process,
        child::{doom, signal_name, signal_words},
    },
    shell::Clock,
};
use protocol::Doom;
use rig::observe;

use super::{
    Setup,
    hosts::{Heard, LINK},
    interrupts::Wish,
};
use crate::error::CliError;

/// A process of this run. Dropping it ends the process.
pub(crate) struct Started {
    /// Which, and who lives in it.
    pub(crate) host: Host,
    child: Child,
    exit: Option<ExitStatus>,
    /// What it says, if it is the link to another computer in the place of a module.
    link: Option<Heard>,
}

impl Drop for Started {
    fn drop(&mut self) {
        // It may be gone already; then there is nothing to end.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Started {
    /// Starts one process: this program again, under another command, in a process group of its own so that
    /// Ctrl-C reaches the launcher only.
    pub(crate) fn start(setup: &Setup, address: &str, host: Host) -> Result<Started, CliError> {
        let process = host.beats();
        if process == Process::Interpreter
            && let Some(link) = setup.link.take()
        {
            let (child, heard) = link.joins(address, setup.clock)?;
            let host = Host { name: LINK.into(), ..host };
            return Ok(Started { host, child, exit: None, link: Some(heard) });
        }
        let this = std::env::current_exe().map_err(|error| CliError::Machine(error.to_string()))?;
        let mut command = Command::new(this);
        let by_hand = setup.by_hand && process == Process::Interpreter;
        command
            .stdin(if by_hand { Stdio::piped() } else { Stdio::null() })
            // In real time each process with a deadline says in some lines how that was kept.
            .stdout(if setup.clock == Clock::Real { Stdio::piped() } else { Stdio::null() })
            .process_group(0);
        match process {
            Process::Interpreter => {
                command.arg("interpreter").arg(&setup.folder.program).args(setup.folder.language_args());
                if by_hand { command.arg("--by-hand") } else { &mut command }
            }
            Process::Interpolator => command.arg("interpolator"),
            Process::Plant => {
                let alone = host.modules.len() == 1;
                command.arg(if alone { "sim-plant" } else { "real-time" });
                command.arg("--seed").arg(setup.seed.to_string());
                command.arg("--pace").arg(setup.pace.to_string());
                if let Some(scenario) = &setup.folder.scenario {
                    command.arg("--scenario").arg(scenario);
                }
                for fell in &setup.fell {
                    command.arg("--stand-at").arg(fell.cycle.to_string());
                }
                &mut command
            }
            Process::Regulator(axis) => command.arg("regulator").arg("--axis").arg(axis.name()),
            Process::Launcher => unreachable!("the launcher starts the others"),
        };
        command.arg("--address").arg(address).arg("--machine").arg(&setup.folder.machine);
        match setup.clock {
            // In lock step everybody waits for everybody: taking turns on one processor is fastest.
            Clock::Virtual => {
                command.arg("--clock").arg("virtual").arg("--processor").arg(processor().to_string())
            }
            Clock::Real => command.arg("--clock").arg("real"),
        };
        if setup.strict {
            command.arg("--strict-set-up");
        }
        let child = command
            .spawn()
            .map_err(|error| CliError::Machine(format!("cannot start {}: {error}", host.name)))?;
        Ok(Started { host, child, exit: None, link: None })
    }

    /// Where it takes machine code by hand, if it does.
    pub(crate) fn takes_by_hand(&mut self) -> Option<ChildStdin> {
        self.child.stdin.take()
    }

    /// What somebody at the other computer wants; a link that is lost stops the machine: a tool in a thread
    /// leaves it first.
    pub(crate) fn wish(&mut self) -> Wish {
        let is_lost = self.exit.is_some_and(|exit| !exit.success());
        let stops = |link: &mut Heard| link.wish().max(if is_lost { Wish::Stop } else { Wish::None });
        self.link.as_mut().map_or(Wish::None, stops)
    }

    /// Whether it is a link that says nothing any more.
    pub(crate) fn is_dumb(&mut self) -> bool {
        self.lives() && self.link.as_mut().is_some_and(Heard::is_dumb)
    }

    /// A link whose hall asks what the machine does.
    pub(crate) fn looked_at(&mut self) -> Option<&mut Heard> {
        self.link.as_mut().filter(|link| link.is_looked_at())
    }

    /// What the interpreter behind a link has used of a processor, in ticks, and never more than that; `None`
    /// of a process of this computer. Each time it said so it was more than one.
    pub(crate) fn has_computed(&self) -> Option<u64> {
        self.link.as_ref().map(|link| 2 * link.computed())
    }

    /// Number of the process.
    pub(crate) fn pid(&self) -> u32 {
        self.child.id()
    }

    /// Whether it has ended since the last look.
    pub(crate) fn has_ended(&mut self) -> Result<bool, CliError> {
        if self.exit.is_some() {
            return Ok(false);
        }
        self.exit = self.child.try_wait().map_err(|error| CliError::Machine(error.to_string()))?;
        Ok(self.exit.is_some())
    }

    /// Whether it runs, as of the last look.
    pub(crate) fn lives(&self) -> bool {
        self.exit.is_none()
    }

    /// Ends it, and waits until it has ended. It may be gone by now; either way its status is collected.
    pub(crate) fn end(&mut self) {
        if self.lives() {
            let _ = self.child.kill();
            self.exit = self.child.wait().ok();
        }
    }

    /// Does something to it. It may have ended meanwhile.
    pub(crate) fn doom(&mut self, how: Doom) {
        match how {
            Doom::Kill => {
                let _ = self.child.kill();
                let _ = self.child.wait();
            }
            Doom::Freeze | Doom::Thaw => {
                let _ = doom(self.child.id(), how);
            }
        }
    }

    /// How it ended, for people.
    pub(crate) fn ending(&self) -> String {
        let signal = self.exit.and_then(|exit| exit.signal());
        if let Some(why) = self.link.as_ref().and_then(Heard::why) {
            return format!("ended: {why}");
        }
        match (self.exit.and_then(|exit| exit.code()), signal) {
            (_, Some(number)) => format!("was ended by {}", signal_words(number)),
            (Some(code), _) => format!("ended with exit status {code}; why is on standard error"),
            (None, None) => "ended".into(),
        }
    }

    /// In real time, what a process with deadlines has said of itself; it has ended.
    pub(crate) fn said(&mut self) -> Option<observe::RealTimeReport> {
        let (mut stdout, mut text) = (self.child.stdout.take()?, String::new());
        // Of one that was killed the last line may be torn.
        let _ = stdout.read_to_string(&mut text);
        let lines = text.lines().filter_map(|line| serde_json::from_str::<serde_json::Value>(line).ok());
        let mut all = serde_json::Map::new();
        lines.for_each(|line| all.extend(line.as_object().cloned().unwrap_or_default()));
        all.insert("process".into(), self.host.name.clone().into());
        let report = serde_json::from_value::<observe::RealTimeReport>(all.into()).ok()?;
        (!report.set_up.is_empty()).then_some(report)
    }

    /// As `summary.json` has it.
    pub(crate) fn report(&self) -> observe::Process {
        let signal = self.exit.and_then(|exit| exit.signal()).map(signal_name);
        let exit = self.exit.and_then(|exit| exit.code());
        observe::Process { name: self.host.name.clone(), pid: self.child.id(), exit, signal }
    }
}

/// The processor for this machine's processes: machines started side by side spread over all there are.
fn processor() -> usize {
    let allowed = process::ipc::time::processors();
    allowed[std::process::id() as usize % allowed.len()]
}
