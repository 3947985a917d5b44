//! Ideal passes: what they leave is the profile of the tool, and what they take adds up to the groove.

use base64::prelude::{BASE64_STANDARD, Engine as _};
use protocol::{Axis, AxisState};
use rig::observe::{GaugeLimits, GaugeReport, PassReport, StockReport, Summary, ToolNote};
use rig::trace::Row;

use super::chips::chips;
use super::limits::{both, corners};
use super::section::surface;
use super::thread::Thread;
use super::whole;
use crate::paint::Figure;
use crate::run::curves::Curves;
use crate::run::tests::{row, summary};

/// Crest of the thread, full depth, lead; nose of the tool of 60°.
const CREST: f64 = 10.0;
const DEPTH: f64 = 1.2;
const LEAD: f64 = 2.0;
const NOSE: f64 = 0.2;

/// Depth of a pass, how far along Z it lies from the first one, and its start.
type Cut = (f64, f64, u32);

/// A run of ideal passes along 12 turns from Z 0, of a machine whose zero is not that of the program.
fn cut(passes: &[Cut], inside: bool) -> (Summary, Curves) {
    const CYCLES: u64 = 400;
    let origin = [100.0, 50.0];
    let sign = if inside { -1.0 } else { 1.0 };
    let pass = |(i, (depth, _, start)): (usize, &Cut)| PassReport {
        pass: i as u32 + 1,
        start: *start,
        tool_number: 3,
        origin_mm: Some(origin),
        lead_mm: -LEAD,
        delta_x_mm: -sign,
        depth_mm: *depth,
        x_moments_deg: [0.0, 0.0, 4320.0, 4320.0],
        z_moments_deg: [0.0, 0.0, 4320.0, 4320.0],
        thread_end_deg: 4320.0,
        armed_cycle: i as u64 * CYCLES,
        end_cycle: (i as u64 + 1) * CYCLES - 1,
        ..summary().passes[0].clone()
    };
    let tool = ToolNote { angle_deg: Some(60.0), nose_mm: Some(NOSE), ..ToolNote::default() };
    let passes_of = passes.iter().enumerate().map(pass).collect();
    let summary = Summary { passes: passes_of, tools: [(3, tool)].into(), ..summary() };
    let mut curves = Curves::new(&summary);
    for cycle in 0..CYCLES * passes.len() as u64 {
        let (depth, aside, _) = passes[(cycle / CYCLES) as usize];
        let deg = (cycle % CYCLES) as f64 * 4320.0 / CYCLES as f64 + 3.0;
        let mut at = Row { spindle_true_deg: 7.0 * 4320.0 + deg, ..row(cycle) };
        for (axis, place) in &mut at.axes {
            place.state = AxisState::Locked;
            place.slide = match axis {
                Axis::X => origin[0] + CREST - sign * depth,
                _ => origin[1] + aside - LEAD * deg / 360.0,
            };
            place.programmed = place.slide;
        }
        curves.add(&summary, &at);
    }
    (summary, curves)
}

fn thread(passes: &[Cut], inside: bool) -> Thread {
    let (summary, curves) = cut(passes, inside);
    Thread::of(&summary, &curves.part, curves.shown_index, 0).expect("a thread")
}

/// Half the width of the groove of the tool at a height over its tip.
fn half_width(height: f64) -> f64 {
    let (sin, cos) = libm::sincos(core::f64::consts::FRAC_PI_6);
    let corner = NOSE * (1.0 - sin);
    if height < corner {
        libm::sqrt(height * (2.0 * NOSE - height))
    } else {
        NOSE * cos + (height - corner) * sin / cos
    }
}

/// The area of that groove up to the crest.
fn area(depth: f64) -> f64 {
    let n = 100_000;
    let step = depth / f64::from(n);
    (0..n).map(|i| 2.0 * step * half_width(step * (f64::from(i) + 0.5))).sum()
}

