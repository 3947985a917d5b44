//! The observer by itself, as the reference has it: a spindle whose angle is known in closed form, an encoder
//! that rounds it, the observer at 1 kHz. In: which observer, encoder, bandwidth, case. Out: error of the
//! helix in µm.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | n0, n1 | rev/s | speed before and after; it changes evenly |
//! | t0, D | s | when it begins to change, how long that takes |
//! | c | count | angle times 4 N, and a phase: where the encoder's counts lie |
//! | F | mm/rev | lead |
//!
//! ```text
//! angle = n0 t + (n1 − n0) g(t − t0),  g(x) = x²/2D within the change, x − D/2 after it
//! the observer is given floor(c) + 1/2; error of the helix = F (observed − c)/4N
//! ```

use motion::SpindleObserver;

use super::{Case, LEAD_MM};

/// Period of the measurement, s.
const T: f64 = 1e-3;
/// When the speed begins to change, s.
const CHANGE_S: f64 = 1.0;
/// From here on the start is forgotten, s.
const SETTLED_S: f64 = 0.8;
/// Phases of the count: of one alone a beat between counts and cycles may hide an error.
pub(super) const PHASES: u32 = 9;
/// 500 1/min is 250/3 counts a cycle at 2500 lines, which would lock the phase for ever. No spindle turns so
/// evenly.
const S_RPM: f64 = 500.37;

/// Which observer.
#[derive(Clone, Copy, Debug)]
pub(super) enum Kind {
    /// As the reference has it (M53).
    Plain,
    /// As the regulator uses it (`regulator/src/spindle.rs`).
    Used,
}

impl Kind {
    fn observer(self, bandwidth_hz: f64) -> SpindleObserver {
        match self {
            Kind::Plain => SpindleObserver::new(bandwidth_hz, T),
            Kind::Used => SpindleObserver::of_counts(bandwidth_hz, T),
        }
    }
}

/// Largest errors of the helix over a case, µm.
#[derive(Clone, Copy, Debug)]
pub(super) struct Errors {
    /// Median over the phases.
    pub(super) typical_um: f64,
    /// Largest of any phase.
    pub(super) worst_um: f64,
}

#[derive(Clone, Copy, Debug)]
struct Turning {
    before: f64,
    after: f64,
    ramp_s: f64,
    seconds: f64,
}

impl Turning {
    fn of(case: Case) -> Turning {
        let even = S_RPM / 60.0;
        let (before, share, ramp_s, seconds) = match case {
            Case::Constant | Case::Force => (even, 1.0, 1.0, 3.0),
            Case::OverrideRamp => (even, 0.6, 0.3, 2.0),
            Case::Dip => (even, 0.97, 0.015, 2.0),
            Case::Slow => (0.2 / 60.0, 1.0, 1.0, 20.0),
        };
        Turning { before, after: share * before, ramp_s, seconds }
    }

    /// Angle in revolutions.
    fn angle(&self, t: f64) -> f64 {
        let x = (t - CHANGE_S).max(0.0);
        let gained = if x < self.ramp_s { 0.5 * x * x / self.ramp_s } else { x - 0.5 * self.ramp_s };
        self.before * t + (self.after - self.before) * gained
    }
}

/// Error of the helix over time, s and µm from the change on, once the start is forgotten.
pub(super) fn course(kind: Kind, lines: u32, bandwidth_hz: f64, case: Case, phase: f64) -> Vec<(f64, f64)> {
    let (turning, quanta) = (Turning::of(case), 4.0 * f64::from(lines));
    let truth = |cycle: u32| turning.angle(f64::from(cycle) * T) * quanta + phase;
    let mut observer = kind.observer(bandwidth_hz);
    observer.start(truth(0), turning.before * quanta);
    let mut errors = Vec::new();
    for cycle in 1..=(turning.seconds / T) as u32 {
        let count = truth(cycle);
        observer.update(count.floor() + 0.5);
        let t = f64::from(cycle) * T;
        if t >= SETTLED_S {
            let error = 1e3 * LEAD_MM * (observer.at(0.0).angle - count) / quanta;
            errors.push((t - CHANGE_S, error));
        }
    }
    errors
}

/// Largest errors over every phase of the count.
pub(super) fn errors(kind: Kind, lines: u32, bandwidth_hz: f64, case: Case) -> Errors {
    let largest = |phase: u32| {
        let phase = (f64::from(phase) + 0.37) / f64::from(PHASES);
        let course = course(kind, lines, bandwidth_hz, case, phase);
        course.into_iter().map(|(_, error)| error.abs()).fold(0.0, f64::max)
    };
    let mut all: Vec<f64> = (0..PHASES).map(largest).collect();
    all.sort_by(f64::total_cmp);
    let typical_um = all.get(all.len() / 2).copied().unwrap_or_default();
    Errors { typical_um, worst_um: all.last().copied().unwrap_or_default() }
}
