//! Scenarios: what a file may say, and what it does to the machine.

use crate::stand::Stand;
use machine::Machine;
use protocol::operator::Request;
use protocol::{Cycle, Panel};
use sim_plant::{Plant, Scenario};

fn refusal(text: &str) -> String {
    Scenario::from_toml(text).expect_err("the file is wrong").to_string()
}

#[test]
fn errors_name_event_key_and_remedy() {
    for (event, expected) in [
        ("at = { cycle = 1 }\nspeed = 3", "unknown field `speed`"),
        ("at = { cycle = 1, tool = 3 }\nstop = true", "unknown field `tool`"),
        (
            "at = { cycle = 1, line = 3 }\nstop = true",
            "at: these keys do not make one trigger; give one of {",
        ),
        ("at = { pass = 1 }\nstop = true", "at: these keys do not make one trigger"),
        ("at = { pass = 0, z_mm = 1 }\nstop = true", "at.pass = 0: counted from 1"),
        ("at = { time_s = -1 }\nstop = true", "at.time_s = -1: must lie between 0 and"),
        ("at = {}\nstop = true", "at: no trigger; give one of"),
        ("stop = true", "at: missing; give one of"),
        ("at = { cycle = 1 }", "no action; give one, such as"),
        (
            "at = { cycle = 1 }\nstop = true\nfeed_hold = true",
            "more than one action; give each its own [[event]]",
        ),
        ("at = { cycle = 1 }\nstop = true\nramp_s = 1", "ramp_s: only an override can be turned slowly"),
        ("at = { cycle = 1 }\nfeed_hold = false", "feed_hold: a button can only be pressed: write true"),
        (
            "at = { cycle = 1 }\nspindle_override_pct = 201",
            "spindle_override_pct = 201: must lie between 0 and 200",
        ),
        (
            "at = { cycle = 1 }\nrapid_override_pct = 101",
            "rapid_override_pct = 101: must lie between 0 and 100",
        ),
        ("at = { cycle = 1 }\nfeed_override_pct = nan", "feed_override_pct = NaN: must lie between"),
        ("at = { cycle = 1 }\nspindle_override_pct = '60'", "invalid type: string"),
        ("at = { cycle = 1 }\nspindle_load = { torque_nm = -1 }", "spindle_load.torque_nm = -1: must lie"),
        (
            "at = { cycle = 1 }\nspindle_load = { for_s = 1 }",
            "spindle_load takes either torque_nm or nm_per_rpm",
        ),
        (
            "at = { cycle = 1 }\naxial_force_n = { force_n = 1, for_s = 0 }",
            "axial_force_n.for_s = 0: must lie",
        ),
        ("at = { cycle = 1 }\nradial_force_n = 'much'", "expected a force in N, or { force_n, for_s }"),
        (
            "at = { cycle = 1 }\nkill = 'launcher'",
            "kill = \"launcher\": must be \"interpreter\", \"interpolator\", or \"regulator-x\" of an axis",
        ),
        (
            "at = { cycle = 1 }\npacket = { channel = 'x', drop = true }",
            "packet.channel = \"x\": must be one of",
        ),
    ] {
        let message = refusal(&format!("[[event]]\nat = {{ line = 1 }}\nstop = true\n[[event]]\n{event}\n"));
        assert!(message.starts_with("event 2: ") && message.contains(expected), "{event}: {message}");
    }
    assert!(refusal("[[events]]\nstop = true").contains("unknown field `events`"));
    assert!(refusal("[[event]").contains("line 1"));
}

#[test]
fn errors_of_the_encoder_name_key_and_remedy() {
    for (event, expected) in [
        (
            "at = { cycle = 1 }\nencoder_glitch_counts = 0",
            "encoder_glitch_counts = 0: must lie between -1000000000 and 1000000000, and not be 0",
        ),
        (
            "at = { cycle = 1 }\nencoder_glitch_counts = 1.5",
            "expected a number of counts, or { counts, for_s }",
        ),
        (
            "at = { cycle = 1 }\nencoder_glitch_counts = { counts = 3 }",
            "expected a number of counts, or { counts, for_s }",
        ),
        (
            "at = { cycle = 1 }\nencoder_glitch_counts = { counts = 3, for_s = -1 }",
            "encoder_glitch_counts.for_s = -1: must lie",
        ),
        ("at = { cycle = 1 }\nindex_lost = false", "index_lost: write true or { for_s }"),
        ("at = { cycle = 1 }\nindex_lost = { for_s = 0 }", "index_lost.for_s = 0: must lie"),
        ("at = { cycle = 1 }\nindex_lost = true\nencoder_glitch_counts = 1", "more than one action"),
    ] {
        let message = refusal(&format!("[[event]]\n{event}\n"));
        assert!(message.starts_with("event 1: ") && message.contains(expected), "{event}: {message}");
    }
}

