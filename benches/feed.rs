//! Planning of one block beside rsruckig: time of motion, and ns for a plan. `cargo bench --bench feed`
//! prints a table.
//!
//! rsruckig plans the fastest motion with rectangular jerk. Ours has a smooth jerk: with the same limit it
//! takes longer, and as long as rsruckig at half the limit (M27; `tests/machine/rest_to_rest.rs` holds that).
//! The last rows have a limit of the jerk rate as well, which the peer does not know. Both plan the same
//! blocks in turns; a figure is the median of rounds.
#![allow(missing_docs, clippy::unwrap_used, clippy::print_stdout, clippy::disallowed_methods)] // measures time

mod peer;

use std::{hint::black_box, time::Instant};

use peer::{Asked, Peer, blocks};

const BLOCKS: usize = 5000;
const ROUNDS: usize = 21;

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn ns_each(work: impl FnOnce()) -> f64 {
    let begun = Instant::now();
    work();
    begun.elapsed().as_secs_f64() * 1e9 / BLOCKS as f64
}

/// Keeps the compiler from leaving out what nobody reads.
fn use_up<T>(value: T) {
    black_box(value);
}

/// Medians of ns for a plan: ours, rsruckig.
fn cost(asked: &[Asked], peer: &mut Peer) -> [f64; 2] {
    let inputs: Vec<_> = asked.iter().map(|asked| asked.input(1.0)).collect();
    let round = |_| {
        let ours = ns_each(|| asked.iter().for_each(|asked| use_up(black_box(asked).plan())));
        let theirs = ns_each(|| inputs.iter().for_each(|input| use_up(peer.time(black_box(input)))));
        (ours, theirs)
    };
    let (ours, theirs) = (0..ROUNDS).map(round).unzip();
    [ours, theirs].map(median)
}

/// Our time over that of rsruckig at a share of the jerk limit: least, median, greatest.
fn times(asked: &[Asked], peer: &mut Peer, share: f64) -> [f64; 3] {
    let mut ratios: Vec<f64> = asked
        .iter()
        .map(|asked| asked.plan().unwrap().duration() / peer.time(&asked.input(share)).unwrap())
        .collect();
    ratios.sort_by(f64::total_cmp);
    [ratios[0], ratios[ratios.len() / 2], ratios[ratios.len() - 1]]
}

fn main() {
    let mut peer = Peer::new();
    println!(
        "{BLOCKS} random blocks a row; ratios: time of motion, ours over rsruckig, least … median … greatest"
    );
    println!(
        "{:<29}  {:^34}  {:^28}  {:>8}  {:>8}",
        "blocks", "rsruckig at half the jerk limit", "at the same jerk limit", "ours", "rsruckig"
    );
    for (name, at_rest, dj) in [
        ("rest to rest", true, f64::INFINITY),
        ("feeds at both ends", false, f64::INFINITY),
        ("rest to rest, jerk rate too", true, 1e4),
        ("also feeds at both ends", false, 1e4),
    ] {
        let asked = blocks(1, BLOCKS, at_rest, dj);
        let [low, mid, high] = times(&asked, &mut peer, 0.5);
        let [low_same, mid_same, high_same] = times(&asked, &mut peer, 1.0);
        let [ours, theirs] = cost(&asked, &mut peer);
        println!(
            "{name:<29}  {low:>10.8} {mid:>10.8} {high:>12.8}  {low_same:>8.4} {mid_same:>8.4} {high_same:>10.4}  \
             {ours:>5.0} ns  {theirs:>5.0} ns"
        );
    }
}
