//! Random programs under everything that an operator, a spindle and a slow sender do: every axis within its
//! limits at every cycle, every block completed, the end reached exactly. `PITCHLOCK_PROGRAMS` says how many,
//! and `PITCHLOCK_PROGRAM` runs the one of this number alone.

use crate::programs::{Line, N, Place, end_of, program};
use crate::stand::{AXES, CYCLE_S, Stand, ask};
use motion::chain::{Ask, Block, Ratios};
use motion::{Limits, Path};
use testing::{Seed, count};

/// Cycles for which things happen.
const PLAYFUL: u64 = 100_000;

/// What happens during a program.
struct Events {
    /// Chance of each, per cycle.
    hold: f64,
    single: f64,
    change: f64,
    starve: f64,
    /// Share by which the observed speed of the spindle swings from cycle to cycle.
    noise: f64,
}

impl Events {
    fn draw(random: &mut Seed) -> Events {
        let mut rare = |often: f64| if random.chance(0.5) { 0.0 } else { random.scale(0.002, often) };
        let (hold, single, change, starve) = (rare(0.2), rare(0.1), rare(0.5), rare(0.1));
        let noise = if random.chance(0.3) { random.scale(1e-6, 0.02) } else { 0.0 };
        Events { hold, single, change, starve, noise }
    }

    fn act(&self, random: &mut Seed, ask: &mut Ask) {
        ask.hold ^= random.chance(self.hold);
        ask.single ^= random.chance(self.single);
        ask.more ^= random.chance(self.starve);
        if random.chance(self.change) {
            let mut share = || if random.chance(0.1) { 0.0 } else { random.scale(0.02, 1.0) };
            ask.ratios = Ratios { rapid: share(), feed: 2.0 * share(), turns: 20.0 * share() };
        } else if self.noise > 0.0 {
            ask.ratios.turns *= 1.0 + random.between(-self.noise, self.noise);
        }
    }
}

/// Limits and a cycle of another machine.
fn machine(random: &mut Seed) -> ([Limits; N], f64) {
    let cycle_s = random.scale(5e-4, 8e-3);
    let mut axis = || Limits {
        v: random.scale(20.0, 500.0),
        a: random.scale(200.0, 10_000.0),
        j: random.scale(1e4, 1e6),
        dj: random.scale(1e6, 1e8),
    };
    ([axis(), axis(), axis()], cycle_s)
}

fn run(number: u64) {
    let mut random = Seed::of_case(number);
    let blocks = program(&mut random);
    let (axes, cycle_s) = if random.chance(0.5) { (AXES, CYCLE_S) } else { machine(&mut random) };
    let mut stand = Stand::of(&blocks, axes, cycle_s);
    let events = Events::draw(&mut random);
    stand.pace = 1 + (random.next() % 4) as usize;
    stand.every = if random.chance(0.5) { 1 } else { 1 + random.next() % 60 };
    let mut asked = ask();
    while stand.tick(&asked) {
        // Who holds and lets go all the time does not come to an end: at last the operator lets the machine
        // go.
        if stand.ticks() < PLAYFUL {
            events.act(&mut random, &mut asked);
        }
        if stand.ticks() % 200 == 199 {
            asked = ask();
        }
    }
    stand.ends();
}

#[test]
fn random_programs_keep_every_limit_and_reach_their_end() {
    let mut failures = Vec::new();
    let (all, one) = (count("PITCHLOCK_PROGRAMS", 300), count("PITCHLOCK_PROGRAM", u64::MAX));
    for number in (0..all).filter(|number| one == u64::MAX || *number == one) {
        if std::panic::catch_unwind(|| run(number)).is_err() {
            failures.push(number);
        }
    }
    assert!(failures.is_empty(), "programs {failures:?}");
}

/// Nothing but a slow sender: as long as more is announced and comes at this pace, the chain waits for no
/// one.
#[test]
fn a_sender_of_one_block_a_cycle_is_fast_enough_for_blocks_of_a_cycle() {
    for number in 0..count("PITCHLOCK_PROGRAMS", 300) / 10 {
        let blocks = program(&mut Seed::of_case(number));
        let mut stand = Stand::new(&blocks);
        stand.pace = 1;
        stand.run(&ask());
        stand.ends();
        assert_eq!(stand.starved(), 0, "program {number}");
    }
}

/// The third axis is a rotary one: it goes along, by more than the way that its block is long.
#[test]
fn a_rotary_axis_keeps_its_limits_too() {
    for number in 0..count("PITCHLOCK_PROGRAMS", 300) / 10 {
        let mut random = Seed::of_case(30_000 + number);
        let mut at = [0.0; N];
        let blocks: Vec<Line> = program(&mut random)
            .into_iter()
            .map(|block| {
                let [x, y, turn] = end_of(&block.path);
                let line = Path::line([x, y, turn + random.between(-20.0, 20.0)], &[true, true, false]);
                let path = line.filter(|_| block.path.is_line()).unwrap_or(block.path);
                let start = at;
                at = std::array::from_fn(|i| at[i] + end_of(&path)[i]);
                Block { path, tag: Place { start, ..block.tag }, ..block }
            })
            .collect();
        let mut stand = Stand::new(&blocks);
        stand.run(&ask());
        stand.ends();
    }
}