#[test]
fn errors_of_faults_name_key_and_remedy() {
    for (event, expected) in [
        (
            "emergency_stop = false",
            "emergency_stop: a button can only be pressed: write true; it stays pressed",
        ),
        ("power_lost = false", "power_lost: write true; the mains do not come back"),
        ("drive_fault = 'q'", "expected an axis, or { axis, torque_lost = true }"),
        (
            "spindle_fault = 'fire'",
            "spindle_fault = \"fire\": must be \"runaway\", \"reversal\", \"stall\" or \"jam\"",
        ),
        ("spindle_fault = { fault = 'jam', for_s = 0 }", "spindle_fault.for_s = 0: must lie"),
        ("encoder_stands = false", "encoder_stands: write true or { for_s }; without an event it counts"),
        ("encoder_noise_counts = -1", "encoder_noise_counts = -1: must lie between 0 and 1000"),
        ("encoder_noise_counts = 1.5", "expected i64"),
        ("encoder_eccentricity_counts = nan", "encoder_eccentricity_counts = NaN: must lie"),
        ("axis_jump = { axis = 'x', mm = 0 }", "axis_jump.mm = 0: must not be 0"),
        ("axis_jump = { axis = 'x', mm = 1e4 }", "axis_jump.mm = 10000: must lie between -1000 and 1000"),
        ("axis_jump = { mm = 1 }", "missing field `axis`"),
        ("force_spike = { axis = 'z', force_n = 1e6, for_s = 1 }", "force_spike.force_n = 1000000: must lie"),
        ("force_spike = { axis = 'z', force_n = 1 }", "missing field `for_s`"),
        ("freeze = 'sim-plant'", "freeze = \"sim-plant\": must be \"interpreter\""),
        ("freeze = { process = 'interpolator' }", "expected the name of a process, or { process, for_s }"),
        (
            "packet = { channel = 'credit', drop = true }",
            "packet.channel = \"credit\": must be one of machine-code",
        ),
        ("packet = { channel = 'machine-code' }", "packet takes one of drop = true"),
        (
            "packet = { channel = 'machine-code', drop = true, corrupt = 3 }",
            "packet takes one of drop = true",
        ),
        (
            "packet = { channel = 'measurement', delay_cycles = 0 }",
            "packet.delay_cycles = 0: must lie between 1",
        ),
        (
            "packet = { channel = 'measurement', drop = true, count = 0 }",
            "packet.count = 0: must lie between 1",
        ),
        ("kill = 'regulator-x'\nstop = true", "more than one action"),
    ] {
        let refused = Scenario::from_toml(&format!("[[event]]\nat = {{ cycle = 1 }}\n{event}\n"));
        let message = refused.expect_err(event).to_string();
        assert!(message.starts_with("event 1: ") && message.contains(expected), "{event}: {message}");
    }
}

#[test]
fn an_event_for_an_axis_that_there_is_not_is_refused() {
    for event in [
        "drive_fault = 'y'",
        "axis_jump = { axis = 'y', mm = 1 }",
        "kill = 'regulator-y'",
        "packet = { channel = 'axis-status/y', drop = true }",
    ] {
        let text =
            format!("[[event]]\nat = {{ cycle = 1 }}\nstop = true\n[[event]]\nat = {{ cycle = 1 }}\n{event}");
        let scenario = Scenario::from_toml(&text).unwrap();
        let refused = Plant::new(&Machine::plain(), scenario, 1).expect_err(event).to_string();
        assert_eq!(refused, "event 2 of the scenario acts on axis y: the machine has no [axis.y]");
    }
}

