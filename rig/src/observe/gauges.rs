//! Gauges that an observer holds against what was cut: GO and NO-GO of a thread, the drawing of a groove.

use protocol::{Motion, Truth};

use super::gauged::{GaugeAsked, Gauged, GrooveAsked, Grooved};
use super::{Led, Observer};

impl Observer {
    /// The same observer with a gauge for the thread; after [`Observer::of_part`], if there is one.
    ///
    /// # Panics
    /// If no gauge can be made of what is asked: see [`gauge::Nominal::check`].
    #[must_use]
    pub fn with_gauge(mut self, asked: GaugeAsked) -> Observer {
        self.gauged = Some(Gauged::new(&self.machine, &self.program, asked));
        self
    }

    /// The same observer with a drawing that the groove is held against.
    #[must_use]
    pub fn with_groove(mut self, asked: GrooveAsked) -> Observer {
        self.grooved = Some(Grooved::new(&self.machine, &self.program, asked));
        self
    }

    /// What a tool turns before the thread is gauged.
    pub(super) fn take_turned(&mut self, truth: &Truth) {
        let Some(_) = &self.gauged else { return };
        let Led { tool, motion } = self.setpoints.now();
        let origin_mm = self.out.tools.get(&tool).and_then(|tool| tool.origin_mm);
        for gauged in self.gauged.iter_mut().chain(self.rings.gauges()) {
            gauged.turns(motion == Motion::Feed, origin_mm, truth);
        }
    }
}
