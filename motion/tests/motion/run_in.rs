//! The shortest run-in of a thread: how soon the commanded Z lies on the helix. Ideal spindle, mm and s.
//!
//! Phase rule: the run-in is centred on the programmed start angle, C0 + ΔC/2, so the helix through the
//! programmed start point is z = F (C − C0 − ΔC/2)/360 = V (p − T/2), p the time since C0 at programmed speed
//! (M1, M10).

use motion::{Limits, Ramp, Sample};

const LIMITS: Limits = Limits { v: 100.0, a: 500.0, j: 50_000.0, dj: 1.0e7 };
const LEAD: f64 = 2.0;
const POINTS: u32 = 200_000;

/// Commanded Z at the first sample from which on the axis stays within `tolerance` mm of the helix, mm of
/// travel.
fn travel_until_within(tolerance: f64, run_in: &Ramp) -> f64 {
    let last_outside = samples(run_in)
        .filter(|&(p, z)| (z - run_in.dv() * (p - 0.5 * run_in.duration())).abs() > tolerance)
        .last();
    last_outside.map_or(0.0, |(_, z)| z)
}

/// (p, z) over the run-in and as long again.
fn samples(run_in: &Ramp) -> impl Iterator<Item = (f64, f64)> {
    (0..=POINTS).map(|i| {
        let p = 2.0 * run_in.duration() * f64::from(i) / f64::from(POINTS);
        (p, run_in.at(p).s)
    })
}

/// Fastest run-in at `s_rpm`: its travel until within 10 µm and 1 µm of the helix, and all figures in words.
fn measured(s_rpm: f64) -> (f64, f64, String) {
    let run_in = Ramp::fastest(LEAD * s_rpm / 60.0, &LIMITS);
    let (ten, one) = (travel_until_within(10e-3, &run_in), travel_until_within(1e-3, &run_in));
    let figures = format!(
        "S {s_rpm}: {:.4} s, {:.4} mm; within 10 um after {ten:.4} mm, 1 um after {one:.4} mm; {:?}",
        run_in.duration(),
        run_in.distance(),
        run_in.peak(),
    );
    (ten, one, figures)
}

#[test]
fn run_in_meets_the_helix_at_600_rpm() {
    let (ten, one, figures) = measured(600.0);
    println!("{figures}");
    assert!(ten <= 0.34, "10 µm after {ten} mm");
    assert!(one <= 0.46, "1 µm after {one} mm");
}

#[test]
fn run_in_meets_the_helix_at_1000_rpm() {
    let (ten, one, figures) = measured(1000.0);
    println!("{figures}");
    assert!(ten <= 0.98, "10 µm after {ten} mm");
    assert!(one <= 1.20, "1 µm after {one} mm");
}

/// Sampled jerk, and the jerk regained from differences of the sampled acceleration, so that the law cannot
/// excuse itself by reporting a jerk it does not make.
#[test]
fn run_in_keeps_its_limits() {
    for s_rpm in [600.0, 1000.0] {
        let run_in = Ramp::fastest(LEAD * s_rpm / 60.0, &LIMITS);
        let step = run_in.duration() / f64::from(POINTS);
        let mut before = run_in.at(0.0);
        for i in 1..=POINTS {
            let now = run_in.at(step * f64::from(i));
            assert!(now.v.abs() <= LIMITS.v && now.a.abs() <= LIMITS.a, "{now:?}");
            assert!(now.j.abs() <= LIMITS.j && now.dj.abs() <= LIMITS.dj, "{now:?}");
            let mean_jerk = (now.a - before.a) / step;
            assert!(mean_jerk.abs() <= LIMITS.j * (1.0 + 1e-6), "jerk by difference {mean_jerk}");
            before = now;
        }
    }
}

#[test]
fn a_ramp_by_nothing_rests_as_long_as_it_lasts() {
    let ramp = Ramp::new(0.0, 0.2, 0.5);
    for p in [-0.1, 0.0, 0.05, 0.1, 0.15, 0.2, 0.3] {
        assert_eq!((ramp.at(p), ramp.braking_at(p)), (Sample::default(), Sample::default()), "at {p}");
    }
}
