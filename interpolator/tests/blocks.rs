//! One move, along a line or an arc, under changing overrides: limits of every axis, the path, the end, the time.
#![allow(clippy::unwrap_used)]

use interpolator::{block::Block, pace::Step};
use proptest::prelude::*;
use protocol::{Arc, Cycle, Machine, PerAxis, Plane, Position, Setpoint, units::AXES};

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

/// An arc that starts and ends on counts of the wire, its start, and its radius.
fn arcs() -> impl Strategy<Value = (PerAxis<Position>, Arc, f64)> {
    let turns = prop_oneof![Just(1), Just(-1), Just(2), Just(-3)];
    let angle = || 0.0..std::f64::consts::TAU;
    (0.05..20.0_f64, angle(), angle(), turns).prop_map(|(r, start, end, turns)| {
        let at = |angle: f64| point(60.0 + r * libm::sin(angle), r * libm::cos(angle));
        let center = [Position(0), Position::from_mm(60.0)];
        (at(start), Arc { plane: Plane::Zx, target: at(end), center, turns }, r)
    })
}

/// X and Z of the speed, acceleration, of a node.
fn of_axes(nodes: &PerAxis<Setpoint>, of: fn(&Setpoint) -> f64) -> [f64; 2] {
    [of(&nodes[0]), of(&nodes[2])]
}

proptest! {
    /// What is streamed keeps speed, acceleration and jerk (its mean over a tick) whatever the overrides, and the radius
    /// to a count of the wire.
    #[test]
    fn nodes_of_an_arc_keep_the_limits_and_the_radius(
        (from, arc, r) in arcs(),
        feed in 5.0..200.0_f64,
        pace in prop::collection::vec(0.0..2.0_f64, 1..8),
        every in 5..60_usize,
    ) {
        let machine = Machine::default();
        let x = &machine.axis[&protocol::Axis::X];
        let mut block = Block::arc(&machine, &from, &arc, feed, 1.0).unwrap();
        let (mut ticks, mut before) = (0, [0.0; 2]);
        while !block.done() {
            let asked = pace[(ticks / every).min(pace.len() - 1)].max(if ticks > 600 { 0.3 } else { 0.0 });
            let (step, _) = block.advance(TICK, asked);
            let nodes = block.setpoints(Cycle(ticks as u64), &step);
            let acceleration = of_axes(&nodes, |node| node.acceleration_mm_s2);
            for i in 0..2 {
                prop_assert!(of_axes(&nodes, |node| node.velocity_mm_s)[i].abs() <= x.velocity_mm_s * (1.0 + 1e-6));
                prop_assert!(acceleration[i].abs() <= x.acceleration_mm_s2 * (1.0 + 1e-6));
                let jerk = (acceleration[i] - before[i]) / TICK;
                prop_assert!(jerk.abs() <= x.jerk_mm_s3 * (1.0 + 1e-6), "jerk {jerk} in tick {ticks}");
            }
            let [dz, dx] = [nodes[2].position.mm(), nodes[0].position.mm_from(Position::from_mm(60.0))];
            prop_assert!((libm::hypot(dz, dx) - r).abs() < 1.5e-9, "radius {}", libm::hypot(dz, dx));
            (ticks, before) = (ticks + 1, acceleration);
            prop_assert!(ticks < 3_000_000);
        }
        prop_assert_eq!(block.here(), arc.target);
    }

    /// At a steady pace jerk rate (the mean over two ticks) is kept, too, and speed is the slope of position.
    #[test]
    fn nodes_at_a_steady_pace_keep_the_jerk_rate((from, arc, _) in arcs(), feed in 5.0..200.0_f64) {
        let machine = Machine::default();
        let x = &machine.axis[&protocol::Axis::X];
        let mut block = Block::arc(&machine, &from, &arc, feed, 1.0).unwrap();
        let mut last = [[0.0; 2]; 2];
        let mut before = block.setpoints(Cycle(0), &Step { tau: 0.0, ratio: 1.0, ratio_rate: 0.0 });
        while !block.done() {
            let (step, _) = block.advance(TICK, 1.0);
            let nodes = block.setpoints(Cycle(0), &step);
            let acceleration = of_axes(&nodes, |node| node.acceleration_mm_s2);
            for (i, axis) in [0, 2].into_iter().enumerate() {
                let rate = (acceleration[i] - 2.0 * last[1][i] + last[0][i]) / (TICK * TICK);
                prop_assert!(rate.abs() <= x.jerk_rate_mm_s4 * (1.0 + 1e-6), "jerk rate {rate}");
                let slope = nodes[axis].position.mm_from(before[axis].position) / TICK;
                let mean = 0.5 * (nodes[axis].velocity_mm_s + before[axis].velocity_mm_s);
                prop_assert!((slope - mean).abs() <= x.jerk_mm_s3 * TICK * TICK / 12.0 + 2e-9 / TICK);
            }
            (last, before) = ([last[1], acceleration], nodes);
        }
    }
}

#[test]
fn an_arc_that_is_none_has_no_block() {
    let machine = Machine::default();
    let arc = Arc { plane: Plane::Zx, target: point(10.0, 0.0), center: [Position(0); 2], turns: 1 };
    assert!(Block::arc(&machine, &point(0.0, 10.0), &arc, 10.0, 1.0).is_ok());
    assert!(Block::arc(&machine, &point(0.0, 11.0), &arc, 10.0, 1.0).is_err());
    assert!(Block::arc(&machine, &point(0.0, 10.0), &Arc { turns: 0, ..arc }, 10.0, 1.0).is_err());
    // The smallest circle there is still has a plan.
    let smallest = Arc { plane: Plane::Zx, target: point(1e-6, 0.0), center: [Position(0); 2], turns: 1 };
    assert!(!Block::arc(&machine, &point(1e-6, 0.0), &smallest, f64::INFINITY, 1.0).unwrap().done());
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
