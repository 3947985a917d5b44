//! `pitchlock panel --at`: the panel is here, and the machine with its launcher on another computer. In: what
//! `panel` is given. Out: the page. Its server here reads the socket to the launcher there as if that were
//! here; the secret of the page never leaves this computer.

use std::{
    os::unix::net::UnixListener,
    process::{ExitCode, Stdio},
    sync::atomic::Ordering,
    time::Duration,
};

use process::{
    ipc::time::Moment,
    link::{Said, Told},
};

use super::{
    Call, Link,
    at::{HERE_ALONE, asked_for, refuses},
    command, compared,
    stand::SOCKET,
};
use crate::{
    error::CliError,
    panel::{BY_HAND, Server},
    run::{
        Prepared, RunArgs,
        interrupts::{Interrupts, Wish},
    },
    temporary::Temporary,
    words,
};

/// What was pressed longer ago was of another run.
const LONG_AGO: Duration = Duration::from_secs(10);

/// Shows the panel of a machine of another computer until somebody ends the command.
pub(crate) fn panel_at(asked: &RunArgs, (at, key): Call, quiet: bool) -> Result<ExitCode, CliError> {
    let language = &asked.language;
    let its_own = "the machine has its own, which its machine file there names";
    refuses(&[
        (asked.in_process, "--in-process", HERE_ALONE),
        (asked.processes, "--processes", HERE_ALONE),
        (asked.out.is_some(), "--out", "run folders are made by `pitchlock serve`, in its folder"),
        (language.tools.is_some(), "--tools", its_own),
        (language.parameters.is_some(), "--parameters", its_own),
        (language.ini.is_some(), "--ini", its_own),
        (asked.program.is_dir(), "a run folder", "play it where it is"),
        (asked.unkept || !asked.fell.is_empty(), "what tests do to a process", HERE_ALONE),
    ])?;
    let mut interrupts = Some(Interrupts::catch()?);
    let place = Temporary::new("panel")?;
    let mut send = Told::Send {
        folder: place.path().to_owned(),
        files: Vec::new(),
        words: asked_for(asked, "", asked.seed.unwrap_or(1)),
    };
    let prepared = match asked.program.as_os_str() == BY_HAND {
        true => None,
        // Where it begins is chosen there.
        false => Some(Prepared::of(&RunArgs { from: None, ..asked.clone() }, quiet, &mut interrupts, true)?),
    };
    if let Some(Prepared { setup, .. }) = &prepared {
        let program = setup.folder.program.file_name().unwrap_or_default().to_string_lossy();
        let mut words = asked_for(asked, &program, setup.seed);
        words.extend(asked.from.iter().flat_map(|line| ["--from".into(), line.to_string()]));
        send =
            Told::Send { folder: setup.folder.path.clone(), files: setup.folder.program_is_made_of(), words };
    }
    let server = Server::open(&asked.panel)?;
    let socket = place.path().join(SOCKET);
    let listener = UnixListener::bind(&socket).and_then(|listener| {
        listener.set_nonblocking(true)?;
        Ok(listener)
    });
    let listener = listener.map_err(|error| CliError::file(&socket, error))?;
    let mut command = command("panel", &compared(&asked.machine)?, key)?;
    command.arg("--at").arg(at);
    let link = Link::start(command, Stdio::null())?;
    let first =
        serde_json::to_string(&server.first()).map_err(|error| CliError::Machine(error.to_string()))?;
    let tells = vec![send, Told::Panel { socket, first: first + "\n" }];
    let caught = interrupts.ok_or_else(|| CliError::Machine("signals are not caught".into()))?;
    let wish = (Wish::None, Moment::now());
    let mut far = Far { server, listener, link, interrupts: caught, wish, at, quiet, tells, begun: false };
    let ended = far.stands(asked.json);
    let Far { link, server, .. } = far;
    link.end();
    drop((server, prepared));
    ended.map(|()| ExitCode::SUCCESS)
}

/// A panel here of a machine there.
struct Far<'a> {
    server: Server,
    /// Where the link comes that is the launcher's for the server.
    listener: UnixListener,
    link: Link,
    interrupts: Interrupts,
    /// What was wished, and when.
    wish: (Wish, Moment),
    at: &'a str,
    quiet: bool,
    /// What the link is told when it was let in.
    tells: Vec<Told>,
    /// The machine waits for presses.
    begun: bool,
}

impl Far<'_> {
    fn stands(&mut self, json: bool) -> Result<(), CliError> {
        while self.looks_at_the_keyboard()? {
            match self.link.heard.hears() {
                Ok(Some(Said::Welcome { .. })) => {
                    self.tells.iter().try_for_each(|told| self.link.heard.tell(told))?;
                }
                Ok(Some(Said::Started)) => {
                    self.begun = true;
                    self.server.says_where(json, self.quiet);
                }
                Ok(Some(Said::Outcome(_))) => return Ok(()),
                Ok(Some(Said::Refused(text))) => return Err(CliError::Input(text)),
                Ok(Some(Said::Why(text))) | Err(text) => return Err(self.lost(&text)),
                Ok(Some(Said::Note(text))) if !self.quiet => words::say(&format!("{text}\n")),
                Ok(_) => {}
            }
            if self.server.is_due()
                && let Ok((link, _)) = self.listener.accept()
            {
                // Without memory or files for it there is no panel, and a later look tries again.
                let _ = link.set_nonblocking(false).and_then(|()| self.server.start(link));
            }
        }
        Ok(())
    }

    fn lost(&self, why: &str) -> CliError {
        let at = self.at;
        CliError::Machine(format!(
            "the link to {at} is lost: {why}\nhelp: the machine there comes to rest by itself, as by Ctrl-C; its run folder \
             there says how"
        ))
    }

    /// Passes Ctrl-C on. False if nothing more is wanted: the terminal is gone, or it was pressed before
    /// anything could hear it.
    fn looks_at_the_keyboard(&mut self) -> Result<bool, CliError> {
        let (before, since) = self.wish;
        if before != Wish::None && since.elapsed() > LONG_AGO {
            self.interrupts.forget();
            self.wish.0 = Wish::None;
            return Ok(true);
        }
        let told = self.interrupts.asked().swap(false, Ordering::Relaxed);
        let wish = self.interrupts.wish();
        if wish == before {
            // Who is told twice to end, and not by Ctrl-C, has nobody at it any more.
            return Ok(!told);
        }
        self.interrupts.asked().store(false, Ordering::Relaxed);
        self.wish = (wish, Moment::now());
        match wish {
            _ if !self.begun => Ok(false),
            Wish::End => Err(self.lost("it was broken off here")),
            Wish::EmergencyStop => self.link.heard.tell(&Told::Press(2)).map(|()| true),
            Wish::None | Wish::Stop => self.link.heard.tell(&Told::Press(1)).map(|()| true),
        }
    }
}