#[test]
fn a_file_without_events_is_empty() {
    assert!(Scenario::from_toml("# nothing\n").unwrap().is_empty() && Scenario::none().is_empty());
}

#[test]
fn an_action_is_there_in_the_cycle_of_its_trigger() {
    for at in ["cycle = 40", "time_s = 0.02"] {
        let mut stand = Stand::playing(&format!("[[event]]\nat = {{ {at} }}\nspindle_override_pct = 60"));
        for cycle in 0..80 {
            let m = stand.plant.measurement();
            assert_eq!(m.cycle, Cycle(cycle));
            assert_eq!(m.panel.spindle_override_pct, if cycle < 40 { 100.0 } else { 60.0 }, "cycle {cycle}");
            stand.tick();
        }
    }
    let stand = Stand::playing("[[event]]\nat = { cycle = 0 }\nfeed_override_pct = 150");
    assert_eq!(stand.plant.measurement().panel.feed_override_pct, 150.0);
}

#[test]
fn a_knob_is_turned_evenly() {
    let mut stand =
        Stand::playing("[[event]]\nat = { cycle = 100 }\nspindle_override_pct = 60\nramp_s = 0.3");
    let pct = |stand: &mut Stand| stand.plant.measurement().panel.spindle_override_pct;
    assert_eq!(pct(stand.run(99)), 100.0);
    assert!((pct(stand.run(300)) - 80.0).abs() < 0.1);
    assert_eq!(pct(stand.run(300)), 60.0);
    assert_eq!(stand.plant.pending_events().count(), 0);
}

#[test]
fn buttons_press_and_release() {
    let mut stand = Stand::playing(
        "[[event]]\nat = { cycle = 10 }\nfeed_hold = true\n[[event]]\nat = { cycle = 20 }\ncycle_start = true\n\
         [[event]]\nat = { cycle = 30 }\nstop = true\n[[event]]\nat = { cycle = 40 }\nsingle_block = true\n\
         [[event]]\nat = { cycle = 50 }\nabort = true\n[[event]]\nat = { cycle = 60 }\nsingle_block = false",
    );
    let buttons = |stand: &mut Stand| stand.run(10).plant.measurement().panel.buttons;
    assert_eq!(buttons(&mut stand), Panel::FEED_HOLD);
    assert_eq!(buttons(&mut stand), 0);
    assert_eq!(buttons(&mut stand), Panel::STOP);
    assert_eq!(buttons(&mut stand), Panel::STOP | Panel::SINGLE_BLOCK);
    assert_eq!(buttons(&mut stand), Panel::STOP | Panel::SINGLE_BLOCK | Panel::ABORT);
    assert_eq!(buttons(&mut stand), Panel::STOP | Panel::ABORT);
    let mut plant = Plant::new(&Default::default(), Scenario::none(), 1).unwrap();
    plant.tick(&Default::default(), &Default::default(), Some(Request::Stop));
    assert!(plant.measurement().panel.pressed(Panel::STOP));
    plant.tick(&Default::default(), &Default::default(), Some(Request::SpindleOverride(70.0)));
    assert_eq!(plant.measurement().panel.spindle_override_pct, 70.0);
}

