//! The run folder: everything that a run was made of, and everything it left.

use std::collections::BTreeMap;
use std::ffi::{OsStr, OsString};
use std::hash::{DefaultHasher, Hasher as _};
use std::io::Read as _;
use std::path::{Path, PathBuf};

use interpreter::Language;
use machine::Machine;
use process::shell::LanguageArgs;
use protocol::{Item, code_file::CodeFile};
use rig::{observe::Summary, trace};

use super::args::{RunArgs, Trace};
use super::claim::{Claim, SUMMARY, is_claimed, is_held};
use super::journal::JOURNAL;
use super::moment::{LIVE, MOMENT};
use crate::{error::CliError, program::Program};

/// A run folder and the copies in it.
pub(crate) struct RunFolder {
    /// The folder.
    pub(crate) path: PathBuf,
    /// The program as the user named it.
    pub(crate) named: String,
    /// Copy of the program.
    pub(crate) program: PathBuf,
    /// How it is read; the tool table is a copy as well.
    pub(crate) language: Language,
    /// Copy of the machine file.
    pub(crate) machine: PathBuf,
    /// Copy of the scenario.
    pub(crate) scenario: Option<PathBuf>,
    /// Form of the trace.
    pub(crate) trace: Option<trace::Format>,
    /// Whether it has every cycle of a long run.
    pub(crate) every_cycle: bool,
    /// Hash of all that decides what the program does.
    pub(crate) input: [u8; 16],
    /// BLAKE3 of each of these and of the scenario, in hex, by its name.
    pub(crate) hashes: BTreeMap<String, String>,
    /// What the copy of the program held before the run.
    stamp: Option<u64>,
    /// Held as long as the run writes into the folder.
    _claim: Claim,
}

const LANGUAGE: &str = "language.toml";
const TOOLS: &str = "tool.tbl";
const PARAMETERS: &str = "parameters.var";
const INI: &str = "machine.ini";
pub(crate) const MACHINE: &str = "machine.toml";
const SCENARIO: &str = "scenario.toml";
/// The folder in it of the run that it goes on with: all that is needed to make that one again.
pub(crate) const BEFORE: &str = "before";
/// What reached the modules of a run otherwise than in lock step.
pub(crate) const ARRIVALS: &str = "arrivals.txt";
/// What somebody has pressed in a run, as events of a scenario.
pub(crate) const PRESSES: &str = "presses.toml";
/// What a run leaves, and names under which that is written.
const RESULTS: [&str; 14] = [
    "summary.json",
    "report.html",
    "trace.mcap",
    "trace.csv",
    JOURNAL,
    ARRIVALS,
    PRESSES,
    "summary.json.new",
    "report.html.new",
    "journal.bin.new",
    "arrivals.txt.new",
    MOMENT,
    LIVE,
    BEFORE,
];

impl RunFolder {
    /// Makes the folder and copies the input into it. A folder that is there already has to be empty: what is
    /// in it is another run, or something that no run may touch.
    pub(crate) fn create(
        args: &RunArgs,
        judged: &Program,
        machine: &str,
        scenario: Option<&str>,
        seen: &Seen,
    ) -> Result<RunFolder, CliError> {
        let name = args.program.file_name().unwrap_or_else(|| "program.ngc".as_ref());
        let part_name = Path::new(name).with_extension("toml");
        for (from, to, what) in
            [(Some(&args.program), Path::new(name), "job"), (judged.part_file.as_ref(), &part_name, "part")]
        {
            from.map_or(Ok(()), |from| refuse_kept(from, to, what))?;
        }
        let claim = Claim::new(args, judged.watched.len())?;
        let path = claim.path.clone();
        let program = path.join(name);
        copy(&args.program, &program)?;
        if let Some(file) = &judged.part_file {
            copy(file, &path.join(part_name))?;
        }
        for file in judged.subroutine_files() {
            copy(file, &path.join(file.file_name().unwrap_or_default()))?;
        }
        let keep = |from: &Option<PathBuf>, name: &str| {
            let from = from.as_ref().filter(|from| from.exists());
            from.map(|from| copy(from, &path.join(name)).map(|()| path.join(name))).transpose()
        };
        let asked = args.language.language();
        let [tools, parameters, ini] =
            [keep(&asked.tools, TOOLS)?, keep(&asked.parameters, PARAMETERS)?, keep(&asked.ini, INI)?];
        let copies = [Some(&program), tools.as_ref(), parameters.as_ref(), ini.as_ref()];
        seen.compare(args, copies)?;
        let language = Language { tools, parameters, ini, subroutines: Vec::new(), ..asked };
        let write = |name: &str, text: &str| {
            let path = path.join(name);
            let written = intake::replace(&path, text.as_bytes());
            written.map(|()| path.clone()).map_err(|error| CliError::file(&path, error))
        };
        if language != Language::default() {
            let kept = Language { tools: None, parameters: None, ini: None, ..language.clone() };
            let text = toml::to_string(&kept).map_err(|error| CliError::Machine(error.to_string()))?;
            write(LANGUAGE, &text)?;
        }
        let machine = write(MACHINE, machine)?;
        let scenario = scenario.map(|text| write(SCENARIO, text)).transpose()?;
        let trace = match args.trace {
            Trace::Mcap | Trace::Full => Some(trace::Format::Mcap),
            Trace::Csv | Trace::FullCsv => Some(trace::Format::Csv),
            Trace::None => None,
        };
        let every_cycle = matches!(args.trace, Trace::Full | Trace::FullCsv);
        let named = args.program.display().to_string();
        let (input, hashes) = hashes(deciding(&path, judged, name))?;
        Ok(RunFolder {
            named,
            program,
            language,
            machine,
            scenario,
            trace,
            every_cycle,
            input,
            hashes,
            path,
            stamp: seen.0[0],
            _claim: claim,
        })
    }

