//! A run folder becomes a page that has everything in it.

use std::path::Path;

use base64::prelude::{BASE64_STANDARD, Engine as _};
use protocol::{Axis, AxisState, Motion};
use rig::observe::{
    AxisLimits, CircleReport, CuttingReport, DeviationReport, FeedReport, Led, MovesReport, Outcome,
    PassReport, Summary, TraceReport, Traced, TracedPoint, WorkKind,
};
use rig::trace::{AxisRow, CutRow, Format, Row, TraceWriter};

use super::render;

const CYCLES: u64 = 4000;

pub(super) fn summary() -> Summary {
    let pass = PassReport {
        pass: 1,
        line: 3,
        lead_mm: -2.0,
        direction: 1.0,
        x_moments_deg: [100.0, 500.0, 3000.0, 3400.0],
        z_moments_deg: [200.0, 500.0, 3000.0, 3300.0],
        thread_end_deg: 3000.0,
        armed_cycle: 10,
        begin_cycle: 100,
        end_cycle: CYCLES - 10,
        thread_cycles: 100,
        same_index: true,
        complete: true,
        helix_max_abs_um: 1.234,
        slide_helix_max_abs_um: 3.456,
        ..PassReport::default()
    };
    let limits = AxisLimits { velocity_mm_s: 100.0, acceleration_mm_s2: 1000.0, jerk_mm_s3: 1e5 };
    Summary {
        version: 1,
        program: "examples/a<b>.ngc".into(),
        outcome: Outcome::Completed,
        cycle_s: 0.0005,
        cycles: CYCLES,
        simulated_s: 2.0,
        passes: vec![pass],
        limits: [(Axis::X, limits), (Axis::Z, limits)].into(),
        ..Summary::default()
    }
}

pub(super) fn row(cycle: u64) -> Row {
    let angle = cycle as f64 - 100.0;
    let axis = AxisRow {
        programmed: 10.0 - angle * 2.0 / 360.0,
        commanded: 0.0,
        measured: 0.0,
        true_mm: 10.0 - angle * 2.0 / 360.0,
        velocity: 50.0,
        acceleration: 0.0,
        jerk: 0.0,
        servo_error: if cycle == 777 { 0.0123 } else { 0.0 },
        torque: 0.0,
        state: AxisState::Locked,
        slide: 0.0,
        force: 0.0,
    };
    Row {
        cycle,
        t_s: cycle as f64 * 0.0005,
        spindle_true_deg: angle,
        spindle_counts: 0,
        spindle_rpm: 333.25,
        override_pct: 100.0,
        axes: vec![(Axis::X, axis), (Axis::Z, axis)],
        pass: 1,
        line: 3,
        cut: CutRow { area: 0.2, force: 612.5, torque: 6.125, motor_torque: 7.5 },
        traced: Traced::default(),
        led: Led { tool: 3, motion: Motion::None },
    }
}

/// The report of a folder, with the numbers of its pictures written out.
fn page_of(folder: &Path) -> String {
    let page = std::fs::read_to_string(render(folder).expect("drawn")).expect("read");
    let mut parts = page.split("{\"bdata\":\"");
    let mut read = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (packed, rest) = part.split_once("\",\"dtype\":\"f4\"").expect("numbers of this kind");
        let (_shape, rest) = rest.split_once('}').expect("an end");
        let bytes = BASE64_STANDARD.decode(packed).expect("packed numbers");
        let number = |four: &[u8]| f32::from_le_bytes(four.try_into().expect("four bytes")).to_string();
        let numbers: Vec<String> = bytes.chunks(4).map(number).collect();
        read += &format!("[{}]{rest}", numbers.join(","));
    }
    read
}

