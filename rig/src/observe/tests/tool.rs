//! What the tool does in the material, as injected into an ideal machine: contact, helix, flank and depth.

use machine::{Machine, PLAIN_LATHE, Part};
use protocol::{Axis, Position, ThreadPass};

use super::ideal::{Ideal, Injected, lay_out, pass};
use crate::observe::{
    DeviationReport, GaugeReport, Observation, Outcome, PartVerdict, PassReport, TraceReport,
};

/// Where the tool of [`pass`] enters the stock, degrees: 5 mm at 360°, Z 0 two and a half turns behind.
const FACE_DEG: f64 = 1260.0;
const END_DEG: f64 = 4140.0;

#[track_caller]
fn close(measured: f64, expected: f64, tolerance: f64) {
    assert!((measured - expected).abs() <= tolerance, "measured {measured}, expected {expected}");
}

fn observed(passes: &[ThreadPass], slide_at_um: fn(Axis, f64) -> f64) -> Observation {
    let injected = Injected { slide_at_um: Some(slide_at_um), ..Injected::default() };
    let passes: Vec<_> = passes.iter().map(|pass| (*pass, injected)).collect();
    Ideal::new().run(&passes, |_, _| {})
}

fn one(pass: ThreadPass, slide_at_um: fn(Axis, f64) -> f64) -> PassReport {
    observed(&[pass], slide_at_um).passes.remove(0)
}

#[test]
fn m121_a_slide_that_stands_off_has_a_phase_and_does_not_swing() {
    for (direction, lead) in [(1.0, -2.0), (-1.0, -2.0)] {
        let mut pass = pass(1);
        (pass.direction, pass.lead_mm, pass.start_angle_deg) = (direction, lead, 75.0);
        lay_out(&mut pass);
        let report = one(pass, |axis, _| if axis == Axis::Z { 50.0 } else { 3.0 });
        close(report.tool.phase_um, 50.0, 1e-6);
        close(report.tool.helix_max_abs_um, 0.0, 1e-6);
        close(report.tool.contact_deg, END_DEG - FACE_DEG, 12.0); // 50 µm are 9°
        // From outside: X is a radius, so farther out is too shallow.
        close(report.tool.x_min_um, 3.0, 1e-6);
        close(report.tool.x_max_um, 3.0, 1e-6);
        close(report.phase_um, 0.0, 1e-6);
    }
}

#[test]
fn m120_what_the_tool_does_before_the_face_does_not_count() {
    let report = one(pass(1), |axis, c| match axis {
        Axis::Z if c < FACE_DEG - 2.0 => 90.0,
        Axis::Z if (2000.0..2010.0).contains(&c) => 4.0,
        _ => 0.0,
    });
    // 10 of 2880 degrees are 4 µm off.
    close(report.tool.phase_um, 40.0 / (END_DEG - FACE_DEG), 0.01);
    close(report.tool.helix_max_abs_um, 4.0 - report.tool.phase_um, 1e-6);
    assert!(report.slide_helix_max_abs_um > 89.0);
}

/// X leaves over the last two turns, Z stays on the helix meanwhile: a taper.
fn with_a_taper() -> ThreadPass {
    let mut pass = pass(1);
    let x = &mut pass.axes[Axis::X.index()];
    (x.retract_c_deg, x.retract_dc_deg) = (END_DEG - 720.0, 1440.0);
    pass.thread_end_deg = x.retract_c_deg;
    pass
}

#[test]
fn a_taper_is_contact() {
    let off =
        |axis: Axis, c: f64| if axis == Axis::Z && c > END_DEG - 500.0 && c < END_DEG { 22.0 } else { 0.0 };
    let report = one(with_a_taper(), off);
    assert!(report.helix_max_abs_um < 1e-6 && report.slide_helix_max_abs_um < 1e-6, "not at full depth");
    // 0.2 mm deep: X is above the crest after a third of its stroke's time and a bit.
    assert!(report.tool.contact_deg > END_DEG - 720.0 - FACE_DEG + 300.0, "{:?}", report.tool);
    close(report.tool.helix_max_abs_um, 22.0 - report.tool.phase_um, 1e-6);
    let late = one(with_a_taper(), |axis, c| if axis == Axis::X && c > END_DEG - 600.0 { -7.0 } else { 0.0 });
    close(late.tool.stroke_max_abs_um, 7.0, 1e-6);
    assert_eq!((late.tool.x_min_um, late.tool.x_max_um), (0.0, 0.0), "full depth ends where X leaves");
}

