//! G33: the path, the retract of the next block, the starts of a multi-start thread.

use interpreter::check;
use machine::{Machine, RunOut};
use protocol::{Axis, Code, WayOut};

use crate::{good, listing, passes};

#[test]
fn the_retract_of_the_next_block_belongs_to_the_pass() {
    let source = "S400 M3\nG0 X19.5 Z4\nG33 Z-25 K1.5\n(out)\nG0 X25\nZ4\nM2\n";
    let check = good(source);
    assert!(check.diagnostics.is_empty());
    let pass = passes(&check.items)[0];
    let (x, z) = (*pass.axis(Axis::X), *pass.axis(Axis::Z));
    assert_eq!((x.start.mm(), x.end.mm(), x.stroke_mm, x.retract_mm), (19.5, 25.0, 0.0, 5.5));
    assert_eq!((z.start.mm(), z.end.mm(), pass.lead_mm), (4.0, -25.0, -1.5));
    assert!(x.retract_c_deg == pass.thread_end_deg && z.brake_c_deg >= x.retract_c_deg);
    assert!(listing(&check.items).contains("6 rapid X25 Z4\n"));
}

/// 0.2 1/min turns a spindle by one count of 2500 lines in 30 ms: X does not retract within a few of them.
#[test]
fn a_stroke_takes_a_hundred_counts_however_slow_the_spindle() {
    for (rpm, least) in [("0.2", 3.6), ("300", 60.0)] {
        let check = good(&format!("S{rpm} M3\nG0 X19.5 Z4\nG33 Z-25 K1.5\nG0 X25\nZ4\nM2\n"));
        let x = *passes(&check.items)[0].axis(Axis::X);
        assert!(x.retract_dc_deg >= least - 1e-9, "{rpm} 1/min: {}", x.retract_dc_deg);
        assert!(x.retract_dc_deg < 1.1 * least || rpm == "300", "{rpm} 1/min: {}", x.retract_dc_deg);
    }
}

#[test]
fn the_modes_of_the_next_block_count() {
    for (next, retract) in
        [("G91 G0 X5", 5.0), ("G7 G0 X51", 6.0), ("#1=30 G0 X30", 10.5), ("g0x[2*10]", 0.5)]
    {
        let check = good(&format!("S400 M3\nG0 X19.5 Z4\nG33 Z-25 K1.5\n{next}\nM2\n"));
        assert_eq!(passes(&check.items)[0].axis(Axis::X).retract_mm, retract, "{next}");
    }
}

#[test]
fn without_a_retract_there_is_a_warning() {
    for next in ["G0 X25 Z4", "G1 X25 F100", "G4 P1\nG0 X25", "G0 X25 S500", "G0 X25 M5", "G0 Z4", "G0 X500"]
    {
        let check =
            check("t", &format!("S400 M3\nG0 X19.5 Z4\nG33 Z-25 K1.5\n{next}\nM2\n"), &Machine::plain());
        let warning = &check.diagnostics[0];
        assert_eq!((warning.code, warning.line), ("no-retract", 3), "{next}");
        let pass = passes(&check.items)[0];
        assert_eq!((pass.axis(Axis::X).retract_mm, pass.axis(Axis::X).end.mm()), (0.0, 19.5));
        assert_eq!(pass.thread_end_deg, pass.axis(Axis::Z).brake_c_deg);
    }
}

/// Without a retract the tool is out of the groove where the next move takes X. Where that says nothing, it
/// is lifted by the machine file's way against the last infeed, and a hold, which would come back, waits.
#[test]
fn the_way_out_of_a_thread_without_a_retract_is_that_of_the_next_move() {
    for (next, clear) in
        [("G1 X28 F100", 28.0), ("G0 X25 Z4", 25.0), ("G0 X15 Z-26", 15.0), ("G4 P1\nG0 X25", 21.5)]
    {
        let source = format!("(on_hold, leave)\nS400 M3\nG0 X19.5 Z4\nG33 Z-25 K1.5\n{next}\nM2\n");
        let check = check("t", &source, &Machine::plain());
        let out = passes(&check.items)[0].out;
        assert_eq!(out.clear.mm(), clear, "{next}");
        assert!((out.free.mm() - 19.5) * (clear - 19.5) > 0.0, "{next}");
        assert_eq!(out.on(WayOut::ON_HOLD), clear != 21.5, "{next}");
    }
}

