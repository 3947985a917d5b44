//! The two levels of the control on two computers: the interpreter on host A (`pitchlock run --at`),
//! everything that has deadlines on host B (`pitchlock serve`). In: arguments. Out: the process of the link
//! on either, and what it says. What crosses the wire, and how, only that process knows (`hosts/`).

mod at;
mod file;
mod panel;
mod seen;
mod serve;
mod stand;

use std::{
    io::{BufRead as _, BufReader, Write as _},
    net::Shutdown,
    os::{
        fd::OwnedFd,
        unix::{net::UnixStream, process::CommandExt as _},
    },
    path::Path,
    process::{Child, Command, ExitCode, Stdio},
    sync::mpsc::{Receiver, RecvTimeoutError, channel},
    time::Duration,
};

use process::{
    ipc::time::{Moment, sleep_until},
    link::{Said, Told, Watch},
    shell::Clock,
};

use super::{
    interrupts::{Interrupts, Wish},
    quiet::Quiet,
};
use crate::{args::MachineArgs, error::CliError, words};

pub(crate) use at::run_at;
pub(crate) use panel::panel_at;
pub(crate) use seen::seen;
pub(crate) use serve::{HELP, ServeArgs, serve};

/// Name of the program, and of the process in a summary.
pub(super) const LINK: &str = "pitchlock-link";
/// How long nothing is looked at while the link says nothing.
const NAP: Duration = Duration::from_millis(20);

/// So long a link says nothing, which says twice a second that it lives: on either computer longer than one
/// with other work to do keeps a process waiting.
const DUMB: Duration = Duration::from_secs(5);
/// So long a link may take for its last words.
const LAST_WORDS: Duration = Duration::from_millis(500);

/// A process of the link.
pub(crate) struct Link {
    child: Child,
    heard: Heard,
}

/// What a link says, and what it is told.
pub(crate) struct Heard {
    said: Receiver<Said>,
    ear: UnixStream,
    wish: Wish,
    why: Option<String>,
    /// Somebody in a hall asks what the machine does.
    looked: bool,
    /// How often the interpreter on the other computer said that it computes.
    computed: u64,
    /// For how long nothing was heard.
    dumb: Quiet,
}

/// Who calls whom, and as what.
type Call<'a> = (&'a str, &'a Path);

/// The command that starts the link, as one end of it, with this hash of the machine file.
fn command(end: &str, machine: &str, key: &Path) -> Result<Command, CliError> {
    let mut command = bare(end)?;
    command.arg("--key").arg(key);
    command.arg("--control").arg(env!("CARGO_PKG_VERSION"));
    command.arg("--machine").arg(machine);
    Ok(command)
}

/// Hash of the machine file, by which both computers compare it.
fn compared(machine: &MachineArgs) -> Result<String, CliError> {
    machine.read().map(|(_, text)| rig::hash::hex_of_text(&text))
}

/// The same without what it needs to be let in.
fn bare(end: &str) -> Result<Command, CliError> {
    let wrong = |error: std::io::Error| CliError::Machine(error.to_string());
    let path = std::env::current_exe().map_err(wrong)?.with_file_name(LINK);
    if !path.exists() {
        let text = "is not there: the link to another computer is a program of its own, which lies beside pitchlock\n\
                    help: in the folder of the sources, `cargo install --locked --path hosts` for a pitchlock that was \
                    installed, `cargo build --release --manifest-path hosts/Cargo.toml --target-dir target` for one \
                    that was built there";
        return Err(CliError::file(&path, text));
    }
    let mut command = Command::new(path);
    command.arg(end);
    Ok(command)
}

/// Starts what looks at the machines of a hall.
pub(crate) fn hall(machines: &[Watch]) -> Result<Link, CliError> {
    let mut command = bare("hall")?;
    command.arg("--control").arg(env!("CARGO_PKG_VERSION"));
    let mut link = Link::start(command, Stdio::null())?;
    link.heard.says(&machines)?;
    Ok(link)
}

/// Measures the way to another computer and back, and prints a table.
pub(crate) fn ping(machine: &MachineArgs, (at, key): (&str, &Path)) -> Result<ExitCode, CliError> {
    let wrong = |error: std::io::Error| CliError::Machine(error.to_string());
    let mut interrupts = Interrupts::catch()?;
    let mut command = command("ping", &compared(machine)?, key)?;
    let mut child = command.arg("--at").arg(at).process_group(0).spawn().map_err(wrong)?;
    let status = loop {
        if let Some(status) = child.try_wait().map_err(wrong)? {
            break status;
        }
        if interrupts.is_wished() {
            child.kill().and_then(|()| child.wait()).map_err(wrong)?;
            return Err(CliError::Machine("the measurement was broken off here".into()));
        }
        sleep_until(Moment::now().after(NAP));
    };
    Ok(status.code().and_then(|code| u8::try_from(code).ok()).map_or(ExitCode::FAILURE, ExitCode::from))
}

