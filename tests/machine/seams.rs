//! A seam on the four-axis positioner, in the whole machine: where the beam really meets the part, and under
//! which angle. Bounds are those the work is accepted by.
//!
//! What the observer measures by the seam of the machine code is measured once more by brute force: drives to
//! beam by M46 and M47, and the seam as one writes it down.

use std::f64::consts::TAU;

use machine::{Machine, POSITIONER};
use protocol::{Axis, Item};
use rig::observe::{Observation, Record, TraceReport};

use crate::shop;

/// Farthest that the beam may be from its seam, µm, and the direction from the beam, degrees.
const BEAM_UM: f64 = 10.0;
const ANGLE_DEG: f64 = 0.01;
const FEED_PCT: f64 = 1.0;

fn positioner() -> Machine {
    Machine::from_toml(POSITIONER).expect("the positioner is shipped")
}

/// Machine code of the branch on a pipe.
fn items() -> Vec<Item> {
    shop::items(&positioner(), &shop::project().join("examples/positioner/cylinders.toml"))
}

fn run(items: &[Item], scenario: &str, see: impl FnMut(&Record)) -> Observation {
    shop::observed(&positioner(), items, scenario, see)
}

fn is_exact<'a>(observation: &'a Observation, what: &str) -> &'a TraceReport {
    let [trace] = &observation.traces[..] else { panic!("{what}: {} traces", observation.traces.len()) };
    assert_eq!((observation.moves.limit_violations, observation.moves.starved), (0, 0), "{what}");
    assert!(trace.cut_cycles > 1000 && trace.unmeasured_cycles == 0, "{what}: {trace:#?}");
    assert!(
        trace.commanded.max_abs_um() <= 0.001 && trace.commanded.angle_max_deg <= 1e-6,
        "{what}: {trace:#?}"
    );
    assert!(trace.slide.max_abs_um() <= BEAM_UM, "{what}: {:?}", trace.slide);
    assert!(trace.slide.angle_max_deg <= ANGLE_DEG, "{what}: {:?}", trace.slide);
    // A window that a stop cuts short may end before a tick has said what is used.
    assert!(trace.feed.unexplained_s <= 0.002, "{what}: slower without a reason, {:?}", trace.feed);
    trace
}

/// Height of the middle of the pipe above the table, mm.
const MIDDLE: f64 = 50.0;

/// Where a cylinder of 40 mm along Z meets one of 60 mm along X, and the bisector of both outward normals
/// there.
fn seam(t: f64) -> ([f64; 3], [f64; 3]) {
    let (x, y) = (20.0 * libm::cos(t), 20.0 * libm::sin(t));
    let up = (900.0 - y * y).sqrt();
    ([x, y, MIDDLE + up], [x / 20.0, y / 20.0 + y / 30.0, up / 30.0])
}

/// Distance of the beam from the seam, mm, and angle between the beam and the direction at the nearest point,
/// degrees, with the axes at x, y, A, C.
fn beam_at([x, y, a, c]: [f64; 4]) -> (f64, f64) {
    let config = positioner().positioner.expect("it is a positioner");
    let ((sa, ca), (sb, cb)) = (libm::sincos(a.to_radians()), libm::sincos(c.to_radians()));
    let turned = |p: [f64; 3]| {
        let [u, v, w] = [cb * p[0] + sb * p[1], -sb * p[0] + cb * p[1], p[2]];
        [u, ca * v + sa * w, -sa * v + ca * w]
    };
    let distance = |t: f64| {
        let (p, _) = seam(t);
        let p = turned([p[0], p[1], p[2]]);
        let table = turned_offset([config.x2_mm, config.y2_mm, config.z2_mm], sa, ca);
        let [dx, dy] = [x + config.x1_mm + table[0] + p[0], y + config.y1_mm + table[1] + p[1]];
        libm::hypot(dx - config.beam_mm[0], dy - config.beam_mm[1])
    };
    let nearest = |from: f64, step: f64, steps: i32| {
        let places = (-steps..=steps).map(|i| from + f64::from(i) * step);
        places.min_by(|a, b| distance(*a).total_cmp(&distance(*b))).expect("there are places")
    };
    let mut step = TAU / 720.0;
    let mut t = nearest(0.0, step, 720);
    while step > 1e-10 {
        let next = nearest(t, step, 1);
        step *= if next == t { 0.5 } else { 1.0 };
        t = next;
    }
    let l = turned(seam(t).1);
    (distance(t), libm::atan2(libm::hypot(l[0], l[1]), l[2]).to_degrees())
}

