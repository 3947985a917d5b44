//! How fine positions, and what is derived from them, have to be (M28–M35). In: tolerance in µm, feed in
//! mm/min, acceleration in m/s², jerk in m/s³, cycle in Hz, counts per mm. Out: counts, counts/cycleⁿ,
//! mm/cycleⁿ, percent. Source: "Investigation of the required discreteness of interpolation movement
//! parameters in cyber-physical systems", Eqs. (2)–(20); M28 follows from the binomial coefficients of a
//! difference.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | k | 1/mm | counts of position per mm |
//! | f | Hz | cycle in which positions are counted |
//! | F, a, J | mm/min, m/s², m/s³ | feed, acceleration, jerk |
//! | V_T, a_T, J_T | counts/cycleⁿ | the same as a control sees them that counts (M29) |
//! | P | µm | tolerance of the part |
//! | K_m, K_F, K_a, K_J | – | into how many steps tolerance, highest feed, acceleration, jerk are to be divided |
//! | d | mm/cycleⁿ | coarsest step that does (M30–M33) |
//!
//! ```text
//! error of the n-th difference of rounded positions ≤ 2ⁿ⁻¹ counts, rms (C(2n, n)/12)^½ counts/cycleⁿ   (M28)
//! V_T = F k/(60 f),  a_T = 1000 a k/f²,  J_T = 1000 J k/f³                                             (M29)
//! d = P/(1000 K_m),  F/(60 f K_F),  1000 a/(f² K_a),  1000 J/(f³ K_J)                              (M30–M33)
//! discrepancy = (1/k)/d                                                                                (M34)
//! order = floor(lg d + 1e-9)                                                                           (M35)
//! ```

/// Rounding of a quotient that decides whether it is a whole number, relative; and that of M35, absolute.
const ROUNDING: f64 = 1e-9;

/// How a control counts: positions in steps of 1/k, once a cycle. Both values are positive.
///
/// ```
/// // A control of 1 µm and 1 ms sees a feed of 10 mm/min as a count in every sixth cycle.
/// let counts = adviser::resolution::Counts { per_mm: 1000.0, cycle_hz: 1000.0 };
/// let error = counts.feed_error(10.0);
/// assert_eq!((error.low, error.high), (0.0, 1.0));
/// assert!((error.high_pct - 500.0).abs() < 1e-9);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Counts {
    /// k, counts per mm.
    pub per_mm: f64,
    /// f, cycles per second.
    pub cycle_hz: f64,
}

/// A feed as whole counts per cycle show it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FeedError {
    /// The feed itself, V_T in counts/cycle.
    pub internal: f64,
    /// The whole numbers of counts that are seen in a cycle; equal if the feed is one.
    pub low: f64,
    /// See `low`.
    pub high: f64,
    /// Seen minus true feed when the lower number is seen, percent of the true one.
    pub low_pct: f64,
    /// The same for the higher number.
    pub high_pct: f64,
    /// What neither exceeds: one count, percent of the true feed.
    pub envelope_pct: f64,
}

impl Counts {
    /// One count, mm.
    #[must_use]
    pub fn increment_mm(&self) -> f64 {
        1.0 / self.per_mm
    }

    /// Feed in mm/min as counts/cycle (M29).
    #[must_use]
    pub fn speed(&self, feed_mm_min: f64) -> f64 {
        feed_mm_min * self.per_mm / (60.0 * self.cycle_hz)
    }

    /// Acceleration in m/s² as counts/cycle² (M29).
    #[must_use]
    pub fn acceleration(&self, a_m_s2: f64) -> f64 {
        1e3 * a_m_s2 * self.per_mm / self.cycle_hz.powi(2)
    }

    /// Jerk in m/s³ as counts/cycle³ (M29).
    #[must_use]
    pub fn jerk(&self, j_m_s3: f64) -> f64 {
        1e3 * j_m_s3 * self.per_mm / self.cycle_hz.powi(3)
    }

    /// What differences of counts show of a feed > 0 in mm/min: it jumps between two whole numbers.
    #[must_use]
    pub fn feed_error(&self, feed_mm_min: f64) -> FeedError {
        let internal = self.speed(feed_mm_min);
        let whole = internal.round();
        let (low, high) = if (internal - whole).abs() <= ROUNDING * whole {
            (whole, whole)
        } else {
            (internal.floor(), internal.ceil())
        };
        let percent = |seen: f64| 100.0 * (seen - internal) / internal;
        FeedError {
            internal,
            low,
            high,
            low_pct: percent(low),
            high_pct: percent(high),
            envelope_pct: 100.0 / internal,
        }
    }

    /// A position in mm in whole counts, cut off towards 0.
    #[must_use]
    pub fn cut(&self, mm: f64) -> f64 {
        (mm * self.per_mm).trunc()
    }

