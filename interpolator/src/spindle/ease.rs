//! The override of a spindle that leads a tool along a thread, eased. In: the override that is allowed, once
//! a tick. Out: the one that is commanded.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | m, e | % | override allowed, and commanded |
//! | R, S | 1/min per s, 1/min | ramp of the drive, programmed speed |
//! | τ, T | s | time of each of three lags, 35 ms; tick |
//!
//! ```text
//! r follows m by at most 100 R/S a second;  e is r behind three lags 1/(1 + τ s)                 (M135)
//! ```
//! A drive changes its speed at once as fast as its ramp is, and who counts knows of it only when some counts
//! are wrong. Behind the lags the acceleration comes within 0.15 s, and its jerk is R'/(3.7 τ) at most, with
//! R' the acceleration of the ramp: the observer keeps up with that. Only a pass in hand needs it; where
//! nobody cuts, and whenever the spindle has to stop, it is commanded as before.

/// Three lags in a row.
const LAGS: usize = 3;
/// Time of each, s.
const LAG_S: f64 = 0.035;
/// What is closer than this is there, per cent.
const THERE_PCT: f64 = 1e-6;

/// An eased override, per cent.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ease {
    ramped: f64,
    lags: [f64; LAGS],
    /// What a lag takes over in a tick.
    share: f64,
}

impl Ease {
    /// At 100 %.
    pub(super) fn new(tick_s: f64) -> Ease {
        Ease { ramped: 100.0, lags: [100.0; LAGS], share: 1.0 - libm::exp(-tick_s / LAG_S) }
    }

    /// What is commanded, per cent.
    pub(super) fn pct(&self) -> f64 {
        self.lags[LAGS - 1]
    }

    /// Nothing is eased: this is commanded at once.
    pub(super) fn jump(&mut self, pct: f64) {
        (self.ramped, self.lags) = (pct, [pct; LAGS]);
    }

    /// A tick in which `pct` is allowed, and the drive's ramp is `step_pct`.
    pub(super) fn tick(&mut self, pct: f64, step_pct: f64) {
        self.ramped = pct.clamp(self.ramped - step_pct, self.ramped + step_pct);
        let mut input = self.ramped;
        for lag in &mut self.lags {
            *lag += self.share * (input - *lag);
            input = *lag;
        }
        if self.ramped == pct && self.lags.iter().all(|lag| (lag - pct).abs() < THERE_PCT) {
            self.jump(pct);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TICK_S: f64 = 0.002;

    #[test]
    fn it_gets_there_without_a_step_of_the_acceleration() {
        // 800 1/min per s at S1200.
        let (ramp, mut ease) = (100.0 * 800.0 / 1200.0, Ease::new(TICK_S));
        let mut course = vec![100.0, 100.0];
        while ease.pct() != 60.0 {
            ease.tick(60.0, ramp * TICK_S);
            course.push(ease.pct());
            assert!(course.len() < 1000, "{} % after 2 s", ease.pct());
        }
        let rates: Vec<f64> = course.windows(2).map(|c| (c[1] - c[0]) / TICK_S).collect();
        let changes = rates.windows(2).map(|r| (r[1] - r[0]).abs() / TICK_S);
        assert!(rates.iter().all(|rate| (-ramp - 1e-9..=0.0).contains(rate)), "it overshoots");
        let jerk = changes.fold(0.0, f64::max);
        assert!(jerk < ramp / (3.4 * LAG_S), "{jerk} %/s² of {}", ramp / LAG_S);
    }

    #[test]
    fn where_nobody_cuts_it_jumps() {
        let mut ease = Ease::new(TICK_S);
        ease.tick(0.0, 1.0);
        ease.jump(80.0);
        assert_eq!(ease.pct(), 80.0);
        ease.tick(80.0, 1.0);
        assert_eq!(ease.pct(), 80.0);
    }
}
