//! Numbers that look random and are the same everywhere. SplitMix64 (Steele, Lea, Flood 2014). In: a seed.
//! Out: numbers.

use std::ops::Range;

/// A sequence of numbers that depends on nothing but its seed.
///
/// ```
/// use testing::Seed;
/// let mut seed = Seed::new(0);
/// assert_eq!(seed.next(), 0xE220_A839_7B1D_CDAF, "as published");
/// assert!((2.0..3.0).contains(&seed.between(2.0, 3.0)));
/// assert!(seed.below(6) < 6);
/// ```
#[derive(Clone, Debug)]
pub struct Seed(u64);

impl Seed {
    /// The sequence of the published generator.
    pub fn new(seed: u64) -> Seed {
        Seed(seed)
    }

    /// The sequence of a case: that of the next case has nothing to do with it.
    pub fn of_case(number: u64) -> Seed {
        Seed(number.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ 0x5851_F42D_4C95_7F2D)
    }

    /// The next 64 bits.
    #[expect(clippy::should_implement_trait, reason = "one number after the other, without an end")]
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut bits = self.0;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        bits ^ (bits >> 31)
    }

    /// From 0 up to, not including, `end`; 0 if there is nothing below it.
    pub fn below(&mut self, end: usize) -> usize {
        (self.next() % end.max(1) as u64) as usize
    }

    /// From `range.start` up to, not including, `range.end`; `range.start` if the range is empty.
    pub fn within(&mut self, range: Range<u64>) -> u64 {
        range.start + self.next() % range.end.saturating_sub(range.start).max(1)
    }

    /// One of a list.
    ///
    /// # Panics
    /// If the list is empty.
    pub fn of<'a, T: ?Sized>(&mut self, list: &[&'a T]) -> &'a T {
        list[self.below(list.len())]
    }

    /// From 0 up to, not including, 1.
    pub fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// From −1 up to, not including, 1.
    pub fn signed(&mut self) -> f64 {
        2.0 * self.unit() - 1.0
    }

    /// From `low` up to, not including, `high`, evenly spread.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Between two positive numbers, every order of magnitude alike.
    pub fn scale(&mut self, low: f64, high: f64) -> f64 {
        low * libm::pow(high / low, self.unit())
    }

    /// True with probability `p`.
    pub fn chance(&mut self, p: f64) -> bool {
        self.unit() < p
    }
}

/// How many of something are tried: what this variable of the environment asks for, else a number that a run
/// of all tests has time for.
pub fn count(variable: &str, usual: u64) -> u64 {
    std::env::var(variable).ok().and_then(|text| text.replace('_', "").parse().ok()).unwrap_or(usual)
}

#[cfg(test)]
mod tests {
    use super::Seed;

    #[test]
    fn numbers_are_those_of_the_published_generator() {
        let mut seed = Seed::new(1_234_567);
        let published = [
            6_457_827_717_110_365_317,
            3_203_168_211_198_807_973,
            9_817_491_932_198_370_423,
            4_593_380_528_125_082_431,
            16_408_922_859_458_223_821,
        ];
        assert_eq!([0; 5].map(|_| seed.next()), published);
    }

    #[test]
    fn numbers_are_evenly_spread() {
        let mut seed = Seed::of_case(1);
        let drawn = std::iter::repeat_with(|| [seed.unit(), seed.signed(), seed.between(2.0, 4.0)]);
        let drawn: Vec<[f64; 3]> = drawn.take(100_000).collect();
        for (column, low, high) in [(0, 0.0, 1.0), (1, -1.0, 1.0), (2, 2.0, 4.0)] {
            assert!(drawn.iter().all(|row| (low..high).contains(&row[column])));
            let mean = drawn.iter().map(|row| row[column]).sum::<f64>() / 1e5;
            let middle = f64::midpoint(low, high);
            assert!((mean - middle).abs() < 0.005 * (high - low), "mean {mean} of {low} to {high}");
        }
        let below = (0..60_000).map(|_| seed.below(6)).fold([0; 6], |mut counts, side| {
            counts[side] += 1;
            counts
        });
        assert!(below.iter().all(|count| (9_500..10_500).contains(count)), "{below:?}");
    }
}