/// With 10 µm allowed at the tool a count may be 4 µm: a lead of 5 mm needs 313 lines. Where more is allowed
/// there, the 0.05 mm of servo error count, of which it may be a quarter: 100 lines.
#[test]
fn a_coarse_encoder_is_warned_of() {
    for (lines, lead, part_error_um, warned) in [
        (313, "5", 10.0, None),
        (312, "5", 10.0, Some(("313 lines", "threading.part_error_um is 10"))),
        (100, "5", 10.0, Some(("313 lines", "threading.part_error_um is 10"))),
        (1024, "25", 10.0, Some(("1563 lines", "threading.part_error_um is 10"))),
        (100, "5", 100.0, None),
        (99, "5", 100.0, Some(("100 lines", "axis.z.thread_error_mm is 0.05"))),
        (25, "2", 100.0, Some(("40 lines", "axis.z.thread_error_mm is 0.05"))),
    ] {
        let mut machine = Machine::plain();
        (machine.spindle.encoder_lines, machine.threading.part_error_um) = (lines, part_error_um);
        for thread in [format!("G33 Z-25 K{lead}"), format!("G76 P{lead} Z-25 I-1 J0.3 K1.2 R1.5")] {
            let check = check("t", &format!("S100 M3\nG0 X19.5 Z10\n{thread}\nG0 X30\nM2\n"), &machine);
            let told = check.diagnostics.first().map(|found| (found.help.as_str(), found.message.as_str()));
            assert!(
                check.diagnostics.len() == usize::from(warned.is_some()),
                "{thread}: {:?}",
                check.diagnostics
            );
            assert!(
                warned.is_none_or(|(lines, limit)| {
                    told.is_some_and(|(help, message)| help.contains(lines) && message.ends_with(limit))
                }),
                "{thread}: {told:?}"
            );
            assert!(check.diagnostics.iter().all(|found| (found.code, found.line) == ("coarse-encoder", 3)));
        }
    }
}

#[test]
fn k_is_measured_along_the_path() {
    // 3 in X and 4 in Z: K 5 gives leads of 3 and 4.
    let check = good("S100 M3\nG0 X10 Z2\nG33 X28 Z-22 K5\nG0 X40\nM2\n");
    let pass = passes(&check.items)[0];
    let (x, z) = (*pass.axis(Axis::X), *pass.axis(Axis::Z));
    assert!((x.lead_mm - 3.0).abs() < 1e-12 && (z.lead_mm + 4.0).abs() < 1e-12);
    assert_eq!((x.end.mm(), z.end.mm()), (40.0, -22.0));
    assert_eq!((x.run_in_c0_deg, x.run_in_dc_deg), (z.run_in_c0_deg, z.run_in_dc_deg));
    let (x_law, z_law) = (x.law(100.0), z.law(100.0));
    let end = pass.thread_end_deg;
    for step in 0..=2000 {
        let c = end * f64::from(step) / 2000.0;
        assert!((4.0 * x_law.at(c).s + 3.0 * z_law.at(c).s).abs() < 1e-9, "the tool leaves the cone at {c}");
    }
}

#[test]
fn starts_are_told_apart_by_their_helix() {
    let source = "S200 M3\nG0 X20 Z9\nG33 Z-30 K4.5\nG0 X34\nX20 Z10.5\nG33 Z-30 K4.5\nG0 X34\nX19.5 Z12\n\
                  G33 Z-30 K4.5\nG0 X34\nX19.5 Z18\nG33 Z-30 K4.5\nG0 X34\nX19 Z10.5\nG33 Z-30 K3\nG0 X34\n\
                  M4\nX19 Z10.5\nG33 Z-30 K4.5\nG0 X34\nM2\n";
    let starts: Vec<u32> = passes(&good(source).items).iter().map(|pass| pass.start).collect();
    assert_eq!(starts, [0, 1, 2, 0, 0, 0], "9 and 18 are one helix; another lead and direction count anew");
}

