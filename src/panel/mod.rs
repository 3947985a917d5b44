//! `pitchlock panel`: a machine with its panel in a browser. Between runs it waits for somebody who starts
//! one.

mod args;
mod by_hand;
pub(crate) mod hand;
mod homing;
mod jog;
mod known;
mod live;
mod lost;
mod mode;
mod opened;
mod origins;
mod plan;
mod playback;
mod said;
mod scope;
mod session;
mod tables;
mod terminal;
mod tool;
mod view;
mod web;
mod wish;

use std::{
    fs::File,
    io::Write as _,
    net::TcpListener,
    os::{
        fd::AsFd as _,
        unix::{
            fs::{DirBuilderExt as _, MetadataExt as _},
            net::UnixStream,
        },
    },
    path::{Path, PathBuf},
    process::ExitCode,
    sync::Arc,
    time::Duration,
};

use interpreter::Dialect;
use machine::ProgramDialect;
use process::{
    ipc::time::{Moment, sleep_until},
    shell::Pace,
};
use protocol::{Code, Item, code_file::CodeFile};
use serde_json::json;

pub(crate) use args::{BY_HAND, HELP, PanelArgs, PanelCommandArgs};
use known::{Known, MOST_TEXT, Shown, machine_seen, stays};
pub(crate) use live::Live;
use live::fields;
pub(crate) use mode::Mode;
pub(crate) use session::{Presses, Who};
pub(crate) use terminal::{CTRL_C, LOOK};
pub(crate) use web::Server;

use crate::{
    error::CliError,
    run::{self, Prepared, RunArgs, folder::arguments_of, interrupts::Interrupts},
    words, written,
};
use scope::Rows;
use tables::Tables;
use web::Web;
use wish::{Begins, Wish};

/// Between two looks while nothing runs.
const IDLE: Duration = Duration::from_millis(20);

impl Live {
    /// Opens the panel and says where it is.
    pub(crate) fn open(args: &RunArgs, quiet: bool) -> Result<Live, CliError> {
        let web = Web::open(&args.panel)?;
        web.says_where(args.json && !args.with_panel, quiet && !args.with_panel);
        Ok(Live::new(web, args.with_panel, Tables::of(args)?))
    }

    /// Shows the machine and the program that are there before anything runs.
    fn loads(&mut self, asked: &RunArgs, program: Option<&PathBuf>, name: &str) {
        let pace = asked.pace.unwrap_or(Pace::ONE);
        self.stands(fields(&json!({ "machine": machine_seen(self.tables.machine(), pace) })));
        if let Some(program) = program {
            let text = intake::text(program, MOST_TEXT).ok();
            let shown = json!({ "program": {
                "name": name, "text": text, "passes": null, "time_s": null, "folder": null,
            } });
            self.stands(fields(&shown));
        }
    }

    /// Shows a run that is about to begin.
    pub(crate) fn prepared(&mut self, setup: &run::Setup) -> Result<(), CliError> {
        self.begins_by_hand(setup)?;
        // What is pressed before the first cycle meets a machine that is on.
        self.mode = if setup.by_hand { Mode::Mdi } else { Mode::Auto };
        let run = Shown::begins(setup);
        let (program, machine) = stays(&run, &setup.program.observer(&setup.machine));
        self.rows = Rows::of(&setup.machine);
        self.begins(&program, &machine, Known::of(&run));
        let begun = self.tables.begun(&setup.folder.language);
        self.shows_tables(begun);
        Ok(())
    }
}

/// Runs the program as often as somebody starts it.
pub(crate) fn panel(args: &PanelCommandArgs, quiet: bool) -> Result<ExitCode, CliError> {
    let asked = &args.run;
    if args.terminal || args.join {
        return terminal::terminal(args);
    }
    let looked = if args.led { terminal::led()? } else { Arc::default() };
    if asked.with_panel {
        return Err(CliError::Input("--panel is for run; leave it out".into()));
    }
    if asked.resume {
        return Err(CliError::Input("--resume is for run: pitchlock run RUN_DIR --resume".into()));
    }
    if let (Some(at), Some(key)) = (&asked.far.at, &asked.far.key) {
        return run::hosts::panel_at(asked, (at, key), quiet);
    }
    if args.there {
        return at_the_machine(&there(asked)?, quiet, |asked| {
            Ok(Live::new(Web::there(looked)?, false, Tables::of(asked)?))
        });
    }
    if asked.program.is_dir() {
        return playback::playback(asked, quiet);
    }
    if opened::is_trace(&asked.program) {
        return opened::opened(asked, quiet);
    }
    at_the_machine(asked, quiet, |asked| Live::open(asked, quiet))
}