/// X leaves 60° after Z began to brake.
fn with_a_late_retract() -> ThreadPass {
    let mut pass = pass(1);
    pass.axes[Axis::X.index()].retract_c_deg = END_DEG + 60.0;
    pass
}

#[test]
fn m122_a_brake_may_come_as_near_to_the_flank_as_x_has_made_room() {
    // Z brakes before X leaves; how far it lags beyond the room, by the laws alone.
    let pass = with_a_late_retract();
    let (x, z) = (pass.axis(Axis::X).law(pass.s_rpm), pass.axis(Axis::Z).law(pass.s_rpm));
    for half_angle_deg in [14.5, 30.0, 60.0] {
        let tan = libm::tan(half_angle_deg * std::f64::consts::PI / 180.0);
        let beyond_um = |c: f64| {
            let out_mm = x.at(c).s + 1.0;
            let lag_mm = (z.at(END_DEG).s - 2.0 * (c - END_DEG) / 360.0 - z.at(c).s).abs();
            if out_mm < 0.2 { 1e3 * (lag_mm - out_mm * tan) } else { 0.0 }
        };
        let expected = (0..2400).map(|step| beyond_um(END_DEG + 0.1 * f64::from(step))).fold(0.0, f64::max);
        assert!(expected > 10.0, "{expected}");
        let mut ideal = Ideal::new();
        ideal.machine.threading.flank_half_angle_deg = half_angle_deg;
        let report = ideal.run(&[(pass, Injected::default())], |_, _| {}).passes.remove(0);
        close(report.tool.flank_um, expected, 0.05 * expected + 0.01);
        close(report.tool.helix_max_abs_um, report.tool.flank_um, 1e-9);
    }
}

#[test]
fn a_pass_that_does_not_say_its_depth_is_in_contact_until_its_way_out_is_free() {
    let mut pass = with_a_taper();
    pass.depth_mm = 0.0;
    (pass.out.clear, pass.out.free) = (Position::from_mm(12.0), Position::from_mm(11.42));
    // A groove of 0.42 mm, less the margin: X passes 11.4 on its way out, and until there the helix counts.
    let law = pass.axis(Axis::X).law(pass.s_rpm);
    let degrees = (0..1440).map(|step| END_DEG - 720.0 + f64::from(step));
    let out = degrees.clone().find(|c| law.at(*c).s + 1.0 > 0.4).expect("it goes out");
    let report = one(pass, |_, _| 0.0);
    close(report.tool.contact_deg, out.min(END_DEG) - FACE_DEG, 4.0);
    let in_air = ThreadPass { out: Default::default(), ..pass };
    assert_eq!(one(in_air, |_, _| 9.0).tool, Default::default());
}

/// Nobody has said where: wherever G54 and the tool put zero of the program. A machine file is believed.
#[test]
fn stock_of_which_nothing_is_said_lies_below_zero_of_the_program() {
    let contact_deg = |zero_mm: Option<f64>, plant: &str| {
        let mut ideal = Ideal::new();
        ideal.machine.plant = plant.parse().expect("a plant");
        ideal.zero = zero_mm.map(|z| [0.0, z]);
        let passes = [(pass(1), Injected::default())];
        ideal.run(&passes, |_, _| {}).passes.remove(0).tool.contact_deg
    };
    let from = |face_mm: f64| END_DEG - FACE_DEG + 180.0 * face_mm;
    close(contact_deg(None, ""), from(0.0), 4.0);
    close(contact_deg(Some(-3.0), ""), from(-3.0), 4.0);
    close(contact_deg(Some(2.0), ""), from(2.0), 4.0);
    close(contact_deg(Some(-3.0), "[cutting]\nface_mm = -1.0"), from(-1.0), 4.0);
    close(contact_deg(Some(-3.0), "[cutting]\nback_mm = -100.0"), from(0.0), 4.0);
    assert_eq!(contact_deg(Some(-100.0), ""), 0.0, "in the air");
}

