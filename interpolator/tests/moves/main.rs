//! Timed motion of the interpolator on an ideal machine: what the operator and the upper level do to it.

mod stand;

use protocol::{Code, Fault, Feed, Item, MachineState, Panel, PathMode, SpindleMode, SpindleSpeed};
use stand::{Stand, code, line, point};

const F: Feed = Feed::PerMinute(3000.0);

/// To the start, then a wave of short lines along Z, then home.
fn contour(count: u32) -> Vec<Item> {
    let mut items = vec![line(1, 40.0, 0.0, Feed::Rapid)];
    for i in 1..=count {
        let z = -0.2 * f64::from(i);
        items.push(line(i + 1, 40.0 + 2.0 * libm::sin(z / 10.0), z, F));
    }
    items.push(line(count + 2, 60.0, -0.2 * f64::from(count), Feed::Rapid));
    items.push(line(count + 3, 60.0, 100.0, Feed::Rapid));
    items.push(code(count + 4, Code::End));
    items
}

#[test]
fn a_contour_of_short_lines_runs_at_its_feed_and_ends_exactly() {
    let mut stand = Stand::new(contour(1000));
    let mut fastest = 0.0_f64;
    let points = stand.run(|stand, _| {
        if stand.out.is_some() && (-101.0..-100.0).contains(&stand.at()[1]) && stand.at()[0] < 42.5 {
            fastest = fastest.max((stand.speed() - 50.0).abs());
        }
    });
    assert!(fastest < 0.01, "off by {fastest} mm/s in the middle");
    assert_eq!(points.last(), Some(&[60.0, 100.0]));
    let out = stand.out.unwrap();
    assert_eq!((out.status.moves, out.status.starved, out.status.fault), (1003, 0, 0));
    // 204 mm at 50 mm/s and two rapids of about 1.9 s; rest to rest each line alone would take 0.05 s.
    assert!(points.len() < 4500, "{} ticks", points.len());
}

#[test]
fn a_stalled_upper_level_stops_the_machine_on_its_path_and_goes_on_when_fed() {
    let mut fed = Stand::new(contour(300));
    let whole = fed.run(|_, _| {});
    let mut stand = Stand::new(contour(300));
    stand.send(64);
    let mut ticks = 0;
    while !(stand.out.is_some_and(|out| out.status.starved == 1) && stand.speed() == 0.0) {
        stand.tick();
        ticks += 1;
        assert!(ticks < 10_000, "it never says that it starves");
    }
    let [x, z] = stand.at();
    // The last of the 64 items ends at Z −12.6.
    assert!((z + 12.6).abs() < 1e-9 && (x - 40.0 - 2.0 * libm::sin(z / 10.0)).abs() < 1e-9, "{x} {z}");
    let points = stand.run(|_, _| {});
    assert_eq!(points.last(), whole.last());
    assert_eq!(stand.out.unwrap().status.moves, 303);
}

#[test]
fn feed_hold_stops_at_once_and_resumes_on_the_path() {
    for moment in [300, 350, 431, 707, 1111] {
        let mut stand = Stand::new(contour(500));
        let mut held = 0;
        let points = stand.run(|stand, n| {
            stand.panel.buttons = if (moment..moment + 300).contains(&n) { Panel::FEED_HOLD } else { 0 };
            if n == moment + 299 {
                assert_eq!(stand.speed(), 0.0, "moving {n}");
                held += 1;
            }
        });
        assert_eq!((held, points.last()), (1, Some(&[60.0, 100.0])));
        for [x, z] in points.iter().filter(|[_, z]| *z < -0.5 && *z > -99.0) {
            if (x - 40.0).abs() < 2.5 {
                let off = x - 40.0 - 2.0 * libm::sin(z / 10.0);
                assert!(off.abs() < 0.011, "{off} beside the contour at Z {z}");
            }
        }
    }
}

#[test]
fn single_block_waits_for_cycle_start_after_every_move() {
    let items = [line(1, 60.0, 90.0, F), line(2, 50.0, 90.0, F), line(3, 50.0, 80.0, F), code(4, Code::End)];
    let mut stand = Stand::new(items);
    stand.panel.buttons = Panel::SINGLE_BLOCK;
    let mut stops = Vec::new();
    let mut waited = 0;
    stand.run(|stand, _| {
        if stand.out.is_some() && stand.state() == MachineState::Paused {
            waited += 1;
            if waited == 50 {
                stops.push(stand.at());
                stand.panel.cycle_starts += 1;
                waited = 0;
            }
        }
    });
    // The corners are rounded within 0.01 mm, and the stop is on the rounded path.
    for (stop, wanted) in stops.iter().zip([[60.0, 90.0], [50.0, 90.0], [50.0, 80.0]]) {
        assert!(libm::hypot(stop[0] - wanted[0], stop[1] - wanted[1]) <= 0.01 + 1e-8, "{stop:?}");
    }
    assert_eq!(stops.len(), 3);
}

