//! Bounds against searches that know nothing of them: the observer itself on counts of a varied spindle, a
//! loop of the control step by step.

use motion::SpindleObserver;
use protocol::{Axis, ThreadPass, VariationShape};
use testing::Seed;

use super::*;

/// A pass with a lead, that the axes can follow at a ratio.
fn pass(lead_mm: f64, s_rpm: f64, max_ratio: f64) -> ThreadPass {
    let mut pass = ThreadPass { pass: 1, s_rpm, max_ratio, lead_mm, direction: 1.0, ..ThreadPass::default() };
    pass.axes[Axis::Z.index()].lead_mm = lead_mm;
    pass
}

fn variation(shape: VariationShape, share: f64, revolutions: f64) -> Variation {
    Variation { shape, share, revolutions }
}

/// A machine, a pass and a variation that can be: the built-in lathe with another encoder and observer, half
/// the time at the limit of its ramp.
fn any(seed: &mut Seed, round: usize) -> (Machine, ThreadPass, Variation) {
    let mut machine = Machine::default();
    machine.spindle.encoder_lines = seed.between(500.0, 5000.0) as u32;
    machine.spindle.observer_hz = seed.between(20.0, 60.0);
    machine.spindle.ramp_rpm_s = seed.between(200.0, 6000.0);
    machine.threading.variation.error_um = 1000.0;
    let shape = VariationShape::ALL[round % 3];
    let pass = pass(seed.between(0.5, 6.0), seed.between(30.0, 1500.0), 2.0);
    let asked = variation(shape, seed.between(0.05, 0.5), seed.between(0.5, 20.0));
    match machine.shortest_period(&pass, &asked) {
        Some(revolutions) => (machine, pass, Variation { revolutions, ..asked }),
        // So large a share cannot be at this speed, however long the period is.
        None => any(seed, round),
    }
}

/// The largest error of the angle that the observer gives, asked ahead, over a pass, turns.
fn searched_error(machine: &Machine, pass: &ThreadPass, variation: &Variation, ahead_s: f64) -> f64 {
    let (period, counts) = (machine.general.cycle_s, machine.spindle_counts());
    let mut observer = SpindleObserver::of_counts(machine.spindle.observer_hz, period);
    let law = SpeedLaw::new(*variation, u64::from(pass.pass));
    let speed = pass.s_rpm / 60.0;
    // Steady for a second, then varied for eight periods or ten seconds.
    let (dt, lag) = (period / 8.0, (ahead_s / period * 8.0).round() as usize);
    let (mut angle, mut since, mut angles) = (0.37, 0.0, Vec::new());
    let seconds = 1.0 + (8.0 * variation.revolutions / speed).min(10.0) + ahead_s;
    for step in 0..(seconds / dt) as usize {
        angles.push(angle);
        let varies = step as f64 * dt >= 1.0;
        let rate = |turns: f64| if varies { speed * law.share(turns) } else { speed };
        let moved = dt * rate(since + 0.5 * dt * rate(since));
        angle += moved;
        since += if varies { moved } else { 0.0 };
    }
    observer.start((angles[0] * counts).floor() + 0.5, speed * counts);
    let mut worst = 0.0_f64;
    for step in (8..angles.len() - lag).step_by(8) {
        observer.update((angles[step] * counts).floor() + 0.5);
        if step as f64 * dt > 0.9 {
            let told = observer.at(lag as f64 * dt).angle / counts;
            worst = worst.max((told - angles[step + lag]).abs());
        }
    }
    worst
}

#[test]
fn m232_no_search_finds_an_observer_that_errs_more_than_the_bound() {
    let (mut seed, mut nearest) = (Seed::new(0x5eed), 0.0_f64);
    for round in 0..150 {
        let (machine, pass, variation) = any(&mut seed, round);
        let (lead_mm, ahead_s) = (pass.lead_mm, machine.observed_ahead_s(&machine.axis[&Axis::Z]));
        let found_um = 1e3 * lead_mm * searched_error(&machine, &pass, &variation, ahead_s);
        let bound_um = machine.variation_error_um(&pass, &variation, 1.0);
        assert!(found_um <= bound_um, "{variation:?} {pass:?}: {found_um} µm, bound {bound_um}");
        nearest = nearest.max(found_um / bound_um);
    }
    assert!(nearest > 0.4, "the bound is no more than it has to be: {nearest}");
}

/// What errs in degrees errs most where a lead that changes is largest.
#[test]
fn m232_counts_the_largest_lead_of_a_chain() {
    let (machine, varied) = (Machine::default(), variation(VariationShape::Sine, 0.2, 4.0));
    let mut growing = pass(1.0, 400.0, 2.0);
    let constant_um = machine.variation_error_um(&growing, &varied, 1.0);
    growing.axes[Axis::Z.index()].steepest_mm = 3.0;
    let grown_um = machine.variation_error_um(&growing, &varied, 1.0);
    assert!((grown_um - 3.0 * constant_um).abs() < 1e-9 * grown_um, "{grown_um} of {constant_um}");
}