#[test]
fn stock_that_lies_elsewhere_is_not_touched() {
    let mut ideal = Ideal::new();
    ideal.machine.plant = "[cutting]\nface_mm = -100.0".parse().expect("a plant");
    let observed = ideal.run(&[(pass(1), Injected { slide_um: 99.0, ..Injected::default() })], |_, _| {});
    assert_eq!(observed.passes[0].tool, Default::default());
    let summary = observed.summary("part.ngc", "virtual");
    assert_eq!((summary.part.verdict, summary.at_the_tool()), (PartVerdict::None, [0.0; 4]));
}

/// A pass of a start, this deep; X strokes 1 mm and the depth of the crest.
fn of(number: u32, start: u32, depth_mm: f64) -> ThreadPass {
    let mut pass = pass(number);
    (pass.start, pass.start_angle_deg, pass.depth_mm) = (start, 180.0 * f64::from(start), depth_mm);
    lay_out(&mut pass);
    let x = &mut pass.axes[Axis::X.index()];
    (x.stroke_mm, x.retract_mm) = (-0.8 - depth_mm, 0.8 + depth_mm);
    pass
}

fn cut(passes: &[(ThreadPass, [f64; 2])]) -> crate::observe::Summary {
    // Both errors of a pass as one number would not do: they are told by its depth and its start.
    let passes: Vec<_> = passes
        .iter()
        .map(|(pass, [phase_um, slide_um])| {
            (*pass, Injected { phase_um: *phase_um, slide_um: *slide_um, ..Injected::default() })
        })
        .collect();
    Ideal::new().run(&passes, |_, _| {}).summary("part.ngc", "virtual")
}

#[test]
fn passes_are_compared_with_those_of_their_start_and_starts_by_their_last_passes() {
    let summary = cut(&[
        (of(1, 0, 0.2), [1.0, 0.0]),
        (of(2, 1, 0.2), [9.0, 0.0]),
        (of(3, 0, 0.3), [4.0, 0.0]),
        (of(4, 1, 0.3), [8.5, 0.0]),
    ]);
    close(summary.thread.tool_phase_spread_um, 3.0, 1e-3);
    close(summary.thread.tool_start_spread_um, 4.5, 1e-3);
    assert_eq!(summary.part.verdict, PartVerdict::Good, "{:?}", summary.part);
}

#[test]
fn the_depth_of_a_thread_is_that_of_its_finishing_passes() {
    let summary =
        cut(&[(of(1, 0, 0.2), [0.0, 40.0]), (of(2, 0, 0.3), [0.0, -3.0]), (of(3, 0, 0.3), [0.0, 2.0])]);
    close(summary.thread.tool_depth_um, 5.0, 1e-3);
    close(summary.thread.tool_depth_off_um, -3.0, 1e-3);
}

#[test]
fn each_figure_has_its_reason() {
    let reasons = |passes: &[(ThreadPass, [f64; 2])]| cut(passes).part.reasons;
    assert_eq!(reasons(&[(of(1, 0, 0.2), [30.0, 0.0])]), [""; 0], "the whole thread elsewhere is no defect");
    let apart = reasons(&[(of(1, 0, 0.2), [0.0, 0.0]), (of(2, 0, 0.3), [12.0, 0.0])]);
    assert!(apart.len() == 1 && apart[0].contains("12.00 µm apart"), "{apart:?}");
    let starts = reasons(&[(of(1, 0, 0.2), [0.0, 0.0]), (of(2, 1, 0.2), [11.0, 0.0])]);
    assert!(starts.len() == 1 && starts[0].contains("starts of a thread lie 11.00 µm"), "{starts:?}");
    let shallow = reasons(&[(of(1, 0, 0.2), [0.0, 15.0])]);
    assert!(shallow.len() == 1 && shallow[0].contains("15.00 µm of radius too shallow"), "{shallow:?}");
    let swings =
        observed(&[pass(1)], |axis, c| if axis == Axis::Z { 20.0 * libm::sin(c / 100.0) } else { 0.0 });
    let swings = swings.summary("part.ngc", "virtual").part;
    assert_eq!((swings.verdict, swings.reasons.len()), (PartVerdict::Bad, 1), "{swings:?}");
    assert!(swings.reasons[0].contains("pass 1 strays by 2"), "{swings:?}");
    let broken = Injected { broken_off_deg: Some(300.0), ..Injected::default() };
    let broken = Ideal::new().run(&[(pass(1), broken)], |_, _| {}).summary("part.ngc", "virtual").part;
    assert_eq!(broken.reasons, ["pass 1 was not cut to its end"]);
}