/// The arguments of a panel on another computer, whose files have come into the folder of the program.
fn there(asked: &RunArgs) -> Result<RunArgs, CliError> {
    match (asked.program.parent(), asked.program.file_name()) {
        (Some(folder), Some(name)) if asked.program.as_os_str() != args::BY_HAND => {
            arguments_of(asked, folder, name)
        }
        _ => Ok(asked.clone()),
    }
}

/// The same with a machine, whose panel is opened when the input has been judged.
fn at_the_machine(
    asked: &RunArgs,
    quiet: bool,
    open: impl FnOnce(&RunArgs) -> Result<Live, CliError>,
) -> Result<ExitCode, CliError> {
    // Whatever is wrong with the input is said before there is a panel.
    let loaded = asked.program.as_os_str() != args::BY_HAND;
    let empty = Empty::new(asked)?;
    let mut by_hand = RunArgs { program: empty.path.clone(), by_hand: true, ..asked.clone() };
    let (program, dialect, _) = run::judged(if loaded { asked } else { &by_hand })?;
    if loaded {
        // Whoever has read the program goes on in its language.
        by_hand.language.dialect = Some(match dialect {
            Dialect::Linuxcnc => ProgramDialect::Linuxcnc,
            Dialect::Fanuc | Dialect::FanucMill => ProgramDialect::Fanuc,
        });
    }
    let mut begins = Begins::at(asked, asked.from)?;
    asked.out.as_deref().map_or(Ok(()), written::empty)?;
    let name = program.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let mut interrupts = Some(Interrupts::catch()?);
    let mut live = open(asked)?;
    let hint = if loaded {
        format!("{name} is loaded; start starts it")
    } else {
        "switch it on, to work by hand".into()
    };
    let (mut said, mut used) = (hint.clone(), false);
    live.loads(asked, loaded.then_some(&program), &name);
    loop {
        live.shows_tables(live.tables.kept());
        live.shows_begins(&begins);
        let ready = json!({ "state": "ready", "mode": "off", "words": said });
        live.stands(fields(&ready));
        let wish = loop {
            match live.wish(loaded) {
                Some(Wish::From(ticket, line)) => live.chooses(ticket, asked, line, &mut begins),
                Some(wish) => break wish,
                None => {}
            }
            if interrupts.as_mut().is_some_and(Interrupts::is_wished) {
                return Ok(ExitCode::SUCCESS);
            }
            sleep_until(Moment::now().after(IDLE));
        };
        let out = asked.out.as_deref().map(|out| next(out, used));
        let ended = if wish == Wish::Hand {
            let by_hand = RunArgs { out: out.clone(), ..by_hand.clone() };
            let ended = one_run(&by_hand, quiet, &mut interrupts, &mut live);
            // What was by hand is over, and the program is what start starts.
            live.loads(asked, loaded.then_some(&program), &name);
            ended
        } else {
            // The start behind this one begins at the beginning.
            let from = std::mem::take(&mut begins);
            let begun = RunArgs { from: from.line, out: out.clone(), ..asked.clone() };
            from.is_as_shown(asked).and_then(|()| one_run(&begun, quiet, &mut interrupts, &mut live))
        };
        used |= out.is_some_and(|out| out.exists());
        said = match ended {
            Ok(()) => hint.clone(),
            Err(error) => {
                words::say(&format!("error: {error}\n"));
                format!("it was not run: {error}")
            }
        };
        interrupts.iter_mut().for_each(Interrupts::forget);
    }
}

/// The run folder of the next run: the one that was named, and once that is used `OUT-2` and so on.
fn next(out: &Path, used: bool) -> PathBuf {
    let numbered = |number: u32| {
        let mut name = out.as_os_str().to_owned();
        name.push(format!("-{number}"));
        PathBuf::from(name)
    };
    let mut more = (2..).map(numbered).filter(|path| !path.exists());
    more.next().filter(|_| used).unwrap_or_else(|| out.to_owned())
}

