//! The law of a varied speed over the commanded angle, and its peaks. In: a variation, turns. Out: shares of
//! the speed, turn/s² and turn/s³.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | S, r, a | turn/s, –, – | programmed speed, override, share of the variation |
//! | θ, P | turn | commanded angle since the pass began, period |
//! | k, v | – | half periods that are over, share of the one in hand: 2 θ/P = k + v |
//! | ℓ_k | – | level at the beginning of half period k, −1 … 1; ℓ_0 = 0 |
//! | β | – | share of a half period in which a corner of the triangle is rounded at either end, 1/4 |
//! | α, j | turn/s², turn/s³ | acceleration and jerk of the angle |
//!
//! ```text
//! n = r S (1 + a f),   f = ℓ_k + (ℓ_{k+1} − ℓ_k) s(v),   dθ/dt = n                              (M230)
//!   s = (1 − cos πv)/2 of a sine and of random levels;
//!   s = v²/(2β(1−β)) | (v − β/2)/(1−β) | 1 − (1−v)²/(2β(1−β))   for v ≤ β | ≤ 1 − β | beyond   of a triangle
//!   ℓ_k = −1, 1 in turn, or drawn evenly from −1 … 1
//! α ≤ (rS)² a f′ (1 + a x),   j ≤ (rS)³ a (f″ (1 + a)² + a f′² (1 + a))                           (M231)
//!   sine, random: f′ = 2π/P sin φ, x = cos φ = (√(1 + 8a²) − 1)/4a;  j ≤ (rS)³ a (2π/P)² (1 + a)²
//!   triangle:     f′ = 4/(P(1−β)),  f″ = 8/(P² β(1−β)),  x = 1 − β/(1−β)
//! ```
//! The first half period goes from the programmed speed to a peak: it sets out at rest of the speed, with
//! half the slope of those that follow. α = n dn/dθ and j = n dα/dθ; for a sine |j| is largest where the
//! speed is, since (1 + a c)(a(1 − c²) + (1 + a c) c) = (1 + a c)(a + c). Levels of `random` lie within the
//! band, so its slopes and bends are at most those of the sine.

use core::f64::consts::{PI, TAU};

use protocol::{Variation, VariationShape};

/// β.
const ROUNDED: f64 = 0.25;

/// The law in one pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpeedLaw {
    variation: Variation,
    /// By which random levels are drawn.
    seed: u64,
}

impl SpeedLaw {
    /// The law of a pass; `seed` says which levels `random` has: the number of the pass.
    pub fn new(variation: Variation, seed: u64) -> SpeedLaw {
        SpeedLaw { variation, seed }
    }

    /// 1 + a f: the speed as a share of the programmed one times the override, `turns` ≥ 0 into the law
    /// (M230).
    pub fn share(&self, turns: f64) -> f64 {
        let halves = 2.0 * turns.max(0.0) / self.variation.revolutions;
        let k = halves.floor();
        let [from, to] = [k, k + 1.0].map(|k| self.level(k as u64));
        1.0 + self.variation.share * (from + (to - from) * self.step(halves - k))
    }

    /// How much of a half period's change is made at a share of it.
    fn step(&self, v: f64) -> f64 {
        const BEND: f64 = 2.0 * ROUNDED * (1.0 - ROUNDED);
        match self.variation.shape {
            VariationShape::Sine | VariationShape::Random => 0.5 - 0.5 * libm::cos(PI * v),
            VariationShape::Triangle if v <= ROUNDED => v * v / BEND,
            VariationShape::Triangle if v <= 1.0 - ROUNDED => (v - 0.5 * ROUNDED) / (1.0 - ROUNDED),
            VariationShape::Triangle => 1.0 - (1.0 - v) * (1.0 - v) / BEND,
        }
    }

    /// Level at the beginning of a half period.
    fn level(&self, k: u64) -> f64 {
        match self.variation.shape {
            _ if k == 0 => 0.0,
            VariationShape::Random => 2.0 * drawn(self.seed, k) - 1.0,
            _ if k.is_multiple_of(2) => -1.0,
            _ => 1.0,
        }
    }
}

/// A number from 0 to 1 for each place of each seed: SplitMix64 (Steele, Lea, Flood 2014), as it stands at
/// that place.
fn drawn(seed: u64, place: u64) -> f64 {
    let mut bits = seed.wrapping_mul(0xD1B5_4A32_D192_ED03);
    bits = bits.wrapping_add(place.wrapping_mul(0x9E37_79B9_7F4A_7C15));
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    bits ^= bits >> 31;
    (bits >> 11) as f64 / (1u64 << 53) as f64
}

