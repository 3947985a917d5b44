//! Progress on a terminal: passes, depth, time on the machine. Silent elsewhere.

use std::io::Write as _;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use protocol::MachineState;
use rig::observe::Record;

use super::Setup;

/// Control cycles between two looks.
const EVERY: u64 = 256;

/// The bar.
pub(crate) struct Progress {
    bar: ProgressBar,
    passes: u32,
    cycle_s: f64,
    quiet: bool,
}

impl Progress {
    /// A bar over the machine code of the program.
    pub(crate) fn new(setup: &Setup) -> Progress {
        let bar = ProgressBar::new(setup.program.steps);
        if !setup.progress {
            bar.set_draw_target(ProgressDrawTarget::hidden());
        }
        let style =
            ProgressStyle::with_template("{bar:24} {msg}").unwrap_or_else(|_| ProgressStyle::default_bar());
        bar.set_style(style);
        let passes = setup.program.passes();
        Progress { bar, passes, cycle_s: setup.machine.general.cycle_s, quiet: setup.quiet }
    }

    /// Shows a cycle, now and then.
    pub(crate) fn cycle(&mut self, record: &Record) {
        let cycle = record.truth.cycle.0;
        if !cycle.is_multiple_of(EVERY) {
            return;
        }
        let machine = record.machine;
        let paused = machine.state() == MachineState::Paused;
        self.bar.set_position(machine.taken);
        self.bar.set_message(format!(
            "line {}  pass {}/{}  depth {:.3} mm  {:.0} 1/min ({:.0} %)  {:.1} s{}",
            machine.line,
            machine.pass,
            self.passes,
            machine.depth_mm,
            record.truth.spindle_rpm,
            machine.spindle_override_pct,
            cycle as f64 * self.cycle_s,
            if paused { "  paused: waits for cycle start" } else { "" },
        ));
    }

    /// Says something on standard error, besides the bar. Nobody may be there to read it.
    pub(crate) fn say(&self, text: &str) {
        if !self.quiet {
            let line = format!("pitchlock: {text}\n");
            self.bar.suspend(|| {
                let _ = std::io::stderr().write_all(line.as_bytes());
            });
        }
    }

    /// Takes the bar away.
    pub(crate) fn finish(&self) {
        self.bar.finish_and_clear();
    }
}
