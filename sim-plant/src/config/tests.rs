//! What is read of `[plant.*]`, and what is refused.

use super::*;

fn with(plant: &str) -> Result<PlantConfig, PlantError> {
    PlantConfig::of(&Machine { plant: plant.parse().unwrap(), ..Machine::plain() })
}

/// Texts, and what is said of them.
fn refuses(cases: &[(&str, &str)]) {
    for (text, expected) in cases {
        let message = with(text).unwrap_err().to_string();
        assert!(message.contains(expected), "{text}: {message}");
    }
}

#[test]
fn the_small_lathe_has_the_default_plant() {
    let config = PlantConfig::of(&Machine::plain()).unwrap();
    assert_eq!(config.spindle, SpindleTrain::default());
    assert_eq!(config.cutting, Cutting::default());
    assert!(config.axis.values().all(|train| *train == AxisTrain::default()));
    assert_eq!(with("").unwrap(), PlantConfig::default());
}

#[test]
fn a_refusal_of_an_axis_names_the_key_and_what_is_allowed() {
    refuses(&[
        ("[axis.x]\nmode_hz = 0.5", "plant.axis.x.mode_hz = 0.5: must lie between 5 and 1000"),
        ("[axis.z]\nslide_static_n = 100", "plant.axis.z.slide_static_n = 100: must lie between 120"),
        ("[axis.z]\nscrew_static_n = 149", "plant.axis.z.screw_static_n = 149: must lie between 150"),
        ("[axis.z]\nscrew_stribeck_mm_s = 0", "plant.axis.z.screw_stribeck_mm_s = 0: must lie between 0.01"),
        (
            "[axis.x]\nscrew_bristle_n_s_mm = -1",
            "plant.axis.x.screw_bristle_n_s_mm = -1: must lie between 0 and",
        ),
        (
            "[axis.x]\nslide_bristle_n_s_mm = 1e4",
            "plant.axis.x.slide_bristle_n_s_mm = 10000: must lie between 0",
        ),
        ("[axis.x]\nbrake_n = 0", "plant.axis.x.brake_n = 0: must lie between 1 and"),
        ("[axis.y]\nmode_hz = 80", "[plant.axis.y]: the machine has no [axis.y]"),
        ("[axis.x]\nmode = 80", "unknown field `mode`"),
    ]);
}

#[test]
fn a_refusal_of_a_motor_names_the_key_and_what_is_allowed() {
    refuses(&[
        ("[axis.x]\ntorque_constant_pct = 60", "plant.axis.x.torque_constant_pct = 60: must lie between -50"),
        ("[axis.x]\ntorque_noise_nm = -1", "plant.axis.x.torque_noise_nm = -1: must lie between 0"),
        ("[axis.x]\ntorque_step_nm = inf", "plant.axis.x.torque_step_nm = inf: must lie between 0"),
        ("[axis.x]\ncogging_nm = -1", "plant.axis.x.cogging_nm = -1: must lie between 0"),
        ("[axis.x]\ncogging_per_rev = 0", "plant.axis.x.cogging_per_rev = 0: must lie between 1 and 1000"),
        ("[axis.x]\ncogging_deg = 361", "plant.axis.x.cogging_deg = 361: must lie between -360 and 360"),
        ("[axis.x]\ngravity_n = -9001", "plant.axis.x.gravity_n = -9001: must lie between -9000 and 9000"),
        ("[axis.x]\nno_torque_mm_s = 0", "plant.axis.x.no_torque_mm_s = 0: must lie between 1"),
        (
            "[axis.x]\nno_torque_mm_s = 200\nfull_torque_mm_s = 300",
            "full_torque_mm_s = 300: must lie between 0 and 198",
        ),
        ("[axis.x]\nfull_torque_mm_s = 300", "full_torque_mm_s = 300: says nothing without no_torque_mm_s"),
    ]);
}

#[test]
fn a_refusal_of_what_is_believed_too_names_the_key_and_what_is_allowed() {
    refuses(&[
        ("[axis.x]\nscrew_lead_mm = 0", "plant.axis.x.screw_lead_mm = 0: must lie between 0.000001 and 1000"),
        ("[axis.x]\nencoder_counts = 8", "plant.axis.x.encoder_counts = 8: must lie between 16 and"),
        ("[axis.x]\nhome_off_mm = 1e6", "plant.axis.x.home_off_mm = 1000000: must lie between -100 and"),
        (
            "[axis.x]\nscale_step_mm = 0.001",
            "plant.axis.x.scale_step_mm = 0.001: the axis has no scale: [axis.x]",
        ),
        ("[axis.x]\ntorque_limit_nm = 0", "plant.axis.x.torque_limit_nm = 0: must lie between 0.000001"),
        ("[spindle]\nencoder_lines = 0", "plant.spindle.encoder_lines = 0: must lie between 1 and 250000"),
        ("[spindle]\nramp_rpm_s = 0", "plant.spindle.ramp_rpm_s = 0: must lie between 1 and 1000000"),
        ("[spindle]\nmax_rpm = 0", "plant.spindle.max_rpm = 0: must lie between 1 and 100000"),
    ]);
}

#[test]
fn a_refusal_of_the_spindle_names_the_key_and_what_is_allowed() {
    refuses(&[
        ("[spindle]\nripple_pct = -1", "plant.spindle.ripple_pct = -1: must lie between 0 and 10"),
        ("[spindle]\nripple_per_rev = 1.5", "plant.spindle.ripple_per_rev = 1.5: must be a whole number"),
        ("[spindle]\nripple_pct = \"much\"", "must be a number or a list of numbers"),
        ("[spindle]\nripple_pct = [0.2, 0.1]", "ripple_per_rev = 1: harmonics were found; ripple_pct and"),
        (
            "[spindle]\nripple_pct = [0.2, 11]\nripple_per_rev = [1, 2]",
            "ripple_pct[1] = 11: must lie between 0 and 10",
        ),
        (
            "[spindle]\nencoder_error_arcsec = [[1, 20], [2.5, 5]]",
            "encoder_error_arcsec[1][0] = 2.5: must be a whole",
        ),
        (
            "[spindle]\nencoder_error_arcsec = [[2500, 60]]",
            "is the steepness of all rows together; it must be at most",
        ),
        (
            "[spindle]\nindex_jitter_s = 0.001",
            "plant.spindle.index_jitter_s = 0.001: must lie between 0 and 0.0001",
        ),
        (
            "[spindle]\nencoder_delay_s = -0.001",
            "plant.spindle.encoder_delay_s = -0.001: must lie between -0.0002",
        ),
    ]);
}

#[test]
fn a_refusal_of_the_cut_and_the_mains_names_the_key_and_what_is_allowed() {
    refuses(&[
        ("[cutting]\nrise_s = nan", "plant.cutting.rise_s = NaN: must lie between"),
        (
            "[cutting]\nspecific_force_n_mm2 = -1",
            "plant.cutting.specific_force_n_mm2 = -1: must lie between 0 and",
        ),
        (
            "[cutting]\nface_mm = -5\nback_mm = 0",
            "plant.cutting.back_mm = 0: must lie between -100000 and -5",
        ),
        ("[power]\nlink_hold_s = 11", "plant.power.link_hold_s = 11: must lie between 0 and 10"),
        ("[bus]\nlost_commands = 2", "plant.bus.lost_commands = 2: must lie between 3 and 1000"),
    ]);
}
