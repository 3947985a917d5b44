//! A run folder becomes a page that has everything in it.

use protocol::{Axis, AxisState};
use rig::observe::{AxisLimits, Outcome, PassReport, Summary};
use rig::trace::{AxisRow, Format, Row, TraceWriter};

use super::render;

const CYCLES: u64 = 4000;

fn summary() -> Summary {
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

fn row(cycle: u64) -> Row {
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
    }
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

    let page = std::fs::read_to_string(render(folder.path()).expect("drawn")).expect("read");
    assert!(page.len() < 8_000_000, "{} bytes", page.len());
    assert_eq!(page.matches("<figure>").count(), 6);
    for needed in [
        "keeps within 1.23 µm",
        "12.3",
        "333.25",
        "a&lt;b&gt;.ngc",
        "(a &lt; b &amp; c)",
        "aria-label",
        "Plotly.react",
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
    let page = std::fs::read_to_string(render(folder.path()).expect("drawn")).expect("read");
    assert!(page.contains("without a trace") && page.contains("1.23; ") && !page.contains("<figure>"));
}

#[test]
fn what_is_no_run_folder_is_refused() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let refused = render(folder.path()).expect_err("empty folder").to_string();
    assert!(refused.contains("summary.json") && refused.contains("pitchlock run"), "{refused}");
}
