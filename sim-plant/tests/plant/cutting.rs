//! The cut in the whole plant: forces on the slides, power of the spindle, stability.

use core::f64::consts::TAU;

use crate::stand::Stand;
use machine::Machine;
use protocol::{Axis, Groove, SpindleCommand, Truth};
use sim_plant::Scenario;

/// A part that reaches to Z 200, cut where the tool stands: X 60, Z 100. No ripple.
fn machine(specific_force: f64) -> Machine {
    let plant = format!(
        "[cutting]\nspecific_force_n_mm2 = {specific_force:?}\nface_mm = 200.0\n[spindle]\nripple_pct = 0.0\n"
    );
    Machine { plant: plant.parse().expect("the table of the test"), ..Machine::plain() }
}

/// A pass along -Z from outside, that is so deep with the tool at X 60.
fn pass(depth_mm: f64) -> SpindleCommand {
    let groove = Groove { lead_mm: -2.0, crest_mm: 60.0 + depth_mm, into: -1.0, ..Groove::default() };
    SpindleCommand { rpm: 600.0, pass: 1, groove, ..SpindleCommand::default() }
}

fn turning(specific_force: f64, scenario: &str) -> Stand {
    let scenario = Scenario::from_toml(scenario).expect("the scenarios of the tests are sound");
    let mut stand = Stand::new(&machine(specific_force), scenario, 1);
    stand.spindle.rpm = 600.0;
    stand.run(4000);
    stand
}

fn force_n(truth: &Truth, axis: Axis) -> f64 {
    truth.axes[axis.index()].force_n
}

#[test]
fn the_motor_pays_for_friction_the_cut_and_the_speed() {
    let mut stand = turning(2000.0, "");
    let energy = |truth: &Truth| 0.5 * 0.15 * (truth.spindle_rpm * TAU / 60.0).powi(2);
    let (before, cycle_s) = (energy(stand.truth()), 0.0005);
    stand.spindle = pass(0.4);
    let (mut paid, mut taken, mut slowest) = (0.0, 0.0, 600.0f64);
    for _ in 0..4000 {
        let cut_nm = stand.truth().cut.torque_nm;
        let rpm_before = stand.truth().spindle_rpm;
        let truth = stand.tick();
        let w = 0.5 * (rpm_before + truth.spindle_rpm) * TAU / 60.0;
        paid += truth.spindle_torque_nm * w * cycle_s;
        taken += (1.0 + 0.01 * w + cut_nm) * w * cycle_s;
        slowest = slowest.min(truth.spindle_rpm);
    }
    let kinetic = energy(stand.truth()) - before;
    assert!(((taken + kinetic) / paid - 1.0).abs() < 1e-3, "{taken} and {kinetic} of {paid} J");
    // 277 N at 60 mm; the slide gives way a little, so it is not quite as much.
    let cut = stand.truth().cut;
    assert!((16.0..16.7).contains(&cut.torque_nm), "{cut:?}");
    // The speed loop as an oscillator of 11.2 rad/s with damping 0.84, which a step of torque hits.
    let (wn, damping) = ((TAU * 3.0 / 0.15).sqrt(), 0.5 * TAU * 3.0 / (TAU * 3.0 / 0.15).sqrt());
    let (wd, decay) = (wn * (1.0 - damping * damping).sqrt(), wn * damping);
    let at = libm::atan2(wd, decay);
    let dip = 16.4 / 0.15 / wd * libm::exp(-decay * at / wd) * libm::sin(at) * 60.0 / TAU;
    assert!((600.0 - slowest - dip).abs() < 1.0, "{slowest} 1/min, a dip of {dip} expected");
    assert!((stand.truth().spindle_rpm - 600.0).abs() < 0.5, "the drive has caught up");
    let motor = stand.truth().spindle_torque_nm;
    assert!((motor - (1.0 + 0.01 * 62.83 + cut.torque_nm)).abs() < 0.02, "{motor} N·m");
}

#[test]
fn the_cut_pushes_x_out_and_z_back_and_a_scenario_adds_to_it() {
    let event = "[[event]]\nat = { time_s = 2.5 }\naxial_force_n = 100\n\
                 [[event]]\nat = { time_s = 2.5 }\nradial_force_n = 50\n\
                 [[event]]\nat = { time_s = 2.5 }\nspindle_load = { torque_nm = 3 }\n";
    let mut stand = turning(2000.0, event);
    assert_eq!((force_n(stand.truth(), Axis::X), force_n(stand.truth(), Axis::Z)), (0.0, 0.0));
    stand.spindle = pass(0.4);
    let truth = *stand.run(500).truth();
    assert!(truth.cut.radial_n > 130.0 && truth.cut.axial_n > 50.0, "{:?}", truth.cut);
    assert_eq!(force_n(&truth, Axis::X), truth.cut.radial_n);
    assert_eq!(force_n(&truth, Axis::Z), truth.cut.axial_n);
    let slide_um = 1e3 * (truth.axes[Axis::X.index()].slide_mm - truth.axes[Axis::X.index()].motor_mm);
    // Within what the guide's friction takes: up to 160 N of 43 N/µm.
    assert!((0.0..truth.cut.radial_n / 43.0).contains(&slide_um) && slide_um > 0.2, "{slide_um} µm");

    let truth = *stand.run(4000).truth();
    assert_eq!(force_n(&truth, Axis::X), truth.cut.radial_n + 50.0);
    assert_eq!(force_n(&truth, Axis::Z), truth.cut.axial_n + 100.0);
    let motor = truth.spindle_torque_nm;
    assert!((motor - (1.628 + 3.0 + truth.cut.torque_nm)).abs() < 0.02, "{motor} N·m");
}

#[test]
fn a_heavy_cut_does_not_shake_the_slide_by_the_method() {
    let mut stand = turning(5000.0, "");
    stand.spindle = pass(4.0);
    stand.run(2000);
    // One period of the slide on its screw.
    let (mut low, mut high) = (f64::MAX, f64::MIN);
    for _ in 0..20 {
        let x = stand.tick().axes[Axis::X.index()].slide_mm;
        (low, high) = (low.min(x), high.max(x));
    }
    assert!(stand.truth().cut.force_n > 10_000.0, "{:?}", stand.truth().cut);
    assert!(high - low < 1e-4, "{} µm", 1e3 * (high - low));
}

#[test]
fn a_machine_that_cuts_air_is_the_machine_of_before() {
    let run = |specific_force: f64, spindle: SpindleCommand| {
        let mut stand = turning(specific_force, "");
        stand.spindle = spindle;
        *stand.run(500).truth()
    };
    let plain = SpindleCommand { rpm: 600.0, ..SpindleCommand::default() };
    assert_eq!(run(0.0, pass(0.4)), run(0.0, plain));
    assert_eq!(run(2000.0, plain), run(0.0, plain));
    assert_ne!(run(2000.0, pass(0.4)), run(0.0, plain));
}