/// Highest acceleration, turn/s², and jerk, turn/s³, of the angle under a variation about a speed, turn/s
/// (M231).
pub(crate) fn peaks(variation: &Variation, speed: f64) -> [f64; 2] {
    let Variation { shape, share: a, revolutions } = *variation;
    let top = 1.0 + a;
    let [slope, bend, at] = match shape {
        VariationShape::Sine | VariationShape::Random => {
            let cos = ((1.0 + 8.0 * a * a).sqrt() - 1.0) / (4.0 * a);
            let k = TAU / revolutions;
            return [
                speed * speed * a * k * (1.0 - cos * cos).sqrt() * (1.0 + a * cos),
                speed.powi(3) * a * k * k * top * top,
            ];
        }
        VariationShape::Triangle => [
            4.0 / (revolutions * (1.0 - ROUNDED)),
            8.0 / (revolutions * revolutions * ROUNDED * (1.0 - ROUNDED)),
            1.0 - ROUNDED / (1.0 - ROUNDED),
        ],
    };
    let acceleration = speed * speed * a * slope * (1.0 + a * at);
    [acceleration, speed.powi(3) * a * (bend * top * top + a * slope * slope * top)]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The angle by small steps of time, and its second and third differences at their largest.
    fn searched(law: &SpeedLaw, speed: f64, periods: f64) -> [f64; 2] {
        let dt = 2e-5 * law.variation.revolutions / speed;
        let (mut turns, mut speeds) = (0.0, Vec::new());
        while turns < periods * law.variation.revolutions {
            // Midpoint rule.
            let half = turns + 0.5 * dt * speed * law.share(turns);
            speeds.push(speed * law.share(turns));
            turns += dt * speed * law.share(half);
        }
        let rates: Vec<f64> = speeds.windows(2).map(|n| (n[1] - n[0]) / dt).collect();
        let largest = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, |m: f64, x| m.max(x.abs()));
        let jerks = rates.windows(2).map(|a| (a[1] - a[0]) / dt);
        [largest(&mut rates.iter().copied()), largest(&mut jerks.into_iter())]
    }

    #[test]
    fn m230_it_begins_at_the_programmed_speed_and_stays_within_its_band() {
        for shape in VariationShape::ALL {
            for share in [0.05, 0.3, 0.5] {
                let law = SpeedLaw::new(Variation { shape, share, revolutions: 4.0 }, 7);
                assert_eq!(law.share(0.0), 1.0);
                let shares: Vec<f64> = (0..40_000).map(|n| law.share(f64::from(n) * 1e-3)).collect();
                let [low, high] = [f64::min as fn(f64, f64) -> f64, f64::max]
                    .map(|of| shares.iter().copied().fold(1.0, of));
                assert!(low >= 1.0 - share - 1e-12 && high <= 1.0 + share + 1e-12, "{shape:?}: {low} {high}");
                assert!(high - low > share, "{shape:?} {share} varies: {low} {high}");
                let step = shares.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max);
                assert!(step <= 1.001e-3 * share * TAU / 4.0, "{shape:?} {share}: {step}");
            }
        }
    }

    #[test]
    fn m231_no_search_finds_more_than_the_peaks_and_it_comes_near_them() {
        let mut seed = 0.5;
        let mut random = |low: f64, high: f64| {
            seed = (seed * 997.0 + 0.137) % 1.0;
            low + (high - low) * seed
        };
        for round in 0..24 {
            let shape = VariationShape::ALL[round % 3];
            let variation = Variation { shape, share: random(0.02, 0.5), revolutions: random(0.5, 20.0) };
            let speed = random(0.5, 30.0);
            let found = searched(&SpeedLaw::new(variation, round as u64), speed, 6.0);
            let peak = peaks(&variation, speed);
            for (what, found, peak) in [("acceleration", found[0], peak[0]), ("jerk", found[1], peak[1])] {
                assert!(found <= peak * 1.001, "{variation:?} {speed}: {what} {found}, bound {peak}");
                let near = if shape == VariationShape::Random { 0.05 } else { 0.7 };
                assert!(found > near * peak, "{variation:?} {speed}: {what} {found} of {peak}");
            }
        }
    }

    #[test]
    fn random_levels_are_spread_over_the_band_and_differ_from_seed_to_seed() {
        let drawn: Vec<f64> = (0..20_000).map(|n| drawn(n / 100, n % 100 + 1)).collect();
        let mean = drawn.iter().sum::<f64>() / 2e4;
        assert!((mean - 0.5).abs() < 0.01, "{mean}");
        let mut sorted = drawn.clone();
        sorted.sort_by(f64::total_cmp);
        assert!(sorted.windows(2).all(|pair| pair[1] - pair[0] < 0.002), "no gap");
        let neighbours = drawn.windows(2).map(|d| (d[0] - 0.5) * (d[1] - 0.5)).sum::<f64>() / 2e4;
        assert!(neighbours.abs() < 0.003, "{neighbours}");
    }
}