/// The tilt alone: offsets behind the turn do not turn with it.
fn turned_offset([x, y, z]: [f64; 3], sa: f64, ca: f64) -> [f64; 3] {
    [x, ca * y + sa * z, -sa * y + ca * z]
}

#[test]
fn the_beam_keeps_to_the_seam_of_two_cylinders() {
    let mut worst = [[0.0_f64; 2]; 2];
    let mut cuts = [0, 0];
    let observation = run(&items(), "", |record| {
        if !record.truth.cycle.0.is_multiple_of(500) {
            return;
        }
        cuts = [cuts[1], record.machine.work];
        if cuts != [1, 1] {
            return;
        }
        let axes = [Axis::X, Axis::Y, Axis::A, Axis::C];
        let commanded = axes.map(|axis| {
            record
                .axes
                .iter()
                .find(|(other, _)| *other == axis)
                .map_or(0.0, |(_, status)| status.commanded_mm)
        });
        let slides = axes.map(|axis| record.truth.axes[axis.index()].slide_mm);
        for (worst, axes) in worst.iter_mut().zip([commanded, slides]) {
            let (distance, angle) = beam_at(axes);
            *worst = [worst[0].max(1e3 * distance), worst[1].max(angle)];
        }
    });
    let trace = is_exact(&observation, "the seam");
    let feed = &trace.feed;
    assert!(feed.most_pct <= FEED_PCT && feed.held_pct > 90.0, "{feed:?}");
    // So does the true one, except while an axis crosses its backlash.
    assert!(feed.true_rms_pct <= 0.5 * FEED_PCT && feed.true_held_pct >= 98.0, "{feed:?}");
    // All around and a little more: the seam is longer than the circle it is seen as from above.
    assert!(trace.way_mm > TAU * 20.0, "{trace:#?}");
    let [commanded, slide] = worst;
    assert!(commanded[0] <= 0.001 && commanded[1] <= 1e-6, "{worst:?}");
    assert!(slide[0] > 0.5 && slide[0] <= trace.slide.max_abs_um() + 0.001, "{worst:?} {trace:#?}");
    assert!(slide[1] > 1e-4 && slide[1] <= trace.slide.angle_max_deg + 1e-6, "{worst:?} {trace:#?}");
}

#[test]
fn whatever_the_operator_does_the_beam_stays_on_the_seam() {
    let items = items();
    let quiet = run(&items, "", |_| {});
    let event = |at: f64, action: &str| format!("[[event]]\nat = {{ time_s = {at} }}\n{action}\n");
    let scenarios = [
        ("slower", event(5.0, "feed_override_pct = 30") + &event(8.0, "feed_override_pct = 100")),
        ("hold", event(6.0, "feed_hold = true") + &event(7.0, "cycle_start = true")),
    ];
    for (what, scenario) in scenarios {
        let observation = run(&items, &scenario, |_| {});
        let trace = is_exact(&observation, what);
        assert!((trace.way_mm - quiet.traces[0].way_mm).abs() < 0.01, "{what}: the same way");
        assert!(trace.cut_cycles > quiet.traces[0].cut_cycles + 1000, "{what}: it came to pass");
    }
}

/// Points are joined by as many pieces; the seam is one, and all of it is measured.
#[test]
fn a_seam_through_points_is_one_seam() {
    let points: Vec<String> = (0..=250)
        .map(|i| {
            let (at, along) = seam(TAU * f64::from(i) / 250.0);
            format!("[{}, {}, {}, {}, {}, {}]", at[0], at[1], at[2], along[0], along[1], along[2])
        })
        .collect();
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("points.toml");
    let job = format!("kind = \"seam\"\nfeed_mm_min = 1500\npoints = [{}]\n", points.join(", "));
    std::fs::write(&path, job).expect("it can be written");
    let observation = run(&shop::items(&positioner(), &path), "", |_| {});
    let trace = is_exact(&observation, "points");
    assert_eq!((trace.trace, observation.traces_left_out), (1, 0));
    let whole: f64 = (0..10_000)
        .map(|i| {
            let [a, b] = [i, i + 1].map(|i| seam(TAU * f64::from(i) / 10_000.0).0);
            libm::hypot(libm::hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2])
        })
        .sum();
    assert!((trace.way_mm - whole).abs() < 0.05, "{} mm of {whole} mm", trace.way_mm);
}
