//! The plant process: spindle, axes, drives. `pitchlock run` starts it as a part of the machine.

use clap::Parser;

/// The plant process: spindle, axes, drives.
#[derive(Parser)]
#[command(version)]
struct Args {
    #[command(flatten)]
    args: sim_plant::shell::PlantArgs,
}

fn main() -> std::process::ExitCode {
    protocol::shell::exit(sim_plant::shell::run(&Args::parse().args))
}
