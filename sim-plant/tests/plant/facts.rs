//! What the controller believes and what is true, where they are two things: screw, encoders, home, scale,
//! limits.
#![allow(clippy::unwrap_used)]

use core::f64::consts::TAU;

use crate::stand::Stand;
use machine::Machine;
use protocol::Axis;
use sim_plant::{Belief, Scenario};

fn lathe(plant: &str) -> Machine {
    let mut machine = Machine { plant: plant.parse().unwrap(), ..Machine::plain() };
    machine.axis.get_mut(&Axis::X).unwrap().scale_step_mm = Some(1e-4);
    machine
}

fn stand(plant: &str) -> Stand {
    Stand::new(&lathe(plant), Scenario::none(), 1)
}

/// X: true place of the slide, what encoder and scale show of it, mm.
fn places(stand: &Stand) -> [f64; 3] {
    let measured = &stand.plant.measurement().axes[0];
    [stand.truth().axes[0].slide_mm, measured.position.mm(), measured.scale.mm()]
}

/// Ways of slide, encoder and scale after some 20 mm.
fn ways(plant: &str) -> [f64; 3] {
    let mut stand = stand(plant);
    let before = places(&stand);
    stand.velocity = [20.0, 0.0];
    stand.run(2000);
    stand.velocity = [0.0; 2];
    stand.run(400);
    let after = places(&stand);
    core::array::from_fn(|n| after[n] - before[n])
}

#[test]
fn a_wrong_screw_or_encoder_makes_the_true_way_another_one() {
    for (plant, by_encoder, by_scale) in [
        ("", 1.0, 1.0),
        ("[axis.x]\nscrew_lead_mm = 5.01", 5.0 / 5.01, 1.0),
        ("[axis.x]\nencoder_counts = 131000", 131_000.0 / 131_072.0, 1.0),
        ("[axis.x]\nscale_step_mm = 1.002e-4", 1.0, 1.0 / 1.002),
    ] {
        let [slide, encoder, scale] = ways(plant);
        // Friction bends the drive train by a few micrometres.
        assert!(slide > 19.0 && (encoder - by_encoder * slide).abs() < 0.008, "{plant}: {encoder} {slide}");
        assert!((scale - by_scale * slide).abs() < 3e-4, "{plant}: {scale} {slide}");
    }
}

#[test]
fn a_wrong_home_is_an_offset_of_the_slide() {
    let [slide, encoder, scale] = places(&stand("[axis.x]\nhome_off_mm = 0.25"));
    assert!((slide - 60.25).abs() < 1e-9 && (encoder - 60.0).abs() < 1e-4 && (scale - 60.0).abs() < 1e-4);
}

#[test]
fn the_limit_of_the_torque_is_the_true_one() {
    let mut stand = stand("[axis.x]\ntorque_limit_nm = 4");
    stand.velocity = [150.0, 0.0];
    let most = (0..400).map(|_| stand.tick().axes[0].torque_nm).fold(0.0, f64::max);
    assert!((most - 4.0).abs() < 1e-3, "{most} N·m");
}

#[test]
fn the_spindle_has_its_own_ramp_top_speed_and_encoder() {
    let mut stand = stand("[spindle]\nramp_rpm_s = 400\nmax_rpm = 500\nencoder_lines = 2400");
    stand.spindle.rpm = 600.0;
    let half_way = stand.run(750).truth().spindle_rpm;
    assert!((half_way - 150.0).abs() < 15.0, "{half_way} rpm after 0.375 s");
    stand.run(4000);
    assert!((stand.truth().spindle_rpm - 500.0).abs() < 2.0, "{} rpm", stand.truth().spindle_rpm);
    let [first, second] = [(); 2].map(|()| {
        let before = stand.truth().measurement.index_number;
        while stand.tick().measurement.index_number == before {}
        stand.truth().measurement.index_count
    });
    assert_eq!(second - first, 9600);
}

/// Mass and friction as the controller meets them: torques that it commands, ways that it measures.
#[test]
fn the_belief_of_the_truth_is_what_the_controller_meets() {
    let keys = "screw_lead_mm = 5.5\nencoder_counts = 120000\ntorque_constant_pct = 8\n";
    let met = |friction: &str, torque_nm: f64| {
        let mut machine = lathe(&format!("[axis.x]\n{keys}{friction}"));
        let x = machine.axis.get_mut(&Axis::X).unwrap();
        // A drive that only gives the torque that is fed forward.
        x.velocity_bandwidth_hz = 1e-9;
        let mut stand = Stand::new(&machine, Scenario::none(), 1);
        stand.offset = [torque_nm, 0.0];
        let place = |stand: &mut Stand, cycles| places(stand.run(cycles))[1];
        let [early, middle, late] = [place(&mut stand, 200), place(&mut stand, 200), place(&mut stand, 200)];
        let (speed, acceleration) = ((late - middle) / 0.1, (late - 2.0 * middle + early) / 0.01);
        (speed, acceleration, Belief::of_truth(&machine, Axis::X).unwrap())
    };
    let force_n = |torque_nm: f64| torque_nm * TAU / 5e-3;
    let none = "screw_coulomb_n = 0\nslide_coulomb_n = 0\nslide_static_n = 0\n\
                screw_viscous_n_s_mm = 0\nslide_viscous_n_s_mm = 0";
    let (_, acceleration, belief) = met(none, 1.0);
    let mass_kg = force_n(1.0) / (1e-3 * acceleration);
    assert!((belief.mass_kg / mass_kg - 1.0).abs() < 2e-3, "{} kg, met {mass_kg} kg", belief.mass_kg);
    // So much viscous friction that the speed is steady at once.
    let (speed, _, belief) = met("slide_viscous_n_s_mm = 200", 1.2);
    let friction_n = belief.coulomb_n + belief.viscous_n_s_mm * speed;
    assert!((friction_n / force_n(1.2) - 1.0).abs() < 5e-3, "{friction_n} N of {} N", force_n(1.2));
}
