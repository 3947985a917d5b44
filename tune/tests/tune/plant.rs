//! An axis of the simulated machine, tuned by what it measures: identified values against the truth, and
//! refusals.

use machine::Machine;
use protocol::{Axis, DriveCommand, Measurement, PerAxis, SpindleCommand};
use sim_plant::{Plant, Scenario};
use tune::{Bench, Refusal, Tuned, tune};

/// A whole machine, of which only one axis is free.
struct OnPlant(Plant);

impl Bench for OnPlant {
    fn measurement(&self) -> &Measurement {
        self.0.measurement()
    }

    fn tick(&mut self, drives: &PerAxis<DriveCommand>) {
        self.0.tick(drives, &SpindleCommand::default(), None);
    }
}

/// The truth about X.
#[derive(Clone, Copy)]
struct Truth {
    inertia_kg_m2: f64,
    slide_mass_kg: f64,
    mode_hz: f64,
    /// Friction, of that of the small lathe.
    friction: f64,
    current_lag_s: f64,
}

const LATHE: Truth =
    Truth { inertia_kg_m2: 12e-4, slide_mass_kg: 110.0, mode_hz: 100.0, friction: 1.0, current_lag_s: 5e-4 };

impl Truth {
    fn machine(&self) -> Machine {
        let mut machine = Machine::plain();
        let x = machine.plant["axis"]["x"].as_table_mut().expect("the lathe has an X");
        for (key, value) in [
            ("inertia_kg_m2", self.inertia_kg_m2),
            ("slide_mass_kg", self.slide_mass_kg),
            ("mode_hz", self.mode_hz),
            ("current_lag_s", self.current_lag_s),
            ("screw_coulomb_n", 150.0 * self.friction),
            ("slide_coulomb_n", 120.0 * self.friction),
            ("slide_static_n", 160.0 * self.friction),
        ] {
            assert!(x.insert(key.into(), toml::Value::Float(value)).is_some());
        }
        machine
    }

    fn mass_kg(&self) -> f64 {
        let per_metre = core::f64::consts::TAU / 5e-3;
        self.inertia_kg_m2 * per_metre * per_metre + self.slide_mass_kg
    }

    /// At the motor: the screw, and the guide behind the mode.
    fn presliding_n_mm(&self) -> f64 {
        let rad_s = core::f64::consts::TAU * self.mode_hz;
        let mode = 1e-3 * self.slide_mass_kg * rad_s * rad_s;
        30_000.0 + 1.0 / (1.0 / 15_000.0 + 1.0 / mode)
    }
}

fn tuned(machine: &Machine) -> Result<Tuned, Refusal> {
    let mut bench = OnPlant(Plant::new(machine, Scenario::none(), 1).expect("the plant is sound"));
    let found = tune(&mut bench, Axis::X, machine);
    let still = bench.0.truth().axes[0];
    assert!(still.velocity_mm_s.abs() < 0.1, "it is left at rest: {} mm/s", still.velocity_mm_s);
    found
}

fn within(what: &str, found: f64, truth: f64, per_cent: f64) {
    let error = 100.0 * (found / truth - 1.0);
    assert!(error.abs() <= per_cent, "{what}: {found} is {error:.2} % from {truth}");
}

const TRUTHS: [Truth; 7] = [
    LATHE,
    Truth { inertia_kg_m2: 25.4e-4, ..LATHE },
    Truth { friction: 3.0, ..LATHE },
    Truth { mode_hz: 60.0, ..LATHE },
    Truth { current_lag_s: 1e-3, ..LATHE },
    Truth { slide_mass_kg: 400.0, ..LATHE },
    Truth { inertia_kg_m2: 20e-4, slide_mass_kg: 400.0, mode_hz: 60.0, friction: 3.0, current_lag_s: 1e-3 },
];

