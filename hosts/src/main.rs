//! `pitchlock-link`: the process of the link, as `pitchlock serve` and `pitchlock run --at` start it.

use std::{io::Write as _, path::PathBuf, process::ExitCode};

use clap::{Parser, Subcommand};
use hosts::{hall, lower, panel, ping, seal::Key, talk::leave, upper};

/// The link between the two levels of a control on two computers.
///
/// `pitchlock serve` starts it on the host with the machine, `pitchlock run --at` on the one with the
/// program.
#[derive(Debug, Parser)]
#[command(version)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// The end at the machine.
    Lower(lower::LowerArgs),
    /// The end at the program.
    Upper(upper::CallArgs),
    /// The end at the panel.
    Panel(upper::CallArgs),
    /// Look at machines of a hall, which are named there.
    Hall(hall::HallArgs),
    /// Measure the way there and back.
    Ping(ping::PingArgs),
    /// Make a file with a new key.
    Key {
        /// Which; it is not overwritten.
        file: PathBuf,
    },
}

fn main() -> ExitCode {
    let cli = Cli::parse();
    let (ended, talks) = match &cli.command {
        Command::Lower(args) => (lower::run(args), true),
        Command::Upper(args) => (upper::run(args), true),
        Command::Panel(args) => (panel::run(args), true),
        Command::Hall(args) => (hall::run(args), true),
        Command::Ping(args) => (ping::run(args), false),
        Command::Key { file } => (Key::make(file), false),
    };
    let Err(error) = ended else { return ExitCode::SUCCESS };
    if talks {
        leave(&error);
    }
    let _ = writeln!(std::io::stderr(), "error: {}", process::link::shown(&error.to_string()));
    ExitCode::from(error.status())
}
