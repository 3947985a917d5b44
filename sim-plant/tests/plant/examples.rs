//! The scenarios that are shipped, played to a spindle that cuts seven passes of 4000° without any
//! controller.

use crate::stand::Stand;
use machine::Machine;
use protocol::Panel;
use sim_plant::Scenario;

const PASS_DEG: f64 = 4000.0;

/// What the observer of a pass sees.
#[derive(Debug)]
struct Pass {
    override_at_start: f64,
    override_at_end: f64,
    override_low: f64,
    /// Lowest and highest true speed, share of the commanded one at 100 %.
    low: f64,
    high: f64,
    /// Time below 90 % of the commanded speed, s.
    bogged_s: f64,
}

fn play(text: &str, rpm: f64) -> Vec<Pass> {
    let mut stand =
        Stand::new(&Machine::plain(), Scenario::from_toml(text).expect("shipped scenarios are sound"), 1);
    let passes = (1..=7).map(|number| cut(&mut stand, number, rpm)).collect();
    assert_eq!(stand.plant.pending_events().count(), 0, "events that never happened at {rpm} rpm");
    passes
}

fn cut(stand: &mut Stand, number: u32, rpm: f64) -> Pass {
    let knob = |panel: &Panel| panel.spindle_override_pct;
    let follow = |stand: &mut Stand| {
        stand.spindle.rpm = rpm * 0.01 * knob(&stand.plant.measurement().panel);
        *stand.tick()
    };
    stand.spindle.pass = 0;
    for _ in 0..3000 {
        follow(stand);
    }
    let start = *stand.truth();
    (stand.spindle.pass, stand.spindle.direction) = (number, 1.0);
    stand.spindle.index_not_before = start.cycle.after(1);
    let (mut low, mut high, mut bogged_s, mut override_low) = (f64::MAX, 0.0, 0.0, f64::MAX);
    while stand.truth().spindle_deg < start.spindle_deg + 360.0 + PASS_DEG {
        let now = follow(stand);
        let share = now.spindle_rpm / rpm;
        (low, high) = (share.min(low), share.max(high));
        override_low = knob(&now.measurement.panel).min(override_low);
        bogged_s += if share < 0.9 { 0.0005 } else { 0.0 };
    }
    Pass {
        override_at_start: knob(&start.measurement.panel),
        override_at_end: knob(&stand.plant.measurement().panel),
        override_low,
        low,
        high,
        bogged_s,
    }
}

#[test]
fn override_100_80_60_changes_between_the_passes() {
    for rpm in [200.0, 300.0, 600.0] {
        let passes = play(include_str!("../../../examples/scenarios/override-100-80-60.toml"), rpm);
        for (pass, expected) in passes.iter().zip([100.0, 80.0, 60.0, 100.0, 80.0, 60.0, 100.0]) {
            assert_eq!((pass.override_at_start, pass.override_at_end), (expected, expected), "{passes:#?}");
            let share = 0.01 * expected;
            assert!(pass.low > 0.98 * share && pass.high < 1.02 * share, "settled at the start: {passes:#?}");
        }
    }
}

#[test]
fn override_in_pass_goes_down_and_comes_back() {
    for rpm in [200.0, 300.0, 600.0] {
        let passes = play(include_str!("../../../examples/scenarios/override-in-pass.toml"), rpm);
        for (index, pass) in passes.iter().enumerate() {
            let turned = matches!(index + 1, 2 | 3);
            assert_eq!(pass.override_low, if turned { 60.0 } else { 100.0 }, "{passes:#?}");
            assert_eq!((pass.override_at_start, pass.override_at_end), (100.0, 100.0), "{passes:#?}");
            assert_eq!(pass.low < 0.65, turned, "{passes:#?}");
        }
    }
}

#[test]
fn bogged_spindle_falls_by_a_fifth_for_a_fifth_of_a_second() {
    for (rpm, bogged) in [(200.0, 2), (300.0, 4), (600.0, 4)] {
        let passes = play(include_str!("../../../examples/scenarios/bogged-spindle.toml"), rpm);
        let pass = &passes[bogged - 1];
        assert!((0.78..0.82).contains(&pass.low), "{rpm} rpm: {passes:#?}");
        assert!((0.15..0.25).contains(&pass.bogged_s), "{rpm} rpm: {passes:#?}");
        assert!(passes[0].low > 0.99 && passes[4].low > 0.99, "{rpm} rpm: {passes:#?}");
        assert!(passes.iter().all(|pass| pass.low > 0.3), "never stalls: {passes:#?}");
    }
}
