//! `pitchlock canon`: what a program means, one canonical machining function a line.
//!
//! A program streams through: a line is read, executed, printed and forgotten. Nothing else of the machine is
//! started.

use std::fs::File;
use std::io::{self, IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Args, ValueEnum};
use gcode::canon::{LinuxcncPrinter, PlainPrinter, Units};
use gcode::files::{MachineFile, ParameterFile, ToolTable};
use gcode::{
    Call, Diagnostic, Dialect, Job, Options, Place, Pose, Problem, Program, Severity, Sink, Skips, Step,
};

use crate::{
    changes::wrong,
    error::CliError,
    screen,
    written::{self, Made},
};

pub(crate) const HELP: &str = "Examples:
  pitchlock canon part.ngc
  pitchlock canon part.ngc --format linuxcnc -t tool.tbl -i lathe.ini > part.canon
  echo 'G21 G0 X10' | pitchlock canon
  pitchlock canon part.ngc -p lathe.var          parameters are read before and written back after the run

The switches of LinuxCNC's `rs274` (-g -t -i -b -n) mean the same here; so does its -v before a file named *.var, but
-p is clearer: -v says more everywhere else.

Exit status: 0 the program is good, 2 it has errors or a file is wrong; with --format linuxcnc -n 0 it is 0 whenever the
end of the program was reached, as that of `rs274`. Messages: FILE:LINE:COLUMN: on standard error.";

/// What to print, and what the program is run with.
#[derive(Clone, Debug, Args)]
pub(crate) struct CanonArgs {
    /// Part program (G-code); `-`, or nothing behind a pipe: standard input.
    #[arg(value_name = "FILE")]
    program: Option<PathBuf>,
    /// Where to print; without it standard output.
    #[arg(value_name = "OUTPUT")]
    output: Option<PathBuf>,
    /// Form of the calls.
    #[arg(long, value_enum, default_value_t)]
    format: Format,
    /// Dialect of the part program.
    #[arg(long, value_name = "DIALECT", default_value = "linuxcnc")]
    dialect: Dialect,
    /// Tool table (LinuxCNC's format).
    #[arg(short, long = "tools", value_name = "FILE")]
    tools: Option<PathBuf>,
    /// Parameter file: read if it exists, written when the program is over.
    #[arg(short, long, value_name = "FILE")]
    parameters: Option<PathBuf>,
    /// Machine description of LinuxCNC (.ini): units, peck clearance, folders, tool table, parameters.
    #[arg(short, long, value_name = "FILE")]
    ini: Option<PathBuf>,
    /// Folder with subroutine files, besides that of the program; may be given several times.
    #[arg(long, value_name = "DIR")]
    subroutines: Vec<PathBuf>,
    /// Leave out lines that begin with `/`, which is `/1`; `=1,2` those that begin with `/1` or `/2`.
    #[arg(short, long, value_name = "N", num_args = 0..=1, require_equals = true, value_delimiter = ',')]
    #[arg(default_missing_value = "1", value_parser = clap::value_parser!(u8).range(1..=9))]
    block_delete: Vec<u8>,
    /// After an error: 0 go on with the next line, 2 stop.
    #[arg(short = 'n', long, value_name = "N", value_parser = on_error, default_value = "2")]
    on_error: OnError,
    /// Ask nothing before the start, as this command never does.
    #[arg(short = 'g', long, hide = true)]
    go: bool,
}

