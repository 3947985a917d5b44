//! What the modules latch, as a person reads it. In: every control cycle the fault of each status. Out:
//! reports in the order in which they came; of one cycle a cause before what it made of another axis.

use protocol::{Axis, Fault, MachineState, MachineStatus};

use super::{FaultReport, Observer, Outcome, Record};

/// Whether something else has caused it.
fn follows(fault: &FaultReport) -> bool {
    [Fault::OtherAxis, Fault::Stopped].iter().any(|follows| follows.code() == fault.code)
}

impl Observer {
    /// Takes the faults of a control cycle.
    pub(super) fn take_faults(&mut self, record: &Record) {
        let cycle = record.truth.cycle.0;
        let gap = self.latched.gap(cycle);
        let faults = &mut self.out.faults;
        let mut take = |seen: &mut u32, code: u32, who: &dyn Fn() -> (String, Option<String>)| {
            if std::mem::replace(seen, code) != code && code != 0 {
                let (source, detail) = who();
                let detail = Vec::from_iter(detail.into_iter().chain(gap.clone())).join("; ");
                faults.push(FaultReport::of(cycle, source, code, Some(detail).filter(|it| !it.is_empty())));
            }
        };
        let mut corrected = 0;
        for (axis, status) in record.axes {
            let counts = status.encoder_counts;
            let swing = &mut self.swings[axis.index()];
            let told = || match Fault::from_code(status.fault) {
                Some(Fault::AxisJump | Fault::FollowingError | Fault::ThreadError) => swing.told(),
                _ => (counts != 0).then(|| format!("{counts:+} counts")),
            };
            let who = || (format!("regulator-{}", axis.name()), told());
            take(&mut self.latched.axes[axis.index()], status.fault, &who);
            swing.cycle(status.servo_error_mm);
            if status.fault == 0 {
                corrected = corrected.max(status.encoder_counts);
            }
        }
        let concerned = || {
            let axis = Axis::ALL.get(usize::from(record.machine.fault_axis).checked_sub(1)?)?;
            Some(format!("regulator-{}", axis.name()))
        };
        take(&mut self.latched.machine, record.machine.fault, &|| ("interpolator".into(), concerned()));
        if faults.last().is_some_and(|fault| fault.cycle == cycle) {
            faults.sort_by_key(|fault| (fault.cycle, follows(fault)));
        }
        self.out.overrides_clamped = record.machine.overrides_clamped;
        self.corrected.cycle(cycle, corrected);
        self.out.outcome = self.outcome(record.machine);
    }

    fn outcome(&self, machine: &MachineStatus) -> Outcome {
        let faults = &self.out.faults;
        if faults.iter().any(|fault| fault.code != Fault::Stopped.code()) {
            Outcome::Faulted
        } else if faults.is_empty() && machine.stopped == 0 && machine.state() == MachineState::Ended {
            Outcome::Completed
        } else {
            Outcome::Stopped
        }
    }
}
