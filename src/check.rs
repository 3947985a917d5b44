//! `pitchlock check`: a program is read to its end, nothing moves.

use std::{fmt::Write as _, process::ExitCode};

use clap::Args;
use interpreter::Severity;

use crate::{
    args::ProgramArgs,
    diagnostics::Document,
    error::CliError,
    gauged::{self, GaugeArgs},
    program::{Program, Read},
    screen,
};

#[derive(Clone, Debug, Args)]
pub(crate) struct CheckArgs {
    #[command(flatten)]
    pub(crate) input: ProgramArgs,
    #[command(flatten)]
    pub(crate) gauge: GaugeArgs,
    /// Print every diagnostic as one JSON document, for editors, and nothing else.
    #[arg(long)]
    pub(crate) json: bool,
}

/// Reports every diagnostic, every pass, and the time the program takes.
pub(crate) fn check(args: &CheckArgs) -> Result<ExitCode, CliError> {
    let (machine, _) = args.input.machine.read()?;
    let (language, asked) = (args.input.language(&machine), args.gauge.read()?);
    let program = Program::judge(&args.input.program, &language, &machine, asked)?;
    if args.json {
        let name = args.input.program.display().to_string();
        let dialect = Read::of(&args.input.program, &language, &machine).name();
        let good = program.found(Severity::Error) == 0;
        let time_s = good.then_some(program.time_s);
        let gauge = program.gauge.as_ref().map(|nominal| nominal.name.as_str());
        let document = Document::new(&name, dialect, program.diagnostics(), program.moves, time_s, gauge);
        let text = serde_json::to_string_pretty(&document);
        let text = text.map_err(|error| CliError::Machine(error.to_string()))?;
        screen::print(&format!("{text}\n"));
    } else {
        eprint!("{}", program.messages);
        screen::print(&findings(&program));
    }
    let good = program.found(Severity::Error) == 0;
    Ok(if good { ExitCode::SUCCESS } else { ExitCode::from(2) })
}

fn findings(program: &Program) -> String {
    let mut text = String::new();
    let moves = program.moves;
    let (errors, warnings) = (program.found(Severity::Error), program.found(Severity::Warning));
    let (errors_found, warnings_found) =
        (counted(errors as u64, "error"), counted(warnings as u64, "warning"));
    let _ = writeln!(text, "{errors_found}, {warnings_found}, {}", counted(moves, "move"));
    for job in program.check.iter().flat_map(|check| &check.jobs) {
        let _ = writeln!(text, "job       line {}", job.line);
        for (what, value) in &job.facts {
            let _ = writeln!(text, "  {what:<9} {value}");
        }
    }
    let passes = program.check.as_ref().map_or(&[][..], |check| &check.passes);
    if !passes.is_empty() {
        let _ =
            writeln!(text, "pass  line  depth mm    start Z  full depth from Z     to Z  highest override");
    }
    for pass in passes {
        let [from, to] = pass.full_depth_z_mm;
        // Where the program does not say where the crest is, the X of the pass is all that is known.
        let depth = pass.depth_mm.map_or_else(|| format!("X{:.3}", pass.x_mm), |depth| format!("{depth:.4}"));
        let _ = writeln!(
            text,
            "{:>4}  {:>4}  {:>8}  {:>9.4}  {:>17.4}  {:>7.3}  {:>14.0} %",
            pass.pass, pass.line, depth, pass.start_z_mm, from, to, pass.max_override_pct
        );
    }
    if !passes.is_empty() {
        let _ = writeln!(text, "Z is that of the machine: coordinate system and tool offset are added");
    }
    if let Some(nominal) = &program.gauge {
        let _ = writeln!(text, "gauge {}", gauged::told(nominal));
    }
    if errors == 0 {
        let _ = writeln!(text, "about {:.1} s on the machine at 100 % override", program.time_s);
    }
    text
}

/// A number of things: "1 error", "2 errors".
fn counted(number: u64, thing: &str) -> String {
    format!("{number} {thing}{}", if number == 1 { "" } else { "s" })
}
