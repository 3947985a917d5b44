//! A stop at a corner where the next law begins before the last one has ended (M194): whatever is asked for
//! at whatever cycle around it, the limits hold, the machine stays within the tolerance and comes to its end.

use crate::programs::{Line, through};
use crate::rounded::{Rounded, distance};
use crate::stand::{Stand, ask};
use motion::Limits;
use motion::chain::{Ask, Corner, Feed, Ratios};
use testing::Seed;

/// Cycles around the corner: the whole of both pulses of jerk.
const AROUND: u64 = 30;
/// A stop takes no longer than this, in cycles.
const MOST_STOP: u64 = 150;
const TOLERANCE: f64 = 0.01;
/// mm/s.
pub(crate) const FEED: f64 = 100.0;

/// Corners of 45° to 110°, and a line that is shorter than an overlap.
fn contour() -> Vec<Line> {
    let points = [
        [0.0, 0.0, 0.0],
        [2.0, 0.0, 0.0],
        [2.0, 3.0, 0.0],
        [3.5, 4.5, 0.0],
        [3.51, 3.95, 1.0],
        [3.55, 3.95, 1.0],
        [0.0, 0.0, 0.0],
    ];
    through(&points, Feed::PerSecond(FEED), Corner::Blend(TOLERANCE))
}

/// How far the axes are beside the place that the way on their block says, mm.
fn led(stand: &Stand, path: &Rounded) -> f64 {
    let seen = stand.last.expect("a tick");
    let right = path.at(seen.step.tag.number, seen.step.along.s);
    distance(&right, &seen.axes.map(|axis| axis.s))
}

pub(crate) fn tick(stand: &mut Stand, path: &Rounded, ask: &Ask) -> bool {
    let goes_on = stand.tick(ask);
    if let Some(seen) = &stand.last {
        path.holds(seen);
    }
    goes_on
}

/// The first cycles of all overlaps of an undisturbed run, and how many cycles that takes.
fn overlaps(blocks: &[Line], path: &Rounded) -> (Vec<u64>, u64) {
    let mut stand = Stand::new(blocks);
    let (mut first, mut before) = (Vec::new(), false);
    while tick(&mut stand, path, &ask()) {
        let now = led(&stand, path) > 1e-9;
        let step = stand.last.as_ref().expect("a tick").step;
        // Its law leads the axes yet, so the block before is not completed.
        let last = step.last.map(|block| block.number + 1);
        assert!(last.is_none_or(|next| next == step.tag.number) && now <= last.is_some(), "{step:?}");
        if now && !before {
            first.push(stand.ticks());
        }
        before = now;
    }
    stand.ends();
    (first, stand.ticks())
}

/// What an operator may ask for.
pub(crate) fn requests() -> [Ask; 5] {
    let ratio = |feed: f64| Ask { ratios: Ratios { feed, ..ask().ratios }, ..ask() };
    [Ask { hold: true, ..ask() }, ratio(0.0), ratio(0.2), ratio(1.7), Ask { single: true, ..ask() }]
}

/// A request from a cycle on: the machine stops in so many cycles if that asks for it, or at the end. It is
/// taken back for a moment, asked for again, and taken back: the machine comes to its end, and is never
/// faster than it was asked to be, on blocks of [`FEED`] at most.
pub(crate) fn asked(at: &Stand, path: &Rounded, request: &Ask, most_stop: u64) {
    let mut stand = at.clone();
    let most = FEED * request.ratios.feed.max(1.0) * (1.0 + 1e-6);
    let tick = |stand: &mut Stand, ask: &Ask| {
        let goes_on = tick(stand, path, ask);
        assert!(stand.speed() <= most, "{} mm/s after {request:?} at {}", stand.speed(), at.ticks());
        goes_on
    };
    let stops = request.hold || request.single || request.ratios.feed == 0.0;
    let mut stood = false;
    for _ in 0..most_stop {
        if !tick(&mut stand, request) {
            stood = true;
            break;
        }
        stood |= stand.speed() == 0.0 && led(&stand, path) <= 1e-9;
        // At the end of a block it goes on when the key is pressed again.
        if request.single && stood {
            break;
        }
    }
    assert!(stood || !stops, "{request:?} at {} does not stop", at.ticks());
    for again in [&ask(), request, &ask()] {
        (0..5).for_each(|_| _ = tick(&mut stand, again));
    }
    while tick(&mut stand, &ask()) {}
    stand.ends();
}