/// Form of the calls.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
enum Format {
    /// In mm, without numbers: for reading and comparing.
    #[default]
    Plain,
    /// As LinuxCNC's `rs274 -g` prints them.
    Linuxcnc,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum OnError {
    GoOn,
    Stop,
}

fn on_error(number: &str) -> Result<OnError, String> {
    match number {
        "0" => Ok(OnError::GoOn),
        "1" => Err("there is no keyboard to go on from here; use 0 to go on or 2 to stop".into()),
        "2" => Ok(OnError::Stop),
        _ => Err("use 0 to go on with the next line or 2 to stop".into()),
    }
}

/// Prints the calls of a program.
pub(crate) fn canon(args: &CanonArgs, quiet: bool) -> Result<ExitCode, CliError> {
    let options = options(args, quiet)?;
    let mut program = open(args, &options)?;
    let mut printer = Printer::new(args.format, output(args)?, &options);
    let done = print(&mut program, &mut printer, args.on_error, quiet);
    let good = match done.and_then(|good| printer.finish(good, args.ini.is_some()).map(|()| good)) {
        Ok(good) => good,
        // Whoever was reading has seen enough.
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => true,
        Err(error) => return Err(CliError::Input(format!("the output cannot be written: {error}"))),
    };
    if let Some(path) = &args.parameters {
        program.outlasting().parameters.write(path).map_err(wrong)?;
    }
    Ok(if good { ExitCode::SUCCESS } else { ExitCode::from(2) })
}

/// Runs the program to its end. Whether it had no errors.
fn print(
    program: &mut Program,
    printer: &mut Printer,
    on_error: OnError,
    quiet: bool,
) -> Result<bool, io::Error> {
    let colour = screen::colour(&io::stderr());
    let mut good = true;
    // As `rs274 -n 0`, which is content with having reached the end.
    let goes_on = on_error == OnError::GoOn && matches!(printer, Printer::Linuxcnc(_));
    let forgives = |code: &str| goes_on && code != "no-program-end";
    if matches!(printer, Printer::Linuxcnc(_)) && !quiet {
        eprintln!("executing"); // the first line that `rs274` writes there
    }
    loop {
        let step = program.step(printer);
        for warning in program.take_warnings() {
            if !quiet {
                eprint!("{}", warning.render(colour));
            }
        }
        match step {
            Ok(Step::More) => {}
            Ok(Step::Ended) => break,
            Err(error) => {
                // What was printed before comes first; an output that is lost is not an error of the program.
                printer.gave_up(error.code, program.is_read_to_end());
                printer.flush()?;
                good &= error.severity != Severity::Error || forgives(error.code);
                printer.show(&error, colour);
                if on_error == OnError::Stop {
                    break;
                }
            }
        }
    }
    Ok(good)
}

/// What the program is run with.
fn options(args: &CanonArgs, quiet: bool) -> Result<Options, CliError> {
    interpreter::check_folders(&args.subroutines).map_err(|error| CliError::Input(error.to_string()))?;
    let machine = match &args.ini {
        Some(path) => MachineFile::read(path).map_err(wrong)?,
        None => MachineFile::default(),
    };
    for warning in machine.warnings.iter().filter(|_| !quiet) {
        eprint!("{}", warning.render(screen::colour(&io::stderr())));
    }
    let mut options = Options {
        dialect: args.dialect,
        skips: Skips::of(args.block_delete.iter().copied()),
        stand_alone: args.format == Format::Linuxcnc && args.dialect == Dialect::Linuxcnc,
        subroutine_folders: args
            .subroutines
            .iter()
            .cloned()
            .chain(machine.subroutine_folders.clone())
            .collect(),
        named: machine.named.clone(),
        orient_offset: machine.orient_offset,
        ..Options::default()
    };
    options.machine_units = machine.units.unwrap_or(match args.format {
        Format::Plain => Units::Millimetre,
        // Where nothing says otherwise, `rs274` takes the machine for one in inches; programs begin in mm
        // anyway.
        Format::Linuxcnc => Units::Inch,
    });
    for (clearance, given) in
        options.peck_clearances.iter_mut().zip([machine.g73_clearance, machine.g83_clearance])
    {
        *clearance = given.unwrap_or(*clearance);
    }
    options.forgets_g92 = machine.forgets_g92;
    options.no_fanuc_subs = machine.no_fanuc_subs;
    if let Some(path) = args.tools.as_ref().or(machine.tool_table.as_ref()) {
        options.tools = ToolTable::read(path).map_err(wrong)?;
    }
    if let Some(path) = args.parameters.as_ref().or(machine.parameter_file.as_ref()) {
        let parameters = ParameterFile::read(path).map_err(wrong)?;
        options.parameters = machine.counted(parameters).collect();
    }
    Ok(options)
}

fn open(args: &CanonArgs, options: &Options) -> Result<Program, CliError> {
    match &args.program {
        Some(path) if path != Path::new("-") => {
            interpreter::no_other(path).map_err(|error| CliError::Input(error.to_string()))?;
            let open = if interpreter::is_job(path) { Program::open_job } else { Program::open };
            open(path, options).map_err(|error| CliError::file(path, error))
        }
        None if io::stdin().is_terminal() => Err(CliError::Input(
            "no program: name a file, or `-` to type one in\nExample: pitchlock canon part.ngc".into(),
        )),
        _ => Program::from_reader("-", io::stdin().lock(), options)
            .map_err(|error| CliError::file(Path::new("-"), error)),
    }
}

fn output(args: &CanonArgs) -> Result<Box<dyn Write>, CliError> {
    match &args.output {
        Some(path) if is_program(path) => Err(CliError::Input(format!(
            "{}: is a program, and canon reads one at a time; its second file is where it prints",
            path.display()
        ))),
        Some(path) if path.extension().is_some_and(|extension| extension == "var") => {
            Err(CliError::Input(format!(
                "{}: is a parameter file by its name, and would be printed to; parameters are read with -p",
                path.display()
            )))
        }
        Some(path) => written::free(path, Made::Calls).and_then(|()| {
            Ok(Box::new(File::create(path).map_err(|error| CliError::file(path, error))?) as Box<dyn Write>)
        }),
        None => Ok(Box::new(io::stdout().lock())),
    }
}

/// Whether a path is that of a part program which is there already.
fn is_program(path: &Path) -> bool {
    let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
    let known = ["ngc", "nc", "tap", "gcode"].iter().any(|known| extension.eq_ignore_ascii_case(known));
    known && path.exists()
}

/// The printer of a format.
enum Printer {
    Plain(PlainPrinter<Box<dyn Write>>),
    Linuxcnc(LinuxcncPrinter<Box<dyn Write>>),
}

impl Printer {
    fn new(format: Format, file: Box<dyn Write>, options: &Options) -> Printer {
        match format {
            Format::Plain => Printer::Plain(PlainPrinter::new(file, options.machine_units)),
            Format::Linuxcnc => Printer::Linuxcnc(LinuxcncPrinter::new(file)),
        }
    }

