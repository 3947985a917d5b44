//! What the controller believes of screw, home and encoders, and is wrong about: what becomes of a thread.
#![allow(clippy::unwrap_used)]

use machine::{AxisConfig, Bus, Machine};
use protocol::{Code, Feed, Item, Position, units::AXES};
use rig::{
    observe::{Observation, Outcome},
    trial::{self, Trial},
};
use sim_plant::Scenario;

/// Ten turns of a thread with a lead of 5 mm at 500 1/min on a lathe of which this is true.
fn thread(plant: &str) -> Observation {
    let machine = Machine { plant: plant.parse().unwrap(), ..Machine::plain() };
    let trial = Trial { s_rpm: 500.0, delta_x_mm: 0.0, turns: 10.0, ..Trial::default() };
    let items = trial::program(&machine, &[trial]).unwrap();
    trial::run(&machine, &items, &Scenario::none(), 1, &mut |_| ()).unwrap()
}

#[test]
fn an_encoder_of_other_lines_is_named() {
    for (lines, fault) in
        [(2490, "encoder-pulses-lost"), (2498, "encoder-pulses-lost"), (2510, "encoder-pulses-gained")]
    {
        let seen = thread(&format!("[spindle]\nencoder_lines = {lines}"));
        assert_eq!(seen.outcome, Outcome::Faulted, "{lines} lines");
        assert!(seen.faults.iter().any(|found| found.code == fault), "{lines}: {:?}", seen.faults);
    }
}

#[test]
fn a_wrong_lead_of_the_screw_is_an_error_of_the_lead() {
    // 5 mm a turn come out as 5.002 mm.
    let seen = thread("[axis.z]\nscrew_lead_mm = 5.002");
    let pass = &seen.passes[0];
    assert!(pass.complete && (pass.lead_error_um_per_rev.abs() - 2.0).abs() < 0.05, "{pass:#?}");
}

#[test]
fn a_wrong_home_is_an_offset_of_the_thread() {
    let [right, wrong] = ["", "[axis.z]\nhome_off_mm = 0.3"].map(|plant| {
        let seen = thread(plant);
        assert!(seen.passes[0].complete);
        seen.passes[0].slide_phase_um
    });
    assert!((wrong - right - 300.0).abs() < 1.0, "{right} µm, {wrong} µm");
}

#[test]
fn a_loop_that_swings_is_not_taken_for_a_bad_encoder() {
    // The same motor on a screw of twice the lead moves a quarter of the mass.
    let mut machine = Machine::default();
    machine.axis.values_mut().for_each(|axis| axis.screw_lead_mm = 10.0);
    let fault = |machine: &Machine, scenario: &str| {
        let scenario = Scenario::from_toml(scenario).unwrap();
        let items = [Item { line: 1, code: AWAY }, Item { line: 2, code: Code::End }];
        let seen = trial::run(machine, &items, &scenario, 1, &mut |_| ()).unwrap();
        seen.faults.into_iter().find(|found| found.code == "axis-jump").unwrap().text
    };
    let swings = fault(&machine, "");
    assert!(swings.contains("it swings, by ") && swings.contains("screw_lead_mm and mass_kg"), "{swings}");
    let jumps = fault(
        &Machine::default(),
        "[[event]]\nat = { time_s = 0.2 }\naxis_jump = { axis = \"x\", mm = 0.045 }",
    );
    assert!(!jumps.contains("it swings"), "{jumps}");
}

/// X and Z go away from home in timed motion.
const AWAY: Code = {
    let mut target = [Position(0); AXES];
    (target[0], target[2]) = (Position(30_000_000_000), Position(20_000_000_000));
    Code::Line { target, feed: Feed::Rapid }
};

#[test]
fn a_wrong_bus_is_named_by_what_it_looks_like() {
    let items = [Item { line: 1, code: AWAY }, Item { line: 2, code: Code::End }];
    let told = |change: &dyn Fn(&mut Machine)| {
        let mut machine = Machine::default();
        change(&mut machine);
        let seen = trial::run(&machine, &items, &Scenario::none(), 1, &mut |_| ()).unwrap();
        assert_eq!(seen.outcome, Outcome::Completed);
        seen.warnings.into_iter().find(|warning| warning.code == "bus-delay").map(|warning| warning.text)
    };
    for (input_cycles, output_cycles, believed) in
        [(0, 0, 0), (0, 1, 1), (1, 0, 1), (2, 1, 3), (1, 2, 3), (2, 2, 4)]
    {
        let text = told(&|machine| machine.bus = Bus { input_cycles, output_cycles }).unwrap();
        assert!(text.contains(&format!("of [bus] are {believed} together")), "{text}");
        assert!(text.contains("if 2 were right"), "{text}");
    }
    // What else may be believed wrongly looks different.
    let axes: [fn(&mut AxisConfig); 7] = [
        |_| (),
        |axis| axis.mass_kg *= 0.5,
        |axis| axis.mass_kg *= 1.5,
        |axis| axis.coulomb_n = 0.0,
        |axis| axis.mode_hz = Some(50.0),
        |axis| axis.velocity_integral_s *= 10.0,
        |axis| axis.backlash_mm = 0.03,
    ];
    for (number, change) in axes.into_iter().enumerate() {
        let text = told(&|machine| machine.axis.values_mut().for_each(change));
        assert_eq!(text, None, "change {number}");
    }
}