    /// The program of work by hand is what came of it: the run can be made again.
    pub(crate) fn holds_what_was_given(
        &mut self,
        items: Vec<Item>,
        machine: &Machine,
    ) -> Result<(), CliError> {
        let (path, name) = (&self.program, self.program.file_name().unwrap_or_default().to_string_lossy());
        let mut bytes = Vec::new();
        let file = CodeFile::new(&name, &machine.identity(), items);
        file.write(&mut bytes).map_err(|error| CliError::file(path, error))?;
        intake::replace(path, &bytes).map_err(|error| CliError::file(path, error))?;
        let hash = rig::hash::hex_of_file(path).map_err(|error| CliError::file(path, error))?;
        self.hashes.insert(name.into_owned(), hash);
        Ok(())
    }

    /// Names of the files that the run is made of.
    pub(crate) fn made_of(&self) -> Vec<String> {
        let files = std::fs::read_dir(&self.path).into_iter().flatten().flatten();
        let mut names: Vec<String> = files.filter_map(|file| file.file_name().into_string().ok()).collect();
        names.retain(|name| !RESULTS.contains(&name.as_str()) && self.path.join(name).is_file());
        names.sort();
        names
    }

    /// The same without the machine file, and without tables: of a machine that has its own.
    pub(crate) fn program_is_made_of(&self) -> Vec<String> {
        let mut names = self.made_of();
        names.retain(|name| ![MACHINE, TOOLS, PARAMETERS, INI].contains(&name.as_str()));
        names
    }

    /// Whether the program is what it was when the run began.
    pub(crate) fn is_as_it_was(&self) -> bool {
        stamp(&self.program).is_ok_and(|stamp| Some(stamp) == self.stamp)
    }
}

/// The files in a run folder that decide what its program does, and what happens to it.
fn deciding(folder: &Path, judged: &Program, name: &OsStr) -> Vec<PathBuf> {
    let part = judged.part_file.as_ref().map(|_| Path::new(name).with_extension("toml").into_os_string());
    let subroutines = judged.subroutine_files().filter_map(|file| file.file_name().map(OsStr::to_owned));
    let kept = [MACHINE, LANGUAGE, TOOLS, PARAMETERS, INI, SCENARIO].map(OsString::from);
    let names = std::iter::once(name.to_owned()).chain(part).chain(subroutines).chain(kept);
    names.map(|name| folder.join(name)).filter(|path| path.exists()).collect()
}

/// The hash of all deciding files together, and, in hex, that of each by its name.
fn hashes(deciding: Vec<PathBuf>) -> Result<([u8; 16], BTreeMap<String, String>), CliError> {
    let hashed = |path: PathBuf| match rig::hash::of_file(&path) {
        Ok(hash) => Ok((path, hash)),
        Err(error) => Err(CliError::file(&path, error)),
    };
    let deciding = deciding.into_iter().map(hashed).collect::<Result<Vec<_>, CliError>>()?;
    let name = |path: &PathBuf| path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let each = deciding.iter().map(|(path, hash)| (name(path), hash.to_hex().to_string()));
    Ok((rig::journal::fingerprint(&deciding), each.collect()))
}