/// One run, from its beginning to its end.
fn one_run(
    asked: &RunArgs,
    quiet: bool,
    interrupts: &mut Option<Interrupts>,
    live: &mut Live,
) -> Result<(), CliError> {
    let prepared = Prepared::of(asked, quiet, interrupts, true)?;
    prepared.go(quiet, interrupts, Some(live)).map(drop)
}

/// The program of work by hand before anything is given: it waits. It lies in a folder of its own, which goes
/// with it; that of a panel that was killed goes with the next one. A lock on the file says that its panel
/// lives.
struct Empty {
    path: PathBuf,
    _lives: File,
}

/// What such a folder is called before its number.
const FOLDER: &str = "pitchlock-by-hand-";

/// Removes what panels of this user have left that were killed. What is another user's, a link, held, or
/// holds anything else, stays.
fn sweep(temporary: &Path, own: u32) {
    let Ok(entries) = std::fs::read_dir(temporary) else { return };
    for entry in entries.flatten() {
        let folder = entry.path();
        let named = entry.file_name().to_str().is_some_and(|name| name.starts_with(FOLDER));
        let Ok(found) = std::fs::symlink_metadata(&folder) else { continue };
        if !(named && found.is_dir() && found.uid() == own) {
            continue;
        }
        let path = folder.join(args::BY_HAND);
        if File::open(&path).is_ok_and(|file| file.try_lock().is_ok()) && std::fs::remove_file(&path).is_ok()
        {
            // Whatever else is in it keeps it.
            let _ = std::fs::remove_dir(&folder);
        }
    }
}

impl Empty {
    fn new(asked: &RunArgs) -> Result<Empty, CliError> {
        let (machine, _) = asked.machine.read()?;
        // A name that nobody can foresee, and take.
        let name = format!("{FOLDER}{:016x}", intake::unforeseen());
        let temporary = std::env::temp_dir();
        let folder = temporary.join(name);
        let path = folder.join(args::BY_HAND);
        let failed =
            |error: &dyn std::fmt::Display| CliError::Machine(format!("{}: {error}", path.display()));
        std::fs::DirBuilder::new().mode(0o700).create(&folder).map_err(|error| failed(&error))?;
        let made = std::fs::symlink_metadata(&folder).map_err(|error| failed(&error))?;
        sweep(&temporary, made.uid());
        let items = vec![hand::BEGINS, Item { line: 0, code: Code::End }];
        let file = CodeFile::new(args::BY_HAND, &machine.identity(), items);
        let mut bytes = Vec::new();
        file.write(&mut bytes).map_err(|error| failed(&error))?;
        // It gets its name when it is held: before, it would be taken for one that was left.
        let unnamed = folder.join("new");
        let mut lives = File::create_new(&unnamed).map_err(|error| failed(&error))?;
        lives.lock().map_err(|error| failed(&error))?;
        lives.write_all(&bytes).map_err(|error| failed(&error))?;
        std::fs::rename(&unnamed, &path).map_err(|error| failed(&error))?;
        Ok(Empty { path, _lives: lives })
    }
}

impl Drop for Empty {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.path);
        self.path.parent().into_iter().for_each(|folder| {
            let _ = std::fs::remove_dir(folder);
        });
    }
}

/// The process of the panel, as the launcher starts it: its standard input is the link to the launcher, its
/// standard output the socket on which it listens.
pub(crate) fn server() -> Result<ExitCode, CliError> {
    let wrong = |error: std::io::Error| CliError::Machine(format!("panel-server: {error}"));
    let link = std::io::stdin().as_fd().try_clone_to_owned().map_err(wrong)?;
    let listener = std::io::stdout().as_fd().try_clone_to_owned().map_err(wrong)?;
    ::panel::serve(TcpListener::from(listener), UnixStream::from(link), scope::saved).map_err(wrong)?;
    Ok(ExitCode::SUCCESS)
}

#[cfg(test)]
mod tests {
    use super::next;

    #[test]
    fn each_run_behind_the_first_one_has_a_folder_of_its_own() {
        let place = tempfile::tempdir().expect("a folder");
        let out = place.path().join("made");
        assert_eq!(next(&out, false), out);
        for name in ["made", "made-2", "made-3"] {
            std::fs::create_dir(place.path().join(name)).expect("a folder");
        }
        assert_eq!(next(&out, true), place.path().join("made-4"));
        assert_eq!(next(&out, false), out, "one that is there already is refused by name");
    }
}
