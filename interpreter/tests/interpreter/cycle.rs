//! G76: which passes a cycle has, and where. The numbers are those LinuxCNC's interpreter gives for the same
//! words (four decimals): Z of the start, X at depth, Z of the end of every pass.

use protocol::{Axis, Code, Item, SpindleSpeed, ThreadPass};

use crate::{good, listing, passes};

const PREAMBLE: &str = "G21 G18 G90\n";

/// Start Z, X at depth, Z at the end.
fn path(pass: &ThreadPass) -> [f64; 3] {
    let (x, z) = (pass.axis(Axis::X), pass.axis(Axis::Z));
    [z.start.mm(), x.start.mm() + x.stroke_mm, z.end.mm()]
}

fn assert_paths(passes: &[ThreadPass], expected: &[[f64; 3]]) {
    for (n, (pass, expected)) in passes.iter().zip(expected).enumerate() {
        for (got, expected) in path(pass).iter().zip(expected) {
            assert!((got - expected).abs() < 6e-5, "pass {}: {:?}, not {expected:?}", n + 1, path(pass));
        }
    }
}

#[test]
fn external_metric_thread_with_flank_infeed() {
    let source = format!(
        "{PREAMBLE}G8 M3 S500\nG0 X7 Z4\nG76 P1.5 Z-20 I-2 J0.2 K0.92 R1.5 Q29.5 H2\nG0 X15\nM5\nM2\n"
    );
    let passes = passes(&good(&source).items);
    let expected = [
        [3.8868, 4.8000, -19.5926],
        [3.8204, 4.6825, -19.6591],
        [3.7646, 4.5840, -19.7149],
        [3.7149, 4.4960, -19.7646],
        [3.6691, 4.4152, -19.8104],
        [3.6264, 4.3396, -19.8531],
        [3.5859, 4.2681, -19.8936],
        [3.5474, 4.2000, -19.9321],
        [3.5104, 4.1347, -19.9691],
        [3.4795, 4.0800, -20.0],
        [3.4795, 4.0800, -20.0],
        [3.4795, 4.0800, -20.0],
    ];
    assert_eq!(passes.len(), expected.len());
    assert_paths(&passes, &expected);
    for (n, pass) in (1..).zip(&passes) {
        assert_eq!((pass.pass, pass.start, pass.start_angle_deg), (n, 0, 0.0));
        assert_eq!((pass.lead_mm, pass.direction, pass.s_rpm), (-1.5, 1.0, 500.0));
        let x = pass.axis(Axis::X);
        assert_eq!((x.start.mm(), x.end.mm()), (7.0, 7.0), "X starts and ends on the drive line");
    }
}

/// The cycle of the reference ends with an exit taper: its full depth ends E before the programmed end.
#[test]
fn diameters_halve_i_j_and_k() {
    let source = format!(
        "{PREAMBLE}G7 M3 S400\nG0 X24 Z6\nG76 P2.5 Z-30 I-4 J0.6 K3.067 R1.5 Q29.5 H1 E2.5 L2\nG0 X40\nM2\n"
    );
    let passes = passes(&good(&source).items);
    let expected = [
        [5.8303, 9.7000, -29.3021],
        [5.7306, 9.5238, -29.4018],
        [5.6469, 9.3760, -29.4854],
        [5.5723, 9.2440, -29.5601],
        [5.5037, 9.1228, -29.6287],
        [5.4396, 9.0094, -29.6928],
        [5.3789, 8.9022, -29.7535],
        [5.3211, 8.8000, -29.8113],
        [5.2656, 8.7020, -29.8668],
        [5.2122, 8.6075, -29.9202],
        [5.1605, 8.5162, -29.9719],
    ];
    assert_eq!(passes.len(), 13, "12 passes and a spring pass");
    assert_paths(&passes, &expected);
    assert!((path(&passes[12])[1] - (10.0 - 1.5335)).abs() < 1e-9 && path(&passes[12])[2] == -30.0);
}

#[test]
fn internal_thread_moves_outwards() {
    let source = format!("{PREAMBLE}M3 S350\nG0 X8 Z3\nG76 P1.25 Z-18 I1 J0.15 K0.7 R1.7 Q29 H3\nM2\n");
    let passes = passes(&good(&source).items);
    assert_paths(
        &passes,
        &[[2.9169, 9.15, -17.6951], [2.8750, 9.2255, -17.7370], [2.8413, 9.2863, -17.7707]],
    );
    assert!(passes.iter().all(|pass| pass.axis(Axis::X).stroke_mm > 0.0));
    assert!(passes.iter().all(|pass| pass.axis(Axis::X).retract_mm == -pass.axis(Axis::X).stroke_mm));
}

