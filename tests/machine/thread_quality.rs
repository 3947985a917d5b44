//! How good threads have to be, measured against the truth of the plant: at constant speed, with overrides
//! and loads, and against the same thread cut at another speed. On the plain lathe, where what the control
//! does is most of what is seen; `ten_seeds` judges the tool of the built-in one.

use std::fs;

use crate::shop::{EXAMPLES, Place, example};
use rig::observe::{Outcome, PassReport, Summary};

/// Whatever happens to the spindle: everything was cut, within the limits, from one index.
fn is_sound(summary: &Summary, what: &str) {
    assert_eq!(summary.outcome, Outcome::Completed, "{what}: {:?}", summary.faults);
    assert_eq!(summary.moves.limit_violations, 0, "{what}");
    assert!(!summary.passes.is_empty(), "{what}");
    for pass in &summary.passes {
        assert!(pass.complete && pass.same_index, "{what}: {pass:#?}");
        assert!(pass.limits_asked_pct.most() <= 100.0, "{what}: {pass:#?}");
    }
}

fn holds_at_constant_speed(name: &str) {
    let summary = Place::new().run_plain(&example(name), None);
    is_sound(&summary, name);
    assert!(summary.thread.phase_spread_um <= 1.0, "{name}: {}", summary.thread.phase_spread_um);
    for pass in &summary.passes {
        assert!(pass.helix_max_abs_um <= 1.5, "{name}: {pass:#?}");
        assert!(pass.lead_error_um_per_rev.abs() <= 0.05, "{name}: {pass:#?}");
        assert!(pass.x.approach_min_um >= -2.5 && pass.x.approach_max_um <= 2.5, "{name}: {pass:#?}");
        assert!(pass.x.end_um.abs() <= 0.6, "{name}: {pass:#?}");
        assert!(pass.x.thread_max_abs_um <= 0.5, "{name}: {pass:#?}");
    }
}

#[test]
fn m20x2_at_constant_speed() {
    holds_at_constant_speed("m20x2");
}

#[test]
fn worm_left_at_constant_speed() {
    holds_at_constant_speed("worm-left");
}

#[test]
fn internal_m30_at_constant_speed() {
    holds_at_constant_speed("internal-m30");
}

/// What was sent to the regulators of a pass: the same in every scenario, since it is machine code.
fn law(pass: &PassReport) -> [f64; 6] {
    let PassReport { c0_deg, delta_c_deg, delta_z_mm, delta_x_mm, thread_end_deg, programmed_rpm, .. } =
        *pass;
    [c0_deg, delta_c_deg, delta_z_mm, delta_x_mm, thread_end_deg, programmed_rpm]
}

/// Runs every example with a scenario; `happened` says whether the scenario came to pass.
fn holds_with(scenario: &str, happened: impl Fn(&Summary) -> bool) {
    let place = Place::new();
    for name in EXAMPLES {
        let what = format!("{name} {scenario}");
        let quiet = place.run_plain(&example(name), None);
        let summary = place.run_plain(&example(name), Some(scenario));
        is_sound(&summary, &what);
        assert!(happened(&summary), "{what}: {:#?}", summary.passes);
        assert!(summary.thread.phase_spread_um <= 1.5, "{what}: {}", summary.thread.phase_spread_um);
        for pass in &summary.passes {
            assert!(pass.helix_max_abs_um <= 3.0, "{what}: {pass:#?}");
        }
        let laws = |summary: &Summary| summary.passes.iter().map(law).collect::<Vec<_>>();
        assert_eq!(laws(&summary), laws(&quiet), "{what}: machine code does not depend on what happens");
    }
}

#[test]
fn override_from_pass_to_pass_leaves_the_thread_in_its_place() {
    holds_with("override-100-80-60", |summary| {
        let expected = [100.0, 80.0, 60.0];
        summary.passes.iter().zip(expected.iter().cycle()).take(7).all(|(pass, pct)| {
            let share = 0.01 * pct * pass.programmed_rpm;
            (pass.override_min_pct, pass.override_max_pct) == (*pct, *pct)
                && pass.rpm_min > 0.97 * share
                && pass.rpm_max < 1.03 * share
        })
    });
}