#[test]
fn a_work_is_judged_by_its_commanded_path() {
    let part = |low_um: f64, slide_um: f64| {
        let of = |low_um: f64| DeviationReport { low_um, ..DeviationReport::default() };
        let (commanded, slide) = (of(low_um), of(slide_um));
        let trace = TraceReport { line: 7, commanded, slide, most_um: Some(2.0), ..TraceReport::default() };
        Observation { traces: vec![trace], outcome: Outcome::Completed, ..Observation::default() }
            .summary("part.toml", "virtual")
            .part
    };
    assert_eq!(part(-1.9, -25.0).verdict, PartVerdict::Good, "what a slide may be off, no job says");
    let gauged = |verdict| {
        let gauge = Some(GaugeReport { verdict, ..GaugeReport::default() });
        let traces = vec![TraceReport { line: 7, most_um: Some(2.0), ..TraceReport::default() }];
        Observation { traces, gauge, outcome: Outcome::Completed, ..Observation::default() }
            .summary("part.toml", "virtual")
            .part
            .verdict
    };
    let all = [PartVerdict::Good, PartVerdict::None];
    assert_eq!(all.map(gauged), all, "a gauge that decides nothing makes no part good");
    let wrong = part(-2.5, -2.5);
    assert_eq!((wrong.verdict, wrong.reasons.len()), (PartVerdict::Bad, 1));
    assert!(wrong.reasons[0].contains("in line 7 the commanded path itself is 2.50 µm off"), "{wrong:?}");
}

/// A bar whose face is at Z 4.5: the tool is on its helix from Z 4 on.
#[test]
fn in_a_part_that_is_known_the_run_in_counts_too() {
    let part = |text: &str| Part::from_comment(text, 1.0).expect("a part").expect("a part");
    let observed = |part: &Part, origin: [f64; 2]| {
        let (mut ideal, item) = (Ideal::new(), pass(1));
        ideal.part = Some((part.clone(), origin));
        ideal.run(&[(item, Injected::default())], |_, _| {}).passes.remove(0).tool
    };
    let far = observed(&part("part, bar D30 L60 Z3"), [0.0; 2]);
    close(far.contact_deg, END_DEG - 720.0, 2.0); // from Z 3 to where X leaves
    assert!(far.helix_max_abs_um < 1e-6, "{far:?}");
    let inside = observed(&part("part, bar D30 L60 Z4.5"), [0.0; 2]);
    assert!(inside.flank_um > 2.0, "{inside:?} {far:?}");
    assert_eq!(observed(&part("part, bar D20 L60 Z3"), [0.0; 2]).contact_deg, 0.0, "X 11 is beside it");
    assert_eq!(
        observed(&part("part, bar D20 L60 Z1"), [5.0, 2.0]).contact_deg,
        far.contact_deg,
        "it lies elsewhere"
    );
}

#[test]
fn a_tool_has_its_angle_and_its_edge() {
    let shaped = |keys: &str| {
        let mut ideal = Ideal::new();
        let file = format!("{PLAIN_LATHE}\n[tools.3]\nname = \"a tool\"\n{keys}\n");
        ideal.machine = Machine::from_toml(&file).expect("a machine with a tool");
        ideal.tool = 3;
        ideal.run(&[(with_a_late_retract(), Injected::default())], |_, _| {}).passes.remove(0).tool
    };
    let plain = shaped("");
    assert_eq!(plain, one(with_a_late_retract(), |_, _| 0.0).tool);
    // 29° between the flanks are what the machine file has.
    assert_eq!(shaped("angle_deg = 29"), plain);
    assert!(shaped("angle_deg = 60").flank_um < plain.flank_um);
    close(shaped("width_mm = 0.4").contact_deg, plain.contact_deg + 36.0, 1.0); // 0.2 mm before the face
}
