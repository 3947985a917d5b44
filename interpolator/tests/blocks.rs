//! One move under changing overrides: limits of every axis, the end, the time.
#![allow(clippy::unwrap_used)]

use interpolator::block::Block;
use proptest::prelude::*;
use protocol::{Cycle, Machine, PerAxis, Position, units::AXES};

fn point(x: f64, z: f64) -> PerAxis<Position> {
    let mut point = [Position(0); AXES];
    (point[0], point[2]) = (Position::from_mm(x), Position::from_mm(z));
    point
}

const TICK: f64 = 0.002;

proptest! {
    #[test]
    fn nodes_keep_the_limits_and_reach_the_end_exactly(
        x in -50.0..50.0_f64,
        z in -200.0..200.0_f64,
        feed in 0.5..200.0_f64,
        pace in prop::collection::vec(0.0..2.0_f64, 1..8),
        every in 5..60_usize,
    ) {
        let machine = Machine::default();
        let (from, to) = (point(60.0, 0.0), point(60.0 + x, z));
        let Some(mut block) = Block::line(&machine, &from, &to, feed, 1.0) else { return Ok(()) };
        let mut ticks = 0;
        while !block.done() {
            let asked = pace[(ticks / every).min(pace.len() - 1)].max(if ticks > 600 { 0.3 } else { 0.0 });
            let (step, _) = block.advance(TICK, asked);
            let nodes = block.setpoints(Cycle(ticks as u64), &step);
            for (axis, config) in machine.axes() {
                let node = &nodes[axis.index()];
                prop_assert!(node.velocity_mm_s.abs() <= config.velocity_mm_s * (1.0 + 1e-9));
                prop_assert!(node.acceleration_mm_s2.abs() <= config.acceleration_mm_s2 * (1.0 + 1e-9));
            }
            ticks += 1;
            prop_assert!(ticks < 2_000_000);
        }
        prop_assert_eq!(block.here(), to);
    }
}

#[test]
fn a_move_of_no_length_is_none() {
    let machine = Machine::default();
    assert!(Block::line(&machine, &point(1.0, 2.0), &point(1.0, 2.0), 10.0, 1.0).is_none());
}

#[test]
fn a_plan_ends_on_a_tick_and_takes_hardly_longer() {
    let machine = Machine::default();
    let mut block = Block::line(&machine, &point(0.0, 0.0), &point(0.0, 30.0), 50.0, 1.0).unwrap();
    let mut ticks = 0;
    while !block.done() {
        block.advance(TICK, 1.0);
        ticks += 1;
    }
    // 30 mm at 50 mm/s, and a ramp at each end within 80 % of the limits.
    let ideal = 0.6 + 50.0 / 1600.0 + 0.05;
    assert!((f64::from(ticks) * TICK - ideal).abs() < 0.02, "{} s", f64::from(ticks) * TICK);
}

#[test]
fn what_no_program_asks_for_does_no_harm() {
    let machine = Machine::default();
    let mut elsewhere = point(1.0, 2.0);
    elsewhere[1] = Position(1);
    assert!(Block::line(&machine, &point(1.0, 2.0), &elsewhere, f64::INFINITY, 1.0).is_none());
    let slowest = Block::line(&machine, &point(1.0, 2.0), &point(1.0, 2.001), 5e-324, 1.0).unwrap();
    assert!(!slowest.done());
    assert_eq!(Position(i64::MAX).mm_from(Position(i64::MIN)), (u64::MAX as f64) / Position::PER_MM);
}
