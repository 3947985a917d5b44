//! The model against the lobes, which know nothing of it, and what a variation gains.

use machine::Machine;
use protocol::{Variation, VariationShape};

use super::limit::Case;
use super::lobes::{least_mm, limit_mm};
use super::*;

fn limit(rpm: f64, variation: Option<Variation>) -> f64 {
    let case = Case { mode: MODE, stiffness_n_mm2: STIFFNESS_N_MM2, rpm, variation, seed: 1 };
    case.limit_mm(least_mm(&MODE, STIFFNESS_N_MM2)).expect("there is a limit")
}

#[test]
fn m237_at_an_even_speed_the_model_has_the_limits_of_the_lobes() {
    for rpm in [97.0, 150.0, 240.0, 311.0, 480.0, 600.0, 777.0, 1000.0, 1450.0, 1800.0, 2400.0, 2900.0] {
        let (found, lobes) = (limit(rpm, None), limit_mm(&MODE, STIFFNESS_N_MM2, rpm));
        assert!((found / lobes - 1.0).abs() < 0.03, "S{rpm}: {found} mm, by the lobes {lobes}");
    }
}

#[test]
fn m238_the_variation_is_as_strong_as_the_drive_allows_and_no_stronger() {
    let machine = Machine::default();
    let mut before = f64::INFINITY;
    for rpm in [90.0, 240.0, 400.0, 600.0, 1200.0, 2000.0] {
        let varied = strongest(&machine, rpm).expect("it can be varied a little");
        // A sine of a share a over P turns at n turn/s needs at most n² a 2π/P (1 + a), at least n² a 2π/P.
        let n = rpm / 60.0;
        let least = n * n * varied.share * core::f64::consts::TAU / varied.revolutions * 60.0;
        assert!(least <= 0.9 * machine.spindle.ramp_rpm_s, "S{rpm}: {varied:?}");
        let bound = varied.share < SHARE || varied.revolutions > PERIODS[0];
        assert!(
            !bound || least * (1.0 + varied.share) > 0.85 * machine.spindle.ramp_rpm_s,
            "S{rpm}: {varied:?}"
        );
        let strength = varied.share / varied.revolutions;
        assert!(strength <= before);
        before = strength;
    }
}

#[test]
fn a_variation_helps_at_the_named_speed_and_not_with_a_weak_drive_or_like_turns() {
    let machine = Machine::default();
    let named = limit(NAMED_RPM, strongest(&machine, NAMED_RPM)) / limit(NAMED_RPM, None);
    assert!(named >= ASKED, "S{NAMED_RPM}: {named}");
    for rpm in [1800.0, 2400.0] {
        let fast = limit(rpm, strongest(&machine, rpm)) / limit(rpm, None);
        assert!(fast < 1.05, "S{rpm}: {fast}");
    }
    let gain = |revolutions| period(revolutions, 1).expect("there is a limit").gain;
    assert!(gain(1.0) < 1.05 && gain(0.5) < 1.05 && gain(2.0) > ASKED);
}

#[test]
fn a_variation_of_nothing_changes_nothing() {
    let hardly = Variation { shape: VariationShape::Sine, share: 1e-6, revolutions: 4.0 };
    for rpm in [240.0, 900.0] {
        let [even, varied] = [None, Some(hardly)].map(|variation| limit(rpm, variation));
        assert!((varied / even - 1.0).abs() < 0.02, "S{rpm}: {even} and {varied}");
    }
}

#[test]
fn on_the_whole_lathe_a_thread_chatters_at_the_even_speed_and_not_at_the_varied_one() {
    let stand = Stand { machine: Machine::default(), seed: 1, progress: false };
    let threads = lathe::threads(&stand).expect("they can be cut");
    let worst = |thread: &lathe::Thread| thread.passes.iter().map(|pass| pass[2]).fold(0.0, f64::max);
    let [even, varied] = [worst(&threads[0]), worst(&threads[1])];
    assert!(even > 3.0 * varied, "even {even} µm, varied {varied} µm");
}
