//! `pitchlock panel --terminal` and `--join`: the panel in this terminal. In: keys, what the panel sends.
//! Out: what is drawn, requests. With `--terminal` the panel is a process that this one starts: its
//! standard input is a pipe that leads it. A byte is one Ctrl-C; its end, however this process ends, is
//! that of the terminal.

use std::{
    ffi::OsString,
    io::{BufRead as _, BufReader, IsTerminal as _, Read as _, Write as _},
    process::{Child, ChildStdin, Command, ExitCode, Stdio},
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
        mpsc::{Receiver, channel},
    },
    thread::Builder,
    time::Duration,
};

use process::ipc::time::{Moment, sleep_until};
use serde_json::Value;
use signal_hook::{
    consts::{SIGHUP, SIGINT},
    low_level::raise,
};
use terminal::{Act, At, Client, Desk, Screen};

use super::args::PanelCommandArgs;
use crate::{error::CliError, run::interrupts::Interrupts, words};

/// Between two looks at the panel.
const PAUSE: Duration = Duration::from_millis(10);
/// Between two pictures.
const DRAWN: Duration = Duration::from_millis(40);
/// Between two tries to connect.
const AGAIN: Duration = Duration::from_secs(1);
/// What the launcher has said that is kept, lines.
const MOST_SAID: usize = 200;
/// Bytes that lead a panel.
pub(crate) const CTRL_C: u8 = b'c';
pub(crate) const LOOK: u8 = b'l';
/// The word of the command line behind which the arguments of the launcher go.
const COMMAND: &str = "panel";
/// Where a panel is that is joined.
const WHERE: &str = "PITCHLOCK_PANEL";

/// Shows a panel in this terminal.
pub(super) fn terminal(args: &PanelCommandArgs) -> Result<ExitCode, CliError> {
    if args.run.json {
        return Err(CliError::Input(
            "--json prints where a panel is; leave it out with --terminal and --join".into(),
        ));
    }
    if !std::io::stdin().is_terminal() || !std::io::stdout().is_terminal() {
        let text = "--terminal and --join need a terminal for keys and picture: without them the panel is for browsers";
        return Err(CliError::Input(text.into()));
    }
    if std::env::var_os("TERM").is_some_and(|name| name == "dumb") {
        let text = "TERM=dumb is a terminal whose cursor does not move: set TERM to what it is, as xterm, or leave out --terminal and open the panel in a browser";
        return Err(CliError::Input(text.into()));
    }
    let mut interrupts = Interrupts::catch()?;
    if args.join {
        let at = asked_for(&mut interrupts)?;
        return at.map_or(Ok(ExitCode::SUCCESS), |at| joined(&at, &mut interrupts));
    }
    let mut launcher = Launcher::start().map_err(|error| CliError::Machine(format!("the panel: {error}")))?;
    let shown = match launcher.place() {
        Some(at) => shown(&at, Some(&mut launcher), &mut interrupts),
        // It says why and ends by itself; the end of its pipe would end it before.
        None => launcher.child.wait().map(drop).map_err(|error| CliError::Machine(error.to_string())),
    };
    let status = launcher.ends();
    shown.map(|()| status)
}

/// Where the panel is that is joined, unless somebody ends that: no command line has its secret, which
/// others of this computer could read.
fn asked_for(interrupts: &mut Interrupts) -> Result<Option<At>, CliError> {
    let wrong = |why: String| CliError::Input(why);
    if let Some(text) = std::env::var_os(WHERE) {
        let at = text.to_string_lossy().parse::<At>();
        return at.map(Some).map_err(|why| wrong(format!("{WHERE} {why}")));
    }
    let asks = "address of the panel, as it was printed; what stands behind # is not shown: ";
    let typed = terminal::secret(asks, || interrupts.is_wished()).map_err(gone)?;
    let at = typed.map(|line| {
        let shown = line.trim().split('#').next().unwrap_or_default().to_owned();
        line.parse::<At>().map_err(|why| wrong(format!("{shown:?} {why}")))
    });
    at.transpose()
}

fn gone(error: std::io::Error) -> CliError {
    CliError::Machine(format!("the terminal: {error}"))
}

/// Somebody looks at a panel that others have begun.
fn joined(at: &At, interrupts: &mut Interrupts) -> Result<ExitCode, CliError> {
    // Whoever is not there, or lets nobody in, is told before the terminal is taken.
    Client::connect(at).map_err(CliError::Input)?;
    shown(at, None, interrupts)?;
    Ok(ExitCode::SUCCESS)
}

/// Shows it until somebody leaves, or the panel that was begun here ends.
fn shown(at: &At, mut launcher: Option<&mut Launcher>, interrupts: &mut Interrupts) -> Result<(), CliError> {
    let begun = Moment::now();
    let mut desk = Desk::new(&format!("terminal-{}", std::process::id()), launcher.is_some());
    let mut wire = Wire { at: at.clone(), client: None, tried: None };
    let mut screen = Screen::take().map_err(gone)?;
    let mut drawn = None::<Moment>;
    while !interrupts.is_wished() {
        if let Some(launcher) = &mut launcher {
            launcher.said.try_iter().for_each(|line| {
                desk.told(&line);
                launcher.kept.push(line);
            });
            if launcher.has_ended() {
                break;
            }
        }
        wire.hears(&mut desk);
        if drawn.is_none_or(|drawn| drawn.elapsed() >= DRAWN) {
            screen.draw(&mut desk).map_err(gone)?;
            drawn = Some(Moment::now());
        }
        let act = match screen.key(PAUSE).map_err(gone)? {
            Some(key) => desk.key(&key, begun.elapsed()),
            None => Act::Stay,
        };
        desk.beat(begun.elapsed());
        wire.says(&mut desk);
        match (act, &mut launcher) {
            (Act::Stay, _) => {}
            (Act::End, Some(launcher)) => launcher.interrupt(),
            (Act::Leave | Act::End, _) => break,
        }
    }
    Ok(())
}

