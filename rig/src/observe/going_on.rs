//! A run that goes on with one that was broken off: both cut one thread. In: the observer of the run before,
//! and the truth of its machine while that came to rest. Out: an observer that judges the thread of both.

use protocol::Truth;

use super::rings::{Coasting, ResumedReport};
use super::{Observer, ThreadReport};

impl Observer {
    /// Takes a cycle in which the machine comes to rest without its controls: what the tool does to the
    /// thread in which it stands counts for the gauge.
    pub fn run_down(&mut self, truth: &Truth) {
        let Some(pass) = &self.current else { return };
        let off_helix = pass.off_helix(truth);
        self.rings.part_from(&self.gauged);
        // Before the face of its part a tool turns in the air, as far as its flanks do not reach.
        if off_helix.is_some() || pass.pass().returns() {
            self.gauged.iter_mut().for_each(|gauged| gauged.cycle(pass.pass(), truth));
            self.grooved.iter_mut().for_each(|grooved| grooved.cycle(pass.pass(), truth));
        }
        let origin_mm = pass.origin_mm().map_or(0.0, |[_, z]| z);
        let tool = Coasting { pass: pass.pass().pass, origin_mm, off_helix };
        self.rings.coast(tool, truth, self.out.part_error_um);
    }

    /// The same observer of a run that goes on with another one of the same program.
    #[must_use]
    pub fn going_on(mut self, mut before: Observer) -> Observer {
        before.close();
        let in_place_mm = before.out.tools.get(&before.setpoints.now().tool).and_then(|tool| tool.origin_mm);
        self.threads = before.threads;
        self.rings = before.rings.switched_on();
        if let Some(now) = self.gauged.first().cloned() {
            self.gauged = before.gauged;
            let gauges = self.gauged.iter_mut().chain(self.rings.gauges());
            gauges.for_each(|gauged| gauged.goes_on(&now, in_place_mm));
        }
        self.grooved = match (self.grooved.take(), before.grooved) {
            (Some(now), Some(before)) => Some(before.goes_on(&now)),
            (now, _) => now,
        };
        self.earlier = before.earlier;
        self.earlier.append(&mut before.out.passes);
        self
    }

    /// The same observer, told which run that is and where it goes on with it.
    #[must_use]
    pub fn resumed(mut self, report: ResumedReport) -> Observer {
        self.rings.report = Some(report);
        self
    }

    /// The same observer of a program that is begun at a line: what was cut before is not known to it.
    #[must_use]
    pub fn from_line(mut self, line: u32) -> Observer {
        self.out.from_line = Some(line);
        self
    }

    /// What all passes come to, those of the runs before included.
    pub(super) fn thread(&self) -> ThreadReport {
        let all: Vec<_> = self.earlier.iter().chain(&self.out.passes).cloned().collect();
        self.threads.report(&all)
    }
}
