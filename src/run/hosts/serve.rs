//! `pitchlock serve`: the machine is here, and waits for programs of another computer. In: a machine file, an
//! address, a key. Out: a run as any other, whose interpreter is far away; its run folder lies here.

use std::{
    cell::RefCell,
    fs,
    io::ErrorKind,
    net::{IpAddr, Ipv4Addr, TcpListener},
    os::fd::OwnedFd,
    path::{Path, PathBuf},
    process::{ExitCode, Stdio},
    rc::Rc,
    time::Duration,
};

use clap::{Args, Parser as _};
use process::{
    ipc::{computer, time::Moment},
    link::{CHANGED, Said, Told},
};
use serde_json::{Value, json};

use super::{Link, command, file::Compared, seen, stand};
use crate::{
    args::MachineArgs,
    cli::{Cli, Command},
    error::CliError,
    run::{Prepared, RunArgs, axes, ended::Ended, folder::arguments_of, interrupts::Interrupts},
    screen,
    temporary::Temporary,
    words,
};

/// What folders for what comes are called.
const FOLDER: &str = "serve";
/// Most bytes of a file with a key.
const KEY: u64 = 4096;
/// Who is to end waits so long for whoever wants to know how the last run has ended, and then so long until
/// the answer is on its way.
const FETCHED: Duration = Duration::from_secs(5);
const ON_ITS_WAY: Duration = Duration::from_millis(300);

pub(crate) const HELP: &str = "Examples:
  pitchlock-link key shop.key                                  a key; copy it to the other computer
  pitchlock serve --machine lathe.toml --key shop.key --listen 10.0.0.2:7447
  pitchlock run part.ngc --machine lathe.toml --key shop.key --at 10.0.0.2:7447      there
  pitchlock panel part.ngc --machine lathe.toml --key shop.key --at 10.0.0.2:7447    there, in a browser

Both have the same machine file and the same pitchlock, or nothing moves. Run folders are made here, as those of
`pitchlock run`; the summary is told on both. Ctrl-C stops a run, and between runs ends this; SIGTERM does
both.";

#[derive(Clone, Debug, Args)]
pub(crate) struct ServeArgs {
    #[command(flatten)]
    pub(super) machine: MachineArgs,
    /// Address at which the other computer calls: one of this computer, on a network that nobody else is on.
    #[arg(long, value_name = "HOST:PORT", default_value = "127.0.0.1:7447")]
    listen: String,
    /// File with the key that both computers have (`pitchlock-link key FILE` makes one).
    #[arg(long, value_name = "FILE")]
    key: PathBuf,
}

/// What may be asked for from another computer, by a panel the last one as well; each has a value.
const ALLOWED: [&str; 7] = ["--seed", "--trace", "--clock", "--pace", "--gauge", "--watchdog-s", "--from"];

/// What somebody at another computer wants.
enum Wanted {
    /// A run of this name.
    Run(String, Vec<String>),
    /// To stand at the machine.
    Panel(Vec<String>),
}

/// The address at which the other computer calls, from here on until this process ends, and its name.
fn listens(address: &str) -> Result<(TcpListener, String), CliError> {
    let wrong = |error: std::io::Error| {
        let help = match error.kind() {
            ErrorKind::AddrInUse => {
                "another program listens there: `ss -ltnp` names it, or take another port; pitchlock-link of a `pitchlock \
                 serve` that was killed goes when its machine has come to rest: wait for that"
            }
            ErrorKind::AddrNotAvailable => "it is not an address of this computer: `ip address` lists those",
            ErrorKind::PermissionDenied => {
                "a port below 1024 is for an administrator: take another one, as 7447"
            }
            ErrorKind::InvalidInput => "HOST:PORT, an address of this computer, as in 10.0.0.2:7447",
            _ => "no computer of this name is known here: give an address of this one, as in 10.0.0.2:7447",
        };
        CliError::Input(format!("--listen {address}: {error}\nhelp: {help}"))
    };
    let listener = TcpListener::bind(address).map_err(wrong)?;
    let here = listener.local_addr().map_err(wrong)?;
    let all = here.ip() == IpAddr::V4(Ipv4Addr::BROADCAST) || here.ip().is_multicast();
    // Nobody can call there.
    if all { Err(wrong(ErrorKind::AddrNotAvailable.into())) } else { Ok((listener, here.to_string())) }
}

/// Refuses a run where the machine file is another one than that which whoever asked has compared.
pub(super) fn is_as_compared(args: &ServeArgs, compared: &str) -> Result<(), CliError> {
    if super::compared(&args.machine)? == compared {
        return Ok(());
    }
    Err(CliError::Input(CHANGED.into()))
}