/// The way to the panel.
struct Wire {
    at: At,
    client: Option<Client>,
    tried: Option<Moment>,
}

impl Wire {
    /// Takes what the panel has sent; one that is gone is looked for again.
    fn hears(&mut self, desk: &mut Desk) {
        if self.client.is_none() && self.tried.is_none_or(|tried| tried.elapsed() >= AGAIN) {
            match Client::connect(&self.at) {
                Ok(client) => {
                    self.client = Some(client);
                    desk.connected();
                }
                Err(why) => desk.gone(&why),
            }
            self.tried = Some(Moment::now());
        }
        while let Some(client) = &mut self.client {
            match client.news() {
                Ok(Some(news)) => desk.hears(news),
                Ok(None) => break,
                Err(why) => self.lost(desk, &why),
            }
        }
    }

    /// Sends what is asked for.
    fn says(&mut self, desk: &mut Desk) {
        for request in desk.asks() {
            if let Some(Err(why)) = self.client.as_mut().map(|client| client.say(&request)) {
                self.lost(desk, &why);
            }
        }
    }

    fn lost(&mut self, desk: &mut Desk, why: &str) {
        self.client = None;
        desk.gone(why);
    }
}

/// The process of the panel that was begun here.
struct Launcher {
    child: Child,
    leads: Option<ChildStdin>,
    said: Receiver<String>,
    kept: Vec<String>,
}

impl Launcher {
    /// The same command without a terminal.
    fn start() -> std::io::Result<Launcher> {
        let mut arguments: Vec<OsString> =
            std::env::args_os().skip(1).filter(|one| one != "--terminal").collect();
        let place = arguments.iter().position(|one| one == COMMAND).map_or(0, |place| place + 1);
        arguments.splice(place..place, ["--led", "--json"].map(OsString::from));
        let mut command = Command::new(std::env::current_exe()?);
        command.args(arguments).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn()?;
        let (says, said) = channel();
        if let Some(words) = child.stderr.take() {
            let hears = move || {
                let lines = BufReader::new(words).lines().map_while(Result::ok);
                lines.take_while(|line| says.send(line.clone()).is_ok()).for_each(drop);
            };
            Builder::new().name("launcher".into()).spawn(hears)?;
        }
        Ok(Launcher { leads: child.stdin.take(), child, said, kept: Vec::new() })
    }

    /// Where its panel is; nothing if it has ended before there was one, and has said why.
    fn place(&mut self) -> Option<At> {
        let mut line = String::new();
        BufReader::new(self.child.stdout.as_mut()?).read_line(&mut line).ok()?;
        let place: Value = serde_json::from_str(&line).ok()?;
        format!("{}#{}", place["url"].as_str()?, place["token"].as_str()?).parse().ok()
    }

    /// As by Ctrl-C.
    fn interrupt(&mut self) {
        // One that has ended hears nothing, which is seen elsewhere.
        let _ = self.leads.as_mut().map(|leads| leads.write_all(&[CTRL_C]).and_then(|()| leads.flush()));
    }

    fn has_ended(&mut self) -> bool {
        !matches!(self.child.try_wait(), Ok(None))
    }

    /// Lets it end, and tells what it has said.
    fn ends(mut self) -> ExitCode {
        self.leads = None;
        let status = self.child.wait().ok().and_then(|status| status.code());
        self.kept.extend(self.said.iter());
        let first = self.kept.len().saturating_sub(MOST_SAID);
        self.kept[first..].iter().for_each(|line| words::say(&format!("{line}\n")));
        ExitCode::from(status.and_then(|code| u8::try_from(code).ok()).unwrap_or(1))
    }
}

/// The panel is led by its standard input: a byte is one Ctrl-C, or asks what the machine does, and that is
/// said once; its end is that of a terminal.
pub(super) fn led() -> Result<Arc<AtomicBool>, CliError> {
    let looked = Arc::<AtomicBool>::default();
    let asked = Arc::clone(&looked);
    let leads = move || {
        let mut bytes = std::io::stdin().lock().bytes();
        while let Some(Ok(byte)) = bytes.next() {
            match byte {
                LOOK => asked.store(true, Ordering::Relaxed),
                // Both fail for no signal that there is.
                _ => drop(raise(SIGINT)),
            }
        }
        // One ends the run in hand, the next one the command.
        loop {
            let _ = raise(SIGHUP);
            sleep_until(Moment::in_s(0.2));
        }
    };
    let begun = Builder::new().name("led".into()).spawn(leads);
    begun.map(|_| looked).map_err(|error| CliError::Machine(format!("the panel: {error}")))
}
