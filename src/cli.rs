//! The arguments.

use std::{io::Write, path::PathBuf};

use clap::{Args, Parser, Subcommand, ValueEnum};
use machine::{Kinematics, Machine};
use process::shell::{Clock, LanguageArgs, Named, one_of};

use crate::error::CliError;

/// A two-level CNC for spindle-synchronised machining.
///
/// Threads are cut as functions of the measured spindle angle, so they are right at any spindle speed.
/// Begin with: pitchlock run examples/m20x2.ngc
#[derive(Debug, Parser)]
#[command(version, propagate_version = true)]
pub(crate) struct Cli {
    #[command(flatten)]
    pub(crate) log: LogArgs,
    #[command(subcommand)]
    pub(crate) command: Command,
}

/// What is said on standard error.
#[derive(Debug, Args)]
pub(crate) struct LogArgs {
    /// Say more; twice for everything.
    #[arg(short, long, global = true, action = clap::ArgAction::Count)]
    pub(crate) verbose: u8,
    /// No progress, no summary; only errors.
    #[arg(short, long, global = true, conflicts_with = "verbose")]
    pub(crate) quiet: bool,
    /// Form of log messages.
    #[arg(long, global = true, value_enum, default_value_t)]
    pub(crate) log_format: LogFormat,
}

/// Form of log messages.
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
pub(crate) enum LogFormat {
    /// For people.
    #[default]
    Text,
    /// For programs, one JSON object a line.
    Json,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Start the machine, run a program, write the run folder.
    #[command(after_help = RUN_HELP)]
    Run(RunArgs),
    /// Read a program: every diagnostic, every pass, the time it takes. Moves nothing.
    #[command(
        after_help = "Examples:\n  pitchlock check examples/m20x2.ngc\n  pitchlock check part.ngc --json      for editors"
    )]
    Check(CheckArgs),
    /// Turn a program into a machine-code file that `run` takes.
    #[command(
        after_help = "Examples:\n  pitchlock compile examples/m20x2.ngc -o m20x2.mc\n  pitchlock run m20x2.mc\n  \
                      pitchlock compile wave.toml -o wave.mc --g1 wave.ngc      the job also as straight lines"
    )]
    Compile(CompileArgs),
    /// Print what a program means: canonical machining functions, one a line.
    #[command(after_help = crate::canon::HELP)]
    Canon(crate::canon::CanonArgs),
    /// Print a machine file: a start for your own.
    #[command(
        after_help = "Examples:\n  pitchlock machine > my-lathe.toml\n  pitchlock run part.ngc --machine my-lathe.toml\n  \
                      pitchlock machine --kinematics mill > my-mill.toml"
    )]
    Machine {
        /// A lathe (the built-in machine), or a mill.
        #[arg(long, value_parser = one_of(&KINEMATICS), default_value = Kinematics::default().name())]
        kinematics: Kinematics,
    },
    /// Draw report.html of a run folder again.
    #[command(after_help = "Example:\n  pitchlock report runs/m20x2-1")]
    Report(ReportArgs),
    /// Make a published experiment again: table, JSON, pictures.
    #[command(after_help = crate::experiment::HELP)]
    Experiment(crate::experiment::ExperimentArgs),
    /// Commission axes: measure mass, friction, delays and the mode of the slide, and propose loops that fit.
    #[command(after_help = crate::tune::HELP)]
    Tune(crate::tune::TuneArgs),
    /// Say how fine positions, speeds, accelerations and jerks have to be, and whether this machine's encoders are.
    #[command(after_help = crate::resolution::HELP)]
    Resolution(Box<crate::resolution::ResolutionArgs>),
    /// Say whether this computer can run the machine, and what to change if not.
    #[command(after_help = "Example:\n  pitchlock doctor")]
    Doctor(DoctorArgs),
    /// The interpreter process, as `run` starts it.
    #[command(after_help = PROCESS_HELP)]
    Interpreter(process::shell::interpreter::InterpreterArgs),
    /// The interpolator process, as `run` starts it.
    #[command(after_help = PROCESS_HELP)]
    Interpolator(process::shell::ProcessArgs),
    /// A regulator process, as `run` starts it.
    #[command(after_help = PROCESS_HELP)]
    Regulator(process::shell::regulator::RegulatorArgs),
    /// The plant process, as `run` starts it.
    #[command(after_help = PROCESS_HELP)]
    SimPlant(process::shell::plant::PlantArgs),
}

const KINEMATICS: [Named<Kinematics>; 3] = [
    (
        Kinematics::Lathe,
        Kinematics::Lathe.name(),
        "X across, Z along the spindle, and, where it exists, C about it",
    ),
    (Kinematics::Mill, Kinematics::Mill.name(), "X, Y, Z, and what exists of A, B, C about them"),
    (
        Kinematics::Positioner,
        Kinematics::Positioner.name(),
        "X, Y, a tilt A and a turn C that bring a seam under a beam that stands",
    ),
];

const RUN_HELP: &str = "Examples:
  pitchlock run examples/m20x2.ngc
  pitchlock run part.ngc --machine my-lathe.toml --scenario examples/scenarios/override-in-pass.toml
  pitchlock run runs/m20x2-1          the same run again, from its folder

The run folder holds summary.json, the trace (MCAP opens in Foxglove and PlotJuggler), report.html (opens in any
browser, no network), and the program, machine file and scenario that were used.

M0, M1 and M60 wait for cycle start. An event of the scenario presses it; where none is left that could, it is pressed
after 1 s on the machine, and the summary names the pause.

Exit status: 0 done and good, 1 the run ended in a fault, 2 the program, machine file, scenario or an argument is wrong.";

