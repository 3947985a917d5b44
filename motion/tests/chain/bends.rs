//! Laws that pass several sections (M196, M197): uneven bends and feeds that fall and rise, shorter than a
//! ramp. Whatever is asked for at whatever cycle, the limits hold, the machine stays on its path and comes to
//! its end; planned again in every cycle it is as fast.

use crate::overlap::{FEED, asked, requests, tick};
use crate::programs::{Line, through};
use crate::rounded::Rounded;
use crate::stand::{Stand, ask};
use crate::times::wave;
use motion::chain::{Ask, Corner, Feed, Ratios};
use testing::{Seed, count};

/// A stop takes no longer than this, in cycles: bends leave little to it, and in single block the law in hand
/// comes to its cruise before.
const MOST_STOP: u64 = 400;

/// A tenth of a wave in uneven chords, with another feed now and then.
fn bends(case: u64) -> Vec<Line> {
    let mut random = Seed::of_case(case);
    let points = wave(&mut random, 0.4, 4.0);
    let mut blocks = through(&points[..points.len() / 10], Feed::PerSecond(FEED), Corner::Blend(0.01));
    let mut feed = FEED;
    for block in &mut blocks {
        if random.chance(0.2) {
            feed = random.scale(0.3 * FEED, FEED);
        }
        block.feed = Feed::PerSecond(feed);
    }
    blocks
}

#[test]
fn every_request_at_every_cycle_of_uneven_bends() {
    for case in 0..count("PITCHLOCK_PROGRAMS", 300) / 100 {
        let blocks = bends(case);
        let path = Rounded::new(&blocks);
        let mut at = Stand::new(&blocks);
        loop {
            requests().iter().for_each(|request| asked(&at, &path, request, MOST_STOP));
            if !tick(&mut at, &path, &ask()) {
                break;
            }
        }
        at.ends();
    }
}

/// A sender of few blocks a cycle, and a ratio that no block goes by, which changes in every cycle.
#[test]
fn planned_again_in_every_cycle_it_is_as_fast() {
    for case in 100..140 {
        let blocks = bends(case);
        let path = Rounded::new(&blocks);
        let mut plan = Stand::new(&blocks);
        plan.run(&ask());
        for pace in [1, 3, 2000] {
            let mut stand = Stand::new(&blocks);
            stand.pace = pace;
            let mut turns = 1.0;
            while tick(&mut stand, &path, &Ask { ratios: Ratios { turns, ..ask().ratios }, ..ask() }) {
                turns = 1.0 + (turns + 0.618) % 1.0;
            }
            stand.ends();
            // Blocks that arrive one by one let the machine wait until it knows some of them.
            let late = blocks.len() as u64 / pace as u64 + 1;
            let (took, planned) = (stand.ticks(), plan.ticks());
            assert!(took <= planned + planned / 100 + late, "{took} cycles, not {planned}: {case}, {pace}");
        }
    }
}

/// Twice half the feed is nearly the feed: what is joined beforehand must not take it from who asks later.
#[test]
fn an_override_is_as_fast_as_the_same_feed_programmed() {
    let mut sums = [0, 0];
    for case in 200..240 {
        let blocks = bends(case);
        let halves = |block: &Line| {
            let Feed::PerSecond(feed) = block.feed else { return *block };
            Line { feed: Feed::PerSecond(0.5 * feed), ..*block }
        };
        let slow: Vec<Line> = blocks.iter().map(halves).collect();
        let took = |blocks: &[Line], feed: f64| {
            let mut stand = Stand::new(blocks);
            stand.run(&Ask { ratios: Ratios { feed, ..ask().ratios }, ..ask() });
            stand.ends();
            stand.ticks()
        };
        let (programmed, asked) = (took(&blocks, 1.0), took(&slow, 2.0));
        assert!(asked <= programmed + programmed / 20, "{asked} cycles, not {programmed}: {case}");
        sums = [sums[0] + asked, sums[1] + programmed];
    }
    assert!(sums[0] <= sums[1] + sums[1] / 200, "{sums:?}");
}
