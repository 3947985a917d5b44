//! `pitchlock`: the launcher and command line. One binary that can be every process of the machine.

mod args;
mod campaign;
mod canon;
mod certificate;
mod changes;
mod check;
mod chip;
mod cli;
mod compile;
mod diagnostics;
mod doctor;
mod entered;
mod error;
mod experiment;
mod fit;
mod gauged;
mod hall;
mod ini;
mod journal;
mod lsp;
mod offsets;
mod panel;
mod pickup;
mod program;
mod references;
mod repeated;
mod replay;
mod report;
mod resolution;
mod run;
mod screen;
mod soak;
mod temporary;
mod thread;
mod tune;
mod varied;
mod words;
mod written;

use std::process::ExitCode;

use cli::{Cli, Command};
use error::CliError;

fn main() -> ExitCode {
    let arguments = cli::arguments(std::env::args_os());
    let cli = cli::parse(&arguments).unwrap_or_else(|error| {
        // What reads JSON gets JSON; --help is an answer and no error.
        if error.use_stderr() && arguments.iter().any(|argument| argument == "--json") {
            screen::print_error(&error.to_string());
        }
        error.exit()
    });
    screen::start_log(&cli.log);
    let code = dispatch(&cli).unwrap_or_else(|error| {
        if cli.command.prints_json() {
            screen::print_error(&error.to_string());
        }
        error.report()
    });
    words::flush(cli.command.is_of_a_machine());
    if screen::is_printed() { code } else { ExitCode::FAILURE }
}

fn dispatch(cli: &Cli) -> Result<ExitCode, CliError> {
    let quiet = cli.log.quiet;
    process::ipc::end_with_starter()?;
    match &cli.command {
        Command::Run(args) => match (&args.far.at, &args.far.key) {
            (Some(at), Some(key)) => run::hosts::run_at(args, (at, key), quiet),
            _ => run::run(args, quiet),
        },
        Command::Serve(args) => run::hosts::serve(args, quiet),
        Command::Hall(args) => hall::hall(args),
        Command::Panel(args) => panel::panel(args, quiet),
        Command::PanelServer => panel::server(),
        Command::Check(args) => check::check(args, quiet),
        Command::Compile(args) => compile::compile(args, quiet),
        Command::Lsp(args) => lsp::lsp(args),
        Command::Canon(args) => canon::canon(args, quiet),
        Command::Machine { kinematics } => {
            screen::print(kinematics.example());
            Ok(ExitCode::SUCCESS)
        }
        Command::Offsets(args) => offsets::offsets(args, quiet),
        Command::Journal(args) => journal::journal(args),
        Command::Report(args) => report::report(args),
        Command::Replay(args) => replay::replay(args, quiet),
        Command::Diff(args) => replay::diff(args, quiet),
        Command::Experiment(args) => experiment::experiment(args, quiet),
        Command::Tune(args) => tune::tune(args, quiet),
        Command::Resolution(args) => resolution::resolution(args, quiet),
        Command::Soak(args) => soak::soak(args, quiet),
        Command::Campaign(args) => campaign::campaign(args, quiet),
        Command::Thread(args) => thread::thread(args, quiet),
        Command::PickUp(args) => pickup::command(args),
        Command::Doctor(args) => doctor::doctor(args),
        Command::Interpreter(args) => Ok(process::shell::interpreter::run(args).map(|()| ExitCode::SUCCESS)?),
        Command::Interpolator(args) => {
            Ok(process::shell::interpolator::run(args).map(|()| ExitCode::SUCCESS)?)
        }
        Command::Regulator(args) => Ok(process::shell::regulator::run(args).map(|()| ExitCode::SUCCESS)?),
        Command::RealTime(args) => {
            Ok(process::shell::plant::run_with_regulators(args).map(|()| ExitCode::SUCCESS)?)
        }
        Command::SimPlant(args) => Ok(process::shell::plant::run(args).map(|()| ExitCode::SUCCESS)?),
    }
}
