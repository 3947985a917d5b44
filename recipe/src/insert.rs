//! The edge of a threading tool, from the designation of its insert. In: text. Out: a [`Tool`], and for a
//! thread its edge, mm and degrees.
//!
//! ```text
//! insert = size E|I R|L [M|B] form          size 06 08 11 16 22 27: length of an edge, mm
//! form   = pitch [standard]                 full profile: 16ER2.0ISO, 16IR14UN, 22ERTR6
//!        | A|AG|G|N|Q|U 60|55               partial profile, for a range of pitches: 16ERAG60
//! shape  = A angle [R nose] [W width]       a tool as it is: A60 R0.1, A30 W1.9
//!        | sharp                            the flanks of the thread, and a point
//! ```
//!
//! | form | its edge, P the pitch |
//! |---|---|
//! | full profile, 60° | nose of 0.1443 P (the rounding of ISO 68-1) of a screw, 0.0722 P of a nut; MJ 0.165 P (0.15011 to 0.18042) |
//! | full profile, 55° | nose of 0.1373 P (BS 84) |
//! | full profile, Tr, ACME | as flat as the root of the basic profile |
//! | full profile, NPT | nose of 0.033 P (its least truncation) |
//! | partial profile | nose of 0.125 times the least pitch of its range |
//!
//! Letters and ranges: Iscar, *Turning tools* 2017, page 493, "Insert identification system". Noses differ
//! among makers and are seldom printed on the box: [`Tool::with_nose_mm`] takes what is known.

use std::{fmt, str::FromStr};

use gauge::Side;
use metrology::{Misread, Profile, Thread};

use crate::Refused;

/// A threading tool.
#[derive(Clone, Debug, PartialEq)]
pub struct Tool {
    /// As it was asked for.
    pub name: String,
    /// For a screw or for a nut, where its name says it.
    pub side: Option<Side>,
    /// For a spindle that turns left (M4).
    pub left: bool,
    /// What its tip looks like.
    pub form: Form,
    nose_mm: Option<f64>,
}

/// The tip of a tool.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Form {
    /// The flanks of the thread, and a point.
    Sharp,
    /// Of one pitch and one standard.
    Full {
        /// Distance of grooves, mm.
        pitch_mm: f64,
        /// Whose profile it is; none: of any.
        family: Option<Family>,
    },
    /// Of one angle, for pitches within a range.
    Partial {
        /// Angle between the flanks, degrees.
        angle_deg: f64,
        /// Least and largest pitch, mm.
        pitches_mm: [f64; 2],
    },
    /// As it was measured.
    Shape {
        /// Angle between the flanks, degrees.
        angle_deg: f64,
        /// Flat at the tip, mm.
        width_mm: f64,
    },
}

/// Standards whose profiles differ.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    /// ISO metric and unified: 60°.
    Sixty,
    /// MJ and UNJ.
    Jet,
    /// Whitworth and its pipes: 55°.
    Whitworth,
    /// NPT.
    Npt,
    /// Trapezoidal.
    Trapezoidal,
    /// ACME.
    Acme,
    /// A worm of a module.
    Worm,
}

/// Ranges of pitches by letter, mm.
const RANGES: [(&str, [f64; 2]); 6] = [
    ("AG", [0.5, 3.0]),
    ("A", [0.5, 1.5]),
    ("G", [1.75, 3.0]),
    ("N", [3.5, 5.0]),
    ("Q", [5.5, 6.0]),
    ("U", [5.5, 9.0]),
];
/// Standards as inserts name them; whether their pitch is in threads per inch.
const FAMILIES: [(&str, Family, bool); 12] = [
    ("ISO", Family::Sixty, false),
    ("MJ", Family::Jet, false),
    ("M", Family::Sixty, false),
    ("UNJ", Family::Jet, true),
    ("UN", Family::Sixty, true),
    ("BSPT", Family::Whitworth, true),
    ("BSW", Family::Whitworth, true),
    ("W", Family::Whitworth, true),
    ("NPT", Family::Npt, true),
    ("TR", Family::Trapezoidal, false),
    ("ACME", Family::Acme, true),
    ("MOD", Family::Worm, false),
];
/// Edges of inserts, mm.
const SIZES: [&str; 6] = ["06", "08", "11", "16", "22", "27"];
/// Pitches of a tool and of a thread that agree, mm.
const SAME_MM: f64 = 0.003;
/// The nose of a partial profile, shares of the least pitch.
const PARTIAL_NOSE: f64 = 0.125;
/// How tools are written.
const HELP: &str =
    "write an insert as in 16ER2.0ISO, 16IR14UN, 16ERAG60, or a shape as in 'A60 R0.1', 'A30 W1.9', or sharp";

