//! A regulator process: one axis. `pitchlock run` starts it as a part of the machine.

use clap::Parser;

/// A regulator process: one axis.
#[derive(Parser)]
#[command(version)]
struct Args {
    #[command(flatten)]
    args: regulator::shell::RegulatorArgs,
}

fn main() -> std::process::ExitCode {
    protocol::shell::exit(regulator::shell::run(&Args::parse().args))
}
