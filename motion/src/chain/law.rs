//! What s does from one decision to the next, and the check that it does so: a law is integrated and compared
//! with its target and its limits before it is released.
//!
//! In: a plan. Out: samples of s in mm/sⁿ; a verdict. The check knows nothing of how a plan was made: it
//! takes jerk and acceleration from the law at the nodes of a Gauss quadrature, phase by phase, and adds up
//! speed and way itself.

use crate::change::SpeedChange;
use crate::feed::FeedBlock;
use crate::limits::Limits;
use crate::sample::Sample;

/// Relative error that a released law may have.
pub(super) const ACCURACY: f64 = 1e-6;

/// Accelerations below this, mm/s², are nothing: after hours at a creep the last bits of the time are as long
/// as a pulse that changes the feed by its own last bits.
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
    /// The same out of the beginning of a pulse of jerk.
    Fold(Fold),
}

/// A block law whose first pulse of jerk is left before its middle, at `at`, by its mirror image: with u = t
/// − at
///
/// ```text
/// j(at + u) = j(at − u),  a = 2 a(at) − a(at − u)
/// v = v(at − u) + 2 a(at) u,  s = 2 s(at) − s(at − u) + a(at) u²
/// ```
/// until u = at, where the jerk is 0 again; from there a change of speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Fold {
    block: FeedBlock,
    at: f64,
    change: SpeedChange,
}

impl Fold {
    /// A block law folded at a time in the first half of its first pulse, before the change is known; then
    /// the state from which that begins.
    pub(super) fn at_end(block: &FeedBlock, at: f64) -> Sample {
        Fold::mirrored(block, at, at)
    }

    pub(super) fn new(block: FeedBlock, at: f64, change: SpeedChange) -> Fold {
        Fold { block, at, change }
    }

    fn mirrored(block: &FeedBlock, at: f64, u: f64) -> Sample {
        let (turn, back) = (block.at(at), block.at(at - u));
        Sample {
            s: 2.0 * turn.s - back.s + turn.a * u * u,
            v: back.v + 2.0 * turn.a * u,
            a: 2.0 * turn.a - back.a,
            j: back.j,
            dj: -back.dj,
        }
    }

    /// When the change begins.
    fn turns(&self) -> f64 {
        2.0 * self.at
    }

    fn at(&self, t: f64) -> Sample {
        if t < self.at {
            return self.block.at(t);
        }
        if t < self.turns() {
            return Fold::mirrored(&self.block, self.at, t - self.at);
        }
        let behind = self.change.at(t - self.turns());
        Sample { s: Fold::at_end(&self.block, self.at).s + behind.s, ..behind }
    }

    fn settled(&self, t: f64) -> f64 {
        if t < self.turns() { self.turns() } else { self.turns() + self.change.settled(t - self.turns()) }
    }

    fn duration(&self) -> f64 {
        self.turns() + self.change.duration()
    }

    fn ends(&self) -> [f64; 7] {
        let [a, b, c] = self.change.ends().map(|end| self.turns() + end);
        [self.at, self.turns(), a, b, c, c, c]
    }

