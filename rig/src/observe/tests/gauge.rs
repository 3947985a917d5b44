//! What is injected into an ideal machine is what the gauge finds.

use std::collections::BTreeMap;

use gauge::{Nominal, Side};
use protocol::{Axis, ThreadPass};

use super::ideal::{Ideal, Injected, lay_out, pass};
use crate::observe::{GaugeAsked, GaugeReport, Observation, PartVerdict};

/// Radius of the tip of [`pass`] at depth, and half a pitch over the tangents of two flanks of 30° above it
/// the pitch line.
const PITCH_DIAMETER_MM: f64 = 2.0 * (11.0 + 0.866_025_403_784_438_6);

/// A thread that the passes leave, 50 µm to either limit.
fn nominal() -> Nominal {
    Nominal {
        name: "thread".into(),
        side: Side::External,
        flank_deg: [30.0; 2],
        pitch_mm: 2.0,
        starts: 1,
        grows: false,
        pitch_diameter_mm: [PITCH_DIAMETER_MM - 0.05, PITCH_DIAMETER_MM + 0.05],
        crest_mm: [None; 2],
        root_go_mm: None,
        root_mm: [None; 2],
        taper: 0.0,
        plane_mm: 0.0,
        gauge_mm: 10.0,
        tap_mm: None,
        blunt_turns: None,
        left_out: &[],
    }
}

fn observed(nominal: Nominal, passes: &[(ThreadPass, Injected)]) -> Observation {
    let mut ideal = Ideal::new();
    ideal.gauge = Some(GaugeAsked { nominal, origins_mm: BTreeMap::new(), passes: None });
    ideal.run(passes, |_, _| {})
}

/// What is judged is the length that the program calls its thread, wherever that lies on the machine.
#[test]
fn the_length_does_not_depend_on_where_zero_of_the_program_lies() {
    let length_mm = |z: f64| {
        // The part is cut where it is clamped.
        let mut passes = [pass(1), pass(2)];
        passes.iter_mut().for_each(|pass| {
            let axis = &mut pass.axes[Axis::Z.index()];
            axis.start = protocol::Position::from_mm(axis.start.mm() + z);
        });
        let mut ideal = Ideal::new();
        let origins_mm = BTreeMap::from([1, 2].map(|number| (number, [0.0, z])));
        ideal.zero = Some([0.0, z]);
        ideal.gauge = Some(GaugeAsked { nominal: nominal(), origins_mm, passes: None });
        let report = ideal.run(&passes.map(|pass| (pass, Injected::default())), |_, _| {}).gauge;
        report.expect("a gauge was asked for").length_mm
    };
    let here_mm = length_mm(0.0);
    assert!(here_mm > 10.0, "{here_mm}");
    // But for one of the stations, 72 a turn, on the border.
    [14.0, -50.0, 300.0].iter().for_each(|z| close(length_mm(*z), here_mm, 2.0 / 72.0 + 1e-6));
}

fn gauged(nominal: Nominal, passes: &[(ThreadPass, Injected)]) -> GaugeReport {
    observed(nominal, passes).gauge.expect("a gauge was asked for")
}

fn with_slide(slide_at_um: fn(Axis, f64) -> f64) -> Injected {
    Injected { slide_at_um: Some(slide_at_um), ..Injected::default() }
}

#[track_caller]
fn close(measured: f64, expected: f64, tolerance: f64) {
    assert!((measured - expected).abs() <= tolerance, "measured {measured}, expected {expected}");
}

