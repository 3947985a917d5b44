//! Ways out from the states of a pass, and from any other.

use super::*;
use crate::{PassLaw, Window};

const LIMITS: Limits = Limits { v: 150.0, a: 2000.0, j: 80_000.0, dj: 8.0e6 };

/// Every state of a pass at its design speed, and at less.
fn states() -> impl Iterator<Item = Sample> {
    let helix = |lead| {
        let run_in = Window { c: 200.0, dc: 250.0, lambda: 0.5 };
        let brake = Window { c: 2000.0, dc: 250.0, lambda: 0.5 };
        PassLaw::new(300.0).with_lead(lead, run_in, brake)
    };
    let stroke = |law: PassLaw| law.with_approach(-3.0, 200.0, 260.0).with_retract(3.0, 2000.0, 260.0);
    let laws = [PassLaw::new(300.0), helix(-0.3)].map(stroke);
    let ratios = [0.1, 0.5, 1.0, 1.1];
    laws.into_iter().flat_map(move |law| {
        ratios
            .into_iter()
            .flat_map(move |r| (0..2400).map(move |c| law.at(f64::from(c)).driven([r, 0.0, 0.0, 0.0])))
    })
}

#[test]
fn a_way_out_begins_as_the_axis_moves_and_ends_at_rest() {
    for from in states() {
        for exit in [Exit::to(&from, 1.0, &LIMITS), Exit::stop(&from, &LIMITS)] {
            let (first, last) = (exit.at(0.0), exit.at(exit.duration() * (1.0 - 1e-12)));
            let close = |a: f64, b: f64, scale: f64| (a - b).abs() <= 1e-9 * scale;
            assert!(close(first.s, from.s, 1.0) && close(first.v, from.v, 1e2), "{from:?}: {first:?}");
            assert!(close(first.a, from.a, 1e4), "{from:?}: {first:?}");
            assert!(close(last.s, exit.end(), 10.0) && close(last.v, 0.0, 1e3), "{from:?}: {last:?}");
            assert!(close(last.a, 0.0, 1e5), "{from:?}: {last:?}");
        }
    }
}

#[test]
fn a_way_out_of_any_moment_of_a_pass_keeps_the_limits() {
    let mut longest = 0.0f64;
    for from in states() {
        for exit in [Exit::to(&from, 1.0, &LIMITS), Exit::stop(&from, &LIMITS)] {
            longest = longest.max(exit.duration());
            for look in 0..=997 {
                let at = exit.at(exit.duration() * f64::from(look) / 997.0);
                assert!(at.v.abs() <= LIMITS.v && at.a.abs() <= LIMITS.a * 1.001, "{from:?}: {at:?}");
                assert!(at.j.abs() <= LIMITS.j.max(from.j.abs()) * 1.01, "{from:?}: {at:?}");
            }
        }
    }
    assert!(longest < 0.25, "{longest} s");
}

/// A little speed, acceleration and jerk at the beginning of a long way, and a lot of each.
#[test]
fn a_long_way_keeps_the_limits_whatever_it_begins_with() {
    let slow = Limits { v: 60.0, ..LIMITS };
    for limits in [LIMITS, slow] {
        for case in 0..6 * 5 * 5 * 5 {
            let part = |share: u32, most: f64| most * (f64::from(case / share % 5) - 2.0) / 2.0;
            let way = [0.1, 1.0, 10.0, 50.0, 84.0, -300.0][case as usize / 125];
            // Braked as hard as may be, it stays below the highest speed.
            let from = Sample {
                v: part(1, 0.3 * limits.v),
                a: part(5, 900.0),
                j: part(25, 60_000.0),
                ..Sample::default()
            };
            for small in [1.0, 0.01] {
                let from = Sample { v: small * from.v, a: small * from.a, j: small * from.j, ..from };
                let exit = Exit::to(&from, way, &limits);
                assert_eq!(exit.at(exit.duration() + 1.0).s, way);
                for look in 0..=997 {
                    let at = exit.at(exit.duration() * f64::from(look) / 997.0);
                    assert!(
                        at.v.abs() <= limits.v && at.a.abs() <= limits.a * 1.02,
                        "{way} mm from {from:?}: {at:?}"
                    );
                    assert!(at.j.abs() <= limits.j * 1.05, "{way} mm from {from:?}: {at:?}");
                }
            }
        }
    }
}

