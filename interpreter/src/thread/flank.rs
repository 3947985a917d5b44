//! When Z may begin to brake behind a retracting tool. In: the two laws, mm and s at the same speed of the
//! spindle. Out: a delay in s.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | t, u | s | time since the retract began, time since braking began |
//! | x(t) | mm | way of the retract |
//! | e(u) | mm | lag of Z behind the helix, V u - z(u), increasing |
//! | φ | – | half angle of the flank |
//!
//! The trailing flank is not touched while e <= x tan φ (M15), as long as the tool is in the thread. At time
//! t that allows braking to have lasted u = e⁻¹(x(t) tan φ), so it must not begin before t - u: the least
//! delay is
//!
//! ```text
//! d = max over t of ( t - e⁻¹(x(t) tan φ) ),  0 <= t <= time at which the tool is clear of the thread
//! ```

use motion::{Ramp, Stroke};

/// Samples of the maximum before it is refined.
const GRID: u32 = 48;
/// Steps of a bisection in doubles, and of the refinement.
const STEPS: u32 = 50;

/// Least delay in s from the beginning of `retract` to that of `brake`, so that the flank is not touched
/// until the tool has gone `clear_mm`. `brake` is the axial ramp; both at the same spindle speed.
pub(crate) fn least_delay(brake: &Ramp, retract: &Stroke, clear_mm: f64, tan_flank: f64) -> f64 {
    let duration = retract.duration();
    let clear = largest(duration, |t| retract.at(t).s.abs() <= clear_mm);
    let lag = |u: f64| brake.dv().abs() * u - brake.braking_at(u).s.abs();
    let needed = |t: f64| {
        let room = retract.at(t).s.abs() * tan_flank;
        t - largest(clear, |u| lag(u) <= room)
    };
    let step = clear / f64::from(GRID);
    let best = (0..=GRID)
        .map(|i| (needed(f64::from(i) * step), f64::from(i) * step))
        .fold((0.0, 0.0), |best, next| if next.0 > best.0 { next } else { best });
    let (mut low, mut high) = ((best.1 - step).max(0.0), (best.1 + step).min(clear));
    for _ in 0..STEPS {
        let third = (high - low) / 3.0;
        if needed(low + third) < needed(high - third) {
            low += third;
        } else {
            high -= third;
        }
    }
    best.0.max(needed(0.5 * (low + high)))
}

/// The largest value in 0 … `top` for which `holds`, which holds up to a point and not beyond.
pub(crate) fn largest(top: f64, holds: impl Fn(f64) -> bool) -> f64 {
    if holds(top) {
        return top;
    }
    let (mut low, mut high) = (0.0, top);
    for _ in 0..STEPS {
        let middle = 0.5 * (low + high);
        if holds(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}
