//! The end of a run. In: how it ended, what the observer makes of it. Out: what of that is not true.

use protocol::{Axis, MachineState, Module};
use rig::observe::{Observation, Outcome, Record};
use rig::supervisor::End;

use super::{Broken, Judge, Reference, bounds, excuse};
use crate::event::{Event, Fate, SpindleFault, Trouble, What};

/// An axis that is slower than this stands, mm/s: at rest it is held by a loop that sees whole counts.
const STANDS_MM_S: f64 = 0.5;
/// And a spindle, 1/min: its loop swings through rest.
const STANDS_RPM: f64 = 40.0;
/// Cycles before the end in which a spindle that begins to turn is not seen.
const LAST_CYCLES: u64 = 40;
/// Two ends are the same place, mm.
const SAME_MM: f64 = 1e-6;

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ending {
    /// The interpolator said that it is finished.
    Finished,
    /// A process had died, and the launcher let the rest go.
    Launcher(End),
    /// It did not end in the time it may take.
    Never,
}

impl Judge<'_> {
    /// What the end of the run breaks; `last` is its last cycle.
    pub fn finish(&mut self, ending: Ending, last: &Record, observation: &Observation) {
        let now = last.truth.cycle.0;
        let summary = self.summary(ending, last, observation);
        let found = match self.known.reference {
            Some(_) => self.end(ending, last).or(summary),
            None => summary.or_else(|| self.end(ending, last)),
        };
        if let Some((invariant, text)) = found {
            self.broken.get_or_insert(Broken::new(invariant, now, text));
        }
    }

    fn end(&self, ending: Ending, last: &Record) -> Option<(&'static str, String)> {
        let (now, state) = (last.truth.cycle.0, last.machine.state());
        let axes = || {
            let told = last.axes.iter().map(|(axis, status)| format!("{axis} {}", status.state().name()));
            told.collect::<Vec<_>>().join(", ")
        };
        match ending {
            Ending::Never => {
                return Some((
                    "no-end",
                    format!("machine {state:?}, {}, {:.0} 1/min", axes(), last.truth.spindle_rpm),
                ));
            }
            Ending::Launcher(End::NoRest(moving)) => return Some(("no-rest", moving.to_string())),
            Ending::Launcher(End::Rest | End::PlantGone) => {}
            Ending::Finished => {
                if !matches!(state, MachineState::Ended | MachineState::Fault) {
                    return Some(("untrue", format!("finished in state {state:?}")));
                }
            }
        }
        let speed = |axis: &Axis| last.truth.axes[axis.index()].velocity_mm_s;
        let pushed = |axis: &Axis| last.truth.axes[axis.index()].force_n != 0.0 || self.known.pushed(now);
        if let Some((axis, _)) =
            last.axes.iter().find(|(axis, _)| speed(axis).abs() > STANDS_MM_S && !pushed(axis))
        {
            return Some(("no-rest", format!("{axis} moves at {:.3} mm/s in the end", speed(axis))));
        }
        // What begins to turn it in the last moment nobody can know any more.
        let late = |at: u64| at + LAST_CYCLES > now;
        let cycle_s = self.known.machine.general.cycle_s;
        // Nor can who has no encoder.
        let dies = |event: &Event| matches!(event.what, What::Plant(Trouble::Stands(_)));
        let blind = self.known.events.iter().any(dies);
        let turned = |event: &Event| match event.what {
            // One that was held winds its drive up, until it is let go.
            What::Plant(Trouble::Spindle(SpindleFault::Jam, s)) => {
                blind || late(event.at) || late(event.at + (s / cycle_s) as u64)
            }
            What::Plant(Trouble::Spindle(..)) => blind || late(event.at),
            // A drive at its limit swings over when the load lets go.
            What::Plant(Trouble::Load(..) | Trouble::Dip(..)) => blind,
            _ => false,
        };
        let coasts = self.known.events.iter().any(|event| excuse::coasts(&event.what) || turned(event));
        if last.truth.spindle_rpm.abs() > STANDS_RPM && !coasts {
            return Some((
                "no-rest",
                format!("the spindle turns at {:.1} 1/min in the end", last.truth.spindle_rpm),
            ));
        }
        let lifted = self.tool.can_leave(&self.known, last.truth.cycle.0);
        (self.tool.is_touching() && lifted)
            .then(|| ("in-the-part", "the tool is in the part in the end".into()))
    }

    /// The summary says what happened.
    fn summary(
        &self,
        ending: Ending,
        last: &Record,
        observation: &Observation,
    ) -> Option<(&'static str, String)> {
        let all: Vec<u32> = self.known.passes.keys().copied().collect();
        let complete: Vec<u32> =
            observation.passes.iter().filter(|pass| pass.complete).map(|pass| pass.pass).collect();
        if complete.windows(2).any(|pair| pair[0] >= pair[1]) {
            return Some(("twice", format!("passes {complete:?}")));
        }
        let Some(reference) = self.known.reference else {
            let told = || format!("{:?}: {:?}", observation.outcome, observation.faults.first());
            return (observation.outcome != Outcome::Completed || complete != all)
                .then(|| ("undisturbed", told()));
        };
        let (moves, taken) = (last.machine.moves, last.machine.taken);
        if moves > reference.moves || taken > reference.taken {
            return Some((
                "twice",
                format!("{moves} moves of {}, {taken} steps of {}", reference.moves, reference.taken),
            ));
        }
        let events = self.known.events;
        let faults = || observation.faults.iter().map(|fault| format!("{} {}", fault.source, fault.code));
        match observation.outcome {
            Outcome::Completed if ending == Ending::Finished => {
                let done = (moves, taken) == (reference.moves, reference.taken);
                if complete != all || !done || !self.is_there(last, reference) {
                    let text = format!(
                        "completed with passes {complete:?} of {all:?}, {moves} moves of {}",
                        reference.moves
                    );
                    return Some(("untrue", text));
                }
                let before = |event: &&Event| {
                    excuse::ends(&event.what)
                        && event.at + bounds::stop(self.known.machine) < self.measured.worked
                };
                if let Some(event) = events.iter().find(before) {
                    return Some(("untrue", format!("completed in spite of {}", event.told())));
                }
            }
            Outcome::Completed => return Some(("untrue", format!("completed, but {ending:?}"))),
            Outcome::Stopped
                if !events.iter().any(|event| excuse::is_stop(&event.what)) && !damaged(events) =>
            {
                return Some(("broken-off", "stopped, and nobody pressed stop".into()));
            }
            Outcome::Faulted
                if events
                    .iter()
                    .all(|event| excuse::is_harmless(&event.what) || excuse::is_stop(&event.what)) =>
            {
                return Some((
                    "broken-off",
                    format!("faults from what does no harm: {:?}", faults().collect::<Vec<_>>()),
                ));
            }
            _ => {}
        }
        None
    }

    /// Whether every axis has been led to where it ends undisturbed. A regulator that hangs says nothing of
    /// its last cycles, and nobody misses it so soon: its axis has to be there in truth, as near as is in
    /// position.
    fn is_there(&self, last: &Record, reference: &Reference) -> bool {
        let now = last.truth.cycle;
        (0..).zip(last.axes).all(|(i, (axis, status)): (usize, _)| {
            let off = |here: &[f64], there: &[f64]| (here[i] - there[i]).abs();
            let hangs = status.cycle < now;
            match self.known.machine.axis.get(axis).filter(|_| hangs) {
                None => off(&self.measured.end_mm, &reference.end_mm) < SAME_MM,
                Some(config) => off(&self.measured.slides_mm, &reference.slides_mm) <= config.in_position_mm,
            }
        })
    }
}

/// A bit of a message may be one of a button; who has died stops the program.
fn damaged(events: &[crate::event::Event]) -> bool {
    events.iter().any(|event| match event.what {
        What::Packet(_, Fate::Corrupt(_), _) => true,
        What::Kill(module) | What::Freeze(module, _) => module != Module::Interpreter,
        _ => false,
    })
}