    /// The first of the given number of cycles after the start in which a motion shows: `way_mm` gives its
    /// way in mm after a time in s. `None` if none does.
    #[must_use]
    pub fn first_seen(&self, cycles: u32, way_mm: impl Fn(f64) -> f64) -> Option<u32> {
        (1..=cycles).find(|&cycle| self.cut(way_mm(f64::from(cycle) / self.cycle_hz)) != 0.0)
    }

    /// Largest error of the n-th difference of rounded positions over Tⁿ, mm/sⁿ; n ≥ 1 (M28).
    #[must_use]
    pub fn difference_bound(&self, n: u16) -> f64 {
        self.increment_mm() * self.cycle_hz.powi(i32::from(n)) * difference_bound(n)
    }

    /// Its rms if errors of rounding are independent, mm/sⁿ (M28).
    #[must_use]
    pub fn difference_rms(&self, n: u16) -> f64 {
        self.increment_mm() * self.cycle_hz.powi(i32::from(n)) * difference_rms(n)
    }

    /// How many times a count is coarser than a step that is needed, in mm (M34).
    #[must_use]
    pub fn discrepancy(&self, needed_mm: f64) -> f64 {
        self.increment_mm() / needed_mm
    }
}

/// Largest error of the n-th difference of rounded positions, counts: 2ⁿ⁻¹, with n ≥ 1 (M28).
#[must_use]
pub fn difference_bound(n: u16) -> f64 {
    2_f64.powi(i32::from(n) - 1)
}

/// Its rms if errors of rounding are independent and even within a count: (C(2n, n)/12)^½ counts, the squares
/// of the binomial coefficients added up (M28).
#[must_use]
pub fn difference_rms(n: u16) -> f64 {
    let squares = (1..=n).map(f64::from).fold(1.0, |c, i| c * (f64::from(n) + i) / i);
    (squares / 12.0).sqrt()
}

/// Coarsest step of position for a tolerance of `tolerance_um`, K_m steps to it, mm (M30).
#[must_use]
pub fn position_mm(tolerance_um: f64, steps: f64) -> f64 {
    tolerance_um / (1e3 * steps)
}

/// Coarsest step of speed that divides the highest feed into K_F steps, mm/cycle (M31).
#[must_use]
pub fn speed_mm(feed_mm_min: f64, cycle_hz: f64, steps: f64) -> f64 {
    feed_mm_min / (60.0 * cycle_hz * steps)
}

/// Coarsest step of acceleration that divides the highest one into K_a steps, mm/cycle² (M32).
#[must_use]
pub fn acceleration_mm(a_m_s2: f64, cycle_hz: f64, steps: f64) -> f64 {
    1e3 * a_m_s2 / (cycle_hz.powi(2) * steps)
}

/// Coarsest step of jerk that divides the highest one into K_J steps, mm/cycle³ (M33).
#[must_use]
pub fn jerk_mm(j_m_s3: f64, cycle_hz: f64, steps: f64) -> f64 {
    1e3 * j_m_s3 / (cycle_hz.powi(3) * steps)
}

/// Order of a step > 0: the decimal power not coarser than it (M35). The published "int-up" is used both
/// ways; this is the one of its (10), (14) and (18).
#[must_use]
pub fn order(step: f64) -> i32 {
    (libm::log10(step) + ROUNDING).floor() as i32
}

/// Counts per mm of a decimal order: 10^−order.
#[must_use]
pub fn counts_per_mm(order: i32) -> f64 {
    10_f64.powi(order.saturating_neg())
}

/// What a machine has to do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Demand {
    /// P, tolerance of its parts, µm.
    pub tolerance_um: f64,
    /// Highest feed, mm/min.
    pub feed_mm_min: f64,
    /// Highest acceleration, m/s².
    pub acceleration_m_s2: f64,
    /// Highest jerk, m/s³.
    pub jerk_m_s3: f64,
    /// Its cycle, Hz.
    pub cycle_hz: f64,
}

/// Into how many steps each of it is divided.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Steps {
    /// K_m.
    pub tolerance: f64,
    /// K_F.
    pub feed: f64,
    /// K_a.
    pub acceleration: f64,
    /// K_J.
    pub jerk: f64,
}

impl Steps {
    /// The fewest that are published: 10, 1e4 (up to 3e4), 1000, 100.
    pub const PUBLISHED: Steps = Steps { tolerance: 10.0, feed: 1e4, acceleration: 1e3, jerk: 100.0 };
}

