//! The path never leaves the programmed one by more than the path mode allows.

use crate::programs::{Line, N, program};
use crate::rounded::{is_flat, nearest};
use crate::stand::{Seen, Stand, ask};
use motion::chain::{Ask, Corner, Ratios};
use testing::{Seed, count};

/// Positions are rounded to a count far above this, mm.
const ROUNDING: f64 = 1e-9;

fn allowed(block: &Line) -> f64 {
    match block.corner {
        Corner::Stop => 0.0,
        Corner::Exact(tolerance) | Corner::Blend(tolerance) => tolerance,
        Corner::Curve { flat, .. } => flat,
    }
}

/// Distance of the axes from the nearest of the block they are on and its neighbours.
fn off(blocks: &[Line], seen: &Seen) -> f64 {
    let (number, s) = (seen.step.tag.number, seen.step.along.s);
    let mut least = f64::INFINITY;
    for k in number.saturating_sub(1)..=(number + 1).min(blocks.len() - 1) {
        let Line { path, tag, .. } = &blocks[k];
        let point = std::array::from_fn(|i| seen.axes[i].s - tag.start[i]);
        // As far beyond the junction as before it.
        let guess = match k {
            k if k < number => path.length() - s,
            k if k > number => blocks[number].path.length() - s,
            _ => s,
        };
        least = least.min(nearest(path, &point, guess));
    }
    least
}

/// How far blends of corners may lead beyond the lines beside the junction behind a block: nowhere, unless
/// there is that much room beside both.
fn beyond(blocks: &[Line], k: usize) -> f64 {
    let Some([last, next]) = blocks.get(k..k + 2) else { return 0.0 };
    let tolerance = match last.corner {
        Corner::Curve { corner, .. } if !is_flat(last, next) => corner,
        _ => allowed(last),
    };
    if last.room.min(next.room) < tolerance { 0.0 } else { tolerance }
}

/// Within the boxes of the block and its neighbours, widened by the least room where one is an arc, and by
/// the tolerance where there is so much room.
fn in_its_room(blocks: &[Line], seen: &Seen) -> bool {
    let number = seen.step.tag.number;
    let near = &blocks[number.saturating_sub(1)..=(number + 1).min(blocks.len() - 1)];
    let corners = number.checked_sub(1).map_or(0.0, |k| beyond(blocks, k)).max(beyond(blocks, number));
    (0..N).all(|i| {
        let (mut low, mut high, mut room) = (f64::INFINITY, f64::NEG_INFINITY, corners);
        for block in near {
            let [least, most] = block.path.bounds();
            low = low.min(block.tag.start[i] + least[i]);
            high = high.max(block.tag.start[i] + most[i]);
            if near.iter().any(|block| !block.path.is_line()) {
                room = room.max(block.room);
            }
        }
        let at = seen.axes[i].s;
        at >= low - room - ROUNDING && at <= high + room + ROUNDING
    })
}

#[test]
fn the_path_stays_within_its_tolerance() {
    let (mut samples, mut rounded, mut widest) = (0_u64, 0_u64, 0.0_f64);
    for number in 0..count("PITCHLOCK_PROGRAMS", 300) / 10 {
        let blocks = program(&mut Seed::of_case(9000 + number));
        let mut stand = Stand::new(&blocks);
        // At a fifth of the feed the samples lie denser.
        let slow = Ask { ratios: Ratios { rapid: 0.2, feed: 0.2, turns: 2.0 }, ..ask() };
        while stand.tick(&slow) {
            let Some(seen) = &stand.last else { continue };
            let k = seen.step.tag.number;
            let before = if k > 0 { allowed(&blocks[k - 1]) } else { 0.0 };
            let most = before.max(allowed(&blocks[k]));
            let off = off(&blocks, seen);
            assert!(off <= most + ROUNDING, "program {number}: {off} mm off, {most} allowed: {seen:?}");
            assert!(in_its_room(&blocks, seen), "program {number}: beyond its room: {seen:?}");
            samples += 1;
            rounded += u64::from(off > ROUNDING);
            if most > 0.0 {
                widest = widest.max(off / most);
            }
        }
        stand.ends();
    }
    assert!(rounded * 50 > samples, "only {rounded} of {samples} samples lie beside the path");
    assert!(widest > 0.5, "at most {widest} of the tolerance is used");
}