#[test]
fn identified_values_are_those_of_the_plant() {
    for truth in TRUTHS {
        let found = tuned(&truth.machine()).unwrap();
        within("mass", found.mass_kg.value, truth.mass_kg(), 0.5);
        within("Coulomb friction", found.coulomb_n.value, 270.0 * truth.friction, 1.0);
        within("viscous friction", found.viscous_n_s_mm.value, 2.6, 2.0);
        // Two frictions that break away one after the other are not one spring, but the one nearest to both
        // lies below.
        let presliding = found.presliding_n_mm.expect("there is friction");
        within("presliding", presliding.value, truth.presliding_n_mm(), 25.0);
        within("delay", found.delay_s.value, 5e-4, 1.0);
        within("lag", found.lag_s.value, truth.current_lag_s, 1.0);
        assert!(found.constant_n.value.abs() < 1.0, "{:?}", found.constant_n);
        let mode = found.mode.unwrap();
        within("mode", mode.hz.value, truth.mode_hz, 1.0);
        within("slide", mode.slide_kg.value, truth.slide_mass_kg, 5.0);
        // The guide also damps the slide: 600 N s/m against 2 m w, less what its friction falls with speed.
        let guide = 600.0 / (2.0 * truth.slide_mass_kg * core::f64::consts::TAU * truth.mode_hz);
        within("damping", mode.damping.value, 0.03 + guide, 10.0);
    }
}

#[test]
fn deviations_are_of_the_size_of_the_errors() {
    for truth in TRUTHS {
        let found = tuned(&truth.machine()).unwrap();
        let presliding = found.presliding_n_mm.expect("there is friction");
        for (estimate, is, share) in [
            (found.mass_kg, truth.mass_kg(), 0.02),
            (found.coulomb_n, 270.0 * truth.friction, 0.02),
            (found.viscous_n_s_mm, 2.6, 0.02),
            (presliding, truth.presliding_n_mm(), 0.25),
        ] {
            let error = (estimate.value - is).abs();
            assert!(
                error < 4.0 * estimate.deviation && estimate.deviation < share * is,
                "{estimate:?} for {is}"
            );
        }
    }
}

/// Then the stiffness before sliding stays as it was configured.
#[test]
fn an_axis_without_friction() {
    let mut machine = Truth { friction: 0.0, ..LATHE }.machine();
    machine.axis.get_mut(&Axis::X).expect("the lathe has an X").presliding_n_mm = 12_345.0;
    let found = tuned(&machine).expect("it is tuned");
    assert_eq!((found.presliding_n_mm, found.proposal.presliding_n_mm), (None, 12_345.0));
    assert!(found.coulomb_n.value.abs() < 1.0, "{:?}", found.coulomb_n);
}

/// The loops of the proposal hold: tuned again with them, the axis follows, and the proposal stays.
#[test]
fn a_proposal_is_stable_and_stays() {
    for truth in TRUTHS {
        let mut machine = truth.machine();
        let first = tuned(&machine).expect("it is tuned");
        machine.axis.insert(Axis::X, first.proposal.clone());
        let second = tuned(&machine).expect("it is tuned with the proposal");
        for (what, per_cent, of) in [
            ("mass", 0.5, (|found| found.proposal.mass_kg) as fn(&Tuned) -> f64),
            ("Coulomb friction", 1.0, |found| found.proposal.coulomb_n),
            ("acceleration lead", 0.2, |found| found.proposal.acceleration_lead_s),
            ("bandwidth", 5.0, |found| found.proposal.velocity_bandwidth_hz),
            ("position gain", 10.0, |found| found.proposal.position_gain_1_s),
        ] {
            within(what, of(&second), of(&first), per_cent);
        }
        let margins = second.before;
        assert!(margins.velocity.phase_deg > 33.0 && margins.velocity.gain > 2.1, "{margins:?}");
        assert!(margins.position.phase_deg > 58.0 && margins.position.gain > 2.8, "{margins:?}");
    }
}

/// The margins of a linear loop say nothing of backlash.
#[test]
fn a_loop_over_a_scale_behind_a_backlash_gets_no_faster() {
    let mut machine = Machine::plain();
    let x = machine.axis.get_mut(&Axis::X).expect("the lathe has an X");
    (x.scale_step_mm, x.position_gain_1_s) = (Some(1e-4), 20.0);
    let without = tuned(&machine).expect("it is tuned").proposal.position_gain_1_s;
    machine.axis.get_mut(&Axis::X).expect("the lathe has an X").backlash_mm = 0.01;
    let with = tuned(&machine).expect("it is tuned").proposal.position_gain_1_s;
    assert!(without > 30.0 && with == 20.0, "{without} without, {with} with backlash");
}

