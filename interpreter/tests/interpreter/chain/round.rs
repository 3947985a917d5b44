//! Threads along arcs: where the tool is, against the circle that the program means.

use gcode::problem::Severity;
use interpreter::{Check, check};
use machine::Machine;
use protocol::{Axis, ThreadPass};
use testing::Seed;

use super::{fanuc, fanuc_lathe, only_pass, turn_deg};

/// An arc as it is meant: radius, centre X (a radius) and Z.
struct Circle {
    radius: f64,
    centre: [f64; 2],
}

/// Largest distances from the circle, outside of the windows of the pieces and in them, and of Z from its
/// even lead, mm; between the end of the run-in and where the arc or the thread ends.
fn off(pass: &ThreadPass, circle: &Circle, from_z: f64, lead_z: f64) -> [f64; 3] {
    let (x, z) = (pass.axis(Axis::X), pass.axis(Axis::Z));
    let (x_law, z_law) = (pass.law(Axis::X), pass.law(Axis::Z));
    // Behind the last window the lead of X has stopped to grow.
    let stops = pass.corners().last().map_or(0.0, |corner| corner.c_deg);
    let inside =
        |c: f64| pass.corners().any(|corner| (corner.c_deg..corner.c_deg + corner.dc_deg).contains(&c));
    let (mut most, mut c, mut looks) = ([0.0f64; 3], z.run_in_c0_deg + z.run_in_dc_deg, 0);
    while c < stops.min(pass.thread_end_deg) {
        let at = [x.start.mm() + x_law.at(c).s, z.start.mm() + z_law.at(c).s];
        let from_centre = libm::hypot(at[0] - circle.centre[0], at[1] - circle.centre[1]);
        let which = usize::from(inside(c));
        most[which] = most[which].max((from_centre - circle.radius).abs());
        most[2] = most[2].max((at[1] - from_z - lead_z * (c - turn_deg(pass)) / 360.0).abs());
        (c, looks) = (c + 1.9, looks + 1);
    }
    assert!(looks > 100, "{looks} places");
    most
}

/// 300 arcs of every size, way and side: on the circle within 0.5 um, in the windows of the pieces within
/// 1 um, and Z goes on evenly as if there were no arc.
#[test]
fn a_thread_along_an_arc_lies_on_its_circle() {
    let (mut worst, mut made) = ([0.0f64; 3], 0);
    for case in 0..300 {
        let mut seed = Seed::of_case(case);
        let (s_rpm, lead) = (50.0 + 400.0 * seed.unit(), 0.5 + 0.25 * seed.below(9) as f64);
        let radius = 20.0 * libm::pow(50.0, seed.unit());
        let convex = case % 2 == 0;
        // Places on the arc, as angles from its middle, from Z+ to Z-.
        let reach = 60.0_f64.min(0.6 * radius) / radius;
        let [a, b] = [reach * (0.4 + 0.6 * seed.unit()), -reach * seed.unit()];
        let side = if convex { 1.0 } else { -1.0 };
        let on = |angle: f64| [side * radius * (libm::cos(angle) - 1.0), radius * libm::sin(angle)];
        let [from, to] = [on(a), on(b)];
        let (x0, z0) = (25.0 + from[0], 20.0);
        let (x1, z1) = (25.0 + to[0], 20.0 + to[1] - from[1]);
        let circle = Circle { radius, centre: [25.0 - side * radius, 20.0 - from[1]] };
        let code = if convex { "G36" } else { "G35" };
        let [i, k] = [circle.centre[0] - x0, circle.centre[1] - z0];
        let centre = if case % 4 < 2 { format!("I{i:.9} K{k:.9}") } else { format!("R{radius:.9}") };
        let source = format!(
            "G97 S{s_rpm:.0} M03\nG00 X{:.9} Z{z0:.9}\n{code} X{:.9} Z{z1:.9} {centre} F{lead}\nG00 X90.\n",
            2.0 * x0,
            2.0 * x1
        );
        let program = format!("%\nO0001\n{source}M30\n%\n");
        let check = check("o0001.nc", &program, &fanuc_lathe());
        if let Some(error) = check.diagnostics.iter().find(|found| found.severity == Severity::Error) {
            // Too short for its speed, or too round for its pieces.
            assert!(["pass-not-feasible", "bad-value"].contains(&error.code), "{error:?}\n{program}");
            continue;
        }
        made += 1;
        let pass = only_pass(&check);
        let off = off(&pass, &circle, z0, -lead);
        assert!(off[0] < 6e-4 && off[1] < 1e-3 && off[2] < 1e-9, "case {case}: {off:?} mm\n{program}");
        worst = [0, 1, 2].map(|i| worst[i].max(off[i]));
        assert!(pass.max_ratio >= 1.0 && Machine::plain().can_follow(&pass), "case {case}");
    }
    assert!(made > 200, "{made} of 300 can be made");
    println!("{made} arcs: {worst:?} mm off, in windows, of Z");
}

/// An arc in a chain: tangent to what is before and behind, so that nothing is taken off.
#[test]
fn an_arc_joins_lines_it_is_tangent_to() {
    // A quarter of 45 degrees, R20, from a cylinder of radius 20 down to a cone of 45 degrees.
    let [dz, dx] = [20.0 * core::f64::consts::FRAC_1_SQRT_2, 20.0 * (1.0 - core::f64::consts::FRAC_1_SQRT_2)];
    let source = format!(
        "G97 S150 M03\nG00 X40. Z12.\nG32 Z-10. F1.5\nG36 X{:.6} Z{:.6} R20. F1.5\nG32 U-20. W-10. F1.5\nG00 X90.\n",
        2.0 * (20.0 - dx),
        -10.0 - dz
    );
    let check = fanuc(&source);
    let pass = only_pass(&check);
    let notes = &check.passes[0].corners;
    assert_eq!(notes.iter().map(|corner| corner.line).collect::<Vec<_>>(), [6, 7], "corners of the program");
    assert!(notes.iter().all(|corner| corner.off_mm < 2e-4), "{notes:?}");
    assert!(pass.corners().count() > 4, "the arc is several pieces");
    // X is where the chain ends, Z has gone on evenly.
    let end = pass.axis(Axis::X).end.mm();
    assert!((end - 45.0).abs() < 1e-3, "{end}");
}

/// The error of a program with one block after the approach.
fn refused(block: &str, says: &str, helps: &str) {
    let source = format!("%\nO0001\nG97 S300 M03\nG00 X40. Z5.\n{block}\nG00 X90.\nM30\n%\n");
    let Check { diagnostics, .. } = check("o0001.nc", &source, &fanuc_lathe());
    let error = diagnostics.iter().find(|found| found.severity == Severity::Error).expect("refused");
    assert!(error.line == 5 && error.message.contains(says), "{block}: {error:?}");
    assert!(error.help.contains(helps), "{block}: {error:?}");
}

#[test]
fn arcs_without_a_law_are_refused_with_a_remedy() {
    // Quarter circles end along X.
    refused("G36 X80. Z-15. R20. F2.", "steeper than 45 degrees", "end it where it is at 45 degrees");
    // The other way round it would be the rest of the circle.
    refused("G35 X40. Z-25. I-40. K-15. F2.", "steeper than 45 degrees", "clockwise is as in G02");
    refused("G36 X40. Z-275. R200. F2.", "pieces", "cut less of the arc");
    refused("G36 X40. Z-5. R200. F0.", "lead", "greater than 0");
    refused("G36 X90.", "measures a tool", "centre or radius");
}