#[test]
fn triggers_of_a_pass_wait_for_that_pass() {
    let mut stand = Stand::playing(
        "[[event]]\nat = { pass = 2, angle_deg = 720 }\nspindle_override_pct = 60\n\
         [[event]]\nat = { pass = 2, z_mm = 99.5 }\nfeed_override_pct = 70\n\
         [[event]]\nat = { after_pass = 2 }\nrapid_override_pct = 80\n\
         [[event]]\nat = { line = 12 }\nfeed_hold = true\n\
         [[event]]\nat = { line = 99 }\ncycle_start = true",
    );
    stand.spindle.rpm = -600.0;
    (stand.spindle.pass, stand.spindle.direction, stand.velocity) = (1, -1.0, [0.0, -20.0]);
    stand.run(3000);
    let panel = stand.plant.measurement().panel;
    assert_eq!(
        (panel.spindle_override_pct, panel.feed_override_pct, panel.rapid_override_pct),
        (100.0, 100.0, 100.0)
    );
    // Back to before Z 99.5, then pass 2, with an index that does not count yet.
    (stand.spindle.pass, stand.velocity) = (0, [0.0, 20.0]);
    while stand.tick().axes[2].slide_mm < 100.0 {}
    let not_before = Cycle(stand.truth().cycle.0 + 500);
    (stand.spindle.pass, stand.spindle.index_not_before, stand.velocity) = (2, not_before, [0.0, -2.0]);
    while stand.tick().measurement.panel.feed_override_pct == 100.0 {}
    assert!((stand.truth().axes[2].slide_mm - 99.5).abs() < 0.002, "{}", stand.truth().axes[2].slide_mm);
    while stand.truth().measurement.index_cycle < not_before {
        stand.tick();
    }
    let index_deg = (stand.truth().spindle_deg / 360.0).ceil() * 360.0;
    while stand.tick().measurement.panel.spindle_override_pct == 100.0 {}
    let turned = index_deg - stand.truth().spindle_deg;
    assert!((720.0..722.0).contains(&turned), "{turned}°");
    assert_eq!(stand.plant.pending_events().collect::<Vec<_>>(), [3, 4, 5]);
    stand.spindle.pass = 3;
    assert_eq!(stand.tick().measurement.panel.rapid_override_pct, 80.0);
    stand.spindle.line = 12;
    assert!(stand.tick().measurement.panel.pressed(Panel::FEED_HOLD));
}

#[test]
fn a_force_bends_the_slide_and_goes_again() {
    let mut stand = Stand::playing(
        "[[event]]\nat = { cycle = 200 }\nradial_force_n = { force_n = 100, for_s = 0.2 }\n\
         [[event]]\nat = { cycle = 200 }\naxial_force_n = -100",
    );
    let bent_um = |stand: &Stand, axis: usize| {
        let axis = stand.truth().axes[axis];
        1e3 * (axis.slide_mm - axis.motor_mm)
    };
    stand.run(200);
    assert!(bent_um(&stand, 0).abs() < 0.05);
    stand.run(300);
    // 43 N/µm beside 15 N/µm of bristles, which creep before they slide.
    assert!((1.0..2.3).contains(&bent_um(&stand, 0)), "{} µm", bent_um(&stand, 0));
    assert!((-2.3..-1.0).contains(&bent_um(&stand, 2)), "{} µm", bent_um(&stand, 2));
    stand.run(400);
    assert!(bent_um(&stand, 0).abs() < 0.7, "{} µm", bent_um(&stand, 0));
    assert!(bent_um(&stand, 2) < -1.0);
}

/// What the encoder shows beyond the true angle in each of so many cycles, counts, less that of cycle 0.
fn strays(scenario: &str, cycles: u32) -> Vec<i64> {
    let (mut quiet, mut stand) = (Stand::lathe(), Stand::playing(scenario));
    (quiet.spindle.rpm, stand.spindle.rpm) = (-300.0, -300.0);
    (0..cycles)
        .map(|_| {
            let (quiet, disturbed) = (*quiet.tick(), *stand.tick());
            assert_eq!(quiet.spindle_deg, disturbed.spindle_deg, "the truth is as before");
            disturbed.measurement.spindle_count - quiet.measurement.spindle_count
        })
        .collect()
}

#[test]
fn a_glitch_of_the_encoder_stays_or_comes_back() {
    let event =
        |counts: &str| format!("[[event]]\nat = {{ cycle = 10 }}\nencoder_glitch_counts = {counts}\n");
    let stays = strays(&event("-7"), 20);
    assert!(stays[..10].iter().all(|stray| *stray == 0) && stays[10..].iter().all(|stray| *stray == -7));
    let passes = strays(&event("{ counts = 40, for_s = 0.002 }"), 20);
    assert_eq!(passes[10..14], [40; 4]);
    assert!(passes[..10].iter().chain(&passes[14..]).all(|stray| *stray == 0), "{passes:?}");
    let both = strays(&(event("{ counts = 40, for_s = 0.002 }") + &event("2")), 20);
    assert_eq!((both[11], both[19]), (42, 2));
}

