//! A tool leaves the heights of its own shape.

use std::collections::BTreeMap;

use protocol::{Axis, AxisState, Motion};
use rig::observe::{AxisLimits, Led, StockReport, Summary, ToolNote, TraceReport, Traced, WorkKind};
use rig::trace::{AxisRow, CutRow, Row};

use super::heights::{Cutter, Heights};
use super::{Way, part};

fn summary(diameter_mm: Option<f64>, name: &str) -> Summary {
    let limits = AxisLimits { velocity_mm_s: 100.0, acceleration_mm_s2: 1000.0, jerk_mm_s3: 1e5 };
    let tool = ToolNote { name: name.into(), diameter_mm, ..ToolNote::default() };
    Summary {
        limits: [Axis::X, Axis::Y, Axis::Z].map(|axis| (axis, limits)).into(),
        tools: BTreeMap::from([(1, tool)]),
        ..Summary::default()
    }
}

fn row([x, y, z]: [f64; 3], motion: Motion) -> Row {
    let at = |slide: f64| AxisRow {
        programmed: slide,
        commanded: slide,
        measured: slide,
        true_mm: slide,
        velocity: 0.0,
        acceleration: 0.0,
        jerk: 0.0,
        servo_error: 0.0,
        torque: 0.0,
        state: AxisState::Streaming,
        slide,
        force: 0.0,
    };
    Row {
        cycle: 0,
        t_s: 0.0,
        spindle_true_deg: 0.0,
        spindle_counts: 0,
        spindle_rpm: 0.0,
        override_pct: 100.0,
        axes: vec![(Axis::X, at(x)), (Axis::Y, at(y)), (Axis::Z, at(z))],
        pass: 0,
        line: 1,
        led: Led { tool: 1, motion },
        cut: CutRow::default(),
        traced: Traced::default(),
    }
}

/// A groove of 40 mm along X, 2 mm deep, in a face that the same tool has just gone over.
fn groove(summary: &Summary) -> Way {
    let mut way = Way::new(summary).expect("a mill");
    let line = |from: [f64; 3], to: [f64; 3]| {
        (0..=1000).map(move |n| [0, 1, 2].map(|i| from[i] + f64::from(n) / 1000.0 * (to[i] - from[i])))
    };
    line([0.0, -10.0, 50.0], [0.0, -10.0, 0.0]).for_each(|at| way.add(&row(at, Motion::Rapid)));
    line([0.0, -10.0, 0.0], [40.0, 10.0, 0.0]).for_each(|at| way.add(&row(at, Motion::Feed)));
    line([40.0, 0.0, 0.0], [40.0, 0.0, -2.0]).for_each(|at| way.add(&row(at, Motion::Feed)));
    line([40.0, 0.0, -2.0], [0.0, 0.0, -2.0]).for_each(|at| way.add(&row(at, Motion::Feed)));
    way
}

fn height(heights: &Heights, x: f64, y: f64) -> f64 {
    let cell = |i: usize, mm: f64| ((mm - heights.from_mm[i]) / heights.cell_mm).round() as usize;
    heights.z_mm[cell(1, y) * heights.size[0] + cell(0, x)]
}

/// The stock that nobody described ends where the tool was fed, and begins where it was fed sideways (M168).
#[test]
fn a_flat_tool_leaves_a_flat_groove() {
    let summary = summary(Some(8.0), "end mill");
    let heights = Heights::of(&summary, &groove(&summary), None).expect("something was cut");
    assert_eq!((heights.top_mm, heights.from_mm), (0.0, [-4.0, -14.0]));
    for (y, z) in [(0.0, -2.0), (3.5, -2.0), (-3.5, -2.0), (4.5, 0.0), (-12.0, 0.0)] {
        assert!((height(&heights, 20.0, y) - z).abs() < 1e-9, "{y}: {}", height(&heights, 20.0, y));
    }
}

