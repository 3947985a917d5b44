//! The spindle and its encoder, seen from outside.

use crate::stand::Stand;
use machine::Machine;
use protocol::Truth;

fn turning(rpm: f64) -> Stand {
    let mut stand = Stand::lathe();
    stand.spindle.rpm = rpm;
    stand
}

#[test]
fn the_speed_follows_the_ramp_of_the_drive() {
    for rpm in [600.0, -600.0] {
        let mut stand = turning(rpm);
        let half_way = stand.run(750).truth().spindle_rpm;
        assert!((half_way - rpm / 2.0).abs() < 20.0, "{half_way} rpm after 0.375 s");
        let overshoot = (0..4000).map(|_| stand.tick().spindle_rpm.abs()).fold(0.0, f64::max);
        assert!(overshoot < 615.0, "{overshoot} rpm");
        assert!((stand.truth().spindle_rpm - rpm).abs() < 1.5);
    }
}

#[test]
fn it_stops_and_stands() {
    let mut stand = turning(300.0);
    stand.run(2000);
    stand.spindle.rpm = 0.0;
    stand.run(4000);
    let deg = stand.truth().spindle_deg;
    assert_eq!(stand.truth().spindle_rpm, 0.0);
    assert_eq!(stand.run(1000).truth().spindle_deg, deg);
    stand.spindle.rpm = f64::NAN;
    assert_eq!(stand.run(1000).truth().spindle_deg, deg);
}

#[test]
fn every_turn_has_one_index_at_a_whole_number_of_turns() {
    let counts = 10_000;
    for rpm in [613.0, -613.0, 3000.0, -31.0] {
        let mut stand = turning(rpm);
        let mut before: Truth = *stand.truth();
        let start_deg = before.spindle_deg;
        for _ in 0..20_000 {
            let now = *stand.tick();
            let (m, b) = (now.measurement, before.measurement);
            let passed = (now.spindle_deg / 360.0).floor() != (before.spindle_deg / 360.0).floor();
            assert_eq!(m.index_number, b.index_number + u64::from(passed));
            if passed {
                assert_eq!(m.index_cycle, now.cycle);
                let span = [b.spindle_count, m.spindle_count];
                let (low, high) = (span[0].min(span[1]), span[0].max(span[1]));
                assert!((low..=high).contains(&m.index_count), "{} in {low}..{high}", m.index_count);
                if b.index_number > 0 {
                    assert_eq!((m.index_count - b.index_count).abs(), counts);
                }
            } else {
                assert_eq!((m.index_count, m.index_cycle), (b.index_count, b.index_cycle));
            }
            before = now;
        }
        let turns = (before.spindle_deg / 360.0).floor() - (start_deg / 360.0).floor();
        assert_eq!(before.measurement.index_number as f64, turns.abs());
    }
}

#[test]
fn an_index_is_seen_again_on_the_way_back() {
    let mut stand = turning(60.0);
    stand.run(4000);
    let forth = stand.truth().measurement;
    stand.spindle.rpm = -60.0;
    while stand.tick().measurement.index_number == forth.index_number {}
    let back = stand.truth().measurement;
    // The index met first on the way back is the last one of the way forth, or the one the ramp still passed.
    assert!((back.index_count - forth.index_count).abs() <= 10_000);
    assert_eq!((back.index_count - forth.index_count) % 10_000, 0);
}

#[test]
fn counts_are_the_true_angle_in_quanta() {
    let mut stand = turning(417.0);
    let first = *stand.truth();
    assert_eq!(first.measurement.spindle_count, 0);
    for _ in 0..4000 {
        let now = *stand.tick();
        let counts = (now.spindle_deg - first.spindle_deg) / 360.0 * 10_000.0;
        let gap = now.measurement.spindle_count as f64 - counts;
        assert!((-1.0..1.0).contains(&gap), "{gap} counts");
    }
}

#[test]
fn ripple_has_its_size_and_its_order() {
    let mut stand = turning(600.0);
    stand.run(8000);
    // One turn at 600 rpm: 200 cycles.
    let speeds: Vec<f64> = (0..200).map(|_| stand.tick().spindle_rpm).collect();
    let share = |order: f64| {
        let (mut c, mut s) = (0.0, 0.0);
        for (i, rpm) in speeds.iter().enumerate() {
            let (sin, cos) = libm::sincos(core::f64::consts::TAU * order * i as f64 / 200.0);
            (c, s) = (c + rpm * cos / 100.0, s + rpm * sin / 100.0);
        }
        (c * c + s * s).sqrt() / 600.0
    };
    assert!((share(2.0) - 0.002).abs() < 1e-4, "{}", share(2.0));
    assert!(share(1.0) < 2e-4 && share(3.0) < 2e-4, "{} {}", share(1.0), share(3.0));
}

#[test]
fn an_even_spindle_has_none() {
    let plant = "[spindle]\nripple_pct = 0".parse().unwrap();
    let machine = Machine { plant, ..Machine::plain() };
    let mut stand = Stand::new(&machine, sim_plant::Scenario::none(), 1);
    stand.spindle.rpm = 600.0;
    stand.run(8000);
    let spread = (0..200).map(|_| (stand.tick().spindle_rpm - 600.0).abs()).fold(0.0, f64::max);
    assert!(spread < 0.01, "{spread} rpm");
}

