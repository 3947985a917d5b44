//! The interpreter process: G-code to machine code. `pitchlock run` starts it as a part of the machine.

use clap::Parser;

/// The interpreter process: G-code to machine code.
#[derive(Parser)]
#[command(version)]
struct Args {
    #[command(flatten)]
    args: interpreter::shell::InterpreterArgs,
}

fn main() -> std::process::ExitCode {
    protocol::shell::exit(interpreter::shell::run(&Args::parse().args))
}
