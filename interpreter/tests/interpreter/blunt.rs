//! Blunt starts: where passes go and at which angle they leave, from the words of the program alone.

use gcode::problem::Severity;
use interpreter::check;
use machine::{Machine, ProgramDialect};
use protocol::{Axis, ThreadPass};

use crate::{good, passes};

/// Holds the passes of a blunt start against the groove: `z` of its helix at the index, its lead (signed
/// along the thread), where the face lies, the turns to the ridge, and X (a radius) by Z.
fn hold(all: &[ThreadPass], [z, lead, face, turns]: [f64; 4], x_at: impl Fn(f64) -> f64) {
    let (length, n) = (lead.abs(), all.len() as f64);
    let leaves = (face + turns * lead - z) / lead * 360.0;
    for (k, pass) in (1..).zip(all) {
        let beside = turns * length * f64::from(k) / n;
        let (x, along) = (pass.axis(Axis::X), pass.axis(Axis::Z));
        let (law_x, law_z) = (pass.law(Axis::X), pass.law(Axis::Z));
        let locked = along.locked_deg().max(x.locked_deg());
        let at = |c: f64| along.start.mm() + law_z.at(c).s;
        assert!((at(locked) - face) * lead < 0.0, "pass {k} is at depth before the face");
        for share in 0..=20 {
            let c = locked + (pass.thread_end_deg - locked) * f64::from(share) / 20.0;
            let turned = (at(c) - z + lead.signum() * beside) / lead - c / 360.0;
            assert!((turned - turned.round()).abs() < 1e-6, "pass {k} lies {beside} beside its groove");
            let depth = x.start.mm() + law_x.at(c).s;
            assert!((depth - x_at(at(c))).abs() < 1e-6, "pass {k}: X{depth} at Z{}", at(c));
        }
        let off = (pass.thread_end_deg - leaves) / 360.0;
        assert!((off - off.round()).abs() < 1e-7, "pass {k} leaves at {}", pass.thread_end_deg);
        assert!((at(pass.thread_end_deg) - (face + turns * lead - lead.signum() * beside)).abs() < 1e-6);
        assert_eq!(pass.start, 0);
        if x.lead_mm == 0.0 {
            assert!((x.end.mm() - x.start.mm()).abs() < 1e-6, "back on the drive line");
        }
    }
}

#[test]
fn all_passes_of_a_blunt_start_leave_at_one_angle() {
    let cycle = "G76 P2 Z-22 I-2.18 J0.84 K2.969 R2 Q29.5 H2\n";
    let program = |s: f64, told: &str| {
        format!(
            "G18 G21 G90 G7 S{s} M3\nG0 X22 Z8\n{cycle}G0 Z8\n({told})\n{cycle}(Blunt_Start, off)\nG0 Z8\n{cycle}M2\n"
        )
    };
    let z = 8.0 - 1.4845 * libm::tan(29.5_f64.to_radians());
    for (s, told, n, turns) in
        [(60.0, "blunt_start, Z0 T0.9 D0.1", 18, 0.9), (900.0, "BLUNT_START, d0.3 t1 z0", 7, 1.0)]
    {
        let found = good(&program(s, told));
        let all = passes(&found.items);
        assert_eq!(all.len(), 30 + n, "the thread, its start, the thread once more");
        hold(&all[15..15 + n], [z, -2.0, 0.0, turns], |_| 11.0 - 1.09 - 1.4845);
        let noted: Vec<_> = found.passes.iter().filter_map(|pass| pass.blunt).collect();
        assert!(noted.len() == n && noted.iter().all(|note| note.turns == turns), "{noted:?}");
        // The tool is out of the groove after the share of its lift that the depth is.
        let note = noted[0];
        let law = all[15].axis(Axis::X);
        let risen = all[15].law(Axis::X).at(law.retract_c_deg + note.over_deg).s - law.stroke_mm;
        assert!((risen - 1.4845).abs() < 1e-6, "{risen}");
        assert!((note.whole_from_mm - (-2.0 * turns - law.retract_dc_deg / 180.0)).abs() < 1e-9);
    }
}