/// The files of a run that hold something else now than they did in it, or cannot be read any more.
pub(crate) fn changed(folder: &Path, summary: &Summary) -> Vec<String> {
    let other = |(name, was): &(&String, &String)| {
        rig::hash::hex_of_file(&folder.join(name)).map_or(true, |hash| hash != **was)
    };
    summary.files.iter().filter(other).map(|(name, _)| name.clone()).collect()
}

/// What the program and the tables beside it held when they were read: what is run is what was judged.
pub(crate) struct Seen([Option<u64>; 4]);

/// The program, tools, parameters, and the description of a machine.
fn read_by(args: &RunArgs) -> [Option<&PathBuf>; 4] {
    let LanguageArgs { tools, parameters, ini, .. } = &args.language;
    [Some(&args.program), tools.as_ref(), parameters.as_ref(), ini.as_ref()]
}

impl Seen {
    /// What they hold now.
    pub(crate) fn of(args: &RunArgs) -> Seen {
        Seen(read_by(args).map(|file| file.and_then(|file| stamp(file).ok())))
    }

    /// Refuses copies that are not of what was read.
    fn compare(&self, args: &RunArgs, copies: [Option<&PathBuf>; 4]) -> Result<(), CliError> {
        for ((file, seen), copy) in read_by(args).into_iter().zip(self.0).zip(copies) {
            if let (Some(file), Some(seen), Some(copy)) = (file, seen, copy)
                && stamp(copy).map_err(|error| CliError::file(copy, error))? != seen
            {
                return Err(CliError::file(file, "was changed while it was checked: run it again"));
            }
        }
        Ok(())
    }
}

/// Refuses a file that would take the name of one that the folder keeps.
fn refuse_kept(from: &Path, to: &Path, what: &str) -> Result<(), CliError> {
    let kept = [MACHINE, SCENARIO, LANGUAGE, TOOLS, PARAMETERS, INI].iter().chain(&RESULTS);
    if kept.into_iter().any(|kept| to == Path::new(kept)) {
        let text = format!("the run folder keeps another file under this name: rename the {what}");
        return Err(CliError::file(from, text));
    }
    Ok(())
}

/// A number that is another one when a file has changed, unless somebody has made it so on purpose.
pub(crate) fn stamp(path: &Path) -> std::io::Result<u64> {
    let (mut file, mut hash, mut block) = (intake::open(path)?, DefaultHasher::new(), [0; 1 << 14]);
    loop {
        match file.read(&mut block)? {
            0 => return Ok(hash.finish()),
            read => hash.write(&block[..read]),
        }
    }
}

/// Copies a file, down to the disk: whoever goes on after a loss of power needs it.
fn copy(from: &Path, to: &Path) -> Result<(), CliError> {
    let copied = || {
        std::fs::copy(from, to)?;
        std::fs::File::open(to)?.sync_all()
    };
    copied().map_err(|error| CliError::file(to, error))
}

impl RunFolder {
    /// Arguments that tell the interpreter how to read the program.
    pub(crate) fn language_args(&self) -> Vec<OsString> {
        // Strictness was asked for when the program was judged.
        let Language { dialect, block_delete, strict: _, tools, parameters, ini, subroutines: _, from } =
            &self.language;
        let dialect = dialect.map(|dialect| dialect.name());
        let mut args: Vec<OsString> = Vec::new();
        if let Some(dialect) = dialect {
            args.extend(["--dialect".into(), dialect.into()]);
        }
        args.extend(block_delete.iter().map(|switch| format!("--block-delete={switch}").into()));
        args.extend(from.iter().flat_map(|line| ["--from".into(), line.to_string().into()]));
        for (switch, file) in [("--tools", tools), ("--parameters", parameters), ("--ini", ini)] {
            if let Some(file) = file {
                args.extend([switch.into(), file.into()]);
            }
        }
        args
    }
}

/// If a run folder was named instead of a program: the arguments of that run. What else was said on the
/// command line goes before.
pub(crate) fn repeated(args: &RunArgs) -> Result<RunArgs, CliError> {
    if !args.program.is_dir() {
        return Ok(args.clone());
    }
    let folder = &args.program;
    let summary =
        Summary::read(&folder.join(SUMMARY)).map_err(|error| without_summary(folder, error.to_string()))?;
    let name = Path::new(&summary.program).file_name().unwrap_or_default();
    let mut repeated = arguments_of(args, folder, name)?;
    repeated.gauge.gauge = args.gauge.gauge.clone().or(summary.repeats_gauge());
    repeated.seed = args.seed.or(Some(summary.seed));
    Ok(repeated)
}