/// A block that is described is as large as it is said to be, and what stands above it is not part of it.
#[test]
fn a_block_is_as_large_as_the_program_says() {
    let stock =
        StockReport { block_mm: Some([[-20.0, -30.0, -15.0], [60.0, 30.0, 0.5]]), ..StockReport::default() };
    let summary = Summary { stock: Some(stock), ..summary(Some(8.0), "end mill") };
    let mut way = groove(&summary);
    way.add(&row([0.0, 0.0, -40.0], Motion::Feed));
    let heights = Heights::of(&summary, &way, None).expect("something was cut");
    assert_eq!((heights.top_mm, heights.floor_mm, heights.from_mm), (0.5, -15.0, [-20.0, -30.0]));
    for (x, y, z) in [(20.0, 0.0, -2.0), (20.0, 2.0, -2.0), (-15.0, 0.0, 0.5), (50.0, 25.0, 0.5)] {
        assert!((height(&heights, x, y) - z).abs() < 1e-9, "{x} {y}: {}", height(&heights, x, y));
    }
    let page = part(&summary, &way, None).expect("something was cut").into_string();
    assert!(
        page.contains("The stock is the block that the program describes") && !page.contains("Nobody said")
    );
}

#[test]
fn a_ball_leaves_a_round_groove() {
    let summary = summary(Some(8.0), "Ball nose");
    let heights = Heights::of(&summary, &groove(&summary), None).expect("something was cut");
    let row = ((0.0 - heights.from_mm[1]) / heights.cell_mm).round();
    let off = heights.from_mm[1] + row * heights.cell_mm;
    assert!((height(&heights, 20.0, 0.0) - (-2.0 + 4.0 - (16.0 - off * off).sqrt())).abs() < 1e-3);
    let beside = heights.from_mm[1] + (row + 8.0) * heights.cell_mm;
    assert!((height(&heights, 20.0, beside) - (2.0 - (16.0 - beside * beside).sqrt())).abs() < 1e-2);
}

/// (M165) of both, and of what lies beside a tool.
#[test]
fn a_tool_rises_from_its_tip() {
    let cutter =
        |corner_mm| Cutter { number: 1, name: String::new(), radius_mm: 3.0, known: true, corner_mm };
    assert_eq!((cutter(0.0).rise_mm(2.9), cutter(0.0).rise_mm(3.1)), (Some(0.0), None));
    assert_eq!((cutter(3.0).rise_mm(0.0), cutter(3.0).rise_mm(3.0)), (Some(0.0), Some(3.0)));
}

#[test]
fn what_was_taken_for_a_tool_is_said() {
    let said = |diameter| {
        let summary = summary(diameter, "");
        part(&summary, &groove(&summary), None).expect("something was cut").into_string()
    };
    assert!(said(None).contains("flat, 6 mm is taken, the record does not say"));
    assert!(said(Some(8.0)).contains("flat, 8 mm. Drag"));
}

/// A job is fed to its surface from afar, and leaves none of the stock that nobody described beside it.
#[test]
fn a_surface_is_as_large_as_its_tip_went_and_takes_the_tool_of_the_job() {
    let trace = TraceReport { trace: 1, kind: WorkKind::Surface, ..TraceReport::default() };
    let summary = Summary { traces: vec![trace], ..summary(None, "") };
    let mut way = Way::new(&summary).expect("a mill");
    let cuts = Traced { trace: 1, ..Traced::default() };
    for (from, to, traced) in [
        ([-50.0, 5.0, 90.0], [0.0, 5.0, 90.0], Traced::default()),
        ([0.0, 0.0, 2.0], [20.0, 0.0, 2.0], cuts),
        ([20.0, 10.0, 4.0], [0.0, 10.0, 4.0], cuts),
    ] {
        for n in 0..=1000 {
            let at = [0, 1, 2].map(|i| from[i] + f64::from(n) / 1000.0 * (to[i] - from[i]));
            way.add(&Row { traced, ..row(at, Motion::Feed) });
        }
    }
    let job = "tool = { kind = \"ball\", diameter_mm = 6 }";
    let heights = Heights::of(&summary, &way, super::job::tool(job)).expect("a surface");
    assert!((heights.top_mm - 4.0).abs() < 1e-9 && heights.from_mm == [0.0, 0.0], "{}", heights.top_mm);
    // A ball is lowered every half cell: between, the ridges are less than q²/32R high.
    assert!((height(&heights, 10.0, 0.0) - 2.0).abs() < 1e-3);
    assert!(
        part(&summary, &way, Some(job)).is_some_and(|page| page.into_string().contains("ball, 6 mm. Drag"))
    );
}

/// However long the run was.
#[test]
fn a_way_is_bounded_in_points() {
    let summary = summary(Some(8.0), "");
    let mut way = Way::new(&summary).expect("a mill");
    for n in 0..900_000 {
        way.add(&row([f64::from(n) * 0.03, 0.0, 0.0], Motion::Feed));
    }
    assert!(way.points.len() <= 400_000 && way.points.len() > 100_000, "{}", way.points.len());
}