impl Tool {
    /// The flanks of any thread, and a point.
    #[must_use]
    pub fn sharp() -> Tool {
        Tool { name: "sharp".into(), side: None, left: false, form: Form::Sharp, nose_mm: None }
    }

    /// A tool that was measured: the angle between its flanks, degrees; flat and nose, mm.
    #[must_use]
    pub fn measured(name: String, angle_deg: f64, width_mm: f64, nose_mm: f64) -> Tool {
        let form = Form::Shape { angle_deg, width_mm };
        Tool { name, side: None, left: false, form, nose_mm: Some(nose_mm) }
    }

    /// The same with the nose that it has, mm.
    #[must_use]
    pub fn with_nose_mm(self, nose_mm: f64) -> Tool {
        Tool { nose_mm: Some(nose_mm), ..self }
    }

    /// Width of its tip as a machine file has it, corners and all (0 of a round one), and radius of its nose
    /// or of its corners, in a thread, mm.
    ///
    /// # Errors
    /// It is not for this thread.
    pub fn tip_mm(&self, thread: &Thread, side: Side) -> Result<[f64; 2], Refused> {
        let profile = thread.profile();
        let angle: f64 = profile.flank_deg.iter().sum();
        let refused = |text: String| Err(Refused::Tool { tool: self.name.clone(), text });
        if self.side.is_some_and(|of| of != side) {
            let [is, needs] = if side == Side::External { ["internal", "E"] } else { ["external", "I"] };
            return refused(format!("it is for {is} threads: take one with {needs} behind its size"));
        }
        if self.left != profile.left_hand && self.side.is_some() {
            let hand = if profile.left_hand {
                "left-hand thread, take an insert with L"
            } else {
                "right-hand thread, take an insert with R"
            };
            return refused(format!("for a {hand} behind E or I"));
        }
        let of = |[width_mm, nose_mm]: [f64; 2]| [width_mm, self.nose_mm.unwrap_or(nose_mm)];
        match self.form {
            Form::Sharp => Ok(of([0.0, 0.0])),
            Form::Shape { angle_deg, .. } | Form::Partial { angle_deg, .. }
                if (angle_deg - angle).abs() > 0.01 =>
            {
                refused(format!("it has {angle_deg}°, the thread {angle}°"))
            }
            Form::Shape { width_mm, .. } => Ok(of([width_mm, 0.0])),
            Form::Partial { pitches_mm: [least, most], .. } => {
                if !(least - SAME_MM..=most + SAME_MM).contains(&profile.pitch_mm) {
                    return refused(format!(
                        "it is for pitches of {least} to {most} mm, the thread has {}",
                        profile.pitch_mm
                    ));
                }
                Ok(of([0.0, PARTIAL_NOSE * least]))
            }
            Form::Full { pitch_mm, family } => {
                if (pitch_mm - profile.pitch_mm).abs() > SAME_MM {
                    return refused(format!(
                        "its pitch is {pitch_mm:.4} mm, that of the thread {:.4}",
                        profile.pitch_mm
                    ));
                }
                // Its flanks are hardly straight anywhere, which is what a gauge would touch.
                if thread.to_string().starts_with("Rd") {
                    return refused(
                        "the full profile of a round thread is not known here: write its shape".into(),
                    );
                }
                let own = Family::of(thread);
                if family.is_some_and(|family| family != own) {
                    return refused(format!("its profile is not that of {}", thread.standard()));
                }
                Ok(of(own.tip_mm(&profile, side)))
            }
        }
    }
}

impl Family {
    /// Whose profile a thread has.
    fn of(thread: &Thread) -> Family {
        let name = thread.to_string();
        let standard = thread.standard();
        match () {
            () if name.starts_with("MJ") || name.contains(" UNJ") => Family::Jet,
            () if name.starts_with("Tr") => Family::Trapezoidal,
            () if name.contains("ACME") => Family::Acme,
            () if standard.contains("NPT") => Family::Npt,
            () if name.starts_with("module") => Family::Worm,
            () if thread.profile().flank_deg[0] == 27.5 => Family::Whitworth,
            () => Family::Sixty,
        }
    }

