//! A pass as a whole: parts that follow each other and parts that overlap.

use motion::{PassLaw, Window};

const S: f64 = 600.0;

fn turning() -> PassLaw {
    let run_in = Window { c: 100.0, dc: 240.0, lambda: 0.4 };
    let brake = Window { c: 2000.0, dc: 300.0, lambda: 0.5 };
    PassLaw::new(S)
        .with_approach(-2.0, 40.0, 300.0)
        .with_lead(-3.0, run_in, brake)
        .with_retract(2.0, 1900.0, 350.0)
}

#[test]
fn is_continuous_in_angle_up_to_the_jerk() {
    let law = turning();
    let (mut before, step) = (law.at(0.0), 0.01);
    let dt = step / (6.0 * S);
    let peak = law.peak();
    for i in 1..260_000 {
        let now = law.at(f64::from(i) * step);
        assert!((now.s - before.s - 0.5 * (now.v + before.v) * dt).abs() < 1e-9);
        assert!((now.v - before.v).abs() <= 1.001 * peak.a * dt, "at {}", f64::from(i) * step);
        assert!((now.a - before.a).abs() <= 1.001 * peak.j * dt);
        assert!((now.j - before.j).abs() <= 1.001 * peak.dj * dt);
        before = now;
    }
}

#[test]
fn the_lead_goes_through_the_middle_of_the_run_in() {
    let run_in = Window { c: 100.0, dc: 240.0, lambda: 0.4 };
    let law = PassLaw::new(S).with_lead(-3.0, run_in, Window { c: 2000.0, dc: 300.0, lambda: 0.5 });
    for c in [340.0, 1000.0, 1999.0] {
        let helix = -3.0 * (c - 220.0) / 360.0;
        assert!((law.at(c).s - helix).abs() < 1e-12, "at {c}");
        assert_eq!(law.at(c).a, 0.0);
    }
    let rest = law.at(2300.0);
    assert!((rest.s + 3.0 * (2000.0 - 220.0) / 360.0 + 3.0 * 300.0 / 720.0).abs() < 1e-12);
    assert_eq!((rest.v, law.at(9e9).v), (0.0, 0.0));
}

#[test]
fn a_law_without_parts_rests() {
    let law = PassLaw::new(S);
    assert_eq!(law.at(1e6).s, 0.0);
    assert_eq!(law.peak().v, 0.0);
}

#[test]
fn positions_do_not_depend_on_the_programmed_speed() {
    let windows = (Window { c: 100.0, dc: 240.0, lambda: 0.4 }, Window { c: 2000.0, dc: 300.0, lambda: 0.5 });
    let law = |s| PassLaw::new(s).with_lead(2.0, windows.0, windows.1).with_retract(1.0, 1900.0, 200.0);
    let (slow, fast) = (law(30.0), law(3000.0));
    for c in (0..2500).map(f64::from) {
        assert!((slow.at(c).s - fast.at(c).s).abs() < 1e-12);
    }
}
