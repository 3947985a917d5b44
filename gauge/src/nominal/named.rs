//! A gauge from the name of a thread. In: a thread of [`metrology`], mm. Out: a [`Nominal`].
//!
//! | what | from |
//! |---|---|
//! | pitch diameter, crest | the limits of the class |
//! | root for GO | d1_max where a flat of the root may reach it (of UN d2_max − H/2, the flat form of ASME B1.2), else the minor diameter of the basic profile; of a nut the major diameter |
//! | length of the GO gauge | the major diameter: what is usually engaged; L1 or the gauge length of a taper |
//!
//! Roots of the form of Whitworth are round to the basic profile, so no straight flank of a gauge reaches
//! them: GO is held against a quarter of the triangle of the flanks on that side. Limits of the root itself
//! (d3) are those of a drawing, not of a gauge.

use metrology::{Limits, Member, Side, Size, Thread};

use super::{Nominal, NominalError};

/// Flank of the form of Whitworth, degrees.
const ROUND_DEG: f64 = 27.5;

impl Nominal {
    /// What GO and NO-GO of a thread ask. Z falls with the angle of the spindle along a right-hand thread:
    /// cut with M3 towards the chuck, or with M4 away from it.
    ///
    /// # Errors
    /// The name says neither screw nor nut, or its standard has no limits of the pitch diameter.
    pub fn of(thread: &Thread) -> Result<Nominal, NominalError> {
        let Limits { external, internal, .. } = thread.limits();
        let profile = thread.profile();
        if external.is_none() && internal.is_none() {
            return Err(NominalError::NoLimits);
        }
        let side = thread.side().ok_or(NominalError::Side)?;
        let member = if side == Side::External { external } else { internal };
        let member = member.ok_or(NominalError::NoLimits)?;
        if profile.taper != 0.0 {
            return tapered(thread, side, &member);
        }
        let limits = member.get(Size::PitchMin).zip(member.get(Size::PitchMax));
        let (least, most) = limits.ok_or(NominalError::NoLimits)?;
        let (root, crest) = match side {
            Side::External => {
                let root = match member.get(Size::FlatMinorMax) {
                    // Of UN that limit is the root as older tables have it; a GO ring has the flat form.
                    Some(_) if thread.standard().ends_with(" UN") => {
                        most - profile.pitch_diameter_mm + profile.minor_mm
                    }
                    told => told.unwrap_or(profile.minor_mm),
                };
                (root, [Size::MajorMin, Size::MajorMax])
            }
            Side::Internal => (profile.major_mm, [Size::MinorMin, Size::MinorMax]),
        };
        let is_round = profile.flank_deg.contains(&ROUND_DEG);
        let nominal = Nominal {
            name: thread.to_string(),
            side,
            flank_deg: profile.flank_deg,
            pitch_mm: profile.pitch_mm,
            starts: profile.starts,
            grows: profile.left_hand,
            pitch_diameter_mm: [least, most],
            crest_mm: crest.map(|size| member.get(size)),
            root_go_mm: (!is_round).then_some(root),
            root_mm: [None; 2],
            taper: 0.0,
            plane_mm: 0.0,
            gauge_mm: profile.major_mm,
            tap_mm: None,
            blunt_turns: None,
            left_out: left_out(thread, side),
        };
        nominal.check().map(|()| nominal)
    }
}

/// What the standard asks besides.
fn left_out(thread: &Thread, side: Side) -> &'static [&'static str] {
    match (thread.standard(), side) {
        ("ISO 5855 MJ" | "ASME B1.15 UNJ", Side::External) => {
            &["the radius of the root, 0.15011 to 0.18042 P, is not judged"]
        }
        (standard, _) if standard.ends_with("NPT") => &["truncation of crest and root is not judged"],
        _ => &[],
    }
}

/// A taper: its pitch diameter may be off by a turn or more at its plane. That is L1 (NPT) or the gauge
/// length (ISO 7) from the small end of a screw, and the face of a nut; the face of the part is at Z 0.
fn tapered(thread: &Thread, side: Side, member: &Member) -> Result<Nominal, NominalError> {
    let profile = thread.profile();
    let [least, most, length] = match member.get(Size::GaugeLength) {
        Some(_) => [Size::PitchMin, Size::PitchMax, Size::GaugeLength],
        None => [Size::HandTightMin, Size::HandTightMax, Size::HandTightLength],
    };
    let size = |size: Size| member.get(size).ok_or(NominalError::NoLimits);
    let (least, most, length_mm) = (size(least)?, size(most)?, size(length)?);
    let (taper, plane_mm) = match side {
        Side::External => (-profile.taper, -length_mm),
        Side::Internal => (profile.taper, 0.0),
    };
    let nominal = Nominal {
        name: thread.to_string(),
        side,
        flank_deg: profile.flank_deg,
        pitch_mm: profile.pitch_mm,
        starts: profile.starts,
        grows: profile.left_hand,
        pitch_diameter_mm: [least, most],
        crest_mm: [None; 2],
        root_go_mm: None,
        root_mm: [None; 2],
        taper,
        plane_mm,
        gauge_mm: length_mm,
        tap_mm: None,
        blunt_turns: None,
        left_out: left_out(thread, side),
    };
    nominal.check().map(|()| nominal)
}