impl Link {
    /// Starts it, in a process group of its own: Ctrl-C reaches the launcher only. Its standard input is a
    /// socket by which both speak; its standard output, at the machine, the address at which it is called.
    fn start(mut command: Command, address: Stdio) -> Result<Link, CliError> {
        let wrong = |error: std::io::Error| CliError::Machine(format!("cannot start {LINK}: {error}"));
        let (ear, its) = UnixStream::pair().map_err(wrong)?;
        command.stdin(Stdio::from(OwnedFd::from(its))).stdout(address).process_group(0);
        let child = command.spawn().map_err(wrong)?;
        // The command has the other end of the socket: without it that has ended when the process has.
        drop(command);
        let mouth = ear.try_clone().map_err(wrong)?;
        let (sender, said) = channel();
        let hear = move || {
            let lines = BufReader::new(mouth).lines().map_while(Result::ok);
            // What comes from another computer is shown here: it steers no terminal.
            let all = lines.filter_map(|line| serde_json::from_str(&line).ok()).map(Said::harmless);
            // Who started it may want nothing more.
            all.for_each(|said| drop(sender.send(said)));
        };
        std::thread::Builder::new().name("link".into()).spawn(hear).map_err(wrong)?;
        let dumb = Quiet::new();
        Ok(Link {
            child,
            heard: Heard { said, ear, wish: Wish::None, why: None, looked: false, computed: 0, dumb },
        })
    }

    /// What it has said, if that comes soon.
    pub(crate) fn says(&self) -> Option<Said> {
        self.heard.said.recv_timeout(NAP).ok()
    }

    /// What is left of what it said: it has ended.
    fn says_last(&self) -> Option<Said> {
        self.heard.said.recv_timeout(LAST_WORDS).ok()
    }

    /// Whether it has ended, and nothing that it has said is left.
    pub(crate) fn is_over(&mut self) -> bool {
        self.child.try_wait().map_or(true, |exit| exit.is_some())
    }

    /// It takes the place of the interpreter in a name space. What is left is a child, and its pipes.
    pub(super) fn joins(mut self, address: &str, clock: Clock) -> Result<(Child, Heard), CliError> {
        let told = Told::Join { address: address.into(), real: clock == Clock::Real };
        self.heard.tell(&told)?;
        Ok((self.child, self.heard))
    }

    /// It says nothing any more, and is to say nothing later either. It may have ended already.
    fn is_given_up(&mut self) {
        let _ = self.child.kill();
    }

    /// It hears that nothing more is wanted, has a moment for its last words, and is ended.
    pub(crate) fn end(self) {
        let Link { mut child, heard: Heard { said, ear, .. } } = self;
        // It may have ended already.
        let _ = ear.shutdown(Shutdown::Write);
        let _ = said.recv_timeout(LAST_WORDS);
        let _ = child.kill();
        let _ = child.wait();
    }
}

impl Heard {
    /// Tells it something. One that has just ended hears nothing of it: that is seen elsewhere.
    fn tell(&mut self, told: &Told) -> Result<(), CliError> {
        self.says(told)
    }

    fn says(&mut self, told: &impl serde::Serialize) -> Result<(), CliError> {
        let line = serde_json::to_string(told).map_err(|error| CliError::Machine(error.to_string()))?;
        let _ = writeln!(self.ear, "{line}");
        Ok(())
    }

    /// What somebody at the other computer wants, all in all.
    pub(super) fn wish(&mut self) -> Wish {
        while let Ok(said) = self.said.try_recv() {
            self.dumb.begins_anew();
            match said {
                Said::Press(1) => self.wish = self.wish.max(Wish::Stop),
                Said::Press(_) => self.wish = self.wish.max(Wish::EmergencyStop),
                Said::Note(text) => words::say(&format!("{text}\n")),
                Said::Look => self.looked = true,
                Said::Computes => self.computed += 1,
                Said::Why(text) | Said::Refused(text) => self.why = Some(text),
                _ => {}
            }
        }
        self.wish
    }

    /// How often the interpreter on the other computer has said that it computes.
    pub(super) fn computed(&self) -> u64 {
        self.computed
    }

    /// Whether it says nothing any more: each call is a look.
    pub(super) fn is_dumb(&mut self) -> bool {
        self.dumb.look() >= DUMB
    }

    /// What is said next, if that comes soon.
    ///
    /// # Errors
    /// Why nothing more will come.
    fn hears(&mut self) -> Result<Option<Said>, String> {
        match self.said.recv_timeout(NAP) {
            Ok(said) => {
                self.dumb.begins_anew();
                Ok(Some(said).filter(|said| *said != Said::Beat))
            }
            Err(RecvTimeoutError::Timeout) if self.is_dumb() => {
                Err(format!("{LINK} here does not answer any more: it is killed"))
            }
            Err(RecvTimeoutError::Timeout) => Ok(None),
            Err(RecvTimeoutError::Disconnected) => Err("its process has ended".into()),
        }
    }

    /// Whether somebody in a hall has asked what the machine does, and has not been answered.
    pub(super) fn is_looked_at(&self) -> bool {
        self.looked
    }

    /// Answers that. The link asks again only when it has been answered, so this never waits.
    pub(crate) fn shows(&mut self, seen: serde_json::Value) {
        self.looked = false;
        // What cannot be told is not seen.
        let _ = self.tell(&Told::Seen(seen));
    }

    /// Why it ended; it has.
    pub(super) fn why(&self) -> Option<String> {
        let last = || {
            self.said.iter().find_map(|said| match said {
                Said::Why(text) | Said::Refused(text) => Some(text),
                _ => None,
            })
        };
        self.why.clone().or_else(last)
    }
}
