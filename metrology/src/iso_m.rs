//! Metric threads: M (ISO 68-1, ISO 724, ISO 965-1) and MJ (ISO 5855-1, ASME B1.21M). In: nominal diameter
//! and pitch in mm, tolerance classes. Out: limits in mm.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | d, P | mm | nominal diameter, pitch |
//! | H | mm | height of the triangle of the flanks, 0.866025 P |
//! | es, EI | mm | fundamental deviations (`deviations.rs`); T … tolerances (`grades.rs`) |
//!
//! ```text
//! D2 = d − 0.649519 P,  D1 = d − 1.082532 P: three places, then deviations and tolerances in whole µm (M139)
//! screw: d_max = d + es,  d2_max = D2 + es,  flat of the root d1_max = D1 + es
//!     d3_min = d2_min − H + 2 P/8 = d2_min − 0.616025 P,  d3_max = d2_min − H + 2 C_max
//!     C_max = H/4 − R (1 − cos(60° − arccos(1 − T_d2/4R))) + T_d2/2,  R = P/8
//! nut: D1_min = D1 + EI,  D2_min = D2 + EI,  D_min = d + EI; D_max is not limited
//! MJ: D1 = d − 0.974279 P,  d3_max = d2_max − 0.505182 P,  d3_min = d2_min − 0.565806 P,
//!     root radius 0.15011 P … 0.18042 P                                                              (M140)
//! ```
//!
//! Roots are reckoned from pitch diameters of full length and rounded in the end. Of two pairs in a class the
//! first is that of the pitch diameter, the second that of the crest.

use std::fmt;

use crate::{
    deviations::Position,
    grades::{crest_tolerance, pitch_tolerance},
    limits::{Limits, Side, Size, Unit},
    profile::Profile,
    rounding::half_up,
    thread::Described,
};

/// Coarse pitches of ISO 261: nominal diameter, pitch, mm.
const COARSE: [(f64, f64); 40] = [
    (1.0, 0.25),
    (1.1, 0.25),
    (1.2, 0.25),
    (1.4, 0.3),
    (1.6, 0.35),
    (1.8, 0.35),
    (2.0, 0.4),
    (2.2, 0.45),
    (2.5, 0.45),
    (3.0, 0.5),
    (3.5, 0.6),
    (4.0, 0.7),
    (4.5, 0.75),
    (5.0, 0.8),
    (6.0, 1.0),
    (7.0, 1.0),
    (8.0, 1.25),
    (9.0, 1.25),
    (10.0, 1.5),
    (11.0, 1.5),
    (12.0, 1.75),
    (14.0, 2.0),
    (16.0, 2.0),
    (18.0, 2.5),
    (20.0, 2.5),
    (22.0, 2.5),
    (24.0, 3.0),
    (27.0, 3.0),
    (30.0, 3.5),
    (33.0, 3.5),
    (36.0, 4.0),
    (39.0, 4.0),
    (42.0, 4.5),
    (45.0, 4.5),
    (48.0, 5.0),
    (52.0, 5.0),
    (56.0, 5.5),
    (60.0, 5.5),
    (64.0, 6.0),
    (68.0, 6.0),
];

/// The coarse pitch of a diameter, mm, ISO 261.
pub(crate) fn coarse_pitch(d: f64) -> Option<f64> {
    COARSE.iter().find(|(of, _)| *of == d).map(|(_, pitch)| *pitch)
}

/// A grade and a position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Zone {
    pub(crate) grade: u8,
    pub(crate) position: Position,
}

/// A tolerance class of one member.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Class {
    pub(crate) pitch: Zone,
    pub(crate) crest: Zone,
}

impl Class {
    /// As it is written; capitals for a nut.
    pub(crate) fn text(self, side: Side) -> String {
        let zone = |zone: Zone| {
            let letter = zone.position.letter();
            let letter = if side == Side::Internal { letter.to_ascii_uppercase() } else { letter };
            format!("{}{letter}", zone.grade)
        };
        match self {
            Class { pitch, crest } if pitch == crest => zone(pitch),
            Class { pitch, crest } => zone(pitch) + &zone(crest),
        }
    }
}

/// Writes the classes of a metric name: external, then internal.
pub(crate) fn write_classes(
    f: &mut fmt::Formatter<'_>,
    external: Option<String>,
    internal: Option<String>,
) -> fmt::Result {
    let classes: Vec<String> = external.into_iter().chain(internal).collect();
    write!(f, "-{}", classes.join("/"))
}

/// A metric thread; mm.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Metric {
    /// Whether it is MJ, with a large radius at the root of the screw.
    pub(crate) mj: bool,
    pub(crate) d: f64,
    pub(crate) pitch: f64,
    pub(crate) starts: u32,
    pub(crate) external: Option<Class>,
    pub(crate) internal: Option<Class>,
}

impl Metric {
    /// D2 at full length, mm.
    fn pitch_diameter(&self) -> f64 {
        self.d - 0.649519 * self.pitch
    }

    /// D1 at full length, mm: of the nut, and of the flat of the root of a screw.
    fn minor(&self) -> f64 {
        self.d - if self.mj { 0.974279 } else { 1.082532 } * self.pitch
    }

