//! Random blocks and changes of speed over wide limits: within them, never backwards, ends exact, nothing
//! that is not a number. `PITCHLOCK_BLOCKS` says how many.

use motion::{FeedBlock, Limits, Sample, SpeedChange};
use testing::{Seed, count};

/// Relative error that a limit may be exceeded by.
const ACCURACY: f64 = 1e-6;
/// A thousandth of the count in which positions are sent.
const ROUNDING_MM: f64 = 1e-12;
const SAMPLES: u32 = 16;

fn limits(random: &mut Seed) -> Limits {
    Limits {
        v: random.scale(0.1, 2e3),
        a: random.scale(1.0, 1e5),
        j: random.scale(10.0, 1e7),
        dj: random.scale(1e2, 1e10),
    }
}

/// A share of a limit: none, all and nearly all are as good as any.
fn share(random: &mut Seed) -> f64 {
    match random.next() % 8 {
        0 => 0.0,
        1 => 1.0,
        2 => 1.0 - random.scale(1e-12, 1e-3),
        3 => random.scale(1e-9, 1e-2),
        _ => random.unit(),
    }
}

fn within(got: &Limits, limits: &Limits) -> bool {
    let kept = |got: f64, most: f64| got.abs() <= most * (1.0 + ACCURACY);
    kept(got.v, limits.v) && kept(got.a, limits.a) && kept(got.j, limits.j) && kept(got.dj, limits.dj)
}

/// Samples from 0 to `duration`: forwards, within the limits. `way` is that of the whole law.
fn goes(duration: f64, way: f64, limits: &Limits, law: impl Fn(f64) -> Sample) {
    let mut last = 0.0;
    let rounding = 1e-12 * way.abs() + ROUNDING_MM;
    for k in 0..=SAMPLES {
        let Sample { s, v, a, j, dj } = law(duration * f64::from(k) / f64::from(SAMPLES));
        assert!([s, v, a, j, dj].iter().all(|x| x.is_finite()), "not a number");
        assert!(within(&Limits { v, a, j, dj }, limits), "sample {k}: {v} {a} {j} {dj} over {limits:?}");
        assert!(v >= -1e-11 * limits.v, "backwards at {v}");
        assert!(s >= last - rounding && s <= way + rounding, "from {last} to {s} of {way} in {duration} s");
        last = s;
    }
}

/// A block of some length, if there is one with these feeds.
fn block(random: &mut Seed, limits: &Limits) -> Option<FeedBlock> {
    let length = random.scale(1e-6, 1e4);
    let f = limits.v * random.scale(1e-4, 1.0);
    let (f0, f_end) = (f * share(random), f * share(random));
    let block = FeedBlock::plan(length, f0, f, f_end, limits).ok()?;
    assert!(within(&block.peak(), limits) && block.peak_feed() <= f, "{:?} over {limits:?}", block.peak());
    let (start, end) = (block.at(0.0), block.at(block.duration()));
    assert_eq!(start, Sample::uniform(0.0, f0));
    assert_eq!(end, Sample::uniform(length, f_end));
    // What its parts make of it, not only what is said to be the end.
    let made = block.accel_length() + block.peak_feed() * block.cruise_time() + block.decel_length();
    assert!((made - length).abs() <= 1e-11 * length, "{made} mm of {length}");
    goes(block.duration(), length, limits, |t| block.at(t));
    Some(block)
}

/// A state of the block without jerk: within the constant acceleration of one of its ramps, or where both
/// pulses of it meet. Taken from the ramp: hours of cruise would round the moment.
fn settled(random: &mut Seed, block: &FeedBlock) -> Sample {
    let speeds_up = random.chance(0.5);
    let ramp = if speeds_up { block.accel() } else { block.decel() };
    let t1 = ramp.jerk_interval();
    let state = ramp.at(t1 + random.unit() * (ramp.duration() - 2.0 * t1).max(0.0));
    let (from, sign) = if speeds_up { (block.at(0.0).v, 1.0) } else { (block.end_feed(), -1.0) };
    Sample { v: from + state.v, a: sign * state.a, ..Sample::default() }
}

/// Peaks of acceleration, jerk and jerk rate do not come together (M181): bends are allowed to count on it.
fn apart(random: &mut Seed, duration: f64, limits: &Limits, at: impl Fn(f64) -> Sample) {
    for _ in 0..10 {
        let now = at(duration * random.unit());
        let [a, j, rate] = [now.a / limits.a, now.j / limits.j, now.dj / limits.dj].map(f64::abs);
        let eta = 0.8 * random.unit();
        assert!(eta * a + (1.0 - 0.66 * eta) * j <= 1.0 + ACCURACY, "{eta} of {now:?} over {limits:?}");
        let (eta, zeta) = (0.7 * random.unit(), 0.4 * random.unit());
        let sum = eta * a + zeta * j + (1.0 - 0.93 * eta - 0.57 * zeta) * rate;
        assert!(sum <= 1.0 + ACCURACY, "{eta}, {zeta} of {now:?} over {limits:?}");
    }
}

/// What remains of an acceleration if it is only led back, mm/s: half of it times its pulse (M63).
fn release(a: f64, limits: &Limits) -> f64 {
    let a_pos = a.abs();
    0.5 * a * (2.0 * a_pos / limits.j).max((std::f64::consts::TAU * a_pos / limits.dj).sqrt())
}

/// A change of speed from a state that a block has left behind, and another that takes over from it. The
/// target is one that a chain asks for: beyond what is left of a braking the speed would swing through 0, so
/// there is none there.
fn change(random: &mut Seed, block: &FeedBlock, limits: &Limits) {
    let mut now = settled(random, block);
    for _ in 0..2 {
        let top = if now.a < 0.0 { (now.v + release(now.a, limits)).max(0.0) } else { limits.v };
        let target = top * share(random);
        let change = SpeedChange::plan(now.v, now.a, target, limits);
        // While an acceleration is turned into braking the speed goes on rising: the chain looks at the top
        // of it.
        let peak = change.peak();
        let most = Limits { v: limits.v.max(change.at(change.top()).v), ..*limits };
        assert!(within(&peak, &most), "{peak:?} over {limits:?} from {now:?} to {target}");
        let swings = now.a > 0.0 && target < now.v + release(now.a, limits);
        assert!(most.v <= limits.v * (1.0 + ACCURACY) || swings, "{now:?} to {target} over {limits:?}");
        let (start, end) = (change.at(0.0), change.at(change.duration()));
        assert_eq!((start.s, start.v, start.a), (0.0, now.v, now.a), "start");
        assert_eq!(end, Sample::uniform(change.distance(), target), "end");
        let before = change.at(change.duration() * (1.0 - 1e-15));
        assert!((before.v - target).abs() <= 1e-9 * limits.v, "{before:?} before the end at {target}");
        goes(change.duration(), change.distance(), &most, |t| change.at(t));
        apart(random, change.duration(), limits, |t| change.at(t));
        now = change.at(change.settled(change.duration() * random.unit()));
        if now.v > limits.v {
            break;
        }
    }
}

#[test]
fn random_blocks_and_changes_keep_every_limit_and_reach_their_targets() {
    let mut random = Seed::of_case(7);
    let (all, mut planned, mut refused) = (count("PITCHLOCK_BLOCKS", 100_000), 0, 0);
    while planned < all {
        let limits = limits(&mut random);
        if let Some(block) = block(&mut random, &limits) {
            planned += 1;
            apart(&mut random, block.duration(), &limits, |t| block.at(t));
            change(&mut random, &block, &limits);
        } else {
            refused += 1;
            assert!(refused < 2 * all, "only {planned} can be planned");
        }
    }
}
