//! The insert that a thread is written for. In: a comment, `(thread_insert, A60 R0.144 W1.9)`, in the units
//! of its program. Out: angle, nose and width of its tip; in what the tool of a machine file is another one.
//!
//! A thread is as deep as its tip asks for, so another tip cuts another thread with the same program.

use crate::Tool;

/// Angles closer than this are one, degrees,
const SAME_DEG: f64 = 0.01;
/// and so are lengths, mm: words of inch programs are not finer.
const SAME_MM: f64 = 2e-3;

/// The tip of an insert.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Insert {
    /// Angle between its flanks, degrees.
    pub angle_deg: f64,
    /// Radius of its nose, mm; 0 if it is sharp.
    pub nose_mm: f64,
    /// Width of its flat tip, mm; 0 if it has none.
    pub width_mm: f64,
}

/// What a comment that begins as one about an insert has wrong.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum InsertError {
    /// A word that is not one of its words, or stands twice.
    #[error("an insert has no word {0}")]
    Word(String),
    /// The angle is missing.
    #[error("the angle between the flanks is missing")]
    Angle,
}

impl Insert {
    /// Reads a comment of a program whose unit is so many mm; `None` if it is about something else.
    ///
    /// # Errors
    /// [`InsertError`] says what is wrong.
    pub fn from_comment(text: &str, unit_mm: f64) -> Result<Option<Insert>, InsertError> {
        let (word, rest) = text.split_once(',').unwrap_or((text, ""));
        if !word.trim().eq_ignore_ascii_case("thread_insert") {
            return Ok(None);
        }
        let mut insert = Insert { angle_deg: f64::NAN, nose_mm: f64::NAN, width_mm: f64::NAN };
        for word in rest.split_whitespace() {
            let wrong = || InsertError::Word(word.into());
            let (letter, number) = word.split_at_checked(1).ok_or_else(wrong)?;
            let value: f64 = number.parse().map_err(|_| wrong())?;
            let (place, unit, most) = match letter.to_ascii_uppercase().as_str() {
                "A" => (&mut insert.angle_deg, 1.0, 120.0),
                "R" => (&mut insert.nose_mm, unit_mm, 50.0),
                "W" => (&mut insert.width_mm, unit_mm, 200.0),
                _ => return Err(wrong()),
            };
            if !place.is_nan() || !(0.0..=most).contains(&(value * unit)) {
                return Err(wrong());
            }
            *place = value * unit;
        }
        let or_none = |mm: f64| if mm.is_nan() { 0.0 } else { mm };
        match insert.angle_deg > 0.0 {
            true => Ok(Some(Insert {
                nose_mm: or_none(insert.nose_mm),
                width_mm: or_none(insert.width_mm),
                ..insert
            })),
            false => Err(InsertError::Angle),
        }
    }

    /// In what a tool is another one, in words; `None` if it is not. A machine file that does not describe it
    /// is taken to have a sharp one of the right angle.
    pub fn differs(&self, tool: Option<&Tool>) -> Option<String> {
        let (angle, nose, width) =
            tool.map_or((None, None, None), |tool| (tool.angle_deg, tool.nose_mm, tool.width_mm));
        let other = |have: f64, want: f64, same: f64| (have - want).abs() > same;
        let mut told = Vec::new();
        if let Some(angle) = angle.filter(|angle| other(*angle, self.angle_deg, SAME_DEG)) {
            told.push(format!("{angle} degrees between its flanks, not {}", self.angle_deg));
        }
        for (have, want, what) in [
            (nose.unwrap_or(0.0), self.nose_mm, "a nose"),
            (width.unwrap_or(0.0), self.width_mm, "a flat tip"),
        ] {
            if other(have, want, SAME_MM) {
                told.push(format!("{what} of {have:.3} mm, not {want:.3}"));
            }
        }
        (!told.is_empty()).then(|| told.join(", "))
    }
}
