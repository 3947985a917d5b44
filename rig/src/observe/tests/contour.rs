//! Contour error and roundness: what is put into a circle is what is read from it.

use machine::{Machine, SMALL_MILL};
use protocol::{
    Arc, Axis, AxisState, AxisStatus, Code, Cycle, Feed, Item, MachineState, MachineStatus, PerAxis,
    Position, Truth, arc::Plane,
};

use crate::observe::{MovesReport, Observer, Record, Watch};

const RADIUS_MM: f64 = 5.0;
const SPEED_MM_S: f64 = 2000.0 / 60.0;
const LINE: u32 = 7;

fn at(x: f64, y: f64) -> PerAxis<Position> {
    Axis::ALL.map(|axis| match axis {
        Axis::X => Position::from_mm(x),
        Axis::Y => Position::from_mm(y),
        _ => Position(0),
    })
}

/// To (15, 20), and once around (10, 20).
fn program() -> [Item; 2] {
    let center = [Position::from_mm(10.0), Position::from_mm(20.0)];
    let arc = Arc { plane: Plane::Xy, target: at(15.0, 20.0), center, turns: 1 };
    [
        Item { line: 3, code: Code::Line { target: at(15.0, 20.0), feed: Feed::Rapid } },
        Item { line: LINE, code: Code::Arc { arc, feed: Feed::PerMinute(2000.0) } },
    ]
}

/// Goes around once; the true position is off by this many mm outwards and backwards at a direction in
/// degrees.
fn around(off: impl Fn(f64) -> [f64; 2]) -> MovesReport {
    let machine = Machine::from_toml(SMALL_MILL).expect("a mill");
    let mut observer = Observer::new(&machine, &program());
    let rate = SPEED_MM_S / RADIUS_MM;
    let cycles = (core::f64::consts::TAU / rate / machine.general.cycle_s) as u64;
    for cycle in 0..=cycles {
        let angle = rate * cycle as f64 * machine.general.cycle_s;
        let (sin, cos) = libm::sincos(angle);
        let [out, back] = off(angle.to_degrees());
        let mut truth = Truth { cycle: Cycle(cycle), ..Truth::default() };
        let mut axes = [Axis::X, Axis::Y, Axis::Z].map(|axis| (axis, AxisStatus::default()));
        for (i, (center, radial, along)) in [(10.0, cos, -sin), (20.0, sin, cos)].into_iter().enumerate() {
            truth.axes[i].motor_mm = center + (RADIUS_MM + out) * radial - back * along;
            let status = &mut axes[i].1;
            (status.commanded_mm, status.velocity_mm_s) = (center + RADIUS_MM * radial, SPEED_MM_S * along);
        }
        for (_, status) in &mut axes {
            (status.cycle, status.state, status.line) = (truth.cycle, AxisState::Streaming as u32, LINE);
        }
        let machine = MachineStatus { line: LINE, state: MachineState::Moving as u32, ..Default::default() };
        observer.cycle(&Record { truth: &truth, axes: &axes, machine: &machine });
    }
    observer.finish().moves
}

#[test]
fn only_what_is_normal_to_the_motion_is_contour_error() {
    let moves = around(|_| [0.0, 0.4]);
    assert!(moves.contour_max_um < 1e-4, "{moves:?}");
    let moves = around(|_| [-0.003, 0.4]);
    assert!(
        (moves.contour_max_um - 3.0).abs() < 1e-6 && (moves.contour_rms_um - 3.0).abs() < 1e-6,
        "{moves:?}"
    );
    let moves = around(|psi| [if (100.0..101.0).contains(&psi) { 0.017 - psi * 1e-4 } else { 0.001 }, 0.0]);
    assert!((moves.contour_max_um - 7.0).abs() < 0.02 && moves.contour_line == LINE, "{moves:?}");
    let t_s = 100.0f64.to_radians() * RADIUS_MM / SPEED_MM_S;
    assert!((moves.contour_t_s - t_s).abs() < 0.001, "{} s, not {t_s} s", moves.contour_t_s);
}

#[test]
fn a_circle_is_measured_with_its_quadrants() {
    // 1 µm too large, with a glitch after two of the quadrants.
    let moves = around(|psi| match psi {
        _ if (90.0..95.0).contains(&psi) => [0.004, 0.0],
        _ if (272.0..276.0).contains(&psi) => [-0.0015, 0.0],
        _ => [0.001, 0.0],
    });
    let [circle] = &moves.circles[..] else { panic!("{:?}", moves.circles) };
    assert_eq!((circle.line, circle.plane, circle.radius_mm), (LINE, [Axis::X, Axis::Y], 5.0));
    assert_eq!(circle.center_mm, [10.0, 20.0]);
    assert!(
        (circle.feed_mm_min - 2000.0).abs() < 1e-6 && (circle.swept_deg - 360.0).abs() < 0.5,
        "{circle:?}"
    );
    assert!((circle.round_max_um - 4.0).abs() < 1e-6, "{circle:?}");
    let mean = 1.0 + 3.0 * 5.0 / 360.0 - 2.5 * 4.0 / 360.0;
    assert!((circle.mean_um - mean).abs() < 0.01, "{circle:?}");
    let glitches = [1.0, 4.0, 1.0, -1.5].map(|um| um - mean);
    let close = |(one, other): (&f64, f64)| (one - other).abs() < 0.01;
    assert!(
        circle.quadrants_um.iter().zip(glitches).all(close),
        "{:?}, not {glitches:?}",
        circle.quadrants_um
    );
}

#[test]
fn half_turns_and_more_are_watched_for() {
    let arc = |x: f64, y: f64, turns: i32| {
        let arc = Arc { plane: Plane::Xy, target: at(x, y), center: [Position(0); 2], turns };
        Item { line: 1, code: Code::Arc { arc, feed: Feed::PerMinute(100.0) } }
    };
    let start = Item { line: 1, code: Code::Line { target: at(5.0, 0.0), feed: Feed::Rapid } };
    for (item, wanted) in [
        (arc(5.0, 0.0, 1), true),
        (arc(-5.0, 0.0, 1), true),
        (arc(-5.0, 0.0, -1), true),
        (arc(0.0, 5.0, 1), false),
        (arc(0.0, 5.0, -1), true),
        (arc(0.0, -5.0, -1), false),
        (arc(0.0, 5.0, 2), true),
    ] {
        let mut watch = Watch::default();
        assert!(!watch.wants(&start));
        assert_eq!(watch.wants(&item), wanted, "{item:?}");
    }
}