#[test]
fn a_run_folder_becomes_one_page_that_needs_no_network() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    summary().write(&folder.path().join("summary.json")).expect("summary");
    std::fs::write(folder.path().join("a<b>.ngc"), "G33 Z-20 K2 (a < b & c)\n").expect("program");
    let path = folder.path().join(Format::Mcap.file_name());
    let mut trace = TraceWriter::create(&path, Format::Mcap, &[Axis::X, Axis::Z]).expect("trace");
    (0..CYCLES).for_each(|cycle| trace.row(&row(cycle)).expect("row"));
    trace.finish().expect("finished");

    let page = page_of(folder.path());
    assert!(page.len() < 2_500_000, "{} bytes", page.len());
    assert_eq!(page.matches("<figure>").count(), 7);
    for needed in [
        "1.23; +0.00",
        "12.3",
        "333.25",
        "a&lt;b&gt;.ngc",
        "(a &lt; b &amp; c)",
        "aria-label",
        "Plotly.react",
        // What `link.js` goes by: the line of each row, line of the program, curve and point of the path.
        "data-pass=\"0\" data-line=\"3\"",
        "<li data-line=\"1\">",
        "\"meta\":{\"line\":3,\"pass\":0}",
        "\"meta\":{\"lines\":[0,3]}",
    ] {
        assert!(page.contains(needed), "{needed} is missing");
    }
    let before_the_library = page.split("</main>").next().unwrap_or_default();
    for foreign in ["http://", "https://", "<link", " src="] {
        assert!(!before_the_library.contains(foreign), "{foreign} in the page");
    }
}

#[test]
fn a_run_without_a_trace_still_has_its_figures_in_numbers() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    summary().write(&folder.path().join("summary.json")).expect("summary");
    let page = page_of(folder.path());
    assert!(page.contains("without a trace") && page.contains("1.23; ") && !page.contains("<figure>"));
}

#[test]
fn what_was_cut_has_a_table_and_a_picture() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let cutting = CuttingReport {
        force_max_n: 612.5,
        radial_max_n: 306.2,
        axial_max_n: 122.5,
        torque_max_nm: 6.125,
        power_max_kw: 0.3849,
        chip_area_max_mm2: 0.2042,
    };
    let mut summary = summary();
    summary.passes[0].cutting = Some(cutting);
    summary.passes.push(PassReport { pass: 2, cutting: None, ..summary.passes[0].clone() });
    summary.write(&folder.path().join("summary.json")).expect("summary");
    let path = folder.path().join(Format::Csv.file_name());
    let mut trace = TraceWriter::create(&path, Format::Csv, &[Axis::X, Axis::Z]).expect("trace");
    (0..CYCLES).for_each(|cycle| trace.row(&row(cycle)).expect("row"));
    trace.finish().expect("finished");
    let page = page_of(folder.path());
    for needed in [
        "<h2>Cutting</h2>",
        "0.2042",
        "612.5; 306.2, 122.5",
        "6.12",
        "0.385",
        "<td>–</td>",
        "Cutting force and spindle torque of every pass",
        "[612.5,",
        "[7.5,",
    ] {
        assert!(page.contains(needed), "{needed} is missing");
    }
    let quiet = tempfile::tempdir().expect("a temporary folder");
    self::summary().write(&quiet.path().join("summary.json")).expect("summary");
    let page = page_of(quiet.path());
    assert!(!page.contains("<h2>Cutting</h2>"), "nothing was cut");
}

/// A positioner has no spindle to show.
#[test]
fn a_spindle_that_never_turns_is_not_drawn() {
    for (rpm, is_shown) in [(0.0, false), (-300.0, true)] {
        let summary = summary();
        let mut curves = super::Curves::new(&summary);
        (0..100).for_each(|cycle| curves.add(&summary, &Row { spindle_rpm: rpm, ..row(cycle) }));
        let figures = super::figures::all(&summary, &curves);
        assert_eq!(figures.iter().any(|figure| figure.title.contains("Spindle")), is_shown, "{rpm}");
    }
}

#[test]
fn what_is_no_run_folder_is_refused() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let refused = render(folder.path()).expect_err("empty folder").to_string();
    assert!(refused.contains("summary.json") && refused.contains("pitchlock run"), "{refused}");
}

