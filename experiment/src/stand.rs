//! What experiments that move a machine share: the machine, the seed, all processors, and progress on a
//! terminal.
//!
//! Cases are independent of each other and each is the same every time, so the findings do not depend on how
//! many are computed at once.

use std::{
    num::NonZero,
    sync::{
        Mutex, PoisonError,
        atomic::{AtomicUsize, Ordering},
    },
    thread,
};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use interpreter::Check;
use machine::Machine;
use rig::{
    Rig,
    observe::{Observation, Observer, Outcome, Record, TraceReport, Traced},
    trial::{self, Trial},
};
use sim_plant::Scenario;

use crate::ExperimentError;

/// Where experiments are made.
pub struct Stand {
    /// As its file describes it.
    pub machine: Machine,
    /// Seed of everything random.
    pub seed: u64,
    /// Whether progress is shown.
    pub progress: bool,
}

impl Stand {
    /// Computes every case, as many at once as there are processors; the results are in the order of the
    /// cases.
    ///
    /// # Errors
    /// That of the first case that has one; those behind it are not begun any more.
    pub(super) fn each<C: Sync, R: Send>(
        &self,
        cases: &[C],
        compute: impl Fn(&C) -> Result<R, ExperimentError> + Sync,
    ) -> Result<Vec<R>, ExperimentError> {
        let bar = self.bar(cases.len());
        let (next, done) = (AtomicUsize::new(0), Mutex::new(Vec::with_capacity(cases.len())));
        let work = || {
            loop {
                let index = next.fetch_add(1, Ordering::Relaxed);
                let Some(case) = cases.get(index) else { return };
                let result = compute(case);
                if result.is_err() {
                    next.store(cases.len(), Ordering::Relaxed);
                }
                done.lock().unwrap_or_else(PoisonError::into_inner).push((index, result));
                bar.inc(1);
            }
        };
        let processors = thread::available_parallelism().map_or(1, NonZero::get);
        thread::scope(|scope| (0..processors.min(cases.len())).for_each(|_| drop(scope.spawn(work))));
        bar.finish_and_clear();
        let mut done = done.into_inner().unwrap_or_else(PoisonError::into_inner);
        done.sort_by_key(|(index, _)| *index);
        done.into_iter().map(|(_, result)| result).collect()
    }

    /// Runs trial passes on a machine, the knob of the spindle override at `override_pct` from the start;
    /// `see` is shown every control cycle.
    ///
    /// # Errors
    /// The machine cannot follow a trial, does not come to the end of the program, or does not cut at that
    /// override.
    pub(super) fn run(
        machine: &Machine,
        trials: &[Trial],
        override_pct: f64,
        seed: u64,
        see: &mut impl FnMut(&Record),
    ) -> Result<Observation, ExperimentError> {
        let failed =
            |reason: String| ExperimentError::Machine(format!("the trial could not be made: {reason}"));
        let items = trial::program(machine, trials).map_err(|error| failed(error.to_string()))?;
        let scenario = Scenario::spindle_override(override_pct);
        let seen =
            trial::run(machine, &items, &scenario, seed, see).map_err(|error| failed(error.to_string()))?;
        if seen.outcome == Outcome::Completed && seen.passes.len() == trials.len() {
            let mut in_force = seen.passes.iter().map(|pass| trial::in_force_pct(machine, pass));
            return match in_force.find(|pct| (pct - override_pct).abs() > 0.01) {
                Some(pct) => Err(ExperimentError::Machine(format!(
                    "a trial at a spindle override of {override_pct} % was cut at {pct:.1} %: let the machine file allow \
                     {override_pct} % (override_max_pct of [spindle], design_override_pct of [threading])"
                ))),
                None => Ok(seen),
            };
        }
        let fault = seen.faults.first().map(|fault| format!("{}: {}", fault.source, fault.text));
        Err(failed(fault.unwrap_or_else(|| "the program was not run to its end".into())))
    }

    /// Runs a job of one contour, surface or seam on a machine; `see` is shown every control cycle, with what
    /// the observer measured in it.
    ///
    /// # Errors
    /// The job has errors or does not suit the machine, or it does not come to its end.
    pub(super) fn cut(
        machine: &Machine,
        name: &str,
        job: &str,
        seed: u64,
        see: &mut impl FnMut(&Record, Traced),
    ) -> Result<TraceReport, ExperimentError> {
        let failed = |reason: String| ExperimentError::Machine(format!("{name} was not made: {reason}"));
        let check = interpreter::check_job(name, job, machine);
        let seen =
            Stand::observed(machine, &check, seed, &failed, |record, seen| see(record, seen.traced()))?;
        let report = seen.traces.into_iter().next();
        report.ok_or_else(|| failed("the program was not run to its end".into()))
    }

    /// Runs a program that was checked; `see` is shown every control cycle, with who observes it. `failed`
    /// says of a reason what could not be done for it.
    ///
    /// # Errors
    /// The program has errors, or does not come to its end.
    pub(super) fn observed(
        machine: &Machine,
        check: &Check,
        seed: u64,
        failed: &impl Fn(String) -> ExperimentError,
        mut see: impl FnMut(&Record, &Observer),
    ) -> Result<Observation, ExperimentError> {
        if !check.is_good() {
            let said = check.diagnostics.iter().map(|diagnostic| diagnostic.render(false));
            return Err(failed(said.collect::<Vec<_>>().join("\n")));
        }
        let mut rig = Rig::new(machine, check.items.iter().copied(), Scenario::none(), seed)
            .map_err(|error| failed(error.to_string()))?;
        let mut observer = Observer::new(machine, &check.items);
        while rig.cycle(None, |record| {
            observer.cycle(record);
            see(record, &observer);
        }) {}
        let seen = observer.finish();
        match seen.faults.first() {
            Some(fault) => Err(failed(format!("{}: {}", fault.source, fault.text))),
            None if seen.outcome == Outcome::Completed => Ok(seen),
            None => Err(failed("the program was not run to its end".into())),
        }
    }

    fn bar(&self, cases: usize) -> ProgressBar {
        let bar = ProgressBar::new(cases as u64);
        if !self.progress {
            bar.set_draw_target(ProgressDrawTarget::hidden());
        }
        let style = ProgressStyle::with_template("{bar:24} {pos}/{len} runs");
        bar.with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whoever of several is done first, the failure is told that comes first among the cases; and those far
    /// behind it are not made for nothing.
    #[test]
    fn the_first_failure_is_told_and_ends_it() {
        let stand = Stand { machine: Machine::default(), seed: 1, progress: false };
        let (cases, made): (Vec<usize>, _) = ((0..10_000).collect(), AtomicUsize::new(0));
        let failed = stand.each(&cases, |case| {
            if (3..5000).contains(case) {
                return Err(ExperimentError::Machine(format!("case {case}")));
            }
            Ok(made.fetch_add(1, Ordering::Relaxed))
        });
        assert!(failed.is_err_and(|error| error.to_string().ends_with("case 3")));
        assert_eq!(made.into_inner(), 3);
    }
}