#[test]
fn by_rest_it_goes_no_farther_than_to_rest() {
    for from in states() {
        let (stop, exit) = (Exit::stop(&from, &LIMITS), Exit::by_rest(&from, 1.0, &LIMITS));
        assert!(exit.farthest(-1.0) >= stop.farthest(-1.0).min(1.0) - 1e-9, "{from:?}");
        let [before, behind] = [-1e-9, 1e-9].map(|t| exit.at(stop.duration() + t));
        assert!((before.s - behind.s).abs() < 1e-6 && (before.v - behind.v).abs() < 1e-3, "{from:?}");
    }
}

#[test]
fn from_rest_it_is_hardly_longer_than_a_stroke() {
    for mm in [0.01, 0.5, 2.0, 20.0] {
        let exit = Exit::to(&Sample::default(), mm, &LIMITS);
        let stroke = crate::Stroke::shortest(mm, &Limits { dj: f64::INFINITY, ..LIMITS });
        assert!(
            exit.duration() <= 1.06 * stroke.max(2.0 * mm / 150.0 * 1.1),
            "{mm} mm: {} s against {stroke} s",
            exit.duration()
        );
    }
}

#[test]
fn on_the_tangent_speed_and_acceleration_keep_their_limits() {
    // Every state from which a motion within the limits can be: braked as hard as may be, it stops short
    // of the highest speed.
    for v in -30..=30 {
        for a in -20..=20 {
            let (v, a) = (5.0 * f64::from(v), 100.0 * f64::from(a));
            if (v + 0.5 * a * a.abs() / LIMITS.j).abs() > LIMITS.v {
                continue;
            }
            let from = Sample { v, a, ..Sample::default() };
            let exit = Exit::stop_in(&from, 1.1 * Exit::stop_s(v, a, &LIMITS));
            for look in 0..=500 {
                let at = exit.at(exit.duration() * f64::from(look) / 500.0);
                assert!(at.v.abs() <= 1.02 * LIMITS.v, "{from:?}: {at:?}");
                assert!(at.a.abs() <= LIMITS.a.max(a.abs()) * 1.001, "{from:?}: {at:?}");
                assert!(at.j.abs() <= 2.0 * LIMITS.j, "{from:?}: {at:?}");
            }
        }
    }
}

#[test]
fn who_is_there_already_stays() {
    let exit = Exit::to(&Sample { s: 3.0, ..Sample::default() }, 3.0, &LIMITS);
    assert_eq!((exit.duration(), exit.at(0.0).s), (0.0, 3.0));
    let stop = Exit::stop_in(&Sample { s: 3.0, ..Sample::default() }, 0.0);
    assert_eq!((stop.end(), stop.at(0.1).s), (3.0, 3.0));
}

#[test]
fn an_axis_that_brakes_hard_does_not_turn_round_on_its_way_to_rest() {
    for (v, a) in [(87.0, -9900.0), (-15.0, 3100.0), (5.9, -2124.0), (0.01, -1500.0)] {
        let from = Sample { s: 3.0, v, a, j: 1e6, ..Sample::default() };
        let exit = Exit::stop(&from, &LIMITS);
        let looks = (0..=1000).map(|i| exit.at(exit.duration() * f64::from(i) / 1000.0));
        assert!((exit.end() - 3.0 - 0.8 * v * v / a.abs() * v.signum()).abs() < 1e-9, "{v}, {a}");
        for at in looks {
            assert!(at.v * v >= -1e-9 && at.a.abs() <= a.abs() * (1.0 + 1e-9), "{v}, {a}: {at:?}");
        }
    }
}

/// As an axis on the helix of a spindle that has run away has it where its brake begins.
#[test]
fn a_jerk_beyond_every_limit_is_not_taken_over() {
    for j in [1e6, -1e6, 1e8] {
        let from = Sample { v: -95.0, a: 28.0, j, ..Sample::default() };
        let exit = Exit::stop(&from, &LIMITS);
        for i in 0..=1000 {
            let at = exit.at(exit.duration() * f64::from(i) / 1000.0);
            assert!(at.v < 5.0 && at.v > -LIMITS.v && at.a.abs() < 1.02 * LIMITS.a, "{j}: {at:?}");
        }
    }
}
