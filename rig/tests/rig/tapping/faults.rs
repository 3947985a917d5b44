//! Counts that are lost about the turn of a tap, and a spindle that loses its torque in one.

use super::*;

/// Two and three counts, lost or gained while the spindle turns round: no cycle shows them, the index that is
/// met again does. They are corrected, and told. Where that is more than the thread may have, the tap comes
/// back all the same and is a fault of that name.
#[test]
fn a_tap_that_loses_counts_at_its_turn_comes_back() {
    let machine = lathe();
    let mut strict = lathe();
    strict.threading.lost_counts_um = 0.1;
    let items = compiled(&machine, &M8.program());
    let (_, _, moments) = run(&machine, M8, &items, "", 3);
    let mut worst = [0.0_f64; 2];
    for counts in [-3, -2, 2, 3] {
        for near in [-120, -3, 0, 2, 60_i64] {
            let at = moments.turns.saturating_add_signed(near);
            let scenario = format!("[[event]]\nat = {{ cycle = {at} }}\nencoder_glitch_counts = {counts}\n");
            let (observation, seen, _) = run(&machine, M8, &items, &scenario, 3);
            let told = observation.warnings.iter().any(|warning| warning.code == "encoder-counts-corrected");
            let at = format!("{counts} counts at {near}: {seen:?} {:?}", observation.faults);
            assert!(observation.outcome == Outcome::Completed && told && !seen.inside, "{at}");
            worst[0] = worst[0].max(seen.most_um());
            if near == 0 {
                let (observation, seen, _) = run(&strict, M8, &items, &scenario, 3);
                assert_eq!(seen.fault, Fault::EncoderPulsesLost as u32, "{at} {:?}", observation.faults);
                assert!(!seen.inside, "it is out: {at} {seen:?}");
                worst[1] = worst[1].max(seen.most_um());
            }
        }
    }
    println!("off the helix: {worst:.2?} µm, corrected and as a fault");
    assert!(worst.iter().all(|um| *um <= 5.0), "{worst:?}");
}

/// A drive without torque is named by what it does not do, long before the spindle stands: on the way in when
/// it has lost half its speed, while it is braked within three turns, on the way out within six. One that
/// stands already cannot be told from a dead encoder.
#[test]
fn a_spindle_without_torque_in_a_tap_is_named_before_it_stands() {
    let machine = lathe();
    let items = compiled(&machine, &M8.program());
    let [index, inside, brakes, turns, _] = borders(&machine, M8, &items, 3);
    let half = |rpm: f64| rpm > 0.4 * M8.s_rpm;
    let told = |at: u64| {
        let scenario = format!("[[event]]\nat = {{ cycle = {at} }}\nspindle_fault = \"stall\"\n");
        let stand = crate::stand::Stand { machine: &machine, items: &items, scenario: &scenario, seed: 3 };
        let (mut from_deg, mut told) = (0.0, None);
        stand.run(|record| {
            let truth = record.truth;
            if truth.cycle.0 == at {
                from_deg = truth.spindle_deg;
            }
            if truth.cycle.0 > at && told.is_none() && record.machine.fault != 0 {
                let turned = (truth.spindle_deg - from_deg).abs() / 360.0;
                told = Some((record.machine.fault, turned, truth.spindle_rpm));
            }
            None
        });
        let told = told.expect("it is told");
        println!("{at}: {told:?}");
        told
    };
    let slow = Fault::SpindleNotAtSpeed as u32;
    for at in [index, index + 3, inside - 2, inside] {
        let (fault, _, rpm) = told(at);
        assert!(fault == slow && half(rpm), "on the way in, {at}: {rpm} 1/min");
    }
    for (at, most_turns) in [(brakes, 3.0), (brakes + 9, 3.0), (brakes + 120, 2.5), (turns - 40, 1.0)] {
        let (fault, turned, _) = told(at);
        assert!(fault == slow && turned < most_turns, "braked, {at}: {fault} after {turned} turns");
    }
    for (at, most_turns) in [(turns + 40, 0.5), (turns + 400, 6.0), (turns + 1600, 6.0)] {
        let (fault, turned, _) = told(at);
        assert!(fault == slow && turned < most_turns, "on the way out, {at}: {fault} after {turned} turns");
    }
    for at in [turns - 2, turns + 2] {
        let (fault, turned, _) = told(at);
        assert!(fault == Fault::EncoderStands as u32 && turned < 0.05, "{at}: {fault} after {turned} turns");
    }
}
