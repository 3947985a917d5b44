//! Somebody stands at this machine with a panel on another computer. In: the files that came, a link. Out:
//! the same panel as on this computer, as a process that is led by its standard input: a byte is one Ctrl-C,
//! and its end that of whoever stands there. So the machine comes to rest whichever process dies.

use std::{
    io::{BufRead as _, BufReader, Write as _},
    net::Shutdown,
    os::{
        fd::OwnedFd,
        unix::{
            net::{UnixListener, UnixStream},
            process::CommandExt as _,
        },
    },
    path::Path,
    process::{Child, Command, Stdio},
    sync::mpsc::{Receiver, channel},
};

use process::{
    ipc::time::{Moment, sleep_until},
    link::{Said, Told},
};

use serde_json::Value;

use super::{
    Link, NAP, seen,
    serve::{ServeArgs, is_as_compared, options, program_in},
};
use crate::{
    error::CliError,
    panel::{CTRL_C, LOOK},
    run::interrupts::{Interrupts, Wish},
    screen, words,
};

/// The name of the socket; no file that comes has one like it.
pub(super) const SOCKET: &str = ".panel";
/// What the panel has said that is kept for whoever stands there, lines.
const MOST_SAID: usize = 20;
/// Options that a panel may have.
const OPTIONS: usize = 7;

/// From the first press to the last.
pub(super) fn stand(
    args: &ServeArgs,
    machine: &str,
    (folder, words, compared): (&Path, &[String], &str),
    mut link: Link,
    interrupts: &mut Option<Interrupts>,
) -> Result<(), CliError> {
    let begun = is_as_compared(args, compared).and_then(|()| Panel::start(args, folder, words));
    let mut panel = match begun {
        Ok(panel) => panel,
        Err(error) => {
            link.heard.tell(&Told::Refuse(screen::plain(&error.to_string())))?;
            link.end();
            return Err(error);
        }
    };
    link.heard.tell(&Told::Panel { socket: folder.join(SOCKET), first: String::new() })?;
    link.heard.shows(seen::off(machine));
    let (mut wish, mut lost) = (Wish::None, None);
    while panel.child.try_wait().is_ok_and(|exit| exit.is_none()) {
        panel.hears();
        if let Some(seen) = panel.seen(machine) {
            link.heard.shows(seen);
        }
        match link.heard.hears() {
            Ok(Some(Said::Press(_))) => panel.interrupt(),
            Ok(Some(Said::Look)) => panel.looks(),
            Ok(Some(Said::Note(text))) => words::say(&format!("{text}\n")),
            Ok(Some(Said::Why(text) | Said::Refused(text))) => lost = Some(text),
            Ok(_) => {}
            Err(text) => {
                lost.get_or_insert(text);
                link.is_given_up();
                sleep_until(Moment::now().after(NAP));
            }
        }
        if interrupts.as_mut().is_some_and(Interrupts::ends) {
            lost.get_or_insert_with(|| "`pitchlock serve` was told to end".into());
        }
        if lost.is_some() {
            panel.is_left();
        }
        let now = interrupts.as_mut().map_or(Wish::None, Interrupts::wish);
        if now > std::mem::replace(&mut wish, now) {
            panel.interrupt();
        }
    }
    let ended = panel.ends();
    let ended = match lost {
        Some(why) if ended.is_ok() => {
            Err(CliError::Machine(format!("the link to the panel was lost, and the machine stopped: {why}")))
        }
        _ => ended,
    };
    match &ended {
        Err(error @ CliError::Input(_)) => {
            link.heard.tell(&Told::Refuse(screen::plain(&error.to_string())))?
        }
        Err(error) => link.heard.tell(&Told::Lost(screen::plain(&error.to_string())))?,
        Ok(()) => link.heard.tell(&Told::Over)?,
    }
    link.end();
    ended
}