#[test]
fn inches_scale_every_length() {
    let inches =
        format!("{PREAMBLE}G20 M3 S350\nG0 X.5 Z.25\nG76 P.05 Z-.5 I-.1 J.01 K.03 H1 E.1 L2 Q29\nM2\n");
    let mm = format!(
        "{PREAMBLE}M3 S350\nG0 X12.7 Z6.35\nG76 P1.27 Z-12.7 I-2.54 J.254 K.762 H1 E2.54 L2 Q29\nM2\n"
    );
    let (inches, mm) = (passes(&good(&inches).items), passes(&good(&mm).items));
    assert_eq!(inches.len(), mm.len());
    for (a, b) in inches.iter().zip(&mm) {
        assert!(path(a).iter().zip(path(b)).all(|(a, b)| (a - b).abs() < 1e-9));
        assert!((a.thread_end_deg - b.thread_end_deg).abs() < 1e-6);
    }
}

#[test]
fn an_incremental_end_is_measured_from_the_start_point() {
    let words = "I-2 J.499 K.5";
    let absolute = format!("{PREAMBLE}M3 S350\nG0 X12 Z6\nG76 P1 Z-14 {words}\nM2\n");
    let incremental = format!("{PREAMBLE}M3 S350\nG0 X12 Z6\nG91 G76 P1 Z-20 {words}\nM2\n");
    assert_eq!(passes(&good(&absolute).items), passes(&good(&incremental).items));
}

#[test]
fn between_passes_the_tool_goes_back_along_the_drive_line() {
    let source = format!("{PREAMBLE}S300 M3\nG0 X12 Z5\nG76 P2 Z-15 I-2 J0.5 K1 Q10\nG0 X20\nM2\n");
    let check = good(&source);
    let expected = "2 spindle 300\n3 rapid X12 Z5\n4 rapid X12 Z4.91183651\n4 pass 1 X12 Z4.91183651 to Z\
                    -14.911836509\n4 rapid X12 Z4.823673019\n4 pass 2 X12 Z4.823673019 to Z-15\n5 rapid X20 \
                    Z-15\n6 spindle stop\n6 end\n";
    assert_eq!(listing(&check.items), expected);
    assert_eq!(check.passes.len(), 2);
    assert_eq!(check.passes[1].line, 4);
    assert_eq!(check.passes[1].depth_mm, Some(1.0));
}

#[test]
fn tapers_lie_at_the_ends_of_the_helix() {
    let source = format!("{PREAMBLE}M3 S300\nG0 X12 Z5\nG76 P2 Z-25 I-2 J0.3 K1.2 R2 Q30 H1 E2 L3\nM2\n");
    for pass in passes(&good(&source).items) {
        let (x, z) = (*pass.axis(Axis::X), *pass.axis(Axis::Z));
        let law = x.law(pass.s_rpm);
        let depth = x.stroke_mm;
        let start = z.run_in_c0_deg + 0.5 * z.run_in_dc_deg;
        // At the start point X is K short of depth, E further along it is at depth.
        assert!((law.at(start).s - (depth + 1.2)).abs() < 1e-6, "{}", law.at(start).s);
        assert_eq!(law.at(start + 360.0).s, depth, "E is one lead long here");
        // E after the end of full depth it has risen by K, and Z has not begun to brake.
        assert!((law.at(pass.thread_end_deg + 360.0).s - (depth + 1.2)).abs() < 1e-6);
        assert!(z.brake_c_deg >= pass.thread_end_deg + 360.0 - 1e-9);
    }
}

#[test]
fn a_left_hand_thread_needs_nothing_special() {
    let source = format!("{PREAMBLE}M4 S300\nG0 X12 Z-25\nG76 P2 Z5 I-2 J.999 K1\nM2\n");
    let check = good(&source);
    let pass = passes(&check.items)[0];
    assert_eq!((pass.direction, pass.lead_mm), (-1.0, 2.0));
    let at_300 = |item: &Item| matches!(item.code, Code::Spindle { speed: SpindleSpeed::Rpm(300.0), .. });
    assert!(check.items.iter().any(at_300));
}
