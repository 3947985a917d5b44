//! A tool that is changed between passes, with other lengths: its axes stand elsewhere, its groove where it
//! was.

use protocol::{Axis, ThreadPass};

use super::turn_deg;
use crate::{good, passes};

/// Where the groove of a pass crosses the index, for a tool that is so long along Z, mm, within one lead.
fn crosses_mm(pass: &ThreadPass, longer_mm: f64) -> f64 {
    let z = pass.axis(Axis::Z);
    (z.start.mm() - z.lead_mm * turn_deg(pass) / 360.0 - longer_mm).rem_euclid(z.lead_mm.abs())
}

#[test]
fn a_tool_of_other_lengths_cuts_in_the_groove_of_the_one_before() {
    let [x, z] = [0.35, 1.737];
    let of = |cut: &str, start: f64| {
        let source = format!(
            "T3 M6\nG43.1 X0 Z0\nS400 M3\nG0 X24 Z6\n{cut}\nG0 X40\nT5 M6\nG43.1 X{x} Z{z}\nM3 S900\nG0 X24 Z{start}\n{cut}\nG0 X40\nM2\n"
        );
        passes(&good(&source).items)
    };
    // Single passes, and a cycle; the second tool two leads farther on, at another speed.
    for cut in ["G0 X20\nG33 Z-20 K2", "G0 X20\nG33 Z-20 K2.5", "G76 P2 Z-20 I-4 J0.6 K1.2 Q0"] {
        let lead = if cut.contains("2.5") { 2.5 } else { 2.0 };
        let all = of(cut, 6.0 + 2.0 * lead);
        let half = all.len() / 2;
        let first = crosses_mm(&all[0], 0.0);
        for (pass, longer) in
            all[..half].iter().map(|pass| (pass, 0.0)).chain(all[half..].iter().map(|pass| (pass, z)))
        {
            let off = (crosses_mm(pass, longer) - first).abs();
            assert!(off.min(lead - off) < 1e-6, "{cut}, pass {}: {off} mm beside", pass.pass);
        }
        // X of both tools is as deep, pass by pass.
        let root = |pass: &ThreadPass| pass.axis(Axis::X).start.mm() + pass.axis(Axis::X).stroke_mm;
        for (one, other) in all[..half].iter().zip(&all[half..]) {
            assert!((root(other) - root(one) - x).abs() < 1e-9, "{cut}");
        }
    }
    // One that stands half a lead beside would be seen.
    let all = of("G0 X20\nG33 Z-20 K2", 7.0);
    let off = (crosses_mm(&all[1], z) - crosses_mm(&all[0], 0.0)).abs();
    assert!((off - 1.0).abs() < 1e-6, "{off}");
}
