//! Feed hold: it stops the machine on its path, within the way that the limits allow, and what follows is the
//! same part.

use crate::programs::{N, program, through};
use crate::rounded::{Rounded, distance};
use crate::stand::{AXES, CYCLE_S, Stand, ask};
use motion::chain::{Ask, Corner, Feed, LEAST_FEED, Ratios};
use motion::{Limits, Path, junction_distance};
use testing::Seed;

/// A stop takes no longer than this, in cycles: 1 s.
const MOST_STOP: u64 = 500;

/// A run that stays on its path.
fn run(stand: &mut Stand, path: &Rounded, ask: &Ask, mut goes_on: impl FnMut(&Stand) -> bool) -> bool {
    while goes_on(stand) {
        if !stand.tick(ask) {
            return false;
        }
        if let Some(seen) = &stand.last {
            path.holds(seen);
        }
    }
    true
}

#[test]
fn a_hundred_holds_leave_the_machine_on_its_path() {
    for number in 0..100 {
        let mut random = Seed::of_case(1000 + number / 10);
        let blocks = program(&mut random);
        let path = Rounded::new(&blocks);
        let mut free = Stand::new(&blocks);
        run(&mut free, &path, &ask(), |_| true);
        let mut moments = Seed::of_case(2000 + number);
        let moment = moments.next() % free.ticks();

        let mut held = Stand::new(&blocks);
        run(&mut held, &path, &ask(), |stand| stand.ticks() < moment);
        let hold = Ask { hold: true, ..ask() };
        // Every third hold is taken back while the machine still brakes.
        let patience = if number % 3 == 0 { moments.next() % 60 } else { MOST_STOP };
        run(&mut held, &path, &hold, |stand| {
            stand.ticks() < moment + patience && (stand.speed() > 0.0 || stand.ticks() < moment + 10)
        });
        if patience == MOST_STOP {
            assert_eq!(held.speed(), 0.0, "hold {number} does not stop");
            let (before, still) = (held.last, held.ticks() + 20);
            run(&mut held, &path, &hold, |stand| stand.ticks() < still);
            let [from, to] = [before, held.last].map(|seen| seen.expect("a tick").axes.map(|axis| axis.s));
            assert!(distance(&from, &to) <= 1e-12, "hold {number} does not stand");
        }
        run(&mut held, &path, &ask(), |_| true);
        free.ends();
        held.ends();
        assert!(held.ticks() + 1 >= free.ticks(), "hold {number} made the program faster");
    }
}

/// Way from the moment at which a hold is asked for at cruise to rest, and the speed it began with.
fn stop(points: &[[f64; N]], corner: Corner, after: u64) -> (f64, f64) {
    let blocks = through(points, Feed::Rapid, corner);
    let mut stand = Stand::new(&blocks);
    while stand.ticks() < after {
        assert!(stand.tick(&ask()), "the program is over");
    }
    let seen = stand.last.expect("a tick");
    assert_eq!((seen.step.along.a, seen.step.along.j), (0.0, 0.0), "not at cruise");
    let hold = Ask { hold: true, ..ask() };
    let mut cycles = 0;
    while stand.speed() > 0.0 {
        assert!(stand.tick(&hold));
        cycles += 1;
        assert!(cycles < MOST_STOP, "does not stop");
    }
    let [from, to] = [seen, stand.last.expect("a tick")].map(|seen| seen.axes.map(|axis| axis.s));
    (distance(&from, &to), seen.step.along.v)
}

