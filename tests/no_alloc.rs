//! After the start nothing allocates: a tick of the interpolator, of a regulator or of the plant takes the
//! same memory in every cycle of a program.

mod shop;

use std::fs;

use allocation_counter::measure;
use machine::Machine;
use protocol::Item;
use rig::Rig;
use sim_plant::Scenario;

/// Cycles in which whatever is made once may be made.
const WARM_UP: u64 = 2000;

/// Runs a machine to its end; how many cycles came after the warm-up, of which none allocates.
fn cycles_without_allocation(rig: &mut Rig<impl Iterator<Item = Item>>, name: &str) -> u64 {
    for _ in 0..WARM_UP {
        assert!(rig.cycle(None, |_| {}), "{name} is longer than the warm-up");
    }
    let mut cycles = 0_u64;
    let counted = measure(|| {
        while rig.cycle(None, |_| {}) {
            cycles += 1;
        }
    });
    assert_eq!(counted.count_total, 0, "{name}: {counted:?} in {cycles} cycles");
    cycles
}

#[test]
fn a_whole_program_allocates_nothing() {
    for example in shop::EXAMPLES {
        for scenario in shop::SCENARIOS {
            let text = |path| fs::read_to_string(path).expect("examples are shipped");
            // With steel in the chuck, so that there is a cut to be remembered.
            let lathe = text(shop::project().join("examples/machines/small-lathe.toml"));
            let steel = lathe.replace("specific_force_n_mm2 = 0.0", "specific_force_n_mm2 = 2000.0");
            assert_ne!(steel, lathe, "the key stands in the file");
            let machine = Machine::from_toml(&steel).expect("it is right");
            let check = interpreter::check(example, &text(shop::example(example)), &machine);
            let items = check.items.into_iter();
            let scenario = Scenario::from_toml(&text(shop::scenario(scenario))).expect("examples are right");
            let mut rig = Rig::new(&machine, items, scenario, 1).expect("the built-in machine can be built");
            let cycles = cycles_without_allocation(&mut rig, example);
            assert!(cycles > 10_000, "{example} ended after {cycles} cycles");
        }
    }
}

/// A varied spindle, and a tool that chatters.
#[test]
fn a_thread_at_a_varied_speed_with_a_tool_that_gives_way_allocates_nothing() {
    let lathe = fs::read_to_string(shop::project().join("examples/machines/small-lathe.toml"));
    let steel = lathe.expect("it is shipped").replace("force_n_mm2 = 0.0", "force_n_mm2 = 2000.0");
    let machine = Machine::from_toml(&(steel + "\n[plant.chatter]\nstiffness_n_mm = 20000.0\n"));
    let machine = machine.expect("it is right");
    for how in ["sine, 30, 3", "triangle, 30, 3", "random, 30, 3"] {
        let text = format!(
            "G18 G8 G94\n(speed_variation, {how})\nM3 S240\nG0 X12 Z8\nG76 P2 Z-20 I-2 J0.5 K1.5\nM2\n"
        );
        let check = interpreter::check(how, &text, &machine);
        assert!(check.is_good(), "{:?}", check.diagnostics);
        let mut rig =
            Rig::new(&machine, check.items.into_iter(), Scenario::none(), 1).expect("it can be built");
        let cycles = cycles_without_allocation(&mut rig, how);
        assert!(cycles > 20_000, "{how} ended after {cycles} cycles");
    }
}

/// An operator who leaves the feed alone for no second: new overrides, holds, cycle starts.
fn restless() -> Scenario {
    let mut scenario = String::new();
    for i in 0..20 {
        let (at, pct) = (2.0 + 0.4 * f64::from(i), 20 + 37 * i % 170);
        scenario += &format!("[[event]]\nat = {{ time_s = {at} }}\nfeed_override_pct = {pct}\n");
        let (hold, on) = (at + 0.1, at + 0.25);
        scenario += &format!("[[event]]\nat = {{ time_s = {hold} }}\nfeed_hold = true\n");
        scenario += &format!("[[event]]\nat = {{ time_s = {on} }}\ncycle_start = true\n");
    }
    Scenario::from_toml(&scenario).expect("a scenario")
}