/// The coarsest steps with which a machine can do what it has to (M30–M33).
///
/// ```
/// use adviser::resolution::{Demand, Required, Steps, order};
/// let lathe = Demand {
///     tolerance_um: 6.0, feed_mm_min: 5000.0, acceleration_m_s2: 1.962, jerk_m_s3: 1.0, cycle_hz: 1000.0,
/// };
/// let needed = Required::of(&lathe, &Steps::PUBLISHED);
/// assert_eq!(needed.steps().map(order), [-4, -6, -6, -8]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Required {
    /// Of position, mm.
    pub position_mm: f64,
    /// Of speed, mm/cycle.
    pub speed_mm: f64,
    /// Of acceleration, mm/cycle².
    pub acceleration_mm: f64,
    /// Of jerk, mm/cycle³.
    pub jerk_mm: f64,
}

impl Required {
    /// What a demand requires when it is divided so.
    #[must_use]
    pub fn of(demand: &Demand, steps: &Steps) -> Required {
        let f = demand.cycle_hz;
        Required {
            position_mm: position_mm(demand.tolerance_um, steps.tolerance),
            speed_mm: speed_mm(demand.feed_mm_min, f, steps.feed),
            acceleration_mm: acceleration_mm(demand.acceleration_m_s2, f, steps.acceleration),
            jerk_mm: jerk_mm(demand.jerk_m_s3, f, steps.jerk),
        }
    }

    /// The four steps, position first.
    #[must_use]
    pub fn steps(&self) -> [f64; 4] {
        [self.position_mm, self.speed_mm, self.acceleration_mm, self.jerk_mm]
    }
}

/// Step of a number in double precision at a magnitude in mm, mm.
#[must_use]
pub fn double_mm(at_mm: f64) -> f64 {
    let at = at_mm.abs();
    at.next_up() - at
}

/// Step of a number in single precision at a magnitude in mm, mm.
#[must_use]
pub fn single_mm(at_mm: f64) -> f64 {
    let at = at_mm.abs() as f32;
    f64::from(at.next_up()) - f64::from(at)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Differences of a motion at constant acceleration, rounded once and as it is.
    #[test]
    fn differences_of_rounded_positions_err_as_foretold() {
        let counts = Counts { per_mm: 1000.0, cycle_hz: 1000.0 };
        let way = |i: i32| 1e-5 * 2_f64.sqrt() * f64::from(i * i);
        let error = |i: i32| (way(i) * counts.per_mm).round() * counts.increment_mm() - way(i);
        for (n, weights) in
            [(1, &[-1.0, 1.0][..]), (2, &[1.0, -2.0, 1.0][..]), (3, &[-1.0, 3.0, -3.0, 1.0][..])]
        {
            let of = |i: i32| {
                let terms = weights.iter().zip(i..).map(|(weight, i)| weight * error(i));
                terms.sum::<f64>() * counts.cycle_hz.powi(i32::from(n))
            };
            let errors: Vec<f64> = (0..20_000).map(of).collect();
            let largest = errors.iter().fold(0.0, |most: f64, e| most.max(e.abs()));
            let rms = (errors.iter().map(|e| e * e).sum::<f64>() / 20_000.0).sqrt();
            let bound = counts.difference_bound(n);
            assert!(
                largest <= bound * (1.0 + 1e-6) && largest > 0.7 * bound,
                "order {n}: {largest} of {bound}"
            );
            assert!((rms / counts.difference_rms(n) - 1.0).abs() < 0.02, "order {n}: {rms}");
        }
        let rms = [1, 2, 3].map(|n| (100.0 * difference_rms(n)).round());
        assert_eq!(rms, [41.0, 71.0, 129.0], "hundredths of a count");
    }

    #[test]
    fn a_feed_that_is_whole_counts_has_no_error() {
        let counts = Counts { per_mm: 1000.0, cycle_hz: 2500.0 };
        for whole in 1..2000 {
            let error = counts.feed_error(f64::from(whole) * 150.0);
            assert_eq!(error.low, error.high, "{whole}");
            assert!(error.low_pct.abs() < 1e-7);
        }
    }

    #[test]
    fn an_order_is_not_coarser_than_its_step() {
        for (step, expected) in
            [(1e-3, -3), (9.99e-4, -4), (1.1e-3, -3), (1e-5, -5), (6.4e-10, -10), (2.0, 0)]
        {
            assert_eq!(order(step), expected, "{step}");
        }
        assert_eq!([-4, 0, 1].map(counts_per_mm), [10_000.0, 1.0, 0.1]);
    }

    /// A double at one metre is finer than anything required, a single is coarser than a position may be.
    #[test]
    fn doubles_are_enough_and_singles_are_not() {
        assert!((double_mm(-1000.0) - 1.137e-13).abs() < 1e-16 && (single_mm(1000.0) - 6.1e-5).abs() < 1e-7);
    }
}
