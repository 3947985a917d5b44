//! Strokes (M2–M8a) and the limits they are held to (M7).

use super::draw::{keeps, limits, magnitude, magnitudes, signed, smooth, times};
use motion::{Limits, Sample, Stroke};
use proptest::prelude::*;

proptest! {
    #[test]
    fn m7_shortest_stroke_keeps_its_limits_and_touches_one(length in signed(1e-3, 1e3), limits in limits()) {
        let stroke = Stroke::new(length, Stroke::shortest(length, &limits));
        let peak = stroke.peak();
        prop_assert!(peak.v <= limits.v && peak.a <= limits.a && peak.j <= limits.j && peak.dj <= limits.dj);
        prop_assert!((limits.top_ratio(&stroke.peak()) - 1.0).abs() < 1e-12, "a shorter one would do");
        for p in times(stroke.duration(), 200) {
            prop_assert!(keeps(&magnitudes(stroke.at(p)), &stroke.peak()), "at {p}");
        }
    }

    #[test]
    fn m2_stroke_is_smooth(length in signed(1e-3, 1e3), duration in magnitude(1e-3, 10.0)) {
        let stroke = Stroke::new(length, duration);
        smooth(duration, &stroke.peak(), |p| stroke.at(p))?;
    }

    #[test]
    fn m2_stroke_reaches_its_target_without_turning_back(
        length in signed(1e-3, 1e3),
        duration in magnitude(1e-3, 10.0),
    ) {
        let stroke = Stroke::new(length, duration);
        prop_assert_eq!(stroke.at(0.0), Sample::default());
        prop_assert_eq!(stroke.at(-1.0), Sample::default());
        prop_assert_eq!(stroke.at(duration), Sample::uniform(length, 0.0));
        prop_assert_eq!(stroke.at(2.0 * duration), Sample::uniform(length, 0.0));
        let mut before = 0.0;
        for p in times(duration, 1000) {
            let way = stroke.at(p).s * length.signum();
            prop_assert!(way >= before - 1e-15 * length.abs(), "turns back at {}", p);
            before = way;
        }
    }

    #[test]
    fn m2_stroke_is_symmetric_about_its_middle(
        length in signed(1e-3, 1e3),
        duration in magnitude(1e-3, 10.0),
        share in 0.0..1.0,
    ) {
        let stroke = Stroke::new(length, duration);
        let (there, back) = (stroke.at(share * duration), stroke.at(duration - share * duration));
        let peak = stroke.peak();
        prop_assert!((there.s + back.s - length).abs() <= 1e-12 * length.abs());
        prop_assert!((there.v - back.v).abs() <= 1e-12 * peak.v);
        prop_assert!((there.a + back.a).abs() <= 1e-11 * peak.a);
        prop_assert!((there.j - back.j).abs() <= 1e-11 * peak.j);
    }

    #[test]
    fn m7_top_ratio_is_tight(length in signed(1e-3, 1e3), duration in magnitude(1e-3, 10.0), limits in limits()) {
        let peak = Stroke::new(length, duration).peak();
        let r = limits.top_ratio(&peak);
        prop_assert!(keeps(&peak.scaled(r), &limits));
        prop_assert!(!keeps(&peak.scaled(r * (1.0 + 1e-9)), &limits));
    }

    /// Faster spindle, shorter time: a stroke driven at ratio r is the stroke of duration/r (M8 with r' = 0).
    #[test]
    fn m8_steady_ratio_is_a_shorter_stroke(length in signed(1e-2, 1e2), share in 0.01..0.99, r in 0.1..3.0) {
        let (slow, fast) = (Stroke::new(length, 0.5), Stroke::new(length, 0.5 / r));
        let (driven, direct) = (slow.at(share * 0.5).driven([r, 0.0, 0.0, 0.0]), fast.at(share * 0.5 / r));
        let (difference, peak) = (magnitudes(driven - direct), fast.peak());
        prop_assert!((driven.s - direct.s).abs() <= 1e-12 * length.abs());
        let rounding = Limits { v: 1e-11 * peak.v, a: 1e-11 * peak.a, j: 1e-11 * peak.j, dj: 1e-11 * peak.dj };
        prop_assert!(keeps(&difference, &rounding), "{difference:?}");
    }

    /// The chain rule against differences of the driven path x(p(t)), p' = r(t) = r + r' t; away from the
    /// middle, where dj jumps.
    #[test]
    fn m8_changing_ratio_agrees_with_differences(share in prop_oneof![0.1..0.45, 0.55..0.9], r in 0.5..1.5, r_dot in -2.0..2.0) {
        let stroke = Stroke::new(5.0, 0.2);
        let p0 = share * 0.2;
        let driven = |t: f64| stroke.at(p0 + (r + 0.5 * r_dot * t) * t).driven([r + r_dot * t, r_dot, 0.0, 0.0]);
        let h = 1e-5;
        let (before, now, after) = (driven(-h), driven(0.0), driven(h));
        let peak = stroke.peak().scaled(r);
        let near = |difference: f64, value: f64, scale: f64| (difference / (2.0 * h) - value).abs() < 1e-4 * scale;
        prop_assert!(near(after.s - before.s, now.v, peak.v));
        prop_assert!(near(after.v - before.v, now.a, peak.a));
        prop_assert!(near(after.a - before.a, now.j, peak.j));
        prop_assert!(near(after.j - before.j, now.dj, peak.dj));
    }

    #[test]
    fn m8a_residual_stays_below_its_bound(
        length in signed(1e-3, 1e3),
        duration in magnitude(1e-3, 10.0),
        mode in magnitude(0.1, 1e3),
    ) {
        let stroke = Stroke::new(length, duration);
        prop_assert!(stroke.residual(mode) <= stroke.residual_bound(mode) * (1.0 + 1e-9));
        prop_assert!(stroke.residual_bound(mode) <= length.abs());
    }
}

/// M8a against an oscillator carried by the stroke, integrated step by step: y'' = −ω² y − a(p).
#[test]
fn m8a_residual_of_a_simulated_mode() {
    let stroke = Stroke::new(5.0, 0.09);
    for mode in [10.0, 22.0, 31.0, 44.4, 57.0] {
        let (omega, step) = (std::f64::consts::TAU * mode, 1e-6);
        let (mut y, mut v) = (0.0, 0.0);
        for i in 0..90_000 {
            v -= step * (omega * omega * y + stroke.at(step * (f64::from(i) + 0.5)).a);
            y += step * v;
        }
        let amplitude = (y * y + v * v / (omega * omega)).sqrt();
        let formula = stroke.residual(mode);
        assert!((amplitude - formula).abs() < 1e-3 * 5.0, "{mode} Hz: {amplitude} against {formula}");
    }
    assert!(stroke.residual(2.0 / 0.09) < 1e-12, "N = 1 leaves nothing");
    assert!((stroke.residual(0.0) - 5.0).abs() < 1e-12, "an infinitely soft mode keeps the whole stroke");
}

#[test]
fn empty_stroke_rests() {
    let stroke = Stroke::new(0.0, 0.0);
    assert_eq!(stroke.at(0.0), Sample::default());
    assert_eq!(stroke.at(1.0), Sample::default());
    let limits = Limits { v: 1.0, a: 1.0, j: 1.0, dj: 1.0 };
    assert_eq!(limits.top_ratio(&stroke.peak()), f64::INFINITY);
    assert_eq!(Stroke::shortest(0.0, &limits), 0.0);
}
