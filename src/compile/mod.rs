//! `pitchlock compile`: a program becomes machine code in a file; and, on request, straight lines of G-code,
//! which it is measured against.

mod g1;

use std::{
    io::{BufWriter, Write},
    path::{Path, PathBuf},
    process::ExitCode,
};

use clap::Args;
use machine::Machine;
use protocol::{
    Item,
    code_file::{CodeFile, CodeWriter},
};

use crate::{
    args::ProgramArgs,
    error::CliError,
    program::Program,
    screen,
    words::{self, Phase},
    written::{self, Made},
};
use g1::{About, NoLines, Size};

#[derive(Clone, Debug, Args)]
pub(crate) struct CompileArgs {
    #[command(flatten)]
    pub(crate) input: ProgramArgs,
    /// The machine-code file.
    #[arg(short, long, value_name = "OUT.mc")]
    pub(crate) out: PathBuf,
    /// Also write the same as straight lines: G-code of RS274/NGC within the chord error of each job
    /// (/dev/stdout prints them, and nothing else).
    #[arg(long, value_name = "FILE")]
    pub(crate) g1: Option<PathBuf>,
}

/// Writes machine code to a file; and says how large it is against straight lines of the same accuracy, where
/// it follows formulas, or the lines themselves are asked for.
pub(crate) fn compile(args: &CompileArgs, quiet: bool) -> Result<ExitCode, CliError> {
    if !CodeFile::is_named(&args.out) {
        return Err(CliError::Input(format!("{}: a machine-code file is named *.mc", args.out.display())));
    }
    written::free(&args.out, Made::Code)?;
    if let Some(lines) = &args.g1 {
        written::free(lines, Made::Lines)?;
    }
    let shop = args.input.machine.with_language(&args.input.language)?;
    let (machine, language) = (shop.machine, shop.language.language());
    let program = Program::read(&args.input.program, &language, &machine, None)?;
    if !quiet {
        words::say(&format!("{}{}", shop.notes, program.messages));
    }
    // Items come anew whenever they are needed: kept, a long program would take much memory.
    let items = || program.items(&args.input.program, &language, &machine);
    let compiling = Phase::begin("compiling");
    let (bytes, about) = write_code(args, program.count, items()?, &machine)?;
    drop(compiling);
    // What is said of lines that are printed does not belong among them.
    let are_printed = args.g1.as_deref().is_some_and(written::is_standard_output);
    let say = if are_printed { words::say } else { screen::print };
    say(&format!("{}: {} items, {bytes} bytes\n", args.out.display(), program.count));
    let lines = match &args.g1 {
        Some(path) => Some(write_lines(path, args, &about, items()?, &machine)?),
        // Without lines there is nothing to compare.
        None if about.works() => g1::write(&about, items()?, &machine, &mut |_| {}).ok(),
        None => None,
    };
    if let Some(lines) = lines {
        say(&compared(bytes, lines));
    }
    if args.g1.is_some() && about.seams() {
        say("the lines of a seam are for size and for other controls: this machine is slower along them\n");
    }
    Ok(ExitCode::SUCCESS)
}

/// The items of a program, or what is wrong with it.
type Items = Box<dyn Iterator<Item = Result<Item, String>>>;

/// Writes so many items to the machine-code file; its bytes, and what lines of it would tell first.
fn write_code(
    args: &CompileArgs,
    count: u64,
    items: Items,
    machine: &Machine,
) -> Result<(u64, About), CliError> {
    // Without its folder, so that a program has the same machine code everywhere.
    let name = args.input.program.file_name().unwrap_or_default().to_string_lossy();
    let failed = |error| CliError::file(&args.out, error);
    written::by_parts(&args.out, |file| {
        let mut about = About::default();
        let file = BufWriter::new(file);
        let mut file = CodeWriter::new(file, &name, &machine.identity(), count).map_err(failed)?;
        for item in items {
            let item = item.map_err(CliError::Input)?;
            Phase::at(item.line);
            about.item(&item);
            file.put(&item).map_err(failed)?;
        }
        Ok((file.finish().map_err(failed)?, about))
    })
}

/// Writes the same as straight lines to a file.
fn write_lines(
    path: &Path,
    args: &CompileArgs,
    about: &About,
    items: Items,
    machine: &Machine,
) -> Result<Size, CliError> {
    let (program, code) = (&args.input.program, args.out.display());
    written::by_parts(path, |file| {
        let mut file = BufWriter::new(file);
        let mut wrote = Ok(());
        let mut put = |line: &str| {
            if wrote.is_ok() {
                wrote = writeln!(file, "{line}");
            }
        };
        let name = program.file_name().unwrap_or_default().to_string_lossy();
        about.header(machine, &name).iter().for_each(|line| put(line));
        // What cannot be said leaves no file behind.
        let size = g1::write(about, items, machine, &mut put).map_err(|error: NoLines| {
            let remedy = format!("leave --g1 out; {code} is written and says all of it");
            CliError::file(program, format!("{error}: {remedy}"))
        })?;
        wrote.and_then(|()| file.flush()).map_err(|error| CliError::file(path, error))?;
        Ok(size)
    })
}

/// How large machine code is against straight lines.
fn compared(bytes: u64, lines: Size) -> String {
    let times = lines.bytes as f64 / bytes.max(1) as f64;
    format!(
        "machine code {} bytes; the G1 program of the same accuracy {} bytes in {} blocks: {} times as many\n",
        grouped(bytes),
        grouped(lines.bytes),
        grouped(lines.blocks),
        if times < 10.0 { format!("{times:.1}") } else { grouped(times as u64) }
    )
}

/// A number with its thousands apart.
fn grouped(number: u64) -> String {
    match number / 1000 {
        0 => number.to_string(),
        thousands => format!("{} {:03}", grouped(thousands), number % 1000),
    }
}