    fn screw(&self, class: Class) -> Vec<(Size, f64)> {
        let Metric { d, pitch, .. } = *self;
        let es = class.pitch.position.deviation(pitch) / 1e3;
        let d_max = d - class.crest.position.deviation(pitch) / 1e3;
        let td = crest_tolerance(Side::External, class.crest.grade, pitch) / 1e3;
        let td2 = pitch_tolerance(Side::External, class.pitch.grade, d, pitch) / 1e3;
        let um = |mm: f64| half_up(mm, 3);
        let d2_max = um(um(self.pitch_diameter()) - es);
        let mut sizes = vec![
            (Size::MajorMax, um(d_max)),
            (Size::MajorMin, um(d_max - td)),
            (Size::PitchMax, d2_max),
            (Size::PitchMin, um(d2_max - td2)),
        ];
        let d2 = self.pitch_diameter() - es;
        if self.mj {
            sizes.extend([
                (Size::MinorMax, um(d2 - 0.505182 * pitch)),
                (Size::MinorMin, um(d2 - td2 - 0.565806 * pitch)),
                (Size::RootRadiusMax, um(0.18042 * pitch)),
                (Size::RootRadiusMin, um(0.15011 * pitch)),
            ]);
        } else {
            sizes.push((Size::FlatMinorMax, um(um(self.minor()) - es)));
            sizes.extend(root_max(d2 - td2, td2, pitch).map(|mm| (Size::MinorMax, um(mm))));
            sizes.push((Size::MinorMin, um(d2 - td2 - 0.616025 * pitch)));
        }
        sizes
    }

    fn nut(&self, class: Class) -> Vec<(Size, f64)> {
        let Metric { d, pitch, .. } = *self;
        let um = |mm: f64| half_up(mm, 3);
        let ei = class.pitch.position.deviation(pitch) / 1e3;
        let d1_min = um(um(self.minor()) + class.crest.position.deviation(pitch) / 1e3);
        let d2_min = um(um(self.pitch_diameter()) + ei);
        vec![
            (Size::MajorMin, um(d + ei)),
            (Size::PitchMax, um(d2_min + pitch_tolerance(Side::Internal, class.pitch.grade, d, pitch) / 1e3)),
            (Size::PitchMin, d2_min),
            (Size::MinorMax, um(d1_min + crest_tolerance(Side::Internal, class.crest.grade, pitch) / 1e3)),
            (Size::MinorMin, d1_min),
        ]
    }
}

/// Largest minor diameter of a root with the least radius P/8 (M140), mm; none where the tolerance is so wide
/// that the arc is not reached.
fn root_max(d2_min: f64, td2: f64, pitch: f64) -> Option<f64> {
    let (height, radius) = (pitch * 0.75_f64.sqrt(), pitch / 8.0);
    let reach = 1.0 - td2 / (4.0 * radius);
    let turned = core::f64::consts::FRAC_PI_3 - libm::acos(reach);
    let c_max = height / 4.0 - radius * (1.0 - libm::cos(turned)) + td2 / 2.0;
    (reach >= 0.5).then_some(d2_min - height + 2.0 * c_max)
}

impl Described for Metric {
    fn standard(&self) -> &'static str {
        if self.mj { "ISO 5855 MJ" } else { "ISO 965 M" }
    }

    fn limits(&self) -> Limits {
        let external = self.external.map(|class| self.screw(class));
        let internal = self.internal.map(|class| self.nut(class));
        Limits::new(Unit::Mm, external.as_deref(), internal.as_deref())
    }

    fn profile(&self) -> Profile {
        Profile {
            flank_deg: [30.0; 2],
            pitch_mm: self.pitch,
            starts: self.starts,
            major_mm: self.d,
            pitch_diameter_mm: self.pitch_diameter(),
            minor_mm: self.minor(),
            taper: 0.0,
            left_hand: false,
        }
    }

    fn note(&self) -> &'static str {
        if self.mj {
            "The root of the screw has a radius between R_min and R_max. D_max is not limited."
        } else {
            "d1_max is where the flat of a root may begin, for a GO gauge; d3 is the root with its radius of P/8. \
             D_max is not limited."
        }
    }
}

impl fmt::Display for Metric {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Metric { d, pitch, starts, .. } = self;
        let letters = if self.mj { "MJ" } else { "M" };
        match starts {
            1 => write!(f, "{letters}{d}x{pitch}")?,
            _ => write!(f, "{letters}{d}xPh{}P{pitch}", lead(*pitch, *starts))?,
        }
        let text = |class: Option<Class>, side| class.map(|class| class.text(side));
        write_classes(f, text(self.external, Side::External), text(self.internal, Side::Internal))
    }
}

/// Advance per revolution, mm, without what binary makes of a sum of decimals.
pub(crate) fn lead(pitch: f64, starts: u32) -> f64 {
    (pitch * f64::from(starts) * 1e6).round() / 1e6
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Machinery's Handbook 27, p. 1804: M6.5x1-4h6h has a minor diameter of 5.386 … 5.163.
    #[test]
    fn the_root_of_a_screw_has_its_radius() {
        let zone = |grade| Zone { grade, position: Position::H };
        let external = Some(Class { pitch: zone(4), crest: zone(6) });
        let metric = Metric { mj: false, d: 6.5, pitch: 1.0, starts: 1, external, internal: None };
        let limits = metric.limits().external.expect("it is a screw");
        assert_eq!((limits.get(Size::MinorMax), limits.get(Size::MinorMin)), (Some(5.386), Some(5.163)));
    }
}
