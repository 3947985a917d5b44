//! Root of an increasing function over the non-negative doubles. In: the function, its target, a cap.
//! Out: the largest argument that does not pass the target. Unit of the argument as the caller's.

/// Iterations that halve any range of positive doubles down to two neighbours: one per bit below the sign.
const ITERATIONS: u32 = 63;

/// The largest `x` in `0..=cap` with `f(x) <= target`, to the last bit; 0 if there is none. `f` must not decrease.
///
/// Positive doubles are ordered like their bit patterns, so halving the range of patterns keeps the relative
/// precision of an increment that is tiny against the feed it is added to, and ends after a fixed count.
pub(crate) fn largest(cap: f64, target: f64, f: impl Fn(f64) -> f64) -> f64 {
    if cap <= 0.0 {
        return 0.0;
    }
    if f(cap) <= target {
        return cap;
    }
    let (mut low, mut high) = (0, cap.to_bits());
    for _ in 0..ITERATIONS {
        let middle = low + (high - low) / 2;
        if f(f64::from_bits(middle)) <= target {
            low = middle;
        } else {
            high = middle;
        }
    }
    f64::from_bits(low)
}

#[cfg(test)]
mod tests {
    use super::largest;

    #[test]
    fn finds_the_last_double_below_the_target() {
        for target in [1e-300, 1e-9, 2.0, 1e6] {
            let root = largest(f64::MAX, target, |x| x * 3.0);
            assert!(root * 3.0 <= target && root.next_up() * 3.0 > target, "{target}");
        }
    }

    #[test]
    fn stays_within_its_cap() {
        assert_eq!(largest(5.0, 100.0, |x| x), 5.0);
        assert_eq!(largest(0.0, 100.0, |x| x), 0.0);
        assert_eq!(largest(5.0, 1.0, |_| 2.0), 0.0);
    }
}