/// What is said of a folder whose summary cannot be read: of a run that goes on, or was broken off, there is
/// none.
pub(crate) fn without_summary(folder: &Path, error: String) -> CliError {
    if let Some(early) = without_machine(folder) {
        return early;
    }
    let name = folder.display();
    let shows = format!("`pitchlock journal {name}` shows what it knows");
    let text = if folder.join(SUMMARY).exists() || !folder.join(JOURNAL).exists() {
        format!("{error}\nhelp: {name} is not the folder of a finished run")
    } else if is_held(folder) {
        format!(
            "{name}: this run still goes on, and has no {SUMMARY} yet\nhelp: wait until it has ended; {shows}"
        )
    } else {
        format!(
            "{name}: this run was broken off, and has no {SUMMARY}\nhelp: {shows}; if that is not the end of its program, \
             `pitchlock run {name} --resume` goes on with it, and of the run that goes on there is a report and a replay"
        )
    };
    CliError::Input(text)
}

/// What is said of a run whose machine has not started: it has taken its folder, and there is no journal yet.
pub(crate) fn without_machine(folder: &Path) -> Option<CliError> {
    if !is_claimed(folder) || [SUMMARY, JOURNAL].iter().any(|name| folder.join(name).exists()) {
        return None;
    }
    let text = match is_held(folder) {
        true => "this run is about to begin\nhelp: wait until it has ended",
        false => {
            "this run was broken off before its machine started: nothing has moved, and there is nothing to go on with\n\
             help: run the program from its beginning; the folder can be removed"
        }
    };
    Some(CliError::file(folder, text))
}

/// What is said of a folder whose journal cannot be read.
pub(crate) fn without_journal(folder: &Path, error: &std::io::Error) -> CliError {
    without_machine(folder).unwrap_or_else(|| {
        let help = format!("name the folder of a run, as in runs/m20x2-1: it has a {JOURNAL}");
        CliError::file(&folder.join(JOURNAL), format!("{error}\nhelp: {help}"))
    })
}

/// Files in a run folder that may be its program.
pub(crate) fn may_be_programs(folder: &Path) -> Vec<OsString> {
    let kept = [MACHINE, SCENARIO, LANGUAGE, TOOLS, PARAMETERS, INI].iter().chain(&RESULTS);
    let kept: Vec<OsString> = kept.map(OsString::from).collect();
    let files = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut names: Vec<OsString> = files.map(|file| file.file_name()).collect();
    names.retain(|name| !kept.contains(name) && folder.join(name).is_file());
    // A job may be the part of a program beside it.
    names.sort_by_key(|name| (Path::new(name).extension() == Some("toml".as_ref()), name.clone()));
    names
}

/// Hash of the files in a run folder that decide what the program of this name does.
pub(crate) fn input_of(folder: &Path, judged: &Program, name: &OsStr) -> Result<[u8; 16], CliError> {
    hashes(deciding(folder, judged, name)).map(|(input, _)| input)
}

/// The arguments of a run by what its folder keeps, for a program of this name.
pub(crate) fn arguments_of(args: &RunArgs, folder: &Path, name: &OsStr) -> Result<RunArgs, CliError> {
    let mut repeated = args.clone();
    repeated.program = folder.join(name);
    let there = |name: &str| Some(folder.join(name)).filter(|path| path.exists());
    repeated.machine.machine = args.machine.machine.clone().or_else(|| there(MACHINE));
    let LanguageArgs { tools, parameters, ini, .. } = &mut repeated.language;
    for (file, name) in [(tools, TOOLS), (parameters, PARAMETERS), (ini, INI)] {
        *file = file.take().or_else(|| there(name));
    }
    if let Some(kept) = there(LANGUAGE) {
        let text = intake::text(&kept, intake::SETTINGS).map_err(|error| CliError::file(&kept, error))?;
        let kept: Language = toml::from_str(&text).map_err(|error| CliError::file(&kept, error))?;
        repeated.language.dialect = args.language.dialect.or(kept.dialect);
        repeated.language.block_delete.extend(kept.block_delete);
        repeated.language.strict |= kept.strict;
        repeated.language.from = args.from.or(kept.from);
    }
    // Of another scenario or another program it was not pressed.
    repeated.presses = there(PRESSES).filter(|_| args.scenario.is_none());
    repeated.scenario = args.scenario.clone().or_else(|| there(SCENARIO));
    Ok(repeated)
}
