//! How the parts of published limits are rounded: to preferred numbers, to whole units of the last place with
//! a half to the even neighbour.
//!
//! ```text
//! R40(i) = 10^(i/40), in the rounded values of ISO 3; grades are whole steps i of each other      (M136)
//! ```

/// One decade of the series R40 of preferred numbers, ISO 3:1973, times 100.
const R40: [f64; 40] = [
    100.0, 106.0, 112.0, 118.0, 125.0, 132.0, 140.0, 150.0, 160.0, 170.0, 180.0, 190.0, 200.0, 212.0, 224.0,
    236.0, 250.0, 265.0, 280.0, 300.0, 315.0, 335.0, 355.0, 375.0, 400.0, 425.0, 450.0, 475.0, 500.0, 530.0,
    560.0, 600.0, 630.0, 670.0, 710.0, 750.0, 800.0, 850.0, 900.0, 950.0,
];
/// What is nearer to a half than this is a half: sums of decimal fractions are not exact in binary.
const TIE: f64 = 1e-7;

/// A preferred number of the series R40, as its place in it: 0 is 1, 40 is 10 (M136).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Preferred(i32);

impl Preferred {
    /// The one that is nearest to a positive value.
    ///
    /// # Panics
    /// If the value is not positive and finite.
    #[must_use]
    pub fn nearest(value: f64) -> Preferred {
        assert!(value > 0.0 && value.is_finite(), "{value} has no nearest preferred number");
        let near = libm::floor(40.0 * libm::log10(value)) as i32;
        let distance = |at: &i32| (Preferred(*at).value() - value).abs();
        let nearest = (near - 1..=near + 2).min_by(|a, b| distance(a).total_cmp(&distance(b)));
        Preferred(nearest.unwrap_or(near))
    }

    /// So many steps up, or down.
    #[must_use]
    pub fn step(self, steps: i32) -> Preferred {
        Preferred(self.0 + steps)
    }

    /// The number.
    #[must_use]
    pub fn value(self) -> f64 {
        let decade = libm::pow(10.0, f64::from(self.0.div_euclid(40)));
        R40[self.0.rem_euclid(40) as usize] * decade / 100.0
    }

    /// As tables of limits print it: a whole number, a half to the even one.
    #[must_use]
    pub fn whole(self) -> f64 {
        even(self.value(), 0)
    }
}

/// Rounded to so many places behind the point, a half to the even neighbour.
#[must_use]
pub fn even(value: f64, places: i32) -> f64 {
    let unit = libm::pow(10.0, f64::from(places));
    let scaled = value * unit;
    let below = scaled.floor();
    let up = match scaled - below - 0.5 {
        rest if rest.abs() < TIE => below % 2.0 != 0.0,
        rest => rest > 0.0,
    };
    (below + f64::from(u8::from(up))) / unit
}

/// Rounded to so many places behind the point, a half up.
#[must_use]
pub fn half_up(value: f64, places: i32) -> f64 {
    let unit = libm::pow(10.0, f64::from(places));
    (value * unit + 0.5 + TIE).floor() / unit
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_preferred_number_is_found_in_any_decade() {
        for (value, preferred) in
            [(1.0, 1.0), (0.98, 1.0), (97.6, 100.0), (97.4, 95.0), (183.5, 180.0), (1.5, 1.5), (9.9e4, 1e5)]
        {
            let found = Preferred::nearest(value).value();
            assert!((found / preferred - 1.0).abs() < 1e-12, "{value}: {found}");
        }
        assert_eq!(Preferred::nearest(112.0).step(-8).value(), 71.0);
        assert_eq!(Preferred::nearest(95.0).step(-28).step(28).value(), 95.0);
    }

    #[test]
    fn a_half_goes_to_the_even_neighbour() {
        assert_eq!([42.5, 31.5, 23.6, 67.0].map(|value| even(value, 0)), [42.0, 32.0, 24.0, 67.0]);
        assert_eq!((even(0.35945, 4), even(0.17015, 4), even(0.61875, 4)), (0.3594, 0.1702, 0.6188));
        assert_eq!((half_up(1.5335, 3), half_up(0.1041, 3), half_up(0.2074, 3)), (1.534, 0.104, 0.207));
    }
}
