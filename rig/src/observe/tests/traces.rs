//! Traces: what is put beside a surface is what is read from it, and only where it is cut.

use machine::{Machine, POSITIONER, SMALL_MILL};
use protocol::{
    Axis, AxisState, AxisStatus, Code, Cycle, Item, MachineState, MachineStatus, Position, Shape, Truth,
    Work, frame::SETPOINT_LEAD,
};
use shape::{Branch, Correction, Formula, Op, Pattern, Seam, SeamCurve, Surface, Tool};

use crate::observe::{Observer, Record, TraceReport, Traced, WorkKind};

const LINE: u32 = 4;
const FEED_MM_MIN: f64 = 1500.0;
const ORIGIN: [f64; 3] = [10.0, -5.0, -60.0];
/// Control cycles: the tool comes down until the first, cuts until the second.
const CUTS: std::ops::Range<u64> = 400..2400;

/// z = 0.75 x under a ball of 6 mm, and after it a line of the program that is not a trace.
fn program() -> [Item; 2] {
    let formula = Formula::new(&[Op::Constant(0.75), Op::Variable(0), Op::Mul]).expect("complete");
    let surface = Surface {
        x: [0.0, 40.0],
        y: [0.0, 10.0],
        tool: Tool { radius_mm: 3.0, corner_mm: 3.0 },
        pattern: Pattern::Curve { t: [0.0, 1.0] },
        clear_mm: 40.0,
    };
    let trace = Work {
        shape: Shape::Surface(surface),
        origin: ORIGIN.map(Position::from_mm),
        feed_mm_min: FEED_MM_MIN,
        chord_mm: 0.002,
        correction: Correction::Exact,
    };
    [Code::Formula { slot: 0, formula }, Code::Work(trace)].map(|code| Item { line: LINE, code })
}

/// As below, with no acceleration commanded.
fn cut(share: impl Fn(u64) -> f64, off: impl Fn(u64) -> f64) -> (TraceReport, Vec<Traced>) {
    cut_with(share, |_| 0.0, off)
}

/// Goes up the plane at a share of the feed and with an acceleration, mm/s², that depend on the cycle; the
/// true tool stands off by so many mm.
fn cut_with(
    share: impl Fn(u64) -> f64,
    acceleration: impl Fn(u64) -> f64,
    off: impl Fn(u64) -> f64,
) -> (TraceReport, Vec<Traced>) {
    let machine = Machine::from_toml(SMALL_MILL).expect("a mill");
    let mut observer = Observer::new(&machine, &program());
    let (cycle_s, tick) = (machine.general.cycle_s, machine.cycles_per_tick());
    let (mut way, mut seen) = (0.0, Vec::new());
    let mut status = MachineStatus { feed_override_pct: 100.0, ..Default::default() };
    for cycle in 0..CUTS.end + 100 {
        let cuts = CUTS.contains(&cycle);
        let speed = if cuts { FEED_MM_MIN / 60.0 * share(cycle) } else { 0.0 };
        way += speed * cycle_s;
        // A ball of 3 mm touches a slope of 3/4 with its tip 0.75 mm above it.
        let above = if cuts { 0.75 } else { 30.0 };
        let tip = [0.8 * way, 3.0, 0.6 * way + above];
        let mut truth = Truth { cycle: Cycle(cycle), ..Truth::default() };
        let mut axes = [Axis::X, Axis::Y, Axis::Z].map(|axis| (axis, AxisStatus::default()));
        // The true tool is also late by 40 µm along the plane.
        let real = [-0.6 * off(cycle) - 0.032, 0.0, 0.8 * off(cycle) - 0.024];
        for i in 0..3 {
            let status = &mut axes[i].1;
            (status.cycle, status.state, status.line) = (truth.cycle, AxisState::Streaming as u32, LINE);
            (status.commanded_mm, status.velocity_mm_s) = (ORIGIN[i] + tip[i], speed * [0.8, 0.0, 0.6][i]);
            status.acceleration_mm_s2 = acceleration(cycle) * [0.8, 0.0, 0.6][i];
            truth.axes[i].slide_mm = ORIGIN[i] + tip[i] + real[i];
        }
        if cycle.is_multiple_of(tick) {
            let made_for = cycle + SETPOINT_LEAD * tick;
            status.work = u32::from(CUTS.contains(&made_for));
            (status.cycle, status.line, status.state) = (Cycle(cycle), LINE, MachineState::Moving as u32);
        }
        observer.cycle(&Record { truth: &truth, axes: &axes, machine: &status });
        seen.push(observer.traced());
    }
    let [report] = <[TraceReport; 1]>::try_from(observer.finish().traces).expect("one trace");
    (report, seen)
}

#[test]
fn a_tool_is_measured_where_it_cuts_and_nowhere_else() {
    let (report, seen) = cut(|_| 1.0, |cycle| if cycle == 1000 { -0.004 } else { 0.001 });
    let TraceReport { trace: 1, line: LINE, kind: WorkKind::Surface, .. } = report else {
        panic!("{report:#?}")
    };
    assert_eq!((report.begin_cycle, report.end_cycle), (CUTS.start, CUTS.end - 4));
    assert_eq!((report.unmeasured_cycles, report.origin_mm), (0, ORIGIN));
    assert!(report.commanded.max_abs_um() < 1e-6, "{report:#?}");
    let slide = report.slide;
    assert!((slide.low_um + 4.0).abs() < 1e-6 && (slide.high_um - 1.0).abs() < 1e-6, "{slide:?}");
    assert!((slide.worst_t_s - 0.5).abs() < 1e-9 && (slide.rms_um - 1.0).abs() < 0.01, "{slide:?}");
    let tip = (slide.worst_mm[2] - 0.75 * slide.worst_mm[0] - 0.75 + 0.005).abs();
    assert!(tip < 1e-9 && (slide.worst_mm[1] - 3.0).abs() < 1e-9, "{slide:?}");
    assert!((report.way_mm - 25.0 * 0.0005 * report.cut_cycles as f64).abs() < 0.02, "{report:#?}");
    for (cycle, traced) in seen.iter().enumerate() {
        let cuts = (report.begin_cycle..=report.end_cycle).contains(&(cycle as u64));
        assert_eq!(traced.trace, u32::from(cuts), "{cycle}");
        assert!(cuts || *traced == Traced::default(), "{cycle}: {traced:?}");
    }
    assert!((seen[1000].slide.deviation_mm + 0.004).abs() < 1e-9, "{:?}", seen[1000]);
    assert!((seen[1500].commanded.feed_mm_min - FEED_MM_MIN).abs() < 1e-3, "{:?}", seen[1500]);
}

