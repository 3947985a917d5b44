//! Gauges that an observer holds against what was cut: GO and NO-GO of threads, the drawing of a groove.

use protocol::{Motion, Truth};

use super::gauged::{Drill, GaugeAsked, GaugeReport, Gauged, GrooveAsked, Grooved};
use super::{Led, Observer, Outcome, Summary};

impl Observer {
    /// The same observer with one more gauge for a thread; after [`Observer::of_part`], if there is one.
    ///
    /// # Panics
    /// If no gauge can be made of what is asked: see [`gauge::Nominal::check`].
    #[must_use]
    pub fn with_gauge(mut self, asked: GaugeAsked) -> Observer {
        self.gauged.push(Gauged::new(&self.machine, &self.program, asked));
        self
    }

    /// The same observer with a drawing that the groove is held against.
    #[must_use]
    pub fn with_groove(mut self, asked: GrooveAsked) -> Observer {
        self.grooved = Some(Grooved::new(&self.machine, &self.program, asked));
        self
    }

    /// The same observer of a program that does not say how deep some of its passes go below the crest: what
    /// they have is a guess.
    #[must_use]
    pub fn guessing_depths(mut self, passes: impl IntoIterator<Item = u32>) -> Observer {
        for number in passes {
            self.program.entry(number).and_modify(|planned| planned.depth_mm = 0.0);
        }
        self
    }

    /// What they say: of several the worst stands for all. A part that is not finished is none yet.
    pub(super) fn report_gauges(&mut self) {
        let said: Vec<_> = self.gauged.iter().map(Gauged::report).collect();
        let said = match self.out.outcome {
            Outcome::Completed => said,
            _ => said.into_iter().map(GaugeReport::unfinished).collect(),
        };
        self.out.gauge = GaugeReport::worst(said.iter().cloned());
        self.out.gauges = if said.len() > 1 { said } else { Vec::new() };
    }

    /// What a tool turns before the thread is gauged.
    pub(super) fn take_turned(&mut self, truth: &Truth) {
        if self.gauged.is_empty() {
            return;
        }
        let Led { tool, motion } = self.setpoints.now();
        let note = self.out.tools.get(&tool);
        let (origin_mm, drill) = (note.and_then(|note| note.origin_mm), Drill::of(tool, note));
        for gauged in self.gauged.iter_mut().chain(self.rings.gauges()) {
            gauged.turns(motion == Motion::Feed, origin_mm, drill, truth);
        }
    }
}

impl Summary {
    /// What each gauge says, in the order of the program.
    pub fn gauged(&self) -> &[GaugeReport] {
        if self.gauges.is_empty() { self.gauge.as_slice() } else { &self.gauges }
    }

    /// What the gauge of a pass says; of a chain that of its first thread.
    pub fn gauge_of(&self, pass: u32) -> Option<&GaugeReport> {
        self.gauged().iter().find(|gauge| gauge.passes.is_empty() || gauge.passes.contains(&pass))
    }

    /// The gauge that a run is repeated with: several threads have their names from the program alone.
    pub fn repeats_gauge(&self) -> Option<String> {
        self.gauge.as_ref().filter(|_| self.gauges.is_empty()).map(|gauge| gauge.name.clone())
    }
}
