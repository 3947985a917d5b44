//! What s does from one decision to the next, and the check that it does so: a law is integrated and compared with its
//! target and its limits before it is released.
//!
//! In: a plan. Out: samples of s in mm/sⁿ; a verdict. The check knows nothing of how a plan was made: it takes jerk and
//! acceleration from the law at the nodes of a Gauss quadrature, phase by phase, and adds up speed and way itself.

use crate::change::SpeedChange;
use crate::feed::FeedBlock;
use crate::limits::Limits;
use crate::sample::Sample;

/// Relative error that a released law may have.
pub(super) const ACCURACY: f64 = 1e-6;

/// Accelerations below this, mm/s², are nothing: after hours at a creep the last bits of the time are as long as a pulse
/// that changes the feed by its own last bits.
const LEAST_ACCELERATION: f64 = 1e-3;

/// Nodes and weights of the Gauss–Legendre quadrature with five points on [0, 1].
const GAUSS: [(f64, f64); 5] = [
    (0.046_910_077_030_668, 0.118_463_442_528_094_5),
    (0.230_765_344_947_158_45, 0.239_314_335_249_683_23),
    (0.5, 0.284_444_444_444_444_45),
    (0.769_234_655_052_841_5, 0.239_314_335_249_683_23),
    (0.953_089_922_969_332, 0.118_463_442_528_094_5),
];

/// What s does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Law {
    /// Stands.
    Rest,
    /// To the end of a stretch.
    Block(FeedBlock),
    /// To another speed, wherever that is.
    Change(SpeedChange),
}

/// What a law has to keep.
#[derive(Clone, Copy, Debug)]
pub(super) struct Promise {
    pub(super) start: f64,
    pub(super) acceleration: f64,
    pub(super) end: f64,
    pub(super) way: f64,
    pub(super) limits: Limits,
}

impl Law {
    pub(super) fn at(&self, t: f64) -> Sample {
        match self {
            Law::Rest => Sample::default(),
            Law::Block(block) => block.at(t),
            Law::Change(change) => change.at(t),
        }
    }

    pub(super) fn duration(&self) -> f64 {
        match self {
            Law::Rest => f64::INFINITY,
            Law::Block(block) => block.duration(),
            Law::Change(change) => change.duration(),
        }
    }

    pub(super) fn end_speed(&self) -> f64 {
        match self {
            Law::Rest => 0.0,
            Law::Block(block) => block.end_feed(),
            Law::Change(change) => change.end_speed(),
        }
    }

    pub(super) fn way(&self) -> f64 {
        match self {
            Law::Rest => 0.0,
            Law::Block(block) => block.length(),
            Law::Change(change) => change.distance(),
        }
    }

    /// The first moment at or after `t` without jerk: there a change of speed can take over.
    pub(super) fn settled(&self, t: f64) -> f64 {
        match self {
            Law::Rest => t,
            Law::Block(block) => block.settled(t),
            Law::Change(change) => change.settled(t),
        }
    }

    /// The first moment at or after `t` at constant speed: there any law can take over.
    pub(super) fn level(&self, t: f64) -> f64 {
        match self {
            Law::Rest => t,
            Law::Block(block) => {
                let [.., up, braking, _, _, end] = block.ends();
                if t <= braking { t.max(up) } else { end }
            }
            Law::Change(change) => t.max(change.duration()),
        }
    }

    /// The highest speed that the law still makes for from `t` on; of a law that brakes, the speed at its end.
    pub(super) fn goal(&self, t: f64) -> f64 {
        match self {
            Law::Block(block) if t <= block.ends()[3] => block.peak_feed(),
            law => law.end_speed(),
        }
    }

    fn ends(&self) -> [f64; 7] {
        match self {
            Law::Rest => [0.0; 7],
            Law::Block(block) => block.ends(),
            Law::Change(change) => {
                let [a, b, c] = change.ends();
                [a, b, c, c, c, c, c]
            }
        }
    }

    fn peak(&self) -> Limits {
        match self {
            Law::Rest => Limits { v: 0.0, a: 0.0, j: 0.0, dj: 0.0 },
            Law::Block(block) => block.peak(),
            Law::Change(change) => change.peak(),
        }
    }

    /// Whether the law does what it promises: at most 70 samples, whatever the law. A pulse of sin² jerk is integrated
    /// in two halves, to some 1e-8.
    pub(super) fn keeps(&self, promise: &Promise) -> bool {
        let Promise { start, acceleration, end, way, limits } = promise;
        let (peak, most) = (self.peak(), 1.0 + ACCURACY);
        let within = peak.v <= limits.v * most
            && peak.a <= limits.a * most
            && peak.j <= limits.j * most
            && peak.dj <= limits.dj * most;
        let (mut s, mut v, mut a, mut from) = (0.0, *start, *acceleration, 0.0);
        let mut forwards = true;
        for to in self.ends() {
            let half = 0.5 * (to - from).max(0.0);
            for begin in [from, from + half] {
                if half <= 0.0 {
                    continue;
                }
                for (node, weight) in GAUSS {
                    let sample = self.at(begin + node * half);
                    s += weight * half * sample.v;
                    v += weight * half * sample.a;
                    a += weight * half * sample.j;
                    forwards &= sample.v >= -ACCURACY * (start.abs() + peak.v);
                }
            }
            from = to;
        }
        let near = |got: f64, wanted: f64, scale: f64| (got - wanted).abs() <= ACCURACY * scale;
        within
            && forwards
            && near(s, *way, way.abs() + peak.v * 1e-3)
            && near(v, *end, peak.v + start.abs())
            && near(a, 0.0, peak.a + acceleration.abs() + LEAST_ACCELERATION)
            && s.is_finite()
    }
}