/// Waits for programs, and runs them.
pub(crate) fn serve(args: &ServeArgs, quiet: bool) -> Result<ExitCode, CliError> {
    let mut file = Compared::read(&args.machine)?;
    // A limit stays while this waits, and the link needs files as well.
    computer::allow_files(computer::files(&axes(&args.machine.read()?.0)))?;
    let (listener, here) = listens(&args.listen)?;
    let mut interrupts = Some(Interrupts::catch()?);
    // Whoever has asked for a run hears how it has ended, whatever becomes of files meanwhile.
    let (key, mut outcome) = (intake::text(&args.key, KEY).ok(), None);
    let (mut told, mut leaves, mut owed) = (false, false, None);
    loop {
        let incoming = if told { again()? } else { Temporary::new(FOLDER)? };
        let mut command = command("lower", &file.hash, &args.key)?;
        command.arg("--into").arg(incoming.path());
        let address = listener.try_clone().map_err(|error| CliError::Machine(error.to_string()))?;
        let mut link = Link::start(command, Stdio::from(OwnedFd::from(address)))?;
        // The first one says what is wrong with the file.
        let key = key.clone().filter(|_| told);
        link.heard.tell(&Told::Before { key, outcome: outcome.clone() })?;
        if file.compared().is_none() {
            link.heard.tell(&Told::Compared(None))?;
        }
        let told = (!std::mem::replace(&mut told, true) && !quiet).then_some(&*here);
        let waits = Waits { file: &mut file, incoming: incoming.path(), told, leaves, owed };
        let (link, wanted, compared) = match waits.asked_for(link, &mut interrupts)? {
            Came::Wanted(link, wanted, compared) => (link, wanted, compared),
            Came::Lost if leaves => return Ok(ExitCode::SUCCESS),
            Came::Lost => continue,
            Came::Enough => return Ok(ExitCode::SUCCESS),
        };
        match wanted {
            Wanted::Run(run, words) => {
                let asked = (incoming.path(), &*words, &*compared);
                outcome = Some(one_run(args, (&run, asked), link, quiet, &mut interrupts));
                owed = Some(Moment::now().after(FETCHED));
                leaves = interrupts.as_mut().is_some_and(Interrupts::ends);
            }
            Wanted::Panel(words) => {
                let asked = (incoming.path(), &*words, &*compared);
                if let Err(error) = stand::stand(args, &file.name, asked, link, &mut interrupts) {
                    words::say(&format!("error: {error}\n"));
                }
                if interrupts.as_mut().is_some_and(Interrupts::ends) {
                    return Ok(ExitCode::SUCCESS);
                }
            }
        }
        interrupts.iter_mut().for_each(Interrupts::forget);
        file.has_changed();
    }
}

/// Another folder for what comes. Where somebody has removed the one for all temporary files, that is made
/// anew.
fn again() -> Result<Temporary, CliError> {
    Temporary::new(FOLDER).or_else(|error| match fs::create_dir_all(std::env::temp_dir()) {
        Ok(()) => Temporary::new(FOLDER),
        Err(_) => Err(error),
    })
}

/// What came of waiting.
enum Came {
    /// Somebody asks for something, with the hash of the machine file that was compared for it.
    Wanted(Link, Wanted, String),
    /// The process of the link has ended, for no reason that would end another one.
    Lost,
    /// Nothing is wanted any more.
    Enough,
}

/// What is known while nobody asks for anything.
struct Waits<'a, 'b> {
    file: &'a mut Compared<'b>,
    /// Where files come.
    incoming: &'a Path,
    /// The address, if it is to be told when the link listens.
    told: Option<&'a str>,
    /// Nothing more is to begin.
    leaves: bool,
    /// So long whoever asked for the last run may not yet know how that has ended.
    owed: Option<Moment>,
}

impl Waits<'_, '_> {
    /// Waits until somebody asks for something.
    fn asked_for(mut self, mut link: Link, interrupts: &mut Option<Interrupts>) -> Result<Came, CliError> {
        let mut listened = false;
        loop {
            // What it said last may still be on its way when it has ended.
            let is_over = link.is_over();
            let said = if is_over { link.says_last() } else { link.says() };
            match said {
                Some(Said::Listening) => {
                    listened = true;
                    self.told
                        .iter()
                        .for_each(|address| words::say(&format!("the machine waits at {address}\n")));
                }
                Some(Said::Run { .. } | Said::Panel { .. }) if self.leaves => {
                    link.heard.tell(&Told::Refuse("the machine is switched off there".into()))?;
                }
                Some(Said::Fetched) => {
                    self.owed = Some(Moment::now().after(ON_ITS_WAY));
                }
                Some(Said::Run { run, words, compared }) => {
                    return Ok(Came::Wanted(link, Wanted::Run(run, words), compared));
                }
                Some(Said::Panel { words, compared }) => {
                    return Ok(Came::Wanted(link, Wanted::Panel(words), compared));
                }
                Some(Said::Look) => link.heard.shows(seen::off(&self.file.name)),
                Some(Said::Note(text)) => words::say(&format!("{text}\n")),
                Some(Said::Refused(text)) => return Err(CliError::Input(text)),
                Some(Said::Why(text)) if !listened => return Err(CliError::Machine(text)),
                Some(Said::Why(text)) => words::say(&format!("{}: {text}\n", super::LINK)),
                Some(_) => {}
                None if is_over && listened => {
                    words::say(&format!("{} has ended: another one waits for programs\n", super::LINK));
                    return Ok(Came::Lost);
                }
                None if is_over => {
                    return Err(CliError::Machine(format!("{} ended without a reason", super::LINK)));
                }
                None => {}
            }
            self.leaves |= interrupts.as_mut().is_some_and(Interrupts::is_wished);
            if self.leaves && self.owed.is_none_or(|owed| owed.passed()) {
                link.end();
                return Ok(Came::Enough);
            }
            if self.file.is_due() && !self.is_as_it_was(&mut link)? {
                link.end();
                return Ok(Came::Lost);
            }
        }
    }

