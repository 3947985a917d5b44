//! Ramps (M9–M21): run-in, run-out, and the fastest member of the family.

use super::draw::{keeps, limits, magnitude, magnitudes, signed, smooth, times};
use motion::{Limits, Ramp, Sample};
use proptest::prelude::*;

/// Limits without a bound on speed: a ramp is held to the other three.
fn without_speed(limits: Limits) -> Limits {
    Limits { v: f64::INFINITY, ..limits }
}

fn ramps() -> impl Strategy<Value = Ramp> {
    (signed(1e-3, 1e3), magnitude(1e-3, 10.0), 0.02..=0.5)
        .prop_map(|(dv, duration, lambda)| Ramp::new(dv, duration, lambda))
}

proptest! {
    #[test]
    fn m13_ramp_is_smooth(ramp in ramps()) {
        smooth(ramp.duration(), &ramp.peak(), |p| ramp.at(p))?;
        smooth(ramp.duration(), &ramp.peak(), |p| ramp.braking_at(p))?;
    }

    #[test]
    fn m13_ramp_stays_within_its_peaks_and_never_slows(ramp in ramps()) {
        let mut before = 0.0;
        for p in times(ramp.duration(), 1000) {
            let sample = ramp.at(p);
            prop_assert!(keeps(&magnitudes(sample), &ramp.peak()), "at {}", p);
            let speed = sample.v * ramp.dv().signum();
            prop_assert!(speed >= before - 1e-15 * ramp.dv().abs(), "slows at {}", p);
            before = speed;
        }
    }

    #[test]
    fn m14_thread_continues_the_helix(ramp in ramps(), later in 0.0..3.0) {
        let duration = ramp.duration();
        prop_assert_eq!(ramp.at(0.0), Sample::default());
        prop_assert_eq!(ramp.at(duration), Sample::uniform(ramp.distance(), ramp.dv()));
        let p = duration * (1.0 + later);
        // z = F (C − C0)/360 − dZ: half the run-in behind the helix that starts at C0.
        let helix = ramp.dv() * p - ramp.distance();
        prop_assert!((ramp.at(p).s - helix).abs() <= 1e-12 * (ramp.dv() * p).abs());
    }

    #[test]
    fn m15_braking_is_the_ramp_reversed(ramp in ramps(), share in -0.5..1.5) {
        let p = share * ramp.duration();
        let (forth, back) = (ramp.at(ramp.duration() - p), ramp.braking_at(p));
        let peak = ramp.peak();
        prop_assert!((forth.s + back.s - ramp.distance()).abs() <= 1e-12 * ramp.distance().abs());
        prop_assert!((forth.v - back.v).abs() <= 1e-12 * peak.v && (forth.a + back.a).abs() <= 1e-11 * peak.a);
        prop_assert!((forth.j - back.j).abs() <= 1e-11 * peak.j && (forth.dj + back.dj).abs() <= 1e-11 * peak.dj);
        prop_assert_eq!(ramp.braking_at(0.0), Sample::uniform(0.0, ramp.dv()));
        prop_assert_eq!(ramp.braking_at(ramp.duration()), Sample::uniform(ramp.distance(), 0.0));
        prop_assert_eq!(ramp.braking_at(3.0 * ramp.duration()), Sample::uniform(ramp.distance(), 0.0));
    }

    /// The lag behind the helix (section 2) and the way still to brake make up the distance that was left to
    /// go.
    #[test]
    fn m15_braking_lags_the_helix_by_the_way_of_the_ramp(ramp in ramps(), share in 0.0..1.0) {
        let p = share * ramp.duration();
        let lag = ramp.dv() * p - ramp.braking_at(p).s;
        prop_assert!((lag - ramp.at(p).s).abs() <= 1e-12 * ramp.distance().abs());
    }

    #[test]
    fn m12_least_jerk_keeps_its_acceleration(dv in signed(1e-3, 1e3), duration in magnitude(1e-3, 10.0), a_max in magnitude(1.0, 1e4)) {
        match Ramp::least_jerk(dv, duration, a_max) {
            None => prop_assert!(dv.abs() >= a_max * duration),
            Some(ramp) => {
                prop_assert!(ramp.peak().a <= a_max * (1.0 + 1e-9));
                prop_assert!(ramp.lambda() == 0.5 || ramp.peak().a >= a_max * (1.0 - 1e-9));
                prop_assert_eq!((ramp.dv(), ramp.duration()), (dv, duration));
                // Any other member that keeps the acceleration has a higher jerk.
                let steeper = Ramp::new(dv, duration, 0.9 * ramp.lambda());
                prop_assert!(steeper.peak().j > ramp.peak().j);
            }
        }
    }

    #[test]
    fn m19_fastest_ramp_keeps_its_limits(dv in signed(1e-6, 1e3), limits in limits()) {
        let (ramp, limits) = (Ramp::fastest(dv, &limits), without_speed(limits));
        let peak = ramp.peak();
        prop_assert!(peak.a <= limits.a && peak.j <= limits.j && peak.dj <= limits.dj, "{peak:?} against {limits:?}");
        for p in times(ramp.duration(), 100) {
            let x = magnitudes(ramp.at(p));
            prop_assert!(x.a <= limits.a && x.j <= limits.j && x.dj <= limits.dj, "{x:?} at {p}");
        }
        prop_assert_eq!(ramp.duration(), Ramp::shortest(dv, &limits));
        prop_assert!((ramp.peak().j / Ramp::peak_jerk(dv, &limits).0 - 1.0).abs() < 1e-9);
        smooth(ramp.duration(), &ramp.peak(), |p| ramp.at(p))?;
    }

    /// Any member of the family, slowed down until it keeps the limits, takes at least as long: the peaks of
    /// a ramp by the same dv fall with its duration as 1/T, 1/T², 1/T³.
    #[test]
    fn m20_no_member_of_the_family_is_faster(dv in signed(1e-6, 1e3), limits in limits(), lambda in 1e-4..=0.5) {
        let unit = Ramp::new(dv, 1.0, lambda).peak();
        let other = (unit.a / limits.a).max((unit.j / limits.j).sqrt()).max(libm::cbrt(unit.dj / limits.dj));
        prop_assert!(keeps(&Ramp::new(dv, other, lambda).peak(), &without_speed(limits)), "the comparison itself");
        prop_assert!(Ramp::fastest(dv, &limits).duration() <= other * (1.0 + 1e-12));
    }

    #[test]
    fn m21_duration_grows_with_the_change_of_speed(dv in magnitude(1e-6, 1e3), more in 1e-6..1.0, limits in limits()) {
        prop_assert!(Ramp::shortest(dv * (1.0 + more), &limits) >= Ramp::shortest(dv, &limits));
        prop_assert_eq!(Ramp::shortest(-dv, &limits), Ramp::shortest(dv, &limits));
    }
}

#[test]
fn empty_ramp_rests() {
    let limits = Limits { v: 100.0, a: 500.0, j: 50_000.0, dj: 1.0e7 };
    let ramp = Ramp::fastest(0.0, &limits);
    assert_eq!((ramp.duration(), ramp.distance(), ramp.lambda()), (0.0, 0.0, 0.5));
    for p in [-1.0, 0.0, 1.0] {
        assert_eq!(ramp.at(p), Sample::default());
        assert_eq!(ramp.braking_at(p), Sample::default());
    }
    assert_eq!(limits.top_ratio(&ramp.peak()), f64::INFINITY);
}
