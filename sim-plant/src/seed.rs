//! What nobody sets and every machine has: where the encoders' lines lie, where the spindle stood.
//! In: a seed. Out: fractions in [0, 1). SplitMix64 (Steele, Lea, Flood 2014).

/// A sequence of numbers that depends on nothing but its seed.
#[derive(Clone, Debug)]
pub struct Seed(
    /// Where the sequence stands.
    pub u64,
);

impl Seed {
    /// The next number, evenly spread over [0, 1).
    pub fn fraction(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut bits = self.0;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        bits ^= bits >> 31;
        (bits >> 11) as f64 / (1u64 << 53) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::Seed;

    #[test]
    fn fractions_are_those_of_the_published_generator_and_evenly_spread() {
        assert_eq!(Seed(0).fraction(), (0xE220_A839_7B1D_CDAF_u64 >> 11) as f64 / (1u64 << 53) as f64);
        let mut seed = Seed(1);
        let drawn: Vec<f64> = (0..100_000).map(|_| seed.fraction()).collect();
        let mean = drawn.iter().sum::<f64>() / 1e5;
        assert!(drawn.iter().all(|x| (0.0..1.0).contains(x)) && (mean - 0.5).abs() < 0.003, "mean {mean}");
    }
}