    /// Looks at what others may change while nothing runs; whether the link can go on.
    fn is_as_it_was(&mut self, link: &mut Link) -> Result<bool, CliError> {
        if self.file.has_changed() {
            link.heard.tell(&Told::Compared(self.file.compared()))?;
        }
        let is_there = self.incoming.exists();
        if !is_there {
            let folder = self.incoming.display();
            words::say(&format!("{folder} was removed: another one waits for programs\n"));
        }
        Ok(is_there)
    }
}

fn refused(text: impl std::fmt::Display) -> CliError {
    CliError::Input(format!("{text}\nhelp: install the same pitchlock on both"))
}

/// The options behind the program, which is checked by whoever knows whether there has to be one.
pub(super) fn options(words: &[String], most: usize) -> Result<(&String, &[String]), CliError> {
    let (program, options) = words.split_first().ok_or_else(|| refused("no program"))?;
    let (pairs, rest) = options.as_chunks::<2>();
    if let Some([option, _]) = pairs.iter().find(|[option, _]| !ALLOWED[..most].contains(&option.as_str())) {
        return Err(refused(format!("{option} is not for another computer")));
    }
    if rest.is_empty() { Ok((program, options)) } else { Err(refused("the run is not whole")) }
}

/// A program that lies in this folder.
pub(super) fn program_in(folder: &Path, program: &str) -> Result<PathBuf, CliError> {
    let is_name = Path::new(program).file_name().is_some_and(|name| name == program);
    let path = folder.join(program);
    if is_name && path.is_file() { Ok(path) } else { Err(refused("the run is not whole")) }
}

/// The arguments of a run of files that lie in this folder.
fn arguments(args: &ServeArgs, folder: &Path, words: &[String]) -> Result<RunArgs, CliError> {
    let (program, options) = options(words, ALLOWED.len() - 1)?;
    program_in(folder, program)?;
    let line = ["pitchlock", "run", "program"].into_iter().chain(options.iter().map(String::as_str));
    let parsed = Cli::try_parse_from(line).map_err(refused)?;
    let Command::Run(run) = parsed.command else { return Err(refused("no run")) };
    let run = RunArgs { machine: args.machine.clone(), ..run };
    let run = arguments_of(&run, folder, program.as_ref())?;
    // Its folder is named after the program.
    Ok(run)
}

/// One run, and what became of it, for whoever asked.
fn one_run(
    args: &ServeArgs,
    (run, asked): (&str, (&Path, &[String], &str)),
    link: Link,
    quiet: bool,
    interrupts: &mut Option<Interrupts>,
) -> Value {
    // Whoever starts the processes takes it.
    let link = Rc::new(RefCell::new(Some(link)));
    match summed_up(args, asked, &link, quiet, interrupts) {
        Ok(ended) => {
            let folder = ended.folder.canonicalize().unwrap_or_else(|_| ended.folder.clone());
            let unwritten = ended.unwritten.as_ref().map(|error| screen::plain(&error.to_string()));
            let value =
                json!({ "run": run, "folder": folder, "summary": ended.summary, "unwritten": unwritten });
            if let Err(error) = ended.tells(quiet) {
                words::say(&format!("error: {error}\n"));
            }
            value
        }
        Err(error) => {
            words::say(&format!("error: {error}\n"));
            let text = screen::plain(&error.to_string());
            if let Some(mut link) = link.take() {
                // One that has just ended hears nothing of it, and is asked no more.
                let _ = link.heard.tell(&Told::Refuse(text.clone()));
                link.end();
            }
            json!({ "run": run, "error": text })
        }
    }
}

/// What came of it.
fn summed_up(
    args: &ServeArgs,
    (folder, words, compared): (&Path, &[String], &str),
    link: &Rc<RefCell<Option<Link>>>,
    quiet: bool,
    interrupts: &mut Option<Interrupts>,
) -> Result<Ended, CliError> {
    is_as_compared(args, compared)?;
    let run = arguments(args, folder, words)?;
    let mut prepared = Prepared::of(&run, quiet, interrupts, false)?;
    prepared.setup.link = Rc::clone(link);
    prepared.stays = true;
    prepared.runs(interrupts, None)
}