    /// Width and nose of the tip of a full profile, mm.
    fn tip_mm(self, profile: &Profile, side: Side) -> [f64; 2] {
        let pitch = profile.pitch_mm;
        match (self, side) {
            (Family::Sixty, Side::External) => [0.0, 0.1443 * pitch],
            (Family::Sixty | Family::Jet, Side::Internal) => [0.0, 0.0722 * pitch],
            (Family::Jet, Side::External) => [0.0, 0.165 * pitch],
            (Family::Whitworth, _) => [0.0, 0.1373 * pitch],
            (Family::Npt, _) => [0.0, 0.033 * pitch],
            (Family::Trapezoidal | Family::Acme | Family::Worm, _) => {
                let root = if side == Side::External { profile.minor_mm } else { profile.major_mm };
                let below = 0.5 * (profile.pitch_diameter_mm - root).abs();
                [0.5 * pitch - below * tangents(profile), 0.0]
            }
        }
    }
}

fn tangents(profile: &Profile) -> f64 {
    profile.flank_deg.iter().map(|deg| libm::tan(deg.to_radians())).sum()
}

impl fmt::Display for Tool {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.name)
    }
}

impl FromStr for Tool {
    type Err = Misread;

    fn from_str(text: &str) -> Result<Tool, Misread> {
        let upper = text.to_ascii_uppercase();
        let name = text.split_whitespace().collect::<Vec<_>>().join(" ");
        let wrong = |message: String| Misread { span: 0..text.len(), message, help: HELP.into() };
        let joined: String = upper.split_whitespace().collect();
        if joined == "SHARP" {
            return Ok(Tool { name, ..Tool::sharp() });
        }
        if joined.starts_with('A') {
            return shape(&upper, &name).map_err(wrong);
        }
        let insert = || -> Option<Tool> {
            let rest = SIZES.iter().find_map(|size| joined.strip_prefix(size))?;
            let (side, rest) = match rest.split_at_checked(1)? {
                ("E", rest) => (Side::External, rest),
                ("I", rest) => (Side::Internal, rest),
                _ => return None,
            };
            let (left, rest) = match rest.split_at_checked(1)? {
                ("R", rest) => (false, rest),
                ("L", rest) => (true, rest),
                _ => return None,
            };
            let form = form(rest).or_else(|| form(rest.strip_prefix(['M', 'B'])?))?;
            Some(Tool { name: name.clone(), side: Some(side), left, form, nose_mm: None })
        };
        insert().ok_or_else(|| wrong(format!("the tool {text:?} is not understood")))
    }
}

/// What stands behind the hand of an insert.
fn form(text: &str) -> Option<Form> {
    for (letter, pitches_mm) in RANGES {
        let angle_deg = match text.strip_prefix(letter) {
            Some("60") => 60.0,
            Some("55") => 55.0,
            _ => continue,
        };
        return Some(Form::Partial { angle_deg, pitches_mm });
    }
    let is_number = |c: char| c.is_ascii_digit() || c == '.' || c == ',';
    let number: String = text.chars().skip_while(|c| !is_number(*c)).take_while(|c| is_number(*c)).collect();
    let letters = text.replace(&number, "");
    let value: f64 = number.replace(',', ".").parse().ok().filter(|value: &f64| *value > 0.0)?;
    let family = FAMILIES.iter().find(|(name, ..)| *name == letters);
    match (letters.as_str(), family) {
        ("", _) => Some(Form::Full { pitch_mm: value, family: None }),
        (_, Some((_, family, true))) => Some(Form::Full { pitch_mm: 25.4 / value, family: Some(*family) }),
        (_, Some((_, Family::Worm, _))) => {
            Some(Form::Full { pitch_mm: value * std::f64::consts::PI, family: Some(Family::Worm) })
        }
        (_, Some((_, family, false))) => Some(Form::Full { pitch_mm: value, family: Some(*family) }),
        (_, None) => None,
    }
}

