//! Root of an increasing function over the non-negative doubles. In: the function, its target, a cap.
//! Out: the largest argument that does not pass the target. Unit of the argument as the caller's.

/// Iterations that halve any range of positive doubles down to two neighbours: one per bit below the sign.
const ITERATIONS: u32 = 63;

/// The largest `x` in `0..=cap` with `f(x) <= target`, to the last bit; 0 if there is none. `f` must not
/// decrease.
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

/// Most steps of [`root`]; smooth functions need about five.
const STEPS: u32 = 40;

/// An `x` in `0..=cap` with `f(x) <= target` and nearly equal, for a smooth increasing `f` that starts as a
/// power of x: Newton's steps on a double logarithmic scale, kept in a bracket. `f` returns its value and its
/// derivative.
pub(crate) fn root(cap: f64, target: f64, f: impl Fn(f64) -> (f64, f64)) -> f64 {
    if cap <= 0.0 || f(cap).0 <= target {
        return cap.max(0.0);
    }
    let base = f(0.0).0;
    let rise = target - base;
    if rise.is_nan() || rise <= 0.0 {
        return 0.0;
    }
    let (mut low, mut high, mut x) = (0.0, cap, cap);
    for _ in 0..STEPS {
        let (value, slope) = f(x);
        if value <= target {
            low = x;
            // Below the target by a rounding only.
            if target - value <= 4.0 * f64::EPSILON * target {
                break;
            }
        } else {
            high = x;
        }
        let gained = value - base;
        let exponent = x * slope / gained;
        let step = libm::log(rise / gained) / exponent;
        let next = x * libm::exp(step);
        let inside = next > low && next < high;
        x = if inside { next } else { f64::from_bits(low.to_bits() / 2 + high.to_bits() / 2) };
        if high - low <= 2.0 * f64::EPSILON * high {
            break;
        }
        // The last steps come from either side; a rounding below the root is where they shall end.
        if inside && step.abs() < 1e-13 {
            x *= 1.0 - 1e-15;
        }
    }
    low
}

#[cfg(test)]
mod tests {
    use super::{largest, root};

    #[test]
    fn the_root_is_the_same_as_the_last_double_but_for_roundings() {
        for base in [0.0, 1e-3, 5.0] {
            for power in [1.0 / 3.0, 0.5, 1.0, 1.5, 2.0] {
                for target in [1e-9, 1e-3, 0.7, 5.1, 300.0] {
                    let value = |x: f64| base + x + libm::pow(x, power);
                    let slope = |x: f64| 1.0 + power * libm::pow(x, power - 1.0);
                    let fast = root(1e4, target, |x| (value(x), slope(x)));
                    let exact = largest(1e4, target, value);
                    assert!(fast <= exact, "{base} {power} {target}: {fast} above {exact}");
                    let off = value(exact) - value(fast);
                    assert!(off <= 16.0 * f64::EPSILON * target, "{base} {power} {target}: {fast}, {exact}");
                }
            }
        }
    }

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