/// A circle of 5 mm about X 10, Y 20 in line 7, 2 µm too large.
#[test]
fn a_mill_shows_its_circles_and_how_far_it_is_from_the_path() {
    let at_rest =
        AxisRow { state: AxisState::Streaming, servo_error: 0.0, velocity: 0.0, ..row(0).axes[0].1 };
    let circle = CircleReport {
        line: 7,
        plane: [Axis::X, Axis::Y],
        center_mm: [10.0, 20.0],
        radius_mm: 5.0,
        feed_mm_min: 2000.0,
        swept_deg: 360.0,
        t_s: 0.0,
        begin_cycle: 0,
        end_cycle: CYCLES,
        round_max_um: 2.0,
        mean_um: 2.0,
        quadrants_um: [0.11, 0.22, 0.33, -0.44],
    };
    let limits = *summary().limits.get(&Axis::X).expect("limits of X");
    let axes = [Axis::X, Axis::Y, Axis::Z];
    let moves =
        MovesReport { contour_max_um: 2.0, starved: 3, circles: vec![circle], ..MovesReport::default() };
    let summary =
        Summary { passes: Vec::new(), moves, limits: axes.map(|axis| (axis, limits)).into(), ..summary() };
    let folder = tempfile::tempdir().expect("a temporary folder");
    summary.write(&folder.path().join("summary.json")).expect("summary");
    let path = folder.path().join(Format::Csv.file_name());
    let mut trace = TraceWriter::create(&path, Format::Csv, &axes).expect("trace");
    for cycle in 0..CYCLES {
        let (sin, cos) = libm::sincos(core::f64::consts::TAU * cycle as f64 / CYCLES as f64);
        let along = |center: f64, radial: f64, velocity: f64| AxisRow {
            commanded: center + 5.0 * radial,
            true_mm: center + 5.002 * radial,
            velocity,
            ..at_rest
        };
        let axes =
            vec![(Axis::X, along(10.0, cos, -sin)), (Axis::Y, along(20.0, sin, cos)), (Axis::Z, at_rest)];
        trace.row(&Row { axes, pass: 0, line: 7, ..row(cycle) }).expect("row");
    }
    trace.finish().expect("finished");
    let page = page_of(folder.path());
    for needed in [
        "Circle in line 7",
        "2.00 µm at 180.0°",
        "+0.11, +0.22, +0.33, -0.44",
        "Contour error over time",
        "Y (mm)",
        "stopped 3 times",
        "2.00 µm",
    ] {
        assert!(page.contains(needed), "{needed} is missing");
    }
    let drawn = page.split("true path").next().unwrap_or_default();
    assert!(!drawn.contains("radius (mm)"), "a mill has no radius");
}

/// A surface in line 5 along X, the true tool 1 µm off it and 3.21 µm at one place.
#[test]
fn a_surface_has_a_table_a_map_and_its_feed() {
    let at_rest =
        AxisRow { state: AxisState::Streaming, servo_error: 0.0, velocity: 0.0, ..row(0).axes[0].1 };
    let trace = TraceReport {
        trace: 1,
        line: 5,
        kind: WorkKind::Surface,
        origin_mm: [10.0, 20.0, 0.0],
        cut_cycles: CYCLES,
        way_mm: 60.0,
        reach_mm: [[0.0, 60.0], [0.0, 30.0], [0.0, 1.0]],
        slide: DeviationReport {
            low_um: -1.0,
            high_um: 3.21,
            worst_mm: [30.0, 5.0, 0.0],
            ..Default::default()
        },
        feed: FeedReport {
            programmed_mm_min: 1800.0,
            held_pct: 98.7,
            unexplained_s: 0.25,
            ..Default::default()
        },
        ..TraceReport::default()
    };
    let limits = *summary().limits.get(&Axis::X).expect("limits of X");
    let axes = [Axis::X, Axis::Y, Axis::Z];
    let limits = axes.map(|axis| (axis, limits)).into();
    let summary = Summary { passes: Vec::new(), traces: vec![trace], limits, ..summary() };
    let folder = tempfile::tempdir().expect("a temporary folder");
    summary.write(&folder.path().join("summary.json")).expect("summary");
    let path = folder.path().join(Format::Csv.file_name());
    let mut trace = TraceWriter::create(&path, Format::Csv, &axes).expect("trace");
    for cycle in 0..CYCLES {
        let x = 10.0 + 60.0 * cycle as f64 / CYCLES as f64;
        let at = |commanded: f64| AxisRow { commanded, ..at_rest };
        let deviation_mm = if cycle == CYCLES / 2 { 0.00321 } else { -0.001 };
        let slide = TracedPoint { deviation_mm, feed_mm_min: 1777.5, angle_deg: 0.0 };
        let traced =
            Traced { trace: 1, commanded: TracedPoint { feed_mm_min: 1800.0, ..Default::default() }, slide };
        let axes = vec![(Axis::X, at(x)), (Axis::Y, at(25.0)), (Axis::Z, at_rest)];
        trace.row(&Row { axes, pass: 0, line: 5, traced, ..row(cycle) }).expect("row");
    }
    trace.finish().expect("finished");
    let page = page_of(folder.path());
    for needed in [
        "<h2>Contours, surfaces, seams</h2>",
        "Surface in line 5: the deviation over the part",
        "Surface in line 5: deviation and feed",
        "-1.00…+3.21",
        "1800; 98.7",
        "heatmap",
        "3.21,",
        "1777.5",
        "kept to its surface within 3.21 µm",
        "For 0.250 s the feed was low",
    ] {
        assert!(page.contains(needed), "{needed} is missing");
    }
}