#[test]
fn the_section_of_an_ideal_pass_is_the_profile_of_the_tool() {
    for inside in [false, true] {
        let thread = thread(&[(DEPTH, 0.0, 0)], inside);
        assert!((thread.crest_at(-5.0) - if inside { -CREST } else { CREST }).abs() < 1e-9);
        let surface = surface(&thread);
        for height in [0.02, 0.07, 0.3, 0.8, 1.15] {
            let y = thread.root_mm + height;
            let crossing = |two: &[(f64, f64)]| {
                let [(z0, y0), (z1, y1)] = [two[0], two[1]];
                ((y0 > y) != (y1 > y)).then(|| z0 + (z1 - z0) * (y - y0) / (y1 - y0))
            };
            let crossings: Vec<f64> = surface.windows(2).filter_map(crossing).collect();
            let near = |side: f64| {
                let wanted = thread.middle_mm + side * half_width(height);
                crossings.iter().map(|z| (z - wanted).abs()).fold(f64::INFINITY, f64::min)
            };
            // The line is thinned by 0.1 µm across it; along Z that is most where it is flat.
            let slack = if height < 0.1 { 3e-4 } else { 1.2e-4 };
            assert!(near(-1.0) < slack && near(1.0) < slack, "{height}: {} {}", near(-1.0), near(1.0));
            let outline = thread.outline(&thread.passes);
            let found = outline.at(thread.middle_mm + half_width(height), thread.crest_at(thread.middle_mm));
            assert!((found - y).abs() < 1e-7, "{height}: {found} for {y}");
        }
    }
}

#[test]
fn chips_add_up_to_the_groove() {
    let flank = libm::tan(core::f64::consts::FRAC_PI_6);
    let depths = [0.5, 0.8, 1.0, DEPTH, DEPTH];
    let straight: Vec<Cut> = depths.map(|depth| (depth, 0.0, 0)).to_vec();
    let modified: Vec<Cut> = depths.map(|depth| (depth, flank * (DEPTH - depth), 0)).to_vec();
    for passes in [&straight, &modified] {
        for inside in [false, true] {
            let chips = chips(&thread(passes, inside));
            let areas: Vec<f64> = chips.iter().map(|chip| chip.area_mm2).collect();
            assert_eq!(areas.len(), 5);
            let sum: f64 = areas.iter().sum();
            assert!((sum / area(DEPTH) - 1.0).abs() < 1e-3, "{sum} of {}", area(DEPTH));
            assert!((areas[0] / area(0.5) - 1.0).abs() < 1e-3, "{areas:?}");
            assert!(areas[4].abs() < 1e-9, "a spring pass takes nothing: {areas:?}");
        }
    }
}

/// Two grooves beside each other: a pass of the other start takes nothing of this one.
#[test]
fn a_groove_of_two_starts_has_the_chips_of_its_own_passes() {
    let (a, b) = ((0.3, 0.0, 0), (0.3, -0.5 * LEAD, 1));
    let passes = [a, b, (0.45, 0.0, 0), (0.45, -0.5 * LEAD, 1)];
    let thread = thread(&passes, false);
    assert!((thread.pitch_mm - 0.5 * LEAD).abs() < 1e-12);
    let chips = chips(&thread);
    let of: Vec<usize> = chips.iter().map(|chip| chip.index).collect();
    assert_eq!(
        of,
        if thread.middle_mm.rem_euclid(LEAD) < 0.1 { [0, 2] } else { [1, 3] },
        "{}",
        thread.middle_mm
    );
    let sum: f64 = chips.iter().map(|chip| chip.area_mm2).sum();
    assert!((sum / area(0.45) - 1.0).abs() < 1e-3, "{sum} of {}", area(0.45));
}

fn limits(pitch_mm: f64, taper: f64) -> GaugeLimits {
    GaugeLimits {
        side: "external".into(),
        pitch_mm,
        starts: 1,
        flank_deg: [30.0, 30.0],
        pitch_diameter_mm: [18.5, 18.7],
        taper,
        ..GaugeLimits::default()
    }
}