/// Formulas evaluated, pieces made and drawn ahead, corrected and not; a tool that retracts, and a seam.
#[test]
fn work_from_formulas_allocates_nothing() {
    let text = |path: &str| fs::read_to_string(shop::project().join(path)).expect("examples are shipped");
    let mill = text("examples/machines/small-mill.toml");
    let surface = |more: &str| {
        "[job]\nkind = \"surface\"\norigin_mm = [0, 0, -100]\nspindle_rpm = 8000\nfeed_mm_min = 3000\n\
         z = \"0.02*x^2 + 8*sin(x/15)*cos(y/20)\"\nx = [0, 40]\ny = [0, 6]\ntool = { kind = \"ball\", diameter_mm = 6 }\n"
            .to_owned()
            + more
    };
    let seam = text("examples/positioner/cylinders.toml");
    let positioner = text("examples/machines/positioner.toml");
    for (machine, job) in [
        (&mill, surface("path = { pattern = \"lines\", along = \"x\", step_mm = 1 }\n")),
        (&mill, surface("path = { pattern = \"lines\", along = \"x\", step_mm = 1, one_way = true }\n")),
        (&mill, surface("path = { pattern = \"rings\", step_mm = 1 }\ncorrection = \"mixed\"\n")),
        (&positioner, seam),
    ] {
        let machine = Machine::from_toml(machine).expect("it is right");
        let check = interpreter::check_job("work", &job, &machine);
        assert!(check.is_good(), "{:?}", check.diagnostics);
        let mut rig = Rig::new(&machine, check.items.into_iter(), restless(), 1).expect("it can be built");
        let cycles = cycles_without_allocation(&mut rig, &job);
        assert!(cycles > 10_000, "{job} ended after {cycles} cycles");
    }
}

/// Outputs at rest and in step with motion, waits for inputs, and what answers them.
#[test]
fn outputs_and_inputs_allocate_nothing() {
    let [machine, program, answers] = ["lathe.toml", "pin.ngc", "answers.toml"].map(|name| {
        fs::read_to_string(shop::project().join("examples/bar-feeder").join(name)).expect("it is shipped")
    });
    let machine = Machine::from_toml(&machine).expect("it is right");
    let check = interpreter::check("pin.ngc", &program, &machine);
    let answers = Scenario::from_toml(&answers).expect("it is right");
    let mut rig = Rig::new(&machine, check.items.into_iter(), answers, 1).expect("it can be built");
    let cycles = cycles_without_allocation(&mut rig, "the bar feeder");
    assert!(cycles > 50_000, "it ended after {cycles} cycles");
}

/// Look-ahead, blends, overrides and holds: a contour of short lines, each with an output, under an operator
/// who does not leave it alone.
#[test]
fn a_contour_under_overrides_allocates_nothing() {
    let mill = fs::read_to_string(shop::project().join("examples/machines/small-mill.toml"));
    let mill = mill.expect("examples are shipped") + "\n[outputs.3]\nname = \"air\"\n";
    let machine = Machine::from_toml(&mill).expect("it is right");
    let mut text = "G21 G64 P0.01 Q0 F3000\nG0 X0 Y0\n".to_owned();
    for i in 1..4000 {
        let (s, c) = libm::sincos(f64::from(i) / 150.0);
        text += &format!("M{} P3\nG1 X{:.6} Y{:.6}\n", 62 + i % 2, 30.0 * s, 30.0 - 30.0 * c);
    }
    let check = interpreter::check("contour", &(text + "M2\n"), &machine);
    let mut rig = Rig::new(&machine, check.items.into_iter(), restless(), 1).expect("it can be built");
    let cycles = cycles_without_allocation(&mut rig, "the contour");
    assert!(cycles > 20_000, "it ended after {cycles} cycles");
}
