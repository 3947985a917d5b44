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

    /// A sequence of its own for a number: what is drawn from it moves nothing that is drawn from this one.
    pub(crate) fn branch(&self, number: u64) -> Seed {
        let here = self.0 ^ number.wrapping_add(1).wrapping_mul(0xD1B5_4A32_D192_ED03);
        Seed(Seed(here).fraction().to_bits())
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

    #[test]
    fn branches_differ_and_move_nothing() {
        let seed = Seed(7);
        let mut drawn: Vec<f64> = (0..1000).map(|number| seed.branch(number).fraction()).collect();
        drawn.extend((0..1000).map(|other| Seed(other).branch(0).fraction()));
        assert_eq!(seed.0, 7);
        let mean = drawn.iter().sum::<f64>() / 2e3;
        assert!((mean - 0.5).abs() < 0.03, "mean {mean}");
        drawn.sort_by(f64::total_cmp);
        drawn.dedup();
        // Branch 0 of seed 7 is there twice.
        assert_eq!(drawn.len(), 1999);
    }
}
