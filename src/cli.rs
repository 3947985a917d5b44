//! The command tree: every command with its help.

use std::{ffi::OsString, path::Path};

use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};
use machine::Kinematics;
use process::shell::{Named, one_of};

use crate::args::LogArgs;

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

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Start the machine, run a program, write the run folder.
    #[command(after_help = crate::run::HELP)]
    Run(crate::run::RunArgs),
    /// Have the machine on this computer, for programs that another one runs.
    #[command(after_help = crate::run::hosts::HELP)]
    Serve(crate::run::hosts::ServeArgs),
    /// Look at many machines on several computers in one view, and press nothing.
    #[command(after_help = crate::hall::HELP)]
    Hall(crate::hall::HallArgs),
    /// Stand at the machine: a panel in the browser that shows it and lets you press.
    #[command(after_help = crate::panel::HELP)]
    Panel(Box<crate::panel::PanelCommandArgs>),
    /// Read a program: every diagnostic, every pass, the time it takes. Moves nothing.
    #[command(
        after_help = "Examples:\n  pitchlock check examples/m20x2.ngc\n  pitchlock check part.ngc --json      for editors\n  pitchlock check *.nc                 each of them, and how many are good\n  sed s/F0.2/F0.3/ part.ngc | pitchlock check -"
    )]
    Check(crate::check::CheckArgs),
    /// Turn a program into a machine-code file that `run` takes.
    #[command(
        after_help = "Examples:\n  pitchlock compile examples/m20x2.ngc -o m20x2.mc\n  pitchlock run m20x2.mc\n  \
                      pitchlock compile wave.toml -o wave.mc --g1 wave.ngc      the job also as straight lines"
    )]
    Compile(crate::compile::CompileArgs),
    /// Print what a program means: canonical machining functions, one a line.
    #[command(after_help = crate::canon::HELP)]
    Canon(crate::canon::CanonArgs),
    /// Tell an editor what is wrong with a program while it is typed, and what its words mean.
    #[command(after_help = crate::lsp::HELP)]
    Lsp(crate::lsp::LspArgs),
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
    /// See and set coordinate systems and tools: G54 to G59.3, offsets, wear.
    #[command(after_help = crate::offsets::HELP)]
    Offsets(crate::offsets::OffsetsArgs),
    /// Say what the control knew last of a run, also of one that lost its power.
    #[command(after_help = crate::journal::HELP)]
    Journal(crate::journal::JournalArgs),
    /// Draw report.html of a run folder again.
    #[command(after_help = "Example:\n  pitchlock report runs/m20x2-1")]
    Report(crate::report::ReportArgs),
    /// Make a recorded run again, and say whether it is the same, bit for bit.
    #[command(after_help = crate::replay::HELP)]
    Replay(crate::replay::ReplayArgs),
    /// Say where two runs differ first: cycle, module and field; and draw it.
    #[command(after_help = crate::replay::HELP_DIFF)]
    Diff(crate::replay::DiffArgs),
    /// Make a published experiment again: table, JSON, pictures.
    #[command(after_help = crate::experiment::HELP)]
    Experiment(crate::experiment::ExperimentArgs),
    /// Commission axes: measure mass, friction, delays and the mode of the slide, and propose loops that fit.
    #[command(after_help = crate::tune::HELP)]
    Tune(crate::tune::TuneArgs),
    /// Say how fine positions, speeds, accelerations and jerks have to be, and whether this machine's
    /// encoders are.
    #[command(after_help = crate::resolution::HELP)]
    Resolution(Box<crate::resolution::ResolutionArgs>),
    /// Try to break the machine: random programs, machines and faults, judged by the truth.
    #[command(after_help = crate::soak::HELP)]
    Soak(crate::soak::SoakArgs),
    /// Make one command with many seeds and values, on all processors or by a scheduler, and one table of it.
    #[command(after_help = crate::campaign::HELP)]
    Campaign(crate::campaign::CampaignArgs),
    /// Write a program that cuts a standard thread, from its name; or print its limits.
    #[command(after_help = crate::thread::HELP)]
    Thread(crate::thread::ThreadArgs),
    /// Find where a thread that is there lies, from touches of its groove.
    #[command(after_help = crate::pickup::HELP)]
    PickUp(crate::pickup::PickUpArgs),
    /// Say whether this computer can run the machine, and what to change if not.
    #[command(after_help = "Examples:\n  pitchlock doctor\n  pitchlock doctor --real 60")]
    Doctor(crate::doctor::DoctorArgs),
    /// The process of the panel, as `panel` starts it.
    #[command(hide = true)]
    PanelServer,
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
    /// The process of plant and regulators in real time, as `run` starts it.
    #[command(after_help = PROCESS_HELP)]
    RealTime(process::shell::plant::PlantArgs),
}

/// Reads the arguments. A number below 0 is the value of its option, so that its range is told and not
/// another option.
pub(crate) fn parse(arguments: &[OsString]) -> Result<Cli, clap::Error> {
    let command = Cli::command().mut_subcommands(takes_negatives);
    Cli::from_arg_matches(&command.try_get_matches_from(arguments)?)
}

fn takes_negatives(command: clap::Command) -> clap::Command {
    command.mut_subcommands(takes_negatives).mut_args(|arg| {
        let value = arg.get_long().is_some() && arg.get_action().takes_values();
        if value { arg.allow_negative_numbers(true) } else { arg }
    })
}

/// The arguments, with the one switch of LinuxCNC's `rs274` spelled as ours that means something else here:
/// `canon -v lathe.var` is `canon -p lathe.var`.
pub(crate) fn arguments(given: impl Iterator<Item = OsString>) -> Vec<OsString> {
    let mut all: Vec<OsString> = given.collect();
    if all.get(1).is_some_and(|command| command == "canon") {
        for at in 2..all.len().saturating_sub(1) {
            let file = Path::new(&all[at + 1]);
            if all[at] == "-v" && file.extension().is_some_and(|extension| extension == "var") {
                all[at] = "-p".into();
            }
        }
    }
    all
}

impl Command {
    /// Whether it prints one JSON document and nothing else.
    pub(crate) fn prints_json(&self) -> bool {
        match self {
            Command::Run(args) => args.json,
            Command::Panel(args) => args.run.json,
            Command::Hall(args) => args.json,
            Command::Check(args) => args.json,
            Command::Journal(args) => args.json,
            Command::Experiment(args) => args.json,
            Command::Tune(args) => args.json,
            Command::Resolution(args) => args.json,
            Command::Soak(args) => args.json,
            Command::Campaign(args) => args.json,
            Command::Thread(args) => args.json,
            Command::PickUp(args) => args.json,
            Command::Doctor(args) => args.json,
            Command::Replay(args) => args.json,
            Command::Diff(args) => args.json,
            _ => false,
        }
    }

    /// Whether somebody waits for this process, or for the processes that it has started.
    pub(crate) fn is_of_a_machine(&self) -> bool {
        use Command::{Interpolator, Interpreter, Panel, RealTime, Regulator, Run, Serve, SimPlant};
        let cyclic = matches!(self, Interpolator(_) | Regulator(_) | SimPlant(_) | RealTime(_));
        cyclic || matches!(self, Run(_) | Serve(_) | Panel(_) | Interpreter(_))
    }
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

const PROCESS_HELP: &str = "A process of a machine that `pitchlock run` has set up; it ends with its launcher.
Example, as the launcher starts them:
  pitchlock regulator --axis x --address ADDRESS --machine runs/m20x2-1/machine.toml --clock virtual --processor 0";
