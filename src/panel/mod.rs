//! `pitchlock panel`: a machine with its panel in a browser. Between runs it waits for somebody who starts
//! one.

mod args;
mod known;
mod live;
mod plan;
mod session;
mod view;
mod web;

use std::{
    net::TcpListener,
    os::{fd::AsFd as _, unix::net::UnixStream},
    process::ExitCode,
    time::Duration,
};

use process::ipc::time::{Moment, sleep_until};
use serde_json::json;

pub(crate) use args::{HELP, PanelArgs, PanelCommandArgs};
use known::Known;
pub(crate) use live::{Live, stays};
pub(crate) use session::Who;

use crate::{
    error::CliError,
    run::{self, Prepared, RunArgs, interrupts::Interrupts},
    screen, words,
};
use web::Web;

/// Between two looks while nothing runs.
const IDLE: Duration = Duration::from_millis(20);
/// Longest text of a program that is shown, bytes.
const MOST_TEXT: u64 = 512 << 10;

impl Live {
    /// Opens the panel and says where it is.
    pub(crate) fn open(args: &RunArgs, quiet: bool) -> Result<Live, CliError> {
        let web = Web::open(&args.panel)?;
        let (url, token) = web.url_and_token();
        if args.json && !args.with_panel {
            screen::print(&format!("{}\n", json!({ "url": url, "token": token })));
        } else if !quiet || args.with_panel {
            words::say(&format!("panel: {url}#{token}\n"));
        }
        Ok(Live::new(web, args.with_panel))
    }

    /// Shows a run that is about to begin.
    pub(crate) fn prepared(&mut self, setup: &run::Setup) {
        let observer = setup.program.observer(&setup.machine);
        let text = intake::text(&setup.folder.program, MOST_TEXT).ok();
        let (program, machine) = stays(setup, &observer, text);
        self.begins(&program, &machine, Known::of(setup));
    }
}

/// Runs the program as often as somebody starts it.
pub(crate) fn panel(args: &PanelCommandArgs, quiet: bool) -> Result<ExitCode, CliError> {
    let asked = &args.run;
    if asked.with_panel {
        return Err(CliError::Input("--panel is for run; leave it out".into()));
    }
    if asked.resume {
        return Err(CliError::Input("--resume is for run: pitchlock run RUN_DIR --resume".into()));
    }
    // Whatever is wrong with the input is said before there is a panel.
    let program = run::judged(asked)?;
    let name = program.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let mut interrupts = Some(Interrupts::catch()?);
    let mut live = Live::open(asked, quiet)?;
    let mut said = format!("{name} is loaded; start starts it");
    let shown = json!({ "program": { "name": name, "text": intake::text(&program, MOST_TEXT).ok() } });
    live.stands(shown.as_object().cloned().unwrap_or_default());
    loop {
        let ready = json!({ "state": "ready", "words": said });
        live.stands(ready.as_object().cloned().unwrap_or_default());
        while !live.is_started() {
            if interrupts.as_mut().is_some_and(Interrupts::is_wished) {
                return Ok(ExitCode::SUCCESS);
            }
            sleep_until(Moment::now().after(IDLE));
        }
        let begun = Prepared::of(asked, quiet, &mut interrupts);
        let ended = begun.and_then(|prepared| prepared.go(quiet, &mut interrupts, Some(&mut live)));
        said = match ended {
            Ok(_) => "start starts it again".into(),
            Err(error) => {
                words::say(&format!("error: {error}\n"));
                format!("it was not run: {error}")
            }
        };
        interrupts.iter_mut().for_each(Interrupts::forget);
    }
}

/// The process of the panel, as the launcher starts it: its standard input is the link to the launcher, its
/// standard output the socket on which it listens.
pub(crate) fn server() -> Result<ExitCode, CliError> {
    let wrong = |error: std::io::Error| CliError::Machine(format!("panel-server: {error}"));
    let link = std::io::stdin().as_fd().try_clone_to_owned().map_err(wrong)?;
    let listener = std::io::stdout().as_fd().try_clone_to_owned().map_err(wrong)?;
    ::panel::serve(TcpListener::from(listener), UnixStream::from(link)).map_err(wrong)?;
    Ok(ExitCode::SUCCESS)
}
