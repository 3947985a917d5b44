//! Random blocks (M22–M26): whatever is planned arrives, at the right feed, within its limits.

use super::draw::{keeps, limits, magnitude, magnitudes, smooth, times};
use motion::{FeedBlock, Limits, Unreachable, junction_distance, reachable_feed};
use proptest::prelude::*;

/// Length, entry, programmed and exit feed as shares of the speed limit; shares of 0 and 1 are frequent.
fn block_and_limits() -> impl Strategy<Value = (f64, f64, f64, f64, Limits)> {
    let share = || prop_oneof![Just(0.0), Just(1.0), 0.0..1.0, Just(0.999_999)];
    (magnitude(1e-6, 1e4), share(), magnitude(1e-3, 1.0), share(), limits()).prop_map(
        |(length, f0, f, f_end, limits)| {
            let f = f * limits.v;
            (length, f0 * f, f, f_end * f, limits)
        },
    )
}

/// The ends of a profile, and its samples against its own limits.
fn check_profile(block: &FeedBlock, f0: f64, f_end: f64, limits: &Limits) -> Result<(), TestCaseError> {
    let (start, end) = (block.at(0.0), block.at(block.duration()));
    prop_assert_eq!((start.s, start.v, start.a), (0.0, f0, 0.0));
    prop_assert_eq!((end.s, end.v, end.a), (block.length(), f_end, 0.0));
    prop_assert_eq!(block.at(block.duration() + 1.0).s, block.length());
    prop_assert!(keeps(&block.peak(), limits), "{:?} against {limits:?}", block.peak());
    let mut before = 0.0;
    for t in times(block.duration(), 500) {
        let sample = block.at(t);
        prop_assert!(keeps(&magnitudes(sample), &block.peak()), "at {}: {:?}", t, sample);
        prop_assert!(sample.v >= -1e-12 * block.peak_feed(), "runs backwards at {}", t);
        prop_assert!(sample.s >= before - 1e-12 * block.length(), "turns back at {}", t);
        before = sample.s;
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    fn m23_planned_block_arrives_within_its_limits((length, f0, f, f_end, limits) in block_and_limits()) {
        match FeedBlock::plan(length, f0, f, f_end, &limits) {
            Ok(block) => {
                check_profile(&block, f0, f_end, &limits)?;
                prop_assert!(block.peak_feed() <= f);
                prop_assert_eq!(block.reaches_feed(), block.peak_feed() == f);
                let made = block.accel_length() + block.peak_feed() * block.cruise_time() + block.decel_length();
                prop_assert!((made - length).abs() <= 1e-11 * length, "ways add up to {made}, not {length}");
                if !block.reaches_feed() {
                    prop_assert!(block.cruise_time() <= 1e-11 * block.duration(), "room for a higher peak is left");
                }
            }
            Err(Unreachable::EndFeed { reachable }) => {
                prop_assert!(f0 <= reachable && reachable < f_end);
                prop_assert!(FeedBlock::plan(length, f0, f, reachable, &limits).is_ok(), "the remedy itself");
            }
            Err(Unreachable::StartFeed { admissible }) => {
                prop_assert!(f_end <= admissible && admissible < f0);
                prop_assert!(FeedBlock::plan(length, admissible, f, f_end, &limits).is_ok(), "the remedy itself");
            }
            Err(Unreachable::Input { reason }) => prop_assert!(false, "{}", reason),
        }
    }

    /// Joints of the three parts: no jump in feed, acceleration or jerk. Only blocks that last: rounding of
    /// the path at 1e4 mm hides a step of a nanosecond.
    #[test]
    fn m23_block_is_smooth((length, f0, f, f_end, limits) in block_and_limits()) {
        if let Ok(block) = FeedBlock::plan(length, f0, f, f_end, &limits) {
            // One law may be much shorter than the block: compare each against the peaks of the whole.
            smooth(block.duration(), &block.peak(), |t| block.at(t.clamp(0.0, block.duration()))
                + motion::Sample::uniform(outside(t, &block), 0.0))?;
        }
    }

    #[test]
    fn m25_reversed_block_is_the_block_reversed((length, f0, f, f_end, limits) in block_and_limits(), share in 0.0..1.0) {
        let forth = FeedBlock::plan(length, f0, f, f_end, &limits);
        let back = FeedBlock::plan(length, f_end, f, f0, &limits);
        prop_assert_eq!(forth.is_ok(), back.is_ok());
        if let (Ok(forth), Ok(back)) = (forth, back) {
            let t = share * forth.duration();
            let (a, b) = (forth.at(t), back.at(back.duration() - t));
            prop_assert!((a.s + b.s - length).abs() <= 1e-10 * length);
            prop_assert!((a.v - b.v).abs() <= 1e-10 * forth.peak_feed());
        }
    }

    #[test]
    fn m24_reachable_feed_is_the_last_that_fits(
        from in magnitude(1e-3, 1e3), length in magnitude(1e-6, 1e3), limits in limits(),
    ) {
        let feed = reachable_feed(from, f64::MAX, length, &limits);
        prop_assert!(feed >= from);
        prop_assert!(junction_distance(from, feed, &limits) <= length);
        prop_assert!(junction_distance(from, feed * (1.0 + 1e-9), &limits) > length);
        prop_assert_eq!(reachable_feed(from, from, length, &limits), from);
    }

    /// A chain of blocks after a backward and a forward pass: every block has a profile, and feeds meet at
    /// the junctions.
    #[test]
    fn m26_look_ahead_leaves_only_blocks_that_can_be_planned(
        blocks in prop::collection::vec((magnitude(1e-4, 1e3), magnitude(1e-3, 1.0)), 1..20), limits in limits(),
    ) {
        let feed = |i: usize| blocks[i].1 * limits.v;
        // Feed at the entry of each block and, last, at rest.
        let mut junctions: Vec<f64> =
            (0..blocks.len()).map(|i| if i == 0 { 0.0 } else { feed(i).min(feed(i - 1)) }).collect();
        junctions.push(0.0);
        for i in (0..blocks.len()).rev() {
            junctions[i] = junctions[i].min(reachable_feed(junctions[i + 1], f64::MAX, blocks[i].0, &limits));
        }
        for i in 0..blocks.len() {
            junctions[i + 1] = junctions[i + 1].min(reachable_feed(junctions[i], f64::MAX, blocks[i].0, &limits));
        }
        for (i, &(length, _)) in blocks.iter().enumerate() {
            let planned = FeedBlock::plan(length, junctions[i], feed(i), junctions[i + 1], &limits);
            prop_assert!(planned.is_ok(), "block {}: {:?}", i, planned);
        }
    }

    /// More room never takes more feed away (the forward and backward passes rely on it).
    #[test]
    fn m26_reachable_feed_grows_with_the_length(
        from in magnitude(1e-3, 1e3), length in magnitude(1e-6, 1e3), more in 0.0..10.0, limits in limits(),
    ) {
        let shorter = reachable_feed(from, f64::MAX, length, &limits);
        prop_assert!(reachable_feed(from, f64::MAX, length * (1.0 + more), &limits) >= shorter);
    }
}

/// Way made at entry feed before the block and at exit feed after it.
fn outside(t: f64, block: &FeedBlock) -> f64 {
    let clamped = t.clamp(0.0, block.duration());
    block.at(clamped).v * (t - clamped)
}

#[test]
fn input_is_refused_with_a_reason() {
    let limits = Limits { v: 100.0, a: 500.0, j: 50_000.0, dj: 1.0e7 };
    let refused = [
        (-1.0, 0.0, 10.0, 0.0, limits, "length"),
        (f64::NAN, 0.0, 10.0, 0.0, limits, "length"),
        (1.0, 0.0, 0.0, 0.0, limits, "feed"),
        (1.0, 20.0, 10.0, 0.0, limits, "entry feed"),
        (1.0, 0.0, 10.0, 20.0, limits, "exit feed"),
        (1.0, 150.0, 200.0, 0.0, limits, "entry feed"),
        (1.0, 0.0, 10.0, -1.0, limits, "exit feed"),
        (1.0, 0.0, 10.0, 0.0, Limits { a: 0.0, ..limits }, "limit"),
        (1.0, 0.0, 10.0, 0.0, Limits { j: f64::INFINITY, dj: f64::INFINITY, ..limits }, "jerk"),
    ];
    for (length, f0, f, f_end, limits, word) in refused {
        let error = FeedBlock::plan(length, f0, f, f_end, &limits).expect_err(word);
        assert!(matches!(error, Unreachable::Input { reason } if reason.contains(word)), "{error}");
    }
}

#[test]
fn speed_limit_bounds_the_feed() {
    let limits = Limits { v: 100.0, a: 500.0, j: 50_000.0, dj: 1.0e7 };
    let block = FeedBlock::plan(1000.0, 0.0, 250.0, 0.0, &limits).expect("a long block");
    assert_eq!((block.peak_feed(), block.reaches_feed()), (100.0, true));
    let empty = FeedBlock::plan(0.0, 0.0, 10.0, 0.0, &limits).expect("no way from rest to rest");
    assert_eq!((empty.duration(), empty.at(0.0).s), (0.0, 0.0));
}