#[test]
fn the_count_at_an_index_is_that_of_the_counter() {
    let mut stand = Stand::playing("[[event]]\nat = { time_s = 1 }\nencoder_glitch_counts = 3");
    stand.spindle.rpm = 600.0;
    let mut latched = Vec::new();
    for _ in 0..8000 {
        let before = stand.truth().measurement.index_number;
        let shown = stand.tick().measurement;
        if shown.index_number != before {
            latched.push(shown.index_count);
        }
    }
    let turns: Vec<i64> = latched.windows(2).map(|pair| pair[1] - pair[0]).collect();
    assert_eq!(turns.iter().filter(|turn| **turn != 10_000).collect::<Vec<_>>(), [&10_003]);
}

#[test]
fn an_index_is_lost_once_or_for_a_time() {
    let seen = |lost: &str| {
        let mut stand = Stand::playing(&format!("[[event]]\nat = {{ time_s = 2 }}\nindex_lost = {lost}"));
        stand.spindle.rpm = 600.0;
        let turns: Vec<f64> = (0..8000).map(|_| (stand.tick().spindle_deg / 360.0).floor()).collect();
        let passed = turns.windows(2).filter(|pair| pair[0] != pair[1]).count() as u64;
        (passed, stand.truth().measurement.index_number)
    };
    let (passed, shown) = seen("true");
    assert_eq!(shown, passed - 1);
    let (passed, shown) = seen("{ for_s = 0.5 }");
    assert_eq!(shown, passed - 5);
}

#[test]
fn a_cycle_allocates_nothing() {
    let encoder = "[[event]]\nat = { cycle = 5 }\nencoder_glitch_counts = { counts = 9, for_s = 0.1 }\n\
                   [[event]]\nat = { cycle = 6 }\nindex_lost = { for_s = 0.1 }\n";
    let bogged = include_str!("../../../examples/scenarios/bogged-spindle.toml");
    let mut stand = Stand::playing(&format!("{bogged}{encoder}"));
    (stand.spindle.rpm, stand.spindle.pass, stand.spindle.direction) = (600.0, 2, 1.0);
    stand.velocity = [10.0, -10.0];
    let allocated = allocation_counter::measure(|| {
        stand.run(10_000);
    });
    assert_eq!(allocated.count_total, 0);
    assert_eq!(stand.plant.pending_events().collect::<Vec<_>>(), [2]);
}

#[test]
fn a_hold_that_nobody_releases_is_refused() {
    let hold = "[[event]]\nat = { time_s = 1 }\nfeed_hold = true\n";
    let refused = Scenario::from_toml(hold).unwrap_err().to_string();
    assert!(refused.starts_with("event 1: feed_hold") && refused.contains("cycle_start"), "{refused}");
    for release in ["cycle_start", "stop", "abort"] {
        let event = format!("{hold}[[event]]\nat = {{ time_s = 2 }}\n{release} = true\n");
        assert!(Scenario::from_toml(&event).is_ok(), "{release}");
    }
}

#[test]
fn an_override_that_stays_at_zero_is_refused() {
    for key in ["spindle_override_pct", "feed_override_pct", "rapid_override_pct"] {
        let event = |at: &str, action: &str| format!("[[event]]\nat = {{ {at} }}\n{action}\n");
        let zero = event("time_s = 1", &format!("{key} = 0\nramp_s = 0.5"));
        let raise = |at: &str| event(at, &format!("{key} = 60"));
        for stands in [zero.clone(), raise("time_s = 0.5") + &zero, raise("time_s = 1") + &zero] {
            let number = stands.matches("[[event]]").count();
            let refused = Scenario::from_toml(&stands).unwrap_err().to_string();
            let named = refused.starts_with(&format!("event {number}: {key} = 0"));
            assert!(named && refused.contains("stop"), "{refused}");
        }
        for goes_on in [
            zero.clone() + &raise("time_s = 1"),
            raise("time_s = 2") + &zero,
            raise("line = 3") + &zero,
            zero.clone() + &event("time_s = 2", "stop = true"),
            zero.clone() + &event("time_s = 2", "abort = true"),
        ] {
            assert!(Scenario::from_toml(&goes_on).is_ok(), "{goes_on}");
        }
    }
    let other = "[[event]]\nat = { time_s = 1 }\nfeed_override_pct = 0\n\
                 [[event]]\nat = { time_s = 2 }\nrapid_override_pct = 50\n";
    let refused = Scenario::from_toml(other).unwrap_err().to_string();
    assert!(refused.starts_with("event 1: feed_override_pct"), "{refused}");
}