#[test]
fn a_hold_from_full_rapid_stops_as_soon_as_the_limits_allow() {
    let ways = [[900.0, 0.0, 0.0], [0.0, 900.0, 0.0], [500.0, -300.0, 100.0]];
    for way in ways {
        let limits: Limits = Path::line(way, &[true; N]).expect("a way").limits(&AXES);
        // One long block, and many short ones in a row.
        for (parts, corner) in [(1, Corner::Stop), (1800, Corner::Blend(0.01)), (1800, Corner::Exact(1e-3))] {
            let points: Vec<[f64; N]> =
                (0..=parts).map(|k| way.map(|w| w * f64::from(k) / f64::from(parts))).collect();
            let (made, v) = stop(&points, corner, 800);
            assert!((v - limits.v).abs() <= 1e-9 * v, "{v} is not full rapid");
            let least = junction_distance(0.0, v, &limits);
            assert!(made <= least + v * CYCLE_S, "{made} mm instead of {least}, {parts} parts of {way:?}");
            assert!(made >= least * (1.0 - 1e-6), "{made} mm cannot be: {least}");
        }
    }
}

/// An override that is not 0 never stops the machine for good, however slow the feed is that it leaves.
#[test]
fn the_least_feed_at_the_least_override_comes_to_its_end() {
    let blocks = through(&[[0.0; N], [0.02, 0.0, 0.0]], Feed::PerSecond(2e-3), Corner::Stop);
    let mut stand = Stand::new(&blocks);
    let least = Ask { ratios: Ratios { feed: 0.01, ..Ratios::full(0.0) }, ..ask() };
    while stand.tick(&least) {
        assert!(stand.speed() <= LEAST_FEED * (1.0 + 1e-9), "{} mm/s", stand.speed());
    }
    stand.ends();
    assert!(stand.ticks().abs_diff(10_000) < 50, "{} cycles for 20 s", stand.ticks());
}

/// A hold at the very beginning of a rapid does not let its first pulse of jerk run out.
#[test]
fn a_hold_in_the_first_pulse_turns_it_back() {
    let blocks = through(&[[0.0; N], [400.0, 0.0, 0.0]], Feed::Rapid, Corner::Stop);
    // The first half of the pulse: at 25 ms the jerk is highest.
    for moment in 1..=12 {
        let mut stand = Stand::new(&blocks);
        while stand.ticks() < moment {
            stand.tick(&ask());
        }
        let pressed = stand.last.expect("a tick").step.along;
        let mut fastest = 0.0_f64;
        while stand.ticks() < moment + MOST_STOP && (stand.speed() > 0.0 || stand.ticks() < moment + 10) {
            stand.tick(&Ask { hold: true, ..ask() });
            fastest = fastest.max(stand.speed());
        }
        // The mirror image of the pulse doubles what it has gained; leading that back takes a²/J of speed
        // more.
        let (t, a) = (moment as f64 * CYCLE_S, 2.0 * pressed.a);
        let most = a * t + a * a / AXES[0].j;
        assert!(fastest <= 1.3 * most + 1.0, "{fastest} mm/s, {most} expected, after a hold at {pressed:?}");
        assert_eq!(stand.speed(), 0.0);
        stand.run(&ask());
        stand.ends();
    }
}

/// Single block, pressed in full motion: the machine stops at the next end of a block that it can reach.
#[test]
fn single_block_stops_at_the_next_end_within_reach() {
    let points: Vec<[f64; N]> = (0..500).map(|i| [f64::from(i), 0.3 * f64::from(i % 2), 0.0]).collect();
    let blocks = through(&points, Feed::PerSecond(50.0), Corner::Blend(0.2));
    let single = Ask { single: true, ..ask() };
    for moment in [20, 300, 777, 1500] {
        let mut stand = Stand::new(&blocks);
        while stand.ticks() < moment {
            stand.tick(&ask());
        }
        let pressed = stand.last.expect("a tick").step.tag.number;
        while stand.ticks() < moment + 1000 && (stand.speed() > 0.0 || stand.ticks() < moment + 2) {
            stand.tick(&single);
        }
        let seen = stand.last.expect("a tick");
        let stopped = seen.step.tag.number;
        assert!(stand.speed() == 0.0 && stopped <= pressed + 12, "pressed in {pressed}, stops in {stopped}");
        let way = seen.step.along.s;
        let length = blocks[stopped].path.length();
        assert!(way < 1e-6 || (way - length).abs() < 1e-6, "stops {way} mm into a block of {length}");
        stand.run(&ask());
        stand.ends();
    }
}