/// A tool as it is: `A60 R0.1 W0.3`.
fn shape(text: &str, name: &str) -> Result<Tool, String> {
    let mut values = [None; 3];
    for word in text.split_whitespace() {
        let at = ["A", "R", "W"].iter().position(|key| word.starts_with(*key));
        let value =
            word[1..].replace(',', ".").parse().ok().filter(|value: &f64| (0.0..=120.0).contains(value));
        match (at, value) {
            (Some(at), Some(value)) if values[at].is_none() => values[at] = Some(value),
            _ => return Err(format!("{word:?} is not understood, or is said twice")),
        }
    }
    let [Some(angle_deg), nose, width] = values else { return Err("the angle, A, is missing".into()) };
    if angle_deg < 2.0 {
        return Err("the angle between the flanks is 2 to 120°".into());
    }
    Ok(Tool::measured(name.into(), angle_deg, width.unwrap_or(0.0), nose.unwrap_or(0.0)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use gauge::Edge;

    fn edge(tool: &str, thread: &str, side: Side) -> Result<Edge, String> {
        let thread: Thread = thread.parse().expect("a thread");
        let tool: Tool = tool.parse().map_err(|misread: Misread| misread.message)?;
        let [width_mm, nose_mm] = tool.tip_mm(&thread, side).map_err(|refused| refused.to_string())?;
        Ok(Edge::of_width(thread.profile().flank_deg, width_mm, nose_mm))
    }

    #[test]
    fn full_profiles_reach_the_root_of_the_standard() {
        // ISO 68-1: the rounding of H/6 ends at d3 = d - 1.22687 P.
        let screw = edge("16ER2.0ISO", "M20x2-6g", Side::External).expect("fits");
        let below = screw.depth_mm(1.0).expect("sharp enough");
        assert!((2.0 * below - (1.22687 - 0.649519) * 2.0).abs() < 2e-3, "{below}");
        // Tr40x7: d3 = 32 and d2 = 36.5.
        let trapezoid = edge("22ERTR7", "Tr40x7-7e", Side::External).expect("fits");
        let thread: Thread = "Tr40x7-7e".parse().expect("a thread");
        let root = 0.5 * (thread.profile().pitch_diameter_mm - thread.profile().minor_mm);
        assert!((trapezoid.depth_mm(3.5).expect("narrow enough") - root).abs() < 1e-9);
    }

    #[test]
    fn what_is_not_for_a_thread_is_refused() {
        let refused = |tool, thread, side| edge(tool, thread, side).expect_err("is not for it");
        assert!(refused("16IR2.0ISO", "M20x2-6g", Side::External).contains("internal"));
        assert!(refused("16ER1.5ISO", "M20x2-6g", Side::External).contains("1.5000"));
        assert!(refused("16ERA60", "M20x2-6g", Side::External).contains("0.5 to 1.5"));
        assert!(refused("16ERAG55", "M20x2-6g", Side::External).contains("55"));
        assert!(refused("16EL2.0ISO", "M20x2-6g", Side::External).contains("right-hand"));
        assert!(refused("16ER2.0ISO", "M20x2-6g LH", Side::External).contains("left-hand"));
        assert!(refused("16ER11W", "M20x2-6g", Side::External).contains("pitch"));
        assert!(refused("16ER2.0TR", "M20x2-6g", Side::External).contains("profile"));
        assert!(refused("A30", "M20x2-6g", Side::External).contains("30"));
        for unread in [
            "", "16", "16ER", "16XR2", "18ER2", "16ERAG", "16ERAG50", "16ERx", "A", "A60 A60", "A60 Q2", "A1",
        ] {
            assert!(unread.parse::<Tool>().is_err(), "{unread:?}");
        }
    }

    #[test]
    fn inserts_are_read_as_makers_write_them() {
        for (text, pitch) in [
            ("16ER 1.50 ISO", 1.5),
            ("16erm2.0iso", 2.0),
            ("22IR TR 6", 6.0),
            ("16ER14UN", 25.4 / 14.0),
            ("16ER2.0", 2.0),
        ] {
            let Form::Full { pitch_mm, .. } = text.parse::<Tool>().expect(text).form else {
                panic!("{text}")
            };
            assert_eq!(pitch_mm, pitch, "{text}");
        }
        let partial = "16ERAG60".parse::<Tool>().expect("an insert");
        assert_eq!(partial.form, Form::Partial { angle_deg: 60.0, pitches_mm: [0.5, 3.0] });
        let edge = edge("A60 R0.1", "M20x2-6g", Side::External).expect("fits");
        assert_eq!((edge.nose_mm, edge.flat_mm), (0.1, 0.0));
    }
}