#[test]
fn stop_and_abort_end_the_program_on_the_path() {
    for (button, at_once) in [(Panel::STOP, false), (Panel::ABORT, true)] {
        let mut items =
            vec![code(1, Code::Spindle { mode: SpindleMode::Clockwise, speed: SpindleSpeed::Rpm(500.0) })];
        items.extend(contour(400));
        let mut stand = Stand::new(items);
        let mut spindle_off_moving = false;
        stand.run(|stand, n| {
            if n > 700 {
                stand.panel.buttons = button;
            }
            spindle_off_moving |=
                stand.out.is_some_and(|out| n > 702 && out.spindle.rpm == 0.0) && stand.speed() > 1.0;
        });
        let status = stand.out.unwrap().status;
        assert_eq!((status.stopped, status.fault), (1, 0));
        assert_eq!(spindle_off_moving, at_once);
    }
}

#[test]
fn a_move_beyond_the_travel_faults_before_it_begins() {
    let items = [line(1, 60.0, 90.0, F), line(2, 500.0, 90.0, F), code(3, Code::End)];
    let mut stand = Stand::new(items);
    let points = stand.run(|_, _| {});
    assert_eq!(stand.out.unwrap().status.fault, Fault::TravelLimit as u32);
    assert_eq!(points.last(), Some(&[60.0, 90.0]));
}

#[test]
fn exact_stop_ends_at_every_point_and_blending_rounds_within_its_tolerance() {
    let corner = |mode: PathMode| {
        let items = [
            code(1, Code::PathMode(mode)),
            line(2, 60.0, 90.0, F),
            line(3, 50.0, 90.0, F),
            code(4, Code::End),
        ];
        let mut stand = Stand::new(items);
        let points = stand.run(|_, _| {});
        points.iter().map(|[x, z]| libm::hypot(x - 60.0, z - 90.0)).fold(f64::INFINITY, f64::min)
    };
    assert!(corner(PathMode::ExactStop) < 1e-6 && corner(PathMode::ExactPath) < 1e-6);
    let blended = corner(PathMode::Blend { tolerance_mm: 0.2, merge_mm: 0.0 });
    // Rounded, or a stop at which both laws overlap.
    assert!(blended > 0.01 && blended <= 0.2, "{blended}");
}

#[test]
fn feed_per_revolution_follows_the_spindle_without_its_noise() {
    let mut items =
        vec![code(1, Code::Spindle { mode: SpindleMode::Clockwise, speed: SpindleSpeed::Rpm(600.0) })];
    items.push(line(2, 60.0, 40.0, Feed::PerRevolution(0.5)));
    items.push(code(3, Code::End));
    let mut stand = Stand::new(items);
    let mut speeds = Vec::new();
    stand.run(|stand, _| {
        if stand.out.is_some() && (50.0..90.0).contains(&stand.at()[1]) {
            speeds.push(stand.speed());
        }
    });
    let (low, high) = speeds.iter().fold((f64::MAX, 0.0_f64), |(low, high), v| (low.min(*v), high.max(*v)));
    assert!((low - 5.0).abs() < 0.1 && high - low < 1e-9, "{low} … {high}, {} points", speeds.len());
    assert_eq!(point(1.0, 0.0)[0].mm(), 1.0);
}

#[test]
fn a_feed_holds_while_the_operator_holds_the_spindle() {
    for feed in [Feed::PerMinute(600.0), Feed::PerRevolution(0.5)] {
        let clockwise = Code::Spindle { mode: SpindleMode::Clockwise, speed: SpindleSpeed::Rpm(600.0) };
        let items = [code(1, clockwise), line(2, 60.0, 40.0, feed), code(3, Code::End)];
        let mut stand = Stand::new(items);
        let mut stood = 0;
        let points = stand.run(|stand, n| {
            let held = (1000..1800).contains(&n);
            stand.panel.spindle_override_pct = if held { 0.0 } else { 100.0 };
            stood += u32::from(held && n > 1300 && stand.speed() == 0.0);
        });
        assert!(stood > 400, "{feed:?}: stood for {stood} ticks");
        assert_eq!((points.last(), stand.out.unwrap().status.fault), (Some(&[60.0, 40.0]), 0), "{feed:?}");
    }
}