/// Who asks for another thread sees this one as it is.
#[test]
fn a_gauge_of_another_lead_does_not_change_what_was_cut() {
    let (summary, curves) = cut(&[(DEPTH, 0.0, 0)], false);
    for (asked, found) in [(LEAD, LEAD), (1.02 * LEAD, LEAD), (0.5 * LEAD, LEAD)] {
        let gauge = GaugeReport { limits: limits(asked, 0.0), ..GaugeReport::default() };
        let summary = Summary { gauge: Some(gauge), ..summary.clone() };
        let thread = Thread::of(&summary, &curves.part, curves.shown_index, 0).expect("a thread");
        assert_eq!(thread.pitch_mm, found, "{asked}");
    }
}

/// Half a pitch wide at the pitch line, flanks of 30°, crest and root on the cone.
#[test]
fn the_zone_has_the_flanks_and_the_cone_of_its_gauge() {
    for taper in [0.0, 1.0 / 16.0] {
        let limits = limits(LEAD, taper);
        for limit in both(&limits, 1.0, CREST) {
            let [a, b, c, d] = corners(&limits, limit, 1.0, -7.0);
            let pitch = limit.pitch - 7.0 * 0.5 * taper;
            for ((z0, y0), (z1, y1), z_p) in [(a, b, -7.0 - 0.25 * LEAD), (d, c, -7.0 + 0.25 * LEAD)] {
                let slope = (z1 - z0) / (y1 - y0);
                assert!((slope.abs() - libm::tan(core::f64::consts::FRAC_PI_6)).abs() < 1e-9, "{slope}");
                assert!((z0 + slope * (pitch - y0) - z_p).abs() < 1e-9);
                assert!((y0 - limit.crest - 0.5 * taper * z0).abs() < 1e-9);
                assert!((y1 - limit.root - 0.5 * taper * z1).abs() < 1e-9);
            }
        }
    }
}

/// A gauge that limits no crest, of a thread whose depth nobody says, as NPT by G32: the zone is drawn on
/// its cone, half a pitch wide at the pitch line.
#[test]
fn a_tapered_thread_has_its_section_with_the_zone() {
    let (summary, curves) = cut(&[(DEPTH, 0.0, 0)], false);
    let (taper, plane) = (-1.0 / 16.0, -8.0);
    let limits = GaugeLimits { plane_mm: plane, ..limits(LEAD, taper) };
    let gauge = GaugeReport { name: "a cone".into(), limits: limits.clone(), ..GaugeReport::default() };
    let mut summary = Summary { gauge: Some(gauge), ..summary };
    summary.passes[0].depth_mm = 0.0;
    let figures = super::figures(&summary, &curves);
    let [section, ..] = &figures[..] else { panic!("no section") };
    assert!(
        section.caption.contains("what a cone allows") && section.caption.contains("nobody says where it is")
    );
    let thread = Thread::of(&summary, &curves.part, curves.shown_index, 0).expect("a thread");
    let over = 0.375 * LEAD / (2.0 * libm::tan(core::f64::consts::FRAC_PI_6));
    assert!((thread.crest_at(plane) - 0.5 * 18.7 - over).abs() < 1e-9, "{}", thread.crest_at(plane));
    // The crest of the zone is that of the thread where the gauge has its diameters.
    let [go, _] = both(&limits, 1.0, thread.crest_at(plane));
    assert!((go.crest - 0.5 * 18.7 - over).abs() < 1e-9, "{go:?}");
}

#[test]
fn a_thread_has_its_pictures_and_a_run_without_one_has_not() {
    let titles = |(summary, curves): (Summary, Curves)| {
        super::figures(&summary, &curves).into_iter().map(|figure| figure.title).collect::<Vec<_>>()
    };
    assert_eq!(
        titles(cut(&[(DEPTH, 0.0, 0)], false)),
        ["Section of the thread", "Chips of one groove, pass by pass"]
    );
    let nothing = Summary { passes: Vec::new(), ..summary() };
    let curves = Curves::new(&nothing);
    assert!(super::table(&nothing, &curves).is_none());
    assert!(titles((nothing, curves)).is_empty());
}

