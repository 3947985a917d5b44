//! The pitch diameter as it is measured with wires, by another way. In: the section as heights over the axis,
//! mm. Out: the pitch diameter, mm.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | α | deg | half angle of the thread |
//! | D, y | mm | diameter of the best wire, that touches at the pitch line; height of its middle |
//!
//! ```text
//! (M157) D = P/(2 cos α);   d2 = 2 y − D/sin α + P/2 cot α
//! ```
//! The wire is let fall into the groove: at each place along the axis it stops where the section first
//! touches it, and it rolls to where it lies lowest. Nothing here knows flanks, pitch lines or the order of
//! grooves.

use gauge::{Edge, Place};

use crate::made::{Errors, Made, threads};

/// Height of an edge over its tip, beside its middle; both flanks alike.
pub(crate) fn edge_mm(edge: &Edge, beside: f64) -> f64 {
    let (sin, cos) = libm::sincos(edge.flank_deg[0].to_radians());
    let w = beside.abs() - 0.5 * edge.flat_mm;
    let rho = edge.nose_mm;
    if w <= 0.0 {
        0.0
    } else if w < rho * cos {
        rho - (rho * rho - w * w).sqrt()
    } else {
        rho * (1.0 - sin) + (w - rho * cos) * cos / sin
    }
}

/// Height of the section: what all places of the tip leave.
pub(crate) fn section_mm(made: &Made, places: &[Place], z: f64) -> f64 {
    let left = |place: &Place| made.sign() * place.radius_mm + edge_mm(&made.edge, z - place.z_mm);
    places.iter().map(left).fold(f64::INFINITY, f64::min)
}

/// Smallest value of a function with one valley.
fn valley(low: f64, high: f64, of: &dyn Fn(f64) -> f64) -> f64 {
    let (mut low, mut high) = (low, high);
    for _ in 0..60 {
        let third = (high - low) / 3.0;
        if of(low + third) < of(high - third) { high -= third } else { low += third }
    }
    of(0.5 * (low + high))
}

/// Height of the middle of a wire of a radius over a place: where the section stops it.
fn stopped_mm(made: &Made, places: &[Place], r: f64, at: f64) -> f64 {
    let over = |z: f64| section_mm(made, places, z) + (r * r - (z - at) * (z - at)).max(0.0).sqrt();
    let steps = 200;
    let of = |i: i32| at + r * f64::from(i) / f64::from(steps);
    let most =
        (-steps..=steps).max_by(|a, b| over(of(*a)).total_cmp(&over(of(*b)))).expect("there are steps");
    -valley(of((most - 1).max(-steps)), of((most + 1).min(steps)), &|z| -over(z))
}

/// Pitch diameter by a wire in the groove near a place.
fn by_wire_mm(made: &Made, places: &[Place], near: f64) -> f64 {
    let (sin, cos) = libm::sincos(made.nominal.flank_deg[0].to_radians());
    let p = made.nominal.pitch_mm;
    let wire = p / (2.0 * cos);
    let near_places: Vec<Place> =
        places.iter().copied().filter(|place| (place.z_mm - near).abs() < 1.5 * p).collect();
    let y = valley(near - 0.2 * p, near + 0.2 * p, &|at| stopped_mm(made, &near_places, 0.5 * wire, at));
    made.sign() * (2.0 * y - wire / sin + 0.5 * p * cos / sin)
}

#[test]
fn m157_pitch_diameters_are_those_of_wires() {
    let errors = [
        Errors::default(),
        Errors { pass: 0.004, ..Errors::default() },
        Errors { taper: 0.001, drunken: 0.01, ..Errors::default() },
        Errors { runout: 0.008, lead: 0.0005, ..Errors::default() },
    ];
    for (at, thread) in threads().into_iter().enumerate() {
        let made = thread.with(errors[at % errors.len()]);
        let sections = made.sections();
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for places in sections.stations.iter().step_by(9) {
            let mut middles: Vec<f64> = places.iter().step_by(5).map(|place| place.z_mm).collect();
            middles.retain(|z| (-made.length_mm..=0.0).contains(z));
            for near in middles {
                let d2 = by_wire_mm(&made, places, near);
                (low, high) = (low.min(d2), high.max(d2));
            }
        }
        // The same angles, and no more.
        let mut few = sections.clone();
        for (station, places) in few.stations.iter_mut().enumerate() {
            if station % 9 != 0 {
                places.clear();
            }
        }
        let report = gauge::judge(&made.nominal, &few, made.full_mm(), made.crest_mm());
        let [least, most] = report.pitch_diameter_mm;
        let name = &made.nominal.name;
        assert!((least - low).abs() < 2e-4, "{name}: {least} by the gauge, {low} by wires");
        assert!((most - high).abs() < 2e-4, "{name}: {most} by the gauge, {high} by wires");
    }
}