/// The process of the panel's launcher.
struct Panel {
    child: Child,
    leads: Option<UnixStream>,
    said: Receiver<String>,
    kept: Vec<String>,
    /// What it says of the machine when it is asked.
    shows: Receiver<Value>,
}

impl Panel {
    fn start(args: &ServeArgs, folder: &Path, words: &[String]) -> Result<Panel, CliError> {
        let wrong = |error: std::io::Error| CliError::Machine(format!("cannot start a panel: {error}"));
        let (program, options) = options(words, OPTIONS)?;
        let program = if program.is_empty() { None } else { Some(program_in(folder, program)?) };
        let socket = folder.join(SOCKET);
        let listener = UnixListener::bind(&socket).map_err(|error| CliError::file(&socket, error))?;
        let mut command = Command::new(std::env::current_exe().map_err(wrong)?);
        command.arg("panel").args(program).args(["--there", "--led"]).args(options);
        command.args(args.machine.machine.iter().flat_map(|file| ["--machine".as_ref(), file.as_os_str()]));
        let (leads, led) = UnixStream::pair().map_err(wrong)?;
        command
            .stdin(Stdio::from(OwnedFd::from(led)))
            .stdout(Stdio::from(OwnedFd::from(listener)))
            .stderr(Stdio::piped());
        let mut child = command.process_group(0).spawn().map_err(wrong)?;
        let (says, said) = channel();
        if let Some(words) = child.stderr.take() {
            let hears = move || {
                let lines = BufReader::new(words).lines().map_while(Result::ok);
                lines.take_while(|line| says.send(line.clone()).is_ok()).for_each(drop);
            };
            std::thread::Builder::new().name("panel".into()).spawn(hears).map_err(wrong)?;
        }
        let (shown, shows) = channel();
        let answers = BufReader::new(leads.try_clone().map_err(wrong)?).lines().map_while(Result::ok);
        let hears = move || {
            let all = answers.filter_map(|line| serde_json::from_str(&line).ok());
            all.take_while(|seen: &Value| shown.send(seen.clone()).is_ok()).for_each(drop);
        };
        std::thread::Builder::new().name("seen".into()).spawn(hears).map_err(wrong)?;
        Ok(Panel { leads: Some(leads), child, said, kept: Vec::new(), shows })
    }

    /// What it says is said here.
    fn hears(&mut self) {
        for line in self.said.try_iter() {
            words::say(&format!("{line}\n"));
            self.kept.push(line);
        }
        let first = self.kept.len().saturating_sub(MOST_SAID);
        self.kept.drain(..first);
    }

    /// As by Ctrl-C.
    fn interrupt(&mut self) {
        self.tells(CTRL_C);
    }

    /// It is asked what the machine does.
    fn looks(&mut self) {
        self.tells(LOOK);
    }

    fn tells(&mut self, byte: u8) {
        // One that has ended hears nothing, which is seen elsewhere.
        let _ = self.leads.as_mut().map(|leads| leads.write_all(&[byte]));
    }

    /// What it has said of the machine since it was asked.
    fn seen(&self, machine: &str) -> Option<Value> {
        let mut seen = self.shows.try_recv().ok()?;
        seen["machine"] = machine.into();
        Some(seen)
    }

    /// Nobody stands there any more.
    fn is_left(&mut self) {
        if let Some(leads) = self.leads.take() {
            // It may be gone already.
            let _ = leads.shutdown(Shutdown::Both);
        }
    }

    /// It has ended; why, if that was early.
    fn ends(mut self) -> Result<(), CliError> {
        let exit = self.child.wait().map_err(|error| CliError::Machine(error.to_string()))?;
        for line in self.said.iter() {
            words::say(&format!("{line}\n"));
            self.kept.push(line);
        }
        let said = || self.kept.join("\n").trim_start_matches("error: ").to_owned();
        match exit.code() {
            Some(0) => Ok(()),
            Some(2) => Err(CliError::Input(said())),
            _ => Err(CliError::Machine(format!("the panel ended: {exit}\n{}", said()))),
        }
    }
}