/// The outline above the axis has the depth of the thread, in diameters; a right-handed flank goes on by a
/// quarter of its lead from the edge of the picture to the axis.
#[test]
fn the_whole_part_is_drawn_with_its_thread() {
    let (summary, curves) = cut(&[(DEPTH, 0.0, 0)], false);
    let figure = whole(&summary, &curves).expect("a picture");
    let trace = |name: &str| drawn(&figure, name);
    let outline: Vec<(f64, f64)> = trace("outline").into_iter().flatten().collect();
    let most = outline.iter().map(|(_, x)| *x).fold(0.0, f64::max);
    assert!((most - 2.0 * CREST).abs() < 1e-3, "{most}");
    for (half, sign) in [(0.0, 1.0), (0.5, -1.0)] {
        let grooves = outline.iter().filter(|(z, x)| sign * x > 1.0 && *z < -0.1 && *z > -23.0);
        let root = grooves.min_by(|a, b| a.1.abs().total_cmp(&b.1.abs())).expect("a root");
        assert!((root.1.abs() - 2.0 * (CREST - DEPTH)).abs() < 0.02, "{root:?}");
        let turns = root.0 / LEAD - half;
        assert!((turns - turns.round()).abs() < 0.02, "{root:?}: half a turn on, half a lead on");
    }
    let flank: Vec<(f64, f64)> = trace("edges and flanks").into_iter().map_while(|at| at).collect();
    let [first, .., last] = &flank[..] else { panic!("{flank:?}") };
    assert!((last.0 - first.0 - 0.25 * LEAD).abs() < 1e-3 && last.1.abs() < 1e-3, "{flank:?}");
    assert_eq!(figure.plot["layout"]["yaxis"]["scaleratio"].as_f64(), Some(0.5), "diameters");
}

/// A thread that ends in a high shoulder: above the axis and below the last flank goes on to the top of it,
/// beyond the length of the thread, and behind that the part is as wide as the shoulder.
#[test]
fn the_last_flank_goes_through_a_shoulder() {
    let shoulder = 20.0;
    let (mut summary, curves) = cut(&[(DEPTH, 0.0, 0)], false);
    let rows_mm = vec![[-60.0, shoulder], [-20.0, shoulder], [-20.0, CREST], [0.0, CREST]];
    summary.stock = Some(StockReport { rows_mm, ..StockReport::default() });
    let figure = whole(&summary, &curves).expect("a picture");
    let outline: Vec<(f64, f64)> = drawn(&figure, "outline").into_iter().flatten().collect();
    for (sign, last_tip) in [(1.0, -22.0), (-1.0, -23.0)] {
        let wide = outline.iter().filter(|(_, x)| (sign * x - 2.0 * shoulder).abs() < 0.01);
        let top = wide.map(|(z, _)| *z).filter(|z| *z < -20.5).fold(f64::NEG_INFINITY, f64::max);
        let flank_ends = last_tip - half_width(shoulder - CREST + DEPTH);
        assert!((top - flank_ends).abs() < 0.05, "{sign}: {top}, not {flank_ends}");
    }
}

/// A trace of a picture: Z and diameter.
fn drawn(figure: &Figure, name: &str) -> Vec<Option<(f64, f64)>> {
    let data = figure.plot["data"].as_array().expect("traces");
    let trace = data.iter().find(|trace| trace["name"] == name).expect("the trace");
    let numbers = |axis: &str| -> Vec<Option<f64>> {
        match trace[axis].as_array() {
            Some(numbers) => numbers.iter().map(serde_json::Value::as_f64).collect(),
            None => packed(trace[axis]["bdata"].as_str().expect("numbers")),
        }
    };
    numbers("x").into_iter().zip(numbers("y")).map(|(x, y)| Some((x?, y?))).collect()
}

/// Numbers as they are packed for the page; none where the pen is lifted.
fn packed(text: &str) -> Vec<Option<f64>> {
    let bytes = BASE64_STANDARD.decode(text).expect("packed numbers");
    let number = |four: &[u8]| f32::from_le_bytes(four.try_into().expect("four bytes"));
    bytes.chunks(4).map(|four| Some(f64::from(number(four))).filter(|number| number.is_finite())).collect()
}
