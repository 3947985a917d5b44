//! Chains of random blocks: every axis within its limits at every moment, every target reached, whatever the operator
//! does meanwhile.

mod programs;
mod stand;

use motion::chain::Ratios;
use programs::{Seed, program};
use stand::{Stand, ask};

#[test]
fn random_programs_keep_every_limit_and_reach_their_end() {
    for seed in 0..300 {
        let mut random = Seed::new(seed);
        let blocks = program(&mut random);
        let mut stand = Stand::new(&blocks);
        let mut asked = ask();
        stand.pace = 1 + (random.next() % 4) as u32;
        while stand.tick(&asked) {
            if random.chance(0.01) {
                asked.hold = !asked.hold;
            }
            if random.chance(0.01) {
                asked.ratios = Ratios { rapid: random.unit(), feed: 2.0 * random.unit(), turns: 10.0 };
            }
            if stand.ticks() > 2_000_000 {
                panic!("program {seed} does not end");
            }
            if stand.ticks() % 500 == 499 {
                asked = ask();
            }
        }
        stand.ends(seed);
    }
}
