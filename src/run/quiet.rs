//! For how long nothing has happened, in time of the wall.

use std::time::Duration;

use process::ipc::time::Moment;

/// The longest time between two looks that counts: a launcher that was stopped itself has not waited.
const STEP: Duration = Duration::from_millis(100);

/// A quiet, which begins when it is made.
pub(crate) struct Quiet {
    lasts: Duration,
    looked: Moment,
}

impl Quiet {
    /// Nothing has happened yet.
    pub(crate) fn new() -> Quiet {
        Quiet { lasts: Duration::ZERO, looked: Moment::now() }
    }

    /// Something has happened.
    pub(crate) fn begins_anew(&mut self) {
        *self = Quiet::new();
    }

    /// Nothing has happened since the last look. How long the quiet lasts now.
    pub(crate) fn look(&mut self) -> Duration {
        self.lasts += self.looked.elapsed().min(STEP);
        self.looked = Moment::now();
        self.lasts
    }

    /// How long it lasted at the last look.
    pub(crate) fn lasts(&self) -> Duration {
        self.lasts
    }
}