#[test]
fn beyond_keeps_full_depth_to_the_programmed_end() {
    let mut machine = Machine::plain();
    machine.threading.run_out = RunOut::Beyond;
    let source = "S400 M3\nG0 X19.5 Z4\nG33 Z-25 K1.5\nG0 X25\nM2\n";
    let beyond = check("t", source, &machine);
    let pass = passes(&beyond.items)[0];
    let end = beyond.passes[0].full_depth_mm[1];
    assert!((end + 25.0).abs() < 1e-9, "{end}");
    assert!(pass.axis(Axis::Z).end.mm() < -25.0);
    assert!(
        listing(&beyond.items).contains("4 rapid X25 Z-25\n"),
        "the programmed point stays as programmed"
    );
    let within = check("t", source, &Machine::plain());
    assert!(within.passes[0].full_depth_mm[1] > -25.0);
}

#[test]
fn a_cycle_beyond_comes_back_to_its_end() {
    let mut machine = Machine::plain();
    machine.threading.run_out = RunOut::Beyond;
    let check = check("t", "S400 M3\nG0 X12 Z4\nG76 P1 Z-20 I-2 J.999 K1\nM2\n", &machine);
    let listing = listing(&check.items);
    assert!(check.is_good() && listing.contains("3 rapid X12 Z-20\n"), "{listing}");
}

#[test]
fn a_run_out_beyond_the_travel_is_refused() {
    let mut machine = Machine::plain();
    machine.threading.run_out = RunOut::Beyond;
    let source = "S1500 M3\nG0 X20 Z-370\nG33 Z-399.9 K3\nG0 X25\nM2\n";
    let refused = check("t", source, &machine);
    assert_eq!(refused.diagnostics[0].code, "travel-limit");
    assert!(
        refused.diagnostics[0].message.contains("axis.z.travel_mm"),
        "{}",
        refused.diagnostics[0].message
    );
    assert!(check("t", source, &Machine::plain()).is_good(), "within the programmed end it can be cut");
}

/// On a face the axes change places: X has the lead, Z lifts the tool, in both dialects and both directions.
#[test]
fn a_thread_on_a_face_runs_along_x_and_z_lifts() {
    for (from, to) in [(20.0, 60.0), (60.0, 20.0)] {
        let linuxcnc = format!(
            "G18 G21 G90 G7 G94 G97\nS300 M3\nG0 X{from} Z2\nG0 Z-0.8\nG33 X{to} K4\nG0 Z2\nG0 X{from}\nM2\n"
        );
        let fanuc = format!(
            "%\nO1\nG21 G18 G97 G99\nS300 M03\nG00 X{from}. Z2.\nG00 Z-0.8\nG32 X{to}. F4.\nG00 Z2.\nG00 X{from}.\nM30\n%\n"
        );
        let mut fanuc_machine = Machine::plain();
        fanuc_machine.general.dialect = machine::ProgramDialect::Fanuc;
        let checks =
            [check("face.ngc", &linuxcnc, &Machine::plain()), check("face.nc", &fanuc, &fanuc_machine)];
        let passes = checks.map(|check| {
            assert!(check.diagnostics.is_empty(), "{:?}", check.diagnostics);
            let [note] = &check.passes[..] else { panic!("one pass: {:?}", check.passes) };
            assert_eq!((note.along, note.across_mm, note.start_mm), (Axis::X, -0.8, 0.5 * from));
            let pass = check.items.into_iter().find_map(|item| match item.code {
                Code::Pass(pass) => Some(pass),
                _ => None,
            });
            pass.expect("a pass")
        });
        assert_eq!(passes[0], passes[1]);
        let (x, z) = (passes[0].axis(Axis::X), passes[0].axis(Axis::Z));
        assert_eq!((x.lead_mm, z.lead_mm, z.retract_mm), (4.0 * (to - from).signum(), 0.0, 2.8));
        assert_eq!((passes[0].out.axis, passes[0].out.clear.mm()), (Axis::Z.index() as u32, 2.0));
        assert_eq!((passes[0].along(), z.end.mm()), (Axis::X, 2.0));
        // Helix of the axis along the thread: at the programmed start at the start angle (phase rule).
        let middle = x.run_in_c0_deg + x.run_in_dc_deg;
        let ran = x.law(300.0).at(middle).s;
        let helix = x.lead_mm * (middle - (x.run_in_c0_deg + 0.5 * x.run_in_dc_deg)) / 360.0;
        assert!((ran - helix).abs() < 1e-9, "{ran} {helix}");
    }
}
