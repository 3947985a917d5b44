//! The function 1 − cos x and its running integrals, the only transcendental part of both laws. In: x in
//! radians, 0 … 2π. Out: dimensionless values, accurate to a few units in the last place down to x = 0.
//!
//! | symbol | value | meaning |
//! |---|---|---|
//! | rate | sin x | derivative of the pulse |
//! | pulse | 1 − cos x = 2 sin²(x/2) | the sin² pulse |
//! | first | x − sin x | integral of the pulse |
//! | second | x²/2 − 1 + cos x | integral of `first` |
//! | third | x³/6 − x + sin x | integral of `second` |
//!
//! The closed forms cancel at small x (`third` begins with x⁵/120), therefore the power series is used below
//! x = 1.

/// Pulse, its derivative and its running integrals at one phase.
#[derive(Clone, Copy)]
pub(crate) struct Versine {
    pub(crate) rate: f64,
    pub(crate) pulse: f64,
    pub(crate) first: f64,
    pub(crate) second: f64,
    pub(crate) third: f64,
}

/// Products n (n+1) of consecutive factors of the factorials in `second` and in `third`, last term first.
const SECOND: [f64; 7] = [306.0, 240.0, 182.0, 132.0, 90.0, 56.0, 30.0];
const THIRD: [f64; 7] = [342.0, 272.0, 210.0, 156.0, 110.0, 72.0, 42.0];

impl Versine {
    /// All values at phase `x`; one `sincos`, or none near the start of the pulse. Inlined, it costs no more
    /// than those that are asked for.
    #[inline]
    pub(crate) fn at(x: f64) -> Versine {
        if x < 1.0 {
            return Versine::near_zero(x);
        }
        let (sin, cos) = libm::sincos(x);
        let (pulse, first) = (1.0 - cos, x - sin);
        let second = 0.5 * x * x - pulse;
        let third = x * x * x / 6.0 - first;
        Versine { rate: sin, pulse, first, second, third }
    }

    /// Power series of `second` and `third`; the others follow from them without cancellation.
    #[inline]
    fn near_zero(x: f64) -> Versine {
        let y = x * x;
        let series = |factors: [f64; 7]| factors.iter().fold(1.0, |tail, factor| 1.0 - y * tail / factor);
        let second = y * y / 24.0 * series(SECOND);
        let third = y * y * x / 120.0 * series(THIRD);
        let pulse = 0.5 * y - second;
        let first = y * x / 6.0 - third;
        Versine { rate: x - first, pulse, first, second, third }
    }
}

#[cfg(test)]
mod tests {
    use super::Versine;

    #[test]
    fn series_and_closed_form_agree_where_they_meet() {
        let (below, above) = (Versine::near_zero(1.0), Versine::at(1.0));
        for (b, a) in [
            (below.rate, above.rate),
            (below.pulse, above.pulse),
            (below.first, above.first),
            (below.second, above.second),
            (below.third, above.third),
        ] {
            assert!((b - a).abs() < 1e-15, "{b} against {a}");
        }
    }

    #[test]
    fn small_phase_keeps_its_relative_precision() {
        let x = 1e-4;
        let versine = Versine::at(x);
        assert!((versine.third / (x * x * x * x * x / 120.0) - 1.0).abs() < 1e-9);
        assert!((versine.second / (x * x * x * x / 24.0) - 1.0).abs() < 1e-9);
    }
}
