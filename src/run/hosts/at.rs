//! `pitchlock run --at`: the program is here, and the machine on another computer. In: what `run` is given.
//! Out: what became of the run there. Here are the interpreter and the link, and between them a name space.

use std::{
    process::{ExitCode, Stdio},
    time::Duration,
};

use process::{
    ipc::{Host, NameSpace, Process, child::used, time::Moment},
    link::{Said, Told},
};
use rig::observe::Summary;
use serde_json::Value;

use super::{Call, Link, command, compared};
use crate::{
    error::CliError,
    run::{
        Prepared, RunArgs, Setup,
        children::Started,
        ended::{Form, status, tell_end},
        interrupts::{Interrupts, Wish},
        recorder::axes,
    },
    words,
};

/// So long the interpreter may take until it has connected, s.
const START_S: f64 = 20.0;
/// How often it is looked whether the interpreter computes.
const WORKS: Duration = Duration::from_millis(500);
/// Those of a machine who live here.
const HERE: [Process; 2] = [Process::Interpreter, Process::Interpolator];

/// What else to do than what is for this computer alone.
pub(super) const HERE_ALONE: &str = "leave it out";

/// Refuses what is not for the machine of another computer, with what else to do.
pub(super) fn refuses(all: &[(bool, &str, &str)]) -> Result<(), CliError> {
    let said = all.iter().find(|(said, ..)| *said);
    said.map_or(Ok(()), |(_, what, help)| {
        let text = "is for a machine on this computer, and cannot go with --at";
        Err(CliError::Input(format!("{what} {text}\nhelp: {help}, or leave out --at")))
    })
}

/// Runs a program on the machine of another computer.
pub(crate) fn run_at(asked: &RunArgs, (at, key): Call, quiet: bool) -> Result<ExitCode, CliError> {
    refuses(&[
        (asked.in_process, "--in-process", HERE_ALONE),
        (asked.resume, "--resume", "go on with it there: its run folder is on that computer"),
        (asked.dry_run, "--dry-run", HERE_ALONE),
        (asked.with_panel, "--panel", "pitchlock panel PROGRAM --at starts from the page"),
        (asked.processes, "--processes", HERE_ALONE),
        (asked.out.is_some(), "--out", "run folders are made by `pitchlock serve`, in its folder"),
        (asked.unkept || !asked.fell.is_empty(), "what tests do to a process", HERE_ALONE),
    ])?;
    let mut interrupts = None;
    let Prepared { setup, keeps, json, .. } = Prepared::of(asked, quiet, &mut interrupts, false)?;
    let caught = interrupts.as_mut().ok_or_else(|| CliError::Machine("signals are not caught".into()))?;
    let mut command = command("upper", &compared(&asked.machine)?, key)?;
    command.arg("--at").arg(at);
    let link = Link::start(command, Stdio::null())?;
    let (wish, worked) = (Wish::None, (Moment::now(), 0));
    let mut far = Far {
        setup: &setup,
        link,
        interrupts: caught,
        wish,
        at,
        quiet,
        started: false,
        joined: false,
        worked,
    };
    let program = setup.folder.program.file_name().unwrap_or_default().to_string_lossy();
    let ended = far.run(&asked_for(asked, &program, setup.seed));
    far.link.end();
    let value = ended?;
    if let Some(error) = value["error"].as_str() {
        return Err(there(at, error));
    }
    let summary: Summary = serde_json::from_value(value["summary"].clone())
        .map_err(|error| CliError::Machine(format!("the summary of {at}: {error}")))?;
    if let Some(folder) = value["folder"].as_str().filter(|_| !quiet && !json) {
        words::say(&format!("the run folder is {folder} at {at}\n"));
    }
    let kept = keeps.map_or(Ok(()), |keeps| keeps.what_is_left(&setup.program, summary.outcome));
    // What the program was lies there, with all that the run has left.
    drop(setup);
    tell_end(&summary, None, if json { Form::Json } else { Form::Printed }, quiet)?;
    if let Some(error) = value["unwritten"].as_str() {
        return Err(there(at, error));
    }
    kept.map(|()| status(&summary))
}

/// Something that is wrong on the other computer.
fn there(at: &str, error: &str) -> CliError {
    CliError::Machine(format!("on the computer at {at}: {error}"))
}

/// The run as the other computer is asked for it: the program, then what is not in the files.
pub(super) fn asked_for(asked: &RunArgs, program: &str, seed: u64) -> Vec<String> {
    use clap::ValueEnum as _;
    let name = |value: Option<clap::builder::PossibleValue>| value.map(|value| value.get_name().to_owned());
    let mut words = vec![program.to_owned(), "--seed".into(), seed.to_string()];
    words.extend(["--watchdog-s".into(), asked.watchdog_s.to_string()]);
    words.extend(name(asked.trace.to_possible_value()).into_iter().flat_map(|form| ["--trace".into(), form]));
    words.extend(
        name(asked.clock.to_possible_value()).into_iter().flat_map(|clock| ["--clock".into(), clock]),
    );
    words.extend(asked.pace.iter().flat_map(|pace| ["--pace".into(), pace.to_string()]));
    words.extend(asked.gauge.gauge.iter().flat_map(|gauge| ["--gauge".into(), gauge.clone()]));
    words
}

