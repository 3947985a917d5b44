//! Progress on a terminal: passes, depth, time on the machine. Silent elsewhere.

use std::time::Duration;

use process::ipc::time::Moment;
use protocol::{Axis, AxisStatus};
use rig::observe::Record;

use super::Setup;
use crate::words;

/// Control cycles between two looks.
const EVERY: u64 = 256;
/// And the least time between two steps that are shown.
const PACE: Duration = Duration::from_millis(50);

/// The bar.
pub(crate) struct Progress {
    shows: bool,
    shown: Moment,
    passes: u32,
    cycle_s: f64,
    quiet: bool,
}

impl Progress {
    /// A bar over the machine code of the program.
    pub(crate) fn new(setup: &Setup) -> Progress {
        let shows = setup.progress && words::show_bar(setup.program.steps);
        let passes = setup.program.passes();
        let cycle_s = setup.machine.general.cycle_s;
        Progress { shows, shown: Moment::now(), passes, cycle_s, quiet: setup.quiet }
    }

    /// Shows a cycle, now and then.
    pub(crate) fn cycle(&mut self, record: &Record) {
        let cycle = record.truth.cycle.0;
        if !self.shows || !cycle.is_multiple_of(EVERY) || self.shown.elapsed() < PACE {
            return;
        }
        self.shown = Moment::now();
        let machine = record.machine;
        let paused = machine.state().waits_for_start();
        let text = format!(
            "line {}  pass {}/{}  {}  {:.0} 1/min ({:.0} %)  {:.1} s{}",
            machine.line,
            machine.pass,
            self.passes,
            place(record),
            record.truth.spindle_rpm,
            machine.spindle_override_pct,
            cycle as f64 * self.cycle_s,
            if paused { "  paused: waits for cycle start" } else { "" },
        );
        words::step(machine.taken, text);
    }

    /// Says something on standard error, besides the bar. Nobody may be there to read it, and nobody waits
    /// for that.
    pub(crate) fn say(&self, text: &str) {
        if !self.quiet {
            words::say(&format!("pitchlock: {text}\n"));
        }
    }

    /// Takes the bar away.
    pub(crate) fn finish(&self) {
        if self.shows {
            words::hide_bar();
        }
    }
}

/// Where the tool is: X as a radius.
fn place(record: &Record) -> String {
    let of = |(axis, _): &(Axis, AxisStatus)| {
        let at = record.truth.axes[axis.index()].slide_mm;
        format!("{}{at:.3}", axis.name().to_ascii_uppercase())
    };
    record.axes.iter().map(of).collect::<Vec<_>>().join(" ")
}
