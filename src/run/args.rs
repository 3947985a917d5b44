//! The arguments of `pitchlock run`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use process::{
    ipc::Process,
    shell::{Clock, LanguageArgs, Pace},
};
use protocol::Doom;

use crate::{
    args::{MachineArgs, seed},
    gauged::GaugeArgs,
    panel::PanelArgs,
};

pub(crate) const HELP: &str = "Examples:
  pitchlock run examples/m20x2.ngc
  pitchlock run part.ngc --machine my-lathe.toml --scenario examples/scenarios/override-in-pass.toml
  pitchlock run part.ngc --gauge M20x2-6g
  pitchlock run runs/m20x2-1          the same run again, from its folder
  pitchlock run runs/m20x2-1 --resume goes on with it after a loss of power, an abort or a fault
  pitchlock run part.ngc --from 27    begins at line 27; with --dry-run it is only shown how
  pitchlock run part.ngc --pace 1     as fast as the machine would be, to watch it
  pitchlock run part.ngc --at 10.0.0.2:7447 --key shop.key   on the machine of another computer

The run folder holds summary.json, the trace (MCAP opens in Foxglove and PlotJuggler), report.html (opens in any
browser, no network), and the program, machine file and scenario that were used.

M0, M1 and M60 wait for cycle start. An event of the scenario presses it; where none is left that could, it is pressed
after 1 s on the machine, and the summary names the pause.

Ctrl-C (or SIGTERM, or closing the terminal) stops the machine and ends the program: a tool in a thread leaves it
first. Ctrl-C again is an emergency stop, and once more ends the processes as they are.

Exit status: 0 the whole program was executed, and the part is good as far as it is judged; 1 the run ended in a fault,
or before the end of its program (stop, abort, Ctrl-C); 2 the program, machine file, scenario or an argument is wrong;
3 the program was executed, and the part is not good: why is said on standard error.";

#[derive(Clone, Debug, Args)]
pub(crate) struct RunArgs {
    /// Part program (G-code), job (`.toml`), machine code (`.mc`), or a run folder to repeat.
    #[arg(value_name = "FILE")]
    pub(crate) program: PathBuf,
    #[command(flatten)]
    pub(crate) language: LanguageArgs,
    #[command(flatten)]
    pub(crate) machine: MachineArgs,
    #[command(flatten)]
    pub(crate) gauge: GaugeArgs,
    #[command(flatten)]
    pub(crate) far: FarArgs,
    /// How the processes wait for each other: in lock step as fast as possible, or in real time.
    #[arg(long, value_enum, default_value_t)]
    pub(crate) clock: Timing,
    /// In lock step, time on the machine for each second on the wall, 0.05 to 1000: 1 is as fast as the
    /// machine would be, 0.2 five times slower; max does not wait. The same numbers at any pace.
    /// [default: max; with a panel 1]
    #[arg(long, value_name = "PACE")]
    pub(crate) pace: Option<Pace>,
    /// In real time each module in a process of its own, for those who have the processors; without it the
    /// plant and all regulators are one process.
    #[arg(long, conflicts_with = "in_process")]
    pub(crate) processes: bool,
    /// The same machine in one process, without iceoryx2; same numbers, as long as no process dies or
    /// freezes.
    #[arg(long)]
    pub(crate) in_process: bool,
    /// What happens to the machine while it runs (TOML).
    #[arg(long, value_name = "FILE")]
    pub(crate) scenario: Option<PathBuf>,
    /// Wait for cycle start after each block; if the scenario does not press it, it is pressed after 1 s on
    /// the machine.
    #[arg(long)]
    pub(crate) single_block: bool,
    /// Seed of everything random about the plant [default: 1].
    #[arg(long, value_name = "N", value_parser = seed)]
    pub(crate) seed: Option<u64>,
    /// Run folder [default: `runs/PROGRAM-N`].
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Form of the trace. It has every cycle of the first two minutes and of passes, and of the rest two of
    /// twenty.
    #[arg(long, value_enum, default_value_t)]
    pub(crate) trace: Trace,
    /// Show the run in a browser, and let whoever has its address press (`pitchlock panel --help`).
    #[arg(long = "panel")]
    pub(crate) with_panel: bool,
    #[command(flatten)]
    pub(crate) panel: PanelArgs,
    /// What somebody has pressed in the run that is repeated.
    #[arg(skip)]
    pub(crate) presses: Option<PathBuf>,
    /// Its machine code is given by hand, block by block.
    #[arg(skip)]
    pub(crate) by_hand: bool,
    /// If nothing has happened for so long, the process that all others wait for is taken for dead; 0 waits
    /// for ever (for debuggers).
    #[arg(long, value_name = "S", default_value_t = 10.0, value_parser = seconds)]
    pub(crate) watchdog_s: f64,
    /// For tests: kills or freezes a process in a control cycle, as in `sim-plant:kill@1000`.
    #[arg(long, value_name = "PROCESS:HOW@CYCLE", value_parser = fell, hide = true)]
    pub(crate) fell: Vec<Fell>,
    /// To measure what they cost: keeps no journal, nor what is needed to make the run again.
    #[arg(long, hide = true, conflicts_with = "resume")]
    pub(crate) unkept: bool,
    /// Go on with the run of a folder that was broken off: by a loss of power, an abort, a fault. In one
    /// process and in virtual time; with --tools by another table, if a tool was changed.
    #[arg(long)]
    pub(crate) resume: bool,
    /// Begin at this line of the program: everything before is read and not executed, the tool goes there
    /// from home, and what follows is cut as it is in the whole program.
    #[arg(long, value_name = "LINE", conflicts_with = "resume")]
    #[arg(value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) from: Option<u32>,
    /// With --resume or --from: show where it would begin and how it would get there, and move nothing.
    #[arg(long)]
    pub(crate) dry_run: bool,
    /// Print summary.json to standard output, and nothing else.
    #[arg(long)]
    pub(crate) json: bool,
}

