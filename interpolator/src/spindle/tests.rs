//! The spindle as the interpolator commands and watches it, on counts that are known.

use protocol::{Panel, PerAxis};

use super::*;

/// 100 m/min about X 2 mm, at most 1200 1/min.
fn surface() -> SpindleSpeed {
    let axis_mm = Position::from_mm(2.0);
    SpindleSpeed::Surface { mm_s: 100_000.0 / 60.0, max_rpm: 1200.0, axis_mm }
}

fn spindle() -> Spindle {
    Spindle::new(&Machine::plain())
}

/// Lets the measured speed go from `from` to `to` (1/min) within some ticks; X goes with `x`, told the
/// tick.
fn turn(spindle: &mut Spindle, count: &mut f64, ticks: u32, rpm: impl Fn(u32) -> f64) {
    for tick in 0..ticks {
        *count += rpm(tick) / spindle.rpm_per_count_s * spindle.tick_s;
        let panel = Panel { spindle_override_pct: 100.0, ..Panel::default() };
        let axes = PerAxis::default();
        let spindle_count = count.floor() as i64;
        spindle.update(&Measurement { spindle_count, panel, axes, ..Measurement::default() }, None, false);
    }
}

fn x_for(rpm: f64) -> Position {
    Position::from_mm(2.0 + 100_000.0 / (TAU * rpm))
}

#[test]
fn surface_speed_follows_x_up_to_the_highest() {
    let mut spindle = spindle();
    spindle.program(SpindleMode::Counterclockwise, surface());
    for (x, rpm) in [(x_for(300.0), -300.0), (x_for(900.0), -900.0), (Position::from_mm(2.0), -1200.0)] {
        spindle.at_x(x);
        assert!((spindle.commanded() - rpm).abs() < 1e-6, "{}", spindle.commanded());
    }
    let beyond = 2.0 * 2.0 - x_for(300.0).mm();
    spindle.at_x(Position::from_mm(beyond));
    assert!((spindle.commanded() + 300.0).abs() < 1e-6, "behind the axis it is the same");
    spindle.program(SpindleMode::Clockwise, SpindleSpeed::Rpm(500.0));
    spindle.at_x(x_for(900.0));
    assert_eq!(spindle.commanded(), 500.0);
    let still = SpindleSpeed::Surface { mm_s: 0.0, max_rpm: 1200.0, axis_mm: Position(0) };
    spindle.program(SpindleMode::Clockwise, still);
    spindle.at_x(Position(0));
    assert_eq!(spindle.commanded(), 0.0);
}

#[test]
fn at_speed_is_judged_against_the_speed_of_now() {
    let (mut spindle, mut count) = (spindle(), 0.0);
    spindle.program(SpindleMode::Clockwise, surface());
    spindle.at_x(x_for(400.0));
    assert!(!spindle.at_speed(), "it still stands");
    turn(&mut spindle, &mut count, 1000, |_| 400.0);
    assert!(spindle.at_speed());
    // A step of X, as after a rapid: the next tick commands a speed that the spindle does not have.
    for _ in 0..2 {
        spindle.at_x(x_for(800.0));
    }
    assert!(!spindle.at_speed());
    turn(&mut spindle, &mut count, 1000, |_| 800.0);
    assert!(spindle.at_speed());
}

#[test]
fn a_slow_spindle_is_at_speed_when_it_turns_and_does_not_stall() {
    for sign in [1.0, -1.0] {
        let (mut spindle, mut count) = (spindle(), 0.0);
        let mode = if sign > 0.0 { SpindleMode::Clockwise } else { SpindleMode::Counterclockwise };
        spindle.program(mode, SpindleSpeed::Rpm(0.2));
        turn(&mut spindle, &mut count, 1000, |_| 0.0);
        assert!(!spindle.at_speed() && spindle.stalls(), "it stands");
        turn(&mut spindle, &mut count, 2000, |_| -0.2 * sign);
        assert!(!spindle.at_speed(), "the other way");
        turn(&mut spindle, &mut count, 2000, |_| 0.2 * sign);
        for _ in 0..2000 {
            turn(&mut spindle, &mut count, 1, |_| 0.2 * sign);
            assert!(spindle.at_speed() && !spindle.stalls(), "{}", spindle.observed());
        }
    }
}