/// Eased, it has hardly come to 60 % before it is turned back.
#[test]
fn override_within_a_pass_leaves_the_thread_in_its_place() {
    holds_with("override-in-pass", |summary| {
        summary.passes.iter().all(|pass| {
            let turned = matches!(pass.pass, 2 | 3);
            (pass.override_min_pct < 70.0) == turned
                && pass.override_max_pct == 100.0
                && (pass.rpm_min < 0.72 * pass.programmed_rpm) == turned
        })
    });
}

#[test]
fn a_bogged_spindle_leaves_the_thread_in_its_place() {
    holds_with("bogged-spindle", |summary| {
        summary.passes.iter().all(|pass| {
            let dip = 1.0 - pass.rpm_min / pass.programmed_rpm;
            if matches!(pass.pass, 2 | 4) { (0.15..0.25).contains(&dip) } else { dip < 0.03 }
        })
    });
}

/// Phase rule: the run-in at another speed is another one, and ends on the same helix.
#[test]
fn halving_s_moves_no_pass() {
    let place = Place::new();
    let text = fs::read_to_string(example("m20x2")).expect("the example is shipped");
    assert!(text.contains("M3 S600"), "the speed of the thread");
    let halved = place.write("halved.ngc", text.replace("M3 S600", "M3 S300"));
    let fast = place.run_plain(&example("m20x2"), None);
    let slow = place.run_plain(&halved, None);
    is_sound(&slow, "half the speed");
    assert_eq!(fast.passes.len(), slow.passes.len());
    for (fast, slow) in fast.passes.iter().zip(&slow.passes) {
        assert_eq!((fast.programmed_rpm, slow.programmed_rpm), (600.0, 300.0));
        assert_ne!(fast.delta_c_deg, slow.delta_c_deg, "a slower spindle needs a shorter run-in");
        // The same groove comes again after every lead.
        let leads = (fast.helix_at_index_mm - slow.helix_at_index_mm) / fast.lead_mm;
        let moved = 1e3 * (leads - leads.round()) * fast.lead_mm + fast.phase_um - slow.phase_um;
        assert!((fast.phase_um - slow.phase_um).abs() <= 1.0, "{fast:#?} {slow:#?}");
        assert!(moved.abs() <= 1.0, "{moved} µm: {fast:#?} {slow:#?}");
    }
}

/// Lead × speed beyond what an axis can do is refused before anything moves, and the message helps.
#[test]
fn a_thread_the_axes_cannot_follow_is_refused() {
    let place = Place::new();
    let program = |rpm: u32| format!("G18 G21 G90 G7\nM3 S{rpm}\nG0 X30 Z20\nG33 Z-20 K6\nG0 X40\nM5\nM2\n");
    let path = place.write("fast.ngc", program(2500));
    let fast = place.ask(&["run", "fast.ngc", "--in-process", "--trace", "none"]);
    assert_eq!(fast.status, Some(2), "{}", fast.stderr);
    assert!(!place.at("runs").exists(), "nothing was run");
    assert!(fast.stderr.contains("fast.ngc:4:"), "{}", fast.stderr);
    let named: Vec<u32> = fast
        .stderr
        .split(|character: char| !character.is_ascii_alphanumeric())
        .filter_map(|word| word.strip_prefix('S').unwrap_or(word).parse().ok())
        .filter(|rpm| (200..2500).contains(rpm))
        .collect();
    let highest = *named.iter().max().unwrap_or_else(|| panic!("no speed is named: {}", fast.stderr));
    fs::write(&path, program(highest)).expect("the place can be written");
    let summary = place.run_plain(&path, None);
    assert_eq!(summary.outcome, Outcome::Completed, "S{highest}: {:?}", summary.faults);
    assert!(summary.passes.len() == 1 && summary.passes[0].complete, "S{highest}: {:#?}", summary.passes);
}