#[test]
fn cones_bores_inches_and_the_other_way_are_taken_as_well() {
    // From Z- to Z+, on a coordinate system of its own, in inches.
    let found = good(
        "G18 G20 G90 G8 S200 M4\nG92 Z0\nG0 X0.5 Z-0.5\n(blunt_start, Z0 T0.5 D0.01)\n\
                      G76 P0.1 Z1.2 I-0.1 J0.02 K0.06\n(blunt_start, off)\nM2\n",
    );
    let all = passes(&found.items);
    let zero = all[0].axis(Axis::Z).start.mm() + 12.7;
    assert_eq!(all.len(), 5);
    hold(&all, [zero - 12.7, 2.54, zero, 0.5], |_| 25.4 * 0.34);
    // A bore.
    let found = good(
        "G18 G21 G90 G7 S200 M3\nG0 X26 Z8\n(blunt_start, Z0 T0.8 D0.2)\nG76 P2 Z-22 I2 J0.8 K2.4\nM2\n",
    );
    hold(&passes(&found.items), [8.0, -2.0, 0.0, 0.8], |_| 13.0 + 1.0 + 1.2);
    // FANUC's box cycle on a cone: R is its change of radius, from the start to the end.
    let mut machine = Machine::plain();
    machine.general.dialect = ProgramDialect::Fanuc;
    let source = "%\nO0001\nG97 S200 M03\nG00 X60. Z10.\n(BLUNT_START, Z0 T0.9 D0.25)\n\
                  G92 X40. Z-22. R-1. F2. Q90000\nM30\n%\n";
    let found = check("o0001.nc", source, &machine);
    let all = passes(&found.items);
    assert_eq!(all.len(), 8, "{:?}", found.diagnostics);
    hold(&all, [10.0 + 0.5, -2.0, 0.0, 0.9], |z| 20.0 - (z + 22.0) / 32.0);
}

#[test]
fn what_is_no_blunt_start_is_refused_with_a_remedy() {
    let refused = |blocks: &str, line: u32, message: &str, help: &str| {
        let program = format!("G18 G21 G90 G7 S300 M3\nG0 X22 Z8\n{blocks}\nG0 X70\nM2\n");
        let found = check("t.ngc", &program, &Machine::plain());
        let errors: Vec<_> =
            found.diagnostics.iter().filter(|found| found.severity == Severity::Error).collect();
        assert_eq!(errors.len(), 1, "{program}: {errors:?}");
        assert!(errors[0].line == line && errors[0].message.contains(message), "{errors:?}");
        assert!(errors[0].help.contains(help), "{errors:?}");
    };
    for (told, message) in [
        ("(blunt_start)", "a comma is missing"),
        ("(blunt_start Z0 T1 D0.1)", "a comma is missing"),
        ("(blunt_start, Z0 T1)", "needs Z, T and D"),
        ("(blunt_start, Z0 T1 D0.1 T1)", "stands there twice"),
        ("(blunt_start, Z0 T1 D0.1 Q1)", "is no word"),
        ("(blunt_start, Z0 T1 Dnan)", "is no word"),
        ("(blunt_start, Z0 T0 D0.1)", "out of range"),
        ("(blunt_start, Z0 T2.1 D0.1)", "out of range"),
        ("(blunt_start, Z0 T1 D-0.1)", "out of range"),
        ("(Higbee, 1)", "is no word that asks for a blunt start"),
        ("(blunt-start, Z0 T1 D0.1)", "is no word that asks for a blunt start"),
    ] {
        refused(told, 3, message, "(blunt_start, Z0 T0.9 D0.1)");
    }
    let cycle = "G76 P2 Z-22 I-2.18 J0.84 K2.969";
    refused(&format!("(blunt_start, Z9 T1 D0.1)\n{cycle}"), 4, "does not go from before Z9", "the face");
    refused(&format!("(blunt_start, Z-20.5 T1 D0.1)\n{cycle}"), 4, "does not go from before", "the face");
    refused(&format!("(blunt_start, Z0 T1 D0.001)\n{cycle}"), 4, "more than 1000 passes", "D be larger");
    refused(
        &format!("(blunt_start, Z7.9 T1 D0.1)\n{cycle}"),
        4,
        "no thread is left",
        "further from the part",
    );
    refused("(blunt_start, Z0 T1 D0.1)\nG33 Z-20 K2", 4, "a thread by G33", "(blunt_start, off)");
}