#[test]
fn a_feed_that_falls_without_a_reason_is_seen() {
    let (report, _) = cut(|_| 1.0, |_| 0.0);
    let feed = report.feed;
    assert!(feed.held_pct == 100.0 && feed.unexplained_s == 0.0 && feed.most_pct < 1e-3, "{feed:?}");
    assert!(feed.true_low_pct > -1e-3 && feed.true_high_pct < 1e-3 && feed.chord_max_um < 1e-6, "{feed:?}");
    let (report, _) = cut(|cycle| if (1000..1200).contains(&cycle) { 0.95 } else { 1.005 }, |_| 0.0);
    let feed = report.feed;
    assert!((feed.unexplained_s - 0.1).abs() < 1e-9 && (feed.most_pct - 0.5).abs() < 1e-3, "{feed:?}");
    assert!((feed.held_pct - 90.0).abs() < 0.1, "{feed:?}");
}

/// Up to the feed in 0.1 s, at 40 % of the acceleration of Z: that is a reason for the ramp, and for nothing
/// after it.
#[test]
fn a_ramp_explains_no_feed_that_stays_low() {
    let at_most = |most: f64| {
        let ramp = |cycle: u64| 0.005 * cycle.saturating_sub(CUTS.start) as f64;
        let limit = Machine::from_toml(SMALL_MILL).expect("a mill").axis[&Axis::Z].acceleration_mm_s2;
        let acceleration = move |cycle: u64| if ramp(cycle) < most { 0.4 / 0.6 * limit } else { 0.0 };
        cut_with(move |cycle| ramp(cycle).min(most), acceleration, |_| 0.0).0
    };
    let full = at_most(1.0).feed;
    assert!(full.unexplained_s == 0.0 && (full.held_pct - 90.0).abs() < 0.2, "{full:?}");
    let low = at_most(0.8);
    // All of the second after the ramp, but for the window in which it ends and the one after that.
    let after = low.cut_cycles as f64 * 0.0005 - 0.08;
    let feed = low.feed;
    assert_eq!(feed.held_pct, 0.0);
    assert!((after - 0.101..=after).contains(&feed.unexplained_s), "{feed:?} of {after} s");
}

/// A line of 10 mm along X, with the beam along Z.
fn piece() -> Code {
    let mut curve = [[0.0; 8]; 6];
    (curve[0][1], curve[5][0]) = (10.0, 1.0);
    let work = Shape::Seam(Seam {
        curve: SeamCurve::Polynomials(curve),
        t: [0.0, 1.0],
        branch: Branch::Negative,
        idle_beta_deg: 0.0,
        moved: None,
    });
    let origin = [Position(0); 3];
    Code::Work(Work {
        shape: work,
        origin,
        feed_mm_min: 600.0,
        chord_mm: 0.002,
        correction: Correction::Exact,
    })
}

/// A piece of a seam after the other, on a positioner that stands still: it is only counted.
#[test]
fn pieces_of_a_seam_are_one_seam_and_the_worst_are_kept() {
    let machine = Machine::from_toml(POSITIONER).expect("a positioner");
    let run = |lines: &[u32], pause: bool| {
        let items: Vec<Item> = lines.iter().map(|line| Item { line: *line, code: piece() }).collect();
        let mut observer = Observer::new(&machine, &items);
        let tick = machine.cycles_per_tick();
        for cycle in 0..(lines.len() as u64 + 1) * 10 * tick {
            let made = cycle / tick;
            let number = if pause && made % 10 >= 5 { 0 } else { (made / 10 + 1) as u32 };
            let tracing = if number as usize > lines.len() { 0 } else { number };
            let status = MachineStatus {
                cycle: Cycle(made * tick),
                state: MachineState::Moving as u32,
                feed_override_pct: 100.0,
                work: tracing,
                ..Default::default()
            };
            let truth = Truth { cycle: Cycle(cycle), ..Truth::default() };
            observer.cycle(&Record { truth: &truth, axes: &[], machine: &status });
        }
        observer.finish()
    };
    let count = |lines: &[u32], pause: bool| {
        let seen = run(lines, pause);
        (seen.traces.iter().map(|trace| (trace.trace, trace.line)).collect::<Vec<_>>(), seen.traces_left_out)
    };
    assert_eq!(count(&[3, 3, 3, 3], false), (vec![(1, 3)], 0));
    assert_eq!(count(&[3, 3, 7, 7], false), (vec![(1, 3), (3, 7)], 0));
    assert_eq!(count(&[3, 3, 3], true), (vec![(1, 3), (2, 3), (3, 3)], 0));
    let (kept, left_out) = count(&[3; 207], true);
    assert_eq!((kept.len(), left_out), (200, 7));
}