    /// Of the pulse the whole, although only its beginning is gone through; of its mirror image the
    /// acceleration at the end.
    fn peak(&self) -> Limits {
        let (block, change) = (self.block.peak(), self.change.peak());
        let turn = Fold::at_end(&self.block, self.at);
        Limits {
            v: turn.v.max(change.v),
            a: turn.a.max(change.a),
            j: block.j.max(change.j),
            dj: block.dj.max(change.dj),
        }
    }
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
            Law::Fold(fold) => fold.at(t),
        }
    }

    pub(super) fn duration(&self) -> f64 {
        match self {
            Law::Rest => f64::INFINITY,
            Law::Block(block) => block.duration(),
            Law::Change(change) => change.duration(),
            Law::Fold(fold) => fold.duration(),
        }
    }

    pub(super) fn end_speed(&self) -> f64 {
        match self {
            Law::Rest => 0.0,
            Law::Block(block) => block.end_feed(),
            Law::Change(change) => change.end_speed(),
            Law::Fold(fold) => fold.change.end_speed(),
        }
    }

    pub(super) fn way(&self) -> f64 {
        match self {
            Law::Rest => 0.0,
            Law::Block(block) => block.length(),
            Law::Change(change) => change.distance(),
            Law::Fold(fold) => fold.at(fold.duration()).s,
        }
    }

    /// The first moment at or after `t` without jerk: there a change of speed can take over.
    pub(super) fn settled(&self, t: f64) -> f64 {
        match self {
            Law::Rest => t,
            Law::Block(block) => block.settled(t),
            Law::Change(change) => change.settled(t),
            Law::Fold(fold) => fold.settled(t),
        }
    }

    /// The block law, if at `t` it is in the first half of the pulse that begins to speed it up: there it can
    /// be folded.
    pub(super) fn folds(&self, t: f64) -> Option<&FeedBlock> {
        match self {
            Law::Block(block) if block.accel().dv() > 0.0 && t < 0.5 * block.ends()[0] => Some(block),
            _ => None,
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
            Law::Fold(fold) => t.max(fold.duration()),
        }
    }

    /// The highest speed that the law still makes for from `t` on; of a law that brakes, the speed at its
    /// end.
    pub(super) fn goal(&self, t: f64) -> f64 {
        match self {
            Law::Block(block) if t <= block.ends()[3] => block.peak_feed(),
            law => law.end_speed(),
        }
    }

    fn ends(&self) -> [f64; 7] {
        match self {
            Law::Rest => [0.0; 7],
            Law::Fold(fold) => fold.ends(),
            Law::Block(block) => block.ends(),
            Law::Change(change) => {
                let [a, b, c] = change.ends();
                [a, b, c, c, c, c, c]
            }
        }
    }

    /// The highest speed.
    pub(super) fn peak_speed(&self) -> f64 {
        self.peak().v
    }

    fn peak(&self) -> Limits {
        match self {
            Law::Rest => Limits { v: 0.0, a: 0.0, j: 0.0, dj: 0.0 },
            Law::Fold(fold) => fold.peak(),
            Law::Block(block) => block.peak(),
            Law::Change(change) => change.peak(),
        }
    }

    /// Whether the law does what it promises: at most 70 samples, whatever the law. A pulse of sin² jerk is
    /// integrated in two halves, to some 1e-8.
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

#[cfg(test)]
mod tests {
    use super::{Fold, Law};
    use crate::change::SpeedChange;
    use crate::feed::FeedBlock;
    use crate::limits::Limits;

    /// What bends count on (M181) holds for a folded pulse, too: it has at most what its mirror image has.
    #[test]
    fn m181_peaks_do_not_come_together_in_a_fold() {
        let limits = [
            Limits { v: 200.0, a: 2000.0, j: 80_000.0, dj: 8e6 },
            Limits { v: 200.0, a: 300.0, j: 80_000.0, dj: 2e6 },
            Limits { v: 200.0, a: 9000.0, j: 20_000.0, dj: 8e8 },
        ];
        for limits in &limits {
            for (v, peak) in [(0.0, 200.0), (40.0, 60.0), (199.0, 200.0)] {
                let block = FeedBlock::plan(1e3, v, peak, v, limits).expect("a long way");
                for k in 1..50 {
                    let at = 0.5 * block.ends()[0] * f64::from(k) / 50.0;
                    let end = Fold::at_end(&block, at);
                    let change = SpeedChange::plan(end.v, end.a, v, limits);
                    let fold = Law::Fold(Fold::new(block, at, change));
                    for step in 0..200 {
                        let now = fold.at(fold.duration() * f64::from(step) / 200.0);
                        let [a, j, dj] =
                            [now.a / limits.a, now.j / limits.j, now.dj / limits.dj].map(f64::abs);
                        assert!(0.8 * a + 0.472 * j <= 1.0 + 1e-9, "{now:?} of {limits:?}, fold at {at}");
                        assert!(0.7 * a + 0.4 * j + 0.121 * dj <= 1.0 + 1e-9, "{now:?} of {limits:?}");
                    }
                }
            }
        }
    }
}