    /// Shows an error. What a program says with (ABORT,...) is shown as `rs274` does: the text, and the line.
    fn show(&self, error: &Diagnostic, colour: bool) {
        match self {
            Printer::Linuxcnc(_) if error.code == "abort" => eprintln!("{}\n{}", error.message, error.text),
            _ => eprint!("{}", error.render(colour)),
        }
    }

    /// Before an error is shown: `rs274` has finished the program if it looked for a subroutine to the end.
    fn gave_up(&mut self, code: &str, read_to_end: bool) {
        if let Printer::Linuxcnc(printer) = self
            && read_to_end
            && code == "no-subroutine"
        {
            let _ = printer.call(Place::default(), Call::Finish);
        }
    }

    /// Ends the output. `rs274` resets when it leaves: after an error, and once more if it has no machine
    /// description.
    fn finish(&mut self, good: bool, described: bool) -> io::Result<()> {
        if let Printer::Linuxcnc(printer) = self {
            for _ in 0..u8::from(!good) + u8::from(!described) {
                // What the file below refuses is kept, and comes out of `flush`.
                let _ = printer.call(Place::default(), Call::OnReset);
            }
        }
        self.flush()
    }

    fn flush(&mut self) -> io::Result<()> {
        match self {
            Printer::Plain(printer) => printer.flush(),
            Printer::Linuxcnc(printer) => printer.flush(),
        }
    }
}

impl Sink for Printer {
    fn call(&mut self, place: Place, call: Call<'_>) -> Result<(), Box<Problem>> {
        match self {
            Printer::Plain(printer) => printer.call(place, call),
            Printer::Linuxcnc(printer) => printer.call(place, call),
        }
    }

    fn job(&mut self, place: Place, job: &Job, tools: &ToolTable) -> Result<Option<Pose>, Box<Problem>> {
        match self {
            Printer::Plain(printer) => printer.job(place, job, tools),
            Printer::Linuxcnc(printer) => printer.job(place, job, tools),
        }
    }
}
