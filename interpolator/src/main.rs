//! The interpolator process: machine code to axis commands. `pitchlock run` starts it as a part of the machine.

use clap::Parser;

/// The interpolator process: machine code to axis commands.
#[derive(Parser)]
#[command(version)]
struct Args {
    #[command(flatten)]
    args: protocol::shell::ProcessArgs,
}

fn main() -> std::process::ExitCode {
    protocol::shell::exit(interpolator::shell::run(&Args::parse().args))
}
