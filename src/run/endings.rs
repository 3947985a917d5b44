//! How a run ended, as far as only the launcher knows: who died, what did not come to rest, who broke it off.
//! What caused a fault is listed before it.

use process::ipc::{ChannelCount, Process};
use protocol::operator::Request;
use rig::{
    observe::{FaultReport, Outcome, Summary},
    standstill::WAIT_S,
    supervisor::{End, Supervisor},
};

/// Late answers in a row at which a drive trips.
const TRIPS: u64 = 3;

/// A process that has died.
#[derive(Clone, Debug)]
pub(crate) struct Death {
    /// Which.
    pub(crate) process: Process,
    /// How, for people.
    pub(crate) ending: String,
    /// The first control cycle that it has not answered.
    pub(crate) cycle: u64,
    /// The machine had ended before.
    pub(crate) over: bool,
    /// It was killed because it did not answer.
    pub(crate) frozen: bool,
}

/// All of it.
#[derive(Default)]
pub(crate) struct Endings {
    deaths: Vec<Death>,
    end: Option<End>,
    broken_off: bool,
    /// In which cycle a run was stopped that waited for nobody, and what it waited for.
    unattended: Option<(u64, &'static str)>,
    /// Regulators that were late so often in a row that their drives tripped, and how often they were late.
    late: Vec<(String, u64)>,
}

impl Endings {
    /// A process has died.
    pub(crate) fn died(&mut self, death: Death) {
        self.deaths.push(death);
    }

    /// Whether a process has died.
    pub(crate) fn has_died(&self, process: Process) -> bool {
        self.deaths.iter().any(|death| death.process == process)
    }

    /// How the machine was left.
    pub(crate) fn ends(&mut self, end: Option<End>) {
        self.end = self.end.or(end);
    }

    /// The operator did not wait for rest.
    pub(crate) fn broken_off(&mut self) {
        self.broken_off = true;
    }

    /// The machine waits for somebody who will not come: it is stopped. A pass that is cut to its end first
    /// may wait on: then what comes is an emergency stop.
    pub(crate) fn waits(
        &mut self,
        cycle: u64,
        waits_for: &'static str,
        supervisor: &mut Supervisor,
    ) -> Option<Request> {
        if self.unattended.is_some() {
            return supervisor.emergency_stop();
        }
        self.unattended = Some((cycle, waits_for));
        Some(Request::Stop)
    }

    /// What was counted of late answers.
    pub(crate) fn late(&mut self, counts: &[ChannelCount]) {
        for count in counts.iter().filter(|count| count.late_in_row >= TRIPS) {
            if let Some(axis) = count.name.strip_prefix("drive-command/") {
                self.late.push((format!("regulator-{axis}"), count.late));
            }
        }
    }

    /// Writes all of it into the summary of the run.
    pub(crate) fn tell(&self, summary: &mut Summary) {
        for (regulator, late) in &self.late {
            let faults = &mut summary.faults;
            let trips = |fault: &FaultReport| fault.source == *regulator && fault.code == "drive-fault";
            // Without a trip they were late when it did not matter: before the start, or at rest.
            if let Some(index) = faults.iter().position(trips)
                && !self.deaths.iter().any(|death| death.process.name() == *regulator)
            {
                let text = format!(
                    "the third late answer of {regulator} in a row: its drive tripped. The computer was too slow ({late} late answers of it in all): more priority, a longer cycle_s, `pitchlock doctor`"
                );
                let (cycle, source) = (faults[index].cycle, regulator.clone());
                faults.insert(index, FaultReport { cycle, source, code: "late-answers".into(), text });
            }
        }
        // A program that came to its end, or was stopped, has missed nobody who died meanwhile.
        let harmless = |death: &&Death| {
            death.over || death.process == Process::Interpreter && summary.outcome != Outcome::Faulted
        };
        let (harmless, harmful): (Vec<_>, Vec<_>) = self.deaths.iter().partition(harmless);
        summary.warnings.extend(harmless.into_iter().map(|death| self.report(death)));
        for death in harmful {
            let behind = |fault: &FaultReport| fault.cycle >= death.cycle;
            let place = summary.faults.iter().position(behind).unwrap_or(summary.faults.len());
            summary.faults.insert(place, self.report(death));
        }
        if let Some((cycle, waits_for)) = self.unattended {
            let text = format!(
                "{waits_for} is left to come in the scenario: the machine stood for {WAIT_S} s, and the run was \
                 stopped. Let that event come behind this one (before it, it does nothing), or add stop = true"
            );
            summary.warnings.push(launcher_s(cycle, "nobody-at-the-panel", text));
        }
        if let Some(End::NoRest(moving)) = self.end {
            let text = format!(
                "{moving} long after the emergency stop, and the processes were ended all the same: look at its drive"
            );
            summary.faults.push(launcher_s(summary.cycles, "no-rest", text));
        }
        if self.broken_off {
            let text = "the operator ended the processes before the machine was at rest".into();
            summary.faults.push(launcher_s(summary.cycles, "broken-off", text));
        }
        if !summary.faults.is_empty() {
            summary.outcome = Outcome::Faulted;
        }
    }

    fn report(&self, death: &Death) -> FaultReport {
        let (code, text) = match death.frozen {
            true => (
                "process-frozen",
                "it did not answer any more, all others waited for it, and it was killed".into(),
            ),
            false => ("process-died", format!("the process {}", death.ending)),
        };
        FaultReport { cycle: death.cycle, source: death.process.name(), code: code.into(), text }
    }
}

/// The program is another one than that which was checked, though it could be read.
pub(crate) fn program_changed(summary: &mut Summary) {
    let text = "the program in the run folder was changed while it ran: what was run is not what was checked";
    summary.faults.push(launcher_s(summary.cycles, "program-changed", text.into()));
    summary.outcome = Outcome::Faulted;
}

fn launcher_s(cycle: u64, code: &str, text: String) -> FaultReport {
    FaultReport { cycle, source: "launcher".into(), code: code.into(), text }
}
