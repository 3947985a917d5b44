//! A case from a seed. In: a seed. Out: a [`Case`] without events, ready to run; then, once it is known what
//! it does undisturbed, its events. The same seed gives the same case on the same version.

mod chain;
mod events;
mod lathe;
mod machines;
mod referenced;
mod shop;
mod thread;
mod timed;

use testing::Seed;

use crate::case::{Case, Ready};

pub(crate) use events::events;
pub(crate) use shop::SHOP;

/// Programs that a machine refuses, or that take long, are drawn again so often.
const TRIES: u64 = 1000;
/// A program takes no longer than this, s; and so much longer with each that was refused.
const LONGEST_S: f64 = 3.2;
const LONGER_S: f64 = 0.1;

/// A random machine with a random program that it takes.
///
/// # Panics
/// If no program can be drawn at all: the generator is wrong.
pub fn draw(number: u64) -> (Case, Ready) {
    let kind = Seed::of_case(number).below(20);
    for attempt in 0..TRIES {
        let mut seed = Seed::of_case(number.wrapping_mul(TRIES).wrapping_add(attempt));
        let case = one(number, kind, &mut seed);
        match case.ready() {
            Some(ready) if ready.time_s < LONGEST_S + LONGER_S * attempt as f64 => return (case, ready),
            _ => {}
        }
    }
    panic!("seed {number}: every program is refused");
}

/// The sequence that the events of a case are drawn from.
pub(crate) fn seed_of_events(number: u64) -> Seed {
    Seed::of_case(number ^ 0x6576_656E_7473)
}

fn one(number: u64, kind: usize, seed: &mut Seed) -> Case {
    let (mut machine, blocks, mut kinds) = match kind {
        0 | 1 => timed::mill(seed),
        2 => timed::positioner(seed),
        3 | 4 => lathe::timed(seed),
        5 => lathe::roughing(seed),
        6 => lathe::fanuc(seed),
        7 => chain::chain(seed),
        9 => chain::tap(seed),
        10 => chain::arc(seed),
        _ => lathe::thread(seed),
    };
    referenced::referenced(number, &mut machine);
    if !machine.reference_runs().is_empty() {
        kinds.push("reference-runs");
    }
    Case { seed: number, machine, blocks, kinds, plant_seed: seed.next() >> 16, events: Vec::new() }
}