/// A run on another computer, seen from here.
struct Far<'a> {
    setup: &'a Setup,
    link: Link,
    interrupts: &'a mut Interrupts,
    wish: Wish,
    at: &'a str,
    quiet: bool,
    /// The machine there has started.
    started: bool,
    /// The link has its place in the machine: what is pressed from here on arrives.
    joined: bool,
    /// When the interpreter was looked at last, and what it had used of a processor then, ticks.
    worked: (Moment, u64),
}

impl Far<'_> {
    /// From the first word to the outcome.
    fn run(&mut self, words: &[String]) -> Result<Value, CliError> {
        while !matches!(self.hears()?, Some(Said::Welcome { .. })) {}
        let folder = &self.setup.folder;
        let (path, files) = (folder.path.clone(), folder.made_of());
        self.link.heard.tell(&Told::Send { folder: path, files, words: words.to_vec() })?;
        while !matches!(self.hears()?, Some(Said::Started)) {}
        self.started = true;
        let mut space = NameSpace::create(&axes(&self.setup.machine))?;
        let host = Host { name: Process::Interpreter.name(), modules: vec![Process::Interpreter] };
        let mut interpreter = Started::start(self.setup, &space.address(), host)?;
        self.link.heard.tell(&Told::Join { address: space.address(), real: false })?;
        self.joined = true;
        let deadline = Moment::in_s(START_S);
        while space.missing(&[])?.iter().any(|process| HERE.contains(process)) {
            self.hears()?;
            lives(&mut interpreter)?;
            if deadline.passed() {
                return Err(CliError::Machine(
                    "the interpreter did not connect; run `pitchlock doctor`".into(),
                ));
            }
        }
        space.start()?;
        let mut over = false;
        loop {
            self.tells_of_work(&interpreter)?;
            if let Some(Said::Outcome(value)) = self.hears()? {
                return Ok(value);
            }
            if !over {
                lives(&mut interpreter)?;
                if !space.unfinished()?.iter().any(|process| HERE.contains(process)) {
                    space.end()?;
                    over = true;
                }
            }
        }
    }

    /// An interpreter that computes has no deadline, and nobody there sees that it does.
    fn tells_of_work(&mut self, interpreter: &Started) -> Result<(), CliError> {
        let (asked, before) = self.worked;
        if asked.elapsed() < WORKS {
            return Ok(());
        }
        let now = used(interpreter.pid()).unwrap_or(before);
        self.worked = (Moment::now(), now);
        if now > before + 1 { self.link.heard.tell(&Told::Computes) } else { Ok(()) }
    }

    /// What the link says next, if anything; and it hears what is pressed here.
    fn hears(&mut self) -> Result<Option<Said>, CliError> {
        self.looks_at_the_keyboard()?;
        match self.link.heard.hears() {
            Ok(Some(Said::Refused(text))) => Err(CliError::Input(text)),
            Ok(Some(Said::Why(text))) | Err(text) => Err(self.lost(&text)),
            Ok(Some(Said::Note(text))) if !self.quiet => {
                words::say(&format!("{text}\n"));
                Ok(None)
            }
            Ok(said) => Ok(said),
        }
    }

    /// What is said when nothing more will come.
    fn lost(&self, why: &str) -> CliError {
        let help = match self.started {
            true => {
                "the machine there comes to rest by itself: a tool in a thread cuts its pass to the end, or leaves it; the \
                 run folder there says which"
            }
            false => {
                "the machine there had not started, and nothing has moved: see what `pitchlock serve` says there"
            }
        };
        CliError::Machine(format!("the link to {} is lost: {why}\nhelp: {help}", self.at))
    }

    fn looks_at_the_keyboard(&mut self) -> Result<(), CliError> {
        let wish = self.interrupts.wish();
        if wish == self.wish {
            return Ok(());
        }
        let before = std::mem::replace(&mut self.wish, wish);
        if !self.joined {
            return Err(CliError::Machine("interrupted while the machine was starting".into()));
        }
        wish.words(before).for_each(|text| words::say(&format!("{text}\n")));
        match wish {
            Wish::None => {}
            Wish::Stop => self.link.heard.tell(&Told::Press(1))?,
            Wish::EmergencyStop => self.link.heard.tell(&Told::Press(2))?,
            Wish::End => return Err(self.lost("it was broken off here")),
        }
        Ok(())
    }
}

/// Whether the interpreter lives, or has ended well.
fn lives(interpreter: &mut Started) -> Result<(), CliError> {
    match interpreter.has_ended()? {
        true => Err(CliError::Machine(format!("the interpreter {}", interpreter.ending()))),
        false => Ok(()),
    }
}