const PROCESS_HELP: &str = "A process of a machine that `pitchlock run` has set up; it ends with its launcher.
Example, as the launcher starts them:
  pitchlock regulator --axis x --address ADDRESS --machine runs/m20x2-1/machine.toml --clock virtual --processor 0";

/// Which machine.
#[derive(Clone, Debug, Args)]
pub(crate) struct MachineArgs {
    /// Machine file (TOML); without it the built-in small lathe (`pitchlock machine`).
    #[arg(long, value_name = "FILE")]
    pub(crate) machine: Option<PathBuf>,
}

impl MachineArgs {
    /// What messages call the machine file.
    pub(crate) fn name(&self) -> String {
        self.machine.as_ref().map_or("built-in machine file".into(), |path| path.display().to_string())
    }

    /// The machine and the text of its file.
    pub(crate) fn read(&self) -> Result<(Machine, String), CliError> {
        let text = match &self.machine {
            None => machine::SMALL_LATHE.to_owned(),
            Some(path) => std::fs::read_to_string(path).map_err(|error| CliError::file(path, error))?,
        };
        let machine = Machine::from_toml(&text)
            .map_err(|error| CliError::Input(format!("{}: {error}", self.name())))?;
        // The truth about the plant is in the same file: whatever is wrong with it is said here.
        sim_plant::Plant::new(&machine, sim_plant::Scenario::none(), 1)
            .map_err(|error| CliError::Input(format!("{}: {error}", self.name())))?;
        Ok((machine, text))
    }
}

#[derive(Clone, Debug, Args)]
pub(crate) struct RunArgs {
    /// Part program (G-code), job (`.toml`), machine code (`.mc`), or a run folder to repeat.
    #[arg(value_name = "FILE")]
    pub(crate) program: PathBuf,
    #[command(flatten)]
    pub(crate) language: LanguageArgs,
    #[command(flatten)]
    pub(crate) machine: MachineArgs,
    /// How the processes wait for each other: in lock step as fast as possible, or in real time.
    #[arg(long, value_enum, default_value_t)]
    pub(crate) clock: Clock,
    /// The same machine in one process, without iceoryx2; same numbers.
    #[arg(long)]
    pub(crate) in_process: bool,
    /// What happens to the machine while it runs (TOML).
    #[arg(long, value_name = "FILE")]
    pub(crate) scenario: Option<PathBuf>,
    /// Wait for cycle start after each block; if the scenario does not press it, it is pressed after 1 s on the machine.
    #[arg(long)]
    pub(crate) single_block: bool,
    /// Seed of everything random about the plant [default: 1].
    #[arg(long, value_name = "N")]
    pub(crate) seed: Option<u64>,
    /// Run folder [default: `runs/PROGRAM-N`].
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Form of the trace.
    #[arg(long, value_enum, default_value_t)]
    pub(crate) trace: Trace,
    /// Print summary.json to standard output, and nothing else.
    #[arg(long)]
    pub(crate) json: bool,
}

/// Form of the trace.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum Trace {
    /// MCAP: opens in Foxglove and PlotJuggler.
    #[default]
    Mcap,
    /// Comma-separated values.
    Csv,
    /// No trace; the report shows the figures only.
    None,
}

/// A program and the machine it is for.
#[derive(Clone, Debug, Args)]
pub(crate) struct ProgramArgs {
    /// Part program (G-code), job (`.toml`) or machine code (`.mc`).
    #[arg(value_name = "FILE")]
    pub(crate) program: PathBuf,
    #[command(flatten)]
    pub(crate) language: LanguageArgs,
    #[command(flatten)]
    pub(crate) machine: MachineArgs,
}

#[derive(Clone, Debug, Args)]
pub(crate) struct CheckArgs {
    #[command(flatten)]
    pub(crate) input: ProgramArgs,
    /// Print every diagnostic as one JSON document, for editors, and nothing else.
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Clone, Debug, Args)]
pub(crate) struct CompileArgs {
    #[command(flatten)]
    pub(crate) input: ProgramArgs,
    /// The machine-code file.
    #[arg(short, long, value_name = "OUT.mc")]
    pub(crate) out: PathBuf,
    /// Also write the same as straight lines: G-code of RS274/NGC within the chord error of each job.
    #[arg(long, value_name = "FILE")]
    pub(crate) g1: Option<PathBuf>,
}

#[derive(Clone, Debug, Args)]
pub(crate) struct ReportArgs {
    /// A run folder.
    pub(crate) run_dir: PathBuf,
}

#[derive(Clone, Debug, Args)]
pub(crate) struct DoctorArgs {
    #[command(flatten)]
    pub(crate) machine: MachineArgs,
}

/// Sends log messages to standard error.
pub(crate) fn start_log(log: &LogArgs) {
    let level = match (log.quiet, log.verbose) {
        (true, _) => "error",
        (false, 0) => "warn",
        (false, 1) => "info",
        (false, _) => "debug",
    };
    let builder = tracing_subscriber::fmt()
        .with_env_filter(tracing_subscriber::EnvFilter::new(level))
        .with_ansi(colour(&std::io::stderr()))
        .with_writer(std::io::stderr);
    match log.log_format {
        LogFormat::Text => builder.without_time().init(),
        LogFormat::Json => builder.json().init(),
    }
}

/// Whether a stream shall be coloured: a terminal, and `NO_COLOR` not set.
pub(crate) fn colour(stream: &impl std::io::IsTerminal) -> bool {
    stream.is_terminal() && std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty())
}

/// Prints results to standard output; a reader that has gone away is no error.
pub(crate) fn print(text: &str) {
    let _ = std::io::stdout().write_all(text.as_bytes());
}
