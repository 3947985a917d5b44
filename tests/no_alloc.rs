//! After the start nothing allocates: a tick of the interpolator, of a regulator or of the plant takes the same memory
//! in every cycle of a program.

mod shop;

use std::fs;

use allocation_counter::measure;
use protocol::Machine;
use rig::Rig;
use sim_plant::Scenario;

/// Cycles in which whatever is made once may be made.
const WARM_UP: u64 = 2000;

#[test]
fn a_whole_program_allocates_nothing() {
    for example in shop::EXAMPLES {
        for scenario in shop::SCENARIOS {
            let text = |path| fs::read_to_string(path).expect("examples are shipped");
            let machine = Machine::default();
            let check = interpreter::check(example, &text(shop::example(example)), &machine);
            let items = check.items.into_iter();
            let scenario = Scenario::from_toml(&text(shop::scenario(scenario))).expect("examples are right");
            let mut rig = Rig::new(&machine, items, scenario, 1).expect("the built-in machine can be built");
            for _ in 0..WARM_UP {
                assert!(rig.cycle(None, |_| {}), "a program is longer than the warm-up");
            }
            let mut cycles = 0_u64;
            let counted = measure(|| {
                while rig.cycle(None, |_| {}) {
                    cycles += 1;
                }
            });
            assert!(cycles > 10_000, "{example} ended after {cycles} cycles");
            assert_eq!(counted.count_total, 0, "{example}: {counted:?} in {cycles} cycles");
        }
    }
}
