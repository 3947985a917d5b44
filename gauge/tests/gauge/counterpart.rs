//! The virtual pitch diameter against a counterpart that is screwed on by trial. In: the section as heights
//! over the axis, mm. Out: whether some phase lets the counterpart in.

use gauge::{Place, Sections};

use crate::{
    made::{Errors, Made, STATIONS, threads},
    wires::section_mm,
};

/// Points of the counterpart's ridge that are held against the section, on each flank.
const POINTS: usize = 30;

/// How far a counterpart of a virtual pitch diameter, at a phase, reaches into material; mm, negative if it
/// is clear everywhere.
fn bites_mm(made: &Made, sections: &Sections, virtual_mm: f64, phase: f64) -> f64 {
    let nominal = &made.nominal;
    let tangent = libm::tan(nominal.flank_deg[0].to_radians());
    let y = 0.5 * made.sign() * virtual_mm;
    let root = 0.5 * made.sign() * nominal.root_go_mm.expect("the thread has one");
    let crest = 0.5 * made.sign() * made.crest_mm().expect("the thread has one");
    let lead = nominal.pitch_mm * f64::from(nominal.starts) * if nominal.grows { 1.0 } else { -1.0 };
    let mut worst = f64::NEG_INFINITY;
    for (j, places) in sections.stations.iter().enumerate() {
        let turn = nominal.starts as i32 + 1;
        for i in -turn..(made.length_mm / nominal.pitch_mm) as i32 + turn {
            let even = -0.3 * nominal.pitch_mm - f64::from(i) * nominal.pitch_mm;
            let middle = even + lead * j as f64 / STATIONS as f64;
            // Of grooves whose middle is not in the thread no gauge is made; errors are far below a pitch.
            if middle > -0.02 * nominal.pitch_mm || middle < -made.length_mm + 0.02 * nominal.pitch_mm {
                continue;
            }
            let near: Vec<Place> = places
                .iter()
                .copied()
                .filter(|place| (place.z_mm - middle).abs() < 0.8 * nominal.pitch_mm)
                .collect();
            for k in 0..=POINTS {
                let h = root + (crest - root) * k as f64 / POINTS as f64;
                let half = 0.25 * nominal.pitch_mm + (h - y) * tangent;
                for z in [middle + phase - half, middle + phase + half] {
                    worst = worst.max(section_mm(made, &near, z) - h);
                }
            }
        }
    }
    worst
}

/// The phase at which it bites least, and how much it bites there.
fn best_mm(made: &Made, sections: &Sections, virtual_mm: f64) -> f64 {
    let of = |phase: f64| bites_mm(made, sections, virtual_mm, phase);
    let (mut low, mut high) = (-0.1, 0.1);
    for _ in 0..40 {
        let third = (high - low) / 3.0;
        if of(low + third) < of(high - third) { high -= third } else { low += third }
    }
    of(0.5 * (low + high))
}

/// A counterpart of the virtual size goes on, one that is 0.2 µm tighter does not.
#[test]
fn m155_the_virtual_size_is_that_of_the_tightest_counterpart() {
    let errors = [
        Errors { lead: 0.0008, drunken: 0.006, runout: 0.004, ..Errors::default() },
        Errors { drunken: 0.01, taper: 0.0007, ..Errors::default() },
        Errors { start: 0.015, lead: -0.0001, pass: 0.01, ..Errors::default() },
    ];
    for (thread, errors) in [0, 2, 3].into_iter().zip(errors) {
        let mut made = threads()[thread].clone().with(errors);
        made.nominal.gauge_mm = 2.0 * made.length_mm;
        made.edge.flank_deg = made.edge.flank_deg.map(|deg| deg - 0.2);
        let (sections, report) = (made.sections(), made.judged());
        let tighter = -made.sign() * 2e-4;
        let name = &made.nominal.name;
        let [goes, not] = [-tighter, tighter].map(|by| best_mm(&made, &sections, report.virtual_mm + by));
        assert!(goes < 0.0, "{name}: {goes} at {}", report.virtual_mm);
        assert!(not > 0.0, "{name}: {not} at {}", report.virtual_mm);
    }
}
