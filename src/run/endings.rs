//! How a run ended, as far as only the launcher knows: who died, what did not come to rest, who broke it off.
//! What caused a fault is listed before it.

use process::ipc::Process;
use protocol::{Fault, operator::Request};
use rig::{
    observe::{FaultReport, Outcome, Summary},
    standstill::WAIT_S,
    supervisor::{End, Supervisor},
};

use super::hosts::LINK;

/// A process that has died.
#[derive(Clone, Debug)]
pub(crate) struct Death {
    /// Whose: of several modules in one process the one that beats its time.
    pub(crate) process: Process,
    /// Name of the process.
    pub(crate) name: String,
    /// How, for people.
    pub(crate) ending: String,
    /// The first control cycle that it has not answered.
    pub(crate) cycle: u64,
    /// Since when nothing has come of what it makes, if that was missed before the death was noticed.
    pub(crate) missed: Option<u64>,
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

    /// Writes all of it into the summary of the run.
    pub(crate) fn tell(&self, summary: &mut Summary) {
        // A program that came to its end, or was stopped, has missed nobody who died meanwhile. But a link
        // that is lost is why it was stopped.
        let harmless = |death: &&Death| match (death.process, summary.outcome) {
            _ if death.over => true,
            (Process::Interpreter, Outcome::Completed) => true,
            (Process::Interpreter, outcome) => outcome != Outcome::Faulted && death.name != LINK,
            _ => false,
        };
        let (harmless, mut harmful): (Vec<_>, Vec<_>) = self.deaths.iter().partition(harmless);
        summary.warnings.extend(harmless.into_iter().map(|death| death.report(death.cycle)));
        harmful.sort_by_key(|death| death.cycle);
        // Backwards, so that of deaths in one cycle the first that was noticed is the first told.
        for death in harmful.into_iter().rev() {
            let behind = |fault: &FaultReport| fault.cycle >= death.cycle || death.starved(fault);
            let place = summary.faults.iter().position(behind).unwrap_or(summary.faults.len());
            let next = summary.faults.get(place).map_or(death.cycle, |fault| fault.cycle);
            summary.faults.insert(place, death.report(death.cycle.min(next)));
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
}

impl Death {
    /// Whether a fault came of it before it was noticed: who had to do without what the dead makes.
    fn starved(&self, fault: &FaultReport) -> bool {
        let hungry = [Fault::StreamStarved, Fault::PassCalledOff, Fault::BadMachineCode].map(Fault::code);
        self.missed.is_some_and(|since| fault.cycle >= since) && hungry.contains(&fault.code.as_str())
    }

    fn report(&self, cycle: u64) -> FaultReport {
        let (code, text) = match self.frozen {
            true => ("process-frozen", "it did not answer any more, and was killed".into()),
            false => ("process-died", format!("the process {}", self.ending)),
        };
        FaultReport { cycle, source: self.name.clone(), code: code.into(), text }
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

#[cfg(test)]
mod tests {
    use super::*;

    fn told(deaths: &[(Process, u64, Option<u64>)], faults: &[(&str, u64, Fault)]) -> Vec<(String, u64)> {
        let mut endings = Endings::default();
        for (process, cycle, missed) in deaths {
            let (process, cycle, missed, ending) = (*process, *cycle, *missed, String::new());
            let name = process.name();
            endings.died(Death { process, name, ending, cycle, missed, over: false, frozen: false });
        }
        let fault = |(source, cycle, fault): &(&str, u64, Fault)| FaultReport {
            cycle: *cycle,
            source: (*source).into(),
            code: fault.code().into(),
            text: String::new(),
        };
        let mut summary = Summary { faults: faults.iter().map(fault).collect(), ..Summary::default() };
        summary.outcome = Outcome::Faulted;
        endings.tell(&mut summary);
        summary.faults.into_iter().map(|fault| (fault.source, fault.cycle)).collect()
    }

    fn order(of: &[(&str, u64)]) -> Vec<(String, u64)> {
        of.iter().map(|(source, cycle)| ((*source).into(), *cycle)).collect()
    }

    /// A launcher that is busy notices a death late: the machine missed its code before.
    #[test]
    fn who_starved_by_a_death_is_told_behind_it_however_late_it_was_noticed() {
        let starved = [
            ("interpolator", 120, Fault::StreamStarved),
            ("regulator-x", 121, Fault::Stopped),
            ("interpolator", 131, Fault::BadMachineCode),
        ];
        let death = |missed| [(Process::Interpreter, 130, missed)];
        let dead_first =
            [("interpreter", 120), ("interpolator", 120), ("regulator-x", 121), ("interpolator", 131)];
        assert_eq!(told(&death(Some(90)), &starved), order(&dead_first));
        // Code came between: it starved by something else.
        let later =
            [("interpolator", 120), ("regulator-x", 121), ("interpreter", 130), ("interpolator", 131)];
        assert_eq!(told(&death(Some(125)), &starved), order(&later));
        assert_eq!(told(&death(None), &starved), order(&later));
        // And a drive that tripped before has not done so for want of code.
        let tripped = [("regulator-z", 100, Fault::DriveFault), ("interpolator", 131, Fault::BadMachineCode)];
        let first = [("regulator-z", 100), ("interpreter", 130), ("interpolator", 131)];
        assert_eq!(told(&death(Some(90)), &tripped), order(&first));
    }

    #[test]
    fn deaths_are_told_by_their_cycles_and_of_one_cycle_as_they_were_noticed() {
        let deaths =
            [(Process::Interpolator, 50, None), (Process::Plant, 50, None), (Process::Interpreter, 40, None)];
        let faults = [("regulator-x", 50, Fault::InterpolatorSilent)];
        let order_of = [("interpreter", 40), ("interpolator", 50), ("sim-plant", 50), ("regulator-x", 50)];
        assert_eq!(told(&deaths, &faults), order(&order_of));
    }
}