#[test]
fn every_request_at_every_cycle_around_an_overlap() {
    let blocks = contour();
    let path = Rounded::new(&blocks);
    let (moments, free) = overlaps(&blocks, &path);
    assert!(moments.len() >= 3, "overlaps at {moments:?}");
    for around in moments {
        let mut at = Stand::new(&blocks);
        while at.ticks() + AROUND < around {
            tick(&mut at, &path, &ask());
        }
        while at.ticks() < around + AROUND && at.ticks() + 2 < free {
            requests().iter().for_each(|request| asked(&at, &path, request, MOST_STOP));
            tick(&mut at, &path, &ask());
        }
    }
}

/// On lines that leave room for it: what still speeds up when somebody asks for less gets no faster by that.
#[test]
fn who_asks_for_less_makes_it_no_faster() {
    let points = [[0.0, 0.0, 0.0], [30.0, 0.0, 0.0], [30.0, 20.0, 0.0]];
    let blocks = through(&points, Feed::PerSecond(FEED), Corner::Blend(TOLERANCE));
    let path = Rounded::new(&blocks);
    let mut at = Stand::new(&blocks);
    loop {
        requests()
            .iter()
            .filter(|request| !request.single)
            .for_each(|request| asked(&at, &path, request, MOST_STOP));
        if !tick(&mut at, &path, &ask()) {
            break;
        }
    }
}

/// Blocks that arrive late: one for a stop after another, at every cycle.
#[test]
fn blocks_that_arrive_around_the_stop() {
    let blocks = contour();
    let path = Rounded::new(&blocks);
    for every in 1..120 {
        let mut stand = Stand::new(&blocks);
        (stand.pace, stand.every) = (1, every);
        while tick(&mut stand, &path, &ask()) {}
        stand.ends();
    }
}

/// Where the contour must be met the laws wait for each other.
#[test]
fn exact_stops_do_not_overlap() {
    for corner in [Corner::Stop, Corner::Exact(5e-4)] {
        let blocks: Vec<Line> = contour().into_iter().map(|line| Line { corner, ..line }).collect();
        let (moments, exact) = overlaps(&blocks, &Rounded::new(&blocks));
        assert!(moments.is_empty(), "{moments:?}");
        let blended = contour();
        let (moments, free) = overlaps(&blended, &Rounded::new(&blended));
        assert!(free + 8 * moments.len() as u64 <= exact, "{free} cycles instead of {exact}, {moments:?}");
    }
}

/// Moves that are over within a cycle or two, and another override in every other cycle: a law may be left
/// for another one in the very cycle in which it comes to its stop.
#[test]
fn moves_of_a_cycle_with_overrides_in_between() {
    const FAST: Limits = Limits { v: 300.0, a: 9000.0, j: 1e6, dj: 1e8 };
    let mut stops = 0;
    for case in 0..60 {
        let mut random = Seed::of_case(case);
        let mut at = [0.0; 3];
        let points: Vec<[f64; 3]> = (0..60)
            .map(|k| {
                at[k % 2] += random.scale(1e-3, 0.2) * if random.chance(0.5) { 1.0 } else { -1.0 };
                at
            })
            .collect();
        let blocks = through(&points, Feed::PerSecond(FEED), Corner::Blend(TOLERANCE));
        let mut stand = Stand::of(&blocks, [FAST; 3], random.scale(5e-4, 8e-3));
        let mut asked = ask();
        while stand.tick(&asked) {
            stops += u32::from(stand.speed() == 0.0);
            if random.chance(0.5) {
                asked.ratios.feed = random.scale(0.02, 2.0);
            }
        }
        stand.ends();
    }
    assert!(stops > 0, "nobody stops");
}