#[test]
fn m158_a_thread_without_errors_is_good_and_as_large_as_its_tool_makes_it() {
    for (direction, starts) in [(1.0, 1), (-1.0, 1), (1.0, 3), (-1.0, 2)] {
        let of_start = |start: u32| {
            let mut pass = pass(1 + start);
            (pass.direction, pass.start) = (direction, start);
            (pass.start_angle_deg, pass.lead_mm) =
                (360.0 / f64::from(starts) * f64::from(start), -2.0 * f64::from(starts));
            lay_out(&mut pass);
            (pass, Injected::default())
        };
        let passes: Vec<_> = (0..starts).map(of_start).collect();
        let grows = direction < 0.0;
        let report = gauged(Nominal { starts, grows, ..nominal() }, &passes);
        assert_eq!((report.verdict, &report.reasons[..]), (PartVerdict::Good, &[][..]), "{report:?}");
        close(report.pitch_diameter_min_mm, PITCH_DIAMETER_MM, 1e-6);
        close(report.pitch_diameter_max_mm, PITCH_DIAMETER_MM, 1e-6);
        close(report.virtual_pitch_diameter_mm, PITCH_DIAMETER_MM, 1e-6);
        assert!(report.drunkenness_um < 1e-3 && report.runout_um < 1e-3, "{report:?}");
        assert!(report.length_mm > 9.0, "{report:?}");
        let other = gauged(Nominal { starts, grows: !grows, ..nominal() }, &passes);
        assert_eq!(other.reasons, ["the thread is wound the other way"]);
    }
}

#[test]
fn lead_drunkenness_and_runout_are_those_of_the_slides() {
    let long = Injected { lead_error_um_per_rev: -1.5, ..Injected::default() };
    // Z falls along the thread: 1.5 µm less in a turn of −2 mm is long, over 10 mm 7.5 µm.
    close(gauged(nominal(), &[(pass(1), long)]).lead_error_um, 7.5, 1e-3);
    let drunken = with_slide(|axis, c| if axis == Axis::Z { 4.0 * libm::sin(c.to_radians()) } else { 0.0 });
    close(gauged(nominal(), &[(pass(1), drunken)]).drunkenness_um, 8.0, 0.02);
    let eccentric = with_slide(|axis, c| if axis == Axis::X { 3.0 * libm::cos(c.to_radians()) } else { 0.0 });
    close(gauged(nominal(), &[(pass(1), eccentric)]).runout_um, 6.0, 0.02);
}

#[test]
fn a_thread_that_is_shallow_or_was_cut_beside_itself_makes_the_part_bad() {
    let shallow = with_slide(|axis, _| if axis == Axis::X { 30.0 } else { 0.0 });
    let observation = observed(nominal(), &[(pass(1), shallow)]);
    let why = "thread: GO does not go on: virtual pitch diameter 23.7921 mm, at most 23.7821 (cut 5.0 µm too shallow)";
    let summary = observation.summary("part.ngc", "virtual");
    assert_eq!(summary.part.verdict, PartVerdict::Bad);
    assert!(summary.part.reasons.iter().any(|reason| reason == why), "{:?}", summary.part.reasons);

    let beside = with_slide(|axis, _| if axis == Axis::Z { 40.0 } else { 0.0 });
    let report = gauged(nominal(), &[(pass(1), Injected::default()), (pass(2), beside)]);
    close(report.pitch_diameter_min_mm, PITCH_DIAMETER_MM - 0.04 * 3.0_f64.sqrt(), 1e-6);
    assert_eq!(report.verdict, PartVerdict::Bad);
    assert!(report.reasons[0].ends_with("(passes 40.0 µm apart)"), "{:?}", report.reasons);
}

#[test]
fn what_was_not_cut_has_no_verdict() {
    let broken = Injected { broken_off_deg: Some(300.0), ..Injected::default() };
    assert_eq!(gauged(nominal(), &[(pass(1), broken)]).verdict, PartVerdict::None);
}

#[test]
fn another_thread_is_refused_without_figures() {
    let passes = [(pass(1), Injected::default())];
    let of = |off_mm: f64, side: Side| Nominal {
        pitch_diameter_mm: nominal().pitch_diameter_mm.map(|mm| mm + off_mm),
        side,
        ..nominal()
    };
    for (asked, says) in [
        (of(0.0, Side::Internal), "the thread is cut towards the axis, as on a shaft, and thread is a nut"),
        (of(-9.0, Side::External), "the groove does not reach the pitch line"),
        (of(4.0, Side::External), "no ridge is left between the grooves"),
    ] {
        let report = gauged(asked, &passes);
        assert_eq!(report.verdict, PartVerdict::Bad, "{report:?}");
        assert!(report.reasons.len() == 1 && report.reasons[0].starts_with(says), "{:?}", report.reasons);
        assert_eq!((report.length_mm, report.pitch_diameter_max_mm, report.flank_deg.len()), (0.0, 0.0, 0));
    }
}