/// The loop of M54 about a rigid mass that is believed a tenth too light, step by step, while the spindle of
/// a variation leads it: the largest error over the one that the bound allows.
fn loop_share(config: &AxisConfig, mut acceleration: impl FnMut(f64) -> f64, most: f64) -> f64 {
    let (dt, kv, w) = (2e-5, config.position_gain_1_s, TAU * config.velocity_bandwidth_hz);
    // e″ = 0.1 a − ω_v (e′ + K e + ∫ (e′ + K e)/T_i): the velocity loop counters what the mass lacks.
    let (mut e, mut v, mut integral, mut worst) = (0.0, 0.0, 0.0, 0.0_f64);
    for step in 0..150_000 {
        let lacks = WRONG * acceleration(f64::from(step) * dt);
        let error = v + kv * e;
        integral += error / config.velocity_integral_s * dt;
        v += (lacks - w * (error + integral)) * dt;
        e += v * dt;
        worst = worst.max(e.abs());
    }
    worst / (WRONG * most / (kv * w))
}

#[test]
fn m232_a_loop_whose_mass_is_a_tenth_off_leaves_less_than_the_bound() {
    let (machine, mut nearest) = (Machine::default(), 0.0_f64);
    for round in 0..12 {
        let variation = variation(VariationShape::ALL[round % 3], 0.3, 0.5 + round as f64);
        for rpm in [60.0, 200.0, 700.0] {
            let (law, speed, mut turns, mut before) = (SpeedLaw::new(variation, 3), rpm / 60.0, 0.0, 0.0);
            let [most, _] = law::peaks(&variation, speed);
            let acceleration = |time: f64| {
                let (dt, n) = (time - before, speed * law.share(turns));
                turns += n * dt;
                before = time;
                if dt > 0.0 { (speed * law.share(turns) - n) / dt } else { 0.0 }
            };
            let share = loop_share(&machine.axis[&Axis::Z], acceleration, most);
            assert!(share <= 1.0, "{variation:?} S{rpm}: {share}");
            nearest = nearest.max(share);
        }
    }
    assert!(nearest > 0.2, "the bound is about that: {nearest}");
}

#[test]
fn m233_each_limit_is_told_and_what_is_told_instead_can_be() {
    let machine = Machine::default();
    let sine = |share, revolutions| variation(VariationShape::Sine, share, revolutions);
    type Told = fn(&NotVaried) -> bool;
    let cases: [(f64, f64, f64, Variation, Told); 5] = [
        (2.0, 150.0, 1.2, sine(0.3, 4.0), |why| matches!(why, NotVaried::Axes { .. })),
        (0.1, 2900.0, 2.0, sine(0.3, 900.0), |why| matches!(why, NotVaried::Spindle { .. })),
        (2.0, 600.0, 2.0, sine(0.5, 40.0), |why| matches!(why, NotVaried::Watch { .. })),
        (2.0, 300.0, 2.0, sine(0.3, 1.0), |why| matches!(why, NotVaried::Ramp { .. })),
        (40.0, 140.0, 2.0, sine(0.3, 1.0), |why| matches!(why, NotVaried::Error { .. })),
    ];
    for (lead_mm, s_rpm, max_ratio, asked, told) in cases {
        let pass = pass(lead_mm, s_rpm, max_ratio);
        let why = machine.varied(&pass, &asked).expect_err("it cannot be");
        assert!(told(&why), "{asked:?}: {why:?}");
        if let Some(share) = machine.largest_share(&pass, &asked) {
            assert!(share < asked.share && machine.varied(&pass, &Variation { share, ..asked }).is_ok());
            let more = Variation { share: share + 0.002, ..asked };
            assert!(machine.varied(&pass, &more).is_err(), "{share} is the largest");
        }
        if let Some(revolutions) = machine.shortest_period(&pass, &asked) {
            let longer = Variation { revolutions, ..asked };
            assert!(revolutions > asked.revolutions && machine.varied(&pass, &longer).is_ok());
            let shorter = Variation { revolutions: revolutions - 0.2, ..asked };
            assert!(machine.varied(&pass, &shorter).is_err(), "{revolutions} is the shortest");
        }
    }
    let pass = pass(2.0, 300.0, 2.0);
    assert_eq!(machine.largest_share(&pass, &sine(0.1, 4.0)), Some(0.1));
}

#[test]
fn the_highest_override_is_the_one_at_which_the_first_limit_is_reached() {
    let machine = Machine::default();
    for (s_rpm, share) in [(200.0, 0.1), (300.0, 0.2), (330.0, 0.2), (300.0, 0.28)] {
        let (pass, asked) = (pass(2.0, s_rpm, 2.0), variation(VariationShape::Sine, share, 4.0));
        let varied = machine.varied(&pass, &asked).expect("it can be");
        // The ramp grows with the square of the override, and is what binds here, or the knob.
        let by_ramp = (720.0 / varied.ramp_rpm_s).sqrt();
        assert!((varied.max_ratio - by_ramp.min(1.2)).abs() < 1e-6, "{varied:?}, by the ramp {by_ramp}");
        assert_eq!(varied.rpm, [s_rpm * (1.0 - share), s_rpm * (1.0 + share)]);
    }
}
