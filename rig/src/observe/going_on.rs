//! A run that goes on with one that was broken off: both cut one thread. In: the observer of the run before,
//! and the truth of its machine while that came to rest. Out: an observer that judges the thread of both.

use protocol::Truth;

use super::{Observer, ThreadReport};

impl Observer {
    /// Takes a cycle in which the machine comes to rest without its controls: what the tool does to the
    /// thread in which it stands counts for the gauge.
    pub fn run_down(&mut self, truth: &Truth) {
        if let Some((gauged, pass)) = self.gauged.as_mut().zip(self.current.as_ref()) {
            gauged.cycle(pass.pass(), truth);
        }
    }

    /// The same observer of a run that goes on with another one of the same program.
    #[must_use]
    pub fn going_on(mut self, mut before: Observer) -> Observer {
        before.close();
        if self.gauged.is_some() {
            self.gauged = before.gauged;
        }
        self.threads = before.threads;
        self.earlier = before.earlier;
        self.earlier.append(&mut before.out.passes);
        self
    }

    /// What all passes come to, those of the runs before included.
    pub(super) fn thread(&self) -> ThreadReport {
        let all: Vec<_> = self.earlier.iter().chain(&self.out.passes).cloned().collect();
        self.threads.report(&all)
    }
}