/// The small lathe with such keys of the spindle, up to speed.
fn with(keys: &str, rpm: f64) -> Stand {
    let plant = format!("[spindle]\n{keys}").parse().expect("the table of the test");
    let mut stand = Stand::new(&Machine { plant, ..Machine::plain() }, sim_plant::Scenario::none(), 1);
    stand.spindle.rpm = rpm;
    stand.run(8000);
    stand
}

/// Sizes of harmonics of values at angles in turns, over whole turns.
fn harmonics<const N: usize>(seen: &[(f64, f64)], orders: [f64; N]) -> [f64; N] {
    orders.map(|order| {
        let (mut c, mut s) = (0.0, 0.0);
        for (turns, value) in seen {
            let (sin, cos) = libm::sincos(core::f64::consts::TAU * order * turns);
            (c, s) = (c + value * cos, s + value * sin);
        }
        2.0 * (c * c + s * s).sqrt() / seen.len() as f64
    })
}

#[test]
fn a_ripple_of_several_harmonics_has_them_all() {
    let mut stand = with("ripple_pct = [0.2, 0.5, 0.1]\nripple_per_rev = [2, 1, 9]", 600.0);
    // One turn at 600 rpm: 200 cycles.
    let seen: Vec<_> = (0..200).map(|i| (f64::from(i) / 200.0, stand.tick().spindle_rpm / 600.0)).collect();
    let [one, two, three, nine] = harmonics(&seen, [1.0, 2.0, 3.0, 9.0]);
    assert!((two - 0.002).abs() < 1e-4 && (one - 0.005).abs() < 1e-4, "{one} {two}");
    assert!((nine - 0.001).abs() < 1e-4 && three < 2e-4, "{nine} {three}");
}

#[test]
fn a_list_of_one_is_a_number() {
    let run = |keys: &str| *with(keys, 417.0).truth();
    assert_eq!(run("ripple_pct = 0.3"), run("ripple_pct = [0.3]\nripple_per_rev = [2]"));
}

#[test]
fn an_encoder_has_its_errors_and_moves_nothing_else() {
    // 600 and 200 seconds of arc are 4.63 and 1.54 of the 10,000 counts of a turn.
    let mut stand = with("encoder_error_arcsec = [[1, 600], [7, 200]]", 600.0);
    let mut sound = with("", 600.0);
    let mut latched = Vec::new();
    let seen: Vec<_> = (0..2000)
        .map(|_| {
            let (truth, plain) = (*stand.tick(), *sound.tick());
            assert_eq!(truth.spindle_deg, plain.spindle_deg);
            assert_eq!(truth.axes, plain.axes);
            assert_eq!(truth.measurement.axes, plain.measurement.axes);
            latched.push(truth.measurement.index_count - plain.measurement.index_count);
            let turns = truth.spindle_deg / 360.0;
            (turns, truth.measurement.spindle_count as f64 - 1e4 * turns)
        })
        .collect();
    let [one, seven, three] = harmonics(&seen, [1.0, 7.0, 3.0]);
    assert!((one - 4.63).abs() < 0.1 && (seven - 1.543).abs() < 0.1 && three < 0.1, "{one} {seven} {three}");
    // The index comes where it comes: what is latched there is off by the same in every turn.
    assert!(latched.iter().all(|off| (off - latched[0]).abs() <= 1), "{latched:?}");
}

#[test]
fn the_latch_of_the_index_jitters_by_a_time() {
    let latched = |keys: &str, rpm: f64, cycles: u32| {
        let mut stand = with(keys, rpm);
        let mut seen = Vec::new();
        for _ in 0..cycles {
            let before = stand.truth().measurement.index_number;
            let now = stand.tick().measurement;
            if now.index_number != before {
                seen.push(now.index_count as f64 - 1e4 * now.index_number as f64);
            }
        }
        let mean = seen.iter().sum::<f64>() / seen.len() as f64;
        let most = seen.iter().map(|count| (count - mean).abs()).fold(0.0, f64::max);
        let rms = (seen.iter().map(|count| (count - mean).powi(2)).sum::<f64>() / seen.len() as f64).sqrt();
        (most, rms)
    };
    assert_eq!(latched("", 600.0, 20_000).1, 0.0);
    // 50 µs at ten turns a second are five counts: evenly spread, so 5/√3 by their squares.
    let (most, rms) = latched("index_jitter_s = 50e-6", 600.0, 60_000);
    assert!(most < 6.0 && most > 4.0 && (rms / 2.9 - 1.0).abs() < 0.1, "{most} {rms}");
    let (most, _) = latched("index_jitter_s = 50e-6", 60.0, 60_000);
    assert!(most < 1.5, "{most} counts at a tenth of the speed");
}

#[test]
fn a_spindle_that_is_sampled_before_the_axes_is_seen_where_it_was() {
    let behind = |keys: &str| {
        let mut stand = with(keys, 600.0);
        let origin = {
            let truth = stand.truth();
            truth.measurement.index_count as f64 - 1e4 * (truth.spindle_deg / 360.0).floor()
        };
        let behind =
            |truth: &Truth| truth.spindle_deg / 360.0 * 1e4 + origin - truth.measurement.spindle_count as f64;
        (0..2000).map(|_| behind(stand.tick())).sum::<f64>() / 2000.0
    };
    let prompt = behind("");
    for (delay_s, counts) in [(1e-4, 10.0), (-1e-4, -10.0), (3e-5, 3.0)] {
        let late = behind(&format!("encoder_delay_s = {delay_s:?}")) - prompt;
        assert!((late - counts).abs() < 0.2, "{late} counts behind with {delay_s} s");
    }
}