#[test]
fn what_lags_behind_a_facing_cut_is_at_speed() {
    let (mut spindle, mut count) = (spindle(), 0.0);
    let (rate, lag_s) = (300.0, 0.02); // 1/min per s; the measured speed comes 20 ms late
    spindle.program(SpindleMode::Clockwise, surface());
    spindle.at_x(x_for(400.0));
    turn(&mut spindle, &mut count, 1000, |_| 400.0);
    let mut without = 0;
    for tick in 1..500 {
        let at = |t: f64| 400.0 + rate * t.max(0.0);
        let t = f64::from(tick) * spindle.tick_s;
        spindle.at_x(x_for(at(t)));
        turn(&mut spindle, &mut count, 1, |_| at(t - lag_s));
        assert!(spindle.at_speed(), "{} at {}", spindle.observed(), spindle.commanded());
        without += u32::from((spindle.observed() - spindle.commanded()).abs() > STANDSTILL_RPM);
    }
    assert!(without > 0, "it does lag");
}

#[test]
fn a_spindle_that_swings_through_zero_does_not_stand() {
    for lines in [500, 2500] {
        let mut machine = Machine::plain();
        machine.spindle.encoder_lines = lines;
        let (mut spindle, mut count, mut stood) = (Spindle::new(&machine), 0.0, 0);
        spindle.program(SpindleMode::Clockwise, SpindleSpeed::Rpm(400.0));
        turn(&mut spindle, &mut count, 1000, |_| 400.0);
        spindle.program(SpindleMode::Stop, SpindleSpeed::Rpm(0.0));
        // Its loop swings at 12 Hz for a second, and calms down.
        let swings = |tick: u32| 60.0 * libm::cos(TAU * 12.0 * f64::from(tick) * 0.002);
        for tick in 0..500 {
            turn(&mut spindle, &mut count, 1, |_| swings(tick));
            stood += u32::from(spindle.stands());
        }
        assert_eq!(stood, 0, "{lines} lines: it stands while it swings");
        turn(&mut spindle, &mut count, 500, |_| 0.0);
        assert!(spindle.stands(), "{lines} lines");
    }
}

/// Commanded 2000 1/min, at speed, then told to stop; it loses so much in a second, 1/min.
fn slows(loses: f64) -> (Option<Fault>, f64) {
    let (mut spindle, mut count) = (spindle(), 0.0);
    spindle.program(SpindleMode::Clockwise, SpindleSpeed::Rpm(2000.0));
    turn(&mut spindle, &mut count, 3000, |tick| (2.0 * f64::from(tick)).min(2000.0));
    assert_eq!(spindle.fault(), None);
    spindle.program(SpindleMode::Stop, SpindleSpeed::Rpm(0.0));
    let at = |tick: u32| (2000.0 - loses * f64::from(tick) * 0.002).clamp(0.0, 3600.0);
    for tick in 0..30_000 {
        turn(&mut spindle, &mut count, 1, |_| at(tick));
        if let Some(fault) = spindle.fault() {
            return (Some(fault), f64::from(tick) * 0.002);
        }
    }
    assert!(spindle.rests() == (at(30_000) == 0.0));
    (None, 60.0)
}