/// A lathe as it stands in a shop: the motor gives 5 % more torque than its drive believes, torque is
/// measured with noise and steps, the screw breaks away, and everything is on its way for a cycle.
fn shop(more: &str) -> Machine {
    let mut machine = Machine::plain();
    (machine.bus.input_cycles, machine.bus.output_cycles) = (1, 1);
    let keys = format!(
        "torque_constant_pct = 5.0\ntorque_noise_nm = 0.01\ntorque_step_nm = 0.00477\n\
         screw_static_n = 190.0\nscrew_bristle_n_s_mm = 48.0\nslide_bristle_n_s_mm = 8.0\n{more}"
    );
    let keys: toml::Table = keys.parse().expect("keys of the plant");
    let x = machine.plant["axis"]["x"].as_table_mut().expect("the lathe has an X");
    x.extend(keys);
    machine.plant.insert(
        "bus".into(),
        toml::toml! {
            input_cycles = 1
            output_cycles = 1
        }
        .into(),
    );
    machine
}

/// By torque as the drive believes it, everything is 5 % less: that is what feedforward needs.
#[test]
fn a_lathe_as_it_stands_in_a_shop() {
    for (per_rev, degrees) in [(24u32, 150.0), (12, -75.0)] {
        let machine = shop(&format!(
            "gravity_n = -760.0\ncogging_nm = 0.05\ncogging_per_rev = {per_rev}\ncogging_deg = {degrees:?}"
        ));
        let found = tuned(&machine).expect("it is tuned");
        within("mass", found.mass_kg.value, LATHE.mass_kg() / 1.05, 0.5);
        within("Coulomb friction", found.coulomb_n.value, 270.0 / 1.05, 2.0);
        within("viscous friction", found.viscous_n_s_mm.value, 2.6 / 1.05, 3.0);
        within("weight", found.proposal.gravity_n, -760.0 / 1.05, 0.5);
        within("mode", found.proposal.mode_hz.expect("a mode"), 100.0, 1.0);
        within("acceleration lead", found.proposal.acceleration_lead_s, 1.25e-3, 1.0);
        let presliding = found.presliding_n_mm.expect("there is friction").value;
        within("presliding", presliding, LATHE.presliding_n_mm() / 1.05, 25.0);
        let waves = found.cogging.clone().expect("there is room for some turns");
        let [wave] = waves[..] else { panic!("one wave, not {waves:?}") };
        assert_eq!(wave.times, per_rev);
        for (what, estimate, is, most) in [
            ("torque", wave.torque_nm, 0.05 / 1.05, 1e-3),
            // Home is a whole number of turns.
            ("phase", wave.phase_deg, degrees, 2.0),
        ] {
            let error = (estimate.value - is).abs();
            assert!(error < most && error < 4.0 * estimate.deviation, "{what}: {estimate:?} for {is}");
        }
        assert_eq!(found.proposal.cogging.len(), 1);
    }
}

#[test]
fn a_motor_that_runs_evenly_gets_no_cogging_and_an_axis_that_lies_no_weight() {
    let found = tuned(&shop("")).expect("it is tuned");
    assert_eq!((found.proposal.gravity_n, found.proposal.cogging.len()), (0.0, 0));
    let mut believing = Machine::plain();
    let x = believing.axis.get_mut(&Axis::X).expect("the lathe has an X");
    (x.gravity_n, x.cogging) = (300.0, vec![[24.0, 0.05, 0.0]]);
    let proposal = tuned(&believing).expect("it is tuned").proposal;
    assert_eq!((proposal.gravity_n, proposal.cogging.len()), (0.0, 0));
}

/// The loop of the position knows that it is late.
#[test]
fn a_bus_takes_margin_from_the_position_loop_alone() {
    let without = tuned(&Machine::plain()).expect("it is tuned");
    let mut machine = Machine::plain();
    (machine.bus.input_cycles, machine.bus.output_cycles) = (1, 1);
    machine.plant.insert(
        "bus".into(),
        toml::toml! {
            input_cycles = 1
            output_cycles = 1
        }
        .into(),
    );
    let with = tuned(&machine).expect("it is tuned");
    within("mass", with.mass_kg.value, LATHE.mass_kg(), 0.5);
    within("delay", with.delay_s.value, 5e-4, 1.0);
    let (before, late) = (without.before, with.before);
    assert!((before.velocity.phase_deg - late.velocity.phase_deg).abs() < 0.5, "{before:?} {late:?}");
    // A millisecond at the crossover.
    let taken_deg = 360.0 * 1e-3 * late.position.crossover_hz;
    let left_deg = before.position.phase_deg - late.position.phase_deg;
    assert!((left_deg - taken_deg).abs() < 1.0 && late.position.gain < before.position.gain, "{late:?}");
}
