//! How far a speed can change on a given way: the step of the look-ahead (M24, M26), in closed form or by a
//! few iterations. In: feeds in mm/s, a way in mm, limits in mm/sⁿ. Out: a feed, mm/s.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | F | mm/s | the feed at one end of the way |
//! | e | mm/s | change of feed, the unknown |
//! | L | mm | the way |
//! | T(e) | s | duration of the fastest ramp (M21), one of three laws |
//! | Jm | mm/s³ | min(Jmax, sqrt(2 Amax DJmax/π)) |
//!
//! ```text
//! (F + e/2) T(e) = L                                                                             (M22)
//! e ≤ Jm³π²/(2 DJ²):   T = 2 (2π e/DJ)^(1/3);   with y = e^(1/3):  c y (F + y³/2) = L
//! e ≤ 2 A²/Jm:         T = 2 (2 e/Jm)^(1/2);    with y = e^(1/2):  c y (F + y²/2) = L
//! otherwise:           T = 2 A/Jm + e/A:        a quadratic                                      (M65)
//! ```
//! In y both roots are those of convex increasing functions, so Newton's steps from above come down to them.

use core::f64::consts::PI;

use crate::limits::Limits;
use crate::ramp::Ramp;

/// Most steps of Newton; from the starts below five are enough, and less than a rounding is left.
const STEPS: usize = 12;
/// The root is lowered by this share, so that its own way fits whatever its last bits do.
const SHORT: f64 = 1.0 - 1e-13;

/// Highest feed up to `cap` that a way of `length` can join with the feed `from`, as its exit or as its
/// entry. At most some 1e-12 below the true root, never above it; never below `from`.
///
/// # Panics
/// If a limit is not positive.
#[must_use]
pub(crate) fn reach(from: f64, cap: f64, length: f64, limits: &Limits) -> f64 {
    let way = |e: f64| (from + 0.5 * e) * Ramp::shortest(e, limits);
    let most = cap - from;
    if most <= 0.0 {
        return from;
    }
    if way(most) <= length {
        return cap;
    }
    let jm = limits.j.min((2.0 * limits.a * (limits.dj / PI)).sqrt());
    let by_rate = jm * jm * jm * PI * PI / (2.0 * limits.dj * limits.dj);
    let by_jerk = 2.0 * limits.a * limits.a / jm;
    let root = if way(by_rate) >= length {
        let y = newton(from, 3, length / (2.0 * libm::cbrt(2.0 * PI / limits.dj)));
        y * y * y
    } else if way(by_jerk) >= length {
        let y = newton(from, 2, length / (2.0 * (2.0 / jm).sqrt()));
        y * y
    } else {
        // e²/2 + (F + A t/2) e + F A t − L A = 0 with t = 2 A/Jm.
        let (b, c) = (from + 0.5 * by_jerk, from * by_jerk - length * limits.a);
        -2.0 * c / (b + (b * b - 2.0 * c).max(0.0).sqrt())
    };
    // Where a way is tiny against its feed the rounding of the feed itself counts.
    let mut feed = from + (root * SHORT).clamp(0.0, most);
    for _ in 0..STEPS {
        if way(feed - from) <= length {
            return feed;
        }
        feed = feed.next_down();
    }
    from
}

/// Root y > 0 of y (f + yⁿ/2) = q, n 2 or 3.
fn newton(f: f64, n: i32, q: f64) -> f64 {
    let alone = if n == 3 { (2.0 * q).sqrt().sqrt() } else { libm::cbrt(2.0 * q) };
    let mut y = if f > 0.0 { alone.min(q / f) } else { alone };
    for _ in 0..STEPS {
        let power = if n == 3 { y * y * y } else { y * y };
        let value = y * (f + 0.5 * power) - q;
        if value <= 0.0 {
            break;
        }
        let slope = f + 0.5 * f64::from(n + 1) * power;
        let next = y - value / slope;
        if next >= y {
            break;
        }
        y = next;
    }
    y
}

#[cfg(test)]
mod tests {
    use super::reach;
    use crate::{Limits, reachable_feed};

    #[test]
    fn the_same_feed_as_the_search_to_the_last_bit_finds() {
        let limits = [
            Limits { v: 500.0, a: 2000.0, j: 80_000.0, dj: 8.0e6 },
            Limits { v: 500.0, a: 2000.0, j: 80_000.0, dj: 2.0e6 },
            Limits { v: 500.0, a: 300.0, j: 80_000.0, dj: 8.0e8 },
        ];
        for limits in &limits {
            for from in [0.0, 1e-3, 1.0, 33.0, 400.0] {
                for way in [1e-9, 1e-4, 0.02, 0.2, 3.0, 50.0, 1000.0] {
                    let (fast, exact) =
                        (reach(from, 500.0, way, limits), reachable_feed(from, 500.0, way, limits));
                    assert!(fast <= exact, "{from} {way}: {fast} above {exact}");
                    let off = (exact - fast) / (exact - from).max(1e-9 * exact);
                    assert!(
                        off < 1e-8 || exact - fast < 4.0 * f64::EPSILON * exact,
                        "{from} {way}: {fast} against {exact}"
                    );
                }
            }
        }
    }
}