#[test]
fn a_spindle_that_only_gets_slower_obeys_as_well_as_it_can() {
    for loses in [40.0, 100.0, 500.0] {
        assert_eq!(slows(loses), (None, 60.0), "{loses} 1/min per s");
    }
    let (fault, after_s) = slows(0.0);
    assert!(matches!(fault, Some(Fault::SpindleRunaway | Fault::SpindleDoesNotStop)), "{fault:?}");
    assert!((5.0..12.0).contains(&after_s), "one that keeps its speed, after {after_s} s");
    let (fault, after_s) = slows(-500.0);
    assert!(fault == Some(Fault::SpindleRunaway) && after_s < 2.0, "one that gets faster, after {after_s} s");
}

/// The panel turns the override in a pass; a tool may be leaving it.
fn knob(spindle: &mut Spindle, pct: f64, leaves: bool) -> f64 {
    let panel = Panel { spindle_override_pct: pct, ..Panel::default() };
    spindle.update(&Measurement { panel, ..Measurement::default() }, Some(1.0), leaves);
    spindle.commanded()
}

#[test]
fn a_tool_that_leaves_keeps_the_speed() {
    let mut spindle = spindle();
    spindle.program(SpindleMode::Clockwise, SpindleSpeed::Rpm(600.0));
    (0..100).for_each(|_| assert!(knob(&mut spindle, 50.0, false) <= 600.0));
    let kept = spindle.commanded();
    assert!(kept > 400.0 && kept < 590.0, "it is on its way: {kept}");
    for (pct, guarded) in [(50.0, 1.0), (0.0, 0.5), (110.0, 1.0)] {
        assert_eq!(knob(&mut spindle, pct, true), kept);
        spindle.guard(guarded);
        assert_eq!(spindle.commanded(), kept);
    }
    assert!(knob(&mut spindle, 0.0, false) < kept, "it goes on");
}

#[test]
fn an_override_that_is_held_counts_once() {
    let mut spindle = spindle();
    spindle.program(SpindleMode::Clockwise, SpindleSpeed::Rpm(600.0));
    spindle.set_ceiling(105.0);
    (100..130).for_each(|pct| assert!(knob(&mut spindle, f64::from(pct), false) < 640.0));
    assert_eq!(spindle.clamped(), 1, "a knob that is turned on is one");
    knob(&mut spindle, 100.0, false);
    knob(&mut spindle, 110.0, false);
    assert_eq!(spindle.clamped(), 2);
}

#[test]
fn a_variation_goes_about_the_speed_asked_and_stays_where_it_is_while_a_tool_leaves() {
    let (mut spindle, variation) =
        (spindle(), Variation { shape: protocol::VariationShape::Sine, share: 0.2, revolutions: 4.0 });
    spindle.program(SpindleMode::Counterclockwise, SpindleSpeed::Rpm(300.0));
    assert_eq!(knob(&mut spindle, 100.0, false), -300.0);
    // By its own law, and by the angle that is commanded: 0 to the first peak in two turns.
    let law = SpeedLaw::new(variation, 5);
    let mut turns = 0.0;
    spindle.vary(variation, 5);
    for tick in 0..4000 {
        let before = spindle.commanded();
        turns += before.abs() / 60.0 * spindle.tick_s;
        let now = knob(&mut spindle, 100.0, false);
        assert!((now + 300.0 * law.share(turns)).abs() < 1e-6, "tick {tick}: {now}");
        spindle.vary(variation, 5);
    }
    let lowest = (0..4000).map(|_| knob(&mut spindle, 50.0, false).abs()).fold(f64::INFINITY, f64::min);
    assert!((lowest - 120.0).abs() < 0.1, "the override scales it: {lowest}");
    let kept = spindle.commanded();
    (0..100).for_each(|_| assert_eq!(knob(&mut spindle, 120.0, true), kept));
    spindle.even = (3.0, 9.0);
    spindle.turn_evenly();
    assert_eq!(spindle.even, (0.0, 0.0), "its speed has to settle");
    spindle.turn_evenly();
    assert_eq!(knob(&mut spindle, 50.0, false), spindle.commanded());
    assert!((spindle.commanded().abs() - 150.0).abs() < 1.0, "{}", spindle.commanded());
}
