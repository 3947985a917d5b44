//! Whether a disturbed run that begins on the way of the undisturbed one is the one that begins in cycle 0.

use soak::run::{self, Undisturbed};
use soak::{draw, driver};

/// Seeds that are run both ways.
const SEEDS: u64 = 60;

#[test]
fn a_run_that_is_taken_up_on_its_way_is_the_one_from_the_beginning() {
    let (mut taken_up, mut spared) = (0, 0);
    for seed in 0..SEEDS {
        let (case, on_its_way) = driver::one(seed);
        let (_, ready) = draw(seed);
        let alone = run::undisturbed(&case, &ready);
        let copying = Undisturbed::of(&case, &ready);
        assert_eq!(copying.ran, alone, "seed {seed}");
        if case.events.is_empty() {
            continue;
        }
        let whole = run::disturbed(&case, &ready, &alone.measured);
        taken_up += u64::from(on_its_way.cycles < alone.cycles + whole.cycles);
        spared += alone.cycles + whole.cycles - on_its_way.cycles;
        assert_eq!(run::Ran { cycles: on_its_way.cycles, ..whole }, on_its_way, "seed {seed}");
    }
    assert!(taken_up > SEEDS / 2 && spared > 1000 * SEEDS, "{taken_up} runs, {spared} cycles spared");
}