#[test]
fn the_path_is_told_apart_by_tool_and_motion() {
    let summary = Summary { passes: Vec::new(), ..summary() };
    let mut curves = super::curves::Curves::new(&summary);
    // Two tools, each in rapid motion and at a feed; in the middle of the last stroke more rows are missing
    // than a thinned trace leaves out.
    for cycle in (0..40).filter(|cycle| !(33..36).contains(cycle)) {
        let (tool, motion) =
            (1 + (cycle / 20) as u32, [Motion::Rapid, Motion::Feed][(cycle / 10 % 2) as usize]);
        let mut at =
            Row { led: Led { tool, motion }, ..row(cycle + if cycle < 36 { 0 } else { rig::trace::STRIDE }) };
        at.axes.iter_mut().for_each(|(_, axis)| {
            axis.state = AxisState::Streaming;
            (axis.true_mm, axis.slide) = (cycle as f64, cycle as f64);
        });
        curves.add(&summary, &at);
    }
    let figure = curves.path.figure();
    let drawn = figure.plot["data"].as_array().expect("strokes");
    let seen: Vec<_> = drawn.iter().map(|one| (one["name"].as_str(), one["line"]["dash"].as_str())).collect();
    let of = |name, dash| (Some(name), Some(dash));
    let dashed = "4px,3px";
    let expected =
        [of("T1 rapid", dashed), of("T1 feed", "solid"), of("T2 rapid", dashed), of("T2 feed", "solid")];
    assert_eq!(seen, expected);
    assert_ne!(drawn[0]["line"]["color"], drawn[2]["line"]["color"]);
    let z: Vec<_> = drawn[3]["x"].as_array().expect("places").iter().map(|z| z.as_f64()).collect();
    let gap = z.iter().position(Option::is_none).expect("the pen is lifted");
    assert_eq!((z[gap - 1], z[gap + 1]), (Some(32.0), Some(36.0)));
    // Ten rows of half a millisecond each; a step of a millimetre in X and in Z from row to row.
    let table = curves.tools.table().expect("tools");
    let cells: Vec<_> =
        table.rows.iter().map(|row| (row[0].as_str(), row[2].as_str(), row[6].as_str())).collect();
    assert_eq!(cells, [("1", "0.01", "26.9"), ("2", "0.01", "22.6")]);
}

#[test]
fn a_run_without_a_tool_has_no_table_of_tools() {
    let summary = summary();
    let mut curves = super::curves::Curves::new(&summary);
    curves.add(&summary, &Row { led: Led::default(), ..row(0) });
    assert!(curves.tools.table().is_none());
}