/// Another computer that has the machine.
#[derive(Clone, Debug, Default, Args)]
pub(crate) struct FarArgs {
    /// The machine is on another computer, where `pitchlock serve` waits at this address: the interpreter
    /// runs here, and everything that has deadlines there.
    #[arg(long, value_name = "HOST:PORT", requires = "key")]
    pub(crate) at: Option<String>,
    /// File with the key that both computers have (`pitchlock-link key FILE` makes one).
    #[arg(long, value_name = "FILE", requires = "at")]
    pub(crate) key: Option<PathBuf>,
}

/// How the processes wait for each other.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum Timing {
    /// In lock step, as fast as the computer can; every run gives the same numbers.
    #[default]
    Virtual,
    /// In real time; what comes too late is counted.
    Real,
    /// In real time, if the computer grants everything that it needs; else nothing starts.
    #[value(name = "real=strict")]
    Strict,
}

impl Timing {
    /// What the processes go by.
    pub(crate) fn clock(self) -> Clock {
        match self {
            Timing::Virtual => Clock::Virtual,
            Timing::Real | Timing::Strict => Clock::Real,
        }
    }
}

/// Form of the trace.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum Trace {
    /// MCAP: opens in Foxglove and PlotJuggler.
    #[default]
    Mcap,
    /// Comma-separated values.
    Csv,
    /// MCAP of every control cycle, however long the run.
    Full,
    /// Comma-separated values of every control cycle.
    FullCsv,
    /// No trace; the report shows the figures only.
    None,
}

/// A process that a test kills or freezes.
#[derive(Clone, Debug)]
pub(crate) struct Fell {
    /// Which.
    pub(crate) process: Process,
    /// What happens to it.
    pub(crate) doom: Doom,
    /// When.
    pub(crate) cycle: u64,
}

fn fell(text: &str) -> Result<Fell, String> {
    let parts = text.split_once('@').and_then(|(who, cycle)| Some((who.split_once(':')?, cycle)));
    let ((process, how), cycle) = parts.ok_or("PROCESS:HOW@CYCLE")?;
    let doom = match how {
        "kill" => Doom::Kill,
        "freeze" => Doom::Freeze,
        _ => return Err("kill or freeze".into()),
    };
    let cycle = cycle.parse().map_err(|error| format!("{cycle}: {error}"))?;
    let process = Process::from_name(process).ok_or_else(|| format!("{process} is not a process"))?;
    Ok(Fell { process, doom, cycle })
}

fn seconds(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(seconds) if (0.0..=1e6).contains(&seconds) => Ok(seconds),
        _ => Err("seconds, 0 to 1000000".into()),
    }
}
