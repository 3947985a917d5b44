//! Setpoints in, motion between them out.

use motion::FeedBlock;
use protocol::{Cycle, Position, Setpoint};
use regulator::stream::Stream;

const T: f64 = 0.0005;

fn node(cycle: u64, mm: f64, v: f64, a: f64) -> Setpoint {
    Setpoint { cycle: Cycle(cycle), position: Position::from_mm(mm), velocity_mm_s: v, acceleration_mm_s2: a }
}

#[test]
fn follows_a_profile_between_its_nodes() {
    let limits = motion::Limits { v: 150.0, a: 2000.0, j: 80_000.0, dj: 8e6 };
    let block = FeedBlock::plan(20.0, 0.0, 100.0, 0.0, &limits).expect("a plan");
    let mut stream = Stream::new(T);
    stream.rest_at(Position(0), Cycle(0));
    let at = |cycle: u64| block.at((cycle as f64 - 4.0) * T);
    let (mut worst_s, mut worst_v, mut worst_a) = (0.0_f64, 0.0_f64, 0.0_f64);
    for tick in 1..200_u64 {
        let ahead = at(4 * tick + 4);
        assert!(stream.push(node(4 * tick + 4, ahead.s, ahead.v, ahead.a), 0.0));
        for sub in 0..4 {
            let cycle = 4 * tick + sub - 4;
            let (got, want) = (stream.at(Cycle(cycle), 2.5), block.at((cycle as f64 - 1.5) * T));
            worst_s = worst_s.max((got.s - want.s).abs());
            worst_v = worst_v.max((got.v - want.v).abs());
            worst_a = worst_a.max((got.a - want.a).abs());
        }
    }
    assert!(worst_s < 1e-5 && worst_v < 0.05 && worst_a < 30.0, "{worst_s} {worst_v} {worst_a}");
}

#[test]
fn holds_before_the_first_and_after_the_last() {
    let mut stream = Stream::new(T);
    stream.rest_at(Position::from_mm(5.0), Cycle(10));
    assert_eq!(stream.at(Cycle(0), 0.0).s, 5.0);
    assert!(stream.push(node(14, 6.0, 0.0, 0.0), 0.0));
    assert_eq!(stream.at(Cycle(14), 0.0).s, 6.0);
    let after = stream.at(Cycle(100), 0.0);
    assert_eq!((after.s, after.v, after.a), (6.0, 0.0, 0.0));
    assert!(!stream.starved(Cycle(100)));
}

#[test]
fn refuses_the_past_and_sees_starvation() {
    let mut stream = Stream::new(T);
    stream.rest_at(Position(0), Cycle(8));
    assert!(!stream.push(node(8, 1.0, 0.0, 0.0), 0.0));
    assert!(stream.push(node(12, 0.1, 10.0, 0.0), 0.0));
    assert!(!stream.starved(Cycle(12)));
    assert!(stream.starved(Cycle(13)));
}

#[test]
fn a_lead_that_reaches_the_last_setpoint_sees_the_motion_that_leads_there() {
    let limits = motion::Limits { v: 150.0, a: 2000.0, j: 80_000.0, dj: 8e6 };
    let block = FeedBlock::plan(20.0, 0.0, 100.0, 0.0, &limits).expect("a plan");
    let mut stream = Stream::new(T);
    stream.rest_at(Position(0), Cycle(0));
    let mut worst = 0.0_f64;
    for tick in 1..200_u64 {
        let ahead = block.at((2 * tick) as f64 * T);
        let stop_s = motion::Exit::stop_s(ahead.v, ahead.a, &limits);
        assert!(stream.push(node(2 * tick, ahead.s, ahead.v, ahead.a), stop_s));
        // Some leads are rounded beyond it.
        for beyond in [0.0, 1e-12, 1e-9] {
            worst = worst.max((stream.at(Cycle(2 * tick - 2), 2.0 + beyond).j - ahead.j).abs());
        }
    }
    assert!(worst < 0.1 * limits.j, "jerk off by {worst}");
}
